//! The outline of a section: where a plane cuts triangles.

use crate::bvh::Accel;
use crate::scene::{ClippingError, ClippingPlane, ClippingPlanes};
use crate::triangle::clip::Clip;
use glam::{DVec2, DVec3};
use std::cmp::Ordering;
use std::collections::HashMap;

/// A polyline of a section's outline.
#[derive(Clone, Debug, PartialEq)]
pub struct SectionLine {
    /// The object that the polyline belongs to.
    pub object: u32,
    /// The polyline's points in world space, in order, no two neighbours equal. Seen from the removed side, lines run
    /// counter-clockwise around the inside; clockwise, of an object that is mirrored.
    pub points: Vec<DVec3>,
    /// Whether the last point is joined to the first; always so for a closed mesh.
    pub is_closed: bool,
}

/// Where the plane crosses an edge: the object, and the corners of the edge that is removed and that is kept, by
/// their coordinates' bits.
type Crossing = (u32, [[u32; 3]; 2]);

/// Where a plane cuts a tree's triangles: polylines in no particular order.
///
/// The sign of each corner's distance from the plane is exact, and a corner on the plane counts as kept. So the plane
/// cuts a triangle where some of its corners are removed and some kept, through exactly two edges. Triangles that
/// share an edge share the crossing, so the polylines of closed meshes close. A crossing is computed from its edge
/// alone: it is off the plane by a few units in the last place of the edge's longest coordinate. Polylines that
/// shrink to a point are left out.
///
/// # Errors
/// An invalid plane.
pub fn section(accel: &Accel, plane: &ClippingPlane) -> Result<Vec<SectionLine>, ClippingError> {
    let enabled = ClippingPlane {
        enabled: true,
        ..*plane
    };
    let clip = |plane| Ok(Clip::new(&ClippingPlanes::new(&[plane])?, accel.origin()));
    let (clip, other_side) = (clip(enabled)?, clip(enabled.flipped())?);
    let mut segments: HashMap<Crossing, Vec<(Crossing, [DVec3; 2])>> = HashMap::new();
    let mut stack: Vec<_> = accel.tree.root.into_iter().collect();
    while let Some(subtree) = stack.pop() {
        if let Some(index) = subtree.node() {
            let mut opened = None;
            let (boxes, children) = accel.open_any(index, &mut opened);
            for (which, child) in children.into_iter().enumerate() {
                let boxed = boxes.get(which);
                let (min, max) = (boxed.min.to_array(), boxed.max.to_array());
                if !clip.removes(min, max) && !other_side.removes(min, max) {
                    stack.push(child);
                }
            }
            continue;
        }
        for primitive in subtree.primitives() {
            if let Some([from, to]) = cut(accel, &clip, plane, primitive) {
                segments
                    .entry(from.0)
                    .or_default()
                    .push((to.0, [from.1, to.1]));
            }
        }
    }
    Ok(joined(segments))
}

/// Where the plane enters and leaves a triangle, if it cuts it. The first crossing is on the edge that runs, in the
/// triangle's order, from a removed corner to a kept one.
fn cut(
    accel: &Accel,
    clip: &Clip,
    plane: &ClippingPlane,
    primitive: u32,
) -> Option<[(Crossing, DVec3); 2]> {
    let corners = accel.corners(primitive);
    let signs = clip.signs(corners);
    let is_removed = signs.map(|sign| sign == Ordering::Less);
    let object = accel.identify(primitive).0;
    let crossing = |is_leaving: bool| {
        let edge = |i: usize| (i, (i + 1) % 3);
        let (from, to) = (0..3)
            .map(edge)
            .find(|&(from, to)| is_removed[from] != is_leaving && is_removed[to] == is_leaving)?;
        let (removed, kept) = if is_leaving { (to, from) } else { (from, to) };
        let at = |corner: usize| accel.origin() + corners[corner].as_dvec3();
        let (a, b) = (at(removed), at(kept));
        let value = |point: DVec3| plane.normal.dot(point) - plane.offset;
        let share = match signs[kept] {
            Ordering::Equal => 1.0,
            _ => (value(a) / (value(a) - value(b))).clamp(0.0, 1.0),
        };
        // Measured from the nearer end, so that the other end's rounding counts less.
        let point = if share < 0.5 {
            a + (b - a) * share
        } else {
            b + (a - b) * (1.0 - share)
        };
        let bits = |corner: usize| corners[corner].to_array().map(to_bits);
        Some(((object, [bits(removed), bits(kept)]), point))
    };
    Some([crossing(false)?, crossing(true)?])
}

/// The bits of a number, the same for both zeros.
fn to_bits(x: f32) -> u32 {
    (x + 0.0).to_bits()
}

