//! Tests of size, step, tiles and look.

use super::*;

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
    update(&mut state, Command::SetSize(320, 200));
    assert_eq!(
        state.rest_samples(),
        16,
        "a typed size is a picture to save"
    );
    update(&mut state, Command::FitWindow);
    update(&mut state, Command::SetSamples(Some(3)));
    assert_eq!(state.rest_samples(), 3);
    update(&mut state, Command::SetSamples(None));
    update(&mut state, Command::SetRefine(false));
    assert_eq!(state.rest_samples(), 1);
}

#[test]
fn the_legend_is_that_of_the_marked_object_where_it_shows_numbers() {
    let mut state = opened(3);
    let area = ColorRule::Value(Quantity::Area);
    let distance = ColorRule::Value(Quantity::Distance(None));
    for (object, rule) in [(0, area), (1, distance)] {
        update(&mut state, Command::SetColorRule(Some(object), rule));
    }
    let title = |state: &State| state.shown_legend().map(|legend| legend.title.clone());
    assert_eq!(title(&state), None, "no picture is there");
    if let Some(document) = &mut state.document {
        document.built = Arc::clone(&document.scene);
    }
    // The picture's own is the first object's.
    state.legend = state.view().and_then(|view| view.legend()).map(Arc::new);
    for (selected, expected) in [(None, "area"), (Some(1), "distance"), (Some(2), "area")] {
        state.selected = selected;
        assert_eq!(title(&state).as_deref(), Some(expected), "{selected:?}");
    }
    update(&mut state, Command::SetMode(Mode::Depth));
    state.selected = Some(0);
    state.legend = state.view().and_then(|view| view.legend()).map(Arc::new);
    assert_eq!(title(&state).as_deref(), Some("distance"), "depth's own");
}

#[test]
fn the_three_are_bound_together() {
    let state = State::default();
    let plane = state.plane().expect("a good plane");
    let frame = f64::from(plane.rows) * plane.step;
    let d = state.viewpoint.orbit.distance;
    assert!(
        (frame - 2.0 * d * raycast_core::math::tan((DEFAULT_FOV / 2.0).to_radians())).abs() < 1e-12
    );
}

#[test]
fn a_density_follows_the_window() {
    let mut state = State {
        resolution: Resolution::Window { density: 0.25 },
        viewport: (1000, 800),
        ..State::default()
    };
    assert_eq!(state.size(), (250, 200));
    state.viewport = (400, 404);
    assert_eq!(state.size(), (100, 101));
    state.viewport = (0, 0);
    assert_eq!(state.size(), (1, 1));
}

#[test]
fn an_orthographic_eye_stays_before_the_scene() {
    let mut state = State {
        viewpoint: Viewpoint {
            projection: Projection::Orthographic,
            ..Viewpoint::default()
        },
        ..State::default()
    };
    state.viewpoint = state.fitted(state.viewpoint);
    let frame = state.frame_height();
    state.viewpoint.orbit.distance *= 0.01;
    let camera = state.camera().expect("a camera");
    assert!((camera.plane().frame_height() - frame * 0.01).abs() < frame * 1e-9);
    for corner in state.bounds().corners() {
        let depth = (corner - camera.pose().eye).dot(camera.forward());
        assert!(depth >= 0.0, "{corner} lies {depth} before the eye");
    }
}
