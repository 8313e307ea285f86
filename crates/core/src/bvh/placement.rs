//! Placements of meshes: maps of corners, and of boxes around them, from the mesh's space to the scene's.

use super::tree::{Box32, BoxPair};
use crate::num::roundoff::EPSILON;
use crate::num::simd::LANES;
use crate::triangle::CornerLanes;
use glam::{DAffine3, DVec3, Vec3};

/// The map from a mesh's positions to the tree's coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    world_from_object: DAffine3,
    /// What is added to a position of the mesh.
    offset: DVec3,
    /// The point that corners in the tree are relative to.
    origin: DVec3,
}

impl Placement {
    pub(super) fn new(world_from_object: DAffine3, offset: DVec3, origin: DVec3) -> Self {
        Self {
            world_from_object,
            offset,
            origin,
        }
    }

    /// A corner, computed in double precision and rounded once.
    pub(super) fn corner(&self, position: Vec3) -> Vec3 {
        let in_object = self.offset + position.as_dvec3();
        (self.world_from_object.transform_point3(in_object) - self.origin).as_vec3()
    }

    /// The same for eight triangles, bit for bit: the operations are those of [`Placement::corner`], in their order.
    #[inline(always)]
    pub(super) fn corners(&self, positions: &CornerLanes) -> CornerLanes {
        let [x_axis, y_axis, z_axis] = self.world_from_object.matrix3.to_cols_array_2d();
        let translation = self.world_from_object.translation.to_array();
        let (offset, origin) = (self.offset.to_array(), self.origin.to_array());
        let mut placed = [[0.0; LANES]; 9];
        for corner in 0..3 {
            let mut in_object = [[0.0; LANES]; 3];
            for axis in 0..3 {
                for lane in 0..LANES {
                    in_object[axis][lane] =
                        offset[axis] + f64::from(positions[3 * corner + axis][lane]);
                }
            }
            let [x, y, z] = &in_object;
            for axis in 0..3 {
                for lane in 0..LANES {
                    let in_world = x_axis[axis] * x[lane]
                        + y_axis[axis] * y[lane]
                        + z_axis[axis] * z[lane]
                        + translation[axis];
                    placed[3 * corner + axis][lane] = (in_world - origin[axis]) as f32;
                }
            }
        }
        placed
    }
}

/// The map of boxes around a mesh's positions to boxes around its placed corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoxPlacement {
    /// The rows of the matrix.
    rows: [[f64; 3]; 3],
    /// The mesh's offset, mapped.
    shift: [f64; 3],
    /// By how much a box is enlarged beyond its rounded faces.
    slack: [f64; 3],
}

impl BoxPlacement {
    /// For boxes inside `bounds`.
    pub(super) fn new(placement: &Placement, bounds: &Box32) -> Self {
        let Placement {
            world_from_object:
                DAffine3 {
                    matrix3,
                    translation,
                },
            offset,
            origin,
        } = *placement;
        let reach = offset.abs() + bounds.min.abs().max(bounds.max.abs()).as_dvec3();
        let magnitude = matrix3.abs() * reach + translation.abs() + origin.abs();
        // In units of ε = 2⁻⁵³ times this magnitude: a corner goes through 6 roundings (offset, product, two sums,
        // translation, origin). Middle and half of a box take 1 each, their products and sums 3; the shift 5; the
        // three sums below 3; the half counts as much again as the middle. That is below 6 + 2 (1 + 3) + 5 + 3 = 22;
        // 64 has room for the rounding of the slack itself. What is rounded to nothing is made up for by the least
        // normal number.
        let slack = magnitude * (64.0 * EPSILON) + f64::MIN_POSITIVE;
        Self {
            rows: matrix3.transpose().to_cols_array_2d(),
            shift: (matrix3 * offset + translation - origin).to_array(),
            slack: slack.to_array(),
        }
    }

