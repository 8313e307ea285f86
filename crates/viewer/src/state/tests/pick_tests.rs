//! Tests of picks and of measurements between them.

use super::*;

#[test]
fn what_is_pinned_moves_with_its_object_at_once() {
    let mut state = opened_to_edit(2);
    do_all(
        &mut state,
        [Command::Look(StandardView::Front), Command::Fit],
    );
    let camera = state.camera().expect("a camera");
    let at = camera
        .project(DVec3::new(2.25, 0.5, 0.0))
        .expect("in front");
    update(&mut state, Command::Pin { at, beside: false });
    let pinned = |state: &State| state.picks.current().map(|pinned| pinned.corners[0]);
    assert_eq!(pinned(&state), Some(DVec3::X * 2.0));
    let moved = Transform {
        translate: DVec3::X * 5.0,
        ..Transform::IDENTITY
    };
    // Its size is another one.
    let effect = update(&mut state, Command::SetTransform(1, moved));
    assert_eq!(effect, Some(Effect::Weigh(1)));
    assert_eq!(pinned(&state), Some(DVec3::X * 5.0));
    let pin = state.picks.current().expect("still there");
    assert!(pin.pick.point.distance(DVec3::new(5.25, 0.5, 0.0)) < 1e-6);
    assert!(pin.has_moved);
}

#[test]
fn several_picks_make_a_list_of_which_one_is_looked_at() {
    let mut state = opened_to_edit(3);
    do_all(
        &mut state,
        [Command::Look(StandardView::Front), Command::Fit],
    );
    let camera = state.camera().expect("a camera");
    let pin = |x: f64, beside| {
        let at = camera.project(DVec3::new(x + 0.25, 0.5, 0.0));
        let at = at.expect("in front");
        Command::Pin { at, beside }
    };
    let listed = |state: &State| -> Vec<u32> {
        let picks = state.picks.list().iter();
        picks.map(|pinned| pinned.pick.hit.object).collect()
    };
    do_all(&mut state, [pin(0.0, true), pin(2.0, true), pin(4.0, true)]);
    assert_eq!((listed(&state), state.selected), (vec![0, 1, 2], Some(2)));
    // Beside everything there is nothing to add, and nothing is lost.
    let at = (1.0, 1.0);
    update(&mut state, Command::Pin { at, beside: true });
    assert_eq!(listed(&state), [0, 1, 2]);
    update(&mut state, Command::ChoosePick(0));
    assert_eq!((state.picks.current_index(), state.selected), (0, Some(0)));
    update(&mut state, Command::ChoosePick(9));
    assert_eq!(state.picks.current_index(), 0);
    update(&mut state, Command::ChoosePick(2));
    update(&mut state, Command::RemovePick(0));
    assert_eq!(
        (listed(&state), state.picks.current_index()),
        (vec![1, 2], 1)
    );
    update(&mut state, Command::RemovePick(1));
    assert_eq!((listed(&state), state.picks.current_index()), (vec![1], 0));
    // A plain click lets go of all others.
    do_all(&mut state, [pin(4.0, true), pin(0.0, false)]);
    assert_eq!(listed(&state), [0]);
    do_all(&mut state, [pin(4.0, true), Command::Dismiss]);
    assert!(listed(&state).is_empty());
}

#[test]
fn a_pick_tells_the_texel_of_the_file_that_is_there() {
    let mut state = opened_to_edit(2);
    let texels = (0..64).map(|i| [i, 2 * i, 0, 255]).collect();
    let image = Texture::new(8, 8, texels).expect("a good texture");
    let crop = raycast_core::scene::Crop {
        x: 2,
        y: 1,
        width: 4,
        height: 4,
    };
    let image = Arc::new(image.cropped(crop).expect("within"));
    let mut scene = Scene::clone(&document(&state).scene);
    scene.objects[1].texture = Some(image);
    if let Some(document) = &mut state.document {
        document.set_scene(Arc::new(scene));
    }
    do_all(
        &mut state,
        [
            Command::SetTextureProjection(TextureProjection::Plane),
            Command::Look(StandardView::Front),
            Command::Fit,
        ],
    );
    let camera = state.camera().expect("a camera");
    let texel = |state: &mut State, x: f64| {
        let at = camera.project(DVec3::new(x, 0.6, 0.0));
        let at = at.expect("in front");
        update(state, Command::Pin { at, beside: false });
        let pinned = state.picks.current().cloned().expect("a triangle");
        state.texel(&pinned)
    };
    // The plane lies once over the box, a square of side 1 from (2, 0): (0.3, 0.6) is in the second of four columns
    // of the crop and, from the top, in the second of its rows.
    let found = texel(&mut state, 2.3).expect("an image");
    assert_eq!((found.column, found.row), (2 + 1, 1 + 1));
    assert_eq!(found.color, [19, 38, 0, 255]);
    assert_eq!(texel(&mut state, 0.3), None, "the other has no image");
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
    update(&mut state, Command::Pin { at, beside: false });
    let pinned = state.picks.current().cloned().expect("the second triangle");
    assert_eq!(
        (pinned.object.as_str(), pinned.normal),
        ("object 1", DVec3::Z)
    );
    assert!(pinned.pick.point.distance(DVec3::new(2.25, 0.5, 0.0)) < 1e-9);
    assert_eq!(pinned.corners[1], DVec3::new(3.0, 0.0, 0.0));
    assert_eq!(state.selected, Some(1));
    let copied = update(&mut state, Command::Copy("2.25".to_owned()));
    assert_eq!(copied, Some(Effect::Copy("2.25".to_owned())));
    update(
        &mut state,
        Command::Pin {
            at: (1.0, 1.0),
            beside: false,
        },
    );
    assert!(state.picks.current().is_none() && state.selected.is_none());
}

