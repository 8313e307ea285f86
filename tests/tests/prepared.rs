//! `raycast prepare`: a prepared mesh stands for the mesh that it was made of, to the last byte.

use raycast_tests::arguments;
use raycast_tests::binary::{refuse, succeed};
use raycast_tests::files::{asset, bytes, folder, write, write_rays};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

/// Prepares files beside which the prepared one is to lie.
fn prepare(files: &[&Path], to: &Path, more: &[&str]) -> String {
    let mut arguments = arguments!["prepare", "-o", to];
    arguments.extend(files.iter().map(OsString::from));
    arguments.extend(more.iter().map(OsString::from));
    succeed(&arguments).errors
}

/// A picture of files with some options.
fn picture(files: &[&Path], image: &str, options: &str) -> Vec<u8> {
    let folder = folder();
    let image = folder.path().join(image);
    let mut arguments = arguments!["render", "-o", &image, "--size", "90x70"];
    arguments.extend(files.iter().map(OsString::from));
    arguments.extend(options.split_whitespace().map(OsString::from));
    succeed(&arguments);
    bytes(&image)
}

/// A quad and a triangle with numbers, colours and coordinates of their own.
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n\
    property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty float height\n\
    element face 2\nproperty list uchar int vertex_indices\nproperty float part\nend_header\n\
    0 0 0 255 0 0 1\n1 0 0 0 255 0 2\n1 1 0 0 0 255 3\n0 1 0 9 9 9 4\n2 2 1 255 255 0 0\n\
    4 0 1 2 3 7\n3 0 2 4 8\n";

/// A GLB that the program makes of several objects.
fn glb(folder: &Path) -> PathBuf {
    let path = folder.join("demo.glb");
    succeed(arguments![
        "convert",
        asset("demo.raycast.toml"),
        "-o",
        &path
    ]);
    path
}

/// The mesh beside which its materials and images are.
fn copied(folder: &Path, mesh: &str) -> PathBuf {
    for entry in fs::read_dir(asset(mesh).parent().expect("a folder")).expect("assets") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name");
        if path
            .extension()
            .is_some_and(|end| end == "mtl" || end == "obj" || end == "png")
        {
            fs::copy(&path, folder.join(name)).expect("a copy");
        }
    }
    folder.join(mesh)
}

#[test]
fn pictures_have_the_same_bytes_in_every_mode() {
    let folder = folder();
    let ply = write(folder.path(), "mesh.ply", PLY);
    let meshes = [copied(folder.path(), "monkey.obj"), ply, glb(folder.path())];
    let everywhere = [
        "--mode color",
        "--mode flat --cull back",
        "--mode smooth --samples 4",
        "--mode normals",
        "--mode depth",
        "--mode barycentric",
        "--mode uv",
        "--mode texture --filter trilinear",
        "--mode material --lights three-point",
        "--mode x-ray",
        "--crease 40",
        "--mode flat --wireframe --wireframe-edges polygon,boundary",
        "--color curvature --color-map viridis --legend",
        "--color area",
        "--clip x:0.1 --precision fast",
        "--projection equirectangular --tiles 3x2",
    ];
    for mesh in &meshes {
        let prepared = mesh.with_extension("raycast");
        prepare(&[mesh], &prepared, &[]);
        for options in everywhere {
            for image in ["a.png", "a.exr"] {
                let expected = picture(&[mesh], image, options);
                let found = picture(&[&prepared], image, options);
                assert!(found == expected, "{} {options} {image}", mesh.display());
            }
        }
    }
    let ply = meshes[1].with_extension("raycast");
    for options in ["--color scalar:height", "--color scalar:part --legend"] {
        let expected = picture(&[&meshes[1]], "a.png", options);
        assert!(picture(&[&ply], "a.png", options) == expected, "{options}");
    }
}

#[test]
fn what_a_mesh_names_is_in_the_prepared_file() {
    let folder = folder();
    let image = "P3\n2 2\n255\n255 0 0 0 255 0 0 0 255 250 250 10\n";
    write(folder.path(), "t.ppm", image);
    write(folder.path(), "a.mtl", "newmtl a\nmap_Kd t.ppm\n");
    let mesh = "mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
    let mesh = write(folder.path(), "a.obj", mesh);
    let expected = picture(&[&mesh], "a.png", "--mode texture");
    let prepared = folder.path().join("a.raycast");
    prepare(&[&mesh], &prepared, &[]);
    let elsewhere = raycast_tests::files::folder();
    let moved = elsewhere.path().join("b.raycast");
    fs::rename(&prepared, &moved).expect("moved");
    assert!(picture(&[&moved], "a.png", "--mode texture") == expected);
    // It has an image, and says so.
    let message = succeed(arguments!["info", &moved, "--json"]).output;
    let message = String::from_utf8(message).expect("JSON");
    for expected in ["\"prepared mesh\"", "prepared from a.obj", "\"texture\": ["] {
        assert!(message.contains(expected), "{expected}: {message}");
    }
}

