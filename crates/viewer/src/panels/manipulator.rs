//! Handles over the picture to move, rotate and scale the selected object: drawing, hit testing and dragging.

use super::Commands;
use super::gizmo::axis_color;
use super::highlight::{before, line};
use crate::state::State;
use crate::state::command::Command;
use crate::state::handle::{Amount, Handle, Tool};
use crate::state::manipulator::{FLATTEST, Manipulator};
use crate::ui::format;
use egui::{
    Align2, Color32, CursorIcon, FontId, Painter, PointerButton, Pos2, Rect, Response, Shape,
    Stroke, Ui, Vec2, vec2,
};
use raycast_core::glam::DVec3;
use raycast_core::math;

/// The length of an axis, in points.
const LENGTH: f32 = 88.0;
/// The greatest distance from the cursor to a line that it drags, in points.
const REACH: f32 = 8.0;
/// Half the side of the squares in the middle and at the ends of axes, in points.
const END: f32 = 5.0;
/// Sides of the polygon that a ring is drawn as.
const SIDES: u32 = 72;
/// The colour of the handle under the cursor.
const LIT: Color32 = Color32::from_rgb(0xff, 0xe0, 0x4a);

/// A handle as it lies in the window.
struct Drawn {
    handle: Handle,
    color: Color32,
    /// Lines that can be dragged.
    lines: Vec<Vec<Pos2>>,
    /// An area that can be dragged.
    area: Vec<Pos2>,
    /// Lines that are drawn faintly and cannot be dragged: the far half of a ring.
    behind: Vec<Vec<Pos2>>,
    end: End,
}

/// The mark at the end of an axis.
enum End {
    None,
    /// An arrow's head, from its base to its tip.
    Arrow(Pos2, Pos2),
    /// A square.
    Square(Pos2),
}

/// Shows the handles of the selected object, and handles drags; returns whether they use the left button. A point of
/// the window is `scale` pixels of the picture wide; `at` and `place` map from the window to the picture and back.
pub(super) fn show(
    ui: &Ui,
    response: &Response,
    state: &State,
    scale: f64,
    (at, place): (impl Fn(Pos2) -> (f64, f64), impl Fn((f64, f64)) -> Pos2),
    out: &mut Commands,
) -> bool {
    let manipulating = &state.manipulating;
    let length = f64::from(LENGTH) * scale;
    let hand = ui.input(|input| input.pointer.latest_pos());
    if manipulating.is_held {
        hold(ui, response, state, hand.map(&at), out);
    }
    let Some((manipulator, tool)) = state.manipulator().zip(manipulating.tool) else {
        return manipulating.is_held;
    };
    let Some(camera) = state.camera() else {
        return manipulating.is_held;
    };
    let middle = camera.project(manipulator.center).map(&place);
    let point = |p: DVec3| {
        let seen = before(&camera, &[p]);
        let point = place(camera.project(*seen.first()?)?);
        // A longer line crosses a panorama's seam, or the edge of a cube's face.
        let is_apart = camera.projection().panorama().is_some()
            && middle.is_none_or(|middle| middle.distance(point) > LENGTH * 4.0);
        (!is_apart).then_some(point)
    };
    let handles = handles(&manipulator, tool, length, point);
    let is_over = |hand: &Pos2| response.rect.contains(*hand) && response.contains_pointer();
    let pressed = ui.input(|input| input.pointer.press_origin());
    let mut is_taken = manipulating.is_held;
    let mut lit = manipulating.drag.as_ref().map(|drag| drag.handle);
    if !is_taken {
        // The place of the press: the cursor may have left the handle before the movement counts as a drag.
        let from = pressed
            .filter(|_| response.is_pointer_button_down_on())
            .or(hand);
        lit = from.filter(is_over).and_then(|from| under(&handles, from));
        is_taken = lit.is_some();
        if let (Some(handle), Some(from)) = (lit, pressed)
            && response.drag_started_by(PointerButton::Primary)
        {
            out.push(Command::GrabHandle {
                handle,
                at: at(from),
                length,
            });
        }
    }
    if is_taken {
        let icon = match manipulating.is_held {
            true => CursorIcon::Grabbing,
            false => CursorIcon::Grab,
        };
        ui.ctx().set_cursor_icon(icon);
    }
    let painter = ui.painter_at(response.rect);
    let dragged = manipulating.drag.as_ref();
    if let Some(Handle::Axis(axis)) = dragged.map(|drag| drag.handle)
        && tool != Tool::Turn
    {
        // The line along which it moves.
        let ends = [-40.0, 40.0].map(|share| manipulator.along(axis, share * length));
        let color = axis_color(NAMES[axis]).gamma_multiply(0.6);
        line(&painter, &camera, ends, &place, color, 1.0);
    }
    for drawn in &handles {
        let is_lit = lit == Some(drawn.handle);
        if dragged.is_none() || is_lit {
            draw(&painter, drawn, is_lit);
        }
    }
    if let Some(drag) = dragged
        && let Some(hand) = hand
    {
        label(&painter, hand, &words(drag.handle, drag.amount));
    }
    is_taken
}

