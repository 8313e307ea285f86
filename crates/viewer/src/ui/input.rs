//! Keys and mouse to commands. The table of keys is also what the help shows.

use crate::state::command::Command;
use crate::state::update::middle;
use crate::state::{Overlay, PromptKind, State};
use egui::{Key, KeyboardShortcut, Modifiers};
use raycast_core::camera::Projection;
use raycast_core::math;
use raycast_core::shade::Mode;

/// Degrees that a point of dragging turns.
pub const DEGREES_PER_POINT: f64 = 0.4;

/// Modes in the order of their keys, 1 to 9, and what a person calls each.
pub const MODES: [(Mode, &str, &str); 9] = [
    (Mode::Color, "Colors", "The triangles' own colors, unlit"),
    (Mode::Flat, "Flat", "Lit, one brightness a triangle"),
    (
        Mode::Smooth,
        "Smooth",
        "Lit, with the mesh's own normals where it has them",
    ),
    (
        Mode::Normals,
        "Normals",
        "Directions of the surface: x red, y green, z blue",
    ),
    (Mode::Depth, "Depth", "Distance: near is light, far is dark"),
    (
        Mode::Barycentric,
        "Barycentric",
        "The weights of a triangle's corners as red, green, blue",
    ),
    (Mode::Uv, "UV", "Texture coordinates as red and green"),
    (Mode::Texture, "Texture", "The texture, unlit"),
    (
        Mode::Wireframe,
        "Lines only",
        "Edges alone; what is hidden is left out",
    ),
];

/// What a key does, as the help says it.
pub struct KeyHelp {
    /// The key.
    pub key: &'static str,
    /// What it does.
    pub does: &'static str,
}

const fn help(key: &'static str, does: &'static str) -> KeyHelp {
    KeyHelp { key, does }
}

/// Gestures of the mouse.
pub const GESTURES: &[KeyHelp] = &[
    help("Left drag", "Orbit about the pivot"),
    help(
        "Right, middle or Shift+left drag",
        "Pan: the point follows the cursor",
    ),
    help("Wheel", "Zoom to the cursor"),
    help("Double-click", "Set the pivot, and bring it to the middle"),
    help("Drop a file", "Open it"),
    help("Hover", "Object, triangle and distance under the cursor"),
];

/// All keys.
pub const KEYS: &[KeyHelp] = &[
    help("F", "Fit the scene"),
    help("R", "Reset the view"),
    help(
        "1 … 9",
        "Colors, flat, smooth, normals, depth, barycentric, UV, texture, lines",
    ),
    help("W", "Wireframe over the mode"),
    help("T", "Tile borders"),
    help("O", "Perspective or orthographic"),
    help("+   −", "Halve or double the step"),
    help("Arrows", "Orbit by 5°"),
    help("P", "Show or hide the panel"),
    help("S, Ctrl+S", "Save the picture"),
    help("Ctrl+O", "Open a file"),
    help("F1, ?", "These keys"),
    help("Esc", "Close keys, path line or error"),
];

/// The commands of the keys pressed in this frame. Empty while a person types into a field.
pub fn keys(context: &egui::Context, state: &State) -> Vec<Command> {
    let mut commands = Vec::new();
    let typing = context.text_edit_focused();
    context.input_mut(|input| {
        let mut shortcut = |modifiers, key, command: Command| {
            if input.consume_shortcut(&KeyboardShortcut::new(modifiers, key)) {
                commands.push(command);
            }
        };
        shortcut(Modifiers::COMMAND, Key::O, Command::Ask(PromptKind::Open));
        shortcut(Modifiers::COMMAND, Key::S, Command::Ask(PromptKind::Save));
        shortcut(Modifiers::NONE, Key::F1, Command::ToggleHelp);
        if !typing {
            shortcut(Modifiers::NONE, Key::Escape, Command::Dismiss);
        }
        if typing {
            return;
        }
        for event in &input.events {
            if let egui::Event::Key {
                key,
                pressed: true,
                modifiers,
                ..
            } = event
                && !modifiers.command
                && !modifiers.alt
                && let Some(command) = key_command(*key, state)
            {
                commands.push(command);
            }
        }
    });
    commands
}

