//! Tests of changes to objects, and of their faults.

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
fn objects_of_many_are_hidden_moved_copied_and_brought_back_at_once() {
    let mut state = opened_to_edit(1000);
    do_all(
        &mut state,
        [Command::Look(StandardView::Front), Command::Fit],
    );
    let over = |state: &State, x: f64| {
        let ray = raycast_core::Ray::new(DVec3::new(x + 0.25, 0.25, 5.0), DVec3::NEG_Z);
        let hit = document(state).accel.cast(&ray, Default::default());
        hit.map(|hit| hit.object)
    };
    let bounds = document(&state).bounds;
    let at_once = |state: &mut State, command: Command| {
        let edits = document(state).edits;
        let effect = update(state, command);
        assert!(!matches!(effect, Some(Effect::Build)), "{effect:?}");
        assert!(document(state).is_built() && document(state).edits == edits + 1);
    };
    assert_eq!(over(&state, 1998.0), Some(999));
    at_once(&mut state, Command::SetVisible(999, false));
    assert_eq!(over(&state, 1998.0), None);
    assert_eq!(document(&state).bounds.max.x, 1997.0);
    at_once(&mut state, Command::Undo);
    assert_eq!(over(&state, 1998.0), Some(999));

    // As a drag does.
    let start = document(&state).scene.objects[7].transform;
    for step in 1..=3 {
        let transform = Transform {
            translate: start.translate + DVec3::Y * 10.0 * f64::from(step),
            ..start
        };
        at_once(&mut state, Command::SetTransform(7, transform));
    }
    assert_eq!((over(&state, 14.0), over(&state, 12.0)), (None, Some(6)));
    assert_eq!(document(&state).bounds.max.y, 31.0);
    at_once(&mut state, Command::Undo);
    assert_eq!(over(&state, 14.0), Some(7));
    at_once(&mut state, Command::Redo);
    assert_eq!(over(&state, 14.0), None);
    at_once(&mut state, Command::Undo);

    at_once(&mut state, Command::Isolate(3));
    assert_eq!((over(&state, 6.0), over(&state, 8.0)), (Some(3), None));
    at_once(&mut state, Command::Duplicate(3));
    assert_eq!(over(&state, 7.1), Some(4), "beside it");
    at_once(&mut state, Command::Delete(4));
    at_once(&mut state, Command::ShowAll);
    assert_eq!(document(&state).bounds, bounds);
    // A new mesh takes a tree, on another thread.
    let added = News::Added {
        objects: vec![Object::new("new", Arc::new(Mesh::new(MeshData::default())))],
        opened: Vec::new(),
        unit: None,
        paths: Vec::new(),
        notes: Vec::new(),
        errors: Vec::new(),
    };
    let effect = receive(&mut state, added, Duration::ZERO);
    assert_eq!(effect, Some(Effect::Build));
}

#[test]
fn a_parent_is_given_in_place_moves_its_children_and_is_taken_away() {
    let mut state = opened_to_edit(3);
    let place = |state: &State, object: usize| {
        let places = document(state).scene.world_from_objects();
        places.expect("a sound scene")[object]
    };
    let turned = Transform {
        translate: DVec3::new(1.0, 2.0, 3.0),
        rotate: DVec3::new(10.0, 20.0, 30.0),
        scale: DVec3::splat(2.0),
        ..Transform::IDENTITY
    };
    update(&mut state, Command::SetTransform(0, turned));
    let before = place(&state, 2);
    update(&mut state, Command::SetParent(2, Some(0)));
    assert_eq!(document(&state).scene.objects[2].parent, Some(0));
    assert!(place(&state, 2).abs_diff_eq(before, 1e-9));
    // Numbers that can be read, and no matrix.
    let own = document(&state).scene.objects[2].transform;
    assert!((own.scale - DVec3::splat(0.5)).length() < 1e-9, "{own:?}");
    let moved = Transform {
        translate: turned.translate + DVec3::X,
        ..turned
    };
    update(&mut state, Command::SetTransform(0, moved));
    let way = place(&state, 2).translation - before.translation;
    assert!((way - DVec3::X).length() < 1e-9, "it moves along");

    // Neither with itself nor with what moves with it.
    for parent in [0, 2] {
        let steps = state.history.revision();
        update(&mut state, Command::SetParent(0, Some(parent)));
        assert_eq!(document(&state).scene.objects[0].parent, None);
        assert_eq!(state.history.revision(), steps);
        assert!(state.toasts.pop().is_some(), "it says why");
    }
    for object in [7, 2] {
        update(&mut state, Command::SetParent(object, Some(9)));
        assert_eq!(document(&state).scene.objects[2].parent, Some(0));
    }
    let here = place(&state, 2);
    update(&mut state, Command::SetParent(2, None));
    assert!(place(&state, 2).abs_diff_eq(here, 1e-9));
    for _ in 0..2 {
        update(&mut state, Command::Undo);
    }
    update(&mut state, Command::Undo);
    assert_eq!(document(&state).scene.objects[2].parent, None);
    assert!(place(&state, 2).abs_diff_eq(before, 0.0));
}

