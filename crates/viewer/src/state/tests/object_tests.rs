//! Tests of changes to objects, and of picks.

use super::*;

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
