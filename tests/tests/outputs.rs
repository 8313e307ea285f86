//! What the program writes: never over what it reads, never over what it was not allowed to replace,
//! and with the mode, the owner and the links of what was there.

#![allow(
    clippy::print_stdout,
    reason = "tests tell what they checked and what they skipped"
)]

use image::ImageDecoder;
use raycast_tests::arguments;
use raycast_tests::binary::{command, refuse, run, succeed};
use raycast_tests::files::{asset, bytes, folder, names, write};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A scene of one mesh, with a library of materials and images, everything named by another file, and a
/// ray.
struct Inputs {
    folder: TempDir,
    before: Vec<(OsString, Vec<u8>)>,
}

impl Inputs {
    fn new() -> Self {
        let folder = folder();
        let at = folder.path();
        let image = bytes(&asset("leopard.png"));
        write(at, "t.png", &image);
        write(at, "object.png", &image);
        // A library may have any name.
        write(
            at,
            "lib.png",
            "newmtl skin\nKd 1 0 0\nmap_Kd t.png\nmap_Bump -bm 0.5 bump.png\n",
        );
        write(at, "bump.png", &image);
        write(at, "lib.mtl", "newmtl other\nKd 0 1 0\n");
        let mesh = "mtllib lib.png\nmtllib lib.mtl\nusemtl skin\n\
             v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
        write(at, "mesh.obj", mesh);
        write(
            at,
            "scene.raycast.toml",
            "[[object]]\nmesh = \"mesh.obj\"\n[[object]]\nmesh = \"mesh.obj\"\ntexture = \"object.png\"\n",
        );
        // No texture coordinates: its image is not read, nor is a buffer that nothing has a view of.
        write(
            at,
            "bare.gltf",
            r#"{"asset":{"version":"2.0"},"images":[{"uri":"t.png"}],"textures":[{"source":0}],
            "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],
            "buffers":[{"uri":"bare.bin","byteLength":36},{"uri":"unused.bin","byteLength":4}],
            "bufferViews":[{"buffer":0,"byteLength":36}],
            "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
            "meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],
            "nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0}"#,
        );
        let corners = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        write(at, "bare.bin", corners.map(f32::to_le_bytes).concat());
        write(at, "unused.bin", [0; 4]);
        // No texture coordinates here, either.
        write(
            at,
            "bare.ply",
            "ply\nformat ascii 1.0\ncomment TextureFile t.png\nelement vertex 3\nproperty float x\n\
             property float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\n\
             end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        );
        let ray = [0.2f32, 0.2, 5.0, 0.0, 0.0, 0.0, -1.0, 9.0];
        write(at, "rays", ray.map(f32::to_le_bytes).concat());
        let before = contents(at);
        Self { folder, before }
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn assert_untouched(&self, what: &str) {
        for (name, before) in &self.before {
            let path = self.folder.path().join(name);
            assert!(bytes(&path) == *before, "{what}: {name:?} was lost");
        }
    }

    /// Every command that writes, each with one of its outputs at `place`.
    fn assert_refused(&self, file: &str, place: &Path) {
        let elsewhere = folder();
        let other = |name: &str| elsewhere.path().join(name);
        let file = self.at(file);
        let small = ["--size", "4x4"];
        let mut outputs = vec![
            arguments!["render", &file, "-o", other("a.png"), "--stats", place],
            arguments!["cast", &file, "--rays", self.at("rays"), "--hits", place],
            arguments![
                "cast",
                &file,
                "--rays",
                self.at("rays"),
                "--hits",
                other("h"),
                "--stats",
                place
            ],
        ];
        if place
            .extension()
            .is_some_and(|extension| extension == "png")
        {
            outputs.push(arguments!["render", &file, "-o", place]);
        }
        for mut arguments in outputs {
            if arguments[0] == "render" {
                arguments.extend(small.map(OsString::from));
            }
            let line = refuse(2, &arguments);
            assert!(line.contains(&place.display().to_string()), "{line}");
            assert!(line.contains("cannot be written"), "{line}");
            self.assert_untouched(&format!("{arguments:?}"));
            assert!(names(elsewhere.path()).is_empty(), "{arguments:?}");
        }
    }
}

/// Every file's name and bytes.
fn contents(folder: &Path) -> Vec<(OsString, Vec<u8>)> {
    let names = names(folder).into_iter();
    names
        .map(|name| (name.clone(), bytes(&folder.join(name))))
        .collect()
}

#[test]
fn what_a_scene_names_is_not_written_over() {
    let inputs = Inputs::new();
    for (file, named) in [
        (
            "scene.raycast.toml",
            &[
                "scene.raycast.toml",
                "mesh.obj",
                "lib.png",
                "lib.mtl",
                "object.png",
                // Named by a mesh whose textures this scene does not show.
                "t.png",
                "bump.png",
            ][..],
        ),
        (
            "mesh.obj",
            &["mesh.obj", "lib.png", "lib.mtl", "t.png", "bump.png"],
        ),
        (
            "bare.gltf",
            &["bare.gltf", "bare.bin", "unused.bin", "t.png"],
        ),
        ("bare.ply", &["bare.ply", "t.png"]),
    ] {
        for name in named {
            inputs.assert_refused(file, &inputs.at(name));
        }
    }
    // What this scene does not name is anybody's.
    let free = inputs.at("object.png");
    succeed(arguments![
        "render",
        inputs.at("mesh.obj"),
        "-o",
        &free,
        "--size",
        "4x4"
    ]);
}

#[cfg(unix)]
#[test]
fn what_a_scene_names_is_found_behind_links() {
    let inputs = Inputs::new();
    let link = |name: &str| {
        let (soft, hard) = (
            inputs.at(&format!("soft {name}")),
            inputs.at(&format!("hard {name}")),
        );
        std::os::unix::fs::symlink(name, &soft).expect("a link");
        std::fs::hard_link(inputs.at(name), &hard).expect("a hard link");
        [soft, hard]
    };
    for name in ["mesh.obj", "lib.png", "t.png", "rays"] {
        for place in link(name) {
            if name == "rays" {
                let line = refuse(
                    2,
                    arguments![
                        "cast",
                        inputs.at("mesh.obj"),
                        "--rays",
                        inputs.at("rays"),
                        "--hits",
                        &place
                    ],
                );
                assert!(line.contains("cannot be written"), "{line}");
                inputs.assert_untouched(name);
            } else {
                inputs.assert_refused("mesh.obj", &place);
            }
        }
    }
}

#[test]
fn a_report_is_not_written_over_what_it_is_of() {
    let folder = folder();
    // One of the report's own files, as a library of materials.
    let library = write(folder.path(), "ways.csv", "newmtl a\nKd 1 0 0\n");
    let mesh = write(
        folder.path(),
        "m.obj",
        "mtllib ways.csv\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    );
    let before = contents(folder.path());
    let refused = refuse(
        1,
        arguments!["report", &mesh, "-o", folder.path(), "--quick"],
    );
    assert!(refused.contains("--force"), "{refused}");
    let refused = refuse(
        2,
        arguments!["report", &mesh, "-o", folder.path(), "--quick", "--force"],
    );
    assert!(
        refused.contains(&library.display().to_string()),
        "{refused}"
    );
    assert_eq!(contents(folder.path()), before);
}

#[test]
fn a_folder_is_written_over_where_it_holds_a_report() {
    let folder = folder();
    let letter = write(folder.path(), "letter.txt", "to somebody");
    let report = write(folder.path(), "report.md", "of another kind");
    let again = arguments!["report", asset("cube.obj"), "-o", folder.path(), "--quick"];
    let line = refuse(1, &again);
    assert!(line.contains("--force"), "{line}");
    assert_eq!(names(folder.path()), ["letter.txt", "report.md"]);

    // Now it holds one; no name makes somebody's file a leftover.
    write(folder.path(), ".raycast-report", "");
    let own = write(folder.path(), ".raycast-1-0.part", "somebody's own");
    succeed(&again);
    assert_eq!(bytes(&letter), b"to somebody");
    assert!(bytes(&report).starts_with(b"# RayCast"));
    assert_eq!(bytes(&own), b"somebody's own");
}

#[cfg(unix)]
mod unix {
    use super::*;
    use rustix::process::geteuid;
    use std::fs::Permissions;
    use std::os::unix::fs::{MetadataExt, PermissionsExt, chown, symlink};
    use std::os::unix::process::CommandExt;

    fn render(place: &Path) -> Vec<OsString> {
        arguments!["render", asset("cube.obj"), "-o", place, "--size", "4x4"]
    }

    #[test]
    fn what_is_replaced_keeps_its_mode_and_its_links() {
        let folder = folder();
        let at = |name: &str| folder.path().join(name);
        succeed(render(&at("fresh.png")));
        let whole = bytes(&at("fresh.png"));
        for mode in [0o600, 0o640, 0o755] {
            let path = write(folder.path(), "a.png", "old");
            std::fs::set_permissions(&path, Permissions::from_mode(mode)).expect("set");
            succeed(render(&path));
            assert!(bytes(&path) == whole);
            let found = std::fs::metadata(&path).expect("a file");
            assert_eq!(found.permissions().mode() & 0o7777, mode, "{mode:o}");
        }
        std::fs::create_dir(at("there")).expect("a folder");
        symlink("there/b.png", at("link.png")).expect("a link");
        for name in ["dangling", "whole"] {
            succeed(render(&at("link.png")));
            assert!(at("link.png").is_symlink(), "{name}");
            assert!(bytes(&at("there/b.png")) == whole, "{name}");
            assert_eq!(names(&at("there")), ["b.png"]);
            write(&at("there"), "b.png", "old");
        }
        symlink("nowhere/c.png", at("lost.png")).expect("a link");
        refuse(1, render(&at("lost.png")));
        symlink("circle.png", at("circle.png")).expect("a link");
        refuse(1, render(&at("circle.png")));
    }

    /// The superuser writes others' files and leaves them theirs; others are refused.
    #[test]
    fn what_is_replaced_keeps_its_owner_or_is_refused() {
        if !geteuid().is_root() {
            println!("skipped: only the superuser can make files of several owners");
            return;
        }
        let (owner, other) = (12_345, 23_456);
        let folder = folder();
        let path = write(folder.path(), "a.png", "old");
        chown(&path, Some(owner), Some(owner)).expect("given away");
        succeed(render(&path));
        let found = std::fs::metadata(&path).expect("a file");
        assert_eq!((found.uid(), found.gid()), (owner, owner));

        // Somebody else, in a folder that anybody may write to.
        std::fs::set_permissions(folder.path(), Permissions::from_mode(0o777)).expect("set");
        for (mode, said) in [(0o644, "denied"), (0o666, "belongs to user 12345")] {
            let path = write(folder.path(), "a.png", "old");
            chown(&path, Some(owner), Some(owner)).expect("given away");
            std::fs::set_permissions(&path, Permissions::from_mode(mode)).expect("set");
            let mut command = command(render(&path));
            command.uid(other).gid(other);
            let Ok(output) = command.output() else {
                println!("skipped: others may not start the program here");
                return;
            };
            let message = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(1), "{mode:o}: {message}");
            assert!(message.contains(said), "{mode:o}: {message}");
            assert_eq!(bytes(&path), b"old");
            assert_eq!(names(folder.path()), ["a.png"]);
        }
        // Their own they may replace.
        let path = write(folder.path(), "a.png", "old");
        chown(&path, Some(other), Some(other)).expect("given away");
        let mut command = command(render(&path));
        command.uid(other).gid(other);
        let message = run(&mut command);
        assert_eq!(message.status, Some(0), "{}", message.errors);
        assert_eq!(std::fs::metadata(&path).expect("a file").uid(), other);
    }
}

#[test]
fn frames_are_not_written_over_what_is_read_nor_statistics_over_frames() {
    let inputs = Inputs::new();
    let image = bytes(&asset("leopard.png"));
    write(inputs.folder.path(), "f-2.png", &image);
    let mesh = "mtllib frames.mtl\nusemtl skin\n\
         v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
    write(inputs.folder.path(), "frames.obj", mesh);
    let library = "newmtl skin\nmap_Kd f-2.png\n";
    write(inputs.folder.path(), "frames.mtl", library);
    let mesh = inputs.at("frames.obj");
    let frames = |pattern: &str| {
        let output = inputs.at(pattern);
        arguments![
            "render",
            &mesh,
            "-o",
            output,
            "--turntable",
            "4",
            "--size",
            "4x4"
        ]
    };
    // The third frame is the texture: none is written.
    let message = refuse(2, frames("f-%d.png"));
    assert!(message.contains("f-2.png: cannot be written"), "{message}");
    assert!(!inputs.at("f-0.png").exists());
    assert!(bytes(&inputs.at("f-2.png")) == image);
    // Nor where the command line names it as the texture.
    let mut with_texture = frames("f-%d.png");
    with_texture[1] = inputs.at("bare.gltf").into();
    with_texture.extend(arguments!["--texture", inputs.at("f-2.png")]);
    let message = refuse(2, with_texture);
    assert!(message.contains("f-2.png: cannot be written"), "{message}");
    assert!(bytes(&inputs.at("f-2.png")) == image);
    let mut with_stats = frames("g-%d.png");
    with_stats.extend(arguments!["--stats", inputs.at("g-1.png")]);
    refuse(2, with_stats);
    for pattern in ["h-%s.png", "h-%d-%d.png", "h-%99d.png"] {
        let message = refuse(2, frames(pattern));
        assert!(message.contains("%05d"), "{message}");
    }
    inputs.assert_untouched("frames");
    succeed(frames("k-%d.png"));
    assert!(inputs.at("k-3.png").exists());
}

/// Viewers of panoramas find GPano metadata where another decoder finds XMP; a picture that is none has none.
#[test]
fn panoramas_say_so_in_png_and_jpeg() {
    let folder = folder();
    let mesh = asset("cube.obj");
    let metadata = |name: &str, options: &[&str]| {
        let path = folder.path().join(name);
        let mut arguments = arguments!["render", &mesh, "-o", &path, "--size", "64x32"];
        arguments.extend(options.iter().map(OsString::from));
        succeed(arguments);
        let reader = image::ImageReader::open(&path).expect("a picture");
        let mut decoder = reader.into_decoder().expect("a picture");
        let packet = decoder.xmp_metadata().expect("readable metadata");
        let size = decoder.dimensions();
        let pixels = image::DynamicImage::from_decoder(decoder).expect("pixels");
        assert_eq!((size, pixels.width()), ((64, 32), 64), "{name}");
        packet.map(|packet| String::from_utf8(packet).expect("XMP is UTF-8"))
    };
    for name in ["a.png", "a.jpg"] {
        let projection = ["--projection", "equirectangular"];
        for (fov, full, corner) in [("180", (64, 32), (0, 0)), ("90", (128, 64), (32, 16))] {
            let options = [&projection[..], &["--fov", fov]].concat();
            let packet = metadata(name, &options).expect("a panorama says so");
            for (key, value) in [
                ("FullPanoWidthPixels", full.0),
                ("FullPanoHeightPixels", full.1),
                ("CroppedAreaLeftPixels", corner.0),
                ("CroppedAreaTopPixels", corner.1),
                ("CroppedAreaImageWidthPixels", 64),
                ("CroppedAreaImageHeightPixels", 32),
            ] {
                let word = format!("GPano:{key}=\"{value}\"");
                assert!(packet.contains(&word), "{name} {word}: {packet}");
            }
        }
        assert_eq!(metadata(name, &[]), None);
        assert_eq!(metadata(name, &["--projection", "fisheye"]), None);
    }
}

/// A plan reads no mesh, and so does not know what files one names.
#[test]
fn plans_replace_plans_alone() {
    let inputs = Inputs::new();
    for name in ["lib.mtl", "t.png"] {
        let place = inputs.at(name);
        let arguments = arguments![
            "plan",
            inputs.at("mesh.obj"),
            "-o",
            &place,
            "--tiles",
            "2x1"
        ];
        let line = refuse(1, arguments);
        assert!(line.contains("is no plan"), "{line}");
        inputs.assert_untouched(name);
        assert!(!inputs.at(&format!("{name}.stitch")).exists());
    }
    let plan = write(inputs.folder.path(), "plan", "");
    for tiles in ["2x1", "3x1"] {
        let mesh = inputs.at("mesh.obj");
        succeed(arguments!["plan", mesh, "-o", &plan, "--tiles", tiles]);
    }
    assert_eq!(bytes(&plan).split(|byte| *byte == b'\n').count(), 3 + 1);
}