#[test]
fn an_object_put_elsewhere_in_the_list_takes_its_number_mark_lock_and_children_along() {
    let mut state = opened_to_edit(4);
    update(&mut state, Command::SetParent(3, Some(2)));
    update(&mut state, Command::SetLocked(0, true));
    do_all(
        &mut state,
        [Command::Look(StandardView::Front), Command::Fit],
    );
    let camera = state.camera().expect("a camera");
    let place = camera.project(DVec3::new(4.25, 0.5, 0.0));
    let at = place.expect("in front");
    update(&mut state, Command::Pin { at, beside: false });
    update(&mut state, Command::Select(Some(2)));
    let (before, parent) = (0, None);
    let to = Insertion { before, parent };
    let effect = update(&mut state, Command::Reorder(2, to));
    assert_eq!(effect, Some(Effect::Weigh(0)), "no tree is built");
    let listed = ["object 2", "object 0", "object 1", "object 3"];
    assert_eq!(names(&state), listed);
    let hit = |state: &State| state.picks.current().map(|pinned| pinned.pick.hit.object);
    assert_eq!((state.selected, hit(&state)), (Some(0), Some(0)));
    assert_eq!(document(&state).scene.objects[3].parent, Some(0));
    let locks = |state: &State| [0, 1, 2, 3].map(|object| state.is_locked(object));
    assert_eq!(locks(&state), [false, true, false, false]);
    // The ray that met it meets it still, by its new number.
    let ray = document(&state)
        .accel
        .cast(&camera.ray(at.0, at.1), Default::default());
    assert_eq!(ray.map(|hit| hit.object), Some(0));

    update(&mut state, Command::Undo);
    assert_eq!((state.selected, hit(&state)), (Some(2), Some(2)));
    assert_eq!(locks(&state), [true, false, false, false]);
    update(&mut state, Command::Redo);
    assert_eq!((state.selected, hit(&state)), (Some(0), Some(0)));
    assert_eq!(names(&state), listed);

    // To the end, and with nothing; and what has no sense changes nothing.
    let end = Insertion {
        before: 4,
        parent: None,
    };
    update(&mut state, Command::Reorder(3, end));
    assert_eq!(names(&state), listed);
    assert_eq!(document(&state).scene.objects[3].parent, None);
    let objects = Arc::clone(&document(&state).scene);
    let (before, parent) = (9, None);
    update(
        &mut state,
        Command::Reorder(3, Insertion { before, parent }),
    );
    update(&mut state, Command::Reorder(9, end));
    let parent = Some(0);
    update(
        &mut state,
        Command::Reorder(0, Insertion { before: 1, parent }),
    );
    assert!(Arc::ptr_eq(&objects, &document(&state).scene));
}

