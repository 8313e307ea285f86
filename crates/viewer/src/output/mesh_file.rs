//! A mesh file, and the material library and images that accompany an OBJ.

use super::target::Output;
use super::unfinished::Unfinished;
use crate::failure::Failure;
use raycast_core::formats::{MaterialLibrary, MeshFormat, WriteError, Written, write_meshes};
use raycast_core::scene::{Object, Scene};
use std::fmt::Display;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// The checked path of a mesh file.
pub struct MeshFile {
    path: PathBuf,
    format: MeshFormat,
    output: Output,
    /// What the command line names: this path and the inputs.
    named: Vec<PathBuf>,
}

impl MeshFile {
    /// A mesh file at a path whose ending gives the format, text with `ascii`; none of `inputs`.
    ///
    /// # Errors
    /// An unknown ending, text of a format that has none, and those of [`Output::at`].
    pub fn at(path: &Path, ascii: bool, inputs: &[&Path]) -> Result<Self, Failure> {
        let name = path.to_string_lossy();
        let format = MeshFormat::from_name(&name, ascii).ok_or_else(|| {
            Failure::usage(format!(
                "{name}: expected a name that ends in {MESH_ENDINGS}"
            ))
        })?;
        if ascii && format == MeshFormat::Glb {
            return Err(Failure::usage(format!("{name}: a .glb is never text")));
        }
        Ok(Self {
            path: path.to_owned(),
            format,
            output: Output::at(path, inputs)?,
            named: inputs.iter().chain([&path]).map(PathBuf::from).collect(),
        })
    }

    /// Whether a file exists that would be replaced.
    pub fn is_taken(&self) -> bool {
        self.output.is_taken()
    }

    /// Writes the visible objects, and what accompanies them: none of the files that are `opened` before or meanwhile is
    /// replaced. Returns what the format cannot represent, in sentences.
    ///
    /// # Errors
    /// No visible object; those of [`Output`] and of writing.
    pub fn write(
        &self,
        scene: &Scene,
        opened: impl Fn() -> Vec<PathBuf>,
    ) -> Result<Vec<String>, Failure> {
        let before = opened();
        self.output.check_against(&before)?;
        if scene.objects.iter().all(Object::is_hidden) {
            let reason = "everything is hidden";
            return Err(self.cannot(&reason));
        }
        let library = match self.format {
            MeshFormat::Obj => Library::beside(self, scene, &before)?,
            _ => None,
        };
        let named = library.as_ref().map(Library::named);
        let (mesh, written) = self.part(&self.output, |out| {
            write_meshes(scene, self.format, named, out)
        })?;
        let beside = library.as_ref().map(|library| library.write(self));
        let beside = beside.transpose()?;
        let by_now = opened();
        let outputs = library.iter().flat_map(|library| &library.outputs);
        for output in outputs.chain([&self.output]) {
            output.check_against(&by_now)?;
        }
        for file in beside.into_iter().flatten() {
            file.finish()?;
        }
        mesh.finish()?;
        Ok(losses(&written))
    }

    /// A part file, and the result of `write`.
    fn part<T>(
        &self,
        output: &Output,
        write: impl FnOnce(&mut dyn Write) -> Result<T, WriteError>,
    ) -> Result<(Unfinished, T), Failure> {
        let mut out = BufWriter::with_capacity(1 << 20, output.create()?);
        let result = write(&mut out).map_err(|error| self.cannot(&error))?;
        let file = out
            .into_inner()
            .map_err(|error| self.cannot(&io::Error::from(error)))?;
        Ok((file, result))
    }

    fn cannot(&self, reason: &dyn Display) -> Failure {
        let name = self.path.display();
        Failure::could_not(format!("{name}: cannot be written: {reason}"))
    }
}

/// The endings of mesh files, for messages.
pub const MESH_ENDINGS: &str = ".obj, .ply, .stl, .glb or .txt";

/// The files beside an OBJ, and where they are written.
struct Library {
    name: String,
    materials: MaterialLibrary,
    /// The library's file, and those of its images.
    outputs: Vec<Output>,
}

impl Library {
    /// `None` if the scene has neither materials nor images.
    fn beside(mesh: &MeshFile, scene: &Scene, opened: &[PathBuf]) -> Result<Option<Self>, Failure> {
        let path = &mesh.path;
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let materials = MaterialLibrary::new(scene, &stem).map_err(|error| mesh.cannot(&error))?;
        if materials.is_empty() {
            return Ok(None);
        }
        let library = path.with_extension("mtl");
        let images = materials.images.iter();
        let images = images.map(|(name, _)| path.with_file_name(name));
        let named: Vec<&Path> = mesh.named.iter().map(AsRef::as_ref).collect();
        let outputs = std::iter::once(library.clone()).chain(images).map(|path| {
            let output = mesh.output.beside(&path, &named)?;
            output.check_against(opened)?;
            Ok(output)
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
    fn write(&self, mesh: &MeshFile) -> Result<Vec<Unfinished>, Failure> {
        let images = self.materials.images.iter();
        let contents = std::iter::once(self.materials.text.as_bytes())
            .chain(images.map(|(_, bytes)| bytes.as_slice()));
        let files = self.outputs.iter().zip(contents);
        let file = |(output, bytes): (&Output, &[u8])| {
            let (file, ()) = mesh.part(output, |out| Ok(out.write_all(bytes)?))?;
            Ok(file)
        };
        files.map(file).collect()
    }
}

/// What the format cannot represent, in sentences.
fn losses(written: &Written) -> Vec<String> {
    let Written {
        triangles,
        dropped,
        emptied,
        vertices,
        moved,
        largest_move,
        ref lost,
    } = *written;
    let mut losses = Vec::new();
    if dropped > 0 {
        let emptied = match emptied {
            0 => String::new(),
            count => format!(", {count} of them as a point, since their corners cannot be written"),
        };
        losses.push(format!(
            "{dropped} of {triangles} triangles can be met by no ray, and are written so that the others keep their \
             numbers{emptied}"
        ));
    }
    if moved > 0 {
        losses.push(format!(
            "{moved} of {vertices} vertices are moved, by at most {largest_move:.2e}, since the format's numbers do not \
             hold them"
        ));
    }
    if !lost.is_empty() {
        losses.push(format!("not kept: {}", lost.join(", ")));
    }
    losses
}

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_core::formats::read_scene;
    use std::cell::Cell;

    #[test]
    fn what_was_opened_while_a_mesh_was_written_is_not_replaced() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = |name| folder.path().join(name);
        let input = place("in.obj");
        std::fs::write(&input, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("written");
        let scene = read_scene(&input, &|_| ()).expect("a mesh").scene;
        let out = place("out.ply");
        std::fs::write(&out, "another's").expect("written");
        let file = MeshFile::at(&out, false, &[]).expect("an output");
        let asked = Cell::new(0);
        let opened = || {
            asked.set(asked.get() + 1);
            match asked.get() {
                1 => vec![input.clone()],
                _ => vec![input.clone(), out.clone()],
            }
        };
        let refused = file.write(&scene, opened).expect_err("opened meanwhile");
        assert!(refused.to_string().contains("out.ply"), "{refused}");
        let found = std::fs::read_to_string(&out).expect("still there");
        assert_eq!(found, "another's");
        assert_eq!(asked.get(), 2);
        let written = file.write(&scene, || vec![input.clone()]);
        assert_eq!(written, Ok(Vec::new()));
        let parts = std::fs::read_dir(folder.path()).expect("a folder").count();
        assert_eq!(parts, 2, "no part file is left");
    }
}
