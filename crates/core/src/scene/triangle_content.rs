use super::content::{add_color_rule, add_placement};
use super::{Bounds, ColorRule, Material, Object, Opacity, Scene};
use crate::digest::{Digest, Digester};
use glam::{DVec3, Vec3};

/// Triangles that are digested at a time.
const AT_ONCE: usize = 4096;

impl Scene {
    /// [`Scene::content`] of pictures that show the scene's triangles alone, and colours, if `shows_colors`, by the
    /// objects' rules alone: the same for the same triangles in the same order, however a file stores their vertices,
    /// and whatever else it has. `None` where such a picture shows more: colours of a file, textures, or surfaces that
    /// are not opaque.
    pub fn triangle_content(&self, shows_colors: bool) -> Option<Digest> {
        let mut hash = Digester::new();
        hash.bytes(b"triangles");
        hash.number(self.objects.len() as u64);
        for object in &self.objects {
            if !are_triangles_enough(object, shows_colors) {
                return None;
            }
            add_placement(&mut hash, (&object.transform, object.parent));
            if shows_colors {
                add_color_rule(&mut hash, &object.color, &object.mesh);
            }
            if !object.visible {
                hash.bytes(b"hidden");
            }
            add_triangles(&mut hash, object, shows_colors);
        }
        Some(hash.finish())
    }
}

/// Whether pictures that show no normals show of an object its triangles alone, and its colour rule where they show
/// colours.
fn are_triangles_enough(object: &Object, shows_colors: bool) -> bool {
    let materials = object.mesh.materials();
    let is_opaque = |material: &Material| matches!(material.opacity, Opacity::Opaque);
    let is_plain = match object.color {
        ColorRule::Uniform(_) | ColorRule::PerTriangle { .. } | ColorRule::ByObject => {
            object.texture.is_none() && materials.iter().all(|it| it.texture.is_none())
        }
        ColorRule::File | ColorRule::ByGroup | ColorRule::Normal | ColorRule::Value(_) => false,
    };
    materials.iter().all(is_opaque) && (is_plain || !shows_colors)
}

/// The corners of the triangles that rays can hit, and their numbers where colours follow from those.
fn add_triangles(hash: &mut Digester, object: &Object, shows_colors: bool) {
    let (mesh, kept) = (&object.mesh, object.kept());
    hash.number(kept.len() as u64);
    if shows_colors && matches!(object.color, ColorRule::PerTriangle { .. }) {
        hash.words(kept.iter().copied());
    }
    // Of all triangles, hidden ones too: distances and grids are scaled to it.
    let Bounds { min, max } = mesh.bounds();
    let vectors = [mesh.offset(), min, max];
    // Zeros are equal, whatever their signs.
    let positive = vectors.map(|vector| (vector + DVec3::ZERO).to_array());
    hash.doubles(positive.into_iter().flatten());
    let mut corners = Vec::with_capacity(AT_ONCE.min(kept.len()));
    for numbers in kept.chunks(AT_ONCE) {
        corners.clear();
        let of_some = numbers.iter().filter_map(|&number| mesh.corners(number));
        corners.extend(of_some.map(|corners| corners.map(|corner| corner + Vec3::ZERO)));
        hash.list(corners.as_flattened());
    }
}

#[cfg(test)]
mod tests {
    use super::super::content::tests::{alpha, data, mask, scene, texture};
    use crate::scene::{Color, ColorRule, MeshData, Object, Quantity, Scene};

    /// Two objects in one colour; the second is of this data.
    fn plain(data: MeshData) -> Scene {
        let mut scene = scene(data, |_| ());
        for object in &mut scene.objects {
            object.color = ColorRule::Uniform(Color([1, 2, 3]));
        }
        scene
    }

    #[test]
    fn triangles_are_the_same_however_their_vertices_are_stored() {
        let expected = plain(data()).triangle_content(true);
        assert!(expected.is_some());
        let changes: [fn(&mut MeshData); 5] = [
            |data| data.normals = None,
            |data| data.uvs = None,
            |data| data.colors.clear(),
            |data| data.positions[2].x = -0.0,
            // Each triangle has vertices of its own.
            |data| {
                let corners = data.triangles.as_flattened().iter();
                let positions = corners.map(|&corner| data.positions[corner as usize]);
                *data = MeshData {
                    positions: positions.collect(),
                    triangles: vec![[0, 1, 2], [3, 4, 5]],
                    ..MeshData::default()
                };
            },
        ];
        for change in changes {
            let mut data = data();
            change(&mut data);
            let changed = plain(data);
            assert_eq!(changed.triangle_content(true), expected);
            assert_ne!(changed.content(), plain(self::data()).content());
        }
    }

    #[test]
    fn all_that_decides_a_picture_of_triangles_counts() {
        let mut digests = vec![plain(data()).triangle_content(true)];
        let changes: [fn(&mut MeshData); 4] = [
            |data| data.positions[1].x = 2.0,
            |data| data.positions.iter_mut().for_each(|p| p.x += 1e6),
            |data| data.triangles[1] = [1, 0, 3],
            |data| data.triangles.truncate(1),
        ];
        for change in changes {
            let mut data = data();
            change(&mut data);
            data.material_of_triangle.truncate(data.triangles.len());
            digests.push(plain(data).triangle_content(true));
        }
        // Two colours by number, for the same triangles with and without a dropped one between them.
        for triangles in [
            vec![[0, 1, 2], [0, 1, 3]],
            vec![[0, 1, 2], [0, 0, 1], [0, 1, 3]],
        ] {
            let mut scene = plain(MeshData {
                positions: data().positions,
                triangles,
                ..MeshData::default()
            });
            scene.objects[1].color = ColorRule::PerTriangle { seed: 0 };
            digests.push(scene.triangle_content(true));
        }
        let changes: [fn(&mut Object); 5] = [
            |object| object.transform.translate.y = 1e-300,
            |object| object.parent = Some(0),
            |object| object.color = ColorRule::Uniform(Color([0; 3])),
            |object| object.color = ColorRule::ByObject,
            |object| object.visible = false,
        ];
        for change in changes {
            let mut scene = plain(data());
            change(&mut scene.objects[1]);
            digests.push(scene.triangle_content(true));
        }
        assert!(digests.iter().all(Option::is_some));
        let distinct: std::collections::HashSet<_> = digests.iter().collect();
        assert_eq!(distinct.len(), digests.len());
    }

    #[test]
    fn what_is_more_than_triangles_has_no_content_of_triangles() {
        let changes: [fn(&mut Object); 5] = [
            |object| object.color = ColorRule::File,
            |object| object.color = ColorRule::ByGroup,
            |object| object.color = ColorRule::Normal,
            |object| object.color = ColorRule::Value(Quantity::Area),
            |object| object.texture = texture(1),
        ];
        for change in changes {
            let mut scene = plain(data());
            change(&mut scene.objects[1]);
            assert_eq!(scene.triangle_content(true), None);
            // Where no colours are shown, they do not count.
            let expected = plain(data()).triangle_content(false);
            assert_eq!(scene.triangle_content(false), expected);
        }
        let changes: [fn(&mut MeshData); 2] = [
            |data| data.materials[0].texture = texture(1),
            |data| data.materials[0].opacity = mask(0.5, alpha(0.5, None)),
        ];
        for (change, shows) in changes.into_iter().zip([true, false]) {
            let mut data = data();
            change(&mut data);
            assert_eq!(plain(data).triangle_content(shows), None);
        }
    }
}
