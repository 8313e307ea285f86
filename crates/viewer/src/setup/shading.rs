use crate::cli::{
    BackFacesArg, GroundArg, ReadingArgs, ShadingArgs, TextureProjectionArgs, WireframeArg,
};
use crate::failure::Failure;
use crate::memory;
use raycast_core::formats;
use raycast_core::quote;
use raycast_core::scene::{
    ColorRule, ColorScale, Object, Projector, Quantity, Scene, TextureProjection,
};
use raycast_core::shade::{Mode, Shading, Wireframe};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Gives every object the requested texture and colours.
///
/// # Errors
/// A texture that cannot be read, a crop outside of it.
pub fn apply_textures_and_colors(
    scene: &mut Scene,
    args: &ShadingArgs,
    reading: &ReadingArgs,
) -> Result<(), Failure> {
    if let Some(path) = &args.texture {
        let mut texture = formats::read_texture_within(path, &memory::budget(reading.limits()))?;
        if let Some(crop) = args.crop {
            texture = texture.cropped(crop).ok_or_else(|| {
                Failure::usage(format!(
                    "the crop {},{},{},{} leaves {}, which is {}x{}",
                    crop.x,
                    crop.y,
                    crop.width,
                    crop.height,
                    path.display(),
                    texture.width(),
                    texture.height()
                ))
            })?;
        }
        if let Some(wrap) = args.wrap {
            texture = texture.wrapped(wrap);
        }
        let texture = Arc::new(texture);
        let source = std::path::absolute(path).unwrap_or_else(|_| path.clone());
        for object in &mut scene.objects {
            object.texture = Some(Arc::clone(&texture));
            object.texture_source = Some(source.clone());
        }
    }
    if let Some(rule) = &args.color {
        if let ColorRule::Value(Quantity::Scalar(name)) = rule {
            check_scalar(scene, ("--color scalar:", &**name))?;
        }
        for object in &mut scene.objects {
            object.color = rule.clone();
        }
    }
    if let Some(name) = &args.blend_by {
        check_scalar(scene, ("--blend-by ", &**name))?;
        for object in &mut scene.objects {
            object.blend_by = Some(name.clone());
        }
    }
    place_textures(scene, &args.projection)
}

/// Checks that an object has the scalar that an option names.
fn check_scalar(scene: &Scene, (option, name): (&str, &str)) -> Result<(), Failure> {
    let mut meshes = scene.objects.iter().map(|object| &object.mesh);
    if meshes.any(|mesh| mesh.scalar(name).is_some()) {
        return Ok(());
    }
    let meshes = scene.objects.iter().map(|object| &object.mesh);
    let names: BTreeSet<_> = meshes
        .flat_map(|mesh| {
            mesh.scalars()
                .iter()
                .map(|scalar| quote::name(&scalar.name))
        })
        .collect();
    let names: Vec<_> = names.into_iter().collect();
    Err(Failure::usage(match names[..] {
        [] => format!("{option}{name}: the files have no scalars"),
        _ => format!(
            "{option}{name}: the files have no such scalar, but {}",
            names.join(", ")
        ),
    }))
}

/// Gives every object's texture the requested projection and projector.
///
/// # Errors
/// An invalid projector or photograph, or a missing one; one for a scene without textures.
fn place_textures(scene: &mut Scene, args: &TextureProjectionArgs) -> Result<(), Failure> {
    if let Some(option) = args.placing()
        && !scene.objects.iter().any(Object::has_texture)
    {
        return Err(Failure::usage(format!(
            "{option} places a texture, and no object has one: give --texture IMAGE"
        )));
    }
    if args.kind().is_some() {
        for object in &mut scene.objects {
            object.mapping.projection = None;
        }
    }
    if let Some(photograph) = args.photograph() {
        if let Err(error) = photograph.check() {
            return Err(Failure::usage(error.to_string()));
        }
        for object in &mut scene.objects {
            object.mapping.photograph = Some(photograph);
        }
    }
    let mut objects = scene.objects.iter();
    let is_taken = |object: &Object| !object.has_texture() || object.mapping.photograph.is_some();
    if args.kind == Some(TextureProjection::Camera) && !objects.all(is_taken) {
        let message = "--texture-projection camera needs --texture-camera EYE/TARGET";
        return Err(Failure::usage(message.to_owned()));
    }
    let directions = [args.center, args.front, args.up];
    if directions == [None; 3] && args.size.is_none() {
        return Ok(());
    }
    for object in &mut scene.objects {
        let about = || Projector::about(&object.mesh.bounds());
        let old = object.mapping.projector.unwrap_or_else(about);
        let [center, front, up] = directions;
        let projector = Projector {
            center: center.unwrap_or(old.center),
            front: front.unwrap_or(old.front),
            up: up.unwrap_or(old.up),
            size: args.size.unwrap_or(old.size),
        };
        if let Err(error) = projector.axes() {
            return Err(Failure::usage(error.to_string()));
        }
        object.mapping.projector = Some(projector);
    }
    Ok(())
}

