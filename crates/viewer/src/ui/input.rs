//! From keys and mouse to commands.

use super::registry::{self, Keymap};
use crate::state::State;
use crate::state::command::Command;
use crate::state::navigate::ZOOM;
use crate::state::preferences::Mouse;
use egui::Key;
use raycast_core::glam::DVec3;
use raycast_core::math;

/// Degrees of orbit for each point of a drag.
pub const DEGREES_PER_POINT: f64 = 0.4;

/// A mouse gesture, for the help.
pub struct Gesture {
    /// The gesture.
    pub gesture: &'static str,
    /// Its effect.
    pub does: &'static str,
}

const fn gesture(gesture: &'static str, does: &'static str) -> Gesture {
    Gesture { gesture, does }
}

/// The gestures with these mouse settings.
pub fn gestures(habits: Mouse) -> impl Iterator<Item = &'static Gesture> {
    let drags: &[Gesture] = match habits {
        Mouse::Viewer => {
            const {
                &[
                    gesture("Left drag", "Orbit about the pivot"),
                    gesture(
                        "Right, middle or Shift+left drag",
                        "Pan: the point follows the cursor",
                    ),
                ]
            }
        }
        Mouse::Blender => {
            const {
                &[
                    gesture("Middle drag", "Orbit about the pivot"),
                    gesture("Shift+middle drag", "Pan: the point follows the cursor"),
                    gesture("Ctrl+middle drag", "Zoom"),
                ]
            }
        }
        Mouse::Cad => {
            const {
                &[
                    gesture("Right drag", "Orbit about the pivot"),
                    gesture("Middle drag", "Pan: the point follows the cursor"),
                ]
            }
        }
    };
    drags.iter().chain(OTHERS)
}

/// The gestures with any mouse settings.
const OTHERS: &[Gesture] = &[
    gesture("Wheel", "Zoom to the cursor"),
    gesture(
        "Ctrl+wheel",
        "Move towards the cursor, and through what is there",
    ),
    gesture("Hover", "Object, triangle and distance under the cursor"),
    gesture(
        "Click",
        "Keep what is under the cursor to be read and copied",
    ),
    gesture("Ctrl+click", "Keep it beside what is kept already"),
    gesture("Double-click", "Set the pivot, and bring it to the middle"),
    gesture(
        "Ctrl+C, Ctrl+V",
        "Copy the camera as text, and use a camera that was copied",
    ),
    gesture(
        "Drop files",
        "Open them; with Shift, add them. A picture of RayCast's brings its scene back",
    ),
];

/// The commands of the keys pressed in this frame.
pub fn keys(context: &egui::Context, state: &State) -> Vec<Command> {
    // A text field may be about to get the keyboard: letters are meant for it already.
    let in_text = context.text_edit_focused();
    let typing = in_text || state.is_typing();
    // Arrow keys move the focus once a control has it.
    let is_in_controls = context.memory(|memory| memory.focused().is_some());
    let in_menu = egui::Popup::is_any_open(context);
    let is_asked = state.question.is_some() || state.replacing.is_some();
    let walks = state.walk.is_some() && !typing && !is_asked;
    let keymap = Keymap::of(context);
    let mut steps = None;
    // What is typed in the frame whose key opens a text field: a slow machine gets several keys in one frame.
    let (mut opens, mut typed) = (false, String::new());
    // A letter that opens a field is not typed into it.
    let mut is_letter = false;
    let mut commands = context.input(|input| {
        let mut commands = Vec::new();
        steps = walks.then(|| step_of(input)).flatten();
        for event in &input.events {
            match event {
                egui::Event::Copy if !typing => commands.push(Command::CopyCamera),
                egui::Event::Paste(text) if !typing => {
                    commands.push(Command::PasteCamera(text.clone()));
                }
                egui::Event::WindowFocused(false) => commands.push(Command::LoseKeyboard),
                egui::Event::Text(_) if std::mem::take(&mut is_letter) => {}
                egui::Event::Text(text) if opens => typed.push_str(text),
                _ => {}
            }
            if opens {
                continue;
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
                // A number field and a menu use Escape themselves.
                if (!in_text || state.is_typing()) && !in_menu {
                    commands.push(Command::Dismiss);
                }
                continue;
            }
            let is_arrow = matches!(
                key,
                Key::ArrowLeft | Key::ArrowRight | Key::ArrowUp | Key::ArrowDown
            );
            let is_step = WALKING.iter().any(|(a, b)| [*a, *b].contains(&key));
            if walks && is_step && !modifiers.command && !modifiers.alt {
                continue;
            }
            // A menu or list that is open takes arrows and letters.
            let is_of_menu = in_menu && !modifiers.command && !modifiers.alt;
            if is_asked || is_of_menu || (is_arrow && is_in_controls && !modifiers.alt) {
                continue;
            }
            let of = |key| registry::pressed(&keymap, state, typing, key, modifiers);
            // On keyboards that type digits with Shift, as in France, the physical key counts.
            let digit = physical_key.filter(|key| DIGITS.contains(key));
            let command = of(key).or_else(|| digit.and_then(of));
            opens = matches!(command, Some(Command::TogglePalette | Command::Ask(_)));
            is_letter = opens && !modifiers.command && !modifiers.alt;
            commands.extend(command);
        }
        commands
    });
    if !typed.is_empty() {
        commands.push(Command::TypeAhead(typed));
    }
    if steps.is_some() {
        // Continues while the key is held.
        context.request_repaint();
    }
    commands.extend(steps);
    commands
}

