//! The registry of commands: what each is called, its keys, when it can be used, what it does. Menus, keys,
//! palette, help and tooltips are all read from here.

use super::modes::MODES;
use crate::state::command::Command;
use crate::state::preferences::Theme;
use crate::state::update::middle;
use crate::state::viewpoint::StandardView;
use crate::state::{PromptKind, State};
use egui::Key;
use raycast_core::camera::Projection;

/// A menu, in the order of the menu bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Menu {
    /// Opening and saving.
    File,
    /// Undo, and objects.
    Edit,
    /// The camera.
    View,
    /// What the picture shows.
    Look,
    /// The window and how it works.
    Window,
    /// Help.
    Help,
}

impl Menu {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::File,
        Self::Edit,
        Self::View,
        Self::Look,
        Self::Window,
        Self::Help,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::File => "File",
            Self::Edit => "Edit",
            Self::View => "View",
            Self::Look => "Look",
            Self::Window => "Window",
            Self::Help => "Help",
        }
    }
}

/// A key with what is held down beside it. For keys that are symbols Shift does not count: where it is
/// needed to type them differs between keyboards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chord {
    /// Ctrl, or ⌘ on a Mac.
    pub ctrl: bool,
    /// Shift.
    pub shift: bool,
    /// Alt.
    pub alt: bool,
    /// The key.
    pub key: Key,
}

const fn plain(key: Key) -> Chord {
    Chord {
        ctrl: false,
        shift: false,
        alt: false,
        key,
    }
}

const fn ctrl(key: Key) -> Chord {
    Chord {
        ctrl: true,
        ..plain(key)
    }
}

const fn ctrl_shift(key: Key) -> Chord {
    Chord {
        shift: true,
        ..ctrl(key)
    }
}

const fn shift(key: Key) -> Chord {
    Chord {
        shift: true,
        ..plain(key)
    }
}

const fn alt(key: Key) -> Chord {
    Chord {
        alt: true,
        ..plain(key)
    }
}

impl Chord {
    /// Whether a key that was pressed is this one.
    pub fn is(&self, key: Key, modifiers: egui::Modifiers) -> bool {
        self.key == key
            && self.ctrl == modifiers.command
            && self.alt == modifiers.alt
            && (self.shift == modifiers.shift || is_symbol(key))
    }

    /// As it is written in menus: `Ctrl+Shift+S`.
    pub fn name(&self) -> String {
        let mut name = String::new();
        for (held, modifier) in [
            (
                self.ctrl,
                if cfg!(target_os = "macos") {
                    "⌘"
                } else {
                    "Ctrl+"
                },
            ),
            (self.alt, "Alt+"),
            (self.shift, "Shift+"),
        ] {
            if held {
                name.push_str(modifier);
            }
        }
        name.push_str(match self.key {
            Key::ArrowLeft => "Left",
            Key::ArrowRight => "Right",
            Key::ArrowUp => "Up",
            Key::ArrowDown => "Down",
            Key::PageUp => "Page Up",
            Key::PageDown => "Page Down",
            Key::Questionmark => "?",
            Key::Plus => "+",
            Key::Equals => "=",
            Key::Minus => "−",
            Key::Comma => ",",
            Key::Period => ".",
            key => key.name(),
        });
        name
    }

    /// Whether it means the same while a person types: it is no letter, and not what fields for text use
    /// themselves.
    fn works_while_typing(&self) -> bool {
        let is_function = matches!(self.key, Key::F1 | Key::F5);
        is_function || (self.ctrl && matches!(self.key, Key::O | Key::S | Key::P | Key::E | Key::Q))
    }
}

fn is_symbol(key: Key) -> bool {
    matches!(
        key,
        Key::Plus | Key::Equals | Key::Minus | Key::Questionmark | Key::Comma | Key::Period
    )
}

/// An entry: something that can be asked for without more being said.
pub struct Action {
    /// What it is called in files and tests: `menu.word`.
    pub id: &'static str,
    /// What it is called in menus.
    pub name: &'static str,
    /// What it does, in a sentence for tooltips and help.
    pub does: &'static str,
    /// Keys, the first of which is shown.
    pub keys: &'static [Chord],
    /// Its menu.
    pub menu: Menu,
    /// Whether a line is drawn above it there.
    pub is_first_of_group: bool,
    /// Whether it can be used now.
    pub applies: fn(&State) -> bool,
    /// Whether it is on, if it is something that is on or off.
    pub is_on: Option<fn(&State) -> bool>,
    /// What it asks for.
    pub command: fn(&State) -> Command,
}

impl Action {
    /// Its first key as text; empty where it has none.
    pub fn key(&self) -> String {
        self.keys.first().map(Chord::name).unwrap_or_default()
    }

    /// What it does, and its key: for tooltips.
    pub fn hint(&self) -> String {
        match self.keys.first() {
            Some(key) => format!("{} ({})", self.does, key.name()),
            None => self.does.to_owned(),
        }
    }

