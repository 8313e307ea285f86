//! The committed demo assets are what their program makes, byte for byte, and every one renders.

use raycast_core::formats::read_scene;
use raycast_core::glam::DVec3;
use raycast_core::scene::{Material, Shape};
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

/// A triangle's corners in the OBJ's decimals, from the least one on, and its material.
type Triangle = ([[i64; 3]; 3], Option<String>);

fn triangle(corners: [DVec3; 3], material: Option<&Material>) -> Triangle {
    let decimals = |x: f64| (x * 1e5).round() as i64;
    let mut corners = corners.map(|corner| corner.to_array().map(decimals));
    let least = (0..3).min_by_key(|i| corners[*i]).unwrap_or_default();
    corners.rotate_left(least);
    (corners, material.map(|material| material.name.clone()))
}

#[test]
fn the_monkey_and_the_dahlia_are_the_assets() {
    let size = Shape::LENGTH;
    let petals = Shape::PETALS;
    for shape in [Shape::Monkey { size }, Shape::Dahlia { size, petals }] {
        let name = shape.name();
        let made = shape.mesh().expect("a good shape");
        let materials = made.material_of_triangle.iter();
        let materials = materials.map(|material| &made.materials[*material as usize]);
        let mut made: Vec<Triangle> = made
            .triangles
            .iter()
            .zip(materials)
            .map(|(corners, material)| {
                triangle(corners.map(|i| made.positions[i as usize]), Some(material))
            })
            .collect();

        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets");
        let file = read_scene(&file.join(format!("{name}.obj")), &|_| ()).expect("an asset");
        let mesh = &file.scene.objects[0].mesh;
        let mut read: Vec<Triangle> = (0..mesh.triangles().len() as u32)
            .map(|number| {
                let corners = mesh.corners(number).expect("a triangle");
                let corners = corners.map(|corner| corner.as_dvec3() + mesh.offset());
                triangle(corners, mesh.material(number))
            })
            .collect();

        made.sort();
        read.sort();
        let differ = made.iter().zip(&read).filter(|(a, b)| a != b).count();
        assert_eq!((made.len(), differ), (read.len(), 0), "{name}");
    }
}