#[test]
fn shapes_are_put_in_changed_by_numbers_and_undone() {
    let mut state = opened_to_edit(2);
    let [cube, _, sphere, ..] = raycast_core::scene::Shape::ALL;
    for shape in [cube, cube, sphere] {
        assert_eq!(
            update(&mut state, Command::AddShape(shape)),
            Some(Effect::Build)
        );
        build(&mut state);
    }
    assert_eq!(names(&state)[2..], ["cube", "cube 2", "sphere"]);
    assert_eq!(state.selected, Some(4));
    let object = &document(&state).scene.objects[4];
    assert_eq!(object.transform.translate, state.viewpoint.orbit.pivot);
    assert_eq!(object.mesh.triangles().len() as u64, sphere.triangles());
    assert!(
        document(&state).can_be_saved(),
        "a scene file says what they are"
    );
    let with = |radius, segments| Shape::Sphere {
        radius,
        segments,
        rings: 8,
    };
    update(&mut state, Command::SetShape(4, with(2.0, 12)));
    update(&mut state, Command::SetShape(4, with(3.0, 12)));
    let object = &document(&state).scene.objects[4];
    assert_eq!(
        (object.shape, object.mesh.bounds().size().y),
        (Some(with(3.0, 12)), 6.0)
    );
    // What has no mesh, is too much for one frame, or is no shape, changes nothing.
    let scene = Arc::clone(&document(&state).scene);
    for (which, shape) in [
        (4, with(0.0, 12)),
        (4, with(1.0, 16_000)),
        (0, cube),
        (9, cube),
    ] {
        update(&mut state, Command::SetShape(which, shape));
        assert!(Arc::ptr_eq(&document(&state).scene, &scene));
    }
    update(&mut state, Command::Undo);
    assert_eq!(document(&state).scene.objects[4].shape, Some(sphere));
    update(&mut state, Command::Undo);
    assert_eq!(names(&state).len(), 4);
}

#[test]
fn one_row_up_or_down_is_past_a_neighbour_with_the_same_parent() {
    let mut state = opened_to_edit(4);
    update(&mut state, Command::SetParent(1, Some(3)));
    let step =
        |state: &State, which, down| Insertion::step(&document(state).scene.objects, which, down);
    let parent = None;
    assert_eq!(step(&state, 0, false), None);
    assert_eq!(step(&state, 0, true), Some(Insertion { before: 3, parent }));
    assert_eq!(
        step(&state, 2, false),
        Some(Insertion { before: 0, parent })
    );
    assert_eq!(step(&state, 1, true), None);
    assert_eq!(step(&state, 3, true), None);
    let down = step(&state, 0, true).expect("there is a row below");
    update(&mut state, Command::Reorder(0, down));
    assert_eq!(
        names(&state),
        ["object 1", "object 2", "object 0", "object 3"]
    );
    assert_eq!(document(&state).scene.objects[0].parent, Some(3));
}

#[test]
fn intersections_that_were_found_stay_known_while_the_mesh_is_the_same() {
    let mut state = opened(1);
    let mesh = Arc::clone(&document(&state).scene.objects[0].mesh);
    let health = Arc::new(raycast_core::health::check(&mesh, &|_| true).expect("it goes on"));
    let found = raycast_core::health::Intersections {
        pairs: vec![[0, 0]],
        has_more: false,
    };
    let checked = |intersections| {
        let (mesh, health) = (Arc::clone(&mesh), Arc::clone(&health));
        News::Checked(vec![Checked {
            object: 0,
            mesh,
            health,
            intersections,
        }])
    };
    receive(&mut state, checked(Some(Arc::new(found))), Duration::ZERO);
    receive(&mut state, checked(None), Duration::ZERO);
    let [known] = &state.inspection.checked[..] else {
        panic!("{:?}", state.inspection.checked);
    };
    let fault = Fault::SelfIntersections;
    assert_eq!((known.count(fault), known.is_sound()), (1, false));
    assert_eq!(known.number(fault, 0), Some("triangles 0 and 0".to_owned()));
    assert_eq!(known.corners(fault, 0).len(), 6);
}

