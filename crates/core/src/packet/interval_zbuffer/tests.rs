//! Which rays the interval z-buffer leaves undecided, and which cells it culls.

use super::depth_merge::DepthMerge;
use super::edge_functions::EdgeFunctions;
use super::*;
use crate::bvh::Accel;
use crate::camera::{Camera, ImagePlane, Placement, Projection};
use crate::hit::Precision;
use crate::num::simd::Plain;
use crate::packet::cast_tests::waves;
use crate::packet::decisions::Decisions;
use crate::triangle::clip::Clip;
use glam::DVec3;

/// A triangle whose edge functions are constant.
fn flat(edge: f32, depth_key: [f32; 3]) -> EdgeFunctions {
    EdgeFunctions {
        primitive: 7,
        edges: [[edge, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
        edge_error: 0.25,
        depth_key,
        depth_key_error: 0.25,
    }
}

fn decisions<'a>(accel: &'a Accel, clip: &'a Clip) -> Decisions<'a> {
    let plane = ImagePlane::new(32, 32, 0.1).expect("a good plane");
    let placement = Placement {
        eye: DVec3::Z,
        target: DVec3::ZERO,
        up: DVec3::Y,
    };
    let camera = Camera::new(placement, Projection::Perspective, plane);
    // Fast casting makes no exact decisions about planes.
    Decisions::new(accel, clip, &camera, Precision::Fast)
}

fn undecided(zbuffer: &IntervalZBuffer) -> usize {
    let stored = zbuffer.primitives.iter();
    stored.filter(|&&stored| stored == UNDECIDED).count()
}

/// Edge functions within their error bound of zero leave rays undecided, in cells and in rows. Without the bound they
/// would be decided.
#[test]
fn edges_within_their_error_are_undecided() {
    let (accel, clip) = (waves(1, 1.0, DVec3::ZERO), Clip::NONE);
    let mut decisions = decisions(&accel, &clip);
    for (edge, expected) in [(0.125, true), (-0.125, true), (0.5, false), (-0.5, false)] {
        let functions = flat(edge, [1.0, 0.0, 0.0]);
        let mut zbuffer = IntervalZBuffer::new();
        zbuffer.clear(Plain, 32, 32, f32::INFINITY);
        zbuffer.rasterize_cells(Plain, &functions, (0, 0), (31, 31), &mut decisions);
        assert_eq!(
            undecided(&zbuffer),
            if expected { RAYS } else { 0 },
            "{edge}"
        );
        zbuffer.clear(Plain, 32, 32, f32::INFINITY);
        zbuffer.rasterize_rows(Plain, &functions, 0, 8, &mut decisions);
        assert_eq!(undecided(&zbuffer), if expected { 64 } else { 0 }, "{edge}");
        zbuffer.clear(Plain, 32, 32, f32::INFINITY);
        zbuffer.mark_undecided(&functions, (0, 0), (0, 7), (0, 7));
        // The sign of another edge is sure: where this edge surely has the opposite sign no ray hits the triangle.
        assert_eq!(undecided(&zbuffer), if edge < -0.25 { 0 } else { 64 });
    }
}

/// A cell is occluded only where all its rays surely have a nearer hit: by the greatest depth key of the triangle in
/// the cell, plus the error bound.
#[test]
fn cells_that_may_hold_a_first_hit_are_not_occluded() {
    let (accel, clip) = (waves(1, 1.0, DVec3::ZERO), Clip::NONE);
    let mut decisions = decisions(&accel, &clip);
    // The least lower bound of the stored depths is 0.75.
    for (depth_key, expected) in [
        ([0.4375, 0.0, 0.0], 0),
        ([0.625, 0.0, 0.0], 64),
        ([0.0, 0.125, 0.0], 32),
    ] {
        let mut zbuffer = IntervalZBuffer::new();
        zbuffer.clear(Plain, 32, 32, f32::INFINITY);
        let first = flat(1.0, [1.0, 0.0, 0.0]);
        zbuffer.rasterize_cells(Plain, &first, (0, 0), (7, 7), &mut decisions);
        zbuffer.update_hi_z(Plain);
        let second = EdgeFunctions {
            primitive: 9,
            ..flat(1.0, depth_key)
        };
        zbuffer.rasterize_cells(Plain, &second, (0, 0), (7, 7), &mut decisions);
        assert_eq!(undecided(&zbuffer), expected, "{depth_key:?}");
    }
}

/// Intervals that share a number leave the order undecided, and so does a depth where rays may start.
#[test]
fn intervals_that_touch_are_undecided() {
    let functions = EdgeFunctions {
        primitive: 7,
        edges: [[0.0; 3]; 3],
        edge_error: 0.0,
        depth_key: [0.0; 3],
        depth_key_error: 0.25,
    };
    let merge = DepthMerge::new(Plain, &functions, 8.0);
    let near = [2.25, 2.5, 0.75, 0.5, 1.5, 7.75, 8.25, 8.5];
    let (mut low, mut high) = ([1.0; ROW], [2.0; ROW]);
    let mut primitives = [3; ROW];
    let undecided = merge.row(
        Plain,
        Plain.load(&near),
        None,
        &mut low,
        &mut high,
        &mut primitives,
    );
    // Intervals that touch from the front, lie in front, touch from behind, lie behind, lie within; touch the start
    // of rays from either side, and lie behind it.
    assert_eq!(undecided.rays, 0b0111_0101);
    assert_eq!(undecided.inside, 0b0001_1111);
    assert_eq!(primitives, [3, 7, 3, 3, 3, 3, 3, 3]);
    assert_eq!(low, [2.0, 2.25, 1.0, 1.0, 1.25, 1.0, 1.0, 1.0]);
    assert_eq!(high, [2.5, 2.75, 2.0, 2.0, 2.0, 8.0, 8.5, 2.0]);
}
