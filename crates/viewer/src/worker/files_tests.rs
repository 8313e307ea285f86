//! File tasks: loading, saving, and their faults.

use super::*;
use crate::setup;
use crate::worker::demo;
use raycast_core::camera::Grid;
use raycast_core::formats::SceneFile;
use raycast_core::render::View;
use raycast_core::scene::{ClippingPlane, Crop, Wrap};
use std::path::Path;

fn files() -> Files {
    Files::new(Arc::new(|| {}))
}

fn wait(files: &Files) -> News {
    for _ in 0..500 {
        if let Some(news) = files.fetch().pop() {
            return news;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    panic!("no news came");
}

#[test]
fn a_panic_in_a_task_is_reported() {
    let files = files();
    files.shared.spawn("test", ANY, |_| panic!("on purpose"));
    assert!(matches!(wait(&files), News::Failed(text) if text.contains("on purpose")));
}

#[test]
fn a_check_that_panics_is_reported_and_ends() {
    let is_first = std::sync::atomic::AtomicBool::new(true);
    let files = Files::new(Arc::new(move || {
        assert!(!is_first.swap(false, Ordering::Relaxed), "on purpose");
    }));
    let file = demo::scene().expect("the demo scene");
    let mesh = Arc::clone(&file.scene.objects[0].mesh);
    files.check("a mesh".to_owned(), vec![(0, mesh)], false);
    assert!(matches!(wait(&files), News::Failed(text) if text.contains("on purpose")));
    assert_eq!(files.activity(), None);
}

#[test]
fn news_of_a_replaced_load_is_dropped() {
    let files = files();
    files.shared.newest_load.store(2, Ordering::Relaxed);
    files.shared.tell(1, News::Failed("old".to_owned()));
    files.shared.tell(2, News::Failed("new".to_owned()));
    let news = files.fetch();
    assert!(matches!(&news[..], [News::Failed(text)] if text == "new"));
}

#[test]
fn good_files_open_and_bad_ones_are_reported() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("written");
        path
    };
    let good = write("good.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let bad = write("bad.obj", "v 0 0 x\n");
    let files = files();
    files.open(vec![bad.clone(), good.clone()], Keep::Nothing);
    let News::Loaded(loaded) = wait(&files) else {
        panic!("the good one opens");
    };
    assert_eq!(loaded.document.scene.objects.len(), 1);
    assert_eq!(loaded.document.paths, std::slice::from_ref(&good));
    assert!(loaded.errors.len() == 1 && loaded.errors[0].contains("bad.obj:1"));
    assert_eq!(files.activity(), None);

    files.open(vec![bad.clone()], Keep::Nothing);
    assert!(matches!(wait(&files), News::NotOpened(text) if text.contains("bad.obj:1")));
    files.add(vec![good, bad]);
    assert!(matches!(
        wait(&files),
        News::Added { objects, errors, .. } if objects.len() == 1 && errors.len() == 1
    ));
}

#[test]
fn an_outline_is_written_and_replaces_no_file_without_permission() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("cut.svg");
    let file = demo::scene().expect("the demo scene");
    let accel = Arc::new(Accel::build(&file.scene).expect("a valid scene"));
    let (files, by) = (files(), PromptKind::Outline(0));
    let save = |offset, replace| {
        let plane = ClippingPlane::new(raycast_core::glam::DVec3::Y, offset);
        let cut = (Arc::clone(&accel), plane.expect("a plane"));
        files.save_outline(cut, path.clone(), by, replace);
        wait(&files)
    };
    assert!(matches!(save(1.5, false), News::PictureSaved(_)));
    let text = std::fs::read_to_string(&path).expect("written");
    assert!(text.starts_with("<svg") && text.contains("<path"), "{text}");
    assert!(matches!(save(0.5, false), News::Taken(taken) if taken.by == by));
    assert_eq!(std::fs::read_to_string(&path).expect("as it was"), text);
    assert!(matches!(save(0.5, true), News::PictureSaved(_)));
    assert_ne!(std::fs::read_to_string(&path).expect("another"), text);
    assert!(
        matches!(save(1e6, true), News::NotSaved(text) if text.contains("cuts nothing")),
        "beside everything"
    );
}

