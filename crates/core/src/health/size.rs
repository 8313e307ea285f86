//! Area, volume and bounding box.

use super::GoOn;
use crate::scene::{Bounds, Mesh};
use glam::{DAffine3, DVec3};
use rayon::prelude::*;

/// Area, volume and bounding box of a mesh, in the units of the space that they were computed in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// The sum of the triangles' areas.
    pub area: f64,
    /// The volume that the triangles enclose where the mesh is closed: positive where they run counter-clockwise as
    /// seen from outside. Of an open mesh it is the volume that they span with the centre of the box, which means
    /// little.
    pub volume: f64,
    /// The axis-aligned bounding box.
    pub bounds: Bounds,
}

/// Triangles that are summed in one task. The chunks are fixed so that the sums do not depend on the number of
/// threads.
const CHUNK: usize = 1 << 14;

/// The size of the kept triangles of a mesh under a transform; `None` if cancelled. In double precision: with n
/// triangles the error of area and volume is at most about n · 2⁻⁵³ of the sum of the magnitudes of all triangles'
/// contributions, and mostly far less. A mesh without triangles has zero area and volume and an empty box.
pub fn size(mesh: &Mesh, world_from_object: &DAffine3, go_on: GoOn<'_>) -> Option<Size> {
    let corners =
        |number: &u32| {
            let corners = mesh.corners(*number)?;
            Some(corners.map(|corner| {
                world_from_object.transform_point3(mesh.offset() + corner.as_dvec3())
            }))
        };
    let kept = mesh.kept();
    let chunks = kept.par_chunks(CHUNK);
    let bounds = chunks.map(|part| Bounds::around(part.iter().filter_map(corners).flatten()));
    let bounds = bounds.reduce(|| Bounds::EMPTY, Bounds::union);
    if !go_on(0.4) {
        return None;
    }
    // Relative to the centre, so that less cancels.
    let middle = if bounds.is_empty() {
        DVec3::ZERO
    } else {
        bounds.center()
    };
    let sums: Vec<(f64, f64)> = kept
        .par_chunks(CHUNK)
        .map(|part| {
            let mut sum = (0.0, 0.0);
            for corners in part.iter().filter_map(corners) {
                let [a, b, c] = corners.map(|corner| corner - middle);
                sum.0 += (b - a).cross(c - a).length() * 0.5;
                sum.1 += a.dot(b.cross(c)) / 6.0;
            }
            sum
        })
        .collect();
    if !go_on(1.0) {
        return None;
    }
    let (area, volume) = sums
        .into_iter()
        .fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
    Some(Size {
        area,
        volume,
        bounds,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Shape;

    fn mesh(shape: Shape) -> Mesh {
        Mesh::new(shape.mesh().expect("a good shape"))
    }

    #[test]
    fn a_cube_has_its_area_and_volume_and_a_mirrored_one_a_negative_volume() {
        let cube = mesh(Shape::Cube {
            size: DVec3::new(1.0, 2.0, 4.0),
        });
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12 * b.abs();
        let here = size(&cube, &DAffine3::IDENTITY, &|_| true).expect("it goes on");
        assert!(
            close(here.area, 28.0) && close(here.volume, 8.0),
            "{here:?}"
        );
        assert_eq!(here.bounds.size(), DVec3::new(1.0, 2.0, 4.0));
        // Far from the origin, twice as large along x, and mirrored: inside out.
        let there = DAffine3::from_translation(DVec3::splat(1e6))
            * DAffine3::from_scale(DVec3::new(-2.0, 1.0, 1.0));
        let there = size(&cube, &there, &|_| true).expect("it goes on");
        assert!((there.area - 40.0).abs() < 1e-8 && (there.volume + 16.0).abs() < 1e-8);
        assert_eq!(size(&cube, &DAffine3::IDENTITY, &|_| false), None);
    }

    #[test]
    fn a_fine_sphere_mesh_has_nearly_the_area_and_volume_of_a_sphere() {
        let sphere = mesh(Shape::Sphere {
            radius: 1.0,
            segments: 256,
            rings: 128,
        });
        let found = size(&sphere, &DAffine3::IDENTITY, &|_| true).expect("it goes on");
        let pi = std::f64::consts::PI;
        assert!((found.area / (4.0 * pi) - 1.0).abs() < 1e-3, "{found:?}");
        assert!((found.volume * 0.75 / pi - 1.0).abs() < 1e-3, "{found:?}");
    }
}
