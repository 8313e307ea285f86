//! The list of objects, and handles.

use crate::bench::{Bench, click, drag, drag_along, open_two};
use egui::{Key, Modifiers, PointerButton, Role, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use raycast_core::glam::DVec3;
use raycast_core::scene::{Crop, Shape, Texture, TextureProjection};
use raycast_viewer::state::State;
use raycast_viewer::state::command::Command;
use raycast_viewer::state::cut::PlaneBy;
use raycast_viewer::state::effect::Effect;
use raycast_viewer::state::news::{News, receive};
use raycast_viewer::state::part::Part;
use raycast_viewer::state::thumbnail::{TexturePart, Thumbnail};
use raycast_viewer::state::update::update;
use std::sync::Arc;
use std::time::Duration;

fn objects(harness: &Harness<'_, Bench>) -> Vec<(String, bool)> {
    let document = harness.state().state.document.as_ref().expect("a scene");
    let objects = document.scene.objects.iter();
    objects.map(|o| (o.name.clone(), o.visible)).collect()
}

#[test]
fn an_object_is_hidden_by_its_eye_and_undo_brings_it_back() {
    let mut harness = open_two();
    let shown = |harness: &Harness<'_, Bench>| {
        let document = harness.state().state.document.as_ref().expect("a scene");
        assert!(document.is_built(), "at once");
        (document.accel.len(), document.bounds.min.x)
    };
    click(&mut harness, "Hide left one");
    assert_eq!(objects(&harness)[0], ("left one".to_owned(), false));
    assert_eq!(shown(&harness), (1, 2.0));
    harness.get_by_label("Show left one");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run();
    assert!(objects(&harness)[0].1);
    assert_eq!(shown(&harness), (2, 0.0));
    assert!(!harness.state().effects.contains(&Effect::Build));
}

#[test]
fn a_row_stays_marked_when_it_is_clicked_again_and_escape_unmarks() {
    let mut harness = open_two();
    for name in ["left one", "left one", "right one", "right one"] {
        click(&mut harness, name);
        let number = usize::from(name == "right one");
        assert_eq!(harness.state().state.selected, Some(number), "{name}");
        // Further apart than the clicks of a double-click.
        harness.run_steps(60);
    }
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(harness.state().state.selected, None);
}

#[test]
fn a_rectangle_drawn_on_its_image_is_the_part_that_is_shown() {
    let mut harness = open_two();
    let path = std::env::temp_dir().join("skin.png");
    let image = |number: u64, image: Texture| News::Texture {
        number: Some(number),
        path: path.clone(),
        found: Ok(Arc::new(image)),
    };
    let load = |number: u64, part: TexturePart| Effect::LoadTexture {
        number,
        path: path.clone(),
        part,
    };
    let bench = harness.state_mut();
    let whole = Texture::new(64, 32, vec![[200, 150, 100, 255]; 64 * 32]).expect("texels");
    update(
        &mut bench.state,
        Command::LoadTexture(path.clone(), Some(0)),
    );
    receive(&mut bench.state, image(1, whole.clone()), Duration::ZERO);
    click(&mut harness, "left one");
    click(&mut harness, "Whole image");
    assert!(
        harness
            .state()
            .effects
            .contains(&Effect::ReadThumbnail(path.clone()))
    );
    harness.get_by_label("Reading the image…");
    let small = Arc::new(Thumbnail {
        of: (64, 32),
        size: [64, 32],
        texels: whole.texels().to_vec(),
    });
    let news = News::Thumbnail(path.clone(), Ok(small));
    receive(&mut harness.state_mut().state, news, Duration::ZERO);
    harness.run();
    let place = harness
        .get_by_label("The image, with the part that is shown")
        .rect();
    let texel = place.width() / 64.0;
    let at = |x: f32, y: f32| place.min + egui::vec2(x, y) * texel;
    let way = [at(8.5, 4.5), at(40.5, 20.5)];
    let count = harness.state().effects.len();
    drag_along(
        &mut harness,
        PointerButton::Primary,
        Modifiers::NONE,
        way,
        |harness| {
            assert_eq!(
                harness.state().effects.len(),
                count,
                "not while it is drawn"
            );
        },
    );
    let part = TexturePart {
        crop: Some(Crop {
            x: 8,
            y: 4,
            width: 33,
            height: 17,
        }),
        ..TexturePart::default()
    };
    assert_eq!(harness.state().effects[count..], [load(2, part)]);
    // It is told before the image is read again.
    harness.get_by_label("33×17 at 8, 4");
    let cut = part
        .crop
        .and_then(|crop| whole.cropped(crop))
        .expect("a part");
    receive(
        &mut harness.state_mut().state,
        image(2, cut),
        Duration::ZERO,
    );
    harness.run();
    harness.get_by_label("33×17 at 8, 4");
    click(&mut harness, "Show the whole image");
    let whole = load(3, TexturePart::default());
    assert_eq!(harness.state().effects.last(), Some(&whole));
}