#[test]
fn meshes_that_are_shown_are_written_and_replace_no_file_without_permission() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let opened = folder.path().join("open.obj");
    std::fs::write(&opened, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("written");
    let files = files();
    files.open(vec![opened.clone()], Keep::Nothing);
    assert!(matches!(wait(&files), News::Loaded(_)));
    let mut scene = demo::scene().expect("the demo scene").scene;
    scene.objects[1].visible = false;
    let scene = Arc::new(scene);
    let save = |path: &Path, replace| {
        files.save_meshes(Arc::clone(&scene), path.to_owned(), replace);
        let mut told = Vec::new();
        for _ in 0..500 {
            for news in files.fetch() {
                match news {
                    News::Done(text) => told.push(text),
                    news => return (news, told),
                }
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        panic!("no news came");
    };
    let path = folder.path().join("demo.glb");
    let (news, told) = save(&path, false);
    assert!(matches!(news, News::PictureSaved(_)), "{news:?}");
    assert!(
        told.iter().any(|text| text.contains("hidden objects (1)")),
        "{told:?}"
    );
    let read = formats::read_scene(&path, &|_| ()).expect("a mesh").scene;
    let names = |scene: &raycast_core::scene::Scene| -> Vec<String> {
        let shown = scene.objects.iter().filter(|object| object.visible);
        shown.map(|object| object.name.clone()).collect()
    };
    assert_eq!(names(&read), names(&scene));

    let (news, _) = save(&path, false);
    assert!(matches!(news, News::Taken(taken) if taken.by == PromptKind::Meshes));
    let (news, _) = save(&path, true);
    assert!(matches!(news, News::PictureSaved(_)), "{news:?}");
    let (news, _) = save(&opened, true);
    assert!(matches!(news, News::NotSaved(_)), "{news:?}");
    // The library of an OBJ that is not there belongs to somebody else.
    let library = folder.path().join("new.mtl");
    std::fs::write(&library, "newmtl mine\n").expect("written");
    let (news, _) = save(&folder.path().join("new.obj"), true);
    assert!(
        matches!(&news, News::NotSaved(text) if text.contains("new.mtl")),
        "{news:?}"
    );
    let kept = std::fs::read(&library).expect("the library");
    assert_eq!(kept, b"newmtl mine\n");
}

#[test]
fn a_cancelled_load_sends_no_news() {
    let files = files();
    files.open(Vec::new(), Keep::Nothing);
    files.cancel_load();
    assert_eq!(files.activity(), None, "its bar goes at once");
    // The load ends by itself.
    while !lock(&files.shared.loads).is_empty() {
        std::thread::sleep(Duration::from_millis(5));
    }
    std::thread::sleep(Duration::from_millis(20));
    assert!(files.fetch().is_empty());
}

#[test]
fn a_scene_is_saved_over_itself_and_over_no_other_open_file() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mesh = folder.path().join("mesh.obj");
    std::fs::write(&mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("written");
    let files = files();
    files.open(vec![mesh.clone()], Keep::Nothing);
    let News::Loaded(loaded) = wait(&files) else {
        panic!("it is a good mesh");
    };
    let mut scene = SceneFile {
        scene: loaded.document.scene.as_ref().clone(),
        ..SceneFile::default()
    };
    scene.scene.objects[0].visible = false;
    let path = folder.path().join("scene.raycast.toml");
    let save = |to: &Path, own: Option<&Path>, replace| {
        let paths = (to.to_owned(), own.map(Path::to_owned));
        files.save_scene(scene.clone(), paths, 7, replace);
        wait(&files)
    };
    assert!(matches!(save(&path, None, false), News::SceneSaved(_, 7)));
    let read = formats::read_scene(&path, &|_| ()).expect("a scene");
    assert!(!read.scene.objects[0].visible && read.scene.objects[0].name == "mesh");

    assert!(matches!(
        save(&path, Some(&path), false),
        News::SceneSaved(..)
    ));
    for own in [None, Some(path.as_path())] {
        assert!(matches!(save(&mesh, own, true), News::NotSaved(_)));
    }
    assert!(std::fs::read(&mesh).expect("the mesh").starts_with(b"v 0"));
    let other = folder.path().join("other.toml");
    std::fs::write(&other, "a letter").expect("written");
    assert!(
        matches!(save(&other, None, false), News::Taken(there) if there.by == PromptKind::Scene)
    );
    assert!(matches!(save(&other, None, true), News::SceneSaved(..)));
}

#[test]
fn scenes_are_named_after_their_files() {
    assert_eq!(scene_name(&[]), "Demo scene");
    assert_eq!(scene_name(&["a/b.obj".into()]), "b.obj");
    assert_eq!(
        scene_name(&["a/b.obj".into(), "c.obj".into()]),
        "b.obj and 1 more"
    );
}

fn picture() -> Saving {
    let demo = demo::scene().expect("the demo scene");
    let accel = setup::tree(&demo.scene).expect("a tree");
    let image = formats::ImageSettings {
        size: Some((16, 9)),
        ..formats::ImageSettings::default()
    };
    let camera = demo.camera.as_ref();
    let camera = setup::camera(&Default::default(), camera, image, &demo.scene.bounds());
    Saving {
        view: View {
            scene: Arc::new(demo.scene),
            accel: Arc::new(accel),
            camera: camera.expect("a camera"),
            settings: Default::default(),
        },
        grid: Grid::default(),
        threads: 1,
    }
}

#[test]
fn a_picture_replaces_a_file_only_where_it_may() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("a.png");
    let files = files();
    let save = |replace| {
        files.save(picture(), path.clone(), replace);
        wait(&files)
    };
    assert!(matches!(save(false), News::PictureSaved(_)));
    let whole = std::fs::read(&path).expect("a picture");
    std::fs::write(&path, "a letter").expect("written");
    assert!(matches!(save(false), News::Taken(there) if there.path == path));
    assert_eq!(std::fs::read(&path).expect("a file"), b"a letter");
    assert!(matches!(save(true), News::PictureSaved(_)));
    assert!(std::fs::read(&path).expect("a picture") == whole);
    assert_eq!(files.activity(), None);
}

#[test]
fn a_picture_is_not_written_over_what_was_opened() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("skin.png");
    std::fs::write(&path, "P3\n1 1\n255\n1 2 3\n").expect("written");
    let files = files();
    files.load_texture(1, path.clone(), TexturePart::default());
    assert!(matches!(wait(&files), News::Texture { found: Ok(_), .. }));
    files.save(picture(), path.clone(), true);
    assert!(matches!(wait(&files), News::NotSaved(text) if text.contains("skin.png")));
    assert!(std::fs::read(&path).expect("a file").starts_with(b"P3"));
}

