//! The committed demo assets are what their program makes, byte for byte, and every one renders.

use std::path::Path;

#[test]
fn assets_are_what_their_program_makes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets");
    let made = raycast_assets::all();
    assert!(made.len() >= 5, "{} assets", made.len());
    for (name, bytes) in &made {
        let committed = std::fs::read(folder.join(name))
            .unwrap_or_else(|error| panic!("assets/{name}: {error}"));
        assert!(
            &committed == bytes,
            "assets/{name} is not what the program makes: `cargo run -p raycast-assets --release`"
        );
    }
    // And nothing lies there that it does not make.
    for entry in std::fs::read_dir(&folder).expect("the assets can be listed") {
        let name = entry.expect("the assets can be listed").file_name();
        let name = name.to_string_lossy();
        let is_source = matches!(&*name, ".gitattributes" | "Cargo.toml" | "src");
        assert!(
            is_source || made.iter().any(|(made, _)| *made == name),
            "assets/{name} is made by nothing"
        );
    }
}
