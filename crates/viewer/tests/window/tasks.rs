//! Twenty everyday tasks, one after another, with files that are there and the threads that read and write them; a
//! bad file in between.

use crate::bench::{Bench, drag, open_with};
use egui::{Event, Key, Modifiers, PointerButton};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use raycast_core::formats::{read_scene, write_prepared};
use raycast_core::glam::DVec3;
use raycast_core::picture::ImageFile;
use raycast_core::scene::{Color, ColorRule, Object};
use raycast_viewer::app::effects::hand_out;
use raycast_viewer::state::State;
use raycast_viewer::state::command::Command;
use raycast_viewer::state::effect::Effect;
use raycast_viewer::state::inspection::Fault;
use raycast_viewer::state::news::receive;
use raycast_viewer::state::update::update;
use raycast_viewer::worker::files::Files;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Longer than the slowest machine takes to read a cube.
const PATIENCE: Duration = Duration::from_secs(60);

/// A window with threads that read and write, and a folder.
struct Desk {
    harness: Harness<'static, Bench>,
    files: Files,
    /// How many of the window's effects were handed out.
    done: usize,
    copied: Vec<String>,
    folder: tempfile::TempDir,
}

impl Desk {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder for temporary files");
        let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets");
        for name in [
            "cube.obj",
            "cube.mtl",
            "torus.obj",
            "torus.mtl",
            "leopard.png",
        ] {
            std::fs::copy(assets.join(name), folder.path().join(name)).expect("copied");
        }
        std::fs::write(folder.path().join("bad.obj"), "v 0 0 0\nf 1 2 x\n").expect("written");
        let mut state = State::default();
        // A harness draws no frames of a movement.
        state.preferences.smooth = false;
        Self {
            harness: open_with(state),
            files: Files::new(Arc::new(|| {})),
            done: 0,
            copied: Vec::new(),
            folder,
        }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn state(&self) -> &State {
        &self.harness.state().state
    }

    fn objects(&self) -> &[Object] {
        self.state()
            .document
            .as_ref()
            .map_or(&[], |document| &document.scene.objects)
    }

    fn names(&self) -> Vec<&str> {
        self.objects().iter().map(|o| o.name.as_str()).collect()
    }

