//! The list of objects, and the controls of the selected one.

use super::surface::PROJECTIONS;
use super::widgets::{choice, color, eye, item, row, section, select};
use super::{Commands, groups, object_tree, shape, texture_part, transform};
use crate::state::State;
use crate::state::command::Command;
use crate::ui::format;
use crate::ui::icons::{self, Icon};
use crate::ui::registry::{self, action, actions};
use crate::ui::theme;
use egui::{
    Align, Button, CollapsingHeader, Id, Key, Layout, RichText, ScrollArea, Sense, TextEdit, Ui,
    vec2,
};
use raycast_core::scene::{Color, ColorRule, Object};

/// The most rows of the list before it scrolls: whole ones, so that none looks cut off.
const ROWS: f32 = 7.0;

pub(super) fn show(ui: &mut Ui, state: &State, out: &mut Commands) {
    let Some(document) = &state.document else {
        return;
    };
    let objects = &document.scene.objects;
    let hidden = objects.iter().filter(|object| !object.visible).count();
    let count = format::count(objects.len() as u64);
    let title = match hidden {
        0 => format!("Objects ({count})"),
        _ => format!("Objects ({count}, {} hidden)", format::count(hidden as u64)),
    };
    // The id does not depend on the title, which changes: the part stays open or closed.
    ui.push_id("objects", |ui| {
        section(ui, (Icon::Boxes, &title), true, |ui| {
            let height = ui.spacing().interact_size.y;
            let row = height + ui.spacing().item_spacing.y;
            let most = ROWS * row - ui.spacing().item_spacing.y;
            let tree = object_tree::Tree::of(objects);
            let mut list = ScrollArea::vertical()
                .id_salt("objects")
                .max_height(most)
                .auto_shrink([false, true]);
            // An object that was selected elsewhere, by a click on the picture, is scrolled into view.
            let last = Id::unique("marked object");
            let is_new = ui.data(|data| data.get_temp(last)) != Some(state.selected);
            if is_new {
                ui.data_mut(|data| data.insert_temp(last, state.selected));
                if let Some(number) = state.selected {
                    let number = tree.row_of(number);
                    list = list.vertical_scroll_offset((number as f32 * row - most * 0.4).max(0.0));
                }
            }
            list.show_rows(ui, height, objects.len(), |ui, rows| {
                let spacing = ui.spacing().item_spacing.y;
                let whole = objects.len() as f32 * (height + spacing) - spacing;
                object_tree::scroll_while_dragging(ui, whole);
                for row in rows {
                    let (number, depth) = tree.at(row);
                    object_row(ui, state, (number, depth), objects, out);
                }
            });
            object_tree::drop_below(ui, objects, out);
            if let Some((number, object)) = state
                .selected
                .and_then(|number| Some((number, objects.get(number)?)))
            {
                marked(ui, state, number, object, out);
            }
        });
    });
}

fn object_row(
    ui: &mut Ui,
    state: &State,
    (number, depth): (usize, usize),
    objects: &[Object],
    out: &mut Commands,
) {
    let object = &objects[number];
    let colors = theme::colors(ui);
    let is_marked = state.selected == Some(number);
    ui.push_id(number, |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            ui.add_space(object_tree::indent(depth));
            let hint = if object.visible { "Hide" } else { "Show" };
            if eye(ui, object.visible, &format!("{hint} {}", object.name)) {
                out.push(Command::SetVisible(number, !object.visible));
            }
            if state.naming == Some(number) {
                name_field(ui, number, object, out);
                return;
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let mesh = &object.mesh;
                let count = format::count(mesh.triangles().len() as u64);
                ui.weak(count).on_hover_text("Triangles");
                let dropped = mesh.dropped();
                if dropped.total() > 0 {
                    let text = format!("−{}", format::count(dropped.total().into()));
                    let hint = format!(
                        "Left out, because no ray could meet them: {}",
                        crate::setup::reasons(&dropped)
                    );
                    ui.label(RichText::new(text).color(colors.error))
                        .on_hover_text(hint);
                }
                if state.is_locked(number) && padlock(ui, &format!("Unlock {}", object.name)) {
                    out.push(Command::SetLocked(number, false));
                }
                if let Some(hidden) = &object.hidden_groups {
                    hides_groups(ui, hidden.names().len());
                }
                let room = vec2(ui.available_width(), 0.0);
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    let color = if object.visible {
                        colors.text
                    } else {
                        colors.quiet
                    };
                    let name = RichText::new(&object.name).color(color);
                    let button = Button::new(name)
                        .selected(is_marked)
                        .frame_when_inactive(is_marked)
                        .truncate()
                        // Aligns the name to the left.
                        .right_text("")
                        .sense(Sense::click_and_drag())
                        .min_size(room);
                    let response = ui.add(button);
                    response.widget_info(|| {
                        let role = egui::Role::Button;
                        egui::WidgetInfo::selected(role, true, is_marked, &object.name)
                    });
                    object_tree::drag(ui, &response, number, objects, out);
                    if response.double_clicked() {
                        out.push(Command::EditName(Some(number)));
                    } else if response.clicked() || response.secondary_clicked() {
                        out.push(Command::Select(Some(number)));
                    }
                    response.context_menu(|ui| {
                        for action in actions().filter(|a| a.id.starts_with("object.")) {
                            item(ui, state, action, out);
                        }
                    });
                });
            });
        });
    });
}

