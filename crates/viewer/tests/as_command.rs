//! *Copy as command*: the line that is copied, run by a shell, writes the bytes that *Save picture* writes.

use raycast_core::Cull;
use raycast_core::camera::{Grid, PixelFilter, Projection};
use raycast_core::glam::DVec3;
use raycast_core::scene::{
    ClippingPlane, Color, ColorMap, ColorScale, TextureProjection, Transform,
};
use raycast_core::shade::{Ground, Mode};
use raycast_viewer::state::command::Command;
use raycast_viewer::state::effect::{Effect, Keep};
use raycast_viewer::state::news::{News, receive};
use raycast_viewer::state::update::update;
use raycast_viewer::state::{Answer, State};
use raycast_viewer::worker::files::{Files, Saving};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

fn wait(files: &Files) -> News {
    for _ in 0..1000 {
        if let Some(news) = files.fetch().pop() {
            return news;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    panic!("no news came");
}

/// A small window that remembers nothing.
fn empty() -> (State, Files) {
    let mut state = State {
        viewport: (160, 120),
        ..State::default()
    };
    state.preferences.smooth = false;
    (state, Files::new(Arc::new(|| {})))
}

/// A window on a mesh in a folder whose name has a blank and a quote in it.
fn opened(folder: &Path) -> (State, Files) {
    let folder = folder.join("it's a folder");
    std::fs::create_dir(&folder).expect("a folder");
    let path = folder.join("cube.obj");
    let asset = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/cube.obj");
    std::fs::copy(asset, &path).expect("a copy");
    let (mut state, files) = empty();
    open(&mut state, &files, &[path], Keep::Nothing);
    (state, files)
}

/// Copies of assets, and a scene of two of them with these lines of shading; the scene's path.
#[cfg(unix)]
fn scene_of_two(folder: &Path, shading: &str) -> PathBuf {
    for name in ["cube.obj", "torus.obj", "leopard.png"] {
        let asset = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets");
        std::fs::copy(asset.join(name), folder.join(name)).expect("a copy");
    }
    let object = |mesh: &str, more: &str| {
        format!("[[object]]\nmesh = \"{mesh}\"\ntexture = \"leopard.png\"\n{more}\n")
    };
    let text = format!(
        "[shading]\n{shading}\n{}{}",
        object("cube.obj", ""),
        object("torus.obj", "texture-projection = \"triplanar\"")
    );
    let path = folder.join("two.raycast.toml");
    std::fs::write(&path, text).expect("a scene");
    path
}

/// Opens files as F5 does, if anything is open.
fn open(state: &mut State, files: &Files, paths: &[PathBuf], keep: Keep) {
    files.open(paths.to_vec(), keep);
    receive(state, wait(files), Duration::ZERO);
    assert!(state.errors.is_empty(), "{:?}", state.errors);
}

/// Copies the command, which must write what the window saves.
#[cfg(unix)]
#[track_caller]
fn copies(state: &mut State, files: &Files, folder: &Path) {
    let Some(Effect::Copy(line)) = update(state, Command::CopyCommand) else {
        panic!("{:?} {:?}", state.errors, state.question);
    };
    let (run, saved) = both(state, files, &line, folder);
    assert!(run == saved, "{line}");
}

/// What the shell makes of the line, and what the window saves.
fn both(state: &State, files: &Files, line: &str, folder: &Path) -> (Vec<u8>, Vec<u8>) {
    let saved = folder.join("saved.png");
    let picture = Saving {
        view: state.view_at_rest().expect("a view"),
        grid: Grid::Size(32),
        threads: 1,
    };
    files.save(picture, saved.clone(), true);
    assert!(matches!(wait(files), News::PictureSaved(_)));
    let program = PathBuf::from(env!("CARGO_BIN_EXE_raycast"));
    let folder_of_program = program.parent().expect("a folder");
    let told = std::process::Command::new("/bin/sh")
        .args(["-c", line])
        .current_dir(folder)
        .env("PATH", folder_of_program)
        .output();
    let told = told.expect("a shell");
    assert!(
        told.status.success(),
        "{line}\n{}",
        String::from_utf8_lossy(&told.stderr)
    );
    let written = line
        .split(" -o ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next());
    let written = folder.join(written.expect("an output"));
    (
        std::fs::read(written).expect("what the command wrote"),
        std::fs::read(saved).expect("what the window wrote"),
    )
}

#[test]
#[cfg(unix)]
fn the_copied_command_writes_the_bytes_that_the_window_saves() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (mut state, files) = opened(folder.path());
    for command in [
        Command::Orbit {
            yaw: 13.7,
            pitch: 9.1,
        },
        Command::Roll(7.0),
        Command::Zoom {
            at: (31.0, 77.0),
            factor: 0.7,
        },
        Command::SetMode(Mode::Flat),
        Command::SetWireframe(true),
        Command::SetWireframeWidth(1.7),
        Command::SetWireframeColor(Color([200, 30, 3])),
        Command::SetWireframeEdges("polygon,silhouette".parse().expect("kinds")),
        Command::SetWireframeHidden(0.3),
        Command::SetCull(Cull::Back),
        Command::SetSamples(Some(3)),
        Command::SetPixelFilter(PixelFilter::Tent),
        Command::SetShift([0.25, -0.1]),
        Command::SetGround(Some(Ground::At(-0.3))),
    ] {
        update(&mut state, command);
    }
    for projection in [Projection::Perspective, Projection::Orthographic] {
        update(&mut state, Command::SetProjection(projection));
        let Some(Effect::Copy(line)) = update(&mut state, Command::CopyCommand) else {
            panic!("{:?}", state.errors);
        };
        let (run, saved) = both(&state, &files, &line, folder.path());
        assert!(run == saved, "{projection:?}: {line}");
    }
    // Depth in colors, fitted and over a range.
    update(&mut state, Command::SetMode(Mode::Depth));
    for range in [None, Some([0.1, 1.0 / 3.0])] {
        let scale = ColorScale {
            map: ColorMap::Turbo,
            range,
            legend: true,
        };
        update(&mut state, Command::SetColorScale(Some(scale)));
        let Some(Effect::Copy(line)) = update(&mut state, Command::CopyCommand) else {
            panic!("{:?}", state.errors);
        };
        let (run, saved) = both(&state, &files, &line, folder.path());
        assert!(run == saved, "{line}");
    }
}

#[test]
#[cfg(unix)]
fn a_changed_scene_is_saved_first_and_its_command_writes_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (mut state, files) = opened(folder.path());
    let moved = Transform {
        translate: DVec3::new(0.1, 1.0 / 3.0, -0.2),
        rotate: DVec3::new(11.0, 0.0, 1e-3),
        ..Transform::IDENTITY
    };
    let build = update(&mut state, Command::SetTransform(0, moved));
    assert_eq!(build, Some(Effect::Build));
    let document = state.document.as_ref().expect("a scene");
    files.build(Arc::clone(&document.scene), Arc::clone(&document.accel));
    receive(&mut state, wait(&files), Duration::ZERO);

    assert_eq!(update(&mut state, Command::CopyCommand), None);
    assert!(state.question.is_some(), "it is asked whether to save it");
    assert_eq!(update(&mut state, Command::Answer(Answer::Discard)), None);
    update(&mut state, Command::CopyCommand);
    let asked = update(&mut state, Command::Answer(Answer::Save));
    assert!(matches!(asked, Some(Effect::Dialog(_))), "{asked:?}");
    let path = folder.path().join("moved.raycast.toml");
    update(&mut state, Command::TypePath(path.display().to_string()));
    let Some(Effect::SaveScene { path, replace }) = update(&mut state, Command::ConfirmPath) else {
        panic!("{:?}", state.errors);
    };
    let scene = state.scene_file().expect("a scene");
    files.save_scene(scene, (path, None), state.history.revision(), replace);
    let copied = receive(&mut state, wait(&files), Duration::ZERO);
    let Some(Effect::Copy(line)) = copied else {
        panic!("{copied:?} {:?}", state.errors);
    };
    let (run, saved) = both(&state, &files, &line, folder.path());
    assert!(run == saved, "{line}");
}

#[test]
#[cfg(unix)]
fn lines_that_a_file_has_and_the_window_has_not_are_switched_off_by_the_command() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = folder.path();
    // A file among several.
    let scene = scene_of_two(at, "wireframe = true");
    let (mut state, files) = empty();
    let paths = [at.join("cube.obj"), scene.clone()];
    open(&mut state, &files, &paths, Keep::Nothing);
    assert!(state.settings.shading.wireframe.is_some());
    copies(&mut state, &files, at);
    update(&mut state, Command::SetWireframe(false));
    copies(&mut state, &files, at);
    // A scene that got lines since it was opened.
    scene_of_two(at, "");
    open(
        &mut state,
        &files,
        std::slice::from_ref(&scene),
        Keep::Nothing,
    );
    scene_of_two(at, "wireframe = true\nwireframe-width = 3.0");
    open(&mut state, &files, std::slice::from_ref(&scene), Keep::All);
    assert!(state.settings.shading.wireframe.is_none());
    copies(&mut state, &files, at);
}

