//! Reading and writing scenes and meshes. The only place in the core that accesses files.

mod at_vertices;
mod disk;
mod error;
mod face_colors;
mod files;
mod gltf;
mod group_statements;
mod guard;
mod held;
mod jpeg;
mod kind;
mod length_unit;
mod limits;
mod lines;
mod mesh_file;
mod obj;
mod off;
mod parsed;
mod placed_meshes;
mod ply;
mod polygon;
mod prepared;
mod random_access;
mod ray_file;
mod scene_animation;
#[cfg(test)]
mod scene_error_tests;
mod scene_file;
mod scene_objects;
mod scene_read;
#[cfg(test)]
mod scene_read_tests;
mod scene_text;
mod scene_textures;
mod scene_toml;
mod scene_words;
mod scene_write;
#[cfg(test)]
mod scene_write_tests;
mod section_drawing;
mod stl;
mod texture;
mod threemf;
mod tokens;
mod triangle_text;
mod unpack;
mod weld;
mod write;

pub use disk::open_regular;
pub use error::{FilePosition, FormatError};
pub use guard::panic_is_caught;
pub use length_unit::LengthUnit;
pub use limits::{Budget, Limits};
pub use prepared::{PrepareError, write_prepared};
pub use ray_file::{HIT_BYTES, RAY_BYTES, decode_ray, encode_hit};
pub use scene_file::{CameraFile, FileKind, ImageSettings, SceneFile, ShadingFile};
pub use scene_write::SaveError;
pub use section_drawing::{DrawingFormat, write_section};
pub use write::{MaterialLibrary, MeshFormat, WriteError, Written, write_meshes};

use crate::scene::{Mesh, Scene, Texture};
use disk::Disk;
use files::{Files, NamedBy};
use held::Held;
use mesh_file::MeshTexture;
use random_access::RandomAccess;
use std::path::Path;
use std::sync::Arc;

/// Called with the fraction of loading that is done, 0 to 1.
pub type Progress<'a> = &'a (dyn Fn(f32) + Sync);

/// The fraction of a mesh file's progress that reading its bytes takes; parsing takes the rest.
const READING_SHARE: f32 = 0.2;

/// The bytes at the start of a file in which a scene file without its name is recognised. They must hold its first table,
/// so comments before that may be almost as long; more would only make a large mesh slower to tell from a scene file.
const SCENE_START: u64 = 1 << 16;

/// Reads a mesh file. The format is recognised by content where possible, otherwise by extension.
///
/// Warnings of [`read_scene`] (about materials that cannot be read) are dropped. The mesh of a glTF or 3MF file is in
/// its own space, without the transform of its node.
///
/// # Errors
/// A file that cannot be read, or is in no known mesh format: with file, line and what was expected; more than the
/// default [`Limits`]; more than one object.
pub fn read_mesh(path: &Path, progress: Progress<'_>) -> Result<Mesh, FormatError> {
    let budget = Budget::default();
    let disk = Disk::new(&budget);
    let read = match read_in_place(path, &disk, progress) {
        Some(read) => read?,
        None => {
            let contents = disk.read(path, NamedBy::Person, &|share| {
                progress(share * READING_SHARE)
            })?;
            let up_axis = budget.limits().up_axis;
            mesh_file::read(path, &contents, &disk, up_axis, &|share| {
                progress(READING_SHARE + share * (1.0 - READING_SHARE));
            })?
        }
    };
    let count = read.objects.len();
    let mut objects = read.objects.into_iter();
    match (objects.next(), count) {
        (Some(object), 1) => Ok(Arc::unwrap_or_clone(object.mesh)),
        _ => {
            let found = format!("{count} objects");
            Err(FormatError::unexpected(path, None, "one mesh", found))
        }
    }
}

/// Reads a mesh file of a format of which a part is needed at a time directly from the disk; `None` for any other.
fn read_in_place(
    path: &Path,
    disk: &Disk<'_>,
    progress: Progress<'_>,
) -> Option<Result<mesh_file::MeshFile, FormatError>> {
    let kind = |first: &_, length| kind::kind_in_place(path, first, length);
    let (file, kind) = disk.open_if(path, kind)?;
    let read_at = |at: u64, to: &mut [u8]| file.read_at(at, to);
    let from = RandomAccess {
        read_at: &read_at,
        length: file.length,
    };
    Some(mesh_file::read_in_place(path, kind, from, disk, progress))
}

