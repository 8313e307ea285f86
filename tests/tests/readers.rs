//! OBJ files read by another implementation too: the same triangles, in the same order, with the same
//! corners, in groups of the same names.

use raycast_core::formats::read_mesh;
use raycast_core::glam::{DVec3, Vec2, Vec3};
use raycast_tests::{files, models};
use std::io::BufReader;
use std::path::Path;

/// Compares our reading of a file whose polygons are convex with that of `tobj`.
fn check(path: &Path) {
    let ours = read_mesh(path, &|_| ()).expect("a good file");
    let file = std::fs::File::open(path).expect("the file");
    let options = tobj::LoadOptions {
        triangulate: true,
        ..tobj::LoadOptions::default()
    };
    let no_library = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut BufReader::new(file), &options, no_library)
        .expect("a file that tobj reads");
    let mut number = 0;
    for tobj::Model { mesh, name } in models {
        let positions: Vec<_> = mesh
            .positions
            .chunks_exact(3)
            .map(DVec3::from_slice)
            .collect();
        let uvs: Vec<_> = mesh.texcoords.chunks_exact(2).collect();
        let normals: Vec<_> = mesh
            .normals
            .chunks_exact(3)
            .map(DVec3::from_slice)
            .collect();
        for (face, corners) in mesh.indices.chunks_exact(3).enumerate() {
            let place = format!("{}, triangle {number}", path.display());
            let group = ours.groups().of(number).unwrap_or("unnamed_object");
            assert_eq!(group, name, "{place}");
            let found = ours.corners(number).expect("as many triangles");
            for (corner, &index) in found.iter().zip(corners) {
                // As stored: single precision about one offset.
                let expected = (positions[index as usize] - ours.offset()).as_vec3();
                assert_eq!(*corner, expected, "{place}");
            }
            if !uvs.is_empty() {
                let expected = [0, 1, 2].map(|corner| {
                    let uv = uvs[mesh.texcoord_indices[3 * face + corner] as usize];
                    Vec2::new(uv[0] as f32, uv[1] as f32)
                });
                assert_eq!(ours.corner_uvs(number), Some(expected), "{place}");
            }
            if !normals.is_empty() {
                let expected: [Vec3; 3] = [0, 1, 2].map(|corner| {
                    let normal = normals[mesh.normal_indices[3 * face + corner] as usize];
                    normal.normalize_or_zero().as_vec3()
                });
                assert_eq!(ours.corner_normals(number), Some(expected), "{place}");
            }
            number += 1;
        }
    }
    assert_eq!(
        ours.triangles().len(),
        number as usize,
        "{}",
        path.display()
    );
}

#[test]
fn the_assets_are_read_as_tobj_reads_them() {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets");
    for name in ["cube", "dahlia", "monkey", "plinth", "torus"] {
        check(&assets.join(name).with_extension("obj"));
    }
}

#[test]
fn real_meshes_are_read_as_tobj_reads_them() {
    for name in ["spot.obj", "stanford-bunny.obj", "teapot.obj"] {
        if let Some(path) = models::file(name) {
            check(&path);
        }
    }
}

/// So long that it is read in pieces, whose borders lie anywhere between the statements.
#[test]
fn groups_of_a_long_file_are_those_of_tobj() {
    let mut text = String::from("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n");
    for part in 0..40_000 {
        let name = ["g part ", "o thing ", "g "][part % 3];
        text.push_str(&format!("{name}{}\n", part / 3 % 1000));
        // Some groups have no face.
        for _ in 0..part * 7 % 5 {
            text.push_str("f 1 2 3\nf 1 3 4\n");
        }
    }
    assert!(text.len() > 1 << 20, "{}", text.len());
    let folder = files::folder();
    check(&files::write(folder.path(), "long.obj", text));
}
