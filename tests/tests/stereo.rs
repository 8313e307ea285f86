//! Pictures for two eyes: every pixel is the truth, every split gives the same bytes, a half is what its eye sees.

use raycast_core::Cull;
use raycast_core::camera::{
    BrownConrady, Camera, Grid, ImagePlane, Panorama, PixelFilter, Pose, Projection, Stereo,
    StereoKind,
};
use raycast_core::glam::DVec3;
use raycast_core::picture::{Picture, Recipe};
use raycast_core::render::View;
use raycast_core::scene::Color;
use raycast_core::shade::{Filter, Mode, Wireframe};
use raycast_oracle::random::Random;
use raycast_report::meshes;
use raycast_report::stage::scene_of;
use raycast_tests::binary::{refuse, succeed};
use raycast_tests::check::{Check, Stage, on_threads, render};
use raycast_tests::files::{asset, bytes, folder};
use std::ffi::OsString;
use std::time::Duration;

fn stage() -> Stage {
    let mut random = Random::new(35);
    let soup = meshes::random_soup(&mut random, 600, DVec3::ZERO, 2.0, 0.4);
    let sphere = meshes::sphere(DVec3::new(0.3, 0.2, 0.5), 0.8, 30);
    Stage::from_scene(scene_of([soup, sphere]))
}

const ALL_AROUND: Projection = Projection::Panoramic(Panorama::Equirectangular);

fn cameras() -> Vec<Camera> {
    let lens = BrownConrady::new([-0.2, 0.05, 0.01, 0.0, 0.0]).expect("finite numbers");
    let pair = |convergence| Stereo {
        kind: StereoKind::Pair,
        eye_distance: 0.4,
        convergence,
    };
    let ods = Stereo {
        kind: StereoKind::Ods,
        ..pair(None)
    };
    [
        (Projection::Perspective, pair(None), (150, 71), 0.04),
        (Projection::through(lens), pair(Some(2.0)), (150, 71), 0.04),
        (
            Projection::Panoramic(Panorama::Equidistant),
            pair(None),
            (150, 71),
            0.15,
        ),
        // With places that the panorama does not have, to its sides and beyond its poles.
        (ALL_AROUND, ods, (101, 102), 0.27),
    ]
    .map(|(projection, stereo, (columns, rows), step)| {
        let pose = Pose::towards(DVec3::new(0.7, 0.4, 4.0), DVec3::ZERO);
        let plane = ImagePlane::new(columns, rows, step).expect("a good plane");
        stereo.check(projection, Some(plane)).expect("possible");
        Camera::new(pose, projection, plane).in_stereo(Some(stereo))
    })
    .to_vec()
}

#[test]
fn every_ray_gets_the_truth() {
    let stage = stage();
    for camera in cameras() {
        let lattice = camera.whole().lattice();
        for cull in [Cull::None, Cull::Back] {
            let hits = stage.check_lattice(&lattice, cull, 5);
            assert!(hits > lattice.len() / 40, "{camera:?}: only {hits} hits");
        }
        stage.check_picture(camera, Cull::None, 5);
    }
}

/// With all that goes by an eye.
fn views(stage: &Stage) -> Vec<View> {
    let modes = [Mode::Smooth, Mode::Flat, Mode::Depth, Mode::Smooth];
    let all = cameras().into_iter().zip(modes).enumerate();
    all.map(|(index, (camera, mode))| {
        let mut view = stage.view(camera, Cull::None);
        let shading = &mut view.settings.shading;
        shading.mode = mode;
        shading.filter = Filter::Ewa;
        shading.back_faces = Some(Color([200, 40, 40]));
        shading.wireframe = (index == 1).then(Wireframe::default);
        view.settings.samples = [1, 4, 1, 3][index];
        view.settings.pixel_filter = PixelFilter::Gaussian;
        view
    })
    .collect()
}

#[test]
fn every_split_gives_the_same_bytes_and_recipes_read_back() {
    let stage = stage();
    for mut view in views(&stage) {
        let camera = view.camera;
        let expected = on_threads(1, || render(&view, Grid::Size(1000)));
        for (size, threads) in [(1, 3), (17, 2), (64, 1)] {
            let picture = on_threads(threads, || render(&view, Grid::Size(size)));
            assert!(picture == expected, "{camera:?} {size}");
        }
        // Fragments across the halves.
        let plane = camera.plane();
        let mut stitched = Picture::blank(plane.columns, plane.rows, true);
        for rect in Grid::Size(40).tiles(plane.columns, plane.rows) {
            let tile = view.render_sub_camera(camera.sub_camera(rect), &|| Duration::ZERO);
            stitched.paste(rect, &tile.pixels, tile.layers.as_ref());
        }
        assert!(stitched == expected, "{camera:?}");
        view.settings.layers = false;
        let plain = on_threads(2, || render(&view, Grid::Size(16)));
        assert!(plain.pixels == expected.pixels, "{camera:?}");

        let recipe = Recipe::of(&view);
        assert_eq!(recipe.to_string().parse::<Recipe>().expect("reads"), recipe);
        let mut other = recipe;
        other.camera = other.camera.in_stereo(None);
        let message = recipe.difference(&other).expect("they differ");
        assert!(message.contains("another"), "{message}");
    }
}

