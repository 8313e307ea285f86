use super::{Layers, Picture};
use crate::digest::{Digest, Digester};

/// The checksum of a picture's pixels, which come from the top, some rows at a time: of all layers, from which the 8-bit
/// colours follow, or of those if there are no layers.
pub struct PixelDigest(Channels);

enum Channels {
    Colors(Digester),
    /// One for each layer, so that it does not matter how many rows come at a time.
    Layers([Digester; 6]),
}

impl PixelDigest {
    /// The checksum of no rows so far.
    pub(super) fn new(has_layers: bool) -> Self {
        Self(match has_layers {
            true => Channels::Layers(std::array::from_fn(|_| Digester::new())),
            false => Channels::Colors(Digester::new()),
        })
    }

    /// The checksum of a picture.
    pub(super) fn of(picture: &Picture) -> Digest {
        let mut digest = Self::new(picture.layers.is_some());
        digest.add(picture);
        digest.finish()
    }

    /// Adds the rows below those that were added. Layers that are missing are left out.
    pub fn add(&mut self, rows: &Picture) {
        match (&mut self.0, &rows.layers) {
            (Channels::Colors(hash), _) => hash.bytes(rows.pixels.as_flattened()),
            (Channels::Layers(hashes), Some(layers)) => {
                let Layers {
                    color,
                    depth,
                    object,
                    triangle,
                    normal,
                    uv,
                } = layers;
                let [colors, depths, objects, triangles, normals, uvs] = hashes;
                colors.words(color.as_flattened().iter().map(|value| value.to_bits()));
                depths.words(depth.iter().map(|value| value.to_bits()));
                objects.words(object.iter().copied());
                triangles.words(triangle.iter().copied());
                normals.words(normal.as_flattened().iter().map(|value| value.to_bits()));
                uvs.words(uv.as_flattened().iter().map(|value| value.to_bits()));
            }
            (Channels::Layers(_), None) => {}
        }
    }

    /// The checksum of all rows.
    pub(super) fn finish(self) -> Digest {
        match self.0 {
            Channels::Colors(hash) => hash.finish(),
            Channels::Layers(hashes) => {
                let mut all = Digester::new();
                for hash in hashes {
                    all.bytes(&hash.finish().to_bytes());
                }
                all.finish()
            }
        }
    }
}

impl std::fmt::Debug for PixelDigest {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PixelDigest").finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::super::fragment::tests::sample_picture;
    use super::*;

    #[test]
    fn the_number_of_rows_at_a_time_does_not_count() {
        for has_layers in [false, true] {
            let picture = sample_picture(7, 12, has_layers);
            for most in [1, 5, 12] {
                let mut digest = PixelDigest::new(has_layers);
                let mut rest = picture.clone();
                while rest.height > 0 {
                    let mut rows = rest;
                    rest = rows.split_off_rows(rows.height.min(most)).expect("memory");
                    digest.add(&rows);
                }
                assert_eq!(digest.finish(), PixelDigest::of(&picture));
            }
        }
    }
}
