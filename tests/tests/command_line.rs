//! The real binary, from outside: pictures the same for every split, errors of one line, file
//! formats, JSON.

#![allow(
    clippy::print_stdout,
    reason = "tests tell what they checked and what they skipped"
)]

use raycast_core::Cull;
use raycast_core::camera::Ray;
use raycast_core::formats::read_mesh;
use raycast_core::glam::{DVec3, Vec3};
use raycast_core::picture::{Format, ImageFile, Picture};
use raycast_oracle::random::Random;
use raycast_tests::binary::{command, refuse, run, succeed};
use raycast_tests::check::{Check, Stage};
use raycast_tests::models;
use serde_json::Value;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder for temporary files")
}

fn asset(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../assets")
        .join(name);
    assert!(path.is_file(), "{} is missing", path.display());
    path
}

fn bytes(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn names(folder: &Path) -> Vec<OsString> {
    let entries = std::fs::read_dir(folder).expect("the folder can be listed");
    let mut names: Vec<_> = entries
        .map(|entry| entry.expect("the folder can be listed").file_name())
        .collect();
    names.sort();
    names
}

/// Arguments: words, and paths where they stand between them.
macro_rules! arguments {
    ($($argument:expr),* $(,)?) => {
        vec![$(OsString::from($argument)),*]
    };
}

// Sameness.

/// Renders whole, and split in several ways: identical bytes.
fn assert_splits_agree(mesh: &Path, more: &[OsString]) {
    let folder = folder();
    let render = |name: &str, split: &[&str]| {
        let output = folder.path().join(name);
        let mut arguments = arguments!["render", mesh, "-o", &output];
        arguments.extend(more.iter().cloned());
        arguments.extend(split.iter().map(OsString::from));
        succeed(arguments);
        bytes(&output)
    };
    let whole = render("whole.png", &[]);
    let image = image::load_from_memory(&whole).expect("a PNG").into_rgba8();
    let first = *image.get_pixel(0, 0);
    let middle = image.pixels().filter(|&&pixel| pixel != first).count();
    assert!(middle > 1000, "{}: an empty picture", mesh.display());
    for (name, split) in [
        ("a.png", &["--tiles", "3x2"][..]),
        ("b.png", &["--tile-size", "17"]),
        ("c.png", &["--threads", "1"]),
        ("d.png", &["--threads", "3", "--tiles", "1x1"]),
    ] {
        assert!(
            render(name, split) == whole,
            "{}: {split:?} makes another picture",
            mesh.display()
        );
    }
}

#[test]
fn splits_agree_on_the_demo_assets() {
    for name in ["cube.obj", "monkey.obj", "dahlia.obj", "demo.raycast.toml"] {
        let size = ["--size", "320x240"].map(OsString::from);
        assert_splits_agree(&asset(name), &size);
        let mode = ["--size", "200x200", "--mode", "color"].map(OsString::from);
        assert_splits_agree(&asset(name), &mode);
    }
    let mut textured = arguments!["--size", "240x180", "--mode", "texture"];
    textured.extend(arguments![
        "--texture",
        asset("leopard.png"),
        "--samples",
        "3"
    ]);
    assert_splits_agree(&asset("torus.obj"), &textured);
}

#[test]
fn splits_agree_on_real_meshes() {
    let color = ["--size", "800x800", "--mode", "color"].map(OsString::from);
    for mesh in models::meshes() {
        assert_splits_agree(&mesh, &color);
    }
    if let (Some(spot), Some(texture)) =
        (models::file("spot.obj"), models::file("spot_texture.png"))
    {
        let textured = arguments![
            "--size",
            "800x800",
            "--mode",
            "texture",
            "--texture",
            texture
        ];
        assert_splits_agree(&spot, &textured);
    }
}

/// Fragments that processes of their own wrote, stitched by another: the whole's own bytes.
#[test]
fn fragments_of_other_processes_stitch_to_the_whole() {
    let mesh = asset("monkey.obj");
    for extension in ["png", "exr"] {
        let folder = folder();
        let at = |name: &str| folder.path().join(format!("{name}.{extension}"));
        let view = ["--size", "203x151", "--orbit", "40,10"];
        let render = |output: &Path, more: &[&str]| {
            let mut arguments = arguments!["render", &mesh, "-o", output];
            arguments.extend(view.iter().chain(more).map(OsString::from));
            succeed(arguments);
        };
        render(&at("whole"), &[]);
        let mut arguments = arguments!["stitch"];
        for cell in ["2,1", "0,0", "1,0", "2,0", "0,1", "1,1"] {
            let part = at(cell);
            render(&part, &["--tiles", "3x2", "--sub-camera", cell]);
            arguments.push(part.into());
        }
        arguments.extend(arguments!["-o", at("stitched")]);
        succeed(arguments);
        assert!(
            bytes(&at("stitched")) == bytes(&at("whole")),
            "{extension}: stitched is not whole"
        );

        // A part that is missing, and a part of another view.
        let stitch = |parts: &[&str]| {
            let mut arguments = arguments!["stitch"];
            arguments.extend(parts.iter().map(|part| OsString::from(at(part))));
            arguments.extend(arguments!["-o", at("bad")]);
            refuse(1, arguments);
            assert!(!at("bad").exists());
        };
        stitch(&["0,0", "1,0", "2,0", "0,1", "1,1"]);
        render(
            &at("other"),
            &[
                "--tiles",
                "3x2",
                "--sub-camera",
                "2,1",
                "--cull",
                "back",
                "--mode",
                "depth",
            ],
        );
        stitch(&["0,0", "1,0", "2,0", "0,1", "1,1", "whole"]);
        stitch(&["0,0", "0,0", "1,0", "2,0", "0,1", "1,1", "2,1"]);
        stitch(&["0,0", "1,0", "2,0", "0,1", "1,1", "other"]);

        // One pixel painted over, with every checksum of the format's own made right.
        let part = at("2,1");
        let file = ImageFile::decode(&bytes(&part)).expect("a fragment");
        assert_eq!(file.full_size(), (203, 151));
        repaint(&part);
        let parts = ["0,0", "1,0", "2,0", "0,1", "1,1", "2,1"];
        let mut arguments = arguments!["stitch"];
        arguments.extend(parts.map(|part| OsString::from(at(part))));
        arguments.extend(arguments!["-o", at("bad")]);
        let line = refuse(1, arguments);
        assert!(
            line.contains("its pixels are not those that were written"),
            "{line}"
        );
    }
}

/// Changes one pixel of an image file, as a program would that knows nothing of RayCast's own words in it
/// but keeps them.
fn repaint(path: &Path) {
    if path.extension().is_some_and(|extension| extension == "exr") {
        use exr::prelude::*;
        let mut image = read_first_flat_layer_from_file(path).expect("an EXR");
        for channel in &mut image.layer_data.channel_data.list {
            if let (true, FlatSamples::F32(values)) =
                (channel.name.eq("G"), &mut channel.sample_data)
            {
                values[7] += 0.25;
            }
        }
        image.write().to_file(path).expect("writes");
        return;
    }
    let file = bytes(path);
    let mut reader = png::Decoder::new(std::io::Cursor::new(&file))
        .read_info()
        .expect("a PNG");
    let mut samples = vec![0; reader.output_buffer_size().expect("a size")];
    reader.next_frame(&mut samples).expect("a PNG");
    samples[7] ^= 1;
    let info = reader.info();
    let mut encoder = png::Encoder::new(
        std::fs::File::create(path).expect("writes"),
        info.width,
        info.height,
    );
    encoder.set_color(info.color_type);
    encoder.set_depth(info.bit_depth);
    for chunk in &info.uncompressed_latin1_text {
        let (keyword, text) = (chunk.keyword.clone(), chunk.text.clone());
        encoder.add_text_chunk(keyword, text).expect("text");
    }
    let mut writer = encoder.write_header().expect("writes");
    writer.write_image_data(&samples).expect("writes");
}

/// Two processors that share a picture's tiles make one picture: glibc chooses its sines by processor,
/// and is told here to do without fused multiply-add; the casting loops without their vectors.
#[cfg(target_os = "linux")]
#[test]
fn fragments_of_two_processors_stitch() {
    let folder = folder();
    let scene = asset("demo.raycast.toml");
    // At the first ones the two sines of glibc 2.36 are a last bit apart.
    let yaws = [
        342.0, 297.0, 256.4, 236.6, 26.2, 136.3, -26.2, -297.0, 40.0, 80.0, 120.0, 200.0,
    ];
    for (index, yaw) in yaws.into_iter().enumerate() {
        let orbit = format!("{yaw},{}", 7 * index as i32 - 40);
        let fov = (20 + index).to_string();
        let at = |name: &str| folder.path().join(format!("{name}.png"));
        let command = |output: &str, more: &[&str]| {
            let mut arguments = arguments!["render", &scene, "-o", at(output)];
            let view = ["--size", "64x48", "--orbit", &orbit, "--fov", &fov];
            arguments.extend(view.iter().chain(more).map(OsString::from));
            command(arguments)
        };
        let done = |mut command: Command| {
            let told = run(&mut command);
            assert_eq!(told.status, Some(0), "{orbit}: {}", told.errors);
        };
        done(command("whole", &[]));
        done(command("left", &["--tiles", "2x1", "--sub-camera", "0,0"]));
        let mut other = command("right", &["--tiles", "2x1", "--sub-camera", "1,0"]);
        other
            .env("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2")
            .env("RAYCAST_SIMD", "plain");
        done(other);
        succeed(arguments![
            "stitch",
            at("left"),
            at("right"),
            "-o",
            at("stitched")
        ]);
        assert!(
            bytes(&at("stitched")) == bytes(&at("whole")),
            "{orbit}: stitched is not whole"
        );
    }
}

/// The channels that the format promises, with the truth in them.
#[test]
fn exr_holds_depth_and_numbers() {
    use exr::prelude::*;
    let folder = folder();
    let output = folder.path().join("a.exr");
    let mesh = asset("cube.obj");
    succeed(arguments![
        "render", &mesh, "-o", &output, "--size", "48x40", "--eye", "0,0,5", "--target", "0,0,0"
    ]);
    let image = read_first_flat_layer_from_file(&output).expect("an EXR");
    let channel = |name: &str| {
        let channels = &image.layer_data.channel_data.list;
        let found = channels.iter().find(|channel| channel.name.eq(name));
        &found
            .unwrap_or_else(|| panic!("no channel {name}"))
            .sample_data
    };
    for name in ["R", "G", "B", "A", "N.X", "N.Y", "N.Z", "uv.U", "uv.V"] {
        assert_eq!(channel(name).len(), 48 * 40, "{name}");
    }
    let (FlatSamples::F32(depth), FlatSamples::U32(object), FlatSamples::U32(triangle)) =
        (channel("Z"), channel("id.object"), channel("id.triangle"))
    else {
        panic!("Z must be 32-bit floats, id.object and id.triangle 32-bit unsigned");
    };
    assert_eq!(
        (depth[0], object[0], triangle[0]),
        (f32::INFINITY, u32::MAX, u32::MAX)
    );
    let middle = 20 * 48 + 24;
    assert!(
        depth[middle] > 1.0 && depth[middle] < 5.0,
        "{}",
        depth[middle]
    );
    assert_eq!(object[middle], 0);
    assert!(triangle[middle] < 12);
}

#[test]
fn other_kinds_of_image_are_written() {
    let folder = folder();
    for (name, start) in [
        ("a.ppm", &b"P6"[..]),
        ("a.jpg", b"\xff\xd8"),
        ("a.PNG", b"\x89PNG"),
    ] {
        let output = folder.path().join(name);
        succeed(arguments![
            "render",
            asset("cube.obj"),
            "-o",
            &output,
            "--size",
            "40x30"
        ]);
        assert!(bytes(&output).starts_with(start), "{name}");
    }
    assert_eq!(names(folder.path()).len(), 3, "nothing else is left behind");
}

// Errors.

/// A render that must be refused: one line that names `named`, and no file left.
fn refuse_render(status: i32, mesh: &Path, more: &[&str], named: &str) {
    let folder = folder();
    let mut arguments = arguments!["render", mesh, "-o", folder.path().join("a.png")];
    arguments.extend(more.iter().map(OsString::from));
    let line = refuse(status, arguments);
    assert!(line.contains(named), "{line:?} does not say {named:?}");
    assert!(names(folder.path()).is_empty(), "{more:?}: a file was left");
}

fn write(folder: &TempDir, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("a temporary file can be written");
    path
}

#[test]
fn bad_files_are_one_line_and_exit_1() {
    let folder = folder();
    refuse_render(1, &folder.path().join("none.obj"), &[], "none.obj");
    refuse_render(1, folder.path(), &[], &folder.path().display().to_string());
    for name in ["empty.obj", "empty.txt", "empty"] {
        refuse_render(1, &write(&folder, name, b""), &[], name);
    }
    let picture = bytes(&asset("leopard.png"));
    for name in ["picture.obj", "picture.txt", "picture.png", "picture"] {
        refuse_render(1, &write(&folder, name, &picture), &[], name);
    }
    for (name, text, place) in [
        (
            "vertices.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\n",
            "vertices.obj",
        ),
        ("cut.obj", "v 0 0 0\nv 1 0 0\nv 0 1", "cut.obj:3"),
        (
            "word.obj",
            "v 0 0 0\nv 1 0 zero\nv 0 1 0\nf 1 2 3\n",
            "word.obj:2",
        ),
        (
            "face.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 x\n",
            "face.obj:4",
        ),
        (
            "cut.txt",
            "(0,0,0);(1,0,0);(0,1,0)\n(0,0,0);(1,0,0);(0,",
            "cut.txt:2",
        ),
        ("two.txt", "(0,0,0);(1,0,0)\n", "two.txt:1"),
        ("bad.raycast.toml", "[camera\n", "bad.raycast.toml:1"),
    ] {
        refuse_render(1, &write(&folder, name, text.as_bytes()), &[], place);
    }
}

/// A file that ends anywhere: a picture, or one line; never a panic, and no file left with an error.
#[test]
fn a_mesh_cut_anywhere_is_a_picture_or_one_line() {
    let whole = bytes(&asset("cube.obj"));
    let folder = folder();
    let mut random = Random::new(5);
    let mut refused = 0;
    for _ in 0..25 {
        let length = random.below(whole.len() as u32) as usize;
        let mesh = write(&folder, "cut.obj", &whole[..length]);
        let output = folder.path().join("a.png");
        let mut command = command(arguments![
            "render", &mesh, "-o", &output, "--size", "16x16"
        ]);
        let told = run(&mut command);
        match told.status {
            Some(0) => std::fs::remove_file(&output).expect("a picture"),
            Some(1) => {
                refused += 1;
                let place = mesh.display().to_string();
                assert_eq!(told.errors.lines().count(), 1, "{length}: {}", told.errors);
                assert!(told.errors.contains(&place), "{length}: {}", told.errors);
                assert!(!output.exists(), "{length}");
            }
            status => panic!("{length}: {status:?}: {}", told.errors),
        }
    }
    assert!(refused > 5, "{refused}");
}

#[test]
fn bad_usage_is_one_line_and_exits_2() {
    let mesh = asset("cube.obj");
    for (more, named) in [
        (&["--size", "0x5"][..], "0x5"),
        (&["--size", "5x0"], "5x0"),
        (&["--size", "-5x5"], "-5"),
        (&["--size", "99999999x5"], "size"),
        (
            &["--size", "100x100", "--step", "0.5", "--fov", "10"],
            "odds",
        ),
        (&["--step", "0"], "step"),
        (&["--step", "nan"], "step"),
        (&["--fov", "180"], "fov"),
        (&["--eye", "1,2"], "eye"),
        (&["--mode", "beautiful"], "beautiful"),
        (&["--tiles", "3x2", "--tile-size", "5"], "tile"),
        (&["--tiles", "3x2", "--sub-camera", "3,0"], "3,0"),
        (&["--sub-camera", "0,0"], "tile"),
        (&["--threads", "many"], "many"),
        (&["--frobnicate"], "frobnicate"),
    ] {
        refuse_render(2, &mesh, more, named);
    }
    refuse(2, ["render"]);
    refuse(2, arguments!["render", &mesh]);
    let folder = folder();
    let line = refuse(
        2,
        arguments!["render", &mesh, "-o", folder.path().join("a.gif")],
    );
    assert!(line.contains("a.gif"), "{line}");
    assert!(names(folder.path()).is_empty());
}

#[test]
fn outputs_that_cannot_be_are_one_line_and_exit_1() {
    let mesh = asset("cube.obj");
    let folder = folder();
    let taken = folder.path().join("taken.png");
    std::fs::create_dir(&taken).expect("a folder can be made");
    let mut places = vec![folder.path().join("none").join("a.png"), taken];
    if cfg!(target_os = "linux") {
        // Even the superuser makes no file there.
        places.push("/proc/a.png".into());
    }
    for place in places {
        let line = refuse(
            1,
            arguments!["render", &mesh, "-o", &place, "--size", "8x8"],
        );
        assert!(line.contains(&place.display().to_string()), "{line}");
    }
    assert_eq!(names(folder.path()), ["taken.png"]);
}

/// An output that is an input would lose the mesh.
#[test]
fn an_input_is_not_overwritten() {
    let folder = folder();
    let mesh = write(&folder, "mesh.png", &bytes(&asset("cube.obj")));
    let mut command = command(arguments!["render", &mesh, "-o", &mesh, "--size", "8x8"]);
    let told = run(&mut command);
    assert!(told.status == Some(1) || told.status == Some(2), "{told:?}");
    assert!(bytes(&mesh) == bytes(&asset("cube.obj")));
}

/// Without a display the window cannot open: one line that names what works.
#[cfg(target_os = "linux")]
#[test]
fn without_a_display_the_window_says_what_to_do() {
    for arguments in [vec![], arguments!["view"], arguments![asset("cube.obj")]] {
        let mut command = command(arguments);
        command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
        command.env_remove("WAYLAND_SOCKET");
        let told = run(&mut command);
        assert_eq!(told.status, Some(1), "{told:?}");
        assert_eq!(told.errors.lines().count(), 1, "{told:?}");
        assert!(told.errors.contains("raycast render"), "{told:?}");
    }
}

/// Every command that builds a tree takes the instruction set from the environment, and refuses one
/// that there is not.
#[test]
fn the_instruction_set_is_forced_everywhere() {
    let mesh = asset("cube.obj");
    let folder = folder();
    let place = |name: &str| folder.path().join(name);
    let rays = place("rays");
    write_rays(&rays, &[[0.0, 0.0, 9.0, 0.0, 0.0, 0.0, -1.0, 1e9]]);
    let commands = [
        arguments![],
        arguments!["view", &mesh],
        arguments!["render", &mesh, "-o", place("a.png"), "--size", "8x8"],
        arguments!["cast", &mesh, "--rays", &rays, "--hits", place("h")],
        arguments!["info", &mesh],
        arguments!["bench", &mesh, "--frames", "1"],
        arguments!["verify", &mesh, "--size", "8x8"],
        arguments!["report", &mesh, "-o", place("report"), "--quick"],
    ];
    for arguments in commands {
        let mut command = command(&arguments);
        let told = run(command.env("RAYCAST_SIMD", "mmx"));
        assert_eq!(told.status, Some(2), "{arguments:?}: {told:?}");
        assert_eq!(told.errors.lines().count(), 1, "{told:?}");
        let named = told.errors.contains("RAYCAST_SIMD: expected plain or avx2");
        assert!(named && told.errors.contains("mmx"), "{told:?}");
    }
    let mut bench = command(arguments!["bench", &mesh, "--frames", "1", "--size", "8x8"]);
    let told = run(bench.env("RAYCAST_SIMD", "plain"));
    assert_eq!(json(&told.output)[0]["simd"], "plain");
    let mut verify = command(arguments!["verify", &mesh, "--size", "64x64"]);
    assert_eq!(run(verify.env("RAYCAST_SIMD", "plain")).status, Some(0));
}

// Rays and hits.

/// A ray as the file holds it.
type FileRay = [f32; 8];

fn write_rays(path: &Path, rays: &[FileRay]) {
    let bytes: Vec<u8> = rays
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    std::fs::write(path, bytes).expect("a temporary file can be written");
}

/// t, object, triangle, u, v.
fn read_hits(path: &Path) -> Vec<(f32, u32, u32, f32, f32)> {
    let bytes = bytes(path);
    assert_eq!(bytes.len() % 20, 0, "hits of 20 bytes");
    let hits = bytes.chunks_exact(20);
    hits.map(|hit| {
        let word = |i: usize| [hit[4 * i], hit[4 * i + 1], hit[4 * i + 2], hit[4 * i + 3]];
        (
            f32::from_le_bytes(word(0)),
            u32::from_le_bytes(word(1)),
            u32::from_le_bytes(word(2)),
            f32::from_le_bytes(word(3)),
            f32::from_le_bytes(word(4)),
        )
    })
    .collect()
}

fn random_rays(stage: &Stage, count: usize) -> Vec<FileRay> {
    let (center, radius) = stage.scene.bounding_sphere();
    let mut random = Random::new(count as u64);
    (0..count)
        .map(|i| {
            let origin = (center + random.direction() * radius * 2.0).as_vec3();
            let target = match i % 3 {
                0 => (center + random.in_cube() * radius).as_vec3(),
                _ => {
                    let primitive = random.below(stage.accel.len() as u32);
                    let corner = stage.accel.corners(primitive)[i % 2].as_dvec3();
                    (stage.accel.origin() + corner).as_vec3()
                }
            };
            let direction = target - origin;
            let Vec3 { x, y, z } = origin;
            let [dx, dy, dz] = direction.to_array();
            [x, y, z, 0.0, dx, dy, dz, f32::MAX]
        })
        .collect()
}

/// `cast` answers what exact arithmetic answers.
fn assert_cast_is_exact(mesh: &Path, count: usize) {
    let folder = folder();
    let (rays_path, hits_path) = (folder.path().join("rays"), folder.path().join("hits"));
    let read = read_mesh(mesh, &|_| ()).unwrap_or_else(|error| panic!("{error}"));
    let stage = Stage::of([read]);
    let rays = random_rays(&stage, count);
    write_rays(&rays_path, &rays);
    succeed(arguments![
        "cast", mesh, "--rays", &rays_path, "--hits", &hits_path
    ]);
    let hits = read_hits(&hits_path);
    assert_eq!(hits.len(), rays.len());
    let mut met = 0;
    for (file_ray, &(t, object, triangle, u, v)) in rays.iter().zip(&hits) {
        let [x, y, z, t_min, dx, dy, dz, t_max] = file_ray.map(f64::from);
        let ray = Ray {
            origin: DVec3::new(x, y, z),
            direction: DVec3::new(dx, dy, dz),
            t_min,
            t_max,
        };
        let Some(truth) = stage.truth(&ray, Cull::None) else {
            assert_eq!((t, object, triangle), (f32::INFINITY, u32::MAX, u32::MAX));
            continue;
        };
        met += 1;
        assert_eq!(
            (object, triangle),
            (truth.object, truth.triangle),
            "{ray:?}"
        );
        if truth.cosine > 0.1 {
            let bound = 4.0 * 2f64.powi(-23);
            assert!((f64::from(t) - truth.t).abs() <= bound * truth.t, "{ray:?}");
            let error = (f64::from(u) - truth.u)
                .abs()
                .max((f64::from(v) - truth.v).abs());
            assert!(error <= bound, "{ray:?}");
        }
    }
    println!("{}: {count} rays, {met} hits, none wrong", mesh.display());
    assert!(met > count / 2, "only {met} of {count} hit");
}

/// `verify` passes what `render` wrote, and finds one pixel that was changed by hand.
#[test]
fn a_wrong_pixel_is_found() {
    let folder = folder();
    let mesh = asset("monkey.obj");
    let view = ["--size", "150x110", "--orbit", "40,10"].map(OsString::from);
    for projection in ["perspective", "orthographic"] {
        let path = folder.path().join("picture.exr");
        let with_view = |mut arguments: Vec<OsString>| {
            arguments.extend(view.iter().cloned());
            arguments.extend(arguments!["--projection", projection]);
            arguments
        };
        succeed(with_view(arguments!["render", &mesh, "-o", &path]));
        let told = succeed(with_view(arguments!["verify", &path, &mesh]));
        let text = String::from_utf8(told.output).expect("a report is UTF-8");
        assert!(
            text.starts_with("16500 of 16500 pixels checked: "),
            "{text}"
        );
        assert!(text.ends_with("0 wrong: every pixel shows what its ray meets first\n"));

        let good = Picture::decode_exr(&bytes(&path)).expect("an EXR");
        let triangles = &good.layers.as_ref().expect("an EXR has layers").triangle;
        // Where the mesh ends: a miss to the left.
        let is_silhouette = |&i: &usize| triangles[i - 1] == u32::MAX && triangles[i] != u32::MAX;
        let at = (1..triangles.len())
            .find(is_silhouette)
            .expect("a silhouette");
        for leak in [false, true] {
            let mut bad = good.clone();
            let layers = bad.layers.as_mut().expect("an EXR has layers");
            if leak {
                layers.object[at] = u32::MAX;
                layers.triangle[at] = u32::MAX;
                layers.depth[at] = f32::INFINITY;
            } else {
                layers.triangle[at] ^= 1;
            }
            std::fs::write(&path, bad.encode(Format::Exr).expect("encodes")).expect("writes");
            let told = run(&mut command(with_view(arguments!["verify", &path, &mesh])));
            assert_eq!(told.status, Some(1), "{}", told.errors);
            assert!(told.errors.contains("1 of 16500 pixels checked are wrong"));
            let text = String::from_utf8(told.output).expect("a report is UTF-8");
            let (column, row) = (at % 150, at / 150);
            assert!(
                text.contains(&format!("column {column}, row {row}: ")),
                "{text}"
            );
        }
    }
}

/// A picture whose colours, or normals, or texture coordinates were painted over is found out, in an EXR
/// and in a PNG, and nothing need be said of its camera or its shading.
#[test]
fn a_repainted_picture_is_found() {
    let folder = folder();
    let mesh = asset("monkey.obj");
    for (mode, samples) in [("smooth", "1"), ("flat", "3"), ("normals", "1")] {
        let exr = folder.path().join("picture.exr");
        let png = folder.path().join("picture.png");
        for path in [&exr, &png] {
            let view = ["--size", "90x70", "--orbit", "40,10", "--fov", "30"];
            let mut arguments = arguments!["render", &mesh, "-o", path];
            arguments.extend(view.map(OsString::from));
            arguments.extend(["--mode", mode, "--samples", samples].map(OsString::from));
            succeed(arguments);
            let told = succeed(arguments!["verify", path, &mesh, "--all"]);
            let text = String::from_utf8(told.output).expect("a report is UTF-8");
            assert!(text.starts_with("6300 of 6300 pixels checked"), "{text}");
            assert!(text.contains("colour at "), "{text}");
            assert!(text.contains("0 wrong: every "), "{text}");
        }
        let refused = |path: &Path, count: Option<usize>| {
            let told = run(&mut command(arguments!["verify", path, &mesh, "--all"]));
            assert_eq!(told.status, Some(1), "{}", told.errors);
            if let Some(count) = count {
                let expected = format!("{count} of 6300 pixels checked are wrong");
                assert!(told.errors.contains(&expected), "{}", told.errors);
            } else {
                assert!(told.errors.contains("are wrong"), "{}", told.errors);
            }
        };
        let ImageFile {
            picture, recipe, ..
        } = ImageFile::decode(&bytes(&exr)).expect("an EXR");
        let write = |picture: &Picture, format: Format, path: &Path| {
            let bytes = picture.encode_with(format, recipe.as_ref());
            std::fs::write(path, bytes.expect("encodes")).expect("writes");
        };
        // A stroke across the middle.
        let row = 35 * 90..36 * 90;
        let mut bad = picture.clone();
        let layers = bad.layers.as_mut().expect("an EXR has layers");
        layers.color[row.clone()].fill([0.5, 0.1, 0.9, 1.0]);
        write(&bad, Format::Exr, &exr);
        refused(&exr, Some(90));
        let mut bad = picture.clone();
        let layers = bad.layers.as_mut().expect("an EXR has layers");
        layers.normal[row.clone()].fill([0.6, 0.8, 0.0]);
        write(&bad, Format::Exr, &exr);
        refused(&exr, None);
        let mut bad = picture.clone();
        bad.layers = None;
        bad.pixels[row].fill([120, 40, 200, 255]);
        write(&bad, Format::Png, &png);
        refused(&png, None);
    }
}

/// What a picture was made of is told at once, before a pixel is looked at.
#[test]
fn a_picture_of_something_else_is_refused() {
    let folder = folder();
    let (mesh, other) = (asset("monkey.obj"), asset("cube.obj"));
    for name in ["picture.exr", "picture.png", "part.png"] {
        let path = folder.path().join(name);
        let mut arguments = arguments!["render", &mesh, "-o", &path, "--size", "60x40"];
        arguments.extend(["--orbit", "40,10", "--color", "#aa3355"].map(OsString::from));
        if name == "part.png" {
            arguments.extend(["--tiles", "2x2", "--sub-camera", "1,1"].map(OsString::from));
        }
        succeed(arguments);
        let verify = |mesh: &Path, more: &[&str]| {
            let mut arguments = arguments!["verify", &path, mesh];
            arguments.extend(more.iter().map(OsString::from));
            arguments
        };
        let color = ["--color", "#aa3355"];
        succeed(verify(&mesh, &color));
        succeed(verify(
            &mesh,
            &[&color[..], &["--orbit", "40,10", "--mode", "smooth"]].concat(),
        ));
        for (mesh, more, expected) in [
            (&other, &[][..], "another scene"),
            (&mesh, &[], "another scene"),
            (&other, &["--color", "#aa3355"], "another scene"),
            (
                &mesh,
                &["--color", "#aa3355", "--orbit", "41,10"],
                "another camera (",
            ),
            (
                &mesh,
                &["--color", "#aa3355", "--mode", "flat"],
                "other settings (mode = \"smooth\", not mode = \"flat\")",
            ),
            (
                &mesh,
                &["--color", "#aa3355", "--samples", "2"],
                "other settings (samples = 1, not samples = 2)",
            ),
        ] {
            let line = refuse(1, verify(mesh, more));
            assert!(line.contains(expected) && line.contains(name), "{line}");
        }
    }
}

/// The recipe is the same however a picture is split, from whatever folder, by however many threads.
#[test]
fn recipes_hang_on_nothing_but_the_picture() {
    let folder = folder();
    let copy = folder.path().join("another name.obj");
    std::fs::write(&copy, bytes(&asset("torus.obj"))).expect("writes");
    std::fs::write(folder.path().join("torus.mtl"), bytes(&asset("torus.mtl"))).expect("writes");
    let mut whole = Vec::new();
    for (mesh, more) in [
        (&asset("torus.obj"), &["--threads", "1"][..]),
        (&copy, &["--threads", "2", "--tiles", "3x2"]),
    ] {
        let path = folder.path().join("picture.png");
        let mut arguments = arguments!["render", mesh, "-o", &path, "--size", "60x40"];
        arguments.extend(more.iter().map(OsString::from));
        succeed(arguments);
        whole.push(bytes(&path));
    }
    assert!(whole[0] == whole[1]);
    let recipe = ImageFile::decode(&whole[0]).expect("a PNG").recipe;
    let text = recipe.expect("a render tells its recipe").to_string();
    assert!(!text.contains("torus") && !text.contains("name"), "{text}");
}

/// What needs more memory than there is is refused before it is begun, with the figures; no process is
/// ended half-way.
#[cfg(target_os = "linux")]
#[test]
fn pictures_beyond_memory_are_refused() {
    let folder = folder();
    // Files of one piece: a JPEG, and fragments. Others are made in bands.
    let fragment = ["--tiles", "1x1", "--sub-camera", "0,0"];
    for (name, size, more) in [
        ("a.exr", "16384x16384", &fragment[..]),
        ("a.png", "32768x32768", &fragment),
        ("a.jpg", "32768x32768", &[]),
    ] {
        let output = folder.path().join(name);
        let mut shell = Command::new("sh");
        shell.arg("-c").arg("ulimit -v 1000000; exec \"$0\" \"$@\"");
        shell.arg(raycast_tests::binary::path());
        shell.args(arguments!["render", asset("cube.obj"), "-o", &output]);
        shell.args(["--size", size, "--threads", "2"]).args(more);
        let told = run(&mut shell);
        assert_eq!(told.status, Some(1), "{name}: {}", told.errors);
        let line = &told.errors;
        assert_eq!(line.lines().count(), 1, "{line}");
        for expected in [size, "GiB of memory", "ulimit -v", "would fit"] {
            assert!(line.contains(expected), "{expected}: {line}");
        }
        assert!(names(folder.path()).is_empty(), "{name}: a file was left");
    }
}

#[test]
fn verify_renders_where_there_is_no_image_and_takes_fragments() {
    let folder = folder();
    let scene = asset("demo.raycast.toml");
    let checks = ["--checks", "3000", "--seed", "7"];
    let mut arguments = arguments!["verify", &scene];
    arguments.extend(checks.map(OsString::from));
    let first = succeed(&arguments).output;
    assert_eq!(first, succeed(&arguments).output);
    let text = String::from_utf8(first).expect("a report is UTF-8");
    assert!(
        text.starts_with("3000 of 921600 pixels checked: "),
        "{text}"
    );
    assert!(text.contains("0 wrong of 3000: "), "{text}");

    let part = folder.path().join("part.exr");
    let split = ["--tiles", "4x3", "--sub-camera", "2,1"].map(OsString::from);
    let mut render = arguments!["render", &scene, "-o", &part];
    render.extend(split);
    succeed(render);
    succeed(arguments!["verify", &part, &scene, "--checks", "2000"]);
    // From elsewhere it is not what the rays meet.
    let elsewhere = arguments!["verify", &part, &scene, "--orbit", "80,10"];
    let told = run(&mut command(elsewhere));
    assert_eq!(told.status, Some(1), "{}", told.errors);
}

#[test]
fn what_cannot_be_verified_is_refused() {
    let folder = folder();
    let mesh = asset("cube.obj");
    let picture = folder.path().join("picture.exr");
    succeed(arguments![
        "render", &mesh, "-o", &picture, "--size", "40x30"
    ]);
    let size = refuse(2, arguments!["verify", &picture, &mesh, "--size", "41x30"]);
    assert!(size.contains("40x30") && size.contains("41x30"), "{size}");
    refuse(2, arguments!["verify", &picture]);
    refuse(2, arguments!["verify", &picture, &picture, &mesh]);
    refuse(2, arguments!["verify", &mesh, "--checks", "0"]);
    let text = folder.path().join("text.exr");
    std::fs::write(&text, "no image").expect("writes");
    refuse(1, arguments!["verify", &text, &mesh]);
    refuse(
        1,
        arguments!["verify", folder.path().join("none.exr"), &mesh],
    );
}

#[test]
fn cast_is_exact_on_the_demo_assets() {
    for name in ["cube.obj", "monkey.obj", "dahlia.obj"] {
        assert_cast_is_exact(&asset(name), 20_000);
    }
}

#[test]
fn cast_is_exact_on_real_meshes() {
    for mesh in models::meshes() {
        assert_cast_is_exact(&mesh, 30_000);
    }
}

#[test]
fn rays_that_are_no_rays_are_counted_misses() {
    let folder = folder();
    let (rays_path, hits_path) = (folder.path().join("rays"), folder.path().join("hits"));
    let good: FileRay = [0.1, 0.2, 9.0, 0.0, 0.0, 0.0, -1.0, 1e30];
    let mut rays = vec![good];
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for place in 0..8 {
            // A ray that ends nowhere is an ordinary one.
            if (bad, place) != (f32::INFINITY, 7) {
                let mut ray = good;
                ray[place] = bad;
                rays.push(ray);
            }
        }
    }
    let mut still = good;
    still[6] = 0.0;
    let mut endless = good;
    endless[7] = f32::INFINITY;
    rays.extend([still, endless]);
    write_rays(&rays_path, &rays);
    let told = succeed(arguments![
        "cast",
        asset("cube.obj"),
        "--rays",
        &rays_path,
        "--hits",
        &hits_path
    ]);
    assert!(told.errors.contains("24 of 26"), "{}", told.errors);
    let hits = read_hits(&hits_path);
    assert_eq!(hits.len(), rays.len());
    let (first, last) = (hits[0], hits[rays.len() - 1]);
    assert!(first.0.is_finite() && first == last);
    for hit in &hits[1..rays.len() - 1] {
        assert_eq!((hit.0, hit.1, hit.2), (f32::INFINITY, u32::MAX, u32::MAX));
        assert!(hit.3 == 0.0 && hit.4 == 0.0);
    }
}