    /// Frames and threads, until it is so.
    fn until(&mut self, what: &str, is_so: impl Fn(&Self) -> bool) {
        let start = Instant::now();
        loop {
            self.harness.run();
            let bench = self.harness.state_mut();
            let new = bench.effects.len();
            for effect in bench.effects[self.done..].iter().cloned() {
                match effect {
                    Effect::Copy(text) => self.copied.push(text),
                    // There is no desktop: paths are typed.
                    Effect::Dialog(_) => {}
                    effect => hand_out(&mut bench.state, &self.files, effect),
                }
            }
            self.done = new;
            for news in self.files.fetch() {
                let effect = receive(&mut bench.state, news, Duration::ZERO);
                bench.effects.extend(effect);
            }
            if self.done == self.harness.state().effects.len() && is_so(self) {
                return;
            }
            let state = self.state();
            let late = start.elapsed() > PATIENCE;
            assert!(!late, "not {what}: {:?} {:?}", state.errors, state.toasts);
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    fn built(&mut self, what: &str, is_so: impl Fn(&Self) -> bool) {
        self.until(what, |desk| {
            let document = desk.state().document.as_ref();
            document.is_some_and(|document| document.is_built()) && is_so(desk)
        });
    }

    fn key(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.until("done", |_| true);
    }

    fn text(&mut self, text: &str) {
        self.harness.event(Event::Text(text.to_owned()));
        self.harness.run();
    }

    fn click(&mut self, name: &str) {
        self.harness.get_by_label(name).click();
        self.until("done", |_| true);
    }

    /// Asks for a path by a key, and types it.
    fn give(&mut self, modifiers: Modifiers, key: Key, path: &Path) {
        self.key(modifiers, key);
        self.harness.run();
        self.text(&path.display().to_string());
        self.key(Modifiers::NONE, Key::Enter);
    }

    /// Runs a command by its name in the palette.
    fn run(&mut self, name: &str) {
        self.key(Modifiers::COMMAND, Key::P);
        self.text(name);
        self.key(Modifiers::NONE, Key::Enter);
    }

    fn click_at(&mut self, point: DVec3) {
        let camera = self.state().camera().expect("a camera");
        let (x, y) = camera.project(point).expect("in front");
        let picture = self.harness.get_by_label("The picture").rect();
        let at = picture.min + egui::vec2(x as f32, y as f32);
        self.harness.event(Event::PointerMoved(at));
        self.harness.run();
        for pressed in [true, false] {
            self.harness.event(Event::PointerButton {
                pos: at,
                button: PointerButton::Primary,
                pressed,
                modifiers: Modifiers::NONE,
            });
        }
        self.until("done", |_| true);
    }

    /// A file that cannot be read is told of, and changes nothing.
    fn bad_file(&mut self, modifiers: Modifiers) {
        let before = self.names().join(" ");
        let bad = self.path("bad.obj");
        self.give(modifiers, Key::O, &bad);
        self.until("told", |desk| !desk.state().errors.is_empty());
        assert!(self.state().errors[0].contains("bad.obj:2"));
        assert_eq!(self.names().join(" "), before);
        // The path line, to mend what was typed; and the message.
        for _ in 0..2 {
            self.key(Modifiers::NONE, Key::Escape);
        }
        assert!(self.state().errors.is_empty() && self.state().prompt.is_none());
    }
}

#[test]
fn twenty_everyday_tasks_are_done_by_keys_clicks_and_typed_paths() {
    let mut desk = Desk::new();
    let (plain, ctrl, shift) = (Modifiers::NONE, Modifiers::COMMAND, Modifiers::SHIFT);

    // 1, 2: open, and add; a bad file each time.
    let cube = desk.path("cube.obj");
    desk.give(ctrl, Key::O, &cube);
    desk.built("open", |desk| desk.objects().len() == 1);
    desk.bad_file(ctrl);
    let torus = desk.path("torus.obj");
    desk.give(ctrl | shift, Key::O, &torus);
    desk.built("added", |desk| desk.objects().len() == 2);
    desk.bad_file(ctrl | shift);

    // 3–6: orbit, front view, fit, walk inside.
    let start = desk.state().viewpoint;
    drag(&mut desk.harness, PointerButton::Primary, plain);
    assert_ne!(desk.state().viewpoint.orbit.yaw, start.orbit.yaw);
    desk.key(plain, Key::Num1);
    let orbit = desk.state().viewpoint.orbit;
    assert_eq!((orbit.yaw, orbit.pitch), (0.0, 0.0));
    desk.key(plain, Key::F);
    desk.key(shift, Key::W);
    let before = desk.state().viewpoint.orbit.pivot;
    desk.harness.key_down(Key::W);
    desk.harness.step();
    desk.harness.step();
    desk.harness.key_up(Key::W);
    desk.harness.run();
    assert_ne!(desk.state().viewpoint.orbit.pivot, before);
    desk.key(plain, Key::Escape);
    desk.key(plain, Key::Num1);
    desk.key(plain, Key::F);

    // 7: what is clicked on is marked, read and copied.
    let near = desk.state().document.as_ref().expect("a scene").bounds;
    let front = |desk: &Desk| {
        let bounds = desk.objects()[0].mesh.bounds();
        bounds.center() + DVec3::Z * bounds.size().z * 0.5
    };
    desk.key(plain, Key::H);
    desk.harness.get_by_label("torus").click();
    desk.until("marked", |desk| desk.state().selected == Some(1));
    desk.key(plain, Key::H);
    desk.built("hidden", |desk| !desk.objects()[1].visible);
    let point = front(&desk) + DVec3::new(0.1, 0.05, 0.0);
    desk.click_at(point);
    let pinned = desk.state().picks.current().cloned().expect("the cube");
    assert_eq!(pinned.object, "cube");
    desk.click("Copy all");
    assert!(
        desk.copied[0].starts_with("Object: cube\n"),
        "{:?}",
        desk.copied
    );

    // 8: a distance and an angle.
    desk.key(plain, Key::D);
    for x in [-0.2, 0.2] {
        let point = front(&desk) + DVec3::new(x, 0.1, 0.0);
        desk.click_at(point);
    }
    desk.key(plain, Key::A);
    for (x, y) in [(0.2, 0.1), (0.0, 0.0), (0.0, 0.2)] {
        let point = front(&desk) + DVec3::new(x, y, 0.0);
        desk.click_at(point);
    }
    assert_eq!(desk.state().measuring.list.len(), 2);
    desk.key(plain, Key::Escape);

    // 9: a cut, and its outline as a drawing.
    desk.run("Cut across X");
    assert_eq!(desk.state().settings.clip.all().len(), 1);
    desk.run("Save outline");
    let outline = desk.path("outline.svg");
    desk.text(&outline.display().to_string());
    desk.key(plain, Key::Enter);
    desk.until("written", |_| outline.exists());
    desk.key(ctrl, Key::Z);
    assert!(desk.state().settings.clip.all().is_empty());

    // 10: show, isolate, rename, duplicate, delete.
    desk.key(shift, Key::H);
    desk.built("shown", |desk| desk.objects()[1].visible);
    desk.key(plain, Key::I);
    desk.built("alone", |desk| !desk.objects()[1].visible);
    desk.key(plain, Key::I);
    desk.key(plain, Key::F2);
    desk.harness.run();
    desk.text("box");
    desk.key(plain, Key::Enter);
    desk.key(ctrl, Key::D);
    desk.built("twice", |desk| desk.names() == ["box", "box copy", "torus"]);
    desk.key(plain, Key::Delete);
    desk.built("gone", |desk| desk.names() == ["box", "torus"]);

    // 11: moved by a number, and by a handle; and made to move with another.
    desk.click("box");
    desk.click("Place");
    desk.click("Move Y");
    desk.text("0.5");
    desk.key(plain, Key::Enter);
    assert_eq!(desk.objects()[0].transform.translate.y, 0.5);
    desk.key(plain, Key::G);
    assert!(desk.state().manipulator().is_some());
    desk.key(plain, Key::Escape);
    update_to(&mut desk, Command::SetParent(1, Some(0)));
    assert_eq!(desk.objects()[1].parent, Some(0));

    // 12, 13: a colour and a texture.
    let red = ColorRule::Uniform(Color([200, 30, 30]));
    update_to(&mut desk, Command::SetColorRule(Some(0), red.clone()));
    assert_eq!(desk.objects()[0].color, red);
    desk.click("Load its texture");
    let leopard = desk.path("leopard.png");
    desk.harness.run();
    desk.text(&leopard.display().to_string());
    desk.key(plain, Key::Enter);
    desk.until("painted", |desk| desk.objects()[0].texture.is_some());
    let shown = |desk: &Desk| desk.objects()[0].texture.as_ref().and_then(|it| it.crop());
    desk.harness.run();
    desk.click("Whole image");
    desk.until("its image", |desk| {
        let image = desk.state().image.as_ref();
        image.is_some_and(|image| matches!(image.found, Ok(Some(_))))
    });
    desk.harness.run();
    desk.click("Columns of the part");
    desk.text("100");
    desk.key(plain, Key::Enter);
    desk.until("a part of it", |desk| {
        shown(desk).is_some_and(|crop| (crop.x, crop.width) == (0, 100))
    });

    // 14: the health of the mesh, and whether it passes through itself.
    desk.run("Find self-intersections");
    desk.until("searched", |desk| {
        !desk.state().inspection.checked.is_empty()
    });
    let checked = &desk.state().inspection.checked[0];
    assert!(checked.intersections.is_some());
    assert_eq!(checked.count(Fault::SelfIntersections), 0);

    // 15: all of it is taken back, and done again.
    let steps = std::iter::from_fn(|| {
        let is_left = desk.state().history.undo_name().is_some();
        is_left.then(|| desk.key(ctrl, Key::Z))
    })
    .count();
    assert!(steps > 8, "{steps}");
    desk.built("as added", |desk| desk.names() == ["cube"]);
    for _ in 0..steps {
        desk.key(ctrl, Key::Y);
    }
    desk.built("as it was", |desk| {
        desk.names() == ["box", "torus"] && desk.objects()[0].texture.is_some()
    });

    // 16, 17: saved, and opened again.
    let scene = desk.path("scene.raycast.toml");
    desk.give(ctrl, Key::S, &scene);
    desk.until("saved", |desk| {
        !desk.state().has_unsaved() && scene.exists()
    });
    let saved: Vec<_> = desk.objects().iter().map(|o| o.transform).collect();
    desk.give(ctrl, Key::O, &cube);
    desk.built("another", |desk| desk.names() == ["cube"]);
    desk.give(ctrl, Key::O, &scene);
    desk.built("open again", |desk| desk.names() == ["box", "torus"]);
    let opened: Vec<_> = desk.objects().iter().map(|o| o.transform).collect();
    assert_eq!(opened, saved);
    assert_eq!(desk.objects()[1].parent, Some(0));
    assert!(!near.is_empty());

    // A copy leaves what is open as it is.
    let copy = desk.path("copy.raycast.toml");
    desk.run("Save a copy");
    desk.text(&copy.display().to_string());
    desk.key(plain, Key::Enter);
    desk.until("copied", |_| copy.exists());
    let open = desk.state().document.as_ref().and_then(|d| d.file.clone());
    assert_eq!(open, Some(scene.clone()));
    let text = |path: &Path| std::fs::read_to_string(path).expect("text");
    assert_eq!(text(&copy), text(&scene));

    // 18: read again once its mesh has changed; half a file changes nothing.
    let mesh = std::fs::read_to_string(&cube).expect("text");
    std::fs::write(&cube, "v 0 0").expect("written");
    desk.key(plain, Key::F5);
    desk.until("told", |desk| !desk.state().errors.is_empty());
    assert_eq!(desk.names(), ["box", "torus"]);
    desk.key(plain, Key::Escape);
    std::fs::write(&cube, format!("{mesh}\nv 9 9 9\n")).expect("written");
    let vertices = desk.objects()[0].mesh.positions().len();
    desk.key(plain, Key::F5);
    desk.built("read again", |desk| {
        desk.objects()[0].mesh.positions().len() == vertices + 1
    });

    // 19, 20: a picture, and the command that makes it.
    let picture = desk.path("picture.png");
    desk.give(ctrl, Key::E, &picture);
    desk.until("written", |_| picture.exists());
    desk.key(ctrl | shift, Key::E);
    let command = desk.copied.last().expect("copied");
    assert!(command.contains("raycast render"), "{command}");
    assert!(command.contains("scene.raycast.toml"), "{command}");
}

#[test]
fn the_copied_picture_is_the_saved_one() {
    let mut desk = Desk::new();
    let cube = desk.path("cube.obj");
    update_to(&mut desk, Command::Open(vec![cube]));
    desk.built("open", |desk| desk.objects().len() == 1);
    update_to(&mut desk, Command::SetSize(64, 48));
    let copied = |desk: &Desk| {
        let effects = desk.harness.state().effects.iter();
        let mut copied = effects.filter_map(|effect| match effect {
            Effect::CopyImage(copied) => Some(Arc::clone(copied)),
            _ => None,
        });
        copied.next()
    };
    desk.key(Modifiers::ALT, Key::C);
    desk.until("copied", |desk| copied(desk).is_some());
    let copied = copied(&desk).expect("copied");
    let saved = desk.path("saved.png");
    desk.give(Modifiers::COMMAND, Key::E, &saved);
    desk.until("written", |_| saved.exists());
    let saved = ImageFile::decode(&std::fs::read(saved).expect("bytes")).expect("a picture");
    assert_eq!(copied.size, (64, 48));
    assert!(copied.pixels == saved.picture.pixels);
}

#[test]
fn a_mesh_stands_upright_once_z_is_said_to_be_up() {
    let mut desk = Desk::new();
    let tall = desk.path("tall.stl");
    let text = "solid tall\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 9\n\
                endloop\nendfacet\nendsolid tall\n";
    std::fs::write(&tall, text).expect("written");
    update_to(&mut desk, Command::Open(vec![tall]));
    desk.built("open", |desk| desk.objects().len() == 1);
    let height = |desk: &Desk| desk.state().document.as_ref().map(|d| d.bounds.size().y);
    assert_eq!(height(&desk), Some(0.0));
    desk.run("Z is up");
    desk.built("turned", |desk| height(desk) == Some(9.0));
    desk.run("Z is up");
    desk.built("turned back", |desk| height(desk) == Some(0.0));
}

#[test]
fn a_prepared_file_is_opened_and_added_as_a_mesh_is_and_a_cut_one_changes_nothing() {
    let mut desk = Desk::new();
    let (ctrl, shift) = (Modifiers::COMMAND, Modifiers::SHIFT);
    let (prepared, cut) = (desk.path("two.raycast"), desk.path("cut.raycast"));
    let mut scene = read_scene(&desk.path("cube.obj"), &|_| {}).expect("a cube");
    scene.append(read_scene(&desk.path("torus.obj"), &|_| {}).expect("a torus"));
    let mut bytes = Vec::new();
    write_prepared(&scene, &prepared, &mut bytes).expect("prepared");
    std::fs::write(&prepared, &bytes).expect("written");
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).expect("written");

    update_to(&mut desk, Command::Open(vec![prepared.clone()]));
    desk.built("open", |desk| desk.names() == ["cube", "torus"]);
    update_to(&mut desk, Command::Add(vec![prepared]));
    desk.built("added", |desk| {
        desk.names() == ["cube", "torus", "cube", "torus"]
    });
    update_to(&mut desk, Command::Add(vec![cut]));
    desk.until("told", |desk| !desk.state().errors.is_empty());
    let error = &desk.state().errors[0];
    assert!(
        error.contains("cut.raycast: ") && error.contains("cut short"),
        "{error}"
    );
    assert_eq!(desk.objects().len(), 4);
    desk.key(Modifiers::NONE, Key::Escape);

    // It is saved in a scene file by its name, and comes back from there.
    let scene = desk.path("scene.raycast.toml");
    desk.give(ctrl, Key::S, &scene);
    desk.until("saved", |desk| {
        !desk.state().has_unsaved() && scene.exists()
    });
    desk.give(ctrl | shift, Key::O, &scene);
    desk.built("again", |desk| desk.objects().len() == 8);
}

/// What a colour field or a list that opens asks for.
fn update_to(desk: &mut Desk, command: Command) {
    let bench = desk.harness.state_mut();
    let effect = update(&mut bench.state, command);
    bench.effects.extend(effect);
    desk.until("done", |_| true);
}
