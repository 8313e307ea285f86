use super::{Failure, warn};
use crate::cli::ConvertArgs;
use crate::output::{Output, Unfinished};
use crate::progress::TerminalProgress;
use crate::setup;
use raycast_core::formats::{self, MeshFormat, SceneFile, WriteError, Written};
use raycast_core::scene::Scene;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Writes the meshes of files in another format.
pub(super) fn run(args: &ConvertArgs) -> Result<(), Failure> {
    let name = args.output.to_string_lossy();
    let format = MeshFormat::from_name(&name, args.ascii).ok_or_else(|| {
        Failure::usage(format!(
            "{name}: expected a name that ends in .obj, .ply, .stl, .glb or .txt"
        ))
    })?;
    if args.ascii && format == MeshFormat::Glb {
        return Err(Failure::usage(format!("{name}: a .glb is never text")));
    }
    let mut inputs: Vec<&Path> = args.files.iter().map(AsRef::as_ref).collect();
    let output = Output::at(&args.output, &inputs)?;
    inputs.push(&args.output);
    // An OBJ's materials are in a file of their own beside it.
    let library = (format == MeshFormat::Obj).then(|| args.output.with_extension("mtl"));

    let progress = TerminalProgress::new();
    progress.loading();
    let SceneFile {
        scene,
        warnings,
        opened,
        ..
    } = setup::load(&args.files, &args.reading, &|share| progress.loaded(share))?;
    output.check_against(&opened)?;
    let library = match &library {
        Some(path) if has_materials(&scene) => {
            let place = output.beside(path, &inputs)?;
            place.check_against(&opened)?;
            Some((path, place))
        }
        _ => None,
    };
    progress.clear();
    for warning in &warnings {
        warn(warning);
    }
    let library_name = library.as_ref().and_then(|(path, _)| path.file_name());
    let library_name = library_name.map(|name| name.to_string_lossy());

    let (mesh_file, written) = write(&args.output, &output, |out| {
        formats::write_meshes(&scene, format, library_name.as_deref(), out)
    })?;
    if let Some((path, place)) = &library {
        let (file, _) = write(path, place, |out| {
            Ok(formats::write_materials(&scene, out)?)
        })?;
        file.finish()?;
    }
    mesh_file.finish()?;
    report_losses(&name, &written);
    Ok(())
}

fn has_materials(scene: &Scene) -> bool {
    scene
        .objects
        .iter()
        .any(|object| !object.mesh.materials().is_empty())
}

/// A part file, and the result of `write`.
fn write<T>(
    name: &Path,
    output: &Output,
    write: impl FnOnce(&mut dyn Write) -> Result<T, WriteError>,
) -> Result<(Unfinished, T), Failure> {
    let cannot = |error: &dyn std::fmt::Display| {
        Failure::could_not(format!("{}: cannot be written: {error}", name.display()))
    };
    let mut out = BufWriter::with_capacity(1 << 20, output.create()?);
    let result = write(&mut out).map_err(|error| cannot(&error))?;
    let file = out
        .into_inner()
        .map_err(|error| cannot(&io::Error::from(error)))?;
    Ok((file, result))
}

/// Reports on standard error what the format cannot represent.
fn report_losses(name: &str, written: &Written) {
    let Written {
        triangles,
        dropped,
        emptied,
        vertices,
        moved,
        largest_move,
        ref lost,
    } = *written;
    if dropped > 0 {
        let emptied = match emptied {
            0 => String::new(),
            count => format!(", {count} of them as a point, since their corners cannot be written"),
        };
        warn(&format!(
            "{name}: {dropped} of {triangles} triangles can be met by no ray, and are written so that \
             the others keep their numbers{emptied}"
        ));
    }
    if moved > 0 {
        warn(&format!(
            "{name}: {moved} of {vertices} vertices are moved, by at most {largest_move:e}, since the \
             format's numbers do not hold them"
        ));
    }
    if !lost.is_empty() {
        warn(&format!("{name}: not kept: {}", lost.join(", ")));
    }
}
