use super::{Failure, warn};
use crate::cli::ConvertArgs;
use crate::output::{Output, Unfinished};
use crate::progress::TerminalProgress;
use crate::setup;
use raycast_core::formats::{self, MaterialLibrary, MeshFormat, SceneFile, WriteError, Written};
use raycast_core::scene::Scene;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

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

    let progress = TerminalProgress::new();
    progress.loading();
    let SceneFile {
        scene,
        warnings,
        opened,
        ..
    } = setup::load(&args.files, &args.reading, &|share| progress.loaded(share))?;
    output.check_against(&opened)?;
    // An OBJ's materials are in a file of their own beside it, and so are their images.
    let library = match format {
        MeshFormat::Obj => Library::beside(&args.output, &output, &scene, (&inputs, &opened))?,
        _ => None,
    };
    progress.clear();
    for warning in &warnings {
        warn(warning);
    }
    let named = library.as_ref().map(Library::named);
    let (mesh_file, written) = write(&args.output, &output, |out| {
        formats::write_meshes(&scene, format, named, out)
    })?;
    let beside = library.map(|library| library.write()).transpose()?;
    for file in beside.into_iter().flatten() {
        file.finish()?;
    }
    mesh_file.finish()?;
    report_losses(&name, &written);
    Ok(())
}

/// The files beside an OBJ, and where they are written.
struct Library {
    name: String,
    materials: MaterialLibrary,
    /// The library's file, and those of its images.
    outputs: Vec<(PathBuf, Output)>,
}

impl Library {
    /// `None` where the scene has neither materials nor images. `read` are the files of the command line and all that
    /// were opened: none of them is replaced.
    fn beside(
        mesh: &Path,
        output: &Output,
        scene: &Scene,
        (inputs, opened): (&[&Path], &[PathBuf]),
    ) -> Result<Option<Self>, Failure> {
        let stem = mesh.file_stem().unwrap_or_default().to_string_lossy();
        let materials = MaterialLibrary::new(scene, &stem).map_err(|error| {
            Failure::could_not(format!("{}: cannot be written: {error}", mesh.display()))
        })?;
        if materials.is_empty() {
            return Ok(None);
        }
        let library = mesh.with_extension("mtl");
        let images = materials.images.iter();
        let images = images.map(|(name, _)| mesh.with_file_name(name));
        let outputs = std::iter::once(library.clone()).chain(images).map(|path| {
            let place = output.beside(&path, inputs)?;
            place.check_against(opened)?;
            Ok((path, place))
        });
        let outputs = outputs.collect::<Result<_, Failure>>()?;
        let name = library.file_name().unwrap_or_default();
        Ok(Some(Self {
            name: name.to_string_lossy().into_owned(),
            materials,
            outputs,
        }))
    }

    /// The library with the name by which the mesh refers to it.
    fn named(&self) -> (&str, &MaterialLibrary) {
        (&self.name, &self.materials)
    }

    /// The part files.
    fn write(&self) -> Result<Vec<Unfinished>, Failure> {
        let images = self.materials.images.iter();
        let contents = std::iter::once(self.materials.text.as_bytes())
            .chain(images.map(|(_, bytes)| bytes.as_slice()));
        let files = self.outputs.iter().zip(contents);
        let file = |((path, place), bytes): (&(PathBuf, Output), &[u8])| {
            let (file, ()) = write(path, place, |out| Ok(out.write_all(bytes)?))?;
            Ok(file)
        };
        files.map(file).collect()
    }
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