/// Reads an image file as a texture: PNG, JPEG or PNM, recognised by its content.
///
/// # Errors
/// A file that cannot be read, is in no known image format, is damaged or ends early, has a side longer than 32768
/// texels, or needs more than the default [`Limits`].
pub fn read_texture(path: &Path) -> Result<Texture, FormatError> {
    read_texture_within(path, &Budget::default())
}

/// As [`read_texture`], within the caller's budget.
///
/// # Errors
/// As [`read_texture`]; an exhausted budget.
pub fn read_texture_within(path: &Path, budget: &Budget) -> Result<Texture, FormatError> {
    decode_texture(&Disk::new(budget), path, NamedBy::Person)
}

/// Reads a scene file (`.raycast.toml`) and every mesh and texture that it names, or a mesh file as a scene of its
/// objects. These are the mesh nodes of a glTF or 3MF file, depth first; those of a prepared file; else one object,
/// named after the file, with the texture that its materials give all of it.
///
/// # Errors
/// As [`read_mesh`]; a scene file with a syntax error, with its line.
pub fn read_scene(path: &Path, progress: Progress<'_>) -> Result<SceneFile, FormatError> {
    read_scene_within(path, &Budget::default(), progress)
}

/// As [`read_scene`], within the caller's budget, which several files may share.
///
/// # Errors
/// As [`read_scene`]; an exhausted budget.
pub fn read_scene_within(
    path: &Path,
    budget: &Budget,
    progress: Progress<'_>,
) -> Result<SceneFile, FormatError> {
    let disk = Disk::new(budget);
    let read = match read_in_place(path, &disk, progress) {
        Some(read) => read?,
        None => {
            let contents = disk.read(path, NamedBy::Person, &|share| {
                progress(share * READING_SHARE)
            })?;
            let rest = |share: f32| progress(READING_SHARE + share * (1.0 - READING_SHARE));
            if kind::is_scene(path, &contents) {
                return scene_read::read(path, &contents, &disk, &rest);
            }
            mesh_file::read(path, &contents, &disk, budget.limits().up_axis, &rest)?
        }
    };
    mesh_file::count_objects(path, &read.objects, budget)?;
    let mut warnings = read.warnings;
    let source = disk.source(path);
    let mut objects = Vec::with_capacity(read.objects.len());
    for found in read.objects {
        let mut object = found.placed(Some(source.clone()));
        match found.texture {
            None => {}
            Some(MeshTexture::Held(texture, source)) => {
                object.texture = Some(texture);
                object.texture_source = source;
            }
            Some(MeshTexture::Named(image)) => {
                match decode_texture(&disk, &image, NamedBy::Mesh(path)) {
                    Ok(texture) => {
                        object.texture = Some(Arc::new(texture));
                        object.texture_source = Some(disk.source(&image));
                    }
                    Err(error) => warnings.push(error.to_string()),
                }
            }
        }
        objects.push(object);
    }
    Ok(SceneFile {
        kind: read.kind,
        scene: Scene { objects },
        warnings,
        notes: read.notes,
        unit: read.unit,
        opened: disk.opened(),
        ..SceneFile::default()
    })
}

/// Reads what a scene file says beside its objects, and checks that the meshes and textures are there that it names. Of a
/// mesh file nothing is read but its start, and the result is empty. `opened` lists the files as [`read_scene`] does, but
/// for those that only meshes name.
///
/// # Errors
/// A file, or one that the scene file names, that is not there, cannot be opened, or is not regular; as [`read_scene`] of
/// everything in a scene file but its objects.
pub fn read_scene_settings(path: &Path, budget: &Budget) -> Result<SceneFile, FormatError> {
    let disk = Disk::new(budget);
    if !kind::is_scene(path, &disk.start(path, SCENE_START)?) {
        return Ok(SceneFile {
            opened: disk.opened(),
            ..SceneFile::default()
        });
    }
    let contents = disk.read(path, NamedBy::Scene, &|_| ())?;
    scene_read::read_settings(path, &contents, &disk)
}

