//! Files for a soak: good, broken and large, each unlike the last of its kind.

use crate::fuzz::mesh::{as_obj, as_triangle_text};
use crate::fuzz::reading::IMAGE;
use raycast_core::glam::DVec3;
use raycast_oracle::random::Random;
use raycast_report::meshes;
use raycast_report::scenes::Made;
use std::fmt::Write;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Triangles of a large file.
const LARGE: u32 = 200_000;

/// A kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// An OBJ of some thousand triangles.
    Obj,
    /// The same as triangle text.
    TriangleText,
    /// A scene of three objects, one with an image.
    Scene,
    /// An OBJ in which half of the triangles are none.
    Degenerate,
    /// An OBJ of 200,000 triangles.
    Large,
    /// An OBJ whose last line names a vertex that is not there.
    BadIndex,
    /// An OBJ that ends within a number.
    Cut,
    /// Bytes of all kinds.
    Noise,
    /// A scene that names a file that is not there.
    Dangling,
    /// No file at all.
    Missing,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Obj,
        Self::BadIndex,
        Self::TriangleText,
        Self::Cut,
        Self::Scene,
        Self::Noise,
        Self::Degenerate,
        Self::Dangling,
        Self::Large,
        Self::Missing,
    ];

    /// Whether a program should show it.
    pub fn is_good(self) -> bool {
        matches!(
            self,
            Self::Obj | Self::TriangleText | Self::Scene | Self::Degenerate | Self::Large
        )
    }
}

/// A folder of files for a soak.
#[derive(Debug)]
pub struct SoakFiles {
    folder: PathBuf,
    /// Making a large file takes longer than opening one: it is made once, and linked to.
    large: PathBuf,
}

impl SoakFiles {
    /// Puts what files share into an empty folder.
    ///
    /// # Errors
    /// The system's refusal.
    pub fn new(folder: &Path) -> io::Result<Self> {
        let large = folder.join("large");
        let scene = Made::Ball(LARGE).scene();
        let text: String = scene.objects.iter().map(|o| as_obj(&o.mesh)).collect();
        fs::write(&large, text)?;
        fs::write(folder.join("image.ppm"), IMAGE)?;
        let part = meshes::sphere(DVec3::ZERO, 1.0, 24);
        fs::write(folder.join("part.obj"), as_obj(&part))?;
        Ok(Self {
            folder: folder.to_owned(),
            large,
        })
    }

    /// Makes a file; its name, which no other has. `number` decides what is in it.
    ///
    /// # Errors
    /// The system's refusal.
    pub fn make(&self, kind: Kind, number: u32) -> io::Result<String> {
        let steps = 8 + number % 40;
        let radius = 1.0 + f64::from(number % 7);
        let sphere = || meshes::sphere(DVec3::new(radius, 0.0, 0.0), radius, steps);
        let extension = match kind {
            Kind::Scene | Kind::Dangling => "raycast.toml",
            Kind::TriangleText => "txt",
            _ => "obj",
        };
        let name = format!("f{number}.{extension}");
        let path = self.folder.join(&name);
        match kind {
            Kind::Missing => {}
            Kind::Large => fs::hard_link(&self.large, &path)?,
            Kind::Obj => fs::write(&path, as_obj(&sphere()))?,
            Kind::TriangleText => fs::write(&path, as_triangle_text(&sphere()))?,
            Kind::Scene => fs::write(&path, scene(number, "part.obj"))?,
            Kind::Dangling => fs::write(&path, scene(number, "not-there.obj"))?,
            Kind::Degenerate => {
                let mut text = as_obj(&sphere());
                for vertex in 0..steps {
                    let _ = writeln!(text, "v nan {vertex} 0\nf -1 1 2\nf 1 1 {}", vertex + 1);
                }
                fs::write(&path, text)?;
            }
            Kind::BadIndex => fs::write(&path, as_obj(&sphere()) + "f 1 2 99999999\n")?,
            Kind::Cut => fs::write(&path, as_obj(&sphere()) + "v 1 2 3\nf 1 2/")?,
            Kind::Noise => {
                let mut random = Random::new(number.into());
                let bytes: Vec<u8> = (0..10_000).map(|_| random.below(256) as u8).collect();
                fs::write(&path, [&[0], &bytes[..]].concat())?;
            }
        }
        Ok(name)
    }

    /// Removes a file that [`SoakFiles::make`] made.
    pub fn remove(&self, name: &str) {
        // One that was never there need not be removed.
        let _ = fs::remove_file(self.folder.join(name));
    }
}

fn scene(number: u32, mesh: &str) -> String {
    let mut text = format!(
        "[camera]\neye = [{}, 2, 5]\ntarget = [0, 0, 0]\n\n[shading]\nmode = \"smooth\"\n\n",
        number % 5
    );
    for object in 0..3 {
        let _ = write!(
            text,
            "[[object]]\nname = \"{object}\"\nmesh = \"{mesh}\"\ntranslate = [{object}, 0, 0]\n"
        );
        if object == 1 {
            text.push_str("texture = \"image.ppm\"\n");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_core::formats::read_scene;

    #[test]
    fn good_files_are_read_and_bad_ones_refused() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let files = SoakFiles::new(folder.path()).expect("files can be written");
        for (kind, number) in Kind::ALL.into_iter().zip(0..) {
            let name = files.make(kind, number).expect("a file can be written");
            let read = read_scene(&folder.path().join(&name), &|_| ());
            assert_eq!(read.is_ok(), kind.is_good(), "{kind:?}: {:?}", read.err());
            files.remove(&name);
            assert!(!folder.path().join(&name).exists());
        }
    }
}
