//! Tests of the handles: where an object gets by a drag, and what undo makes of it.

use super::*;
use crate::state::handle::{Amount, Handle, Tool};
use crate::state::turn::Turning;

/// Pixels of the picture that the handles are long.
const LENGTH: f64 = 90.0;

/// A window on three objects of which the one in the middle is marked, seen from above at a slant, with handles.
fn with_handles(tool: Tool) -> State {
    let mut state = opened_to_edit(3);
    state.viewport = (800, 600);
    do_all(
        &mut state,
        [
            Command::Look(StandardView::Isometric),
            Command::Fit,
            Command::Select(Some(1)),
            Command::SetManipulator(Some(tool)),
        ],
    );
    state
}

fn transform(state: &State) -> Transform {
    document(state).scene.objects[1].transform
}

fn middle_of(state: &State) -> DVec3 {
    let scene = &document(state).scene;
    let places = scene.world_from_objects().expect("a valid scene");
    places[1].transform_point3(scene.objects[1].mesh.bounds().center())
}

/// Where a point of the scene is in the picture.
fn seen(state: &State, point: DVec3) -> (f64, f64) {
    let camera = state.camera().expect("a camera");
    camera.project(point).expect("before the eye")
}

fn grab(state: &mut State, handle: Handle, at: (f64, f64)) {
    let length = LENGTH;
    update(state, Command::GrabHandle { handle, at, length });
}

fn bring(state: &mut State, to: (f64, f64), snaps: bool) -> Option<Effect> {
    update(state, Command::DragHandle { to, snaps })
}

#[test]
fn a_drag_along_an_axis_puts_the_point_that_was_grabbed_under_the_hand() {
    let around = [
        Panorama::Equirectangular,
        Panorama::Cylindrical,
        Panorama::Stereographic,
    ];
    let around = around.map(Projection::Panoramic);
    let flat = [Projection::Perspective, Projection::Orthographic];
    for projection in flat.into_iter().chain(around) {
        let mut state = with_handles(Tool::Move);
        update(&mut state, Command::SetProjection(projection));
        let (start, middle) = (transform(&state), middle_of(&state));
        for (axis, way) in [(0, 0.75), (1, -0.5), (2, 2.0)] {
            let manipulator = state.manipulator().expect("handles");
            let tip = manipulator.along(axis, LENGTH);
            let by = DVec3::AXES[axis] * way;
            let (from, to) = (seen(&state, tip), seen(&state, tip + by));
            grab(&mut state, Handle::Axis(axis), from);
            let effect = bring(&mut state, to, false);
            assert_eq!(effect, None, "shown at once, and weighed when it stands");
            assert!(middle_of(&state).distance(middle + by) < 1e-9, "{axis}");
            assert_eq!(
                update(&mut state, Command::ReleaseHandle),
                Some(Effect::Weigh(1))
            );
            assert_eq!(state.history.undo_name(), Some("Move"));
            update(&mut state, Command::Undo);
            assert_eq!(transform(&state), start);
        }
    }
}

#[test]
fn a_drag_of_many_steps_is_one_step_of_undo_and_comes_back_to_the_bit() {
    let mut state = with_handles(Tool::Move);
    let start = transform(&state);
    let middle = seen(&state, middle_of(&state));
    grab(&mut state, Handle::All, middle);
    for step in 1..40 {
        let step = f64::from(step);
        bring(&mut state, (middle.0 + step, middle.1 - 3.0 * step), false);
    }
    assert_ne!(transform(&state), start);
    bring(&mut state, middle, false);
    assert_eq!(transform(&state), start);
    bring(&mut state, (middle.0 + 50.0, middle.1), false);
    let there = transform(&state);
    update(&mut state, Command::ReleaseHandle);
    update(&mut state, Command::Undo);
    assert_eq!(transform(&state), start);
    assert_eq!(state.history.undo_name(), None);
    update(&mut state, Command::Redo);
    assert_eq!(transform(&state), there);
}