#[test]
fn several_meshes_are_prepared_as_one_file_and_named_by_scene_files() {
    let folder = folder();
    let meshes = ["torus.obj", "cube.obj"].map(|name| copied(folder.path(), name));
    let meshes = meshes.each_ref().map(|mesh| &**mesh);
    let prepared = folder.path().join("both.raycast");
    prepare(&meshes, &prepared, &["--threads", "1"]);
    let first = bytes(&prepared);
    prepare(&meshes, &prepared, &["--threads", "3"]);
    assert!(bytes(&prepared) == first, "threads decide no byte");
    for options in ["--mode smooth", "--color object"] {
        let expected = picture(&meshes, "a.exr", options);
        assert!(
            picture(&[&prepared], "a.exr", options) == expected,
            "{options}"
        );
    }
    // A scene file names one of them, beside a shape that has no tree.
    let scene = |name: &str, mesh: &str| {
        let text = format!(
            "[[object]]\n{mesh}\ntranslate = [0.5, 0.0, 0.0]\nrotate = [0.0, 30.0, 0.0]\n\
             [[object]]\nshape = {{ kind = \"sphere\", radius = 1.0, segments = 32, rings = 16 }}\n"
        );
        write(folder.path(), name, text)
    };
    let plain = scene("a.raycast.toml", "mesh = \"cube.obj\"");
    let named = scene("b.raycast.toml", "mesh = \"both.raycast\"\nnode = 1");
    assert!(picture(&[&named], "a.exr", "") == picture(&[&plain], "a.exr", ""));
    // Scene files themselves are not prepared.
    let message = refuse(
        1,
        arguments!["prepare", asset("demo.raycast.toml"), "-o", &prepared],
    );
    assert!(
        message.contains("prepare the meshes that the scene file names"),
        "{message}"
    );
    assert!(bytes(&prepared) == first, "a refusal changes nothing");
}

#[test]
fn every_command_takes_a_prepared_mesh() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let mesh = copied(folder.path(), "torus.obj");
    let prepared = at("torus.raycast");
    prepare(&[&mesh], &prepared, &[]);
    let rays: Vec<[f32; 8]> = (0..200)
        .map(|i| {
            [
                i as f32 * 0.01 - 1.0,
                5.0,
                0.3,
                0.0,
                0.0,
                -1.0,
                0.01,
                f32::INFINITY,
            ]
        })
        .collect();
    write_rays(&at("rays"), &rays);
    for (mesh, hits) in [(&mesh, "a"), (&prepared, "b")] {
        succeed(arguments![
            "cast",
            mesh,
            "--rays",
            at("rays"),
            "--hits",
            at(hits)
        ]);
    }
    assert!(bytes(&at("a")) == bytes(&at("b")));
    let image = at("image.exr");
    succeed(arguments!["render", &mesh, "-o", &image, "--size", "40x30"]);
    succeed(arguments!["verify", &image, &prepared]);
    succeed(arguments!["convert", &mesh, "-o", at("a.ply")]);
    succeed(arguments!["convert", &prepared, "-o", at("b.ply")]);
    assert!(bytes(&at("a.ply")) == bytes(&at("b.ply")));
    succeed(arguments![
        "bench", &prepared, "--frames", "1", "--size", "32x24"
    ]);
    succeed(arguments![
        "plan",
        &prepared,
        "--turntable",
        "4",
        "-o",
        at("plan")
    ]);
    // Prepared again it is the same but for where it says it comes from.
    prepare(&[&prepared], &at("again.raycast"), &[]);
    assert!(picture(&[&at("again.raycast")], "a.png", "") == picture(&[&mesh], "a.png", ""));
}

#[test]
fn a_prepared_file_is_written_whole_over_nothing_that_was_read() {
    let folder = folder();
    let mesh = copied(folder.path(), "cube.obj");
    let before = bytes(&mesh);
    let named = folder.path().join("cube.raycast");
    for (status, from, to, expected) in [
        (2, &mesh, folder.path().join("a.ply"), "ends in .raycast"),
        (2, &mesh, mesh.clone(), "ends in .raycast"),
        (
            1,
            &folder.path().join("none.obj"),
            named.clone(),
            "none.obj",
        ),
    ] {
        let message = refuse(status, arguments!["prepare", from, "-o", &to]);
        assert!(message.contains(expected), "{message}");
    }
    assert!(!named.exists());
    prepare(&[&mesh], &named, &[]);
    let prepared = bytes(&named);
    refuse(2, arguments!["prepare", &named, "-o", &named]);
    #[cfg(unix)]
    {
        let link = folder.path().join("link.raycast");
        std::os::unix::fs::symlink(&mesh, &link).expect("a link");
        refuse(2, arguments!["prepare", &mesh, "-o", &link]);
    }
    assert!(bytes(&mesh) == before && bytes(&named) == prepared);
    // What is damaged is told in one line, by every command.
    let mut damaged = prepared;
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    let damaged = write(folder.path(), "damaged.raycast", damaged);
    let message = refuse(1, arguments!["info", &damaged]);
    assert!(
        message.contains("damaged: run `raycast prepare` again"),
        "{message}"
    );
}
