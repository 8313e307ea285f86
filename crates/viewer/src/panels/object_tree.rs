//! The tree of objects: the order of the list, and changing parents by dragging or by choice.

use super::Commands;
use super::widgets::{is_chosen, list_height, list_shown, row};
use crate::state::State;
use crate::state::command::Command;
use crate::state::insertion::Insertion;
use crate::state::parents::moves_with;
use egui::{Button, ComboBox, Response, Stroke, Ui};
use raycast_core::scene::Object;

/// The indentation of a child, in points.
const INDENT: f32 = 12.0;
/// The greatest depth that is indented: deeper, names would have no room.
const DEEPEST: usize = 6;

/// The order of the list: children below their parents.
pub(super) struct Tree {
    /// Index and depth by row; `None` where no object has a parent, and rows are indices.
    rows: Option<Vec<(usize, usize)>>,
}

impl Tree {
    pub(super) fn of(objects: &[Object]) -> Self {
        if objects.iter().all(|object| object.parent.is_none()) {
            return Self { rows: None };
        }
        // Linked lists of children in two arrays: this runs in every frame, and must not allocate for each object.
        let none = objects.len();
        let (mut first, mut next, mut first_root) = (vec![none; none], vec![none; none], none);
        for (number, object) in objects.iter().enumerate().rev() {
            let list = match object.parent {
                Some(parent) if parent < none => &mut first[parent],
                _ => &mut first_root,
            };
            next[number] = std::mem::replace(list, number);
        }
        let mut rows = Vec::with_capacity(none);
        let mut stack = vec![(first_root, 0)];
        while let Some((number, depth)) = stack.pop() {
            if number == none {
                continue;
            }
            rows.push((number, depth));
            stack.push((next[number], depth));
            stack.push((first[number], depth + 1));
        }
        // Objects in a cycle of parents would be missing; scenes have none.
        let is_whole = rows.len() == objects.len();
        Self {
            rows: is_whole.then_some(rows),
        }
    }

    /// The index of the object in a row, and its depth.
    pub(super) fn at(&self, row: usize) -> (usize, usize) {
        let rows = self.rows.as_ref();
        rows.and_then(|rows| rows.get(row).copied())
            .unwrap_or((row, 0))
    }

    /// The row of an object.
    pub(super) fn row_of(&self, number: usize) -> usize {
        let rows = self.rows.as_ref();
        rows.and_then(|rows| rows.iter().position(|(object, _)| *object == number))
            .unwrap_or(number)
    }
}

pub(super) fn indent(depth: usize) -> f32 {
    depth.min(DEEPEST) as f32 * INDENT
}

/// The target of a dragged object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target {
    /// The object of this row becomes its parent.
    Onto,
    /// It is inserted between two rows.
    Between(Insertion, Edge),
}

/// The edge of a row that is nearest to the gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Edge {
    Top,
    Bottom,
}

/// The target at a `share` of a row's height: its upper quarter is the gap above, its lower quarter the gap below,
/// where its children begin if it has any.
fn target(objects: &[Object], number: usize, share: f32) -> Target {
    let parent = objects[number].parent;
    match share {
        ..0.25 => {
            let before = number;
            Target::Between(Insertion { before, parent }, Edge::Top)
        }
        ..0.75 => Target::Onto,
        _ => {
            let child = (0..objects.len()).find(|&other| objects[other].parent == Some(number));
            let to = match child {
                Some(before) => Insertion {
                    before,
                    parent: Some(number),
                },
                None => Insertion {
                    before: number + 1,
                    parent,
                },
            };
            Target::Between(to, Edge::Bottom)
        }
    }
}

/// Makes a row draggable, and a target for others: dropped on a row an object becomes its child, between two it is
/// inserted there.
pub(super) fn drag(
    ui: &Ui,
    response: &Response,
    number: usize,
    objects: &[Object],
    out: &mut Commands,
) {
    response.dnd_set_drag_payload(number);
    let Some(held) = response.dnd_hover_payload::<usize>() else {
        return;
    };
    let Some(pointer) = ui.ctx().pointer_interact_pos() else {
        return;
    };
    let (held, rect) = (*held, response.rect);
    let target = target(objects, number, (pointer.y - rect.top()) / rect.height());
    let parent = match target {
        Target::Onto => Some(number),
        Target::Between(to, _) => to.parent,
    };
    let fits = parent.is_none_or(|parent| !moves_with(objects, parent, held));
    if held == number || !fits {
        return;
    }
    let stroke = Stroke::new(1.5, ui.visuals().selection.stroke.color);
    let painter = ui.painter();
    match target {
        Target::Onto => {
            painter.rect_stroke(rect, 3.0, stroke, egui::StrokeKind::Inside);
        }
        Target::Between(_, Edge::Top) => {
            painter.hline(rect.x_range(), rect.top() - 1.0, stroke);
        }
        Target::Between(_, Edge::Bottom) => {
            painter.hline(rect.x_range(), rect.bottom() + 1.0, stroke);
        }
    }
    if response.dnd_release_payload::<usize>().is_some() {
        out.push(match target {
            Target::Onto => Command::SetParent(held, Some(number)),
            Target::Between(to, _) => Command::Reorder(held, to),
        });
    }
}

