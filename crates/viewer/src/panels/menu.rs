//! The menu bar, from the registry.

use super::Commands;
use super::widgets::item;
use crate::state::State;
use crate::state::command::Command;
use crate::ui::registry::{Action, Menu, actions};
use egui::{
    Button, Context, FocusDirection, Id, InnerResponse, Key, MenuBar, Popup, Response, ScrollArea,
    Ui,
};
use raycast_report::cases::{self, CaseTheme};

/// Shows it.
pub(super) fn show(ui: &mut Ui, state: &State, out: &mut Commands) {
    let mut titles = Vec::with_capacity(Menu::ALL.len());
    // Opened once the places of all titles are known.
    let mut neighbor = None;
    MenuBar::new().ui(ui, |ui| {
        for (index, menu) in Menu::ALL.into_iter().enumerate() {
            let button = ui.menu_button(menu.name(), |ui| {
                let submenus = scrolled(ui, |ui| {
                    ui.set_min_width(190.0);
                    contents(ui, menu, state, out)
                });
                if let Some(step) = step_sideways(ui, &submenus) {
                    // The menu itself would go back to its title.
                    ui.memory_mut(|memory| memory.move_focus(FocusDirection::None));
                    neighbor = Some((index + step) % Menu::ALL.len());
                }
                enter_if_asked(ui, menu);
            });
            let title = button.response;
            if title.has_focus() && button.inner.is_none() && is_pressed(ui, Key::ArrowDown) {
                open(ui, menu, &title);
            }
            titles.push(title);
        }
    });
    if let Some(neighbor) = neighbor {
        open(ui, Menu::ALL[neighbor], &titles[neighbor]);
    }
    if let Some(first) = titles.first() {
        ui.data_mut(|data| data.insert_temp(Id::unique(FIRST), first.id));
    }
}

fn is_pressed(ui: &Ui, key: Key) -> bool {
    ui.input(|input| input.key_pressed(key))
}

const ASKED: &str = "menu to enter";

/// Opens a menu by an arrow key, which then moves the keyboard's focus no further.
fn open(ui: &Ui, menu: Menu, title: &Response) {
    Popup::open_id(ui.ctx(), Popup::default_response_id(title));
    title.request_focus();
    ui.memory_mut(|memory| memory.move_focus(FocusDirection::None));
    ui.data_mut(|data| data.insert_temp(Id::unique(ASKED), menu));
    ui.request_repaint();
}

/// Goes to the first entry of a menu that an arrow key opened: in its first pass, a menu only measures its entries.
fn enter_if_asked(ui: &Ui, menu: Menu) {
    let asked: Option<Menu> = ui.data(|data| data.get_temp(Id::unique(ASKED)));
    if asked == Some(menu) && !ui.is_sizing_pass() {
        ui.data_mut(|data| data.remove::<Menu>(Id::unique(ASKED)));
        ui.memory_mut(|memory| memory.move_focus(FocusDirection::Down));
    }
}

/// How many menus further the left or right arrow leads from an open menu. Those of a submenu stay in it.
fn step_sideways(ui: &Ui, submenus: &[Submenu]) -> Option<usize> {
    let is_at_submenu = submenus.iter().any(|submenu| submenu.has_focus);
    let is_in_submenu = !is_at_submenu && submenus.iter().any(|submenu| submenu.is_open);
    if is_in_submenu {
        None
    } else if is_pressed(ui, Key::ArrowLeft) {
        Some(Menu::ALL.len() - 1)
    } else if is_pressed(ui, Key::ArrowRight) && !is_at_submenu {
        Some(1)
    } else {
        None
    }
}

/// A menu inside a menu, as the arrow keys see it.
struct Submenu {
    is_open: bool,
    has_focus: bool,
}

impl Submenu {
    fn of(button: &InnerResponse<Option<()>>) -> Self {
        Self {
            is_open: button.inner.is_some(),
            has_focus: button.response.has_focus(),
        }
    }
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
fn scrolled<R>(ui: &mut Ui, entries: impl FnOnce(&mut Ui) -> R) -> R {
    let window = ui.ctx().content_rect().height();
    let room = window - 48.0;
    // Otherwise an area offers the height that it had at first.
    ui.set_max_height(window);
    let area = ScrollArea::vertical().max_height(room);
    area.show(ui, entries).inner
}

fn contents(ui: &mut Ui, menu: Menu, state: &State, out: &mut Commands) -> Vec<Submenu> {
    let mut submenus = Vec::new();
    let own = |action: &&Action| action.menu == menu && !is_part(action);
    for action in actions().filter(own) {
        if action.is_first_of_group {
            ui.separator();
        }
        item(ui, state, action, out);
        match action.id {
            "file.add" => submenus.push(recent(ui, state, out)),
            "file.watch" => submenus.push(hard_cases(ui, out)),
            "window.panel" => submenus.push(parts(ui, state, out)),
            _ => {}
        }
    }
    submenus
}

fn is_part(action: &Action) -> bool {
    action.id.starts_with("panel.")
}

/// The panel's parts.
fn parts(ui: &mut Ui, state: &State, out: &mut Commands) -> Submenu {
    let menu = ui.menu_button("Part of the panel", |ui| {
        for action in actions().filter(|action| is_part(action)) {
            item(ui, state, action, out);
        }
    });
    Submenu::of(&menu)
}

/// Recent files.
fn recent(ui: &mut Ui, state: &State, out: &mut Commands) -> Submenu {
    let recent = &state.preferences.recent;
    let menu = ui.add_enabled_ui(!recent.is_empty(), |ui| {
        ui.menu_button("Open recent", |ui| {
            for file in recent {
                let name = file.file_name().unwrap_or(file.as_os_str());
                let item = ui.add(Button::new(name.to_string_lossy()));
                if item.on_hover_text(file.display().to_string()).clicked() {
                    out.push(Command::Open(vec![file.clone()]));
                    ui.close();
                }
            }
        })
    });
    Submenu::of(&menu.inner)
}

/// The hard cases, theme by theme.
fn hard_cases(ui: &mut Ui, out: &mut Commands) -> Submenu {
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
    let submenu = Submenu::of(&menu);
    menu.response
        .on_hover_text("Scenes at which known ray casters go wrong");
    submenu
}