/// The step of the walking keys that are held.
fn step_of(input: &egui::InputState) -> Option<Command> {
    if input.modifiers.any() && !input.modifiers.shift_only() {
        return None;
    }
    let pace = if input.modifiers.shift { FASTER } else { 1.0 };
    let down = |key| if input.key_down(key) { pace } else { 0.0 };
    let way = DVec3::from_array(WALKING.map(|(more, less)| down(more) - down(less)));
    // Limits the step after a delayed frame, so that one does not pass through a wall.
    let seconds = f64::from(input.stable_dt.min(0.1));
    (way != DVec3::ZERO).then_some(Command::Walk { way, seconds })
}

/// How much faster Shift walks: as running is to walking.
const FASTER: f64 = 3.0;

/// Keys that walk: right and left, up and down, forwards and back.
const WALKING: [(Key, Key); 3] = [(Key::D, Key::A), (Key::E, Key::Q), (Key::W, Key::S)];

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

/// The notches of a wheel's movement, away from the hand.
fn notches(unit: egui::MouseWheelUnit, delta: f32) -> f64 {
    let notches = match unit {
        egui::MouseWheelUnit::Line => f64::from(delta),
        // A notch of a wheel is some 50 points on systems that report points.
        egui::MouseWheelUnit::Point => f64::from(delta) / 50.0,
        egui::MouseWheelUnit::Page => f64::from(delta) * 8.0,
    };
    notches.clamp(-20.0, 20.0)
}

/// The zoom factor of a wheel's movement: the new distance over the old.
pub fn wheel_factor(unit: egui::MouseWheelUnit, delta: f32) -> f64 {
    math::pow(ZOOM, notches(unit, delta))
}

/// The effect of a drag.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Drag {
    Orbit,
    Pan,
    Zoom,
    Look,
}

/// The effect of a drag with a button, with Shift or Ctrl held, by these mouse settings.
fn drag_of(habits: Mouse, button: egui::PointerButton, shift: bool, ctrl: bool) -> Option<Drag> {
    use egui::PointerButton::{Middle, Primary, Secondary};
    match (habits, button) {
        (Mouse::Viewer, Primary) if !shift => Some(Drag::Orbit),
        (Mouse::Viewer, Primary | Middle | Secondary) => Some(Drag::Pan),
        (Mouse::Blender, Middle) if shift => Some(Drag::Pan),
        (Mouse::Blender, Middle) if ctrl => Some(Drag::Zoom),
        (Mouse::Blender, Middle) => Some(Drag::Orbit),
        (Mouse::Cad, Secondary) => Some(Drag::Orbit),
        (Mouse::Cad, Middle) => Some(Drag::Pan),
        _ => None,
    }
}

/// From the mouse over the picture to commands, by these mouse settings and whether one is walking. The left button
/// does nothing unless it `is_free`. `at` maps a point of the window to the picture's pixels; a point is `scale` pixels
/// wide.
pub fn mouse(
    ui: &egui::Ui,
    response: &egui::Response,
    (habits, walks): (Mouse, bool),
    is_free: bool,
    scale: f64,
    at: impl Fn(egui::Pos2) -> (f64, f64),
) -> Vec<Command> {
    let mut commands = Vec::new();
    let response = (ui, response);
    commands.extend(drags(response, (habits, walks), is_free, scale, &at));
    if is_free {
        commands.extend(click(response, &at));
    }
    commands.extend(wheel(response, walks, &at));
    commands
}