/// Continues a drag.
fn hold(ui: &Ui, response: &Response, state: &State, hand: Option<(f64, f64)>, out: &mut Commands) {
    let snaps = ui.input(|input| input.modifiers.command);
    let drag = state.manipulating.drag.as_ref();
    let is_new = response.drag_delta() != Vec2::ZERO || drag.is_some_and(|d| d.snaps != snaps);
    if let Some(to) = hand.filter(|_| is_new && drag.is_some()) {
        out.push(Command::DragHandle { to, snaps });
    }
    let is_down = ui.input(|input| input.pointer.primary_down());
    if response.drag_stopped_by(PointerButton::Primary) || !is_down {
        out.push(Command::ReleaseHandle);
    }
}

const NAMES: [&str; 3] = ["X", "Y", "Z"];

/// All handles that can be dragged from this view.
fn handles(
    of: &Manipulator,
    tool: Tool,
    length: f64,
    point: impl Fn(DVec3) -> Option<Pos2>,
) -> Vec<Drawn> {
    let Some(center) = point(of.center) else {
        return Vec::new();
    };
    let mut handles = Vec::new();
    if tool == Tool::Turn {
        for axis in 0..3 {
            handles.extend(ring(of, axis, length, &point));
        }
        let around = (0..=SIDES).map(|side| center + around(side) * (LENGTH * 1.18));
        handles.push(Drawn {
            handle: Handle::All,
            color: Color32::from_gray(0xd8),
            lines: vec![around.collect()],
            area: Vec::new(),
            behind: Vec::new(),
            end: End::None,
        });
        return handles;
    }
    let ends = [center - vec2(END, END), center + vec2(END, END)];
    let square = Rect::from_points(&ends);
    handles.push(Drawn {
        handle: Handle::All,
        color: Color32::from_gray(0xe8),
        lines: Vec::new(),
        area: vec![
            square.left_top(),
            square.right_top(),
            square.right_bottom(),
            square.left_bottom(),
        ],
        behind: Vec::new(),
        end: End::None,
    });
    for axis in 0..3 {
        handles.extend(across(of, axis, length, &point));
    }
    for (axis, name) in NAMES.into_iter().enumerate() {
        // An axis seen from its end cannot be dragged.
        let cosine = of.axes[axis].dot(of.view);
        if cosine * cosine > 1.0 - FLATTEST * FLATTEST {
            continue;
        }
        let Some((from, to)) =
            point(of.along(axis, length * 0.16)).zip(point(of.along(axis, length)))
        else {
            continue;
        };
        handles.push(Drawn {
            handle: Handle::Axis(axis),
            color: axis_color(name),
            lines: vec![vec![from, to]],
            area: Vec::new(),
            behind: Vec::new(),
            end: match tool {
                Tool::Scale => End::Square(to),
                _ => End::Arrow(from, to),
            },
        });
    }
    handles
}