#[test]
fn bad_ray_files_are_one_line_and_leave_no_hits() {
    let folder = folder();
    let hits = folder.path().join("hits");
    let cast = |rays: &Path| {
        let mesh = asset("cube.obj");
        let line = refuse(1, arguments!["cast", mesh, "--rays", rays, "--hits", &hits]);
        assert!(line.contains(&rays.display().to_string()), "{line}");
        assert!(!hits.exists());
    };
    cast(&folder.path().join("none"));
    cast(&write(&folder, "truncated", &[0; 32 * 3 + 5]));
    cast(folder.path());
    // No rays at all are no error.
    let none = write(&folder, "no-rays", b"");
    succeed(arguments![
        "cast",
        asset("cube.obj"),
        "--rays",
        none,
        "--hits",
        &hits
    ]);
    assert_eq!(bytes(&hits).len(), 0);
}

// JSON.

fn json(bytes: &[u8]) -> Value {
    serde_json::from_slice(bytes)
        .unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(bytes)))
}

#[test]
fn stats_have_their_keys() {
    let folder = folder();
    let rays = folder.path().join("rays");
    write_rays(&rays, &[[0.0, 0.0, 9.0, 0.0, 0.0, 0.0, -1.0, 1e9]; 10]);
    let mesh = asset("cube.obj");
    let render = arguments![
        "render",
        &mesh,
        "-o",
        folder.path().join("a.png"),
        "--size",
        "30x20",
        "--threads",
        "2",
        "--stats",
        "-"
    ];
    let cast = arguments![
        "cast",
        &mesh,
        "--rays",
        rays,
        "--hits",
        folder.path().join("h"),
        "--threads",
        "2",
        "--stats",
        "-"
    ];
    for (arguments, rays) in [(render, 600), (cast, 10)] {
        let stats = json(&succeed(arguments).output);
        for key in [
            "triangles",
            "dropped",
            "load_ms",
            "build_ms",
            "cast_ms",
            "shade_ms",
            "total_ms",
            "rays",
            "hits",
            "mrays_per_s",
            "threads",
            "peak_bytes",
        ] {
            assert!(stats[key].is_number(), "{key}: {stats}");
        }
        assert!(stats["simd"].is_string(), "{stats}");
        assert_eq!(stats["triangles"], 12);
        assert_eq!(stats["dropped"], 0);
        assert_eq!(stats["rays"], rays);
        assert_eq!(stats["threads"], 2);
        assert!(stats["hits"].as_u64() > Some(0), "{stats}");
    }
    let file = folder.path().join("stats.json");
    succeed(arguments![
        "render",
        &mesh,
        "-o",
        folder.path().join("b.png"),
        "--size",
        "8x8",
        "--stats",
        &file
    ]);
    assert_eq!(json(&bytes(&file))["rays"], 64);
}

