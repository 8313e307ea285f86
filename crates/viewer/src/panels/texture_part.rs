//! The part of its image that an object's texture shows: a rectangle on the image, drawn or typed, and what lies beyond it.

use super::Commands;
use super::widgets::{Number, row, select};
use crate::state::State;
use crate::state::command::Command;
use crate::state::thumbnail::{ShownImage, TexturePart, Thumbnail};
use crate::ui::theme;
use egui::{
    Button, Color32, ColorImage, CursorIcon, Id, Pos2, Rect, Role, Sense, Stroke, StrokeKind,
    TextureHandle, TextureOptions, Ui, WidgetInfo, pos2, vec2,
};
use raycast_core::scene::{Crop, Object, Wrap};
use std::path::Path;
use std::sync::Arc;

/// The greatest height of the image, in points.
const TALLEST: f32 = 170.0;

/// The rectangle while it is drawn or a number is dragged: the object, and its columns and rows.
const DRAFT: &str = "part of a texture";
/// Whether the controls are open.
const OPEN: &str = "part of a texture is open";
/// Where on the image a drag began.
const START: &str = "corner of a part";

pub(super) fn show(
    ui: &mut Ui,
    state: &State,
    (number, object): (usize, &Object),
    out: &mut Commands,
) {
    let (Some(texture), Some(path)) = (&object.texture, &object.texture_source) else {
        return;
    };
    if texture.is_stand_in() {
        return;
    }
    // The part that was chosen last is what the next choice changes, also while it is being read.
    let requests = &state.textures;
    let scene = state.document.as_ref().map(|document| &document.scene);
    let asked = scene.and_then(|scene| requests.part(scene, number, path));
    let part = asked.unwrap_or_else(|| TexturePart::of(texture));
    let title = match part.crop {
        None => "Whole image".to_owned(),
        Some(crop) => format!("{}×{} at {}, {}", crop.width, crop.height, crop.x, crop.y),
    };
    row(
        ui,
        "Shown part",
        "The part of the image that is shown",
        |ui, _| {
            let open = Id::unique(OPEN);
            let mut is_open = ui.data(|data| data.get_temp(open)).unwrap_or(false);
            let response = ui.add(Button::new(title).selected(is_open).truncate());
            let response =
                response.on_hover_text("Choose a rectangle of the image, and what is beyond it");
            if response.clicked() {
                is_open = !is_open;
                ui.data_mut(|data| data.insert_temp(open, is_open));
            }
        },
    );
    let open = Id::unique(OPEN);
    if ui.data(|data| data.get_temp(open)) != Some(true) {
        return;
    }
    match shown(state, path) {
        None => out.push(Command::ShowImage(path.clone())),
        Some(Ok(None)) => {
            ui.label("Reading the image…");
        }
        Some(Err(reason)) => {
            ui.colored_label(ui.visuals().warn_fg_color, reason);
        }
        Some(Ok(Some(image))) => {
            ui.add_enabled_ui(!state.is_locked(number), |ui| {
                choose(ui, (number, part), image, out);
            });
        }
    }
}

/// The thumbnail of a file, if it was asked for.
fn shown<'s>(state: &'s State, path: &Path) -> Option<Result<Option<&'s Arc<Thumbnail>>, &'s str>> {
    let ShownImage { found, .. } = state.image.as_ref().filter(|shown| shown.path == path)?;
    Some(found.as_ref().map(Option::as_ref).map_err(String::as_str))
}