#[test]
fn clicks_measure_between_vertices_while_a_tool_is_on() {
    let mut state = opened(1);
    do_all(
        &mut state,
        [Command::Look(StandardView::Front), Command::Fit],
    );
    let at = |state: &State, point: DVec3| {
        let camera = state.camera().expect("a camera");
        camera.project(point).expect("in front")
    };
    // Near a corner, inside of the triangle.
    let near = |state: &State, corner: DVec3| {
        let middle = DVec3::new(1.0 / 3.0, 1.0 / 3.0, 0.0);
        at(state, corner + (middle - corner) * 0.01)
    };
    update(&mut state, Command::SetTool(Some(Kind::Distance)));
    for corner in [DVec3::X, DVec3::Y] {
        let at = near(&state, corner);
        update(&mut state, Command::Pin { at, beside: false });
    }
    let [measured] = &state.measuring.list[..] else {
        panic!("{:?}", state.measuring);
    };
    assert_eq!(measured.points, [DVec3::X, DVec3::Y], "vertices, not hits");
    // A measurement is a step of the history, and no change of the scene.
    let all = Arc::clone(&state.measuring.list);
    assert_eq!(state.history.undo_name(), Some("Measure"));
    update(&mut state, Command::Undo);
    assert!(state.measuring.list.is_empty());
    update(&mut state, Command::Redo);
    assert_eq!(state.measuring.list, all);
    update(&mut state, Command::ClearMeasurements);
    update(&mut state, Command::ClearMeasurements);
    assert!(state.measuring.list.is_empty());
    update(&mut state, Command::Undo);
    assert_eq!(state.measuring.list, all);
    assert!(!state.history.is_changed());
    update(&mut state, Command::SetMode(Mode::Depth));
    update(&mut state, Command::RemoveMeasurement(0));
    update(&mut state, Command::Undo);
    assert!(state.history.is_changed() && state.measuring.list == all);
    update(&mut state, Command::Undo);
    assert!(!state.history.is_changed() && state.measuring.list == all);
    assert_eq!(state.picks.current(), None);
    update(&mut state, Command::SetSnaps(false));
    let beside = near(&state, DVec3::X);
    update(
        &mut state,
        Command::Pin {
            at: beside,
            beside: false,
        },
    );
    assert_ne!(state.measuring.points, [DVec3::X]);
    // Beside everything nothing is taken; Esc lets the point go, then the tool.
    update(
        &mut state,
        Command::Pin {
            at: (0.5, 0.5),
            beside: false,
        },
    );
    assert_eq!(state.measuring.points.len(), 1);
    update(&mut state, Command::Dismiss);
    assert!(state.measuring.points.is_empty() && state.measuring.tool.is_some());
    update(&mut state, Command::Dismiss);
    assert_eq!(state.measuring.tool, None);
    update(
        &mut state,
        Command::Pin {
            at: beside,
            beside: false,
        },
    );
    assert!(state.picks.current().is_some(), "clicks pick again");
}

#[test]
fn measurements_are_saved_where_the_person_says() {
    let mut state = opened(1);
    let kind = PromptKind::Measurements;
    assert_eq!(
        update(&mut state, Command::Ask(kind)),
        None,
        "nothing to save"
    );
    state.measuring.list = Arc::new(vec![Measurement {
        kind: Kind::Distance,
        points: vec![DVec3::ZERO, DVec3::X],
    }]);
    assert_eq!(
        update(&mut state, Command::Ask(kind)),
        Some(Effect::Dialog(kind))
    );
    update(&mut state, Command::TypePath("sizes".to_owned()));
    let save = |replace| Effect::SaveMeasurements {
        path: "sizes.csv".into(),
        replace,
    };
    assert_eq!(update(&mut state, Command::ConfirmPath), Some(save(false)));
    let taken = Replacing {
        path: "sizes.csv".into(),
        by: kind,
    };
    receive(&mut state, News::Taken(taken), Duration::ZERO);
    assert_eq!(update(&mut state, Command::Replace), Some(save(true)));
}
