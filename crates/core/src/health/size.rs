//! Area, volume and bounding box.

use super::GoOn;
use crate::scene::{Bounds, Mesh};
use glam::{DAffine3, DVec3};
use rayon::prelude::*;

/// How much there is of a mesh, in the units of the space that it was asked for in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// The sum of its triangles' areas.
    pub area: f64,
    /// What its triangles enclose where it is closed: positive where they turn left as seen from outside.
    /// Where it is open it is what they enclose with the centre of the box, which means little.
    pub volume: f64,
    /// The box around it, along the axes.
    pub bounds: Bounds,
}

/// Triangles that are summed up as one; so the sums do not depend on the number of threads.
const CHUNK: usize = 1 << 14;

/// The size of the kept triangles of a mesh in its place; `None` if cancelled. Double precision: of n
/// triangles, area and volume are right to some n · 2⁻⁵³ of the sum of all triangles' shares, and mostly to far
/// less. A mesh without triangles has neither area, volume nor box.
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
    // From the middle, so that little cancels.
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
    fn a_cube_has_the_area_and_the_volume_of_its_sides() {
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
        // Far away, twice as large along x, and mirrored: inside out.
        let there = DAffine3::from_translation(DVec3::splat(1e6))
            * DAffine3::from_scale(DVec3::new(-2.0, 1.0, 1.0));
        let there = size(&cube, &there, &|_| true).expect("it goes on");
        assert!((there.area - 40.0).abs() < 1e-8 && (there.volume + 16.0).abs() < 1e-8);
        assert_eq!(size(&cube, &DAffine3::IDENTITY, &|_| false), None);
    }

    #[test]
    fn a_fine_sphere_comes_near_the_sphere() {
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