#[test]
fn commands_that_change_nothing_leave_nothing_to_undo_or_to_save() {
    let mut state = opened(2);
    let name = names(&state)[0].to_string();
    let transform = document(&state).scene.objects[0].transform;
    let before = Arc::clone(&document(&state).scene);
    for command in [
        Command::Rename(0, name),
        Command::SetVisible(0, true),
        Command::ShowAll,
        Command::SetTransform(0, transform),
        Command::SetColorRule(None, ColorRule::File),
        Command::RemoveTexture(None),
    ] {
        assert_eq!(update(&mut state, command.clone()), None, "{command:?}");
        assert_eq!(state.history.undo_name(), None, "{command:?}");
        assert!(Arc::ptr_eq(&document(&state).scene, &before), "{command:?}");
    }
    assert!(!state.has_unsaved());
    update(&mut state, Command::Rename(0, "another".to_owned()));
    assert_eq!(state.history.undo_name(), Some("Rename"));
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
    for (expected, selected) in [(4, Some(2)), (3, Some(1))] {
        update(&mut state, Command::Undo);
        assert_eq!(names(&state).len(), expected);
        assert_eq!(state.selected, selected, "what comes back is marked");
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
fn undo_names_what_was_typed() {
    let mut state = opened(1);
    let mut transform = Transform::IDENTITY;
    let mut steps = Vec::new();
    for change in [
        |t: &mut Transform| t.translate.x = 1.0,
        |t: &mut Transform| t.rotate.y = 30.0,
        |t: &mut Transform| t.scale.z = 2.0,
    ] {
        change(&mut transform);
        update(&mut state, Command::SetTransform(0, transform));
        steps.extend(state.history.undo_name());
    }
    assert_eq!(steps, ["Move", "Turn", "Scale"]);
    for _ in 0..3 {
        update(&mut state, Command::Undo);
    }
    assert!(!state.history.is_changed(), "three steps");
}

#[test]
fn an_object_is_moved_turned_and_scaled_and_a_drag_is_one_step() {
    let mut state = opened(2);
    let transform = |state: &State| document(state).scene.objects[1].transform;
    let start = transform(&state);
    let moved = |x: f64| Transform {
        translate: DVec3::X * x,
        ..start
    };
    for (x, now) in [(3.0, 0), (4.0, 30), (5.0, 60)] {
        state.now = Duration::from_millis(now);
        let effect = update(&mut state, Command::SetTransform(1, moved(x)));
        assert_eq!(effect, Some(Effect::Build), "moved triangles need a tree");
    }
    assert_eq!(transform(&state), moved(5.0));
    assert!(document(&state).built.objects[1].transform == start);
    state.now = Duration::from_secs(9);
    update(&mut state, Command::Turn(1, 2));
    assert_eq!(transform(&state).rotate, DVec3::Z * 90.0);
    // What is no place is not taken.
    for bad in [DVec3::NAN, DVec3::new(1.0, 0.0, 1.0)] {
        let scaled = Transform {
            scale: bad,
            ..start
        };
        assert_eq!(update(&mut state, Command::SetTransform(1, scaled)), None);
    }
    update(&mut state, Command::Undo);
    assert_eq!(transform(&state), moved(5.0));
    update(&mut state, Command::Undo);
    assert_eq!(transform(&state), start);
    assert_eq!(state.history.undo_name(), None);
}

#[test]
fn a_locked_object_stays_as_it_is_and_the_lock_goes_with_it() {
    let mut state = opened(3);
    update(&mut state, Command::SetLocked(1, true));
    let before = document(&state).scene.objects[1].clone();
    do_all(
        &mut state,
        [
            Command::SetTransform(1, Transform::from_matrix(DAffine3::ZERO)),
            Command::Rename(1, "other".to_owned()),
            Command::Delete(1),
            Command::SetColorRule(Some(1), ColorRule::Uniform(Color([1, 2, 3]))),
            Command::SetColorRule(None, ColorRule::Uniform(Color([4, 5, 6]))),
        ],
    );
    let after = &document(&state).scene.objects;
    assert_eq!(after.len(), 3);
    let of = |object: &Object| (object.name.clone(), object.transform, object.color.clone());
    assert_eq!(of(&after[1]), of(&before));
    assert_ne!(after[0].color, before.color, "the others are free");
    assert!(
        state
            .toasts
            .iter()
            .any(|toast| toast.text.contains("locked"))
    );

    // Objects that come and go before it take their locks along.
    do_all(&mut state, [Command::Duplicate(0), Command::Delete(0)]);
    assert_eq!(names(&state), ["object 0 copy", "object 1", "object 2"]);
    assert!(state.is_locked(1) && !state.is_locked(0) && !state.is_locked(2));
    update(&mut state, Command::Delete(0));
    assert!(state.is_locked(0) && !state.is_locked(1));
    update(&mut state, Command::Undo);
    assert!(state.is_locked(1) && !state.is_locked(0));
}

#[test]
fn faults_are_looked_at_one_by_one_while_the_mesh_is_the_same() {
    let mut state = opened(2);
    assert_eq!(
        update(&mut state, Command::Check { deep: false }),
        Some(Effect::Check {
            objects: vec![0, 1],
            deep: false
        })
    );
    let weigh = update(&mut state, Command::Select(Some(1)));
    assert_eq!(weigh, Some(Effect::Weigh(1)));
    assert_eq!(
        update(&mut state, Command::Check { deep: false }),
        Some(Effect::Check {
            objects: vec![1],
            deep: false
        })
    );
    let mesh = Arc::clone(&document(&state).scene.objects[1].mesh);
    let health = Arc::new(raycast_core::health::check(&mesh, &|_| true).expect("it goes on"));
    let object = 1;
    let checked = vec![Checked {
        object,
        mesh,
        health,
        intersections: None,
    }];
    receive(&mut state, News::Checked(checked), Duration::ZERO);
    let fault = Fault::OpenEdges;
    let shown = Shown {
        object,
        fault,
        index: 2,
    };
    update(&mut state, Command::ShowFault(Some(shown)));
    // The edge from (1, 0, 0) to (0, 1, 0) of the object that stands at x = 2.
    let pivot = state.viewpoint.orbit.pivot;
    assert!(pivot.distance(DVec3::new(2.5, 0.5, 0.0)) < 1e-12, "{pivot}");
    let scene = Arc::clone(&document(&state).scene);
    assert!(state.inspection.of(&scene, 1).is_some());
    assert!(state.inspection.of(&scene, 0).is_none());
    update(&mut state, Command::Delete(0));
    let scene = Arc::clone(&document(&state).scene);
    assert!(
        state.inspection.of(&scene, 1).is_none(),
        "numbers have changed hands"
    );
}

#[test]
fn a_fault_behind_something_is_looked_at_from_where_it_is_seen() {
    let mut state = opened(2);
    // A large triangle between the camera and the second object.
    let mut scene = Scene::clone(&document(&state).scene);
    scene.objects[0].transform = Transform {
        translate: DVec3::new(-10.0, -10.0, 1.0),
        scale: DVec3::splat(40.0),
        ..Transform::default()
    };
    let scene = Arc::new(scene);
    if let Some(document) = &mut state.document {
        document.accel = tree(&scene).accel;
        document.built = Arc::clone(&scene);
        document.scene = scene;
    }
    update(&mut state, Command::Look(StandardView::Front));
    let mesh = Arc::clone(&document(&state).scene.objects[1].mesh);
    let health = Arc::new(raycast_core::health::check(&mesh, &|_| true).expect("it goes on"));
    let checked = Checked {
        object: 1,
        mesh,
        health,
        intersections: None,
    };
    receive(&mut state, News::Checked(vec![checked]), Duration::ZERO);
    let edge = DVec3::new(2.5, 0.5, 0.0);
    assert_eq!(state.hidden(&[edge]), [true]);
    let shown = |index| Shown {
        object: 1,
        fault: Fault::OpenEdges,
        index,
    };
    update(&mut state, Command::ShowFault(Some(shown(2))));
    assert_eq!(state.hidden(&[edge]), [false]);
    // The next fault is seen from there, too: nothing turns.
    let turned = state.viewpoint.orbit;
    assert_ne!((turned.yaw, turned.pitch), (0.0, 0.0));
    update(&mut state, Command::ShowFault(Some(shown(1))));
    let again = state.viewpoint.orbit;
    assert_eq!((again.yaw, again.pitch), (turned.yaw, turned.pitch));
}
