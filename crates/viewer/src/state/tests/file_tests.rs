//! Tests of files, questions and messages.

use super::*;
use crate::state::cut::PlaneBy;

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
    let news = News::Dialog(PromptKind::Open, DialogAnswer::Nothing);
    receive(&mut state, news, Duration::ZERO);
    assert!(state.prompt.as_ref().is_some_and(|prompt| !prompt.dialog));
    update(&mut state, Command::TypePath(" mesh.obj ".to_owned()));
    let effect = update(&mut state, Command::ConfirmPath);
    let whole = std::path::absolute("mesh.obj").expect("a path");
    assert_eq!(effect, Some(Effect::Open(vec![whole], Keep::Nothing)));
    assert!(state.prompt.is_none());
}

#[test]
fn a_cancelled_dialog_takes_the_path_line_with_it_unless_a_path_was_begun() {
    let cancelled = || News::Dialog(PromptKind::Open, DialogAnswer::Nothing);
    let mut state = State::default();
    update(&mut state, Command::Ask(PromptKind::Open));
    update(&mut state, Command::LoseKeyboard);
    receive(&mut state, cancelled(), Duration::ZERO);
    assert!(state.prompt.is_none());
    update(&mut state, Command::Ask(PromptKind::Open));
    update(&mut state, Command::LoseKeyboard);
    update(&mut state, Command::TypePath("/tmp".to_owned()));
    receive(&mut state, cancelled(), Duration::ZERO);
    assert!(state.prompt.is_some_and(|prompt| !prompt.dialog));
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
            by: PromptKind::Picture,
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

/// News of another scene.
fn other() -> News {
    let News::Loaded(mut loaded) = loaded(3, None) else {
        unreachable!("it is made so");
    };
    loaded.document.name = "other.obj".to_owned();
    News::Loaded(loaded)
}

#[test]
fn a_bad_file_is_refused_without_a_question_about_unsaved_changes() {
    let mut state = opened(1);
    update(&mut state, Command::Rename(0, "lid".to_owned()));
    let opens = update(&mut state, Command::Open(vec!["bad.obj".into()]));
    let reads = Some(Effect::Open(vec!["bad.obj".into()], Keep::Nothing));
    assert_eq!(opens, reads);
    let news = News::NotOpened("bad.obj: not a mesh".to_owned());
    assert_eq!(receive(&mut state, news, Duration::ZERO), None);
    assert_eq!((state.question, state.errors.len()), (None, 1));
    assert!(state.has_unsaved());
}

#[test]
fn a_scene_that_was_read_waits_for_the_answer_about_unsaved_changes() {
    let mut state = opened(1);
    receive(&mut state, other(), Duration::ZERO);
    assert_eq!(names(&state).len(), 3, "nothing was changed");
    update(&mut state, Command::Rename(0, "lid".to_owned()));
    let scenes = state.scenes;
    receive(&mut state, loaded(1, None), Duration::ZERO);
    assert_eq!(state.question, Some(Pending::Open));
    assert_eq!(names(&state), ["lid", "object 1", "object 2"]);
    assert_eq!(state.scenes, scenes, "its picture stays");
    update(&mut state, Command::Answer(Answer::Stay));
    assert!(state.arrived.is_none() && state.question.is_none() && state.has_unsaved());

    receive(&mut state, loaded(1, None), Duration::ZERO);
    update(&mut state, Command::Answer(Answer::Discard));
    assert_eq!(names(&state), ["object 0"]);
    assert_eq!(state.scenes, scenes + 1);

    // Saved first, and then shown; not if saving fails.
    update(&mut state, Command::Rename(0, "lid".to_owned()));
    for saves in [false, true] {
        receive(&mut state, other(), Duration::ZERO);
        update(&mut state, Command::Answer(Answer::Save));
        update(&mut state, Command::TypePath("lid".to_owned()));
        assert!(update(&mut state, Command::ConfirmPath).is_some());
        let news = match saves {
            true => News::SceneSaved("lid.raycast.toml".into(), state.history.revision()),
            false => News::NotSaved("the disk is full".to_owned()),
        };
        receive(&mut state, news, Duration::ZERO);
        assert_eq!(names(&state).len(), if saves { 3 } else { 1 });
        assert!(state.arrived.is_none());
    }
}

#[test]
fn unsaved_changes_are_asked_for_before_the_window_closes() {
    let mut state = opened(1);
    assert_eq!(update(&mut state, Command::Close), Some(Effect::Close));
    update(&mut state, Command::Rename(0, "lid".to_owned()));
    // The scene has no file yet, so one is asked for.
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
fn what_was_changed_while_it_was_saved_is_asked_about_before_it_would_be_lost() {
    for pending in [Pending::Open, Pending::Close] {
        let mut state = opened(1);
        update(&mut state, Command::Rename(0, "lid".to_owned()));
        match pending {
            Pending::Open => receive(&mut state, other(), Duration::ZERO),
            _ => update(&mut state, Command::Close),
        };
        update(&mut state, Command::Answer(Answer::Save));
        let revision = state.history.revision();
        update(&mut state, Command::Rename(0, "cap".to_owned()));
        let saved = News::SceneSaved("a.raycast.toml".into(), revision);
        assert_eq!(receive(&mut state, saved, Duration::ZERO), None);
        assert_eq!(state.question, Some(pending));
        assert_eq!(names(&state), ["cap"]);
        // The second answer goes on with what waited.
        let effect = update(&mut state, Command::Answer(Answer::Discard));
        match pending {
            Pending::Open => assert_eq!(names(&state).len(), 3),
            _ => assert_eq!(effect, Some(Effect::Close)),
        }
    }
}

#[test]
fn a_saved_pictures_whole_path_is_told() {
    let mut state = opened(1);
    receive(
        &mut state,
        News::PictureSaved("a.png".into()),
        Duration::ZERO,
    );
    let path = std::env::current_dir().expect("a folder").join("a.png");
    let told = format!("Saved {}", path.display());
    assert_eq!(state.toasts.last().map(|toast| &toast.text), Some(&told));
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
    let whole = std::path::absolute("more.obj").expect("a path");
    assert_eq!(added, Some(Effect::Add(vec![whole])));
    let mut child = document(&state).scene.objects[0].clone();
    child.parent = Some(0);
    let news = News::Added {
        objects: vec![document(&state).scene.objects[1].clone(), child],
        opened: Vec::new(),
        unit: None,
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
fn what_comes_beside_is_told_with_a_hint_where_it_is_not_all_in_view() {
    let mut state = opened(2);
    let near = Object {
        name: "near".to_owned(),
        ..document(&state).scene.objects[0].clone()
    };
    let mut far = near.clone();
    far.transform.translate = DVec3::X * 1e6;
    let mut told = |objects: Vec<Object>| {
        let news = News::Added {
            objects,
            opened: Vec::new(),
            unit: None,
            paths: Vec::new(),
            notes: Vec::new(),
            errors: Vec::new(),
        };
        receive(&mut state, news, Duration::ZERO);
        state.toasts.pop().expect("a message").text
    };
    assert_eq!(told(vec![near.clone()]), "Added near");
    assert_eq!(
        told(vec![near, far]),
        "Added 2 objects, not all of it in view: View, Fit shows everything"
    );
}

#[test]
fn a_file_read_again_keeps_the_camera_and_what_a_person_changed() {
    let mut state = opened(2);
    update(&mut state, Command::Look(StandardView::Top));
    update(&mut state, Command::SetMode(Mode::Normals));
    let before = state.viewpoint;
    let rule = ColorRule::Uniform(Color([1, 2, 3]));
    update(&mut state, Command::SetColorRule(Some(1), rule.clone()));
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
    assert_eq!(update(&mut state, Command::Reload), reads);
    let News::Loaded(mut again) = loaded(2, None) else {
        unreachable!("it was made so");
    };
    again.keep = Keep::All;
    receive(&mut state, News::Loaded(again), Duration::ZERO);
    assert_eq!(state.question, Some(Pending::Open));
    assert_eq!(names(&state).len(), 1);
}

#[test]
fn a_file_that_is_only_read_again_has_nothing_to_save() {
    let mut state = opened(2);
    let News::Loaded(mut again) = loaded(2, None) else {
        panic!("it is a scene");
    };
    again.keep = Keep::All;
    receive(&mut state, News::Loaded(again), Duration::ZERO);
    assert!(!state.has_unsaved());
    update(&mut state, Command::AddPlane(PlaneBy::Axis(0)));
    assert!(state.has_unsaved(), "a plane would be lost");
    update(&mut state, Command::Undo);
    assert!(!state.has_unsaved());
    update(&mut state, Command::SetVisible(0, false));
    assert!(state.has_unsaved());
}

#[test]
fn files_that_cannot_be_opened_are_stepped_over() {
    let mut state = opened(1);
    let step = |state: &mut State, by: i32| match update(state, Command::OpenNeighbor(by)) {
        Some(Effect::OpenNeighbor(_, step)) => step,
        other => panic!("{other:?}"),
    };
    let bad = || News::NotOpened("b.obj:1: no number".to_owned());
    assert_eq!(step(&mut state, 1), 1);
    receive(&mut state, bad(), Duration::ZERO);
    assert_eq!(step(&mut state, 1), 2);
    receive(&mut state, bad(), Duration::ZERO);
    assert_eq!(step(&mut state, -1), 1);
    assert_eq!(step(&mut state, -1), -1, "not the one that is open");
    receive(&mut state, loaded(1, None), Duration::ZERO);
    assert_eq!(step(&mut state, 1), 1);
}

#[test]
fn a_file_read_again_finds_objects_that_were_put_in_another_order() {
    let News::Loaded(mut first) = loaded(3, None) else {
        panic!("it is a scene");
    };
    let apart = |document: &mut Document| {
        let mut scene = Scene::clone(&document.scene);
        for (number, object) in scene.objects.iter_mut().enumerate() {
            object.mesh = Arc::new(Mesh::new(MeshData {
                positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y * (number + 1) as f64],
                triangles: vec![[0, 1, 2]],
                ..MeshData::default()
            }));
        }
        let scene = Arc::new(scene);
        *document = Document {
            paths: document.paths.clone(),
            ..Document::new(1, "mesh.obj", Arc::clone(&scene), tree(&scene))
        };
    };
    apart(&mut first.document);
    let mut state = State::default();
    receive(&mut state, News::Loaded(first), Duration::ZERO);
    let end = Insertion {
        before: 3,
        parent: None,
    };
    update(&mut state, Command::Reorder(0, end));
    build(&mut state);
    let News::Loaded(mut again) = loaded(3, None) else {
        panic!("it is a scene");
    };
    apart(&mut again.document);
    again.keep = Keep::All;
    let read = Arc::clone(&again.document.scene);
    receive(&mut state, News::Loaded(again), Duration::ZERO);
    assert_eq!(names(&state), ["object 1", "object 2", "object 0"]);
    for (now, was) in [(0, 1), (1, 2), (2, 0)] {
        let mesh = &document(&state).scene.objects[now].mesh;
        assert!(Arc::ptr_eq(mesh, &read.objects[was].mesh), "{now}");
    }
    update(&mut state, Command::Undo);
    assert_eq!(names(&state), ["object 0", "object 1", "object 2"]);
}

#[test]
fn undo_outlives_a_file_that_is_read_again_and_shows_what_it_holds_now() {
    let mut state = opened(2);
    update(&mut state, Command::SetVisible(0, false));
    update(&mut state, Command::Rename(1, "lid".to_owned()));
    let News::Loaded(mut again) = loaded(2, None) else {
        panic!("it is a scene");
    };
    again.keep = Keep::All;
    let new = Arc::clone(&again.document.scene.objects[0].mesh);
    receive(&mut state, News::Loaded(again), Duration::ZERO);
    assert_eq!(names(&state), ["object 0", "lid"]);
    update(&mut state, Command::Undo);
    assert_eq!(names(&state), ["object 0", "object 1"]);
    update(&mut state, Command::Undo);
    assert_eq!(visible(&state), [true, true]);
    let objects = &document(&state).scene.objects;
    assert!(
        Arc::ptr_eq(&objects[0].mesh, &new),
        "the new triangles, not the old"
    );
    update(&mut state, Command::Redo);
    assert_eq!(visible(&state), [false, true]);
    assert!(Arc::ptr_eq(&document(&state).scene.objects[0].mesh, &new));
}

#[test]
fn a_whole_name_that_is_typed_over_the_suggestion_keeps_one_ending() {
    let mut state = opened(1);
    for (typed, written) in [
        ("/out/a.jpg.png", "/out/a.jpg"),
        ("/out/a.png.png", "/out/a.png"),
        ("/out/a.tif.png", "/out/a.tif"),
        ("/out/a.png", "/out/a.png"),
        ("/out/v1.2.png", "/out/v1.2.png"),
    ] {
        update(&mut state, Command::Ask(PromptKind::Picture));
        update(&mut state, Command::TypePath(typed.to_owned()));
        let effect = update(&mut state, Command::ConfirmPath);
        let expected = Effect::SavePicture {
            path: written.into(),
            replace: false,
        };
        assert_eq!(effect, Some(expected), "{typed}");
    }
}

/// A path that cannot be read or written stays to be corrected, whatever it is for.
#[test]
fn a_path_that_fails_stays_to_be_corrected() {
    let good = std::path::PathBuf::from("b.png");
    let read = |number, found| News::Texture {
        number: Some(number),
        path: good.clone(),
        found,
    };
    let no_image = || Err("b: no image".to_owned());
    let not_saved = || News::NotSaved("b: the disk is full".to_owned());
    let texture = Texture::new(1, 1, vec![[0; 4]])
        .map(Arc::new)
        .expect("a texel");
    for (kind, bad, done) in [
        (
            PromptKind::Texture,
            read(1, no_image()),
            read(2, Ok(texture)),
        ),
        (
            PromptKind::Picture,
            not_saved(),
            News::PictureSaved(good.clone()),
        ),
    ] {
        let mut state = opened(1);
        update(&mut state, Command::Ask(kind));
        update(&mut state, Command::TypePath("b.png".to_owned()));
        assert!(update(&mut state, Command::ConfirmPath).is_some());
        assert_eq!(state.prompt, None);
        receive(&mut state, bad, Duration::ZERO);
        let text = state.prompt.as_ref().map(|prompt| prompt.text.as_str());
        assert_eq!(text, Some("b.png"));
        assert!(update(&mut state, Command::ConfirmPath).is_some());
        receive(&mut state, done, Duration::ZERO);
        assert_eq!((&state.prompt, &state.typed), (&None, &None));
    }
    // A name that is taken, and is to stay, can be changed.
    let mut state = opened(1);
    update(&mut state, Command::Ask(PromptKind::Picture));
    update(&mut state, Command::TypePath("b.png".to_owned()));
    update(&mut state, Command::ConfirmPath);
    let by = PromptKind::Picture;
    let taken = News::Taken(Replacing { path: good, by });
    receive(&mut state, taken, Duration::ZERO);
    update(&mut state, Command::Dismiss);
    let text = state.prompt.as_ref().map(|prompt| prompt.text.as_str());
    assert_eq!((text, &state.replacing), (Some("b.png"), &None));
}

#[test]
fn an_error_goes_when_its_file_is_read() {
    let mut state = opened(1);
    let bad = News::NotOpened("other.obj:3: expected a number".to_owned());
    receive(&mut state, bad, Duration::ZERO);
    let another = News::Failed("other.objx: damaged".to_owned());
    receive(&mut state, another, Duration::ZERO);
    let News::Loaded(mut loaded) = other() else {
        unreachable!("it is made so");
    };
    loaded.document.paths = vec!["other.obj".into()];
    receive(&mut state, News::Loaded(loaded), Duration::ZERO);
    assert_eq!(state.errors, ["other.objx: damaged"]);
}

#[test]
fn escape_cancels_reading_before_it_takes_away_errors() {
    let mut state = opened(1);
    receive(&mut state, News::Failed("a: b".to_owned()), Duration::ZERO);
    state.is_loading = true;
    assert_eq!(
        update(&mut state, Command::Dismiss),
        Some(Effect::CancelLoad)
    );
    state.is_loading = false;
    assert_eq!(update(&mut state, Command::Dismiss), None);
    assert_eq!(state.errors, [""; 0]);
}

#[test]
fn meshes_are_saved_by_their_ending() {
    let mut state = opened(1);
    let kind = PromptKind::Meshes;
    let asked = update(&mut state, Command::Ask(kind));
    assert_eq!(asked, Some(Effect::Dialog(kind)));
    let prompt = state.prompt.as_ref().expect("a line for the path");
    assert_eq!(prompt.text, "mesh-meshes.glb");
    let mut give = |name: &str| {
        update(&mut state, Command::TypePath(name.to_owned()));
        let effect = update(&mut state, Command::ConfirmPath);
        (effect, state.errors.pop())
    };
    let (effect, error) = give("part.fbx");
    assert_eq!(effect, None);
    let expected = "part.fbx: expected a name that ends in .obj, .ply, .stl, .glb or .txt";
    assert_eq!(error.as_deref(), Some(expected));
    let saved = |path: &str, replace| {
        Some(Effect::SaveMeshes {
            path: path.into(),
            replace,
        })
    };
    assert_eq!(give("part").0, saved("part.glb", false));
    update(&mut state, Command::Ask(kind));
    // Typed over the suggestion's stem.
    update(&mut state, Command::TypePath("part.stl.glb".to_owned()));
    assert_eq!(
        update(&mut state, Command::ConfirmPath),
        saved("part.stl", false)
    );
    let taken = Replacing {
        path: "part.stl".into(),
        by: kind,
    };
    receive(&mut state, News::Taken(taken), Duration::ZERO);
    assert_eq!(
        update(&mut state, Command::Replace),
        saved("part.stl", true)
    );
}