/// The requested shading, with defaults from the scene file, else the general ones.
pub fn shading(args: &ShadingArgs, file: Option<Shading>) -> Shading {
    let base = file.unwrap_or_default();
    let mode = args.mode.unwrap_or(base.mode);
    let has_kinds = args.wireframe_edges.is_some() || args.wireframe_hidden.is_some();
    let wireframe = match args.wireframe {
        Some(WireframeArg::None) => None,
        None if !has_kinds => base.wireframe,
        width => {
            let alone = width.is_none() && mode == Mode::Wireframe;
            let usual = if alone {
                Wireframe::ALONE
            } else {
                Wireframe::default()
            };
            let lines = base.wireframe.unwrap_or(usual);
            Some(Wireframe {
                width: match width {
                    Some(WireframeArg::Width(width)) => width,
                    _ => lines.width,
                },
                color: args.wireframe_color.unwrap_or(lines.color),
                edges: args.wireframe_edges.unwrap_or(lines.edges),
                hidden: args.wireframe_hidden.unwrap_or(lines.hidden),
            })
        }
    };
    Shading {
        mode,
        wireframe,
        background: args.background.unwrap_or(base.background),
        blend: args.blend.unwrap_or(base.blend),
        filter: args.filter.unwrap_or(base.filter),
        projection: args.projection.kind().unwrap_or(base.projection),
        crease: args.crease.unwrap_or(base.crease),
        lights: args.lights.unwrap_or(base.lights),
        plain_color: args.plain_color.unwrap_or(base.plain_color),
        scale: scale(args, base.scale),
        back_faces: match args.back_faces {
            None => base.back_faces,
            Some(BackFacesArg::None) => None,
            Some(BackFacesArg::Color(color)) => Some(color),
        },
        ground: match args.ground {
            None => base.ground,
            Some(GroundArg::None) => None,
            Some(GroundArg::Some(ground)) => Some(ground),
        },
        x_ray_opacity: args.x_ray_opacity.unwrap_or(base.x_ray_opacity),
    }
}

/// The requested colour scale, with defaults from the scene file.
fn scale(args: &ShadingArgs, file: Option<ColorScale>) -> Option<ColorScale> {
    if args.color_map.is_none() && args.color_range.is_none() && !args.legend {
        return file;
    }
    let base = file.unwrap_or_default();
    Some(ColorScale {
        map: args.color_map.unwrap_or(base.map),
        range: args.color_range.or(base.range),
        legend: args.legend || base.legend,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_core::camera::Pose;
    use raycast_core::glam::DVec3;
    use raycast_core::scene::{Mesh, Shape, Texture};
    use raycast_core::shade::EdgeKinds;

    #[test]
    fn a_texture_that_is_placed_has_to_be_there() {
        let mesh = Shape::ALL[0].mesh().expect("a cube");
        let object = Object::new("cube", Arc::new(Mesh::new(mesh)));
        let mut scene = Scene {
            objects: vec![object],
        };
        let camera = TextureProjectionArgs {
            camera: Some(Pose::towards(DVec3::Z, DVec3::ZERO)),
            ..TextureProjectionArgs::default()
        };
        let center = TextureProjectionArgs {
            center: Some(DVec3::ZERO),
            ..TextureProjectionArgs::default()
        };
        for (args, option) in [(&camera, "--texture-camera"), (&center, "--texture-center")] {
            let refused = place_textures(&mut scene, args).expect_err(option);
            assert!(matches!(refused, Failure::Usage(_)), "{refused}");
            let expected =
                format!("{option} places a texture, and no object has one: give --texture IMAGE");
            assert_eq!(refused.to_string(), expected);
        }
        scene.objects[0].texture = Texture::new(1, 1, vec![[9; 4]]).map(Arc::new);
        assert!(place_textures(&mut scene, &camera).is_ok());
        assert!(scene.objects[0].mapping.photograph.is_some());
    }

    #[test]
    fn shading_options_override_one_by_one() {
        let file = Shading {
            mode: Mode::Depth,
            blend: 0.25,
            ..Shading::default()
        };
        let args = ShadingArgs {
            wireframe: Some(WireframeArg::Width(2.0)),
            blend: Some(0.5),
            ..ShadingArgs::default()
        };
        let made = shading(&args, Some(file));
        assert_eq!((made.mode, made.blend), (Mode::Depth, 0.5));
        assert_eq!(made.wireframe.map(|lines| lines.width), Some(2.0));
        // Types of edges without `--wireframe` draw lines as well: light ones where they stand alone.
        let polygon = EdgeKinds {
            polygon: true,
            ..EdgeKinds::NONE
        };
        let kinds = ShadingArgs {
            wireframe_edges: Some(polygon),
            wireframe_hidden: Some(0.5),
            ..ShadingArgs::default()
        };
        for (mode, color) in [
            (Mode::Wireframe, Wireframe::ALONE.color),
            (Mode::Flat, Wireframe::default().color),
        ] {
            let args = ShadingArgs {
                mode: Some(mode),
                ..kinds.clone()
            };
            let lines = shading(&args, None).wireframe.expect("lines");
            assert_eq!(
                (lines.edges, lines.hidden, lines.color),
                (polygon, 0.5, color)
            );
        }
        assert_eq!(shading(&ShadingArgs::default(), None), Shading::default());
        let none = ShadingArgs {
            wireframe: Some(WireframeArg::None),
            ..ShadingArgs::default()
        };
        assert_eq!(shading(&none, Some(made)).wireframe, None);
    }
}