#[test]
#[cfg(unix)]
fn textures_that_lie_as_no_file_says_are_saved_before_the_command_is_copied() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = folder.path();
    let scene = scene_of_two(at, "mode = \"texture\"\ntexture-projection = \"sphere\"");
    let (mut state, files) = empty();
    let paths = [at.join("cube.obj"), scene.clone()];
    open(&mut state, &files, &paths, Keep::Nothing);
    copies(&mut state, &files, at);
    let uv = TextureProjection::Uv;
    update(&mut state, Command::SetTextureProjection(uv));
    assert_eq!(update(&mut state, Command::CopyCommand), None);
    assert!(
        state.question.is_some(),
        "one projection was chosen for some"
    );
    update(&mut state, Command::Answer(Answer::Discard));

    // The same of a scene whose file has another since it was opened; once that is saved it is the file's.
    open(
        &mut state,
        &files,
        std::slice::from_ref(&scene),
        Keep::Nothing,
    );
    copies(&mut state, &files, at);
    scene_of_two(at, "mode = \"texture\"\ntexture-projection = \"plane\"");
    open(&mut state, &files, std::slice::from_ref(&scene), Keep::All);
    assert_eq!(state.settings.shading.projection, TextureProjection::Sphere);
    assert_eq!(update(&mut state, Command::CopyCommand), None);
    let asked = update(&mut state, Command::Answer(Answer::Save));
    let Some(Effect::SaveScene { path, replace }) = asked else {
        panic!("{asked:?} {:?}", state.errors);
    };
    let own = state
        .document
        .as_ref()
        .and_then(|document| document.file.clone());
    let file = state.scene_file().expect("a scene");
    files.save_scene(file, (path, own), state.history.revision(), replace);
    let copied = receive(&mut state, wait(&files), Duration::ZERO);
    let Some(Effect::Copy(line)) = copied else {
        panic!("{copied:?} {:?}", state.errors);
    };
    let (run, saved) = both(&state, &files, &line, at);
    assert!(run == saved, "{line}");
}