#[test]
fn verify_proves_all_pixels_and_fragments_stitch() {
    let folder = folder();
    let demo = asset("demo.raycast.toml").into_os_string();
    let words = |words: &[&str]| words.iter().map(OsString::from).collect::<Vec<_>>();
    for (number, options) in [
        "--stereo=pair --eye-distance=0.3 --size=130x51 --mode=flat",
        "--stereo=pair --eye-distance=0.3 --convergence=inf --size=130x50 --samples=2",
        "--stereo=ods --projection=equirectangular --eye-distance=0.3 --size=90x90 --eye=1.3,0.8,0.9 --target=0,0.9,0",
        "--stereo=ods --projection=equirectangular --eye-distance=0.3 --size=60x60 --eye=1.3,0.8,0.9 --target=0,0.9,0 \
         --samples=2 --mode=flat",
    ]
    .into_iter()
    .enumerate()
    {
        let at = |name: &str| folder.path().join(format!("{number}-{name}.exr"));
        let options: Vec<&str> = options.split_whitespace().collect();
        let render = |more: &[&str], output: &std::path::Path| {
            let mut line = words(&["render"]);
            line.push(demo.clone());
            line.extend(words(&options));
            line.extend(words(more));
            line.extend(["-o".into(), output.into()]);
            succeed(&line);
        };
        render(&[], &at("whole"));
        let mut stitch = words(&["stitch"]);
        for column in 0..3 {
            let part = at(&format!("part-{column}"));
            render(&["--tiles=3x1", &format!("--sub-camera={column},0")], &part);
            stitch.push(part.into());
        }
        stitch.extend(["-o".into(), at("stitched").into()]);
        succeed(&stitch);
        assert!(bytes(&at("whole")) == bytes(&at("stitched")), "{options:?}");
        let mut verify = words(&["verify"]);
        verify.extend([at("whole").into(), demo.clone(), "--all".into()]);
        succeed(&verify);
    }
    for (options, message) in [
        ("--stereo=pair", "--stereo needs --eye-distance"),
        ("--eye-distance=1", "are for pictures with --stereo"),
        (
            "--stereo=pair --eye-distance=1 --size=33x20",
            "even number of columns",
        ),
        ("--stereo=ods --eye-distance=1", "is equirectangular"),
        (
            "--stereo=pair --eye-distance=1 --projection=orthographic",
            "no eyes",
        ),
        ("--stereo=pair --eye-distance=-1", "above 0"),
    ] {
        let mut line = words(&["render"]);
        line.push(demo.clone());
        line.extend(words(&options.split_whitespace().collect::<Vec<_>>()));
        line.extend(["-o".into(), folder.path().join("refused.png").into()]);
        let refused = refuse(2, &line);
        assert!(refused.contains(message), "{options}: {refused}");
    }
}

/// Where the eye of a half stands, a camera of its own sees what that half shows.
#[test]
fn a_pairs_halves_are_pictures_from_either_side() {
    let stage = stage();
    let stereo = Stereo {
        kind: StereoKind::Pair,
        eye_distance: 0.5,
        convergence: Some(f64::INFINITY),
    };
    let pose = Pose::towards(DVec3::new(0.7, 0.4, 4.0), DVec3::ZERO);
    let plane = ImagePlane::new(160, 70, 0.04).expect("a good plane");
    let camera = Camera::new(pose, Projection::Perspective, plane);
    let both = stage.view(camera.in_stereo(Some(stereo)), Cull::None);
    let both = render(&both, Grid::default());
    for (half, side) in [-0.25, 0.25].into_iter().enumerate() {
        let aside = camera.right() * side;
        let pose = Pose {
            eye: pose.eye + aside,
            target: pose.target + aside,
            ..pose
        };
        let plane = ImagePlane {
            columns: 80,
            ..plane
        };
        let alone = Camera::new(pose, Projection::Perspective, plane);
        let alone = render(&stage.view(alone, Cull::None), Grid::default());
        let [of_both, of_one] =
            [&both, &alone].map(|picture| picture.layers.as_ref().expect("layers"));
        let differ = (0..80 * 70).filter(|at| {
            let there = at / 80 * 160 + half * 80 + at % 80;
            (of_both.object[there], of_both.triangle[there])
                != (of_one.object[*at], of_one.triangle[*at])
        });
        // The view axis from eye to target is rounded: few pixels' centres are that near to an edge.
        let count = differ.count();
        assert!(count <= 2, "{half}: {count}");
    }
}