#[test]
fn an_object_has_a_mapping_of_its_own() {
    let mut harness = open_two();
    click(&mut harness, "left one");
    assert!(harness.query_by_label("Its mapping").is_none(), "no image");
    let path = std::env::temp_dir().join("skin.png");
    let load = Command::LoadTexture(path.clone(), Some(0));
    let state = &mut harness.state_mut().state;
    update(state, load);
    let news = News::Texture {
        number: Some(1),
        path,
        found: Ok(Arc::new(
            Texture::new(1, 1, vec![[255; 4]]).expect("a texel"),
        )),
    };
    receive(state, news, Duration::ZERO);
    harness.run();
    let list = (Role::ComboBox, "Its mapping");
    harness.get_by_role_and_label(list.0, list.1).click();
    harness.run();
    click(&mut harness, "Sphere");
    let document = harness.state().state.document.as_ref().expect("a scene");
    let own = document
        .scene
        .objects
        .iter()
        .map(|o| o.mapping.projection)
        .collect::<Vec<_>>();
    assert_eq!(own, [Some(TextureProjection::Sphere), None]);
}

#[test]
fn an_object_is_renamed_in_the_list() {
    let mut harness = open_two();
    click(&mut harness, "right one");
    harness.key_press(Key::F2);
    harness.run();
    // The old name is marked: what is typed takes its place.
    harness.event(egui::Event::Text("lid".to_owned()));
    harness.run();
    harness.key_press(Key::Enter);
    harness.run();
    assert_eq!(objects(&harness)[1].0, "lid");
    assert_eq!(harness.state().state.naming, None);

    harness.key_press(Key::F2);
    harness.run();
    harness.event(egui::Event::Text("wrong".to_owned()));
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(objects(&harness)[1].0, "lid", "Esc keeps the name");
}

#[test]
fn the_marked_object_is_moved_turned_and_locked_by_numbers_and_buttons() {
    let mut harness = open_two();
    click(&mut harness, "right one");
    click(&mut harness, "Place");
    click(&mut harness, "Move Y");
    harness.event(egui::Event::Text("1.5".to_owned()));
    harness.key_press(Key::Enter);
    harness.run();
    let transform = |harness: &Harness<'_, Bench>| {
        let document = harness.state().state.document.as_ref().expect("a scene");
        document.scene.objects[1].transform
    };
    assert_eq!(transform(&harness).translate, DVec3::new(2.0, 1.5, 0.0));
    click(&mut harness, "Turn about the scene's Z");
    assert_eq!(transform(&harness).rotate, DVec3::Z * 90.0);
    // All three factors, as it keeps its shape.
    click(&mut harness, "Scale X");
    harness.event(egui::Event::Text("2".to_owned()));
    harness.key_press(Key::Enter);
    harness.run();
    assert_eq!(transform(&harness).scale, DVec3::splat(2.0));
    click(&mut harness, "Lock");
    let locked = transform(&harness);
    click(&mut harness, "Turn about the scene's Z");
    assert_eq!(transform(&harness), locked);
    click(&mut harness, "Unlock right one");
    click(&mut harness, "Put back");
    assert_eq!(transform(&harness).scale, DVec3::ONE);
    for _ in 0..6 {
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        harness.run();
    }
    assert_eq!(transform(&harness).translate, DVec3::new(2.0, 0.0, 0.0));
}

