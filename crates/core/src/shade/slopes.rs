//! The change of a triangle's barycentrics from pixel to pixel.

use crate::camera::{Camera, Projection};
use glam::{DVec2, DVec3};

/// The derivatives of a hit's barycentrics (u, v) from pixel to pixel, to the right and down, on the picture's own
/// lattice of rays; `corners` are relative to the eye, (x, y) is in pixels.
///
/// Through an eye, u = d · (c × a) / d · n and v = d · (a × b) / d · n with n = (b − a) × (c − a). The ray's
/// direction d before normalising is linear in the place on a planar picture, and has derivatives on others; for
/// parallel rays u and v themselves are linear (Igehy, "Tracing Ray Differentials", 1999, without bounces). Where a
/// ray lies in the triangle's plane they are infinite or NaN.
pub(super) fn slopes(
    camera: &Camera,
    corners: [DVec3; 3],
    (x, y): (f64, f64),
    (u, v): (f32, f32),
) -> [DVec2; 2] {
    let [a, b, c] = corners;
    let (ab, ac) = (b - a, c - a);
    match camera.projection() {
        Projection::Perspective | Projection::Panoramic(_) => {
            let steps = camera.direction_slopes(x, y);
            let normal = ab.cross(ac);
            // From edges, which keep their significant bits where corners are far away.
            let (for_u, for_v) = (ac.cross(a), a.cross(ab));
            let along = camera.direction(x, y).dot(normal);
            steps.map(|step| {
                let change = step.dot(normal);
                let of = |weight: DVec3, value: f32| {
                    (step.dot(weight) - f64::from(value) * change) / along
                };
                DVec2::new(of(for_u, u), of(for_v, v))
            })
        }
        Projection::Orthographic => {
            let step = camera.plane().step;
            let steps = [camera.right() * step, camera.up() * -step];
            let forward = camera.forward();
            let (for_u, for_v) = (ac.cross(forward), forward.cross(ab));
            let area = ab.dot(for_u);
            steps.map(|step| DVec2::new(step.dot(for_u), step.dot(for_v)) / area)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{ImagePlane, Panorama, Pose};

    /// Barycentrics of the point where a ray intersects the plane of a triangle, in double precision.
    fn weights(camera: &Camera, [a, b, c]: [DVec3; 3], (x, y): (f64, f64)) -> DVec2 {
        let direction = camera.direction(x, y);
        let plane = camera.plane();
        let origin = match camera.projection() {
            Projection::Perspective | Projection::Panoramic(_) => DVec3::ZERO,
            Projection::Orthographic => {
                camera.right() * ((x - f64::from(plane.columns) * 0.5) * plane.step)
                    - camera.up() * ((y - f64::from(plane.rows) * 0.5) * plane.step)
            }
        };
        let normal = (b - a).cross(c - a);
        let t = (a - origin).dot(normal) / direction.dot(normal);
        let p = origin + direction * t - a;
        let of = |edge: DVec3| p.dot(edge);
        DVec2::new(
            of((c - a).cross(normal)) / (b - a).dot((c - a).cross(normal)),
            of((b - a).cross(normal)) / (c - a).dot((b - a).cross(normal)),
        )
    }

    /// The truth is a difference over a hundredth of a pixel in both directions.
    #[test]
    fn slopes_are_the_differences_of_neighbouring_rays() {
        let corners = [
            DVec3::new(-0.5, -0.3, 0.2),
            DVec3::new(0.7, -0.1, -0.4),
            DVec3::new(0.2, 0.6, 0.5),
        ];
        let panoramas = [Panorama::Equirectangular, Panorama::Stereographic];
        let planar = [Projection::Perspective, Projection::Orthographic];
        for projection in panoramas
            .map(Projection::Panoramic)
            .into_iter()
            .chain(planar)
        {
            for eye in [DVec3::new(3.0, 2.0, 4.0), DVec3::new(-1.0, 0.5, 1.5)] {
                let plane = ImagePlane::new(200, 100, 0.02).expect("a good plane");
                let pose = Pose {
                    eye,
                    target: DVec3::new(0.1, 0.2, 0.3),
                    up: DVec3::Y,
                };
                let camera = Camera::new(pose, projection, plane);
                let corners = corners.map(|corner| corner - eye);
                for (x, y) in [(100.0, 50.0), (90.5, 47.5), (108.0, 61.0)] {
                    let here = weights(&camera, corners, (x, y));
                    let found = slopes(&camera, corners, (x, y), (here.x as f32, here.y as f32));
                    let by = 0.01;
                    let across = weights(&camera, corners, (x + by, y))
                        - weights(&camera, corners, (x - by, y));
                    let down = weights(&camera, corners, (x, y + by))
                        - weights(&camera, corners, (x, y - by));
                    for (found, truth) in found.iter().zip([across, down]) {
                        let truth = truth / (2.0 * by);
                        let apart = (*found - truth).length();
                        let bound = 1e-5 * truth.length().max(0.01);
                        assert!(apart < bound, "{projection:?}: {found} for {truth}");
                    }
                }
            }
        }
    }
}
