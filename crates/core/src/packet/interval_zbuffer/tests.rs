//! Which rays the interval z-buffer leaves undecided, and which cells it culls.

use super::depth_merge::DepthMerge;
use super::edge_functions::EdgeFunctions;
use super::*;
use crate::bvh::Accel;
use crate::camera::{Camera, ImagePlane, Pose, Projection};
use crate::hit::{Cull, Precision};
use crate::num::simd::{Plain, Simd};
use crate::packet::around_tests::accel;
use crate::packet::cast_tests::{build, grid, waves};
use crate::packet::decisions::Decisions;
use crate::packet::depth_reference::{DepthReference, ReferencePlane};
use crate::packet::plane_keys::SideOfPlane;
use crate::packet::plane_order::PlacesWithin;
use crate::packet::ray_rect::RayRect;
use crate::packet::setup_tests::{camera, space};
use crate::random::Random;
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

/// Fast casting makes no exact decisions about planes.
fn decisions<'a>(accel: &'a Accel, clip: &'a Clip) -> Decisions<'a> {
    decisions_of(accel, clip, Precision::Fast)
}

fn decisions_of<'a>(accel: &'a Accel, clip: &'a Clip, precision: Precision) -> Decisions<'a> {
    let plane = ImagePlane::new(32, 32, 0.1).expect("a good plane");
    let pose = Pose {
        eye: DVec3::Z,
        target: DVec3::ZERO,
        up: DVec3::Y,
    };
    let camera = Camera::new(pose, Projection::Perspective, plane);
    Decisions::new(accel, clip, &camera.whole().lattice(), precision)
}

/// Bounds from the first to the last column and row.
fn ray_box([left, right]: [i32; 2], [top, bottom]: [i32; 2]) -> RayBox {
    RayBox {
        left,
        right,
        top,
        bottom,
    }
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
        zbuffer.clear(Plain, 32, 32, [f32::INFINITY; 2]);
        zbuffer.rasterize_cells(Plain, (&functions, &[]), (0, 0), (31, 31), &mut decisions);
        assert_eq!(
            undecided(&zbuffer),
            if expected { RAYS } else { 0 },
            "{edge}"
        );
        zbuffer.clear(Plain, 32, 32, [f32::INFINITY; 2]);
        zbuffer.rasterize_rows(Plain, &functions, 0, 8, &mut decisions);
        assert_eq!(undecided(&zbuffer), if expected { 64 } else { 0 }, "{edge}");
        zbuffer.clear(Plain, 32, 32, [f32::INFINITY; 2]);
        let cell = ray_box([0, 7], [0, 7]);
        zbuffer.mark_undecided(Simd::Plain, &functions, (0, 0), cell);
        // The sign of another edge is sure: where this edge surely has the opposite sign no ray hits the triangle.
        assert_eq!(undecided(&zbuffer), if edge < -0.25 { 0 } else { 64 });
    }
}

