//! Keys and mouse to commands.

use super::registry;
use crate::state::State;
use crate::state::command::Command;
use egui::Key;
use raycast_core::math;

/// Degrees that a point of dragging turns.
pub const DEGREES_PER_POINT: f64 = 0.4;

/// A gesture of the mouse, and what it does.
pub struct Gesture {
    /// What the hand does.
    pub gesture: &'static str,
    /// What comes of it.
    pub does: &'static str,
}

const fn gesture(gesture: &'static str, does: &'static str) -> Gesture {
    Gesture { gesture, does }
}

/// Gestures of the mouse.
pub const GESTURES: &[Gesture] = &[
    gesture("Left drag", "Orbit about the pivot"),
    gesture(
        "Right, middle or Shift+left drag",
        "Pan: the point follows the cursor",
    ),
    gesture("Wheel", "Zoom to the cursor"),
    gesture("Hover", "Object, triangle and distance under the cursor"),
    gesture(
        "Click",
        "Keep what is under the cursor to be read and copied",
    ),
    gesture("Double-click", "Set the pivot, and bring it to the middle"),
    gesture("Drop files", "Open them; with Shift, add them"),
];

/// The commands of the keys pressed in this frame.
pub fn keys(context: &egui::Context, state: &State) -> Vec<Command> {
    // A field may be about to get the keyboard: its letters are no keys already.
    let in_text = context.text_edit_focused();
    let typing = in_text || state.is_typing();
    // Arrows go from one control to another once one has the keyboard.
    let is_in_controls = context.memory(|memory| memory.focused().is_some());
    let in_menu = egui::Popup::is_any_open(context);
    let is_asked = state.question.is_some() || state.replacing.is_some();
    context.input(|input| {
        let mut commands = Vec::new();
        for event in &input.events {
            match event {
                egui::Event::Copy if !typing => commands.push(Command::CopyCamera),
                egui::Event::Paste(text) if !typing => {
                    commands.push(Command::PasteCamera(text.clone()));
                }
                _ => {}
            }
            let egui::Event::Key {
                key,
                physical_key,
                pressed: true,
                modifiers,
                ..
            } = *event
            else {
                continue;
            };
            if key == Key::Escape {
                // A number that is being typed has its own use for it, and so has a menu.
                if (!in_text || state.is_typing()) && !in_menu {
                    commands.push(Command::Dismiss);
                }
                continue;
            }
            let is_arrow = matches!(
                key,
                Key::ArrowLeft | Key::ArrowRight | Key::ArrowUp | Key::ArrowDown
            );
            if is_asked || (is_arrow && is_in_controls && !modifiers.alt) {
                continue;
            }
            let of = |key| registry::pressed(state, typing, key, modifiers);
            // Where digits are on the second level, as in France, the key counts, not what it types.
            let digit = physical_key.filter(|key| DIGITS.contains(key));
            commands.extend(of(key).or_else(|| digit.and_then(of)));
        }
        commands
    })
}

const DIGITS: [Key; 10] = [
    Key::Num0,
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
    if response.clicked_by(Primary)
        && !response.double_clicked_by(Primary)
        && let Some(position) = response.interact_pointer_pos()
    {
        // The pixel's own ray goes through its centre: what is told is what is drawn.
        let (x, y) = at(position);
        commands.push(Command::Pin {
            at: (x.floor() + 0.5, y.floor() + 0.5),
        });
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
    fn the_wheel_is_symmetric() {
        let nearer = wheel_factor(egui::MouseWheelUnit::Line, 1.0);
        assert!(nearer < 1.0);
        let product = nearer * wheel_factor(egui::MouseWheelUnit::Line, -1.0);
        assert!((product - 1.0).abs() < 1e-12);
    }
}