#[test]
fn escape_gives_a_drag_up_and_another_change_ends_it() {
    let mut state = with_handles(Tool::Move);
    let start = transform(&state);
    let at = seen(&state, middle_of(&state));
    let there = (at.0 + 60.0, at.1 + 10.0);
    grab(&mut state, Handle::All, at);
    bring(&mut state, there, false);
    update(&mut state, Command::Dismiss);
    assert_eq!(transform(&state), start);
    assert_eq!(state.history.undo_name(), None);
    assert!(state.manipulating.is_held, "the hand has not let go yet");
    bring(&mut state, there, false);
    assert_eq!(transform(&state), start, "it moves nothing any more");
    update(&mut state, Command::ReleaseHandle);
    assert!(!state.manipulating.is_held);
    assert_eq!(
        state.manipulating.tool,
        Some(Tool::Move),
        "the handles stay"
    );

    grab(&mut state, Handle::All, at);
    bring(&mut state, there, false);
    let moved = transform(&state);
    update(&mut state, Command::SetVisible(2, false));
    assert_eq!(
        (transform(&state), state.history.undo_name()),
        (moved, Some("Hide"))
    );
    do_all(&mut state, [Command::Undo, Command::Undo]);
    assert_eq!(transform(&state), start);
}

#[test]
fn a_square_moves_along_two_axes_and_ctrl_along_round_numbers() {
    let mut state = with_handles(Tool::Move);
    let middle = middle_of(&state);
    let way = DVec3::new(0.0, 0.613, -0.377);
    let (from, to) = (seen(&state, middle), seen(&state, middle + way));
    grab(&mut state, Handle::Across(0), from);
    bring(&mut state, to, false);
    assert!(middle_of(&state).distance(middle + way) < 1e-9);
    bring(&mut state, to, true);
    let moved = middle_of(&state) - middle;
    let pixel = state.manipulator().expect("handles").pixel;
    assert_eq!(moved.x, 0.0);
    for part in [moved.y, moved.z] {
        // A round number in each direction: of one step, which is 1, 2 or 5 times a power of ten.
        let steps = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5];
        let is_round = |s: &f64| (part / s - (part / s).round()).abs() < 1e-9 && *s >= 12.0 * pixel;
        assert!(steps.iter().any(is_round), "{part}");
    }
}

#[test]
fn a_ring_turns_about_its_axis_and_more_than_once_around() {
    for own in [false, true] {
        let mut state = with_handles(Tool::Turn);
        if own {
            let degrees = DVec3::new(20.0, 30.0, 40.0);
            let turned = Transform {
                rotate: degrees,
                ..transform(&state)
            };
            update(&mut state, Command::SetTransform(1, turned));
            let turning = state.turning;
            update(&mut state, Command::SetTurning(Turning { own, ..turning }));
        }
        let before = transform(&state).parent_from_object();
        let middle = middle_of(&state);
        let manipulator = state.manipulator().expect("handles");
        let [x, y, z] = manipulator.axes;
        let radius = manipulator.pixel * LENGTH;
        let spoke = |degrees: f64| {
            let (sin, cos) = raycast_core::math::sin_cos(degrees.to_radians());
            middle + (z * cos + x * sin) * radius
        };
        let from = seen(&state, spoke(0.0));
        grab(&mut state, Handle::Axis(1), from);
        for degrees in [60.0, 120.0, 180.0, 240.0, 300.0, 360.0, 400.0] {
            let to = seen(&state, spoke(degrees));
            bring(&mut state, to, false);
        }
        let Some(Amount::Turned(degrees)) = state.manipulating.drag.as_ref().map(|d| d.amount)
        else {
            panic!("a turn");
        };
        assert!((degrees - 400.0).abs() < 1e-6, "{degrees}");
        assert!(
            middle_of(&state).distance(middle) < 1e-9,
            "about its middle"
        );
        let corner = DVec3::new(0.3, 0.5, 0.7);
        // About y by 400°: from z towards x.
        let was = before.matrix3 * corner;
        let (sin, cos) = raycast_core::math::sin_cos(400_f64.to_radians());
        let (along_x, along_z) = (was.dot(x), was.dot(z));
        let expected = y * was.dot(y)
            + z * (along_z * cos - along_x * sin)
            + x * (along_x * cos + along_z * sin);
        let is = transform(&state).parent_from_object().matrix3 * corner;
        assert!(is.distance(expected) < 1e-7, "own axes: {own}");
        let to = seen(&state, spoke(400.0));
        bring(&mut state, to, true);
        let amount = state.manipulating.drag.as_ref().map(|d| d.amount);
        assert_eq!(amount, Some(Amount::Turned(405.0)), "by 15° with Ctrl");
    }
}