#[test]
fn bench_has_its_shape() {
    let meshes = ["cube.obj", "torus.obj"].map(asset);
    let told = succeed(arguments![
        "bench",
        &meshes[0],
        &meshes[1],
        "--frames",
        "2",
        "--size",
        "64x48",
        "--threads",
        "1"
    ]);
    let figures = json(&told.output);
    let files = figures.as_array().expect("an array");
    assert_eq!(files.len(), 2);
    for (file, mesh) in files.iter().zip(&meshes) {
        let named = file["file"].as_str().expect("a name");
        assert!(mesh.display().to_string().ends_with(named) || Path::new(named) == mesh);
        assert!(file["triangles"].as_u64() >= Some(12));
        assert!(file["build_ms"].is_number());
        assert_eq!(file["threads"], 1);
        assert!(file["simd"].is_string());
        assert_eq!(file["precision"], "exact");
        let views = file["views"].as_array().expect("views");
        let names: Vec<_> = views.iter().map(|view| &view["view"]).collect();
        assert_eq!(names, ["medium", "close"]);
        for view in views {
            assert_eq!(view["rays"], 64 * 48);
            assert!(view["hits"].as_u64() > Some(100), "{view}");
            assert!(view["mrays_per_s"].is_number());
            for times in ["cast_ms", "frame_ms"] {
                let [min, median] = ["min", "median"].map(|key| view[times][key].as_f64());
                assert!(min > Some(0.0) && min <= median, "{view}");
            }
        }
    }
    let told = succeed(arguments![
        "bench", &meshes[0], "--frames", "1", "--size", "8x8", "--eye", "0,0,9"
    ]);
    let figures = json(&told.output);
    assert_eq!(figures[0]["views"][0]["view"], "given");
    assert_eq!(figures[0]["views"].as_array().map(Vec::len), Some(1));
}

