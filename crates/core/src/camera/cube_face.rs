//! The faces of a cube map as the planes that they are: perspective cameras.

use super::panorama::Face;
use super::stereo::Eyes;
use super::{Camera, Lattice, PanoramaRays, Projection, Rect};

/// How far a face's middle may be from the middle of the picture's pixels, in units of a face's half width. Its place is
/// rounded by ε = 2⁻⁵³ of that, as a tangent. A nearer limit leaves out pictures far off the view axis; a further one makes
/// rays differ by more.
const FURTHEST: f64 = 1024.0;

impl Lattice {
    /// The faces of a cube map that a lattice has rays on: the rectangle of its rays, and a perspective camera whose rays on
    /// the face are the lattice's but for rounding. `None` where the picture is no cube map, or is too far from its middle.
    ///
    /// Tangents of the rays to the right and up differ by less than 1100ε, and directions, made unit length, by as much
    /// again as any camera's are rounded:
    /// * a place (a, b), at most 6 from the middle, is rounded twice, and its distance from the middle of the face once:
    ///   13ε;
    /// * the middle of the face, in pixels, is off by ε of itself, [`FURTHEST`]·ε as a tangent;
    /// * the perspective camera's own place is rounded twice: 2ε;
    /// * axes of the face are the camera's or their negatives, and products with zero and one are exact: on their way to
    ///   the world and to unit length the rays of both are rounded by 9√3ε·|d| ([`places`](crate::packet)), |d|² ≤ 3,
    ///   which moves a tangent by twice that at most: 54ε.
    pub(crate) fn faces(&self) -> Option<Vec<(Rect, Camera)>> {
        let rays = PanoramaRays::new(self)?;
        let mut all = Vec::new();
        for rect in rays.rects_of_faces()? {
            let Some(face) = rays.face(rect.x, rect.y) else {
                // Beside the faces of a cross.
                continue;
            };
            all.push((rect, self.camera.of_face(&face)?));
        }
        Some(all)
    }
}

impl Camera {
    /// A perspective camera that sees a face of a cube map's at the same places.
    fn of_face(&self, &(a, b, [right, up, forward]): &Face) -> Option<Self> {
        let half = self.distance() / self.plane.step;
        let [x, y] = self.center;
        let center = [x + a * half, y - b * half];
        // NaN is not near.
        let is_near = center.iter().all(|at| at.abs() <= FURTHEST * half);
        let mut face = *self;
        face.projection = Projection::Perspective;
        face.right = self.in_world(right);
        face.up = self.in_world(up);
        face.forward = self.in_world(forward);
        face.center = center;
        face.eyes = Eyes::One;
        is_near.then_some(face)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{ImagePlane, Panorama, Pose};
    use crate::random::Random;

    /// Rays of the picture lie beside the faces' by less than is said, and each is on one face.
    #[test]
    fn faces_have_the_pictures_rays_but_for_rounding() {
        let mut random = Random(95);
        for panorama in [Panorama::CubeStrip, Panorama::CubeCross] {
            for (columns, rows) in [(600, 100), (64, 48), (1203, 907), (9, 2)] {
                let pose = Pose::towards(random.point(), random.point() * 7.0);
                let projection = Projection::Panoramic(panorama);
                let distance = pose.eye.distance(pose.target);
                let step = projection.frame(projection.default_fov(), distance) / f64::from(rows);
                let plane = ImagePlane::new(columns, rows, step).expect("a good plane");
                let camera = Camera::new(pose, projection, plane);
                let mut lattice = camera.whole().sparse_lattice(1, (0, 0));
                lattice.offset = (random.unit(), random.unit());
                let faces = lattice.faces().expect("a cube map");
                let mut count = 0;
                for (rect, face) in faces {
                    for row in rect.y..rect.bottom() {
                        for column in rect.x..rect.right() {
                            let (x, y) = lattice.place(column, row);
                            let (ours, theirs) = (face.ray(x, y), camera.ray(x, y));
                            assert_eq!(ours.origin, theirs.origin);
                            let off = (ours.direction - theirs.direction).abs().max_element();
                            assert!(off <= 550.0 * f64::EPSILON, "{panorama:?} {x} {y}: {off:e}");
                            count += 1;
                        }
                    }
                }
                let places =
                    (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
                let there = places.filter(|&(column, row)| {
                    let (x, y) = lattice.place(column, row);
                    camera.has_place(x, y)
                });
                assert_eq!(count, there.count(), "{panorama:?} {columns}x{rows}");
            }
        }
    }
}