/// The controls; a rectangle is taken when the mouse lets go of it.
fn choose(
    ui: &mut Ui,
    (number, part): (usize, TexturePart),
    image: &Arc<Thumbnail>,
    out: &mut Commands,
) {
    let (width, height) = image.of;
    let whole = Crop {
        x: 0,
        y: 0,
        width,
        height,
    };
    let current = part.crop.unwrap_or(whole);
    let kept: Option<(usize, Crop)> = ui.data(|data| data.get_temp(Id::unique(DRAFT)));
    let draft = kept.filter(|(of, _)| *of == number).map(|(_, crop)| crop);
    let mut chosen = draft.unwrap_or(current);
    if let Some(drawn) = picture(ui, image, chosen) {
        chosen = drawn;
    }
    numbers(ui, whole, &mut chosen);
    let is_held = ui.input(|input| input.pointer.any_down());
    ui.data_mut(|data| {
        if is_held && chosen != current {
            data.insert_temp(Id::unique(DRAFT), (number, chosen));
        } else {
            data.remove::<(usize, Crop)>(Id::unique(DRAFT));
        }
    });
    if !is_held && chosen != current {
        let crop = (chosen != whole).then_some(chosen);
        out.push(Command::SetTexturePart(
            number,
            TexturePart { crop, ..part },
        ));
    }
    if part.crop.is_some() {
        row(ui, "", "", |ui, _| {
            let hint = "Show all of the image";
            let response = ui.button("Whole image");
            response
                .widget_info(|| WidgetInfo::labeled(Role::Button, true, "Show the whole image"));
            if response.on_hover_text(hint).clicked() {
                let whole = TexturePart { crop: None, ..part };
                out.push(Command::SetTexturePart(number, whole));
            }
        });
    }
    for (axis, (name, hint)) in [
        ("Wrap u", "What is left and right of the image"),
        ("Wrap v", "What is above and below the image"),
    ]
    .into_iter()
    .enumerate()
    {
        beyond(ui, (number, part), (axis, name, hint), out);
    }
}

/// What lies beyond the image along one axis.
fn beyond(
    ui: &mut Ui,
    (number, part): (usize, TexturePart),
    (axis, name, hint): (usize, &str, &str),
    out: &mut Commands,
) {
    row(ui, name, hint, |ui, label| {
        let current = part.wrap[axis];
        let border = match current {
            Wrap::Border(Some(_)) => current,
            _ => Wrap::Border(None),
        };
        let options = [
            (Wrap::Repeat, "Repeat", "The image again and again"),
            (
                Wrap::Mirror,
                "Mirror",
                "The image again, every other one mirrored",
            ),
            (Wrap::Clamp, "Clamp", "The texels at its edge, drawn out"),
            (
                border,
                "Border",
                "A border's color, or else the object's own",
            ),
        ];
        let id = ["beyond across", "beyond up"][axis];
        if let Some(wrap) = select(ui, id, label, current, &options) {
            let mut part = part;
            part.wrap[axis] = wrap;
            out.push(Command::SetTexturePart(number, part));
        }
    });
}

/// The numbers of the rectangle; each keeps it within the image.
fn numbers(ui: &mut Ui, whole: Crop, crop: &mut Crop) {
    let number = |ui: &mut Ui, name: &str, (value, least, most): (u32, u32, u32)| {
        let number = Number {
            value: f64::from(value),
            range: f64::from(least)..=f64::from(most),
            speed: f64::from(whole.width.max(whole.height)) / 400.0,
            decimals: Some(0),
            suffix: "",
            width: 46.0,
            hint: name,
        };
        number.show_as(ui, name).map(|value| value.round() as u32)
    };
    let Crop {
        x,
        y,
        width,
        height,
    } = *crop;
    row(
        ui,
        "Corner",
        "Columns left of the rectangle, and rows above it",
        |ui, _| {
            if let Some(x) = number(ui, "Columns left of the part", (x, 0, whole.width - width)) {
                crop.x = x;
            }
            if let Some(y) = number(ui, "Rows above the part", (y, 0, whole.height - height)) {
                crop.y = y;
            }
        },
    );
    row(ui, "Size", "Columns and rows of the rectangle", |ui, _| {
        if let Some(width) = number(ui, "Columns of the part", (width, 1, whole.width - x)) {
            crop.width = width;
        }
        if let Some(height) = number(ui, "Rows of the part", (height, 1, whole.height - y)) {
            crop.height = height;
        }
    });
}

