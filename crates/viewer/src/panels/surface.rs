//! Settings of surfaces and textures that are seldom changed.

use super::widgets::{choice, color, row, section, select, tick};
use super::{Commands, light};
use crate::state::State;
use crate::state::command::Command;
use crate::ui::icons::Icon;
use egui::Ui;
use raycast_core::Cull;
use raycast_core::scene::{Color, Object, TextureProjection};
use raycast_core::shade::{Filter, Shading};

pub(super) fn show(ui: &mut Ui, state: &State, out: &mut Commands) {
    section(ui, (Icon::Spline, "Surface"), false, |ui| {
        row(ui, "Faces", "Which faces rays meet", |ui, _| {
            let options = [
                (Cull::None, "Both sides", "Rays meet fronts and backs"),
                (
                    Cull::Back,
                    "Fronts only",
                    "Rays pass through the backs of triangles",
                ),
            ];
            out.extend(choice(ui, state.settings.cull, &options).map(Command::SetCull));
        });
        light::rows(ui, state, out);
        backs(ui, state, out);
        let document = state.document.as_ref();
        if document.is_some_and(|d| d.scene.objects.iter().any(Object::has_texture)) {
            texture(ui, state, out);
        }
    });
}

/// The default colour of back faces: far from the hues of clay, skin and stone.
const BACKS: Color = Color([0xd0, 0x4a, 0x9a]);

fn backs(ui: &mut Ui, state: &State, out: &mut Commands) {
    let hint = "Show triangles that are seen from behind in a color of their own";
    row(ui, "Backs", hint, |ui, label| {
        let current = state.settings.shading.back_faces;
        if let Some(own) = tick(ui, current.is_some(), "Own color", hint) {
            out.push(Command::SetBackFaces(own.then_some(BACKS)));
        }
        if let Some(shown) = current {
            let chosen = color(ui, shown, label, "The color of backs");
            out.extend(chosen.map(|color| Command::SetBackFaces(Some(color))));
        }
    });
}

fn texture(ui: &mut Ui, state: &State, out: &mut Commands) {
    let shading = &state.settings.shading;
    filter(ui, shading, out);
    mapping(ui, shading, out);
    let mut objects = state.document.iter().flat_map(|d| &d.scene.objects);
    let is_camera = |object: &Object| {
        let own = object.mapping.projection.unwrap_or(shading.projection);
        own == TextureProjection::Camera && object.has_texture()
    };
    if objects.any(is_camera) {
        photograph(ui, out);
    }
    blend(ui, shading, out);
}

fn filter(ui: &mut Ui, shading: &Shading, out: &mut Commands) {
    row(ui, "Filter", "What is between texels", |ui, label| {
        let options = [
            (Filter::Nearest, "Nearest", "The nearest texel: blocks"),
            (
                Filter::Bilinear,
                "Bilinear",
                "Four texels, blended in linear light",
            ),
            (
                Filter::Trilinear,
                "Trilinear",
                "Smaller images where it is far away: no shimmer",
            ),
            (
                Filter::Ewa,
                "EWA",
                "All texels that a pixel sees: no shimmer, and sharp at a slant",
            ),
        ];
        out.extend(select(ui, "filter", label, shading.filter, &options).map(Command::SetFilter));
    });
}

/// The texture projections: names, and what they are.
pub(super) const PROJECTIONS: [(TextureProjection, &str, &str); 7] = [
    (
        TextureProjection::Uv,
        "By UV",
        "The mesh's texture coordinates",
    ),
    (
        TextureProjection::Triplanar,
        "Triplanar",
        "From three sides along the object's axes",
    ),
    (
        TextureProjection::PerTriangle,
        "Per triangle",
        "Each triangle laid into the image in its own shape",
    ),
    (
        TextureProjection::Plane,
        "Plane",
        "Straight onto the object from its front",
    ),
    (
        TextureProjection::Sphere,
        "Sphere",
        "By longitude and latitude about the object's middle",
    ),
    (
        TextureProjection::Cylinder,
        "Cylinder",
        "By angle and height about the object's axis",
    ),
    (
        TextureProjection::Camera,
        "Camera",
        "A photograph, onto what its camera saw",
    ),
];

fn mapping(ui: &mut Ui, shading: &Shading, out: &mut Commands) {
    let hint =
        "How surfaces find their place in the texture; objects may have mappings of their own";
    row(ui, "Mapping", hint, |ui, label| {
        let chosen = select(ui, "mapping", label, shading.projection, &PROJECTIONS);
        out.extend(chosen.map(Command::SetTextureProjection));
    });
}

fn photograph(ui: &mut Ui, out: &mut Commands) {
    let hint = "Where the photograph was taken";
    row(ui, "Taken", hint, |ui, _| {
        let button =
            egui::Button::new("From this view").min_size(egui::vec2(ui.available_width(), 0.0));
        let hint = "Take the textures for photographs from where the camera stands now";
        if ui.add(button).on_hover_text(hint).clicked() {
            out.push(Command::TakePhotographs);
        }
    });
}

fn blend(ui: &mut Ui, shading: &Shading, out: &mut Commands) {
    row(
        ui,
        "Blend",
        "From the object's colors (0) to its texture (1)",
        |ui, label| {
            let mut blend = shading.blend;
            ui.spacing_mut().slider_width = 110.0;
            let slider = egui::Slider::new(&mut blend, 0.0..=1.0).fixed_decimals(2);
            let hint = "From the object's colors (0) to its texture (1)";
            if ui
                .add(slider)
                .labelled_by(label)
                .on_hover_text(hint)
                .changed()
            {
                out.push(Command::SetBlend(blend));
            }
        },
    );
}