fn around(side: u32) -> Vec2 {
    let (sin, cos) = math::sin_cos(f64::from(side) * std::f64::consts::TAU / f64::from(SIDES));
    vec2(cos as f32, sin as f32)
}

/// A ring about an axis: its near half, and its far half.
fn ring(
    of: &Manipulator,
    axis: usize,
    length: f64,
    point: impl Fn(DVec3) -> Option<Pos2>,
) -> Option<Drawn> {
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3].map(|other| of.axes[other]);
    let mut near: Vec<Vec<Pos2>> = Vec::new();
    let mut far: Vec<Vec<Pos2>> = Vec::new();
    let at = |side: u32| {
        let spoke = around(side);
        u * f64::from(spoke.x) + v * f64::from(spoke.y)
    };
    for side in 0..SIDES {
        let ends = [at(side), at(side + 1)];
        // A ring that is seen almost face-on has no far half.
        let is_near = (ends[0] + ends[1]).dot(of.view) * 0.5 <= 0.3;
        let lines = if is_near { &mut near } else { &mut far };
        let places = ends.map(|spoke| point(of.center + spoke * (of.pixel * length)));
        let [Some(a), Some(b)] = places else {
            return None;
        };
        match lines.last_mut().filter(|line| line.last() == Some(&a)) {
            Some(line) => line.push(b),
            None => lines.push(vec![a, b]),
        }
    }
    Some(Drawn {
        handle: Handle::Axis(axis),
        color: axis_color(NAMES[axis]),
        lines: near,
        area: Vec::new(),
        behind: far,
        end: End::None,
    })
}

/// A square along two axes, across the third.
fn across(
    of: &Manipulator,
    axis: usize,
    length: f64,
    point: impl Fn(DVec3) -> Option<Pos2>,
) -> Option<Drawn> {
    if of.axes[axis].dot(of.view).abs() < FLATTEST * 2.0 {
        return None;
    }
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3].map(|other| of.axes[other]);
    let side = |a: f64, b: f64| point(of.center + (u * a + v * b) * (of.pixel * length));
    let corners = [(0.34, 0.34), (0.56, 0.34), (0.56, 0.56), (0.34, 0.56)];
    let area: Option<Vec<Pos2>> = corners.into_iter().map(|(a, b)| side(a, b)).collect();
    Some(Drawn {
        handle: Handle::Across(axis),
        color: axis_color(NAMES[axis]),
        lines: Vec::new(),
        area: area?,
        behind: Vec::new(),
        end: End::None,
    })
}

/// The handle under the cursor: the first area that contains it, else the nearest line.
fn under(handles: &[Drawn], hand: Pos2) -> Option<Handle> {
    if let Some(area) = handles.iter().find(|drawn| contains(&drawn.area, hand)) {
        return Some(area.handle);
    }
    let near = handles.iter().filter_map(|drawn| {
        let lines = drawn.lines.iter().flat_map(|line| line.windows(2));
        let distances = lines.map(|ends| distance([ends[0], ends[1]], hand));
        let least = distances.reduce(f32::min)?;
        (least <= REACH).then_some((least, drawn.handle))
    });
    let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map(|(_, handle)| handle)
}

/// Whether a point is in a convex polygon, or within three points of it.
fn contains(area: &[Pos2], point: Pos2) -> bool {
    let sides = || area.iter().zip(area.iter().cycle().skip(1));
    let turns = |(a, b): (&Pos2, &Pos2)| (*b - *a).rot90().dot(point - *a);
    let is_inside =
        sides().all(|side| turns(side) >= 0.0) || sides().all(|side| turns(side) <= 0.0);
    !area.is_empty() && (is_inside || sides().any(|(a, b)| distance([*a, *b], point) <= 3.0))
}

