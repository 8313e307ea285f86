//! Material libraries, through the OBJ file that names one.

use super::mesh::{are_equal, only_mesh};
use super::reading::{MESH, Reading, read, with_windows_lines};
use raycast_core::formats::{MaterialLibrary, MeshFormat, SceneFile, write_meshes};
use raycast_core::scene::{Color, Material};

/// What must hold of a material library.
///
/// # Errors
/// What does not.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    let reading = read_with(bytes)?;
    if let Some(windows) = with_windows_lines(bytes) {
        are_equal(&reading, &read_with(&windows)?)
            .map_err(|difference| format!("with Windows' lines {difference}"))?;
    }
    // A library is no reason to refuse a mesh.
    let file = reading?;
    let materials = only_mesh(&file).materials();
    let text: String = materials.iter().map(as_text).collect();
    let again = read_with(text.as_bytes())??;
    let again = only_mesh(&again);
    if again.materials() != materials {
        let after = again.materials();
        return Err(format!("{materials:?} are read again as {after:?}"));
    }
    for number in [0, 1] {
        let before = only_mesh(&file).material(number);
        let after = again.material(number);
        if before != after {
            return Err(format!("triangle {number} has {before:?}, then {after:?}"));
        }
    }
    converts(&file)
}

/// Whether materials that the program writes are read again with the same looks.
fn converts(file: &SceneFile) -> Result<(), String> {
    let scene = &file.scene;
    let library = MaterialLibrary::new(scene, "image").map_err(|error| error.to_string())?;
    let mut mesh = Vec::new();
    write_meshes(scene, MeshFormat::Obj, Some(("a.mtl", &library)), &mut mesh)
        .map_err(|error| error.to_string())?;
    let again = read_mesh_with(&mesh, library.text.as_bytes())??;
    for number in [0, 1] {
        let look = |file: &SceneFile| {
            let material = only_mesh(file).material(number).cloned();
            material.map(|material| (material.color, material.opacity, material.reflectance))
        };
        let (before, after) = (look(file), look(&again));
        // Triangles without a material are written as those of one.
        if before.is_some() && before != after {
            return Err(format!(
                "triangle {number} is written as {after:?}, and was {before:?}"
            ));
        }
    }
    Ok(())
}

fn read_with(library: &[u8]) -> Result<Reading, String> {
    read_mesh_with(MESH.as_bytes(), library)
}

fn read_mesh_with(mesh: &[u8], library: &[u8]) -> Result<Reading, String> {
    let files = |name: &str| match name {
        "mesh.obj" => Some(mesh.to_vec()),
        "a.mtl" => Some(library.to_vec()),
        _ => None,
    };
    read("[[object]]\nmesh = \"mesh.obj\"\n", &files)
}

fn as_text(material: &Material) -> String {
    let Material {
        name,
        color: Color(levels),
        reflectance,
        opacity,
        ..
    } = material;
    let opacity = opacity
        .alpha()
        .map_or_else(String::new, |alpha| format!("d {:?}\n", alpha.factor));
    let reflectance = reflectance.as_ref().map_or_else(String::new, |known| {
        let [r, g, b] = known.emission;
        let (metallic, roughness) = (known.metallic, known.roughness);
        format!("Pm {metallic:?}\nPr {roughness:?}\nKe {r:?} {g:?} {b:?}\n")
    });
    let [r, g, b] = levels.map(|level| f64::from(level) / 255.0);
    format!("newmtl {name}\nKd {r:?} {g:?} {b:?}\n{opacity}{reflectance}")
}
