use super::*;
use crate::state::cut::{PlaneBy, distance};
use raycast_core::scene::ClippingPlane;

fn planes(state: &State) -> Vec<ClippingPlane> {
    state.settings.clip.all().to_vec()
}

#[test]
fn a_plane_across_an_axis_cuts_the_eyes_side_away_and_is_undone() {
    let mut state = opened(2);
    let eye = state.viewpoint.pose().eye;
    for axis in 0..3 {
        do_all(&mut state, [Command::AddPlane(PlaneBy::Axis(axis))]);
        let plane = planes(&state)[axis];
        let value = |point: DVec3| plane.normal.dot(point) - plane.offset;
        assert_eq!(value(state.bounds().center()), 0.0);
        assert!(value(eye) < 0.0, "{plane:?}");
        assert!(plane.normal.abs() == DVec3::AXES[axis]);
    }
    assert_eq!(
        state.scene_file().map(|file| file.clip),
        Some(state.settings.clip)
    );
    let view = state.view().expect("a view");
    assert_eq!(view.settings.clip, state.settings.clip);
    do_all(&mut state, [Command::Undo, Command::Undo]);
    assert_eq!(planes(&state).len(), 1);
    do_all(&mut state, [Command::Redo]);
    assert_eq!(planes(&state).len(), 2);
}

#[test]
fn moving_a_plane_is_one_change_and_picks_see_what_is_left() {
    let mut state = opened(1);
    let before = |x: f64| ClippingPlane::new(DVec3::NEG_X, -x).expect("a plane");
    do_all(
        &mut state,
        [Command::Look(StandardView::Front), Command::Fit],
    );
    let camera = state.camera().expect("a camera");
    let place = |x: f64| camera.project(DVec3::new(x, 0.1, 0.0)).expect("in front");
    let sees = |state: &State, x: f64| state.pick(place(x).0, place(x).1).is_some();
    assert!(sees(&state, 0.2) && sees(&state, 0.6));
    do_all(&mut state, [Command::AddPlane(PlaneBy::Axis(0))]);
    for x in [0.9, 0.7, 0.4] {
        do_all(&mut state, [Command::SetPlane(0, before(x))]);
    }
    assert_eq!(distance(&planes(&state)[0]), -0.4);
    assert!(sees(&state, 0.2) && !sees(&state, 0.6));
    let off = ClippingPlane {
        enabled: false,
        ..before(0.4)
    };
    do_all(&mut state, [Command::SetPlane(0, off)]);
    assert!(sees(&state, 0.6));
    // An invalid plane is not taken.
    let none = ClippingPlane {
        normal: DVec3::ZERO,
        ..off
    };
    do_all(&mut state, [Command::SetPlane(0, none)]);
    assert_eq!(planes(&state), [off]);
    do_all(&mut state, [Command::Undo]);
    assert_eq!(
        distance(&planes(&state)[0]),
        0.5 * planes(&state)[0].normal.x
    );
    do_all(&mut state, [Command::RemovePlane(0)]);
    assert!(planes(&state).is_empty());
}

#[test]
fn three_clicks_make_a_plane_and_three_on_a_line_none() {
    let mut state = opened(1);
    do_all(
        &mut state,
        [Command::Look(StandardView::Isometric), Command::Fit],
    );
    let camera = state.camera().expect("a camera");
    let click = |x: f64, y: f64| Command::Pin {
        at: camera.project(DVec3::new(x, y, 0.0)).expect("in front"),
        beside: false,
    };
    let corners = [click(0.1, 0.1), click(0.7, 0.1), click(0.1, 0.7)];
    do_all(&mut state, [Command::SetCutting(true)]);
    do_all(&mut state, corners);
    assert!(state.cutting.is_none() && state.picks.current().is_none());
    let [plane] = planes(&state)[..] else {
        panic!("one plane: {:?}", planes(&state));
    };
    assert!((plane.normal.abs() - DVec3::Z).length() < 1e-6, "{plane:?}");
    do_all(&mut state, [Command::Undo]);
    assert!(planes(&state).is_empty());
    do_all(
        &mut state,
        [Command::SetCutting(true), click(0.1, 0.1), Command::Dismiss],
    );
    assert!(state.cutting.is_none());
    do_all(&mut state, [Command::SetCutting(true)]);
    do_all(
        &mut state,
        [click(0.1, 0.1), click(0.1, 0.1), click(0.1, 0.1)],
    );
    assert!(planes(&state).is_empty() && !state.toasts.is_empty());
}

#[test]
fn there_are_no_more_planes_than_can_be() {
    let mut state = opened(1);
    do_all(&mut state, vec![Command::AddPlane(PlaneBy::View); 12]);
    assert_eq!(planes(&state).len(), raycast_core::scene::CLIPPING_PLANES);
}

#[test]
fn the_outline_of_a_plane_is_saved_where_the_person_says() {
    let mut state = opened(1);
    let kind = PromptKind::Outline(0);
    assert_eq!(update(&mut state, Command::Ask(kind)), None, "no plane");
    update(&mut state, Command::AddPlane(PlaneBy::Axis(0)));
    assert_eq!(
        update(&mut state, Command::Ask(kind)),
        Some(Effect::Dialog(kind))
    );
    let prompt = state.prompt.as_ref().expect("a line for the path");
    assert_eq!(prompt.text, "mesh-section.svg");
    let mut give = |name: &str| {
        update(&mut state, Command::TypePath(name.to_owned()));
        let effect = update(&mut state, Command::ConfirmPath);
        (effect, state.errors.pop())
    };
    let (effect, error) = give("cut.pdf");
    assert_eq!(effect, None);
    assert_eq!(
        error.as_deref(),
        Some("cut.pdf: expected a name that ends in .svg or .dxf")
    );
    let saved = |path: &str, replace| {
        Some(Effect::SaveOutline {
            plane: 0,
            path: path.into(),
            replace,
        })
    };
    assert_eq!(give("cut").0, saved("cut.svg", false));
    let taken = Replacing {
        path: "cut.svg".into(),
        by: kind,
    };
    receive(&mut state, News::Taken(taken), Duration::ZERO);
    assert_eq!(update(&mut state, Command::Replace), saved("cut.svg", true));
}
