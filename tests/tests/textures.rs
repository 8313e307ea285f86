//! Textures from outside: the same bytes however a picture is split, by options and by a scene file alike,
//! and a mesh's triangles drawn into its texture.

use raycast_core::camera::{Grid, Projection};
use raycast_core::formats::{read_mesh, read_texture};
use raycast_core::glam::DVec3;
use raycast_core::scene::{
    Color, Object, Photograph, Scene, TextureMapping, TextureProjection, Wrap,
};
use raycast_core::shade::{Filter, Mode, Shading};
use raycast_core::{Cull, Simd};
use raycast_report::cameras::camera;
use raycast_tests::arguments;
use raycast_tests::binary::{refuse, succeed};
use raycast_tests::check::{Check, Stage, on_threads, render};
use raycast_tests::files::{asset, bytes, folder};
use std::ffi::OsString;
use std::sync::Arc;

#[test]
fn splits_threads_and_instruction_sets_agree_with_every_projection_and_filter() {
    let mesh = Arc::new(read_mesh(&asset("torus.obj"), &|_| ()).expect("a mesh"));
    let leopard = read_texture(&asset("leopard.png")).expect("a texture");
    let wraps = [
        Wrap::Repeat,
        Wrap::Mirror,
        Wrap::Clamp,
        Wrap::Border(None),
        Wrap::Border(Some(Color([9, 99, 200]))),
    ];
    let filters = [Filter::Ewa, Filter::Trilinear, Filter::Bilinear];
    for (index, projection) in TextureProjection::ALL.into_iter().enumerate() {
        let texture = leopard
            .clone()
            .wrapped([wraps[index % 5], wraps[(index + 2) % 5]]);
        let object = Object {
            texture: Some(Arc::new(texture)),
            mapping: TextureMapping {
                photograph: Some(Photograph {
                    eye: DVec3::new(3.0, 2.0, -0.5),
                    target: DVec3::ZERO,
                    up: DVec3::Y,
                    fov: 30.0,
                    shift: [0.1, 0.0],
                    lens: Some([-0.1, 0.01, 0.0, 0.0, 0.0]),
                }),
                ..TextureMapping::default()
            },
            ..Object::new("torus", Arc::clone(&mesh))
        };
        let stage = Stage::from_scene(Scene {
            objects: vec![object],
        });
        let (center, radius) = stage.scene.bounding_sphere();
        let eye = center + DVec3::new(0.4, 0.7, 1.0) * radius * 2.0;
        for (at, filter) in filters.into_iter().enumerate() {
            let kind = [Projection::Perspective, Projection::Orthographic][(index + at) % 2];
            let camera = camera(eye, center, kind, (90, 70), radius * 2.0);
            let mut view = stage.view(camera, Cull::None);
            view.settings.layers = at == 2;
            view.settings.samples = [1, 3][index % 2];
            view.settings.shading = Shading {
                mode: [Mode::Smooth, Mode::Texture][at % 2],
                projection,
                filter,
                ..Shading::default()
            };
            let whole = Grid::Count {
                columns: 1,
                rows: 1,
            };
            let expected = on_threads(1, || render(&view, whole));
            for simd in Simd::available() {
                let mut view = view.clone();
                view.accel = Arc::new((*view.accel).clone().with_simd(simd));
                for (grid, threads) in [(Grid::Size(17), 2), (Grid::Size(64), 1), (whole, 2)] {
                    let picture = on_threads(threads, || render(&view, grid));
                    assert!(
                        picture == expected,
                        "{projection:?} {filter:?} {grid:?} {simd:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn options_and_a_scene_file_make_the_same_picture() {
    let folder = folder();
    let picture = |name: &str, arguments: &[&str]| {
        let output = folder.path().join(name);
        let mut all: Vec<OsString> = vec!["render".into(), "-o".into(), output.clone().into()];
        all.extend(arguments.iter().map(OsString::from));
        all.extend(["--size", "80x60", "--orbit", "30,25"].map(OsString::from));
        succeed(all);
        bytes(&output)
    };
    let (cube, leopard) = (asset("cube.obj"), asset("leopard.png"));
    let (cube, leopard) = (cube.display().to_string(), leopard.display().to_string());
    let by_options = picture(
        "a.ppm",
        &[
            &cube,
            "--texture",
            &leopard,
            "--crop",
            "10,20,200,100",
            "--wrap",
            "mirror,border:#ff0000",
            "--texture-projection",
            "cylinder",
            "--texture-center",
            "0.25,0,0",
            "--texture-up",
            "1,1,0",
            "--texture-size",
            "1,1.5",
            "--filter",
            "ewa",
        ],
    );
    let scene = folder.path().join("scene.raycast.toml");
    let text = format!(
        "[shading]\nfilter = \"ewa\"\n[[object]]\nmesh = {cube:?}\ntexture = {leopard:?}\n\
         crop = [10, 20, 200, 100]\nwrap = [\"mirror\", \"border:#ff0000\"]\n\
         texture-projection = \"cylinder\"\ntexture-center = [0.25, 0, 0]\ntexture-up = [1, 1, 0]\n\
         texture-size = [1, 1.5]\n"
    );
    std::fs::write(&scene, text).expect("a scene can be written");
    let scene = scene.display().to_string();
    assert!(picture("b.ppm", &[&scene]) == by_options);
    // An option goes before what the file says of its object.
    assert!(picture("c.ppm", &[&scene, "--texture-projection", "uv"]) != by_options);
}

#[test]
fn triangles_are_drawn_into_the_texture_within_its_crop() {
    let folder = folder();
    let leopard = asset("leopard.png");
    let map = |name: &str, more: &[&str]| {
        let output = folder.path().join(name);
        let mut all: Vec<OsString> = vec!["texture-map".into(), "-o".into(), output.clone().into()];
        all.extend(["--texture".into(), leopard.clone().into()]);
        all.extend(more.iter().map(OsString::from));
        succeed(all);
        image::open(&output).expect("a picture").into_rgb8()
    };
    let cube = asset("cube.obj").display().to_string();
    let plain = map("plain.png", &[]);
    assert_eq!(plain, image::open(&leopard).expect("an image").into_rgb8());
    let crop = ["--crop", "128,64,256,300"];
    let cropped = map("crop.png", &crop);
    let changed =
        |picture: &image::RgbImage, x, y| picture.get_pixel(x, y) != plain.get_pixel(x, y);
    for (x, y) in [(128, 200), (383, 200), (300, 64), (300, 363)] {
        assert!(changed(&cropped, x, y), "no border at {x} {y}");
    }
    assert!(!changed(&cropped, 300, 200) && !changed(&cropped, 120, 200));
    // Each side of the cube has the whole crop, cut from its bottom left to its top right.
    let all = map("all.png", &[&[&*cube], &crop[..]].concat());
    assert!(changed(&all, 256, 214) && !changed(&all, 200, 214));
    // One triangle is filled: it is below that line, or above.
    let one = map(
        "one.png",
        &[&[&*cube, "--triangle", "0"], &crop[..]].concat(),
    );
    let (below, above) = (changed(&one, 340, 340), changed(&one, 180, 90));
    assert!(below != above, "{below} {above}");

    let refused = |more: &[&str], named: &str| {
        let output = folder.path().join("none.png");
        let mut all: Vec<OsString> = vec!["texture-map".into(), "-o".into(), output.clone().into()];
        all.extend(["--texture".into(), leopard.clone().into()]);
        all.extend(more.iter().map(OsString::from));
        let line = refuse(2, all);
        assert!(line.contains(named), "{line}");
        assert!(!output.exists());
    };
    refused(&["--crop", "500,0,20,20"], "the crop leaves");
    refused(&[&*cube, "--triangle", "12"], "there are 12, from 0");
    refused(&[&*cube, "--object", "1"], "there are 1, from 0");
    refused(&["--triangle", "1"], "<FILES>");
}

/// Half a gigabyte of colour profile in half a megabyte of a PNG.
#[test]
fn a_packed_profile_takes_no_memory() {
    let folder = folder();
    let path = folder.path().join("profile.png");
    let info = {
        let mut info = png::Info::with_size(16, 16);
        info.color_type = png::ColorType::Rgb;
        info.icc_profile = Some(vec![0; 512 << 20].into());
        info
    };
    let mut file = std::fs::File::create(&path).expect("a file");
    let encoder = png::Encoder::with_info(&mut file, info).expect("an encoder");
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&[200; 16 * 16 * 3]).expect("rows");
    writer.finish().expect("an end");
    let message = succeed(arguments![
        "render",
        asset("cube.obj"),
        "--texture",
        &path,
        "--mode",
        "texture",
        "--size",
        "16x16",
        "-o",
        folder.path().join("a.png"),
        "--stats",
        "-"
    ]);
    let stats: serde_json::Value = serde_json::from_slice(&message.output).expect("JSON");
    let peak = stats["peak_bytes"].as_u64().expect("a number");
    assert!(peak < 256 << 20, "{peak}");
}