/// The image with the rectangle on it; returns the one that is being drawn.
fn picture(ui: &mut Ui, image: &Arc<Thumbnail>, crop: Crop) -> Option<Crop> {
    let (columns, rows) = (image.of.0 as f32, image.of.1 as f32);
    let scale = (ui.available_width() / columns).min(TALLEST / rows);
    let (place, response) = ui.allocate_exact_size(vec2(columns, rows) * scale, Sense::drag());
    response.widget_info(|| {
        WidgetInfo::labeled(Role::Image, true, "The image, with the part that is shown")
    });
    let response = response
        .on_hover_cursor(CursorIcon::Crosshair)
        .on_hover_text("Draw a rectangle: the part that is shown");
    let handle = handle(ui, image);
    let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    let painter = ui.painter_at(place);
    painter.image(handle.id(), place, uv, Color32::WHITE);
    let at = |x: u32, y: u32| place.min + vec2(x as f32, y as f32) * scale;
    let shown = Rect::from_min_max(
        at(crop.x, crop.y),
        at(crop.x + crop.width, crop.y + crop.height),
    );
    let shade = Color32::from_black_alpha(150);
    for beyond in [
        Rect::from_min_max(place.min, pos2(place.max.x, shown.min.y)),
        Rect::from_min_max(pos2(place.min.x, shown.max.y), place.max),
        Rect::from_min_max(
            pos2(place.min.x, shown.min.y),
            pos2(shown.min.x, shown.max.y),
        ),
        Rect::from_min_max(
            pos2(shown.max.x, shown.min.y),
            pos2(place.max.x, shown.max.y),
        ),
    ] {
        painter.rect_filled(beyond, 0.0, shade);
    }
    let stroke = Stroke::new(1.5, theme::colors(ui).accent);
    painter.rect_stroke(shown, 0.0, stroke, StrokeKind::Inside);
    let pointer = response.interact_pointer_pos()?;
    let start = Id::unique(START);
    if response.drag_started() {
        let from = ui
            .input(|input| input.pointer.press_origin())
            .unwrap_or(pointer);
        ui.data_mut(|data| data.insert_temp(start, from));
    }
    let from: Pos2 = ui.data(|data| data.get_temp(start))?;
    between(
        image.of,
        (from - place.min) / scale,
        (pointer - place.min) / scale,
    )
}

/// The texels between two places on an image, if they are any.
fn between((width, height): (u32, u32), from: egui::Vec2, to: egui::Vec2) -> Option<Crop> {
    let side = |a: f32, b: f32, most: u32| {
        let first = a.min(b).floor().clamp(0.0, most as f32) as u32;
        let last = a.max(b).ceil().clamp(0.0, most as f32) as u32;
        (last > first).then_some((first, last - first))
    };
    let (x, width) = side(from.x, to.x, width)?;
    let (y, height) = side(from.y, to.y, height)?;
    Some(Crop {
        x,
        y,
        width,
        height,
    })
}

/// The image as a texture of the interface, made once.
fn handle(ui: &Ui, image: &Arc<Thumbnail>) -> TextureHandle {
    let id = Id::unique("thumbnail");
    let kept: Option<(Arc<Thumbnail>, TextureHandle)> = ui.data(|data| data.get_temp(id));
    if let Some((of, handle)) = kept
        && Arc::ptr_eq(&of, image)
    {
        return handle;
    }
    let texels = image.texels.as_flattened();
    let pixels = ColorImage::from_rgba_unmultiplied(image.size, texels);
    let handle = ui
        .ctx()
        .load_texture("thumbnail", pixels, TextureOptions::LINEAR);
    ui.data_mut(|data| data.insert_temp(id, (Arc::clone(image), handle.clone())));
    handle
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_are_the_texels_touched_within_the_image() {
        let crop = |x, y, width, height| {
            Some(Crop {
                x,
                y,
                width,
                height,
            })
        };
        let of = (10, 6);
        assert_eq!(
            between(of, vec2(1.2, 1.0), vec2(3.5, 4.0)),
            crop(1, 1, 3, 3)
        );
        assert_eq!(
            between(of, vec2(3.5, 4.0), vec2(1.2, 1.0)),
            crop(1, 1, 3, 3)
        );
        assert_eq!(
            between(of, vec2(-5.0, 2.0), vec2(99.0, 3.0)),
            crop(0, 2, 10, 1)
        );
        assert_eq!(between(of, vec2(12.0, 2.0), vec2(99.0, 3.0)), None);
        assert_eq!(between(of, vec2(2.0, 2.0), vec2(2.0, 3.0)), None);
    }
}
