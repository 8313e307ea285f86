use super::*;
use raycast_core::glam::DVec3;
use raycast_core::shade::Mode;

fn do_all(state: &mut State, commands: impl IntoIterator<Item = Command>) {
    for command in commands {
        update(state, command);
    }
}

#[test]
fn half_the_step_doubles_the_resolution_where_the_frame_stays() {
    let mut state = State {
        viewport: (800, 600),
        ..State::default()
    };
    let before = state.plane().expect("a good plane");
    update(&mut state, Command::ScaleStep(0.5));
    let after = state.plane().expect("a good plane");
    assert_eq!((after.columns, after.rows), (1600, 1200));
    assert!((after.frame_height() - before.frame_height()).abs() < 1e-12);
    // There and back, by way of rows that are no whole numbers: it fits the window again.
    for factor in [8.0, 2.0, 0.5, 0.25] {
        update(&mut state, Command::ScaleStep(factor));
    }
    assert_eq!(state.resolution, Resolution::Window { density: 1.0 });
    assert_eq!(state.fov, DEFAULT_FOV);
}

#[test]
fn half_the_step_zooms_in_where_the_resolution_stays() {
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let mut state = State {
            viewport: (800, 600),
            lock: FrameLock::KeepResolution,
            projection,
            ..State::default()
        };
        let before = state.plane().expect("a good plane");
        update(&mut state, Command::SetStep(before.step / 2.0));
        let after = state.plane().expect("a good plane");
        assert_eq!((after.columns, after.rows), (800, 600));
        assert!((after.step - before.step / 2.0).abs() < before.step * 1e-12);
        let lens_changed = (state.fov - DEFAULT_FOV).abs() > 1.0;
        assert_eq!(lens_changed, projection == Projection::Perspective);
    }
}

#[test]
fn a_fixed_size_keeps_the_frame() {
    let mut state = State::default();
    let frame = state.frame_height();
    update(&mut state, Command::SetSize(320, 200));
    let plane = state.plane().expect("a good plane");
    assert_eq!((plane.columns, plane.rows), (320, 200));
    assert!((plane.frame_height() - frame).abs() < 1e-12);
    update(&mut state, Command::FitWindow);
    assert_eq!(state.size(), state.viewport);
}

#[test]
fn what_the_window_cannot_show_is_an_error_and_changes_nothing() {
    let mut state = State::default();
    let before = state.plane();
    update(&mut state, Command::SetSize(60_000, 10));
    update(&mut state, Command::ScaleStep(1e-3));
    update(&mut state, Command::SetStep(f64::NAN));
    update(&mut state, Command::SetStep(-1.0));
    assert_eq!(state.plane(), before);
    assert_eq!(state.errors.len(), 4, "{:?}", state.errors);
    assert!(state.errors[0].contains("raycast render"));
}

#[test]
fn a_pan_moves_the_target_with_the_cursor() {
    let mut state = State::default();
    let target = state.orbit.pivot;
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
            projection,
            ..State::default()
        };
        state.fit();
        let at = (200.0, 150.0);
        // With nothing to meet, the place is on the plane through the target.
        let camera = state.camera().expect("a camera");
        let ray = camera.ray(at.0, at.1);
        let depth = (state.orbit.pivot - ray.origin).dot(camera.forward());
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
            assert!(state.camera().is_some(), "{factor}: {:?}", state.orbit);
            assert!(state.orbit.pivot.is_finite());
        }
    }
}

#[test]
fn reset_forgets_where_the_camera_went() {
    let mut state = State::default();
    state.fit();
    let first = state.orbit;
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
    assert_eq!(state.orbit, first);
    assert!(state.orbit.pivot.distance(DVec3::ZERO) < 1e-12);
}

#[test]
fn modes_and_lines_are_apart() {
    let mut state = State::default();
    update(&mut state, Command::SetWireframe(true));
    update(&mut state, Command::SetMode(Mode::Depth));
    assert_eq!(state.settings.shading.mode, Mode::Depth);
    assert!(state.settings.shading.wireframe.is_some());
    update(&mut state, Command::SetWireframe(false));
    assert!(state.settings.shading.wireframe.is_none());
    update(&mut state, Command::SetWireframeWidth(3.0));
    assert_eq!(
        state.settings.shading.wireframe.map(|lines| lines.width),
        Some(3.0)
    );
}

#[test]
fn a_bad_file_leaves_everything_as_it_was() {
    let mut state = State::default();
    let before = (state.orbit, state.settings, state.plane());
    let news = || News::Failed("bad.obj:3: expected a number, found \"x\"".to_owned());
    receive(&mut state, news(), Duration::ZERO);
    receive(&mut state, news(), Duration::ZERO);
    assert_eq!((state.orbit, state.settings, state.plane()), before);
    assert_eq!(state.errors.len(), 1, "the same error twice is one banner");
    update(&mut state, Command::Dismiss);
    assert!(state.errors.is_empty());
}

