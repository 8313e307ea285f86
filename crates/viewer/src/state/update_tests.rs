use super::*;
use crate::state::document::{Document, Tree};
use crate::state::effect::Keep;
use crate::state::motion;
use crate::state::news::{DialogAnswer, Loaded, News, expire_toasts, receive};
use crate::state::viewpoint::{DEFAULT_FOV, StandardView, Viewpoint};
use crate::state::{Answer, Replacing, TILES_LIMIT};
use raycast_core::Accel;
use raycast_core::camera::{FrameLock, Grid, Placement, Projection};
use raycast_core::formats::CameraFile;
use raycast_core::glam::DVec3;
use raycast_core::scene::{Color, ColorRule, Mesh, MeshData, Object, Scene};
use raycast_core::shade::Mode;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

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
    assert_eq!(state.viewpoint.fov, DEFAULT_FOV);
}

#[test]
fn half_the_step_zooms_in_where_the_resolution_stays() {
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let mut state = State {
            viewport: (800, 600),
            lock: FrameLock::KeepResolution,
            viewpoint: Viewpoint {
                projection,
                ..Viewpoint::default()
            },
            ..State::default()
        };
        let before = state.plane().expect("a good plane");
        update(&mut state, Command::SetStep(before.step / 2.0));
        let after = state.plane().expect("a good plane");
        assert_eq!((after.columns, after.rows), (800, 600));
        assert!((after.step - before.step / 2.0).abs() < before.step * 1e-12);
        let lens_changed = (state.viewpoint.fov - DEFAULT_FOV).abs() > 1.0;
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
    let before = (state.viewpoint.orbit, state.settings, state.plane());
    let news = || News::Failed("bad.obj:3: expected a number, found \"x\"".to_owned());
    receive(&mut state, news(), Duration::ZERO);
    receive(&mut state, news(), Duration::ZERO);
    assert_eq!(
        (state.viewpoint.orbit, state.settings, state.plane()),
        before
    );
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
    assert_eq!(
        effect,
        Some(Effect::Open(vec![PathBuf::from("mesh.obj")], Keep::Nothing))
    );
    assert!(state.prompt.is_none());
}

#[test]
fn a_dialogs_answer_counts_only_while_it_is_awaited() {
    let mut state = State::default();
    let path = PathBuf::from("mesh.obj");
    let answer = || News::Dialog(PromptKind::Open, DialogAnswer::Paths(vec![path.clone()]));
    assert_eq!(receive(&mut state, answer(), Duration::ZERO), None);
    update(&mut state, Command::Ask(PromptKind::Open));
    assert_eq!(
        receive(&mut state, answer(), Duration::ZERO),
        Some(Effect::Open(vec![path.clone()], Keep::Nothing))
    );
}

#[test]
fn a_picture_needs_a_name_that_says_its_kind() {
    let mut state = opened(1);
    update(&mut state, Command::Ask(PromptKind::Picture));
    update(&mut state, Command::TypePath("picture.doc".to_owned()));
    assert_eq!(update(&mut state, Command::ConfirmPath), None);
    assert!(state.prompt.is_some() && state.errors.len() == 1);
    update(&mut state, Command::TypePath("picture.PNG".to_owned()));
    assert_eq!(
        update(&mut state, Command::ConfirmPath),
        Some(Effect::SavePicture {
            path: PathBuf::from("picture.PNG"),
            replace: false
        })
    );
}