/// Ill-conditioned triangles that any ray may hit: after so many of them the rays are left to be cast one by one, and
/// all are undecided.
#[test]
fn many_ill_conditioned_triangles_leave_all_rays_undecided() {
    let mut zbuffer = IntervalZBuffer::new();
    let functions = flat(0.125, [1.0, 0.0, 0.0]);
    let half = ray_box([0, SIDE as i32 / 2 - 1], [0, SIDE as i32 - 1]);
    for _ in 0..2 {
        zbuffer.clear(Plain, 32, 32, [f32::INFINITY; 2]);
        for _ in 0..2 * MANY_MARKS / RAYS {
            zbuffer.mark_undecided(Simd::Plain, &functions, (0, 0), half);
            assert!(!zbuffer.wants_single_rays());
        }
        zbuffer.mark_undecided(Simd::Plain, &functions, (0, 0), half);
        assert!(zbuffer.wants_single_rays());
        assert_eq!(undecided(&zbuffer), RAYS / 2);
        assert!(zbuffer.rivals(0, 0).is_some());
        zbuffer.leave_all_undecided();
        assert_eq!(undecided(&zbuffer), RAYS);
        assert!(zbuffer.rivals(0, 0).is_none());
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
        zbuffer.clear(Plain, 32, 32, [f32::INFINITY; 2]);
        let first = flat(1.0, [1.0, 0.0, 0.0]);
        zbuffer.rasterize_cells(Plain, (&first, &[]), (0, 0), (7, 7), &mut decisions);
        zbuffer.update_hi_z(Plain);
        let second = EdgeFunctions {
            primitive: 9,
            ..flat(1.0, depth_key)
        };
        zbuffer.rasterize_cells(Plain, (&second, &[]), (0, 0), (7, 7), &mut decisions);
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
    let merge = DepthMerge::new(Plain, &functions, [8.0; 2]);
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
    assert_eq!(undecided.hits, 0b0001_1111);
    assert_eq!(primitives, [3, 7, 3, 3, 3, 3, 3, 3]);
    assert_eq!(low, [2.0, 2.25, 1.0, 1.0, 1.25, 1.0, 1.0, 1.0]);
    assert_eq!(high, [2.5, 2.75, 2.0, 2.0, 2.0, 8.0, 8.5, 2.0]);
}

/// Of the triangles of one plane that a ray may hit, those after one that it surely hits are no rivals, by their primitive
/// ids: not even of a ray that another triangle's edge has left undecided.
#[test]
fn what_is_behind_a_sure_hit_is_no_rival() {
    let flat_grid = grid(2, |x, y| DVec3::new(x, y, 0.0));
    let (accel, clip) = (build([flat_grid]), Clip::NONE);
    let mut decisions = decisions_of(&accel, &clip, Precision::Exact);
    let mut random = Random(91);
    let seen_from = camera(&mut random, DVec3::ZERO, Projection::Perspective, 0.1);
    let packet = RayRect::all(&seen_from.whole().lattice());
    decisions.set_rays(&space(&seen_from, DVec3::ZERO, Cull::None), &packet);
    let mut by_id: Vec<u32> = (0..accel.len() as u32).collect();
    by_id.sort_unstable_by_key(|&primitive| accel.id(primitive));
    let mut zbuffer = IntervalZBuffer::new();
    zbuffer.clear(Plain, 32, 32, [f32::INFINITY; 2]);
    let mut merge = |zbuffer: &mut IntervalZBuffer, primitive: u32, edge: f32| {
        let functions = EdgeFunctions {
            primitive,
            ..flat(edge, [1.0, 0.0, 0.0])
        };
        zbuffer.rasterize_rows(Plain, &functions, 0, 1, &mut decisions);
    };
    // On an edge, so that nothing is sure; then two that are surely hit, the second one after the first.
    let [first, second, third, fourth] = [by_id[2], by_id[1], by_id[3], by_id[0]];
    for (primitive, edge) in [(first, 0.125), (second, 1.0), (third, 1.0), (third, 0.125)] {
        merge(&mut zbuffer, primitive, edge);
    }
    let rivals =
        |zbuffer: &IntervalZBuffer| -> Vec<u32> { zbuffer.rivals(0, 5).expect("few").collect() };
    let mut expected = vec![first, second];
    assert!(IntervalZBuffer::is_undecided(zbuffer.row(0)[5]));
    assert_eq!(rivals(&zbuffer), expected);
    // One before both is the sure hit from then on; the one before it is no rival any more.
    merge(&mut zbuffer, fourth, 1.0);
    expected[1] = fourth;
    assert_eq!(rivals(&zbuffer), expected);
    merge(&mut zbuffer, by_id[4], 1.0);
    assert_eq!(rivals(&zbuffer), expected);
}

/// Hands over decisions about a flat grid and two triangles above it, along the rays of a packet whose depth keys are
/// relative to the grid's plane, and the triangles in the order of their ids, those above last.
fn with_grid_as_reference(check: impl Fn(&mut Decisions<'_>, &[u32])) {
    let flat_grid = grid(4, |x, y| DVec3::new(x, y, 0.0));
    let raised_grid = grid(1, |x, y| DVec3::new(x, y, 0.5));
    let (accel, clip) = (build([flat_grid, raised_grid]), Clip::NONE);
    let mut decisions = decisions_of(&accel, &clip, Precision::Exact);
    let mut random = Random(92);
    let seen_from = camera(&mut random, DVec3::ZERO, Projection::Perspective, 0.1);
    let packet = RayRect::all(&seen_from.whole().lattice());
    let mut by_id: Vec<u32> = (0..accel.len() as u32).collect();
    by_id.sort_unstable_by_key(|&primitive| accel.id(primitive));
    let space = space(&seen_from, DVec3::ZERO, Cull::None);
    let plane = ReferencePlane {
        primitive: by_id[9],
        key: (space.depth_key_in_double(accel.corners(by_id[9]))).expect("a key in range"),
    };
    let reference = DepthReference::NONE.with_plane(plane, space.last);
    let space = space.relative_to(reference.expect("a key in range"));
    decisions.set_rays(&space, &packet);
    check(&mut decisions, &by_id);
}

/// A triangle is skipped where each cell that it touches is covered by a triangle of its plane with a lower id: not by one
/// with a higher id, nor by one of another plane, nor where a cell has no cover.
#[test]
fn covers_precede_later_triangles_of_their_plane_alone() {
    with_grid_as_reference(|decisions, by_id| {
        // The last two are raised.
        let [low, middle, high] = [by_id[0], by_id[3], by_id[5]];
        let other = by_id[by_id.len() - 2];
        let mut zbuffer = IntervalZBuffer::new();
        zbuffer.clear(Plain, 32, 32, [f32::INFINITY; 2]);
        let cells = 0b11 << 5;
        assert!(!zbuffer.sure_hits_precede(cells, middle, decisions));
        zbuffer.sure_hits.set(low, 5);
        zbuffer.sure_hits.set(low, 6);
        // Nothing is known of their planes yet.
        assert!(!zbuffer.sure_hits_precede(cells, middle, decisions));
        let sides = [low, middle, high, other].map(|of| decisions.side_of_reference(of));
        assert_eq!(sides[..3], [SideOfPlane::Within; 3]);
        assert_ne!(sides[3], SideOfPlane::Within);
        assert!(zbuffer.sure_hits_precede(cells, middle, decisions));
        assert!(!zbuffer.sure_hits_precede(cells | 1 << 7, middle, decisions));
        for is_no_cover in [high, other] {
            zbuffer.sure_hits.set(is_no_cover, 6);
            assert!(!zbuffer.sure_hits_precede(cells, middle, decisions));
            assert!(zbuffer.sure_hits_precede(1 << 5, middle, decisions));
        }
    });
}

/// A triangle is behind a cell's sure hits where each of these, however many they are, lies in its plane and has a lower id:
/// not where one has a higher id, where one lies in another plane, or where a ray has none.
#[test]
fn any_number_of_sure_hits_precede_later_triangles_of_their_plane() {
    with_grid_as_reference(|decisions, by_id| {
        for &primitive in by_id {
            decisions.side_of_reference(primitive);
        }
        let cell = (5, &PlacesWithin::of_cell(5));
        let raised = by_id[by_id.len() - 1];
        let [before, after] = [by_id[12], by_id[24]];
        for (odd, are_before) in [
            (by_id[3], true),
            (by_id[30], false),
            (raised, false),
            (MISS, false),
        ] {
            // Of packets as wide as they may be, and of those whose last column is within the cell.
            for (different, columns) in [(2, 32), (20, 32), (2, 12), (20, 12)] {
                let mut zbuffer = IntervalZBuffer::new();
                zbuffer.clear(Plain, columns, 32, [f32::INFINITY; 2]);
                for row in 0..ROW {
                    for column in 0..ROW.min(columns as usize - ROW) {
                        let ray = (ROW + row) * SIDE + ROW + column;
                        zbuffer.primitives[ray] = match [row, column] {
                            [5, 0] => odd,
                            _ => by_id[(row * ROW + column) % different],
                        };
                    }
                }
                // Twice: the second time the sure hits are listed.
                for _ in 0..2 {
                    if odd == raised {
                        // It may be in front of all others.
                        zbuffer.is_behind_sure_hits(after, cell, decisions);
                        continue;
                    }
                    assert_eq!(
                        zbuffer.is_behind_sure_hits(after, cell, decisions),
                        are_before
                    );
                    assert_eq!(
                        zbuffer.is_behind_sure_hits(before, cell, decisions),
                        are_before && different == 2
                    );
                }
                let precede = |primitive| zbuffer.sure_hits_precede(1 << 5, primitive, decisions);
                assert_eq!(
                    [precede(after), precede(before)],
                    [are_before, are_before && different == 2]
                );
            }
        }
    });
}

/// The bounds of depths contain those of a triangle that is nearest by an order of planes, whatever its own bounds are.
#[test]
fn a_triangle_that_wins_a_cell_widens_its_depths() {
    let mut zbuffer = IntervalZBuffer::new();
    zbuffer.clear(Plain, 20, 32, [f32::INFINITY; 2]);
    let of = |primitive: u32, depth: f32| EdgeFunctions {
        primitive,
        ..flat(1.0, [depth, 0.0, 0.125])
    };
    for (first, hi_z) in [(0, 4.75), (16, 4.75)] {
        assert_eq!(zbuffer.win(Plain, &of(3, 5.0), first), hi_z);
        // It is the nearer one, though its depths alone say nothing: at least as near, at most as far.
        assert_eq!(zbuffer.win(Plain, &of(4, 5.125), first), hi_z + 0.125);
        assert_eq!(zbuffer.win(Plain, &of(5, 5.0), first), hi_z + 0.125);
    }
    for row in 0..ROW {
        let below = row as f32 * 0.125;
        let ray = row * SIDE + ROW - 1;
        assert_eq!(zbuffer.primitives[ray], 5);
        assert_eq!(
            [zbuffer.low[ray], zbuffer.high[ray]],
            [4.875 + below, 5.375 + below]
        );
        // Beyond the packet's last column.
        assert_eq!(zbuffer.low[row * SIDE + 20], f32::INFINITY);
    }
    assert_eq!(zbuffer.row(0)[19], 5);
    assert_eq!(zbuffer.low[ROW], f32::NEG_INFINITY);
}

/// An ill-conditioned triangle leaves rays undecided that had a closest hit: a cell that was known to be decided is looked at
/// again. Where it is not, a triangle between the two wins the ray.
#[test]
fn a_cell_is_not_decided_after_an_ill_conditioned_triangle() {
    let layer = |height: f64| {
        let corner = |x: f64, y: f64| DVec3::new(x, y, height);
        [corner(-9.0, -9.0), corner(9.0, -9.0), corner(0.0, 9.0)]
    };
    let accel = accel([-2.0, -3.0, -4.0].map(layer).to_vec());
    let clip = Clip::NONE;
    let mut decisions = decisions_of(&accel, &clip, Precision::Exact);
    let plane = ImagePlane::new(32, 32, 0.1).expect("a good plane");
    let pose = Pose {
        eye: DVec3::Z,
        target: DVec3::ZERO,
        up: DVec3::Y,
    };
    let camera = Camera::new(pose, Projection::Perspective, plane);
    decisions.set_rays(
        &space(&camera, accel.origin, Cull::None),
        &RayRect::all(&camera.whole().lattice()),
    );
    let primitive = |number: u32| {
        (0..3)
            .find(|&at| accel.id(at) == number)
            .expect("a kept triangle")
    };
    let [near, middle, far] = [0, 1, 2].map(primitive);
    let cell = (0, &PlacesWithin::of_cell(0));
    for is_disturbed in [false, true] {
        let mut zbuffer = IntervalZBuffer::new();
        zbuffer.clear(Plain, 32, 32, [f32::INFINITY; 2]);
        let of_far = EdgeFunctions {
            primitive: far,
            ..flat(1.0, [0.0; 3])
        };
        zbuffer.win(Plain, &of_far, 0);
        zbuffer.sure_hits.set(far, 0);
        if is_disturbed {
            let ill_conditioned = EdgeFunctions {
                primitive: near,
                ..flat(0.0, [0.0; 3])
            };
            let ray = ray_box([3, 3], [4, 4]);
            zbuffer.mark_undecided(Simd::Plain, &ill_conditioned, (0, 0), ray);
            zbuffer.update_hi_z(Plain);
        }
        assert!(!zbuffer.is_behind_sure_hits(middle, cell, &mut decisions));
        let is_before = zbuffer.is_before_sure_hits(middle, cell, &mut decisions);
        assert_eq!(is_before, !is_disturbed);
    }
}
