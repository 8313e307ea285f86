//! The list of commands, in the order of their menus.

use super::action::{Action, Menu};
use super::chord::{alt, ctrl, ctrl_shift, plain, shift};
use crate::state::command::Command;
use crate::state::cut::{PlaneBy, has_room};
use crate::state::measure::Kind;
use crate::state::preferences::{Mouse, Theme};
use crate::state::update::middle;
use crate::state::viewpoint::StandardView;
use crate::state::{PromptKind, State};
use crate::ui::modes::MODES;
use egui::Key;
use raycast_core::camera::Projection;
use raycast_core::glam::DAffine3;
use raycast_core::scene::Transform;

fn has_scene(state: &State) -> bool {
    state.document.is_some()
}

fn has_files(state: &State) -> bool {
    let document = state.document.as_ref();
    document.is_some_and(|document| !document.paths.is_empty())
}

fn has_selected(state: &State) -> bool {
    state.selected.is_some()
}

/// The marked object; commands on it apply only where there is one.
fn selected(state: &State) -> usize {
    state.selected.unwrap_or(usize::MAX)
}

fn is_visible(state: &State) -> bool {
    let document = state.document.as_ref();
    let object = document.and_then(|d| d.scene.objects.get(selected(state)));
    object.is_some_and(|object| object.visible)
}

fn transform(state: &State) -> Option<Transform> {
    let document = state.document.as_ref()?;
    let object = document.scene.objects.get(selected(state))?;
    Some(object.transform)
}

/// Where the marked object's file has it, or the file's own matrix where it was read as changed.
fn rest(state: &State) -> Transform {
    let matrix = transform(state).map_or(DAffine3::IDENTITY, |transform| transform.matrix);
    Transform::from_matrix(matrix)
}

fn look(state: &State, view: StandardView) -> bool {
    let orbit = &state.viewpoint.orbit;
    let (yaw, pitch) = view.angles();
    state.viewpoint.roll == 0.0 && (orbit.yaw, orbit.pitch) == (yaw, pitch)
}

macro_rules! view {
    ($id:literal, $name:literal, $view:ident, $keys:expr) => {
        Action::of(
            Menu::View,
            $id,
            $name,
            concat!("Look from this side: ", $name),
            $keys,
            |_| Command::Look(StandardView::$view),
        )
        .when(has_scene)
        .on(|state| look(state, StandardView::$view))
    };
}

macro_rules! mouse {
    ($id:literal, $name:literal, $does:literal, $habits:ident) => {
        Action::of(Menu::Window, $id, $name, $does, &[], |_| {
            Command::SetMouse(Mouse::$habits)
        })
        .on(|state| state.preferences.mouse == Mouse::$habits)
    };
}

macro_rules! tool {
    ($id:literal, $name:literal, $does:literal, $kind:ident, $keys:expr) => {
        Action::of(Menu::Tools, $id, $name, $does, $keys, |state| {
            let is_on = state.measuring.tool == Some(Kind::$kind);
            Command::SetTool((!is_on).then_some(Kind::$kind))
        })
        .when(has_scene)
        .on(|state| state.measuring.tool == Some(Kind::$kind))
    };
}

macro_rules! cut {
    ($id:literal, $name:literal, $does:literal, $by:expr) => {
        Action::of(Menu::Tools, $id, $name, $does, &[], |_| {
            Command::AddPlane($by)
        })
        .when(has_room)
    };
}

macro_rules! mode {
    ($number:literal, $key:ident) => {
        Action::of(
            Menu::Look,
            concat!("look.mode.", $number),
            MODES[$number - 1].1,
            MODES[$number - 1].2,
            &[alt(Key::$key)],
            |_| Command::SetMode(MODES[$number - 1].0),
        )
        .on(|state| state.settings.shading.mode == MODES[$number - 1].0)
    };
}

/// The mode so many places behind the one that is shown.
fn mode_after(state: &State, step: usize) -> Command {
    let now = MODES
        .iter()
        .position(|(mode, ..)| *mode == state.settings.shading.mode)
        .unwrap_or(0);
    Command::SetMode(MODES[(now + step) % MODES.len()].0)
}

fn turn(yaw: f64, pitch: f64) -> Command {
    Command::Orbit { yaw, pitch }
}

/// How much larger or smaller the interface gets at a time.
const SCALE_STEP: f32 = 1.1;