/// Joins segments end to end.
fn joined(mut segments: HashMap<Crossing, Vec<(Crossing, [DVec3; 2])>>) -> Vec<SectionLine> {
    // Sorted, because the order of a hash map is random.
    let mut starts: Vec<Crossing> = segments.keys().copied().collect();
    starts.sort_unstable();
    // An open polyline begins where no segment ends.
    let ends: std::collections::HashSet<Crossing> =
        segments.values().flatten().map(|&(end, _)| end).collect();
    let (first, rest): (Vec<_>, Vec<_>) =
        starts.into_iter().partition(|start| !ends.contains(start));
    let mut lines = Vec::new();
    for start in first.into_iter().chain(rest) {
        while let Some(line) = line_from(start, &mut segments) {
            if line.points.len() > 1 {
                lines.push(line);
            }
        }
    }
    lines
}

fn line_from(
    start: Crossing,
    segments: &mut HashMap<Crossing, Vec<(Crossing, [DVec3; 2])>>,
) -> Option<SectionLine> {
    let (mut at, [first, second]) = segments.get_mut(&start)?.pop()?;
    let mut points = vec![first, second];
    while at != start {
        let Some((next, [_, point])) = segments.get_mut(&at).and_then(Vec::pop) else {
            break;
        };
        points.push(point);
        at = next;
    }
    let is_closed = at == start;
    points.dedup();
    if is_closed && points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    Some(SectionLine {
        object: start.0,
        points,
        is_closed,
    })
}

/// Axes within a plane: right and up for somebody who stands on the removed side and looks at the cut.
///
/// Up is Y; for a horizontal plane it is −Z seen from above, and Z from below. The axes of an axis-aligned plane are
/// coordinate axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionAxes {
    /// To the right: a unit vector.
    pub right: DVec3,
    /// Upwards: a unit vector.
    pub up: DVec3,
}

impl SectionAxes {
    /// The axes of a plane; its normal is not zero.
    pub fn of(plane: &ClippingPlane) -> Self {
        let towards = -plane.normal.normalize_or(DVec3::NEG_Z);
        // Y × towards, scaled by a power of two so that squaring it does not underflow.
        let level = DVec3::new(towards.z, 0.0, -towards.x);
        let right = match level.abs().max_element() {
            0.0 => DVec3::X,
            largest => (level / largest).normalize(),
        };
        Self {
            right,
            up: towards.cross(right),
        }
    }