    /// Boxes that contain every placed corner of a position in the given boxes.
    ///
    /// The centre is mapped by the matrix, and half the size by the matrix's absolute values (Arvo, "Transforming
    /// Axis-Aligned Bounding Boxes", 1990). Rounding to single precision is monotone: a corner inside a face stays
    /// inside it.
    pub(super) fn boxes(&self, boxes: &BoxPair) -> BoxPair {
        let mut middle = [[0.0; 2]; 3];
        let mut half = [[0.0; 2]; 3];
        for axis in 0..3 {
            for which in 0..2 {
                let min = f64::from(boxes.min[axis][which]);
                let max = f64::from(boxes.max[axis][which]);
                middle[axis][which] = (min + max) * 0.5;
                half[axis][which] = (max - min) * 0.5;
            }
        }
        let mut placed = BoxPair::default();
        for axis in 0..3 {
            let row = self.rows[axis];
            for which in 0..2 {
                let center = row[0] * middle[0][which]
                    + row[1] * middle[1][which]
                    + row[2] * middle[2][which]
                    + self.shift[axis];
                let reach = row[0].abs() * half[0][which]
                    + row[1].abs() * half[1][which]
                    + row[2].abs() * half[2][which]
                    + self.slack[axis];
                placed.min[axis][which] = (center - reach) as f32;
                placed.max[axis][which] = (center + reach) as f32;
            }
        }
        placed
    }

    /// As [`BoxPlacement::boxes`], for one box.
    pub(super) fn one(&self, around: Box32) -> Box32 {
        self.boxes(&BoxPair::of([around, around])).get(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use glam::{DMat3, DQuat};

    /// Placements of many magnitudes, each with the size of a mesh.
    fn placements(random: &mut Random) -> Vec<(Placement, f64)> {
        let mut all = Vec::new();
        for round in 0..300 {
            let size = 10f64.powi(round % 13 - 6);
            let turn = random.point().extend(random.signed());
            let turn = DQuat::from_vec4(turn).normalize();
            let scale = DMat3::from_diagonal(random.point() * 10f64.powi(round % 7 - 3));
            let world_from_object = DAffine3 {
                matrix3: DMat3::from_quat(turn) * scale,
                translation: random.point() * 10f64.powi(round % 17 - 8),
            };
            let offset = (random.point() * 1e7 * f64::from(round % 2)).round();
            let origin = (random.point() * 1e6 * f64::from(round % 3)).round();
            all.push((Placement::new(world_from_object, offset, origin), size));
        }
        all
    }

    #[test]
    fn eight_triangles_are_placed_with_the_bits_of_single_ones() {
        let mut random = Random(11);
        for (placement, size) in placements(&mut random) {
            let mut positions: CornerLanes = [[0.0; LANES]; 9];
            positions
                .as_flattened_mut()
                .iter_mut()
                .for_each(|x| *x = (random.point().x * size) as f32);
            let placed = placement.corners(&positions);
            for lane in 0..LANES {
                for corner in 0..3 {
                    let at = |all: &CornerLanes| {
                        Vec3::from_array([0, 1, 2].map(|axis| all[3 * corner + axis][lane]))
                    };
                    let one = placement.corner(at(&positions));
                    assert_eq!(
                        at(&placed).to_array().map(f32::to_bits),
                        one.to_array().map(f32::to_bits)
                    );
                }
            }
        }
    }

    #[test]
    fn placed_boxes_contain_the_placed_corners_in_them() {
        let mut random = Random(12);
        for (placement, size) in placements(&mut random) {
            for _ in 0..20 {
                let [a, b] = [0; 2].map(|_| (random.point() * size).as_vec3());
                let around = Box32 {
                    min: a.min(b),
                    max: a.max(b),
                };
                let placed = BoxPlacement::new(&placement, &around).one(around);
                let holds = |point: Vec3| {
                    let corner = placement.corner(point);
                    assert!(
                        placed.min.cmple(corner).all() && placed.max.cmpge(corner).all(),
                        "{placement:?}: {around:?}, {point}: {corner} {placed:?}"
                    );
                };
                for corner in 0..8u32 {
                    let axis = |axis: u32| corner >> axis & 1 == 1;
                    holds(Vec3::select(
                        glam::BVec3::new(axis(0), axis(1), axis(2)),
                        around.min,
                        around.max,
                    ));
                }
                let share = (random.point().as_vec3() * 0.5 + 0.5).clamp(Vec3::ZERO, Vec3::ONE);
                holds(
                    (around.min + (around.max - around.min) * share).clamp(around.min, around.max),
                );
            }
        }
    }
}
