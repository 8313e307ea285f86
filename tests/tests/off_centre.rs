//! Frames off the view axis, and lenses: every pixel is the truth, a shifted frame is a part of a larger one, every
//! split gives the same bytes, with every pixel filter.

use raycast_core::Cull;
use raycast_core::camera::{BrownConrady, Camera, Grid, ImagePlane, PixelFilter, Pose, Projection};
use raycast_core::glam::DVec3;
use raycast_core::picture::{Picture, Recipe};
use raycast_core::shade::{Background, Mode, Wireframe};
use raycast_oracle::random::Random;
use raycast_report::meshes;
use raycast_report::stage::scene_of;
use raycast_tests::check::{Check, Stage, on_threads, render};

fn stage() -> Stage {
    let mut random = Random::new(33);
    let soup = meshes::random_soup(&mut random, 600, DVec3::ZERO, 2.0, 0.4);
    let sphere = meshes::sphere(DVec3::new(0.3, 0.2, 0.5), 0.8, 30);
    Stage::from_scene(scene_of([soup, sphere]))
}

fn camera(projection: Projection, size: (u32, u32)) -> Camera {
    let pose = Pose::towards(DVec3::new(0.7, 0.4, 4.0), DVec3::ZERO);
    let plane = ImagePlane::new(size.0, size.1, 0.04).expect("a good plane");
    Camera::new(pose, projection, plane)
}

fn lenses() -> [Projection; 2] {
    // A barrel whose end is within the picture, and a pincushion.
    [
        [-0.9, 0.0, 0.01, -0.02, 0.0],
        [0.2, -0.05, 0.0, 0.002, 0.01],
    ]
    .map(|coefficients| Projection::through(BrownConrady::new(coefficients).expect("finite")))
}

#[test]
fn every_ray_gets_the_truth() {
    let stage = stage();
    let [barrel, pincushion] = lenses();
    for (projection, shift) in [
        (barrel, [0.0, 0.0]),
        (barrel, [0.21, -0.1]),
        (pincushion, [-0.3, 0.1]),
        (Projection::Perspective, [0.4, 0.3]),
        (Projection::Perspective, [-1.0 / 3.0, 0.1]),
        (Projection::Orthographic, [0.2, -0.123]),
    ] {
        let camera = camera(projection, (101, 87)).shifted(shift);
        for cull in [Cull::None, Cull::Back] {
            let lattice = camera.whole().lattice();
            let hits = stage.check_lattice(&lattice, cull, 5);
            assert!(hits > lattice.len() / 8, "{projection:?}: only {hits} hits");
        }
        stage.check_picture(camera, Cull::None, 5);
    }
    let barrel = camera(barrel, (101, 87));
    assert!(barrel.has_place(50.5, 43.5) && !barrel.has_place(0.5, 0.5));
    assert_eq!(barrel.ray(0.5, 0.5).direction, DVec3::ZERO);
}

#[test]
fn a_shifted_frame_is_a_part_of_a_larger_one() {
    let stage = stage();
    let render = |camera| {
        let mut view = stage.view(camera, Cull::None);
        view.settings.shading.mode = Mode::Smooth;
        view.settings.shading.wireframe = Some(Wireframe::default());
        view.settings.shading.background = Background::Transparent;
        render(&view, Grid::default())
    };
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let large = render(camera(projection, (128, 64)));
        // The right upper part, whose middle is 32 pixels to the right of the large one's middle, and 16 up.
        let small = render(camera(projection, (64, 32)).shifted([1.0, 0.5]));
        let all = |picture: &Picture, at: usize| {
            let layers = picture.layers.as_ref().expect("layers were asked for");
            let (object, triangle) = (layers.object[at], layers.triangle[at]);
            (
                object,
                triangle,
                layers.depth[at].to_bits(),
                layers.normal[at],
            )
        };
        for y in 0..32 {
            for x in 0..64 {
                let (a, b) = (y * 128 + 64 + x, y * 64 + x);
                let (large, small) = (all(&large, a), all(&small, b));
                assert_eq!(large, small, "{projection:?} {x} {y}");
            }
        }
        // Places are counted from another corner, which may round a colour the other way.
        for (row, small) in small.pixels.chunks(64).enumerate() {
            let large = &large.pixels[row * 128 + 64..][..64];
            for (a, b) in large.iter().flatten().zip(small.iter().flatten()) {
                assert!(a.abs_diff(*b) <= 1, "{projection:?}: {a} {b} in row {row}");
            }
        }
    }
}

#[test]
fn every_split_gives_the_same_bytes_and_recipes_read_back() {
    let stage = stage();
    let [barrel, pincushion] = lenses();
    let projections = [
        barrel,
        pincushion,
        Projection::Perspective,
        Projection::Orthographic,
    ];
    for ((_, filter), projection) in PixelFilter::ALL.into_iter().zip(projections) {
        let mut view = stage.view(
            camera(projection, (90, 70)).shifted([0.1, -0.2]),
            Cull::None,
        );
        view.settings.samples = 5;
        view.settings.pixel_filter = filter;
        let expected = on_threads(1, || render(&view, Grid::Size(1000)));
        for (size, threads) in [(1, 3), (17, 2), (64, 1)] {
            let picture = on_threads(threads, || render(&view, Grid::Size(size)));
            assert!(picture == expected, "{projection:?} {filter:?} {size}");
        }
        let recipe = Recipe::of(&view);
        assert_eq!(recipe.to_string().parse::<Recipe>().expect("reads"), recipe);
        let mut other = recipe;
        other.camera = other.camera.shifted([0.0; 2]);
        let message = recipe.difference(&other).expect("they differ");
        assert!(message.contains("another"), "{message}");
    }
}