#[test]
fn a_ring_seen_from_its_edge_still_turns() {
    let mut state = with_handles(Tool::Turn);
    update(&mut state, Command::Look(StandardView::Front));
    let middle = middle_of(&state);
    let at = seen(&state, middle);
    grab(&mut state, Handle::Axis(1), at);
    // The near side goes to the right: about y that is the positive way, by a radian for the handle's length.
    bring(&mut state, (at.0 + LENGTH, at.1), false);
    let amount = state.manipulating.drag.as_ref().map(|drag| drag.amount);
    let Some(Amount::Turned(degrees)) = amount else {
        panic!("a turn");
    };
    assert!((degrees - 1_f64.to_degrees()).abs() < 0.5, "{degrees}");
}

#[test]
fn scaling_keeps_the_middle_and_follows_the_hand() {
    let mut state = with_handles(Tool::Scale);
    let middle = middle_of(&state);
    let manipulator = state.manipulator().expect("handles");
    let [from, to] = [LENGTH, 1.5 * LENGTH].map(|at| seen(&state, manipulator.along(0, at)));
    grab(&mut state, Handle::Axis(0), from);
    bring(&mut state, to, false);
    assert!(transform(&state).scale.distance(DVec3::new(1.5, 1.0, 1.0)) < 1e-9);
    assert!(middle_of(&state).distance(middle) < 1e-12);
    // Beyond the middle it neither mirrors nor vanishes.
    let behind = seen(&state, manipulator.along(0, -3.0 * LENGTH));
    bring(&mut state, behind, false);
    assert_eq!(transform(&state).scale.x, 0.01);
    update(&mut state, Command::ReleaseHandle);
    assert_eq!(state.history.undo_name(), Some("Scale"));
    update(&mut state, Command::Undo);
    let at = seen(&state, middle);
    grab(&mut state, Handle::All, at);
    bring(&mut state, (at.0 + LENGTH, at.1), true);
    assert_eq!(transform(&state).scale, DVec3::splat(2.0));
}

#[test]
fn a_moved_parent_takes_its_children_and_a_child_moves_along_the_scenes_axes() {
    let mut state = with_handles(Tool::Move);
    let mut scene = Scene::clone(&document(&state).scene);
    scene.objects[0].transform = Transform {
        rotate: DVec3::new(0.0, 0.0, 90.0),
        scale: DVec3::splat(2.0),
        ..Transform::IDENTITY
    };
    scene.objects[1].parent = Some(0);
    let scene = Arc::new(scene);
    if let Some(document) = &mut state.document {
        let accel = Accel::build_instances(&scene).expect("a valid scene");
        document.accel = Arc::new(accel);
        document.built = Arc::clone(&scene);
        document.scene = scene;
    }
    let middle = middle_of(&state);
    let tip = state.manipulator().expect("handles").along(0, LENGTH);
    let by = DVec3::X * 0.4;
    let (from, to) = (seen(&state, tip), seen(&state, tip + by));
    grab(&mut state, Handle::Axis(0), from);
    bring(&mut state, to, false);
    assert!(middle_of(&state).distance(middle + by) < 1e-9);
}

#[test]
fn there_are_handles_only_where_they_can_be_used() {
    let mut state = with_handles(Tool::Move);
    assert!(state.manipulator().is_some());
    update(&mut state, Command::SetLocked(1, true));
    assert!(state.manipulator().is_none(), "locked");
    update(&mut state, Command::SetLocked(1, false));
    update(&mut state, Command::SetTool(Some(Kind::Distance)));
    assert!(state.manipulator().is_none(), "measuring");
    update(&mut state, Command::SetManipulator(Some(Tool::Turn)));
    assert!(state.manipulator().is_some() && state.measuring.tool.is_none());
    update(&mut state, Command::SetVisible(1, false));
    assert!(state.manipulator().is_none(), "hidden");
    grab(&mut state, Handle::All, (1.0, 1.0));
    assert!(state.manipulating.drag.is_none());
    update(&mut state, Command::Dismiss);
    assert_eq!(state.manipulating.tool, None);
}
