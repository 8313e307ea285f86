//! Tests of where the camera goes.

use super::*;

#[test]
fn a_pan_moves_the_target_with_the_cursor() {
    let mut state = State::default();
    let target = state.viewpoint.orbit.pivot;
    let at = middle(&state);
    update(&mut state, Command::Grab { at });
    update(
        &mut state,
        Command::Pan {
            dx: 30.0,
            dy: -12.0,
        },
    );
    let camera = state.camera().expect("a camera");
    let (x, y) = camera.project(target).expect("in front");
    assert!((x - at.0 - 30.0).abs() < 1e-6 && (y - at.1 + 12.0).abs() < 1e-6);
}

#[test]
fn a_zoom_keeps_the_place_under_the_cursor() {
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let mut state = State {
            viewpoint: Viewpoint {
                projection,
                ..Viewpoint::default()
            },
            ..State::default()
        };
        state.viewpoint = state.fitted(state.viewpoint);
        let at = (200.0, 150.0);
        // With nothing to meet, the place is on the plane through the target.
        let camera = state.camera().expect("a camera");
        let ray = camera.ray(at.0, at.1);
        let depth = (state.viewpoint.orbit.pivot - ray.origin).dot(camera.forward());
        let point = ray.at(depth / ray.direction.dot(camera.forward()));
        let frame = state.frame_height();
        update(&mut state, Command::Zoom { at, factor: 0.5 });
        assert!((state.frame_height() / frame - 0.5).abs() < 1e-12);
        let (x, y) = state
            .camera()
            .and_then(|camera| camera.project(point))
            .expect("in front");
        assert!(
            (x - at.0).abs() < 1e-6 && (y - at.1).abs() < 1e-6,
            "{x} {y}"
        );
    }
}

#[test]
fn zooms_stop_before_numbers_do() {
    let mut state = State::default();
    for factor in [1e-9, 1e9, f64::NAN, 0.0, f64::INFINITY] {
        for _ in 0..20 {
            let at = middle(&state);
            update(&mut state, Command::Zoom { at, factor });
            assert!(
                state.camera().is_some(),
                "{factor}: {:?}",
                state.viewpoint.orbit
            );
            assert!(state.viewpoint.orbit.pivot.is_finite());
        }
    }
}

#[test]
fn reset_forgets_where_the_camera_went() {
    let mut state = State::default();
    state.viewpoint = state.fitted(state.viewpoint);
    state.home = state.viewpoint;
    let first = state.viewpoint.orbit;
    do_all(
        &mut state,
        [
            Command::Orbit {
                yaw: 50.0,
                pitch: 200.0,
            },
            Command::SetFov(10.0),
            Command::Zoom {
                at: (3.0, 4.0),
                factor: 0.2,
            },
            Command::ResetView,
        ],
    );
    assert_eq!(state.viewpoint.orbit, first);
}

#[test]
fn a_scene_is_shown_as_its_file_says_and_nothing_stays_of_the_last() {
    let mut state = opened(1);
    let first = state.viewpoint;
    let camera = CameraFile {
        pose: Pose::towards(DVec3::new(0.0, 3.0, 9.0), DVec3::ZERO),
        projection: Projection::Perspective,
        frame: 25.0,
    };
    receive(&mut state, loaded(1, Some(camera)), Duration::ZERO);
    let own = state.viewpoint;
    assert_eq!(own.fov, 25.0);
    update(&mut state, Command::SetFov(101.5));
    update(&mut state, Command::Look(StandardView::Top));
    update(&mut state, Command::SetMode(Mode::Color));
    update(&mut state, Command::ResetView);
    assert_eq!(state.viewpoint, own, "reset is the scene's own view");
    update(&mut state, Command::SetFov(101.5));
    receive(&mut state, loaded(1, None), Duration::ZERO);
    assert_eq!(state.viewpoint, first);
    assert_eq!(state.settings.shading.mode, Mode::default());
}

#[test]
fn the_camera_goes_back_and_forward() {
    let mut state = opened(1);
    let first = state.viewpoint;
    update(&mut state, Command::Look(StandardView::Top));
    update(&mut state, Command::LookBack);
    assert_eq!(state.viewpoint.orbit.pitch, -90.0);
    update(&mut state, Command::ViewBack);
    assert_eq!(state.viewpoint.orbit.pitch, 90.0);
    update(&mut state, Command::ViewBack);
    assert_eq!(state.viewpoint, first);
    update(&mut state, Command::ViewForward);
    assert_eq!(state.viewpoint.orbit.pitch, 90.0);
}

#[test]
fn a_smooth_camera_takes_its_time_and_a_hand_stops_it() {
    let mut state = opened(1);
    state.preferences.smooth = true;
    let first = state.viewpoint;
    update(&mut state, Command::Look(StandardView::Front));
    assert_eq!(state.viewpoint, first);
    state.now += motion::LENGTH / 2;
    assert!(advance(&mut state));
    let (yaw, between) = (state.viewpoint.orbit.yaw, 0.0..first.orbit.yaw);
    assert!(between.contains(&yaw) && yaw > 0.0, "{yaw}");
    update(
        &mut state,
        Command::Orbit {
            yaw: 1.0,
            pitch: 0.0,
        },
    );
    state.now += motion::LENGTH;
    assert!(!advance(&mut state));
    assert!((state.viewpoint.orbit.yaw - yaw - 1.0).abs() < 1e-9);

    update(&mut state, Command::Look(StandardView::Right));
    // Another wish on the way begins from where the first would have ended.
    update(&mut state, Command::Roll(15.0));
    state.now += motion::LENGTH;
    assert!(!advance(&mut state));
    assert_eq!(
        (state.viewpoint.orbit.yaw, state.viewpoint.roll),
        (90.0, 15.0)
    );
}