/// Reads a scene from text. The files that it names come from the caller: `resolve` returns the bytes of a file for
/// its path relative to the scene, with `/` as the separator. No disk is accessed.
///
/// Error messages call the text `scene`. The objects' sources are the relative paths.
///
/// # Errors
/// As [`read_scene`]; a file for which `resolve` has no bytes.
pub fn read_scene_from(
    toml_text: &str,
    resolve: &dyn Fn(&str) -> Option<Vec<u8>>,
) -> Result<SceneFile, FormatError> {
    scene_read::read(
        Path::new("scene"),
        toml_text.as_bytes(),
        &Held::new(resolve, &Budget::default()),
        &|_| (),
    )
}

fn decode_texture(disk: &Disk<'_>, path: &Path, by: NamedBy<'_>) -> Result<Texture, FormatError> {
    let contents = disk.read(path, by, &|_| ())?;
    texture::decode(path, &contents, disk.budget())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;
    use std::sync::Mutex;

    /// A temporary folder that is removed after the test.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let folder =
                std::env::temp_dir().join(format!("raycast-formats-{}-{name}", std::process::id()));
            std::fs::create_dir_all(folder.join("deep")).expect("a folder can be made");
            Self(folder)
        }

        fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
            let path = self.0.join(name);
            std::fs::write(&path, bytes).expect("a file can be written");
            path
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            // A folder that cannot be removed does not change the result.
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn a_checkerboard_stands_in_for_a_missing_image_of_a_scene() {
        let folder = Folder::new("stand-in");
        folder.write("a.txt", b"(0,0,0);(1,0,0);(0,1,0)");
        let text = "[[object]]\nname = \"a\"\nmesh = \"a.txt\"\ntexture = \"deep/t.ppm\"\n\
                    crop = [1, 0, 2, 1]\nwrap = [\"mirror\", \"repeat\"]\n";
        let scene = folder.write("a.raycast.toml", text.as_bytes());
        let read = |stand_ins: bool| {
            let limits = Limits {
                stand_ins,
                ..Limits::default()
            };
            read_scene_within(&scene, &Budget::new(limits), &|_| ())
        };
        let refused = read(false).expect_err("no image").to_string();
        let mut file = read(true).expect("a stand-in");
        let warning = std::mem::take(&mut file.warnings).join(" ");
        assert!(refused.contains("a.raycast.toml:4: ") && refused.contains("t.ppm"));
        assert_eq!(
            warning,
            format!("{refused}; a checkerboard stands in for it")
        );
        // What is known of the image is written again.
        let written = file.to_toml(&folder.0).expect("a name");
        let has = |line: &str| written.lines().any(|written| written == line);
        assert!(
            has("texture = \"deep/t.ppm\"") && has("crop = [1, 0, 2, 1]"),
            "{written}"
        );
        assert!(has("wrap = [\"mirror\", \"repeat\"]"), "{written}");
        let texture = file.scene.objects[0].texture.as_ref().expect("a stand-in");
        assert!(texture.is_stand_in());
        // One that cannot be decoded, and one that can.
        folder.write("deep/t.ppm", b"P3\n3 1\n255\n1 2 3");
        assert_eq!(read(true).expect("a stand-in").warnings.len(), 1);
        folder.write("deep/t.ppm", b"P3\n3 1\n255\n1 2 3 4 5 6 7 8 9\n");
        let file = read(true).expect("an image");
        let texture = file.scene.objects[0].texture.as_ref().expect("a texture");
        assert!(!texture.is_stand_in() && file.warnings.is_empty());
        assert_eq!(texture.texels(), [[4, 5, 6, 255], [7, 8, 9, 255]]);
    }

    #[test]
    fn a_mesh_file_is_a_scene_of_one_object() {
        let folder = Folder::new("mesh");
        folder.write("a.mtl", b"newmtl x\nmap_Kd deep\\t.ppm\n");
        let image = folder.write("deep/t.ppm", b"P3\n1 1\n255\n1 2 3\n");
        let mesh = folder.write(
            "my cube.obj",
            b"mtllib a.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
        );
        let shares = Mutex::new(Vec::new());
        let note = |share| shares.lock().expect("no one panicked").push(share);
        let file = read_scene(&mesh, &note).expect("a good mesh");
        let object = &file.scene.objects[0];
        assert_eq!(object.name, "my cube");
        assert_eq!(object.source.as_ref(), Some(&mesh));
        assert_eq!(object.texture_source.as_ref(), Some(&image));
        assert!(object.texture.is_some());
        let shares = shares.into_inner().expect("no one panicked");
        assert!(shares.is_sorted(), "{shares:?}");
        assert!(shares.iter().all(|share| (0.0..=1.0).contains(share)));
        assert_eq!(shares.last(), Some(&1.0));

        // A scene saved in another folder still finds its files.
        let text = file
            .to_toml(&folder.0.join("deep"))
            .expect("it can be saved");
        assert!(text.contains("mesh = \"../my cube.obj\""), "{text}");
        let scene = folder.write("deep/saved.raycast.toml", text.as_bytes());
        let again = read_scene(&scene, &|_| ()).expect("a good scene");
        assert_eq!(again.scene.objects[0].texture, object.texture);

        assert_eq!(again.opened.first(), Some(&scene));
        let library = folder.0.join("a.mtl");
        for opened in [&mesh, &library, &image] {
            assert!(file.opened.contains(opened), "{:?}", file.opened);
        }
        std::fs::write(&image, b"no image").expect("a file can be written");
        let unreadable = read_scene(&mesh, &|_| ()).expect("a mesh with a bad image");
        assert!(unreadable.scene.objects[0].texture.is_none());
        assert_eq!(unreadable.opened, file.opened);

        std::fs::remove_file(&image).expect("it was there");
        let file = read_scene(&mesh, &|_| ()).expect("a mesh without its image");
        assert!(file.scene.objects[0].texture.is_none());
        assert_eq!(file.warnings.len(), 1, "{:?}", file.warnings);
    }

    #[test]
    fn settings_are_those_of_the_whole_scene_and_its_files_are_there() {
        let folder = Folder::new("settings");
        let budget = Budget::default();
        let mesh = folder.write("a.obj", b"no mesh at all");
        let text = "[camera]\neye = [0, 0, 4]\ntarget = [0, 0, 0]\n[image]\nsize = [64, 48]\n\
                    [[animation.key]]\nat = 7\neye = [0, 0, 4]\ntarget = [0, 0, 0]\n\
                    [[object]]\nmesh = \"a.obj\"\n[[object]]\nshape = { kind = \"cube\", size = [1, 1, 1] }\n";
        let scene = folder.write("a.raycast.toml", text.as_bytes());
        let settings = read_scene_settings(&scene, &budget).expect("no mesh is read");
        assert_eq!(settings.opened, [scene.clone(), mesh.clone()]);
        assert!(settings.scene.objects.is_empty());
        folder.write("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        let whole = read_scene(&scene, &|_| ()).expect("a scene");
        assert_eq!(
            (settings.camera, settings.image, settings.animation),
            (whole.camera, whole.image, whole.animation)
        );
        let nothing = read_scene_settings(&mesh, &budget).expect("a mesh");
        assert_eq!((nothing.camera, nothing.opened), (None, vec![mesh.clone()]));
        std::fs::remove_file(&mesh).expect("it was there");
        let missing = read_scene_settings(&scene, &budget).expect_err("no mesh");
        let message = read_scene(&scene, &|_| ())
            .expect_err("no mesh")
            .to_string();
        assert_eq!(missing.to_string(), message);
    }

    #[test]
    fn files_that_cannot_be_read_are_named_in_the_error() {
        let folder = Folder::new("faults");
        let check = |path: &Path| {
            let errors = [
                read_scene(path, &|_| ()).expect_err("no scene").to_string(),
                read_mesh(path, &|_| ()).expect_err("no mesh").to_string(),
                read_texture(path).expect_err("no image").to_string(),
            ];
            for message in errors {
                assert!(
                    message.starts_with(&path.display().to_string()),
                    "{message}"
                );
                assert_eq!(message.lines().count(), 1, "{message}");
            }
        };
        check(&folder.0.join("not there.obj"));
        check(&folder.0);
        check(&folder.write("empty.obj", b""));
        check(&folder.write("bad.raycast.toml", b"[camera\n"));
        check(&folder.write("latin.raycast.toml", b"# caf\xe9\n"));
    }
}
