//! Faults of meshes: counts, and buttons that show each fault.

use super::Commands;
use super::widgets::{changed_from, fact, section_that_opens};
use crate::state::State;
use crate::state::command::Command;
use crate::state::inspection::{Checked, Fault, Shown};
use crate::ui::format;
use crate::ui::icons::Icon;
use crate::ui::registry::{self, action};
use crate::ui::theme;
use egui::{Button, RichText, Ui, vec2};
use std::sync::Arc;

/// The most objects whose faults are listed: nobody reads more, and laying them out would take longer than a frame.
const MOST: usize = 40;

pub(super) fn show(ui: &mut Ui, state: &State, out: &mut Commands) {
    let Some(document) = &state.document else {
        return;
    };
    // A check may be started from menus and the palette, too: the part opens to show its results.
    let rounds = state.inspection.rounds;
    let is_new = rounds > 0 && changed_from(ui, "last check", rounds, 0).is_some();
    section_that_opens(ui, (Icon::HeartPulse, "Health"), false, is_new, |ui| {
        let name = match state.selected.and_then(|n| document.scene.objects.get(n)) {
            Some(object) => format!("Check {}", object.name),
            None => "Check all objects".to_owned(),
        };
        ask(ui, state, "tools.check", &name, out);
        ask(
            ui,
            state,
            "tools.intersections",
            "Find self-intersections",
            out,
        );
        let objects = &document.scene.objects;
        let checked = state.inspection.checked.iter().filter_map(|checked| {
            let object = objects.get(checked.object)?;
            Arc::ptr_eq(&object.mesh, &checked.mesh).then_some((checked, &object.name))
        });
        // Of several objects those without faults are only counted.
        let is_one = state.inspection.checked.len() == 1;
        let (listed, sound): (Vec<_>, Vec<_>) =
            checked.partition(|(checked, _)| is_one || !checked.is_sound());
        for (checked, name) in listed.iter().take(MOST) {
            ui.push_id(checked.object, |ui| object(ui, state, name, checked, out));
        }
        if listed.len() > MOST {
            ui.weak(format!("… and {} more with faults", listed.len() - MOST));
        }
        if !sound.is_empty() {
            let count = format::count(sound.len() as u64);
            ui.weak(format!("Without any fault: {count}"));
        }
    });
}

/// A button of full width for a command of the registry.
fn ask(ui: &mut Ui, state: &State, id: &str, text: &str, out: &mut Commands) {
    let action = action(id);
    let width = ui.available_width();
    let button = Button::new(text).truncate().min_size(vec2(width, 0.0));
    let response = ui.add_enabled((action.applies)(state), button);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, action.name));
    if response
        .on_hover_text(registry::hint(ui.ctx(), action.id))
        .clicked()
    {
        out.push((action.command)(state));
    }
}

fn object(ui: &mut Ui, state: &State, name: &str, checked: &Checked, out: &mut Commands) {
    let health = &checked.health;
    let colors = theme::colors(ui);
    ui.horizontal(|ui| {
        ui.add(egui::Label::new(RichText::new(name).strong()).truncate());
        let (verdict, color) = match (checked.is_sound(), health.is_closed()) {
            (true, _) => ("sound", colors.done),
            (false, true) => ("closed, with faults", colors.error),
            (false, false) => ("not closed", colors.error),
        };
        ui.label(RichText::new(verdict).color(color));
    });
    let mut is_clean = true;
    for fault in Fault::ALL {
        let count = checked.count(fault);
        if count > 0 {
            is_clean = false;
            faults(ui, state, checked, fault, count, out);
        }
    }
    if health.inside_out > 0 {
        is_clean = false;
        let hint = "Closed shells whose triangles turn right as seen from outside";
        fact(
            ui,
            "Inside out",
            hint,
            &format::count(health.inside_out as u64),
        );
    }
    if health.one_sided > 0 {
        is_clean = false;
        let hint = "Parts with one side alone, as a Möbius band has";
        fact(
            ui,
            "One-sided",
            hint,
            &format::count(health.one_sided as u64),
        );
    }
    match &checked.intersections {
        None if is_clean => {
            ui.weak("No fault was found; self-intersections were not looked for");
        }
        Some(_) if is_clean => {
            ui.weak("No fault was found, nor any self-intersection");
        }
        Some(found) if found.pairs.is_empty() => {
            ui.weak("No self-intersection was found");
        }
        _ => {}
    }
    let euler = health.euler_characteristic();
    fact(
        ui,
        "Shells",
        "Parts that hang together by edges; V − E + F of all of them",
        &format!(
            "{}, Euler characteristic {euler}",
            format::count(health.shells as u64)
        ),
    );
}

fn faults(
    ui: &mut Ui,
    state: &State,
    checked: &Checked,
    fault: Fault,
    count: usize,
    out: &mut Commands,
) {
    let (name, what) = fault.name();
    let shown = state.inspection.shown;
    let shown = shown.filter(|s| s.object == checked.object && s.fault == fault);
    let show = |index| {
        let object = checked.object;
        Command::ShowFault(Some(Shown {
            object,
            fault,
            index,
        }))
    };
    let mut text = format::count(count as u64);
    if checked.has_more(fault) {
        text = format!("over {text}");
    }
    let text = RichText::new(text).color(theme::colors(ui).error);
    let button = Button::new(name)
        .selected(shown.is_some())
        .right_text(text)
        .min_size(vec2(ui.available_width(), 0.0));
    let response = ui.add(button);
    response.widget_info(|| {
        egui::WidgetInfo::selected(egui::Role::Button, true, shown.is_some(), name)
    });
    if response
        .on_hover_text(format!("{what}. Click to look at them"))
        .clicked()
    {
        out.push(match shown {
            Some(_) => Command::ShowFault(None),
            None => show(0),
        });
    }
    let Some(shown) = shown else {
        return;
    };
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        let step = |ui: &mut Ui, text: &str, spoken: &str, index: usize| {
            let response = ui.add(Button::new(text).small());
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, spoken));
            response
                .on_hover_text(spoken)
                .clicked()
                .then(|| show(index))
        };
        out.extend(step(
            ui,
            "Back",
            "The fault before",
            (shown.index + count - 1) % count,
        ));
        out.extend(step(
            ui,
            "Next",
            "The next fault",
            (shown.index + 1) % count,
        ));
        let number = checked.number(fault, shown.index).unwrap_or_default();
        ui.add(egui::Label::new(format!("{} of {count}: {number}", shown.index + 1)).truncate());
    });
}
