//! `raycast convert`: a mesh in any format is the same mesh.

use raycast_tests::arguments;
use raycast_tests::binary::{ProgramOutput, refuse, succeed};
use raycast_tests::files::{asset, bytes, folder, names, write};
use std::ffi::OsString;
use std::path::Path;

fn convert(from: &Path, to: &Path, more: &[&str]) -> ProgramOutput {
    let mut arguments = arguments!["convert", from, "-o", to];
    arguments.extend(more.iter().map(OsString::from));
    succeed(&arguments)
}

/// A picture of a mesh in one colour, which its attributes do not change, as a file of a format.
fn picture_as(format: &str, mesh: &Path) -> Vec<u8> {
    let folder = folder();
    let image = folder.path().join(format!("picture.{format}"));
    succeed(arguments![
        "render", mesh, "-o", &image, "--mode", "flat", "--color", "#888888", "--size", "160x120"
    ]);
    bytes(&image)
}

/// With the picture's recipe.
fn picture(mesh: &Path) -> Vec<u8> {
    picture_as("png", mesh)
}

/// The formats that are read and written, by name.
const FORMATS: [(&str, &[&str]); 7] = [
    ("mesh.obj", &[]),
    ("binary.ply", &[]),
    ("text.ply", &["--ascii"]),
    ("binary.stl", &[]),
    ("text.stl", &["--ascii"]),
    ("mesh.glb", &[]),
    ("mesh.txt", &[]),
];

#[test]
fn one_mesh_in_every_format_is_one_picture() {
    let folder = folder();
    for name in ["monkey.obj", "torus.obj"] {
        let first = folder.path().join("first.ply");
        convert(&asset(name), &first, &[]);
        let expected = picture(&first);
        assert_eq!(picture(&asset(name)), expected, "{name}");
        for (one, options) in FORMATS {
            let one = folder.path().join(one);
            convert(&first, &one, options);
            assert!(picture(&one) == expected, "{name} as {}", one.display());
            for (other, options) in FORMATS {
                let other = folder.path().join(format!("from-{other}"));
                convert(&one, &other, options);
                let names = (one.display(), other.display());
                assert!(
                    picture(&other) == expected,
                    "{name} as {} to {}",
                    names.0,
                    names.1
                );
            }
        }
    }
}

/// A picture that shows triangles alone is that of a mesh in any format. Where it shows more, or has layers, it is not:
/// STL has no texture coordinates.
#[test]
fn a_picture_of_triangles_is_verified_with_any_format() {
    let folder = folder();
    let [ply, stl, picture, layered] =
        ["mesh.ply", "mesh.stl", "picture.png", "picture.exr"].map(|it| folder.path().join(it));
    convert(&asset("torus.obj"), &ply, &[]);
    convert(&ply, &stl, &[]);
    let render = |image: &Path, mode: &str| {
        succeed(arguments![
            "render", &ply, "-o", image, "--mode", mode, "--color", "#888888", "--size", "80x60"
        ]);
    };
    let verify = |image: &Path| {
        arguments![
            "verify", image, &stl, "--color", "#888888", "--checks", "500"
        ]
    };
    render(&picture, "flat");
    succeed(verify(&picture));
    render(&picture, "uv");
    assert!(refuse(1, verify(&picture)).contains("another scene"));
    render(&layered, "flat");
    assert!(refuse(1, verify(&layered)).contains("another scene"));
}

#[test]
fn a_scene_of_several_objects_is_converted_in_its_places() {
    let folder = folder();
    let demo = asset("demo.raycast.toml");
    let obj = folder.path().join("demo.obj");
    let message = convert(&demo, &obj, &[]);
    assert_eq!(message.errors, "");
    for beside in ["demo.mtl", "demo-1.png"] {
        assert!(names(folder.path()).contains(&OsString::from(beside)));
    }
    let ply = folder.path().join("demo.ply");
    convert(&demo, &ply, &[]);
    // The pixels alone: PLY makes one object of all.
    assert!(picture_as("ppm", &obj) == picture_as("ppm", &ply));
}

