//! A small picture of each mode, rendered by the core when the window opens.

use super::modes::MODES;
use egui::{ColorImage, Context, TextureHandle, TextureOptions};
use raycast_core::Accel;
use raycast_core::camera::{Camera, Grid};
use raycast_core::render::{Cancel, Settings, View};
use raycast_core::scene::{
    Bounds, Color, Material, Mesh, Object, Reflectance, Scene, Shape, Texture,
};
use raycast_core::shade::{Background, Mode, Shading, Wireframe};
use std::sync::Arc;
use std::time::Duration;

/// Pixels along a side: enough for buttons of 22 points at twice the scale.
const SIDE: u32 = 44;

type Pictures = Arc<[TextureHandle]>;

/// Renders the pictures and stores them in the context. A mode whose picture cannot be rendered has none.
pub fn install(context: &Context) {
    let Some(pictures) = all(context) else {
        return;
    };
    context.data_mut(|data| data.insert_temp(egui::Id::unique("mode pictures"), pictures));
}

/// The picture of a mode.
pub fn of(context: &Context, mode: Mode) -> Option<TextureHandle> {
    let at = MODES.iter().position(|(other, ..)| *other == mode)?;
    let id = egui::Id::unique("mode pictures");
    context.data(|data| data.get_temp::<Pictures>(id)?.get(at).cloned())
}

fn all(context: &Context) -> Option<Pictures> {
    let plain = ring(None, None)?;
    let textured = ring(Some(checkers()?), None)?;
    let metal = ring(None, Some(brass()))?;
    let pictures = MODES.iter().map(|&(mode, name, _)| {
        let scene = match mode {
            Mode::Texture => &textured,
            Mode::Material => &metal,
            _ => &plain,
        };
        let image = picture(scene, mode)?;
        Some(context.load_texture(name, image, TextureOptions::LINEAR))
    });
    pictures.collect::<Option<Vec<_>>>().map(Into::into)
}

/// A ring of so few triangles that they can be distinguished.
fn ring(
    texture: Option<Arc<Texture>>,
    material: Option<Material>,
) -> Option<(Arc<Scene>, Arc<Accel>)> {
    let shape = Shape::Torus {
        radius: 1.0,
        tube: 0.62,
        segments: 12,
        rings: 7,
    };
    let mut mesh = shape.mesh().ok()?;
    if let Some(material) = material {
        mesh.materials = vec![material];
        mesh.material_of_triangle = vec![0; mesh.triangles.len()];
    }
    let mut object = Object::new("ring", Arc::new(Mesh::new(mesh)));
    object.texture = texture;
    let scene = Scene {
        objects: vec![object],
    };
    let accel = Accel::build(&scene).ok()?;
    Some((Arc::new(scene), Arc::new(accel)))
}

fn brass() -> Material {
    let metal = Reflectance {
        metallic: 1.0,
        roughness: 0.3,
        ..Reflectance::default()
    };
    Material {
        reflectance: Some(Arc::new(metal)),
        ..Material::new("brass", Color([0xe3, 0xb8, 0x5a]))
    }
}

fn checkers() -> Option<Arc<Texture>> {
    const COLUMNS: u32 = 8;
    const ROWS: u32 = 4;
    let texel = |at: u32| {
        let is_light = (at % COLUMNS + at / COLUMNS).is_multiple_of(2);
        if is_light {
            [0xe6, 0xc8, 0x8c, 255]
        } else {
            [0x5a, 0x3a, 0x22, 255]
        }
    };
    Texture::new(COLUMNS, ROWS, (0..COLUMNS * ROWS).map(texel).collect()).map(Arc::new)
}

fn picture((scene, accel): &(Arc<Scene>, Arc<Accel>), mode: Mode) -> Option<ColorImage> {
    let lines = Wireframe {
        width: 2.5,
        color: Color([0x8f, 0xa8, 0xc8]),
        ..Wireframe::ALONE
    };
    let settings = Settings {
        shading: Shading {
            mode,
            background: Background::Transparent,
            wireframe: (mode == Mode::Wireframe).then_some(lines),
            ..Shading::studio()
        },
        samples: 4,
        ..Settings::default()
    };
    // The ring does not reach the corners of its box.
    let Bounds { min, max } = scene.bounds();
    let bounds = Bounds {
        min: min * 0.72,
        max: max * 0.72,
    };
    let camera = Camera::fitting(&bounds, (20.0, 50.0), (SIDE, SIDE)).ok()?;
    let view = View {
        scene: Arc::clone(scene),
        accel: Arc::clone(accel),
        camera,
        settings,
    };
    let clock = || Duration::ZERO;
    let picture = view.render(Grid::default(), &clock, &Cancel::default(), &|_| ())?;
    let side = SIDE as usize;
    let bytes = picture.pixels.as_flattened();
    Some(ColorImage::from_rgba_unmultiplied([side, side], bytes))
}