#[test]
fn a_rolled_camera_pans_along_the_picture() {
    let mut state = opened(1);
    update(&mut state, Command::Roll(40.0));
    let target = state.viewpoint.orbit.pivot;
    state.grabbed_depth = state.viewpoint.orbit.distance;
    update(
        &mut state,
        Command::Pan {
            dx: 30.0,
            dy: -12.0,
        },
    );
    let camera = state.camera().expect("a camera");
    let (x, y) = camera.project(target).expect("in front");
    let at = middle(&state);
    assert!(
        (x - at.0 - 30.0).abs() < 1e-6 && (y - at.1 + 12.0).abs() < 1e-6,
        "{x} {y}"
    );
}

#[test]
fn a_fitted_view_stays_fitted_when_the_window_changes_and_another_stays_as_it_is() {
    let mut state = opened(3);
    state.set_viewport((1000, 500));
    update(&mut state, Command::Fit);
    let (wide, home) = (state.viewpoint, state.home);
    state.set_viewport((300, 600));
    assert_ne!(state.viewpoint.orbit.distance, wide.orbit.distance);
    for corner in state.bounds().corners() {
        let camera = state.camera().expect("a camera");
        let (x, y) = camera.project(corner).expect("in front");
        assert!(
            (0.0..300.0).contains(&x) && (0.0..600.0).contains(&y),
            "{x} {y}"
        );
    }
    state.set_viewport((1000, 500));
    assert_eq!((state.viewpoint, state.home), (wide, home));

    let (yaw, pitch) = (10.0, 0.0);
    update(&mut state, Command::Orbit { yaw, pitch });
    let turned = state.viewpoint;
    state.set_viewport((300, 600));
    assert_eq!(state.viewpoint, turned);
    assert_ne!(state.home, home, "the way back leads to all of it");
}

#[test]
fn zooming_out_does_not_lose_the_scene() {
    let mut state = opened(3);
    for _ in 0..100 {
        let at = middle(&state);
        update(&mut state, Command::Zoom { at, factor: 1.5 });
    }
    let frame = state.frame_height();
    assert!(frame < 15.0 * state.extent(), "{frame} {}", state.extent());
}

#[test]
fn views_are_kept_for_a_file_and_recalled_with_it() {
    let mut state = opened(1);
    update(&mut state, Command::AddBookmark);
    let first = state.viewpoint;
    update(&mut state, Command::Look(StandardView::Top));
    let second = state.viewpoint;
    do_all(&mut state, [Command::AddBookmark, Command::AddBookmark]);
    assert_eq!(
        state.bookmarks,
        [first, second],
        "the same view is kept once"
    );
    update(&mut state, Command::GoToBookmark(0));
    assert_eq!(state.viewpoint, first);
    update(&mut state, Command::RemoveBookmark(0));
    receive(&mut state, loaded(1, None), Duration::ZERO);
    let [recalled] = state.bookmarks[..] else {
        panic!("{:?}", state.bookmarks);
    };
    let (a, b) = (recalled.pose(), second.pose());
    assert!(
        a.eye.distance(b.eye) < 1e-12 && a.up.distance(b.up) < 1e-12,
        "{a:?} {b:?}"
    );
    assert!((recalled.fov / second.fov - 1.0).abs() < 1e-12);
}

#[test]
fn a_camera_is_copied_pasted_and_typed() {
    let mut state = opened(1);
    let here = state.viewpoint;
    let Some(Effect::Copy(text)) = update(&mut state, Command::CopyCamera) else {
        panic!("it is copied");
    };
    update(&mut state, Command::Look(StandardView::Left));
    update(&mut state, Command::PasteCamera(text));
    let (a, b) = (here.pose(), state.viewpoint.pose());
    assert!(a.eye.distance(b.eye) < 1e-12 && a.target.distance(b.target) < 1e-12);
    let before = state.viewpoint;
    update(
        &mut state,
        Command::PasteCamera("a shopping list".to_owned()),
    );
    assert_eq!(state.viewpoint, before);
    let (eye, target) = (DVec3::new(4.0, 2.0, 3.0), DVec3::Y);
    update(&mut state, Command::SetPose { eye, target });
    let placed = state.viewpoint.pose();
    assert!(placed.eye.distance(eye) < 1e-12 && placed.target == target);
    update(&mut state, Command::SetPose { eye, target: eye });
    assert_eq!(state.viewpoint.pose(), placed, "that is no direction");
}

#[test]
fn walking_moves_the_eye_and_looking_around_does_not() {
    let mut state = opened(1);
    update(
        &mut state,
        Command::Walk {
            way: DVec3::Z,
            seconds: 1.0,
        },
    );
    let eye = |state: &State| state.viewpoint.pose().eye;
    let before = eye(&state);
    assert_eq!(
        before,
        opened(1).viewpoint.pose().eye,
        "only who walks goes"
    );
    do_all(
        &mut state,
        [
            Command::SetProjection(Projection::Orthographic),
            Command::SetWalk(true),
            Command::LookAround {
                yaw: 30.0,
                pitch: -10.0,
            },
        ],
    );
    assert_eq!(state.viewpoint.projection, Projection::Perspective);
    assert!(eye(&state).distance(before) < 1e-12);
    let forward = state.camera().expect("a camera").forward();
    update(&mut state, Command::ScaleWalk(2.0));
    update(
        &mut state,
        Command::Walk {
            way: DVec3::Z,
            seconds: 0.5,
        },
    );
    // Half a second at half the scene's size a second.
    let there = before + forward * (0.25 * state.extent());
    assert!(eye(&state).distance(there) < 1e-12);
    update(&mut state, Command::Dismiss);
    assert_eq!(state.walk, None);
}
