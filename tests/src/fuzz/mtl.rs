//! Material libraries, through the OBJ file that names one.

use super::mesh::{are_equal, only_mesh};
use super::reading::{MESH, Reading, read, with_windows_lines};
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
    Ok(())
}

fn read_with(library: &[u8]) -> Result<Reading, String> {
    let files = |name: &str| match name {
        "mesh.obj" => Some(MESH.into()),
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
        ..
    } = material;
    let reflectance = reflectance.as_ref().map_or_else(String::new, |known| {
        let [r, g, b] = known.emission;
        let (metallic, roughness) = (known.metallic, known.roughness);
        format!("Pm {metallic:?}\nPr {roughness:?}\nKe {r:?} {g:?} {b:?}\n")
    });
    let [r, g, b] = levels.map(|level| f64::from(level) / 255.0);
    format!("newmtl {name}\nKd {r:?} {g:?} {b:?}\n{reflectance}")
}