/// All of them, in the order of their menus.
pub static ACTIONS: &[Action] = &[
    Action::of(
        Menu::File,
        "file.open",
        "Open…",
        "Open meshes or a scene",
        &[ctrl(Key::O)],
        |_| Command::Ask(PromptKind::Open),
    ),
    Action::of(
        Menu::File,
        "file.add",
        "Add…",
        "Put more meshes beside what is open",
        &[ctrl_shift(Key::O)],
        |_| Command::Ask(PromptKind::Add),
    ),
    Action::of(
        Menu::File,
        "file.next",
        "Next in folder",
        "Open the folder's next file",
        &[ctrl(Key::PageDown)],
        |_| Command::OpenNeighbor(1),
    )
    .when(has_files)
    .apart(),
    Action::of(
        Menu::File,
        "file.previous",
        "Previous in folder",
        "Open the file before this one in its folder",
        &[ctrl(Key::PageUp)],
        |_| Command::OpenNeighbor(-1),
    )
    .when(has_files),
    Action::of(
        Menu::File,
        "file.reload",
        "Reload",
        "Read the files once more; the camera stays",
        &[plain(Key::F5)],
        |_| Command::Reload,
    )
    .when(has_files),
    Action::of(
        Menu::File,
        "file.watch",
        "Reload when changed",
        "Read files again when they change on the disk",
        &[],
        |state| Command::SetWatch(!state.preferences.watch),
    )
    .on(|state| state.preferences.watch),
    Action::of(
        Menu::File,
        "file.save",
        "Save scene",
        "Write objects, camera and look to a scene file",
        &[ctrl(Key::S)],
        |_| Command::SaveScene,
    )
    .when(has_scene)
    .apart(),
    Action::of(
        Menu::File,
        "file.save_as",
        "Save scene as…",
        "Write the scene to another file",
        &[ctrl_shift(Key::S)],
        |_| Command::Ask(PromptKind::Scene),
    )
    .when(has_scene),
    Action::of(
        Menu::File,
        "file.picture",
        "Save picture…",
        "Write the picture as PNG, PPM, JPEG or EXR",
        &[ctrl(Key::E), plain(Key::S)],
        |_| Command::Ask(PromptKind::Picture),
    )
    .when(has_scene),
    Action::of(
        Menu::File,
        "file.command",
        "Copy as command",
        "Copy the raycast render line that makes this very picture, byte for byte",
        &[ctrl_shift(Key::E)],
        |_| Command::CopyCommand,
    )
    .when(has_scene),
    Action::of(
        Menu::File,
        "file.quit",
        "Quit",
        "Close the window",
        &[ctrl(Key::Q)],
        |_| Command::Close,
    )
    .apart(),
    Action::of(
        Menu::Edit,
        "edit.undo",
        "Undo",
        "Take the last change back",
        &[ctrl(Key::Z)],
        |_| Command::Undo,
    )
    .when(|state| state.history.undo_name().is_some()),
    Action::of(
        Menu::Edit,
        "edit.redo",
        "Redo",
        "Make again what was taken back",
        &[ctrl_shift(Key::Z), ctrl(Key::Y)],
        |_| Command::Redo,
    )
    .when(|state| state.history.redo_name().is_some()),
    Action::of(
        Menu::Edit,
        "object.visible",
        "Visible",
        "Show the marked object, or hide it",
        &[plain(Key::H)],
        |state| Command::SetVisible(selected(state), !is_visible(state)),
    )
    .when(has_selected)
    .on(is_visible)
    .apart(),
    Action::of(
        Menu::Edit,
        "object.isolate",
        "Isolate",
        "Show the marked object alone; once more shows all",
        &[plain(Key::I)],
        |state| Command::Isolate(selected(state)),
    )
    .when(has_selected),
    Action::of(
        Menu::Edit,
        "object.show_all",
        "Show all",
        "Show every object",
        &[shift(Key::H)],
        |_| Command::ShowAll,
    )
    .when(|state| {
        let document = state.document.as_ref();
        document.is_some_and(|d| d.scene.objects.iter().any(|object| !object.visible))
    }),
    Action::of(
        Menu::Edit,
        "object.rename",
        "Rename…",
        "Give the marked object another name",
        &[plain(Key::F2)],
        |state| Command::EditName(state.selected),
    )
    .when(has_selected),
    Action::of(
        Menu::Edit,
        "object.duplicate",
        "Duplicate",
        "Put a copy beside the marked object",
        &[ctrl(Key::D)],
        |state| Command::Duplicate(selected(state)),
    )
    .when(has_selected),
    Action::of(
        Menu::Edit,
        "object.lock",
        "Lock",
        "Keep the marked object as it is until it is unlocked",
        &[plain(Key::L)],
        |state| Command::SetLocked(selected(state), !state.is_locked(selected(state))),
    )
    .when(has_selected)
    .on(|state| state.is_locked(selected(state))),
    Action::of(
        Menu::Edit,
        "object.texture",
        "Texture…",
        "Put an image on the marked object",
        &[],
        |state| Command::Ask(PromptKind::TextureOf(selected(state))),
    )
    .when(has_selected),
    Action::of(
        Menu::Edit,
        "object.reset",
        "Put back",
        "Undo every move, turn and scale of the marked object",
        &[],
        |state| Command::SetTransform(selected(state), rest(state)),
    )
    .when(|state| has_selected(state) && transform(state) != Some(rest(state))),
    Action::of(
        Menu::Edit,
        "object.delete",
        "Delete",
        "Take the marked object away",
        &[plain(Key::Delete)],
        |state| Command::Delete(selected(state)),
    )
    .when(has_selected),
    Action::of(
        Menu::View,
        "view.fit",
        "Fit",
        "Bring all that is visible into view",
        &[plain(Key::F), plain(Key::Home)],
        |_| Command::Fit,
    )
    .when(has_scene),
    Action::of(
        Menu::View,
        "view.reset",
        "Reset",
        "The view that the scene was first shown from",
        &[plain(Key::R)],
        |_| Command::ResetView,
    )
    .when(has_scene),
    Action::of(
        Menu::View,
        "view.back",
        "Back",
        "The view before",
        &[alt(Key::ArrowLeft)],
        |_| Command::ViewBack,
    )
    .when(|state| state.trail.has_past()),
    Action::of(
        Menu::View,
        "view.forward",
        "Forward",
        "The view that was come back from",
        &[alt(Key::ArrowRight)],
        |_| Command::ViewForward,
    )
    .when(|state| state.trail.has_future()),
    Action::of(
        Menu::View,
        "view.walk",
        "Walk",
        "Walk through the scene: W A S D, E and Q, a drag looks around, the wheel changes speed",
        &[shift(Key::W)],
        |state| Command::SetWalk(state.walk.is_none()),
    )
    .when(has_scene)
    .on(|state| state.walk.is_some())
    .apart(),
    Action::of(
        Menu::View,
        "view.bookmark",
        "Keep view",
        "Keep this view in the list of the panel's part Camera",
        &[plain(Key::B)],
        |_| Command::AddBookmark,
    )
    .when(has_scene)
    .apart(),
    Action::of(
        Menu::View,
        "view.copy",
        "Copy camera",
        "Copy the camera as options of raycast render; Ctrl+C does the same, and Ctrl+V goes to one",
        &[],
        |_| Command::CopyCamera,
    )
    .when(has_scene),
    view!("view.front", "Front", Front, &[plain(Key::Num1)]).apart(),
    view!("view.back_side", "Back side", Back, &[ctrl(Key::Num1)]),
    view!("view.right", "Right", Right, &[plain(Key::Num3)]),
    view!("view.left", "Left", Left, &[ctrl(Key::Num3)]),
    view!("view.top", "Top", Top, &[plain(Key::Num7)]),
    view!("view.bottom", "Bottom", Bottom, &[ctrl(Key::Num7)]),
    view!(
        "view.isometric",
        "Isometric",
        Isometric,
        &[plain(Key::Num0)]
    ),
    Action::of(
        Menu::View,
        "view.opposite",
        "Opposite",
        "Look from the other side",
        &[plain(Key::Num9)],
        |_| Command::LookBack,
    )
    .when(has_scene),
    Action::of(
        Menu::View,
        "view.orthographic",
        "Orthographic",
        "Rays side by side, or all from the eye",
        &[plain(Key::Num5), plain(Key::O)],
        |state| {
            Command::SetProjection(match state.viewpoint.projection {
                Projection::Perspective => Projection::Orthographic,
                Projection::Orthographic | Projection::Panoramic(_) => Projection::Perspective,
            })
        },
    )
    .on(|state| state.viewpoint.projection == Projection::Orthographic)
    .apart(),
    Action::of(
        Menu::View,
        "view.orbit_left",
        "Orbit left",
        "Turn about the pivot by 5°",
        &[plain(Key::ArrowLeft), plain(Key::Num4)],
        |_| turn(-5.0, 0.0),
    )
    .apart(),
    Action::of(
        Menu::View,
        "view.orbit_right",
        "Orbit right",
        "Turn about the pivot by 5°",
        &[plain(Key::ArrowRight), plain(Key::Num6)],
        |_| turn(5.0, 0.0),
    ),
    Action::of(
        Menu::View,
        "view.orbit_up",
        "Orbit up",
        "Turn about the pivot by 5°",
        &[plain(Key::ArrowUp), plain(Key::Num8)],
        |_| turn(0.0, 5.0),
    ),
    Action::of(
        Menu::View,
        "view.orbit_down",
        "Orbit down",
        "Turn about the pivot by 5°",
        &[plain(Key::ArrowDown), plain(Key::Num2)],
        |_| turn(0.0, -5.0),
    ),
    Action::of(
        Menu::View,
        "view.roll_left",
        "Roll left",
        "Roll the camera by 15°",
        &[plain(Key::Comma)],
        |_| Command::Roll(-15.0),
    ),
    Action::of(
        Menu::View,
        "view.roll_right",
        "Roll right",
        "Roll the camera by 15°",
        &[plain(Key::Period)],
        |_| Command::Roll(15.0),
    ),
    Action::of(
        Menu::View,
        "view.nearer",
        "Nearer",
        "Zoom in on the middle",
        &[plain(Key::PageUp)],
        |state| Command::Zoom {
            at: middle(state),
            factor: 0.8,
        },
    ),
    Action::of(
        Menu::View,
        "view.further",
        "Further",
        "Zoom out",
        &[plain(Key::PageDown)],
        |state| Command::Zoom {
            at: middle(state),
            factor: 1.25,
        },
    ),
    mode!(1, Num1),
    mode!(2, Num2),
    mode!(3, Num3),
    mode!(4, Num4),
    mode!(5, Num5),
    mode!(6, Num6),
    mode!(7, Num7),
    mode!(8, Num8),
    mode!(9, Num9),
    Action::of(
        Menu::Look,
        "look.next_mode",
        "Next mode",
        "Show the next mode",
        &[plain(Key::M)],
        |state| mode_after(state, 1),
    )
    .apart(),
    Action::of(
        Menu::Look,
        "look.previous_mode",
        "Previous mode",
        "Show the mode before",
        &[shift(Key::M)],
        |state| mode_after(state, MODES.len() - 1),
    ),
    Action::of(
        Menu::Look,
        "look.wireframe",
        "Wireframe",
        "Lines along the triangles' edges, over any mode",
        &[plain(Key::W)],
        |state| Command::SetWireframe(state.settings.shading.wireframe.is_none()),
    )
    .on(|state| state.settings.shading.wireframe.is_some())
    .apart(),
    Action::of(
        Menu::Look,
        "look.borders",
        "Tile borders",
        "Lines between tiles",
        &[plain(Key::T)],
        |state| Command::SetBorders(!state.overlay.borders),
    )
    .on(|state| state.overlay.borders),
    Action::of(
        Menu::Look,
        "look.texture",
        "Load texture…",
        "Put an image on every object",
        &[],
        |_| Command::Ask(PromptKind::Texture),
    )
    .when(has_scene),
    Action::of(
        Menu::Look,
        "look.denser",
        "Halve the step",
        "Half the step: denser rays",
        &[plain(Key::Plus), plain(Key::Equals)],
        |_| Command::ScaleStep(0.5),
    )
    .apart(),
    Action::of(
        Menu::Look,
        "look.sparser",
        "Double the step",
        "Double the step: sparser rays",
        &[plain(Key::Minus)],
        |_| Command::ScaleStep(2.0),
    ),
    Action::of(
        Menu::Look,
        "look.refine",
        "More samples at rest",
        "16 rays a pixel when nothing moves, so that edges are clean",
        &[],
        |state| Command::SetRefine(!state.preferences.refine),
    )
    .on(|state| state.preferences.refine),
    tool!(
        "measure.distance",
        "Measure distance",
        "Measure from a point to another",
        Distance,
        &[plain(Key::D)]
    ),
    tool!(
        "measure.angle",
        "Measure angle",
        "Measure the angle at the second of three points",
        Angle,
        &[plain(Key::A)]
    ),
    tool!(
        "measure.path",
        "Measure path",
        "Measure along points, one after another",
        Path,
        &[]
    ),
    tool!(
        "measure.radius",
        "Measure radius",
        "Measure the circle through three points",
        Radius,
        &[]
    ),
    Action::of(
        Menu::Tools,
        "measure.end",
        "End path",
        "End the path that is being measured",
        &[plain(Key::Enter)],
        |_| Command::EndPath,
    )
    .when(|state| state.measuring.tool == Some(Kind::Path) && state.measuring.points.len() > 1),
    Action::of(
        Menu::Tools,
        "measure.back",
        "Take point back",
        "Take back the last point of what is being measured",
        &[plain(Key::Backspace)],
        |_| Command::TakePointBack,
    )
    .when(|state| !state.measuring.points.is_empty()),
    Action::of(
        Menu::Tools,
        "measure.save",
        "Save CSV…",
        "Write what was measured to a file",
        &[],
        |_| Command::Ask(PromptKind::Measurements),
    )
    .when(|state| !state.measuring.list.is_empty())
    .apart(),
    Action::of(
        Menu::Tools,
        "measure.clear",
        "Clear",
        "Forget all that was measured",
        &[],
        |_| Command::ClearMeasurements,
    )
    .when(|state| !state.measuring.list.is_empty()),
    cut!(
        "cut.x",
        "Cut across X",
        "Cut away what is before a plane across the X axis",
        PlaneBy::Axis(0)
    )
    .apart(),
    cut!(
        "cut.y",
        "Cut across Y",
        "Cut away what is before a plane across the Y axis",
        PlaneBy::Axis(1)
    ),
    cut!(
        "cut.z",
        "Cut across Z",
        "Cut away what is before a plane across the Z axis",
        PlaneBy::Axis(2)
    ),
    cut!(
        "cut.view",
        "Cut across the view",
        "Cut away what is before the point that one turns about",
        PlaneBy::View
    ),
    Action::of(
        Menu::Tools,
        "cut.points",
        "Cut through three points",
        "Click three points: what is before their plane is cut away",
        &[],
        |state| Command::SetCutting(state.cutting.is_none()),
    )
    .when(has_room)
    .on(|state| state.cutting.is_some()),
    Action::of(
        Menu::Tools,
        "tools.check",
        "Check the mesh",
        "Look for holes and other faults in the marked object, or in all",
        &[],
        |_| Command::Check,
    )
    .when(has_scene)
    .apart(),
    Action::of(
        Menu::Window,
        "window.panel",
        "Panel",
        "Show or hide the panel",
        &[plain(Key::P), plain(Key::N)],
        |_| Command::TogglePanel,
    )
    .on(|state| state.panel),
    Action::of(
        Menu::Window,
        "window.smooth",
        "Smooth camera",
        "The camera takes 200 ms from one view to another",
        &[],
        |state| Command::SetSmooth(!state.preferences.smooth),
    )
    .on(|state| state.preferences.smooth),
    mouse!(
        "window.mouse",
        "Mouse of a viewer",
        "Left drag orbits; right, middle or Shift+left drag pans",
        Viewer
    )
    .apart(),
    mouse!(
        "window.mouse_blender",
        "Mouse as in Blender",
        "Middle drag orbits, with Shift it pans, with Ctrl it zooms",
        Blender
    ),
    mouse!(
        "window.mouse_cad",
        "Mouse as in CAD",
        "Right drag orbits, middle drag pans",
        Cad
    ),
    Action::of(
        Menu::Window,
        "window.system_theme",
        "Theme of the system",
        "Light or dark, as the desktop is",
        &[],
        |_| Command::SetTheme(Theme::System),
    )
    .on(|state| state.preferences.theme == Theme::System)
    .apart(),
    Action::of(
        Menu::Window,
        "window.light_theme",
        "Light theme",
        "Light panels",
        &[],
        |_| Command::SetTheme(Theme::Light),
    )
    .on(|state| state.preferences.theme == Theme::Light),
    Action::of(
        Menu::Window,
        "window.dark_theme",
        "Dark theme",
        "Dark panels",
        &[],
        |_| Command::SetTheme(Theme::Dark),
    )
    .on(|state| state.preferences.theme == Theme::Dark),
    Action::of(
        Menu::Window,
        "window.larger",
        "Larger interface",
        "Larger text and buttons",
        &[ctrl(Key::Plus), ctrl(Key::Equals)],
        |state| Command::SetScale(state.preferences.scale * SCALE_STEP),
    )
    .apart(),
    Action::of(
        Menu::Window,
        "window.smaller",
        "Smaller interface",
        "Smaller text and buttons",
        &[ctrl(Key::Minus)],
        |state| Command::SetScale(state.preferences.scale / SCALE_STEP),
    ),
    Action::of(
        Menu::Window,
        "window.scale",
        "Interface as the system has it",
        "Text and buttons of the size that the desktop asks for",
        &[ctrl(Key::Num0)],
        |_| Command::SetScale(1.0),
    ),
    Action::of(
        Menu::Help,
        "help.palette",
        "All commands…",
        "Find a command by its name",
        &[ctrl(Key::P)],
        |_| Command::TogglePalette,
    ),
    Action::of(
        Menu::Help,
        "help.keys",
        "Keys and gestures…",
        "All keys and gestures of the mouse",
        &[plain(Key::F1), plain(Key::Questionmark)],
        |_| Command::ToggleHelp,
    ),
];