/// The start of a drag, and its movement.
fn drags(
    (ui, response): (&egui::Ui, &egui::Response),
    (habits, walks): (Mouse, bool),
    is_free: bool,
    scale: f64,
    at: impl Fn(egui::Pos2) -> (f64, f64),
) -> Vec<Command> {
    use egui::PointerButton::{Middle, Primary, Secondary};
    let mut commands = Vec::new();
    let egui::Modifiers { shift, command, .. } = ui.input(|input| input.modifiers);
    let is_primary = response.dragged_by(Primary);
    if response.drag_started()
        && (is_free || !is_primary)
        && let Some(origin) = ui.input(|input| input.pointer.press_origin())
    {
        commands.push(Command::Grab { at: at(origin) });
    }
    let drags = [Primary, Middle, Secondary].into_iter();
    let is_ours = |button: &egui::PointerButton| is_free || *button != Primary;
    let mut drags = drags.filter(|button| response.dragged_by(*button) && is_ours(button));
    let drag = match walks {
        true => drags.next().map(|_| Drag::Look),
        false => drags.find_map(|button| drag_of(habits, button, shift, command)),
    };
    let delta = response.drag_delta();
    if delta != egui::Vec2::ZERO {
        let (dx, dy) = (f64::from(delta.x), f64::from(delta.y));
        commands.extend(drag.map(|drag| match drag {
            Drag::Pan => Command::Pan {
                dx: dx * scale,
                dy: dy * scale,
            },
            Drag::Look => Command::LookAround {
                yaw: -dx * DEGREES_PER_POINT * 0.5,
                pitch: dy * DEGREES_PER_POINT * 0.5,
            },
            Drag::Orbit => Command::Orbit {
                yaw: -dx * DEGREES_PER_POINT,
                pitch: dy * DEGREES_PER_POINT,
            },
            Drag::Zoom => Command::Zoom {
                at: at(response.rect.center()),
                factor: math::pow(1.01, dy.clamp(-500.0, 500.0)),
            },
        }));
    }
    commands
}

/// A click keeps what is there, a double-click sets the pivot.
fn click(
    (ui, response): (&egui::Ui, &egui::Response),
    at: impl Fn(egui::Pos2) -> (f64, f64),
) -> Option<Command> {
    use egui::PointerButton::Primary;
    let position = response.interact_pointer_pos()?;
    if response.double_clicked_by(Primary) {
        return Some(Command::SetPivot { at: at(position) });
    }
    // The ray through the pixel's centre, as in the picture.
    let (x, y) = at(position);
    response.clicked_by(Primary).then(|| Command::Pin {
        at: (x.floor() + 0.5, y.floor() + 0.5),
        beside: ui.input(|input| input.modifiers.command),
    })
}

/// The wheel moves or zooms, or changes the pace while one is walking.
fn wheel(
    (ui, response): (&egui::Ui, &egui::Response),
    walks: bool,
    at: impl Fn(egui::Pos2) -> (f64, f64),
) -> Option<Command> {
    let position = response.hover_pos()?;
    if ui.input(|input| input.modifiers.command) && !walks {
        let notches = ui.input(|input| {
            let notches = input.events.iter().map(|event| match event {
                egui::Event::MouseWheel { unit, delta, .. } => notches(*unit, delta.y),
                _ => 0.0,
            });
            notches.sum::<f64>()
        });
        let at = at(position);
        return (notches != 0.0).then_some(Command::Push { at, notches });
    }
    let factor = ui.input(|input| {
        let factors = input.events.iter().filter_map(|event| match event {
            egui::Event::MouseWheel { unit, delta, .. } => Some(wheel_factor(*unit, delta.y)),
            egui::Event::Zoom(factor) => Some(1.0 / f64::from(*factor)),
            _ => None,
        });
        factors.product::<f64>()
    });
    if factor == 1.0 {
        return None;
    }
    Some(match walks {
        true => Command::ScaleWalk(1.0 / factor),
        false => Command::Zoom {
            at: at(position),
            factor,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_habit_has_a_way_to_orbit_and_to_pan() {
        use egui::PointerButton::{Middle, Primary, Secondary};
        let viewer = |button, shift| drag_of(Mouse::Viewer, button, shift, false);
        assert_eq!(viewer(Primary, false), Some(Drag::Orbit));
        for (button, shift) in [(Primary, true), (Middle, false), (Secondary, false)] {
            assert_eq!(viewer(button, shift), Some(Drag::Pan));
        }
        let blender = |shift, ctrl| drag_of(Mouse::Blender, Middle, shift, ctrl);
        assert_eq!(blender(false, false), Some(Drag::Orbit));
        assert_eq!(blender(true, false), Some(Drag::Pan));
        assert_eq!(blender(false, true), Some(Drag::Zoom));
        let cad = |button| drag_of(Mouse::Cad, button, false, false);
        assert_eq!(
            (cad(Secondary), cad(Middle)),
            (Some(Drag::Orbit), Some(Drag::Pan))
        );
        for habits in [Mouse::Blender, Mouse::Cad] {
            assert_eq!(drag_of(habits, Primary, false, false), None, "left selects");
        }
    }

    #[test]
    fn the_wheel_is_symmetric() {
        let nearer = wheel_factor(egui::MouseWheelUnit::Line, 1.0);
        assert!(nearer < 1.0);
        let product = nearer * wheel_factor(egui::MouseWheelUnit::Line, -1.0);
        assert!((product - 1.0).abs() < 1e-12);
    }
}