#[test]
fn the_path_line_outlives_a_desktop_without_dialogs() {
    let mut state = State::default();
    let effect = update(&mut state, Command::Ask(PromptKind::Open));
    assert_eq!(effect, Some(Effect::Dialog(PromptKind::Open)));
    let news = News::Dialog(PromptKind::Open, DialogAnswer::Unavailable);
    receive(&mut state, news, Duration::ZERO);
    assert!(state.prompt.as_ref().is_some_and(|prompt| !prompt.dialog));
    update(&mut state, Command::TypePath(" mesh.obj ".to_owned()));
    let effect = update(&mut state, Command::ConfirmPath);
    assert_eq!(effect, Some(Effect::Open(vec![PathBuf::from("mesh.obj")])));
    assert!(state.prompt.is_none());
}

#[test]
fn a_dialogs_answer_counts_only_while_it_is_awaited() {
    let mut state = State::default();
    let path = PathBuf::from("mesh.obj");
    let answer = || News::Dialog(PromptKind::Open, DialogAnswer::Path(path.clone()));
    assert_eq!(receive(&mut state, answer(), Duration::ZERO), None);
    update(&mut state, Command::Ask(PromptKind::Open));
    assert_eq!(
        receive(&mut state, answer(), Duration::ZERO),
        Some(Effect::Open(vec![path.clone()]))
    );
}

#[test]
fn a_picture_needs_a_name_that_says_its_kind() {
    let mut state = State::default();
    update(&mut state, Command::Ask(PromptKind::Save));
    update(&mut state, Command::TypePath("picture.doc".to_owned()));
    assert_eq!(update(&mut state, Command::ConfirmPath), None);
    assert!(state.prompt.is_some() && state.errors.len() == 1);
    update(&mut state, Command::TypePath("picture.PNG".to_owned()));
    assert_eq!(
        update(&mut state, Command::ConfirmPath),
        Some(Effect::Save(PathBuf::from("picture.PNG")))
    );
}

#[test]
fn a_picture_replaces_a_file_when_the_person_says_so() {
    let mut state = State::default();
    let path = PathBuf::from("picture.png");
    let ask = |state: &mut State| {
        let news = News::Taken(path.clone());
        assert_eq!(receive(state, news, Duration::ZERO), None);
        assert_eq!(state.replacing.as_ref(), Some(&path));
    };
    ask(&mut state);
    update(&mut state, Command::Dismiss);
    assert_eq!(state.replacing, None);
    ask(&mut state);
    assert_eq!(
        update(&mut state, Command::ReplacePicture(path.clone())),
        Some(Effect::Replace(path.clone()))
    );
    assert_eq!(state.replacing, None);

    // The desktop's dialog has asked already.
    update(&mut state, Command::Ask(PromptKind::Save));
    let answer = News::Dialog(PromptKind::Save, DialogAnswer::Path(path.clone()));
    assert_eq!(
        receive(&mut state, answer, Duration::ZERO),
        Some(Effect::Replace(path))
    );
}

#[test]
fn escape_closes_the_topmost_first() {
    let mut state = State::default();
    state.errors.push("an error".to_owned());
    do_all(
        &mut state,
        [Command::Ask(PromptKind::Open), Command::ToggleHelp],
    );
    update(&mut state, Command::Dismiss);
    assert!(!state.help && state.prompt.is_some());
    update(&mut state, Command::Dismiss);
    assert!(state.prompt.is_none() && state.errors.len() == 1);
    update(&mut state, Command::Dismiss);
    assert!(state.errors.is_empty());
}

#[test]
fn toasts_go_after_a_while() {
    let mut state = State::default();
    receive(
        &mut state,
        News::Saved("a.png".into()),
        Duration::from_secs(1),
    );
    assert!(expire_toasts(&mut state, Duration::from_secs(3)).is_some());
    assert_eq!(state.toasts.len(), 1);
    assert_eq!(expire_toasts(&mut state, Duration::from_secs(7)), None);
    assert!(state.toasts.is_empty());
}

#[test]
fn grids_stay_within_what_can_be_tracked() {
    let mut state = State::default();
    update(&mut state, Command::SetGrid(Grid::Size(0)));
    let (columns, rows) = state.tile_counts();
    assert!(u64::from(columns) * u64::from(rows) <= TILES_LIMIT);
    update(
        &mut state,
        Command::SetGrid(Grid::Count {
            columns: 0,
            rows: 100_000,
        }),
    );
    assert_eq!(state.tile_counts(), (1, 256));
}