    const fn of(
        menu: Menu,
        id: &'static str,
        name: &'static str,
        does: &'static str,
        keys: &'static [Chord],
        command: fn(&State) -> Command,
    ) -> Self {
        Self {
            id,
            name,
            does,
            keys,
            menu,
            is_first_of_group: false,
            applies: |_| true,
            is_on: None,
            command,
        }
    }

    const fn when(self, applies: fn(&State) -> bool) -> Self {
        Self { applies, ..self }
    }

    const fn on(self, is_on: fn(&State) -> bool) -> Self {
        Self {
            is_on: Some(is_on),
            ..self
        }
    }

    const fn apart(self) -> Self {
        Self {
            is_first_of_group: true,
            ..self
        }
    }
}

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
                Projection::Orthographic => Projection::Perspective,
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

/// The entry of this id.
///
/// # Panics
/// Where there is none: ids are written in this program alone, and a test asks for each.
pub fn action(id: &str) -> &'static Action {
    ACTIONS
        .iter()
        .find(|action| action.id == id)
        .unwrap_or_else(|| panic!("there is no command {id}"))
}

/// What a key asks for; while a person types, only keys that cannot be meant for the text do.
pub fn pressed(
    state: &State,
    is_typing: bool,
    key: Key,
    modifiers: egui::Modifiers,
) -> Option<Command> {
    let is_it =
        |chord: &&Chord| chord.is(key, modifiers) && (!is_typing || chord.works_while_typing());
    let action = ACTIONS
        .iter()
        .find(|action| action.keys.iter().any(|chord| is_it(&chord)))?;
    (action.applies)(state).then(|| (action.command)(state))
}

/// Entries whose names have every word of `text`, those that begin with it first.
pub fn found(text: &str) -> Vec<&'static Action> {
    let text = text.trim().to_lowercase();
    let words: Vec<_> = text.split_whitespace().collect();
    let mut found: Vec<_> = ACTIONS
        .iter()
        .filter(|action| {
            let name = format!("{} {} {}", action.menu.name(), action.name, action.does);
            let name = name.to_lowercase();
            words.iter().all(|word| name.contains(word))
        })
        .collect();
    let rank = |action: &Action| {
        let name = action.name.to_lowercase();
        match name {
            _ if name.starts_with(&text) => 0,
            _ if words.iter().all(|word| name.contains(word)) => 1,
            _ => 2,
        }
    };
    found.sort_by_key(|action| rank(action));
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::Modifiers;
    use raycast_core::shade::Mode;

    #[test]
    fn no_two_commands_have_the_same_key_or_id() {
        for (number, one) in ACTIONS.iter().enumerate() {
            for other in &ACTIONS[number + 1..] {
                assert_ne!(one.id, other.id);
                for chord in one.keys {
                    // Shift does not tell symbols apart.
                    let modifiers = Modifiers {
                        alt: chord.alt,
                        ctrl: chord.ctrl,
                        command: chord.ctrl,
                        shift: chord.shift,
                        ..Modifiers::NONE
                    };
                    let clash = other
                        .keys
                        .iter()
                        .any(|other| other.is(chord.key, modifiers));
                    assert!(!clash, "{}: {} and {}", chord.name(), one.id, other.id);
                }
            }
        }
    }

    #[test]
    fn every_command_says_what_it_does_and_has_its_menu() {
        for action in ACTIONS {
            assert!(
                !action.name.is_empty() && action.does.len() > 4,
                "{}",
                action.id
            );
            assert!(Menu::ALL.contains(&action.menu));
        }
        // Menus are read off in order: each is in one piece.
        let mut menus: Vec<_> = ACTIONS.iter().map(|action| action.menu).collect();
        menus.dedup();
        assert_eq!(menus, Menu::ALL);
    }

    #[test]
    fn keys_ask_for_what_the_registry_says() {
        let mut state = State::default();
        let press = |state: &State, key, modifiers| pressed(state, false, key, modifiers);
        assert_eq!(
            press(&state, Key::Num5, Modifiers::ALT),
            Some(Command::SetMode(Mode::Depth))
        );
        assert_eq!(
            press(&state, Key::W, Modifiers::NONE),
            Some(Command::SetWireframe(true))
        );
        state.settings.shading.wireframe = Some(Default::default());
        assert_eq!(
            press(&state, Key::W, Modifiers::NONE),
            Some(Command::SetWireframe(false))
        );
        assert_eq!(
            press(&state, Key::Plus, Modifiers::SHIFT),
            Some(Command::ScaleStep(0.5))
        );
        assert_eq!(
            press(&state, Key::Z, Modifiers::COMMAND),
            None,
            "nothing to undo"
        );
        assert_eq!(pressed(&state, true, Key::W, Modifiers::NONE), None);
        assert_eq!(
            pressed(&state, true, Key::O, Modifiers::COMMAND),
            Some(Command::Ask(PromptKind::Open))
        );
    }

    #[test]
    fn commands_are_found_by_words_of_their_names() {
        assert_eq!(found("fit")[0].id, "view.fit");
        assert_eq!(found("save pic")[0].id, "file.picture");
        assert_eq!(found("").len(), ACTIONS.len());
        assert!(found("no such thing").is_empty());
    }
}
