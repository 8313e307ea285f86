//! The menu bar, from the registry.

use super::Commands;
use super::widgets::item;
use crate::state::State;
use crate::state::command::Command;
use crate::ui::registry::{Action, Menu, actions};
use egui::{Button, Context, Id, MenuBar, ScrollArea, Ui};
use raycast_report::cases::{self, CaseTheme};

/// Shows it.
pub(super) fn show(ui: &mut Ui, state: &State, out: &mut Commands) {
    MenuBar::new().ui(ui, |ui| {
        for menu in Menu::ALL {
            let button = ui.menu_button(menu.name(), |ui| {
                scrolled(ui, |ui| {
                    ui.set_min_width(190.0);
                    contents(ui, menu, state, out);
                });
            });
            if menu == Menu::ALL[0] {
                let id = button.response.id;
                ui.data_mut(|data| data.insert_temp(Id::unique(FIRST), id));
            }
        }
    });
}

const FIRST: &str = "first menu";

/// Gives the keyboard to the menu bar.
pub fn focus(context: &Context) {
    let first: Option<Id> = context.data(|data| data.get_temp(Id::unique(FIRST)));
    if let Some(first) = first {
        context.memory_mut(|memory| memory.request_focus(first));
    }
}

/// A menu's entries, which scroll where the window is too low for them.
fn scrolled(ui: &mut Ui, entries: impl FnOnce(&mut Ui)) {
    let window = ui.ctx().content_rect().height();
    let room = window - 48.0;
    // Otherwise an area offers the height that it had at first.
    ui.set_max_height(window);
    ScrollArea::vertical().max_height(room).show(ui, entries);
}

fn contents(ui: &mut Ui, menu: Menu, state: &State, out: &mut Commands) {
    let own = |action: &&Action| action.menu == menu && !is_part(action);
    for action in actions().filter(own) {
        if action.is_first_of_group {
            ui.separator();
        }
        item(ui, state, action, out);
        match action.id {
            "file.add" => recent(ui, state, out),
            "file.watch" => hard_cases(ui, out),
            "window.panel" => parts(ui, state, out),
            _ => {}
        }
    }
}

fn is_part(action: &Action) -> bool {
    action.id.starts_with("panel.")
}

/// The panel's parts.
fn parts(ui: &mut Ui, state: &State, out: &mut Commands) {
    ui.menu_button("Part of the panel", |ui| {
        for action in actions().filter(|action| is_part(action)) {
            item(ui, state, action, out);
        }
    });
}

/// Recent files.
fn recent(ui: &mut Ui, state: &State, out: &mut Commands) {
    let recent = &state.preferences.recent;
    ui.add_enabled_ui(!recent.is_empty(), |ui| {
        ui.menu_button("Open recent", |ui| {
            for file in recent {
                let name = file.file_name().unwrap_or(file.as_os_str());
                let item = ui.add(Button::new(name.to_string_lossy()));
                if item.on_hover_text(file.display().to_string()).clicked() {
                    out.push(Command::Open(vec![file.clone()]));
                    ui.close();
                }
            }
        });
    });
}

/// The hard cases, theme by theme.
fn hard_cases(ui: &mut Ui, out: &mut Commands) {
    let menu = ui.menu_button("Open hard case", |ui| {
        for theme in CaseTheme::ALL {
            ui.menu_button(theme.name(), |ui| {
                scrolled(ui, |ui| {
                    for case in cases::all().iter().filter(|case| case.theme == theme) {
                        let item = ui.button(case.title()).on_hover_text(case.difficulty);
                        if item.clicked() {
                            out.push(Command::OpenCase(case.name));
                            ui.close();
                        }
                    }
                });
            });
        }
    });
    menu.response
        .on_hover_text("Scenes at which known ray casters go wrong");
}