#[test]
fn info_tells_what_a_file_holds() {
    let mesh = asset("cube.obj");
    let told = succeed(arguments!["info", &mesh]);
    let text = String::from_utf8(told.output).expect("UTF-8");
    assert!(text.contains("cube") && text.contains("12"), "{text}");
    let folder = folder();
    let dropped = write(
        &folder,
        "dropped.obj",
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nf 1 2 3\nf 1 1 2\nf 1 2 4\n",
    );
    let told = succeed(arguments!["info", "--json", &mesh, &dropped]);
    let files = json(&told.output);
    assert_eq!(files[0]["triangles"], 12);
    assert_eq!(files[1]["triangles"], 3);
    assert_eq!(files[1]["dropped"]["zero_area"], 1);
    assert_eq!(files[1]["dropped"]["not_finite"], 1);
    refuse(1, arguments!["info", folder.path().join("none.obj")]);
}

#[test]
fn help_and_version_go_to_output() {
    for (argument, said) in [("--help", "raycast render"), ("--version", "raycast")] {
        let told = succeed([argument]);
        assert!(String::from_utf8_lossy(&told.output).contains(said));
        assert!(told.errors.is_empty(), "{}", told.errors);
    }
}

// The report.

#[test]
fn a_report_can_be_read_by_people_and_programs() {
    let folder = folder();
    let report = folder.path().join("new/report");
    succeed(arguments![
        "report",
        asset("cube.obj"),
        "-o",
        &report,
        "--quick"
    ]);
    let text = String::from_utf8(bytes(&report.join("report.md"))).expect("text");
    assert!(report.join(".raycast-report").is_file());
    for way in [
        "RayCast tiles, exact",
        "RayCast tiles, fast",
        "RayCast single rays, exact",
        "RayCast single rays, fast",
        "plane, then inside, f32",
        "plane, then inside, f64",
        "Möller–Trumbore, f32",
        "Möller–Trumbore, f64",
        "watertight, f32",
        "obvhs BVH2, f32",
        "obvhs CWBVH, f32",
        "Embree",
    ] {
        assert!(text.contains(way), "{way} is missing");
    }
    let (mut tables, mut pictures) = (0, 0);
    for name in names(&report) {
        let path = report.join(&name);
        let name = name.to_string_lossy().into_owned();
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("csv") => {
                let told = String::from_utf8(bytes(&path)).expect("text");
                let mut reader = csv::Reader::from_reader(told.as_bytes());
                assert!(reader.headers().expect("headings").len() > 1, "{name}");
                let rows = reader
                    .records()
                    .map(|row| row.expect("as many cells as headings"));
                assert!(rows.count() > 0, "{name}");
                tables += 1;
            }
            Some("png") => {
                let picture = image::load_from_memory(&bytes(&path))
                    .expect("a PNG")
                    .into_rgb8();
                assert!(text.contains(&format!("]({name})")), "{name} is not shown");
                let first = *picture.get_pixel(0, 0);
                assert!(
                    picture.pixels().any(|&pixel| pixel != first),
                    "{name} is empty"
                );
                pictures += 1;
            }
            Some("svg") => assert!(bytes(&path).starts_with(b"<svg")),
            // The report itself, and what says that this folder holds one.
            _ => assert!(name == "report.md" || name == ".raycast-report", "{name}"),
        }
    }
    assert!(
        tables >= 3 && pictures >= 1,
        "{tables} tables, {pictures} pictures"
    );
    assert!(text.contains(&format!("raycast report {}", asset("cube.obj").display())));
    assert!(refuse(2, arguments!["report"]).contains("--output"));
    let file = folder.path().join("in the way");
    std::fs::write(&file, "a file").expect("a file");
    assert!(refuse(1, arguments!["report", "-o", &file, "--quick"]).contains("in the way"));
}
