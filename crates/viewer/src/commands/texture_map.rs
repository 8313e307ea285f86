use super::{Failure, warn};
use crate::cli::TextureMapArgs;
use crate::output::Output;
use crate::progress::TerminalProgress;
use crate::{memory, setup};
use raycast_core::formats;
use raycast_core::glam::DAffine3;
use raycast_core::picture::{Format, Picture};
use raycast_core::scene::{Color, Object};
use raycast_core::shade::{TextureMap, texture_corners};
use std::path::Path;

/// The colour of triangles' edges.
const EDGES: Color = Color([0x00, 0xd8, 0xff]);

/// The colour of the selected triangle, and its opacity.
const SELECTED: (Color, f32) = (Color([0xff, 0x30, 0x60]), 0.45);

/// The colour of the crop's border.
const CROP: Color = Color([0xff, 0x30, 0x60]);

/// Draws a mesh's triangles into its texture.
pub(super) fn run(args: &TextureMapArgs) -> Result<(), Failure> {
    let format = Format::from_name(&args.output.to_string_lossy())?;
    if format == Format::Exr {
        return Err(Failure::usage(format!(
            "{}: expected a name that ends in .png, .ppm, .tif or .jpg",
            args.output.display()
        )));
    }
    let mut inputs: Vec<&Path> = args.files.iter().map(AsRef::as_ref).collect();
    inputs.push(&args.texture);
    let output = Output::at(&args.output, &inputs)?;

    let mut texture =
        formats::read_texture_within(&args.texture, &memory::budget(args.reading.limits()))?;
    if let Some(wrap) = args.wrap {
        texture = texture.wrapped(wrap);
    }
    let size = (texture.width(), texture.height());
    let memory_for = |columns, rows| format.memory_for(columns, rows);
    memory::check_picture(&args.output, size, memory_for, "")?;
    let mut map = TextureMap::new(&texture, args.crop).ok_or_else(|| {
        Failure::usage(format!(
            "the crop leaves {}, which is {}x{}",
            args.texture.display(),
            texture.width(),
            texture.height()
        ))
    })?;
    if !args.files.is_empty() {
        draw_files(args, &output, &mut map)?;
    }
    if args.crop.is_some() {
        map.draw_crop(CROP, 2.0 * f64::from(args.line_width));
    }
    let picture = Picture {
        width: map.width(),
        height: map.height(),
        pixels: map.into_pixels(),
        layers: None,
    };
    output.write(&picture.encode(format)?)?.finish()
}

/// Draws the requested triangles.
fn draw_files(args: &TextureMapArgs, output: &Output, map: &mut TextureMap) -> Result<(), Failure> {
    let progress = TerminalProgress::new();
    progress.loading();
    let mut file = setup::load(&args.files, &args.reading, &|share| progress.loaded(share))?;
    output.check_against(&file.opened)?;
    let shading = args.shading();
    setup::apply_textures_and_colors(&mut file.scene, &shading, &args.reading)?;
    let projection = setup::shading(&shading, file.shading).projection;
    progress.clear();
    for warning in &file.warnings {
        warn(warning);
    }

    let objects = &file.scene.objects;
    let placed = file
        .scene
        .world_from_objects()
        .map_err(|error| Failure::could_not(error.to_string()))?;
    let one = args.object.or(args.triangle.map(|_| 0));
    let mut placed = objects.iter().zip(&placed);
    let chosen: Vec<(&Object, &DAffine3)> = match one {
        None => placed.collect(),
        Some(number) => {
            let object = placed.nth(number as usize).ok_or_else(|| {
                let count = objects.len();
                Failure::usage(format!(
                    "there is no object {number}: there are {count}, from 0"
                ))
            })?;
            vec![object]
        }
    };
    let width = f64::from(args.line_width);
    let corners = |(object, world_from_object): (&Object, &DAffine3), number| {
        texture_corners(object, number, projection, world_from_object)
    };
    if let (Some(number), [object]) = (args.triangle, &chosen[..]) {
        let count = object.0.mesh.triangles().len();
        if number as usize >= count {
            return Err(Failure::usage(format!(
                "there is no triangle {number}: there are {count}, from 0"
            )));
        }
        let corners = corners(*object, number).ok_or_else(|| {
            Failure::could_not(format!("triangle {number} has no place in the texture"))
        })?;
        let (color, opacity) = SELECTED;
        map.fill_triangle(corners, color, opacity);
        map.draw_triangle(corners, color, width);
        return Ok(());
    }
    let mut unplaced = 0;
    for object in chosen {
        for &number in object.0.mesh.kept() {
            match corners(object, number) {
                Some(corners) => map.draw_triangle(corners, EDGES, width),
                None => unplaced += 1,
            }
        }
    }
    if unplaced > 0 {
        warn(&format!(
            "{unplaced} triangles have no place in the texture"
        ));
    }
    Ok(())
}