#[test]
fn handles_of_the_marked_object_move_it_and_escape_gives_up() {
    let mut harness = open_two();
    click(&mut harness, "right one");
    harness.key_press(Key::F);
    harness.key_press(Key::G);
    harness.run();
    let place = |state: &State| {
        let document = state.document.as_ref().expect("a scene");
        document.scene.objects[1].transform.translate
    };
    // A point of the window and the same of the picture: from where to where the picture lies.
    let here = pos2(300.0, 300.0);
    harness.event(egui::Event::PointerMoved(here));
    harness.run();
    let (x, y) = harness.state().state.hover.expect("over the picture");
    let corner = here - egui::vec2(x as f32, y as f32);
    let at = |state: &State, axis: usize, points: f64| {
        let manipulator = state.manipulator().expect("handles");
        let camera = state.camera().expect("a camera");
        let (x, y) = camera
            .project(manipulator.along(axis, points))
            .expect("before the eye");
        corner + egui::vec2(x as f32, y as f32)
    };
    let start = place(&harness.state().state);
    let view = harness.state().state.viewpoint;
    let way = |harness: &Harness<'_, Bench>| {
        let state = &harness.state().state;
        [at(state, 0, 70.0), at(state, 0, 130.0)]
    };
    let along = way(&harness);
    drag_along(
        &mut harness,
        PointerButton::Primary,
        Modifiers::NONE,
        along,
        |_| {},
    );
    let state = &harness.state().state;
    let moved = place(state) - start;
    let pixel = state.manipulator().expect("handles").pixel;
    assert!(
        (moved.x / (60.0 * pixel) - 1.0).abs() < 0.02,
        "{moved}: {:?}",
        harness.state().asked
    );
    assert_eq!((moved.y, moved.z), (0.0, 0.0));
    assert_eq!(state.viewpoint, view, "the view stays");
    assert!(
        state.selected == Some(1) && state.picks.current().is_none(),
        "nothing is picked"
    );
    assert_eq!(state.history.undo_name(), Some("Move"));

    let there = place(state);
    let along = way(&harness);
    drag_along(
        &mut harness,
        PointerButton::Primary,
        Modifiers::NONE,
        along,
        |harness| {
            assert_ne!(place(&harness.state().state), there);
            harness.key_press(Key::Escape);
            harness.run();
            assert_eq!(place(&harness.state().state), there);
            harness.event(egui::Event::PointerMoved(pos2(500.0, 700.0)));
            harness.run();
        },
    );
    let state = &harness.state().state;
    assert_eq!((place(state), state.viewpoint), (there, view));
    assert!(!state.manipulating.is_held);

    // Beside the handles the hand orbits as ever, and the right button always does what it does.
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE);
    assert_ne!(harness.state().state.viewpoint, view);
    let view = harness.state().state.viewpoint;
    let along = way(&harness);
    drag_along(
        &mut harness,
        PointerButton::Secondary,
        Modifiers::NONE,
        along,
        |_| {},
    );
    assert_ne!(harness.state().state.viewpoint, view);
    assert_eq!(place(&harness.state().state), there);
}