#[test]
#[cfg(unix)]
fn a_files_planes_and_colour_scale_are_taken_away_by_the_command_or_the_scene_is_saved() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = folder.path();
    let scale = "mode = \"depth\"\ncolor-map = \"turbo\"\ncolor-range = [1.0, 9.0]\nlegend = true";
    let scene = scene_of_two(at, scale);
    let text = std::fs::read_to_string(&scene).expect("the scene");
    let plane = "[[clip]]\nnormal = [1.0, 0.0, 0.0]\noffset = 0.1\n";
    std::fs::write(&scene, format!("{text}{plane}")).expect("a scene");
    let (mut state, files) = empty();
    // A scene that is open by itself would be saved after any change.
    let paths = [at.join("cube.obj"), scene];
    // In another window: here changed planes would be asked about.
    let reopen = |state: &mut State| {
        *state = empty().0;
        open(state, &files, &paths, Keep::Nothing);
    };
    reopen(&mut state);
    copies(&mut state, &files, at);
    // Off, which is one of the file's planes no more.
    let off = ClippingPlane {
        enabled: false,
        ..state.settings.clip.all()[0]
    };
    update(&mut state, Command::SetPlane(0, off));
    copies(&mut state, &files, at);
    for scale in [
        None,
        state.settings.shading.scale.map(|scale| ColorScale {
            range: None,
            ..scale
        }),
        state.settings.shading.scale.map(|scale| ColorScale {
            legend: false,
            ..scale
        }),
    ] {
        reopen(&mut state);
        update(&mut state, Command::SetColorScale(scale));
        assert_eq!(update(&mut state, Command::CopyCommand), None, "{scale:?}");
        assert!(
            state.question.is_some(),
            "no option takes it away: {scale:?}"
        );
        update(&mut state, Command::Answer(Answer::Discard));
    }
    // What a file has not, options say.
    scene_of_two(at, "mode = \"depth\"");
    reopen(&mut state);
    let scale = ColorScale {
        legend: true,
        ..ColorScale::default()
    };
    update(&mut state, Command::SetColorScale(Some(scale)));
    copies(&mut state, &files, at);
}