#[test]
fn a_file_is_replaced_when_the_person_says_so() {
    let mut state = opened(1);
    let path = PathBuf::from("picture.png");
    let ask = |state: &mut State| {
        let replacing = Replacing {
            path: path.clone(),
            scene: false,
        };
        let news = News::Taken(replacing.clone());
        assert_eq!(receive(state, news, Duration::ZERO), None);
        assert_eq!(state.replacing.as_ref(), Some(&replacing));
    };
    let replaced = || Effect::SavePicture {
        path: path.clone(),
        replace: true,
    };
    ask(&mut state);
    update(&mut state, Command::Dismiss);
    assert_eq!(state.replacing, None);
    ask(&mut state);
    assert_eq!(update(&mut state, Command::Replace), Some(replaced()));
    assert_eq!(state.replacing, None);

    // The desktop's dialog has asked already.
    update(&mut state, Command::Ask(PromptKind::Picture));
    let answer = DialogAnswer::Paths(vec![path.clone()]);
    let news = News::Dialog(PromptKind::Picture, answer);
    assert_eq!(receive(&mut state, news, Duration::ZERO), Some(replaced()));
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
        News::PictureSaved("a.png".into()),
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

/// A window on so many triangles beside one another, an object each, that came from files.
fn opened(count: usize) -> State {
    let mut state = State::default();
    state.preferences.smooth = false;
    receive(&mut state, loaded(count, None), Duration::ZERO);
    state
}

fn loaded(count: usize, camera: Option<CameraFile>) -> News {
    let mesh = Arc::new(Mesh::new(MeshData {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
        triangles: vec![[0, 1, 2]],
        ..MeshData::default()
    }));
    let object = |number: usize| {
        let mut object = Object::new(format!("object {number}"), Arc::clone(&mesh));
        object.transform.translate = DVec3::X * 2.0 * number as f64;
        object.source = Some(std::env::temp_dir().join("mesh.obj"));
        object
    };
    let scene = Arc::new(Scene {
        objects: (0..count).map(object).collect(),
    });
    News::Loaded(Box::new(Loaded {
        document: Document {
            number: 1,
            name: "mesh.obj".to_owned(),
            paths: vec!["mesh.obj".into()],
            opened: Vec::new(),
            animation: None,
            file: None,
            read: Arc::clone(&scene),
            built: Arc::clone(&scene),
            edits: 0,
            accel: Arc::new(Accel::build(&scene).expect("a valid scene")),
            bounds: scene.bounds(),
            scene,
            load_time: Duration::ZERO,
            build_time: Duration::ZERO,
        },
        keep: Keep::Nothing,
        camera,
        samples: None,
        shading: None,
        notes: Vec::new(),
        errors: Vec::new(),
    }))
}

fn document(state: &State) -> &Document {
    state.document.as_ref().expect("a scene")
}

fn names(state: &State) -> Vec<&str> {
    let objects = document(state).scene.objects.iter();
    objects.map(|object| object.name.as_str()).collect()
}

fn visible(state: &State) -> Vec<bool> {
    let objects = document(state).scene.objects.iter();
    objects.map(|object| object.visible).collect()
}

/// Does what the worker does.
fn build(state: &mut State) {
    let scene = Arc::clone(&document(state).scene);
    let tree = Tree {
        accel: Arc::new(Accel::build(&scene).expect("a valid scene")),
        bounds: scene.bounds(),
        build_time: Duration::ZERO,
    };
    receive(state, News::Built(scene, tree), Duration::ZERO);
}

#[test]
fn a_scene_is_shown_as_its_file_says_and_nothing_stays_of_the_last() {
    let mut state = opened(1);
    let first = state.viewpoint;
    let camera = CameraFile {
        placement: Placement::towards(DVec3::new(0.0, 3.0, 9.0), DVec3::ZERO),
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
fn hiding_asks_for_a_tree_and_the_last_picture_stays_until_it_is_there() {
    let mut state = opened(3);
    let edits = document(&state).edits;
    let hide = Command::SetVisible(1, false);
    assert_eq!(update(&mut state, hide), Some(Effect::Build));
    assert!(!document(&state).is_built() && document(&state).edits == edits);
    // Undone before the tree is there: the old one holds again, and the new one is not taken.
    let late = Arc::clone(&document(&state).scene);
    assert_eq!(update(&mut state, Command::Undo), None);
    assert!(document(&state).is_built());
    let tree = Tree {
        accel: Arc::new(Accel::build(&late).expect("a valid scene")),
        bounds: late.bounds(),
        build_time: Duration::ZERO,
    };
    receive(&mut state, News::Built(late, tree), Duration::ZERO);
    assert_eq!(document(&state).accel.len(), 3);

    update(&mut state, Command::Redo);
    build(&mut state);
    assert_eq!(
        (document(&state).accel.len(), visible(&state)),
        (2, vec![true, false, true])
    );
    update(&mut state, Command::Isolate(2));
    assert_eq!(visible(&state), [false, false, true]);
    update(&mut state, Command::Isolate(2));
    assert_eq!(visible(&state), [true; 3], "alone already: all are shown");
}

#[test]
fn objects_are_renamed_duplicated_and_deleted_and_all_of_it_is_undone() {
    let mut state = opened(3);
    // The last one moves with the second.
    let mut scene = Scene::clone(&document(&state).scene);
    scene.objects[2].parent = Some(1);
    if let Some(document) = &mut state.document {
        document.set_scene(Arc::new(scene));
        document.read = Arc::clone(&document.scene);
    }
    update(&mut state, Command::Rename(0, " lid ".to_owned()));
    assert_eq!(names(&state), ["lid", "object 1", "object 2"]);
    assert!(state.has_unsaved());
    assert_eq!(
        update(&mut state, Command::Duplicate(0)),
        Some(Effect::Build)
    );
    assert_eq!(names(&state), ["lid", "lid copy", "object 1", "object 2"]);
    assert_eq!(document(&state).scene.objects[3].parent, Some(2));
    assert_eq!(state.selected, Some(1));
    build(&mut state);
    assert_eq!(document(&state).accel.len(), 4, "the copy stands beside it");
    update(&mut state, Command::Delete(2));
    assert_eq!(names(&state), ["lid", "lid copy"], "and what moves with it");
    for expected in [4, 3] {
        update(&mut state, Command::Undo);
        assert_eq!(names(&state).len(), expected);
    }
    update(&mut state, Command::Undo);
    assert_eq!(names(&state)[0], "object 0");
    assert!(!state.has_unsaved(), "back at what was opened");
    for command in [
        Command::Delete(9),
        Command::Duplicate(9),
        Command::Isolate(9),
    ] {
        assert_eq!(update(&mut state, command), None);
    }
    assert_eq!(
        state.history.undo_name(),
        None,
        "what changes nothing is no step"
    );
}

#[test]
fn looks_are_undone_by_name_and_a_dragged_color_is_one_step() {
    let mut state = opened(2);
    update(&mut state, Command::SetMode(Mode::Depth));
    for red in [10, 20, 30] {
        state.now += Duration::from_millis(30);
        let rule = ColorRule::Uniform(Color([red, 0, 0]));
        assert_eq!(
            update(&mut state, Command::SetColorRule(Some(1), rule)),
            None
        );
    }
    assert!(document(&state).is_built(), "colors need no other tree");
    assert_eq!(state.history.undo_name(), Some("Change of color"));
    update(&mut state, Command::Undo);
    assert_eq!(document(&state).scene.objects[1].color, ColorRule::File);
    assert_eq!(state.history.undo_name(), Some("Change of mode"));
    update(&mut state, Command::Undo);
    assert_eq!(state.settings.shading.mode, Mode::default());
    update(&mut state, Command::Redo);
    assert_eq!(state.settings.shading.mode, Mode::Depth);
    // The camera has a history of its own.
    update(&mut state, Command::Look(StandardView::Top));
    assert_eq!(state.history.undo_name(), Some("Change of mode"));
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
fn a_click_pins_what_is_there_with_its_values() {
    let mut state = opened(2);
    update(&mut state, Command::Look(StandardView::Front));
    update(&mut state, Command::Fit);
    let camera = state.camera().expect("a camera");
    let at = camera
        .project(DVec3::new(2.25, 0.5, 0.0))
        .expect("in front");
    update(&mut state, Command::Pin { at });
    let pinned = state.pinned.clone().expect("the second triangle");
    assert_eq!(
        (pinned.object.as_str(), pinned.normal),
        ("object 1", DVec3::Z)
    );
    assert!(pinned.pick.point.distance(DVec3::new(2.25, 0.5, 0.0)) < 1e-9);
    assert_eq!(pinned.corners[1], DVec3::new(3.0, 0.0, 0.0));
    assert_eq!(state.selected, Some(1));
    let copied = update(&mut state, Command::Copy("2.25".to_owned()));
    assert_eq!(copied, Some(Effect::Copy("2.25".to_owned())));
    update(&mut state, Command::Pin { at: (1.0, 1.0) });
    assert!(state.pinned.is_none() && state.selected.is_none());
}

#[test]
fn unsaved_changes_are_asked_for_before_they_are_lost() {
    let mut state = opened(1);
    let other = || Command::Open(vec!["other.obj".into()]);
    let opens = || Some(Effect::Open(vec!["other.obj".into()], Keep::Nothing));
    assert_eq!(update(&mut state, other()), opens(), "nothing was changed");
    update(&mut state, Command::Rename(0, "lid".to_owned()));
    assert_eq!(update(&mut state, other()), None);
    assert_eq!(
        state.question,
        Some(Pending::Open(vec!["other.obj".into()]))
    );
    update(&mut state, Command::Answer(Answer::Stay));
    assert_eq!(state.question, None);

    update(&mut state, other());
    assert_eq!(
        update(&mut state, Command::Answer(Answer::Discard)),
        opens()
    );

    // Saved first: the scene has no file yet, so one is asked for.
    assert_eq!(update(&mut state, Command::Close), None);
    let asks = Some(Effect::Dialog(PromptKind::Scene));
    assert_eq!(update(&mut state, Command::Answer(Answer::Save)), asks);
    update(&mut state, Command::TypePath("lid".to_owned()));
    let path = PathBuf::from("lid.raycast.toml");
    let saves = Effect::SaveScene {
        path: path.clone(),
        replace: false,
    };
    assert_eq!(update(&mut state, Command::ConfirmPath), Some(saves));
    let news = News::SceneSaved(path.clone(), state.history.revision());
    assert_eq!(
        receive(&mut state, news, Duration::ZERO),
        Some(Effect::Close)
    );
    assert!(!state.has_unsaved());
    assert_eq!(document(&state).file, Some(path.clone()));

    // From now on it has a file, which is its own to write over.
    update(&mut state, Command::Rename(0, "cap".to_owned()));
    let saves = Effect::SaveScene {
        path,
        replace: true,
    };
    assert_eq!(update(&mut state, Command::SaveScene), Some(saves));
}

#[test]
fn what_was_changed_while_it_was_saved_is_not_saved() {
    let mut state = opened(1);
    update(&mut state, Command::Rename(0, "lid".to_owned()));
    let revision = state.history.revision();
    update(&mut state, Command::Rename(0, "cap".to_owned()));
    receive(
        &mut state,
        News::SceneSaved("a.raycast.toml".into(), revision),
        Duration::ZERO,
    );
    assert!(state.has_unsaved());
    update(&mut state, Command::Undo);
    assert!(!state.has_unsaved());
}

#[test]
fn a_wrong_path_can_be_mended() {
    let mut state = opened(1);
    update(&mut state, Command::Ask(PromptKind::Open));
    update(&mut state, Command::TypePath("mehs.obj".to_owned()));
    assert!(update(&mut state, Command::ConfirmPath).is_some());
    assert!(state.prompt.is_none());
    receive(
        &mut state,
        News::NotOpened("mehs.obj: no such file".to_owned()),
        Duration::ZERO,
    );
    assert_eq!(
        state.prompt.as_ref().map(|prompt| prompt.text.as_str()),
        Some("mehs.obj")
    );
    assert_eq!(state.errors.len(), 1);
    assert!(state.document.is_some(), "what was open stays");

    // One that was dropped on the window is not what was typed.
    update(&mut state, Command::ConfirmPath);
    update(&mut state, Command::Open(vec!["dropped.obj".into()]));
    receive(
        &mut state,
        News::NotOpened("dropped.obj: no such file".to_owned()),
        Duration::ZERO,
    );
    assert_eq!(state.prompt, None);
}

#[test]
fn files_come_beside_what_is_open_and_undo_takes_them_away() {
    let mut state = opened(2);
    update(&mut state, Command::Ask(PromptKind::Open));
    update(&mut state, Command::SetAdding(true));
    update(&mut state, Command::TypePath("more.obj".to_owned()));
    let added = update(&mut state, Command::ConfirmPath);
    assert_eq!(added, Some(Effect::Add(vec!["more.obj".into()])));
    let mut child = document(&state).scene.objects[0].clone();
    child.parent = Some(0);
    let news = News::Added {
        objects: vec![document(&state).scene.objects[1].clone(), child],
        opened: Vec::new(),
        paths: vec!["more.obj".into()],
        notes: Vec::new(),
        errors: vec!["worse.obj: not a mesh".to_owned()],
    };
    assert_eq!(
        receive(&mut state, news, Duration::ZERO),
        Some(Effect::Build)
    );
    let objects = &document(&state).scene.objects;
    assert_eq!((objects.len(), objects[3].parent), (4, Some(2)));
    assert_eq!(
        state.errors.len(),
        1,
        "the bad file costs nothing but a message"
    );
    assert_eq!(state.history.undo_name(), Some("Add"));
    update(&mut state, Command::Undo);
    assert_eq!(names(&state).len(), 2);
}

#[test]
fn a_file_read_again_keeps_the_camera_and_what_a_person_changed() {
    let mut state = opened(2);
    update(&mut state, Command::Look(StandardView::Top));
    update(&mut state, Command::SetMode(Mode::Normals));
    let before = state.viewpoint;
    let rule = ColorRule::Uniform(Color([1, 2, 3]));
    update(&mut state, Command::SetColorRule(Some(1), rule));
    let reads = Some(Effect::Open(vec!["mesh.obj".into()], Keep::All));
    let changed = || News::Changed("mesh.obj".into());
    assert_eq!(receive(&mut state, changed(), Duration::ZERO), reads);
    update(&mut state, Command::SetWatch(false));
    assert_eq!(receive(&mut state, changed(), Duration::ZERO), None);

    let News::Loaded(mut again) = loaded(2, None) else {
        unreachable!("it was made so");
    };
    again.keep = Keep::All;
    receive(&mut state, News::Loaded(again), Duration::ZERO);
    assert_eq!(
        (state.viewpoint, state.settings.shading.mode),
        (before, Mode::Normals)
    );
    assert_eq!(document(&state).scene.objects[1].color, rule);
    assert!(state.has_unsaved());

    // Objects that came or went cannot be told apart from the file's: that is the person's to decide.
    update(&mut state, Command::SetWatch(true));
    update(&mut state, Command::Delete(0));
    assert_eq!(receive(&mut state, changed(), Duration::ZERO), None);
    assert_eq!(update(&mut state, Command::Reload), None);
    assert_eq!(state.question, Some(Pending::Reload));
}

#[test]
fn samples_rise_by_themselves_only_where_nobody_has_set_them() {
    let mut state = opened(1);
    assert_eq!(state.rest_samples(), 16);
    assert_eq!(state.view().map(|view| view.settings.samples), Some(1));
    assert_eq!(
        state.view_at_rest().map(|view| view.settings.samples),
        Some(16)
    );
    assert!(!state.has_unsaved());
    update(&mut state, Command::ScaleStep(4.0));
    assert_eq!(state.rest_samples(), 1, "few rays stay blocks");
    update(&mut state, Command::FitWindow);
    update(&mut state, Command::SetSamples(Some(3)));
    assert_eq!(state.rest_samples(), 3);
    update(&mut state, Command::SetSamples(None));
    update(&mut state, Command::SetRefine(false));
    assert_eq!(state.rest_samples(), 1);
}