/// The distance from a point to a line segment.
fn distance([a, b]: [Pos2; 2], point: Pos2) -> f32 {
    let way = b - a;
    let share = (point - a).dot(way) / way.length_sq().max(f32::MIN_POSITIVE);
    point.distance(a + way * share.clamp(0.0, 1.0))
}

fn draw(painter: &Painter, drawn: &Drawn, is_lit: bool) {
    let color = if is_lit { LIT } else { drawn.color };
    let width = if is_lit { 3.5 } else { 2.5 };
    let dark = Color32::from_black_alpha(130);
    for line in &drawn.behind {
        let faint = Stroke::new(1.0, color.gamma_multiply(0.35));
        painter.add(Shape::line(line.clone(), faint));
    }
    for line in &drawn.lines {
        painter.add(Shape::line(line.clone(), Stroke::new(width + 2.0, dark)));
        painter.add(Shape::line(line.clone(), Stroke::new(width, color)));
    }
    if !drawn.area.is_empty() {
        let fill = color.gamma_multiply(if is_lit { 0.75 } else { 0.4 });
        painter.add(Shape::convex_polygon(
            drawn.area.clone(),
            fill,
            Stroke::new(1.5, color),
        ));
    }
    match drawn.end {
        End::None => {}
        End::Square(at) => {
            let square = Rect::from_center_size(at, Vec2::splat(2.0 * END + 1.0));
            painter.rect_filled(square.expand(1.0), 1.0, dark);
            painter.rect_filled(square, 1.0, color);
        }
        End::Arrow(from, to) => {
            let way = (to - from).normalized();
            let tip = to + way * 9.0;
            let corners = [5.5, -5.5].map(|side| to - way * 4.0 + way.rot90() * side);
            let head = vec![tip, corners[0], corners[1]];
            painter.add(Shape::convex_polygon(head, color, Stroke::new(1.0, dark)));
        }
    }
}

/// The progress of a drag, in words.
fn words(handle: Handle, amount: Amount) -> String {
    let axes = |value: DVec3, is_none: f64, written: &dyn Fn(f64) -> String| {
        let parts = (0..3).filter(|&axis| match handle {
            Handle::Axis(own) => axis == own,
            Handle::Across(other) => axis != other,
            Handle::All => value[axis] != is_none,
        });
        let parts: Vec<_> = parts
            .map(|axis| format!("{} {}", NAMES[axis], written(value[axis])))
            .collect();
        parts.join("   ")
    };
    match amount {
        Amount::Moved(by) => axes(by, 0.0, &|n| format!("{}{}", plus(n), format::length(n))),
        Amount::Turned(degrees) => match handle {
            Handle::Axis(axis) | Handle::Across(axis) => {
                format!("{} {}{degrees:.1}°", NAMES[axis], plus(degrees))
            }
            Handle::All => format!("{}{degrees:.1}°", plus(degrees)),
        },
        Amount::Scaled(factors) => match handle {
            Handle::All => format!("× {:.3}", factors.x),
            _ => axes(factors, 1.0, &|n| format!("× {n:.3}")),
        },
    }
}

fn plus(number: f64) -> &'static str {
    if number > 0.0 { "+" } else { "" }
}

/// Text beside the cursor on a dark background, readable on any picture.
fn label(painter: &Painter, hand: Pos2, words: &str) {
    if words.is_empty() {
        return;
    }
    let font = FontId::proportional(13.0);
    let words = painter.layout_no_wrap(words.to_owned(), font, Color32::WHITE);
    let corner = hand + vec2(18.0, 14.0);
    let ground = Rect::from_min_size(corner, words.size() + vec2(10.0, 4.0));
    painter.rect_filled(ground, 4.0, Color32::from_black_alpha(200));
    let corner = Align2::CENTER_CENTER.align_size_within_rect(words.size(), ground);
    painter.galley(corner.min, words, Color32::WHITE);
}
