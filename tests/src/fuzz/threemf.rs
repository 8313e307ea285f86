//! 3MF files: archives, and model parts in an archive of their own, since a change to an archive's bytes
//! hardly ever leaves its checksums right.

use super::placed::is_placed_soundly;
use super::reading::{Reading, read};
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// The name under which the bytes are read.
const NAME: &str = "mesh.3mf";

/// The part that names the model.
pub const RELATIONSHIPS: &str = "<Relationships><Relationship Target=\"/3D/m.model\" \
    Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";

/// A part that models may name.
const OTHER: &str = "<model><resources><object id=\"1\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/>\
    <vertex x=\"1\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"1\" z=\"0\"/></vertices><triangles>\
    <triangle v1=\"0\" v2=\"1\" v3=\"2\"/></triangles></mesh></object></resources></model>";

/// What must hold of a 3MF file.
///
/// # Errors
/// What does not.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    let file = file(bytes)?;
    let files = |name: &str| (name == NAME).then(|| file.clone());
    let read = |scene: &str| -> Result<Reading, String> { read(scene, &files) };
    match read(&format!("[[object]]\nmesh = \"{NAME}\"\n"))? {
        Ok(file) => is_placed_soundly(&file, read),
        Err(_) => Ok(()),
    }
}

/// An archive as it is, or one around a model part.
fn file(bytes: &[u8]) -> Result<Vec<u8>, String> {
    if bytes.starts_with(b"PK") {
        return Ok(bytes.to_vec());
    }
    let parts = [
        ("_rels/.rels", RELATIONSHIPS.as_bytes()),
        ("3D/m.model", bytes),
        ("3D/other.model", OTHER.as_bytes()),
    ];
    archive(&parts, CompressionMethod::Stored)
}

/// An archive of parts.
///
/// # Errors
/// What its library refuses.
pub fn archive(parts: &[(&str, &[u8])], compression: CompressionMethod) -> Result<Vec<u8>, String> {
    let write = || -> Result<Vec<u8>, Box<dyn std::error::Error>> {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, bytes) in parts {
            let options = SimpleFileOptions::default().compression_method(compression);
            writer.start_file(*name, options)?;
            writer.write_all(bytes)?;
        }
        Ok(writer.finish()?.into_inner())
    };
    write().map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzz::reading::seed;

    /// A seed that is refused leads nowhere.
    #[test]
    fn seeds_are_good_files() {
        for (name, objects) in [
            ("colors", 1),
            ("components", 4),
            ("archive", 4),
            ("archive_stored", 4),
        ] {
            let bytes = seed("threemf", name);
            let file = file(&bytes).expect("an archive");
            let files = |_: &str| Some(file.clone());
            let scene = format!("[[object]]\nmesh = \"{NAME}\"\n");
            let file = read(&scene, &files).expect("fit messages");
            let file = file.unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(file.scene.objects.len(), objects, "{name}");
        }
    }
}
