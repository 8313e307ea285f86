//! The line in which a path is typed.

use super::Commands;
use super::widgets::{card, select_text};
use crate::state::command::Command;
use crate::state::listing::folder_of;
use crate::state::{Prompt, PromptKind};
use crate::ui::theme;
use egui::{CompletionPopup, Id, RichText, Ui};

/// Its title, what its button does, and what is expected.
fn words(kind: PromptKind) -> (&'static str, &'static str, &'static str) {
    match kind {
        PromptKind::Open => (
            "Open meshes or a scene",
            "Open",
            "path of a mesh or a .raycast.toml",
        ),
        PromptKind::Add => (
            "Add meshes or a scene",
            "Add",
            "path of a mesh or a .raycast.toml",
        ),
        PromptKind::Picture => (
            "Save the picture",
            "Save",
            "a name ending in .png, .ppm, .jpg, .tif or .exr",
        ),
        PromptKind::Measurements => ("Save the measurements", "Save", "a name ending in .csv"),
        PromptKind::Meshes => (
            "Save the meshes",
            "Save",
            "a name ending in .obj, .ply, .stl, .glb or .txt",
        ),
        PromptKind::Outline(_) => ("Save the outline", "Save", "a name ending in .svg or .dxf"),
        PromptKind::Scene => ("Save the scene", "Save", "a name ending in .raycast.toml"),
        PromptKind::SceneCopy => (
            "Save a copy of the scene",
            "Save",
            "a name ending in .raycast.toml",
        ),
        PromptKind::Texture | PromptKind::TextureOf(_) => {
            ("Load a texture", "Load", "path of an image")
        }
    }
}

pub(super) fn show(ui: &mut Ui, prompt: &Prompt, out: &mut Commands) {
    let (title, action, hint) = words(prompt.kind);
    card(ui, theme::colors(ui).accent).show(ui, |ui| {
        ui.set_width(ui.available_width());
        let label = heading(ui, title, prompt);
        let id = Id::unique("path");
        let is_new = ui.ctx().read_response(id).is_none();
        if is_new {
            take_keyboard(ui, id, prompt);
        }
        ui.horizontal(|ui| {
            let entered = field(ui, (id, label), hint, prompt, out);
            let confirm = ui.button(action);
            let name = format!("{action} this path");
            confirm.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
            if confirm.clicked() || entered {
                out.push(Command::ConfirmPath);
            }
            if ui.button("Cancel").on_hover_text("Close (Esc)").clicked() {
                out.push(Command::Dismiss);
            }
        });
        if matches!(prompt.kind, PromptKind::Open | PromptKind::Add) {
            let mut adding = prompt.kind == PromptKind::Add;
            let hint = "What is open stays, and the new objects come beside it";
            let tick = ui.checkbox(&mut adding, "Add to what is open");
            if tick.on_hover_text(hint).changed() {
                out.push(Command::SetAdding(adding));
            }
        }
    });
}

/// The title, and what else can be done; returns the field's label.
fn heading(ui: &mut Ui, title: &str, prompt: &Prompt) -> Id {
    ui.horizontal(|ui| {
        let label = ui.label(RichText::new(title).strong()).id;
        let more = match (prompt.dialog, prompt.kind.saves()) {
            (true, _) => "choose in the dialog, or type a path:".to_owned(),
            (false, true) => match std::env::current_dir() {
                Ok(folder) => format!("type a path, or a name in {}:", folder.display()),
                Err(_) => "type a path:".to_owned(),
            },
            // A dropped file is opened, whatever the path line is for.
            (false, false) => "type a path, or drop a file on the window:".to_owned(),
        };
        ui.add(egui::Label::new(RichText::new(more).weak()).truncate());
        label
    })
    .inner
}

/// Before the field is shown, so that it gets text that is typed in this frame.
fn take_keyboard(ui: &Ui, id: Id, prompt: &Prompt) {
    // A suggested name is selected up to its ending, as in file dialogs, and typing replaces that.
    ui.memory_mut(|memory| memory.request_focus(id));
    let stem = match prompt.kind.saves() {
        true => prompt.text.split('.').next().unwrap_or_default(),
        false => prompt.text.as_str(),
    };
    let stem = stem.chars().count();
    // What was typed already stays.
    let from = if prompt.listing.is_some() { stem } else { 0 };
    select_text(ui.ctx(), id, from..stem);
}

/// The field; returns whether its text was accepted by Enter.
fn field(
    ui: &mut Ui,
    (id, label): (Id, Id),
    hint: &str,
    prompt: &Prompt,
    out: &mut Commands,
) -> bool {
    let mut text = prompt.text.clone();
    let edit = egui::TextEdit::singleline(&mut text)
        .hint_text(hint)
        .desired_width(ui.available_width() - 122.0);
    // What the popup accepts by Enter, the field does not get.
    let enter = ui.input(|input| input.key_pressed(egui::Key::Enter));
    // Enter accepts a name to open: where something completes it, no file has it. One to save may be new.
    let accepting: &[egui::Key] = match prompt.kind.saves() {
        true => &[egui::Key::Tab],
        false => &[egui::Key::Tab, egui::Key::Enter],
    };
    let popup = CompletionPopup::new(id)
        .word_boundary(std::path::is_separator)
        .align(egui::RectAlign::BOTTOM_START)
        .accept_keys(accepting);
    let output = popup.show(ui, edit, |query| suggestions(prompt, query));
    let response = output.text_edit.response.response.labelled_by(label);
    // After a folder's name, which ends in a separator, comes a name in it; a file's is all that was asked for.
    let is_file = output.accepted.is_some() && !text.ends_with(std::path::is_separator);
    if response.changed() || output.accepted.is_some() {
        out.push(Command::TypePath(text));
    }
    // The popup keeps Enter from the field also where it accepts nothing: names that a letter typed in this frame rules out.
    let is_kept = output.accepted.is_none() && response.has_focus();
    let entered = enter && (response.lost_focus() || is_file || is_kept);
    if !response.has_focus() && ui.memory(|memory| memory.focused().is_none()) {
        response.request_focus();
    }
    entered
}

/// The most names below a path line: more are found sooner by typing on.
const MOST_NAMES: usize = 100;

/// The names that complete a path.
fn suggestions(prompt: &Prompt, query: &egui::CompletionQuery<'_>) -> Vec<egui::Suggestion> {
    let Some(listing) = &prompt.listing else {
        return Vec::new();
    };
    let is_listed = folder_of(query.text.trim_start()) == listing.folder;
    let is_at_end = query.text.chars().count() == query.word_range.end.0;
    if query.text.trim().is_empty() || !is_listed || !is_at_end {
        return Vec::new();
    }
    let names = listing.completing(query.word.trim_start());
    names.take(MOST_NAMES).map(egui::Suggestion::new).collect()
}