/// A padlock; returns whether it was clicked.
fn padlock(ui: &mut Ui, spoken: &str) -> bool {
    let (rect, response) = ui.allocate_exact_size(vec2(14.0, 16.0), Sense::click());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, spoken));
    let colors = theme::colors(ui);
    let is_lit = response.hovered() || response.has_focus();
    let color = if is_lit { colors.accent } else { colors.text };
    icons::paint(ui.painter(), rect.center(), Icon::Lock, 12.0, color);
    let hint = format!("{spoken}: it is kept as it is");
    response.on_hover_text(hint).clicked()
}

/// A closed eye for an object of which only groups are hidden.
fn hides_groups(ui: &mut Ui, count: usize) {
    let (rect, response) = ui.allocate_exact_size(vec2(14.0, 16.0), Sense::hover());
    let text = match count {
        1 => "A group of it is hidden".to_owned(),
        _ => format!("{} groups of it are hidden", format::count(count as u64)),
    };
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &text));
    let color = theme::colors(ui).quiet;
    icons::paint(ui.painter(), rect.center(), Icon::EyeClosed, 12.0, color);
    response.on_hover_text(text);
}

/// A field for a name. Enter, or leaving it, accepts the name; Esc cancels.
fn name_field(ui: &mut Ui, number: usize, object: &Object, out: &mut Commands) {
    let id = Id::unique("object's name");
    let kept = ui.data(|data| data.get_temp::<String>(id));
    let is_new = kept.is_none();
    let mut name = kept.unwrap_or_else(|| object.name.clone());
    if is_new {
        ui.memory_mut(|memory| memory.request_focus(id));
        super::widgets::select_text(ui.ctx(), id, 0..name.chars().count());
    }
    let field = TextEdit::singleline(&mut name)
        .id(id)
        .hint_text("Name")
        .desired_width(f32::INFINITY);
    let response = ui.add(field);
    let escaped = ui.input(|input| input.key_pressed(Key::Escape));
    if response.lost_focus() || escaped {
        ui.data_mut(|data| data.remove::<String>(id));
        out.push(match escaped {
            true => Command::EditName(None),
            false => Command::Rename(number, name),
        });
    } else {
        ui.data_mut(|data| data.insert_temp(id, name));
    }
}

/// The controls of the selected object.
fn marked(ui: &mut Ui, state: &State, number: usize, object: &Object, out: &mut Commands) {
    groups::show(ui, state, (number, object), out);
    own_color(ui, state, (number, object), out);
    own_texture(ui, state, (number, object), out);
    texture_part::show(ui, state, (number, object), out);
    own_mapping(ui, state, (number, object), out);
    object_tree::parent(ui, state, number, out);
    if let Some(shape) = object.shape.filter(|_| object.source.is_none()) {
        shape::show(ui, state, (number, shape), out);
    }
    // What is set less often than it is looked at: a click in the picture marks an object, and lists its values below.
    CollapsingHeader::new("Place").show(ui, |ui| {
        transform::show(ui, state, number, object, out);
    });
    buttons(ui, state, out);
}