/// What a key without Ctrl or Alt asks for.
pub fn key_command(key: Key, state: &State) -> Option<Command> {
    const DIGITS: [Key; 9] = [
        Key::Num1,
        Key::Num2,
        Key::Num3,
        Key::Num4,
        Key::Num5,
        Key::Num6,
        Key::Num7,
        Key::Num8,
        Key::Num9,
    ];
    let turn = |yaw, pitch| Command::Orbit { yaw, pitch };
    if let Some(index) = DIGITS.iter().position(|&digit| digit == key) {
        return Some(Command::SetMode(MODES[index].0));
    }
    Some(match key {
        Key::F => Command::Fit,
        Key::R => Command::ResetView,
        Key::W => Command::SetWireframe(state.settings.shading.wireframe.is_none()),
        Key::T => {
            let Overlay { borders, .. } = state.overlay;
            Command::SetBorders(!borders)
        }
        Key::O => Command::SetProjection(other(state.projection)),
        Key::P => Command::TogglePanel,
        Key::S => Command::Ask(PromptKind::Save),
        Key::Plus | Key::Equals => Command::ScaleStep(0.5),
        Key::Minus => Command::ScaleStep(2.0),
        Key::Questionmark => Command::ToggleHelp,
        Key::PageUp => Command::Zoom {
            at: middle(state),
            factor: 0.8,
        },
        Key::PageDown => Command::Zoom {
            at: middle(state),
            factor: 1.25,
        },
        Key::ArrowLeft => turn(-5.0, 0.0),
        Key::ArrowRight => turn(5.0, 0.0),
        Key::ArrowUp => turn(0.0, 5.0),
        Key::ArrowDown => turn(0.0, -5.0),
        _ => return None,
    })
}

fn other(projection: Projection) -> Projection {
    match projection {
        Projection::Perspective => Projection::Orthographic,
        Projection::Orthographic => Projection::Perspective,
    }
}

/// How much nearer a wheel's turn brings the eye: the new distance over the old.
pub fn wheel_factor(unit: egui::MouseWheelUnit, delta: f32) -> f64 {
    let notches = match unit {
        egui::MouseWheelUnit::Line => f64::from(delta),
        // A notch of a wheel is some 50 points on systems that report points.
        egui::MouseWheelUnit::Point => f64::from(delta) / 50.0,
        egui::MouseWheelUnit::Page => f64::from(delta) * 8.0,
    };
    math::pow(0.85, notches.clamp(-20.0, 20.0))
}

/// Mouse over the picture to commands. `at` maps a point of the window to the picture's pixels,
/// `scale` is how many of those a point of the window is wide.
pub fn mouse(
    ui: &egui::Ui,
    response: &egui::Response,
    scale: f64,
    at: impl Fn(egui::Pos2) -> (f64, f64),
) -> Vec<Command> {
    use egui::PointerButton::{Middle, Primary, Secondary};
    let mut commands = Vec::new();
    let shift = ui.input(|input| input.modifiers.shift);
    let pans = [Secondary, Middle]
        .into_iter()
        .any(|button| response.dragged_by(button))
        || (shift && response.dragged_by(Primary));
    if response.drag_started()
        && let Some(origin) = ui.input(|input| input.pointer.press_origin())
    {
        commands.push(Command::Grab { at: at(origin) });
    }
    let delta = response.drag_delta();
    if delta != egui::Vec2::ZERO {
        let (dx, dy) = (f64::from(delta.x), f64::from(delta.y));
        if pans {
            commands.push(Command::Pan {
                dx: dx * scale,
                dy: dy * scale,
            });
        } else if response.dragged_by(Primary) {
            commands.push(Command::Orbit {
                yaw: -dx * DEGREES_PER_POINT,
                pitch: dy * DEGREES_PER_POINT,
            });
        }
    }
    if response.double_clicked_by(Primary)
        && let Some(position) = response.interact_pointer_pos()
    {
        commands.push(Command::SetPivot { at: at(position) });
    }
    if let Some(position) = response.hover_pos() {
        let factor = ui.input(|input| {
            input
                .events
                .iter()
                .filter_map(|event| match event {
                    egui::Event::MouseWheel { unit, delta, .. } => {
                        Some(wheel_factor(*unit, delta.y))
                    }
                    egui::Event::Zoom(factor) => Some(1.0 / f64::from(*factor)),
                    _ => None,
                })
                .product::<f64>()
        });
        if factor != 1.0 {
            commands.push(Command::Zoom {
                at: at(position),
                factor,
            });
        }
    }
    commands
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_the_modes_in_order() {
        let state = State::default();
        assert_eq!(
            key_command(Key::Num1, &state),
            Some(Command::SetMode(Mode::Color))
        );
        assert_eq!(
            key_command(Key::Num9, &state),
            Some(Command::SetMode(Mode::Wireframe))
        );
        assert_eq!(key_command(Key::Num0, &state), None);
    }

    #[test]
    fn keys_toggle() {
        let mut state = State::default();
        assert_eq!(
            key_command(Key::W, &state),
            Some(Command::SetWireframe(true))
        );
        state.settings.shading.wireframe = Some(Default::default());
        assert_eq!(
            key_command(Key::W, &state),
            Some(Command::SetWireframe(false))
        );
    }

    #[test]
    fn the_wheel_is_symmetric() {
        let nearer = wheel_factor(egui::MouseWheelUnit::Line, 1.0);
        assert!(nearer < 1.0);
        let product = nearer * wheel_factor(egui::MouseWheelUnit::Line, -1.0);
        assert!((product - 1.0).abs() < 1e-12);
    }
}