#[test]
fn parts_and_thumbnails_are_those_of_the_image() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("wide.png");
    std::fs::write(&path, "P3\n3 1\n255\n1 2 3 4 5 6 7 8 9\n").expect("written");
    let files = files();
    let part = |x: u32| TexturePart {
        crop: Some(Crop {
            x,
            y: 0,
            width: 2,
            height: 1,
        }),
        wrap: [Wrap::Clamp; 2],
    };
    let read = |number: u64, x: u32| {
        files.load_texture(number, path.clone(), part(x));
        match wait(&files) {
            News::Texture {
                number: Some(of),
                path: from,
                found,
            } if (of, &from) == (number, &path) => found,
            news => panic!("{news:?}"),
        }
    };
    let texture = read(7, 1).expect("a part");
    assert_eq!(texture.texels(), [[4, 5, 6, 255], [7, 8, 9, 255]]);
    assert_eq!(TexturePart::of(&texture), part(1));
    let error = read(8, 2).expect_err("too far right");
    assert!(error.contains("smaller"), "{error}");

    files.read_thumbnail(path.clone());
    match wait(&files) {
        News::Thumbnail(of, Ok(small)) => {
            assert_eq!((of, small.of, small.size), (path, (3, 1), [3, 1]));
            assert_eq!(small.texels[2], [7, 8, 9, 255]);
        }
        news => panic!("{news:?}"),
    }
    let large = folder.path().join("large.pgm");
    let header = b"P5\n2000 1000\n255\n";
    std::fs::write(&large, [&header[..], &[77; 2_000_000]].concat()).expect("written");
    files.read_thumbnail(large);
    match wait(&files) {
        News::Thumbnail(_, Ok(small)) => {
            assert_eq!((small.of, small.size), ((2000, 1000), [512, 256]));
            assert!(small.texels.iter().all(|texel| *texel == [77, 77, 77, 255]));
        }
        news => panic!("{news:?}"),
    }
    let missing = folder.path().join("missing.png");
    files.read_thumbnail(missing);
    assert!(matches!(wait(&files), News::Thumbnail(_, Err(text)) if text.contains("missing.png")));
}

#[test]
fn a_picture_that_cannot_be_written_leaves_no_file() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let files = files();
    let path = folder.path().join("missing").join("a.png");
    files.save(picture(), path, true);
    assert!(matches!(wait(&files), News::NotSaved(text) if text.contains("a.png")));
    assert_eq!(
        std::fs::read_dir(folder.path()).map(Iterator::count).ok(),
        Some(0)
    );
}