#[test]
fn a_picture_that_is_dropped_brings_its_scene_and_its_view_back() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (mut state, files) = opened(folder.path());
    for command in [
        Command::Orbit {
            yaw: 50.0,
            pitch: -20.0,
        },
        Command::SetMode(Mode::Normals),
        Command::SetSize(96, 64),
    ] {
        update(&mut state, command);
    }
    let path = folder.path().join("picture.png");
    let save = |state: &State, path: &Path| {
        let picture = Saving {
            view: state.view_at_rest().expect("a view"),
            grid: Grid::Size(32),
            threads: 1,
        };
        files.save(picture, path.to_owned(), true);
        assert!(matches!(wait(&files), News::PictureSaved(_)));
        raycast_core::picture::ImageFile::decode(&std::fs::read(path).expect("a picture"))
            .expect("an image")
            .picture
            .pixels
    };
    let pixels = save(&state, &path);
    let at = state.viewpoint;
    let drop = |state: &mut State| {
        let Some(Effect::OpenPicture(path, among)) =
            update(state, Command::DropPicture(path.clone()))
        else {
            panic!("a picture is opened");
        };
        let scene = state.document.as_ref().map(|d| Arc::clone(&d.scene));
        files.open_picture(path, scene, among);
    };
    // The scene is open: the view and the look come back.
    update(&mut state, Command::ResetView);
    update(&mut state, Command::SetMode(Mode::Depth));
    drop(&mut state);
    receive(&mut state, wait(&files), Duration::ZERO);
    let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
    assert!(near(state.viewpoint.orbit.yaw, at.orbit.yaw) && near(state.viewpoint.fov, at.fov));
    assert_eq!(state.settings.shading.mode, Mode::Normals);
    assert_eq!(state.size(), (96, 64));
    let again = save(&state, &folder.path().join("again.png"));
    let other = again.iter().zip(&pixels).filter(|(a, b)| a != b).count();
    assert!(
        other * 100 < pixels.len(),
        "{other} of {} pixels",
        pixels.len()
    );
    // Another scene is open: its own is found among the recent files.
    files.open(Vec::new(), Keep::Nothing);
    receive(&mut state, wait(&files), Duration::ZERO);
    drop(&mut state);
    for _ in 0..1000 {
        // First the scene, then what the picture tells.
        for news in files.fetch() {
            receive(&mut state, news, Duration::ZERO);
        }
        if state.settings.shading.mode == Mode::Normals {
            break;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let document = state.document.as_ref().expect("a scene");
    assert_eq!(document.name, "cube.obj");
    assert_eq!(state.settings.shading.mode, Mode::Normals);
    // It is nowhere to be found: it is said, and nothing changes.
    files.open(Vec::new(), Keep::Nothing);
    receive(&mut state, wait(&files), Duration::ZERO);
    state.preferences.recent.clear();
    drop(&mut state);
    let news = wait(&files);
    assert!(
        matches!(&news, News::NotOpened(text) if text.contains("recent files")),
        "{news:?}"
    );
}

#[test]
fn what_no_file_has_is_no_command() {
    let files = Files::new(Arc::new(|| {}));
    let mut state = State::default();
    files.open(Vec::new(), Keep::Nothing);
    receive(&mut state, wait(&files), Duration::ZERO);
    assert_eq!(update(&mut state, Command::CopyCommand), None);
    assert!(state.errors[0].contains("in no file"), "{:?}", state.errors);
}
