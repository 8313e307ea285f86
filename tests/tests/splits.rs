//! A picture is the same however it is split: in tiles, by fragments of other processes, on other processors.

use raycast_core::picture::ImageFile;
use raycast_tests::arguments;
use raycast_tests::binary::{command, refuse, run, succeed};
use raycast_tests::files::{asset, bytes, folder};
use raycast_tests::models;
use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

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
/// and is made to do without fused multiply-add here; the casting loops without their vectors.
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
            let message = run(&mut command);
            assert_eq!(message.status, Some(0), "{orbit}: {}", message.errors);
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