/// Scrolls the list, of this height in points, while a row is dragged to its upper or lower edge.
pub(super) fn scroll_while_dragging(ui: &Ui, height: f32) {
    let (Some(pointer), rect) = (ui.ctx().pointer_interact_pos(), ui.clip_rect()) else {
        return;
    };
    let is_held = egui::DragAndDrop::has_payload_of_type::<usize>(ui.ctx());
    if !is_held || height <= rect.height() {
        return;
    }
    let edge = ui.spacing().interact_size.y * 0.75;
    let way = match pointer.y {
        y if y < rect.top() + edge => 4.0,
        y if y > rect.bottom() - edge => -4.0,
        _ => return,
    };
    ui.scroll_with_delta(egui::vec2(0.0, way));
    ui.ctx().request_repaint();
}

/// A target below the list while a child is dragged: dropped here it becomes the last object, without a parent.
pub(super) fn drop_below(ui: &mut Ui, objects: &[Object], out: &mut Commands) {
    let held = egui::DragAndDrop::payload::<usize>(ui.ctx());
    let Some(held) = held.filter(|held| objects.get(**held).is_some_and(|o| o.parent.is_some()))
    else {
        return;
    };
    let size = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
    let (rect, response) = ui.allocate_exact_size(size, egui::Sense::hover());
    let is_over = response.dnd_hover_payload::<usize>().is_some();
    let visuals = ui.visuals();
    let color = match is_over {
        true => visuals.selection.stroke.color,
        false => visuals.weak_text_color(),
    };
    let (font, middle) = (egui::TextStyle::Body.resolve(ui.style()), rect.center());
    let painter = ui.painter();
    painter.rect_stroke(rect, 3.0, Stroke::new(1.0, color), egui::StrokeKind::Inside);
    painter.text(
        middle,
        egui::Align2::CENTER_CENTER,
        "Moves with nothing",
        font,
        color,
    );
    if response.dnd_release_payload::<usize>().is_some() {
        let to = Insertion {
            before: objects.len(),
            parent: None,
        };
        out.push(Command::Reorder(*held, to));
    }
}

/// The selected object's parent.
pub(super) fn parent(ui: &mut Ui, state: &State, number: usize, out: &mut Commands) {
    let Some(document) = &state.document else {
        return;
    };
    let objects = &document.scene.objects;
    let parent = objects.get(number).and_then(|object| object.parent);
    if objects.len() < 2 {
        return;
    }
    let hint = "With what it moves, turns and scales. Or drag it onto that in the list";
    row(ui, "Moves with", hint, |ui, label| {
        let name = parent.and_then(|parent| objects.get(parent));
        let name = name.map_or("nothing", |object| &object.name);
        ui.add_enabled_ui(!state.is_locked(number), |ui| {
            let list = ComboBox::from_id_salt("parent")
                .height(list_height(ui))
                .width(ui.available_width())
                .truncate()
                .selected_text(name)
                .show_ui(ui, |ui| choices(ui, objects, (number, parent)));
            list_shown(ui, &list.response.labelled_by(label));
            if let Some(Some(chosen)) = list.inner {
                out.push(Command::SetParent(number, chosen));
            }
        });
    });
}

/// The possible parents of an object; returns the choice, if one was made.
fn choices(
    ui: &mut Ui,
    objects: &[Object],
    (number, parent): (usize, Option<usize>),
) -> Option<Option<usize>> {
    let mut chosen = None;
    let none = Button::selectable(parent.is_none(), "nothing");
    let none = ui.add(none);
    if is_chosen(ui, &none) {
        chosen = Some(None);
    }
    let able: Vec<usize> = (0..objects.len())
        .filter(|&other| !moves_with(objects, other, number))
        .collect();
    let height = ui.spacing().interact_size.y;
    egui::ScrollArea::vertical()
        .max_height(200.0)
        .show_rows(ui, height, able.len(), |ui, rows| {
            for &other in &able[rows] {
                let is_it = parent == Some(other);
                let button = Button::selectable(is_it, &objects[other].name).truncate();
                let entry = ui.add(button);
                if is_chosen(ui, &entry) {
                    chosen = Some(Some(other));
                }
            }
        });
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_core::scene::{Mesh, MeshData};
    use std::sync::Arc;

    #[test]
    fn children_stand_below_their_parents_and_all_are_listed_once() {
        let mesh = Arc::new(Mesh::new(MeshData::default()));
        let objects = |parents: &[Option<usize>]| -> Vec<Object> {
            let objects = parents.iter().map(|parent| Object {
                parent: *parent,
                ..Object::new("o", Arc::clone(&mesh))
            });
            objects.collect()
        };
        let tree = Tree::of(&objects(&[Some(2), None, None, Some(0), Some(2)]));
        let rows: Vec<_> = (0..5).map(|row| tree.at(row)).collect();
        assert_eq!(rows, [(1, 0), (2, 0), (0, 1), (3, 2), (4, 1)]);
        assert_eq!(tree.row_of(3), 3);
        let flat = Tree::of(&objects(&[None, None]));
        assert_eq!((flat.at(1), flat.row_of(1)), ((1, 0), 1));
    }
}