/// Each material of an OBJ shows its image, and a GLB and an OBJ made of it give the same picture.
#[test]
fn images_of_materials_are_shown_and_converted() {
    let folder = folder();
    let library = "newmtl a\nmap_Kd red.ppm\nnewmtl b\nmap_Kd blue.ppm\nnewmtl c\nKd 0 1 0\n";
    write(folder.path(), "three.mtl", library);
    write(folder.path(), "red.ppm", "P3 1 1 255 250 0 0\n");
    write(folder.path(), "blue.ppm", "P3 1 1 255 0 0 251\n");
    let strip = |x: usize, material: &str| {
        let (left, right) = (x, x + 1);
        format!(
            "v {left} 0 0\nv {right} 0 0\nv {right} 3 0\nv {left} 3 0\nvt 0.5 0.5\nusemtl {material}\n\
             f -4/-1 -3/-1 -2/-1\nf -4/-1 -2/-1 -1/-1\n"
        )
    };
    let strips = strip(0, "a") + &strip(1, "b") + &strip(2, "c");
    let obj = write(
        folder.path(),
        "three.obj",
        format!("mtllib three.mtl\n{strips}"),
    );
    let glb = folder.path().join("three.glb");
    let copy = folder.path().join("copy.obj");
    for to in [&glb, &copy] {
        assert_eq!(convert(&obj, to, &[]).errors, "");
    }
    for beside in ["copy.mtl", "copy-1.png", "copy-2.png"] {
        assert!(names(folder.path()).contains(&OsString::from(beside)));
    }
    // An image that is there without the mesh that it goes with is somebody else's.
    let other = write(folder.path(), "other-1.png", "somebody's");
    let line = refuse(
        1,
        arguments!["convert", &obj, "-o", folder.path().join("other.obj")],
    );
    assert!(line.contains("other-1.png"), "{line}");
    assert_eq!(bytes(&other), b"somebody's");
    for mesh in [&obj, &glb, &copy] {
        let picture = folder.path().join("a.ppm");
        let mut arguments = arguments!["render", mesh, "-o", &picture];
        let camera =
            "--projection orthographic --size 3x3 --step 1 --eye 1.5,1.5,5 --target 1.5,1.5,0";
        let camera = camera.split(' ').chain(["--mode", "texture"]);
        arguments.extend(camera.map(OsString::from));
        succeed(&arguments);
        let bytes = bytes(&picture);
        let row: Vec<_> = bytes[bytes.len() - 9..].as_chunks::<3>().0.to_vec();
        assert_eq!(row, [[250, 0, 0], [0, 0, 251], [0, 255, 0]], "{mesh:?}");
    }
}

#[test]
fn no_input_is_written_over() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let mesh = "mtllib a.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    write(folder.path(), "a.obj", mesh);
    write(folder.path(), "a.mtl", "newmtl x\nKd 1 0 0\n");
    for output in ["a.obj", "./a.obj"] {
        let line = refuse(2, arguments!["convert", at("a.obj"), "-o", at(output)]);
        assert!(line.contains("cannot be written"), "{line}");
    }
    // The library that the output would have is that of the input.
    std::fs::create_dir(at("b")).expect("a folder");
    std::fs::hard_link(at("a.mtl"), at("b/c.mtl")).expect("a link");
    // Nobody said that it might be replaced; with a mesh there that it goes with, it is the input still.
    for (status, mesh) in [(1, None), (2, Some(mesh))] {
        if let Some(mesh) = mesh {
            write(&at("b"), "c.obj", mesh);
        }
        let line = refuse(
            status,
            arguments!["convert", at("a.obj"), "-o", at("b/c.obj")],
        );
        assert!(line.contains("c.mtl: cannot be written"), "{line}");
    }
    assert_eq!(names(&at("b")), ["c.mtl", "c.obj"]);
    assert_eq!(bytes(&at("b/c.mtl")), b"newmtl x\nKd 1 0 0\n");
    for (output, why) in [
        ("b/a.off", "expected a name that ends in"),
        ("b/a", "expected a name that ends in"),
        ("b/.obj", "expected a name that ends in"),
    ] {
        let line = refuse(2, arguments!["convert", at("a.obj"), "-o", at(output)]);
        assert!(line.contains(why), "{line}");
    }
    refuse(
        2,
        arguments!["convert", at("a.obj"), "-o", at("b/a.glb"), "--ascii"],
    );
}

#[test]
fn what_is_up_is_turned() {
    let folder = folder();
    let mesh = write(folder.path(), "a.txt", "(0,0,0);(1,0,0);(0,2,3)\n");
    let turned = folder.path().join("b.txt");
    convert(&mesh, &turned, &["--up-axis", "z"]);
    assert_eq!(bytes(&turned), b"(0,0,0);(1,0,0);(0,3,-2)\n");
    let message = succeed(arguments!["info", &mesh, "--up-axis", "z"]);
    let message = String::from_utf8_lossy(&message.output).into_owned();
    assert!(message.contains("z is taken to be up"), "{message}");
}