#[test]
fn rows_are_dragged_onto_others_and_between_them() {
    let mut harness = open_two();
    let listed = |harness: &Harness<'_, Bench>| {
        let document = harness.state().state.document.as_ref().expect("a scene");
        let objects = document.scene.objects.iter();
        let listed = objects.map(|o| (o.name.clone(), o.parent));
        listed.collect::<Vec<_>>()
    };
    let named = |names: [(&str, Option<usize>); 2]| names.map(|(name, of)| (name.to_owned(), of));
    let drop_at = |harness: &mut Harness<'_, Bench>, held: &str, on: &str, share: f32| {
        let from = harness.get_by_label(held).rect().center();
        let rect = harness.get_by_label(on).rect();
        let to = pos2(rect.center().x, rect.top() + rect.height() * share);
        drag_along(
            harness,
            PointerButton::Primary,
            Modifiers::NONE,
            [from, to],
            |_| {},
        );
    };
    // Above the first, onto it, and back below it, between the rows.
    drop_at(&mut harness, "right one", "left one", 0.1);
    assert_eq!(
        listed(&harness),
        named([("right one", None), ("left one", None)])
    );
    drop_at(&mut harness, "left one", "right one", 0.5);
    let below = named([("right one", None), ("left one", Some(0))]);
    assert_eq!(listed(&harness), below);
    drop_at(&mut harness, "left one", "right one", 0.1);
    assert_eq!(
        listed(&harness),
        named([("left one", None), ("right one", None)])
    );
    // Below one that has a child is before that child.
    drop_at(&mut harness, "right one", "left one", 0.5);
    assert_eq!(
        listed(&harness),
        named([("left one", None), ("right one", Some(0))])
    );
    // The strip below the list takes it away from its parent.
    let from = harness.get_by_label("right one").rect().center();
    let rect = harness.get_by_label("right one").rect();
    let strip = pos2(rect.center().x, rect.bottom() + rect.height() * 0.75);
    drag_along(
        &mut harness,
        PointerButton::Primary,
        Modifiers::NONE,
        [from, strip],
        |_| {},
    );
    assert_eq!(
        listed(&harness),
        named([("left one", None), ("right one", None)])
    );
    // By keys: up, and no further.
    click(&mut harness, "right one");
    for _ in 0..2 {
        harness.key_press_modifiers(Modifiers::ALT, Key::ArrowUp);
        harness.run();
    }
    assert_eq!(
        listed(&harness),
        named([("right one", None), ("left one", None)])
    );
    harness.key_press_modifiers(Modifiers::ALT, Key::ArrowDown);
    harness.run();
    assert_eq!(
        listed(&harness),
        named([("left one", None), ("right one", None)])
    );
}

#[test]
fn a_shape_is_put_in_by_the_menu_and_changed_by_numbers() {
    let mut harness = open_two();
    click(&mut harness, "Add");
    click(&mut harness, "Torus");
    let shape = |harness: &Harness<'_, Bench>| {
        let document = harness.state().state.document.as_ref().expect("a scene");
        document.scene.objects[2].shape.expect("a shape")
    };
    assert_eq!(objects(&harness)[2].0, "torus");
    click(&mut harness, "Its tube");
    harness.event(egui::Event::Text("0.5".to_owned()));
    harness.key_press(Key::Enter);
    harness.run();
    assert_eq!(
        shape(&harness),
        Shape::Torus {
            radius: 1.0,
            tube: 0.5,
            segments: 64,
            rings: 32
        }
    );
}

#[test]
fn nothing_in_the_panel_changes_its_width() {
    let mut harness = open_two();
    // Low enough for the panel to scroll.
    harness.set_size(egui::vec2(1280.0, 720.0));
    harness.run();
    click(&mut harness, "right one");
    let room = harness.state().state.viewport;
    click(&mut harness, "Plain");
    let right = harness.get_by_label("Random").rect().right();
    assert!(right <= 1270.0, "{right}");
    let state = &mut harness.state_mut().state;
    update(state, Command::AddPlane(PlaneBy::Axis(1)));
    update(state, Command::AddBookmark);
    for part in [Part::Cut, Part::Camera, Part::Picture] {
        update(&mut harness.state_mut().state, Command::OpenPart(part));
        harness.run();
        assert_eq!(harness.state().state.viewport, room, "{part:?}");
    }
    // Not even if rows have too little room.
    harness
        .ctx
        .all_styles_mut(|style| style.spacing.button_padding.x = 20.0);
    harness.run();
    assert!(harness.get_by_label("Keep view").rect().width() > 80.0);
    assert_eq!(harness.state().state.viewport, room);
}