    /// Coordinates of a point of the plane along the axes, in scene units from the world's origin.
    pub fn coordinates(&self, point: DVec3) -> DVec2 {
        DVec2::new(point.dot(self.right), point.dot(self.up))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::scene::{Mesh, MeshData, Object, Scene, Shape};
    use std::sync::Arc;

    fn accel(shape: &Shape) -> Accel {
        let mesh = Mesh::new(shape.mesh().expect("a shape"));
        Accel::build(&Scene::from(mesh)).expect("a valid scene")
    }

    /// The area within closed polylines; holes count negative.
    fn area(lines: &[SectionLine], plane: &ClippingPlane) -> f64 {
        let axes = SectionAxes::of(plane);
        let of = |line: &SectionLine| {
            let points: Vec<DVec2> = line.points.iter().map(|&p| axes.coordinates(p)).collect();
            let next = points.iter().cycle().skip(1);
            points
                .iter()
                .zip(next)
                .map(|(a, b)| a.perp_dot(*b))
                .sum::<f64>()
                * 0.5
        };
        lines.iter().map(of).sum()
    }

    #[test]
    fn a_cubes_sections_close_also_through_its_corners_and_edges() {
        let cube = accel(&Shape::Cube {
            size: DVec3::splat(2.0),
        });
        for (normal, offset, expected) in [
            (DVec3::X, 0.25, 4.0),
            (DVec3::NEG_Y, 0.5, 4.0),
            (DVec3::new(1.0, 1.0, 1.0), 0.0, 27f64.sqrt()),
            (DVec3::new(1.0, 1.0, 0.0), 0.0, 32f64.sqrt()),
            // The removed face lies behind the plane, the opposite one on its kept side.
            (DVec3::X, -1.0, 0.0),
            (DVec3::X, 1.0, 4.0),
            (DVec3::X, 1.5, 0.0),
            // A corner alone.
            (DVec3::new(1.0, 1.0, 1.0), 3.0, 0.0),
        ] {
            let plane = ClippingPlane::new(normal, offset).expect("a plane");
            let lines = section(&cube, &plane).expect("a section");
            assert!(lines.iter().all(|line| line.is_closed), "{plane:?}");
            assert!(
                (area(&lines, &plane) - expected).abs() < 1e-9,
                "{plane:?} {lines:?}"
            );
        }
    }

    #[test]
    fn a_torus_has_a_hole_and_random_planes_close() {
        let (radius, tube) = (1.0, 0.25);
        let torus = accel(&Shape::Torus {
            radius,
            tube,
            segments: 96,
            rings: 48,
        });
        let flat = ClippingPlane::new(DVec3::Y, 0.0).expect("a plane");
        let lines = section(&torus, &flat).expect("a section");
        assert_eq!(lines.len(), 2);
        let ring = std::f64::consts::PI * ((radius + tube).powi(2) - (radius - tube).powi(2));
        assert!((area(&lines, &flat) / ring - 1.0).abs() < 0.01);
        let mut random = Random(3);
        let mut count = 0;
        for _ in 0..300 {
            let corner = torus.corners((random.unit() * torus.len() as f64) as u32)[0].as_dvec3();
            let plane = ClippingPlane::through(corner, random.point()).expect("a plane");
            let lines = section(&torus, &plane).expect("a section");
            for line in &lines {
                assert!(line.is_closed, "{plane:?}");
                // A crossing is a corner plus a fraction of an edge, each coordinate below 2: four roundings, and
                // four more of the product here.
                let off = |p: &DVec3| (plane.normal.dot(*p) - plane.offset).abs();
                let bound = 16.0 * f64::EPSILON * plane.normal.length();
                assert!(line.points.iter().all(|p| off(p) < bound));
                count += line.points.len();
            }
            assert!(area(&lines, &plane) >= -1e-12);
        }
        assert!(count > 10_000, "{count}");
    }

    #[test]
    fn instances_have_the_sections_of_one_tree() {
        let torus = Shape::Torus {
            radius: 1.0,
            tube: 0.25,
            segments: 24,
            rings: 12,
        };
        let mesh = Arc::new(Mesh::new(torus.mesh().expect("a shape")));
        let mut random = Random(9);
        let objects = (0..20).map(|number| {
            let mut object = Object::new(format!("{number}"), Arc::clone(&mesh));
            object.transform.translate = random.point() * 3.0;
            object.transform.rotate = random.point() * 90.0;
            object.transform.scale.x = if number % 3 == 0 { -1.0 } else { 1.0 };
            object.visible = number != 7;
            object
        });
        let scene = Scene {
            objects: objects.collect(),
        };
        let one = Accel::build(&scene).expect("a valid scene");
        let instances = Accel::build_instances(&scene).expect("a valid scene");
        let points = |accel: &Accel, plane: &ClippingPlane| {
            let lines = section(accel, plane).expect("a section");
            assert!(lines.iter().all(|line| line.is_closed && line.object != 7));
            let of = |line: &SectionLine| {
                let object = line.object;
                let bits = |p: &DVec3| (object, p.to_array().map(f64::to_bits));
                line.points.iter().map(bits).collect::<Vec<_>>()
            };
            let mut all: Vec<_> = lines.iter().flat_map(of).collect();
            all.sort_unstable();
            all
        };
        let mut count = 0;
        for _ in 0..20 {
            let plane = ClippingPlane::new(random.point(), random.point().x).expect("a plane");
            let expected = points(&one, &plane);
            assert_eq!(points(&instances, &plane), expected);
            count += expected.len();
        }
        assert!(count > 5000, "{count}");
    }

    #[test]
    fn an_open_meshs_line_has_two_ends_and_a_plane_beside_it_none() {
        let mesh = Mesh::new(MeshData {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::Y],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..MeshData::default()
        });
        let accel = Accel::build(&Scene::from(mesh)).expect("a valid scene");
        let plane = ClippingPlane::new(DVec3::X, 0.5).expect("a plane");
        let lines = section(&accel, &plane).expect("a section");
        let [line] = &lines[..] else {
            panic!("one line: {lines:?}");
        };
        assert!(!line.is_closed && line.points.len() == 3);
        let beside = ClippingPlane::new(DVec3::X, 2.0).expect("a plane");
        assert_eq!(section(&accel, &beside), Ok(Vec::new()));
    }

    #[test]
    fn axes_of_planes_across_axes_are_axes() {
        let of = |normal| {
            let axes = SectionAxes::of(&ClippingPlane::new(normal, 0.0).expect("a plane"));
            (axes.right, axes.up)
        };
        assert_eq!(of(DVec3::NEG_Z * 3.0), (DVec3::X, DVec3::Y));
        assert_eq!(of(DVec3::NEG_X), (DVec3::NEG_Z, DVec3::Y));
        assert_eq!(of(DVec3::NEG_Y), (DVec3::X, DVec3::NEG_Z));
        assert_eq!(of(DVec3::Y), (DVec3::X, DVec3::Z));
    }
}