/// The colour of the selected object.
fn own_color(ui: &mut Ui, state: &State, (number, object): (usize, &Object), out: &mut Commands) {
    row(
        ui,
        "Its color",
        "How its triangles get their colors",
        |ui, label| {
            let current = match object.color {
                ColorRule::File => 0,
                ColorRule::Uniform(_) => 1,
                ColorRule::PerTriangle { .. } => 2,
                // A rule that only the Look part offers.
                _ => 3,
            };
            if let ColorRule::Uniform(one) = object.color {
                // Narrow, to leave room for the names.
                ui.spacing_mut().item_spacing.x = 4.0;
                ui.spacing_mut().interact_size.x = 22.0;
                let picked = color(ui, one, label, "The object's color");
                let rule = |c| Command::SetColorRule(Some(number), ColorRule::Uniform(c));
                out.extend(picked.map(rule));
            }
            let options = [
                (0, "Its file", "The file's own materials"),
                (1, "Plain", "One color for this object"),
                (2, "Random", "A color a triangle"),
            ];
            let chosen = ui
                .add_enabled_ui(!state.is_locked(number), |ui| choice(ui, current, &options))
                .inner;
            out.extend(chosen.map(|kind| {
                let rule = match kind {
                    0 => ColorRule::File,
                    1 => ColorRule::Uniform(Color::DEFAULT),
                    _ => ColorRule::PerTriangle { seed: 0 },
                };
                Command::SetColorRule(Some(number), rule)
            }));
        },
    );
}

/// The texture of the selected object.
fn own_texture(ui: &mut Ui, state: &State, (number, object): (usize, &Object), out: &mut Commands) {
    row(ui, "Its texture", "An image on this object", |ui, _| {
        let load = action("object.texture");
        ui.add_enabled_ui(!state.is_locked(number), |ui| {
            let name = object
                .texture_source
                .as_ref()
                .and_then(|path| path.file_name());
            let text = match name {
                Some(name) if object.has_stand_in() => {
                    format!("Missing: {}", name.to_string_lossy())
                }
                Some(name) => name.to_string_lossy().into_owned(),
                None => "Load…".to_owned(),
            };
            let room = ui.available_width() - if object.texture.is_some() { 66.0 } else { 0.0 };
            let button = Button::new(text).truncate().min_size(vec2(60.0, 0.0));
            ui.scope(|ui| {
                ui.set_max_width(room);
                let response = ui.add(button);
                response.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::Role::Button, true, "Load its texture")
                });
                if response
                    .on_hover_text(registry::hint(ui.ctx(), load.id))
                    .clicked()
                {
                    out.push((load.command)(state));
                }
            });
            if object.texture.is_some() {
                let response = ui.button("Remove");
                response.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::Role::Button, true, "Remove its texture")
                });
                if response.on_hover_text("Take its image off").clicked() {
                    out.push(Command::RemoveTexture(Some(number)));
                }
            }
        });
    });
}

/// How the selected object finds its place in its texture.
fn own_mapping(ui: &mut Ui, state: &State, (number, object): (usize, &Object), out: &mut Commands) {
    if !object.has_texture() {
        return;
    }
    let hint = "How this object finds its place in its texture";
    row(ui, "Its mapping", hint, |ui, label| {
        let picture = (
            None,
            "As in Surface",
            "The mapping that the Surface part sets for all",
        );
        let own = PROJECTIONS.map(|(projection, name, hint)| (Some(projection), name, hint));
        let options: Vec<_> = std::iter::once(picture).chain(own).collect();
        let current = object.mapping.projection;
        ui.add_enabled_ui(!state.is_locked(number), |ui| {
            let chosen = select(ui, "own mapping", label, current, &options);
            out.extend(chosen.map(|projection| Command::SetObjectProjection(number, projection)));
        });
    });
}

/// What can be done with the selected object.
fn buttons(ui: &mut Ui, state: &State, out: &mut Commands) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(3.0, 3.0);
        for id in [
            "object.isolate",
            "object.rename",
            "object.duplicate",
            "object.lock",
            "object.reset",
            "object.delete",
        ] {
            let action = action(id);
            let is_on = action.is_on.is_some_and(|is_on| is_on(state));
            let button = Button::new(action.name).small().selected(is_on);
            let response = ui.add_enabled((action.applies)(state), button);
            if response
                .on_hover_text(registry::hint(ui.ctx(), action.id))
                .clicked()
            {
                out.push((action.command)(state));
            }
        }
    });
}
