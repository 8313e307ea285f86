//! Pictures that are no plane: every pixel is the truth, every split gives the same bytes, and the six faces of
//! a cube are six perspective pictures.

use raycast_core::Cull;
use raycast_core::camera::{Camera, Grid, ImagePlane, Panorama, Pose, Projection};
use raycast_core::glam::DVec3;
use raycast_core::picture::{ImageFile, Picture, Recipe};
use raycast_core::scene::{Object, Scene, Texture};
use raycast_core::shade::{Filter, Mode, Shading, Wireframe};
use raycast_oracle::random::Random;
use raycast_report::meshes;
use raycast_tests::arguments;
use raycast_tests::binary::succeed;
use raycast_tests::check::{Check, Stage, on_threads, render};
use raycast_tests::files::{asset, bytes, folder};
use std::ffi::OsString;
use std::sync::Arc;

/// A room of hills around triangles at all sides; the eye is within.
fn stage() -> Stage {
    let mut random = Random::new(21);
    let room = meshes::cuboid(DVec3::splat(-4.0), DVec3::splat(4.0));
    let soup = meshes::random_soup(&mut random, 400, DVec3::ZERO, 3.0, 0.4);
    let sphere = meshes::sphere(DVec3::new(0.0, 2.0, 0.0), 0.7, 30);
    let mut objects: Vec<Object> = [("room", room), ("soup", soup), ("sphere", sphere)]
        .into_iter()
        .map(|(name, mesh)| Object::new(name, Arc::new(mesh)))
        .collect();
    let texels = (0..64).map(|i| {
        if (i + i / 8) % 2 == 0 {
            [255; 4]
        } else {
            [0, 0, 0, 255]
        }
    });
    objects[0].texture = Texture::new(8, 8, texels.collect()).map(Arc::new);
    Stage::from_scene(Scene { objects })
}

/// The eye, and what it looks at.
const EYE: DVec3 = DVec3::new(0.1, 0.2, -0.1);
const TARGET: DVec3 = DVec3::new(0.4, 0.1, -1.5);

fn camera(projection: Projection, fov: f64, size: (u32, u32)) -> Camera {
    let pose = Pose::towards(EYE, TARGET);
    let step = projection.frame(fov, EYE.distance(TARGET)) / f64::from(size.1);
    let plane = ImagePlane::new(size.0, size.1, step).expect("a good plane");
    Camera::new(pose, projection, plane)
}

/// All of a panorama, and a border around it.
fn whole(panorama: Panorama, rows: u32) -> Camera {
    let (columns, rows) = panorama.size(rows);
    let fov = panorama.default_fov();
    camera(Projection::Panoramic(panorama), fov, (columns + 8, rows))
}

fn all() -> impl Iterator<Item = Panorama> {
    Panorama::ALL.into_iter().map(|(_, panorama)| panorama)
}

#[test]
fn every_ray_gets_the_truth() {
    let stage = stage();
    for panorama in all() {
        let camera = whole(panorama, 60);
        for cull in [Cull::None, Cull::Back] {
            let lattice = camera.whole().lattice();
            let hits = stage.check_lattice(&lattice, cull, 7);
            assert!(hits > lattice.len() / 4, "{panorama:?}: only {hits} hits");
        }
        stage.check_picture(camera, Cull::None, 5);
    }
}

#[test]
fn every_split_gives_the_same_bytes() {
    let stage = stage();
    for (index, panorama) in all().enumerate() {
        for mode in [Mode::ALL[index], Mode::Texture] {
            let mut view = stage.view(whole(panorama, 48), Cull::None);
            view.settings.shading = Shading {
                mode,
                wireframe: (index % 2 == 1).then(Wireframe::default),
                filter: Filter::Ewa,
                ..Shading::default()
            };
            view.settings.samples = if index < 2 { 3 } else { 1 };
            let expected = on_threads(1, || render(&view, Grid::Size(1000)));
            for grid in [Grid::Size(1), Grid::Size(17), Grid::Size(64)] {
                for threads in [1, 3] {
                    let picture = on_threads(threads, || render(&view, grid));
                    assert!(picture == expected, "{panorama:?} {mode:?} {grid:?}");
                }
            }
            // Without layers a picture is shaded where it lies.
            view.settings.layers = false;
            let plain = on_threads(2, || render(&view, Grid::Size(16)));
            assert!(plain.pixels == expected.pixels, "{panorama:?} {mode:?}");
        }
    }
}

/// Which triangles a picture shows.
fn triangles(picture: &Picture) -> Vec<(u32, u32)> {
    let layers = picture.layers.as_ref().expect("layers were asked for");
    let numbers = layers.object.iter().zip(&layers.triangle);
    numbers
        .map(|(&object, &triangle)| (object, triangle))
        .collect()
}

#[test]
fn faces_of_a_cube_are_perspective_pictures_of_a_right_angle() {
    let stage = stage();
    let side = 64;
    let cross = camera(
        Projection::Panoramic(Panorama::CubeCross),
        270.0,
        (4 * side, 3 * side),
    );
    let shown = triangles(&render(&stage.view(cross, Cull::None), Grid::default()));
    let (right, up, forward) = (cross.right(), cross.up(), cross.forward());
    for (column, row, way, top) in [
        (1, 1, forward, up),
        (2, 1, right, up),
        (3, 1, -forward, up),
        (0, 1, -right, up),
        (1, 0, up, -forward),
        (1, 2, -up, forward),
    ] {
        let pose = Pose {
            eye: EYE,
            target: EYE + way,
            up: top,
        };
        let plane = ImagePlane::new(side, side, 2.0 / f64::from(side)).expect("a good plane");
        let face = Camera::new(pose, Projection::Perspective, plane);
        let face = triangles(&render(&stage.view(face, Cull::None), Grid::default()));
        let others = (0..side * side).filter(|i| {
            let (x, y) = (column * side + i % side, row * side + i / side);
            shown[(y * 4 * side + x) as usize] != face[*i as usize]
        });
        // Directions differ by some roundings; few pixels' centres are that near to an edge.
        assert!(others.count() <= 2, "{column} {row}");
    }
}

/// The six pictures of a cube map: a strip's tiles, each a square file of its own.
#[test]
fn faces_in_files_of_their_own_are_the_strips() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let render = |name: &str, more: &[&str]| {
        let mut arguments = arguments!["render", asset("cube.obj"), "-o", at(name)];
        arguments.extend(arguments!["--projection", "cubemap", "--size", "192x32"]);
        arguments.extend(arguments!["--eye", "0.2,0.1,3", "--target", "0,0,0"]);
        arguments.extend(more.iter().map(OsString::from));
        succeed(arguments);
        let file = bytes(&at(name));
        assert!(!file.windows(5).any(|word| word == b"GPano"), "{name}");
        ImageFile::decode(&file).expect("a picture").picture
    };
    let strip = render("strip.png", &[]);
    for face in 0..6 {
        let cell = format!("{face},0");
        let found = render("face.png", &["--tiles", "6x1", "--sub-camera", &cell]);
        assert_eq!((found.width, found.height), (32, 32));
        let rows = strip.pixels.chunks_exact(192);
        let expected: Vec<_> = rows
            .flat_map(|row| row[face * 32..][..32].iter().copied())
            .collect();
        assert!(found.pixels == expected, "{face}");
    }
}

#[test]
fn what_a_panorama_has_no_place_for_is_transparent() {
    let stage = stage();
    // A stereographic fisheye has no end.
    for panorama in all().filter(|&panorama| panorama != Panorama::Stereographic) {
        let (columns, rows) = panorama.size(40);
        let fov = panorama.most_fov();
        let camera = camera(Projection::Panoramic(panorama), fov, (columns + 8, rows));
        let view = stage.view(camera, Cull::None);
        let picture = render(&view, Grid::default());
        assert!(!Recipe::of(&view).is_opaque(), "{panorama:?}");
        let mut outside = 0;
        for (at, pixel) in picture.pixels.iter().enumerate() {
            let (x, y) = (at as u32 % picture.width, at as u32 / picture.width);
            let has = camera.has_place(f64::from(x) + 0.5, f64::from(y) + 0.5);
            assert_eq!(pixel[3], if has { 255 } else { 0 }, "{panorama:?} {x} {y}");
            outside += u32::from(!has);
        }
        assert!(outside >= picture.height, "{panorama:?}: {outside}");
    }
    let planar = camera(Projection::Perspective, 60.0, (40, 30));
    assert!(Recipe::of(&stage.view(planar, Cull::None)).is_opaque());
}

/// Lines that a panorama leaves out are named, by what asked for them; others, and planes, have no such warning.
#[test]
fn lines_that_a_panorama_leaves_out_are_named() {
    let folder = folder();
    for (projection, options, named) in [
        (
            "fisheye",
            "--wireframe --wireframe-hidden",
            "hidden lines are not drawn",
        ),
        (
            "equirectangular",
            "--wireframe --wireframe-edges silhouette,feature:30",
            "silhouettes are not drawn",
        ),
        (
            "cubemap",
            "--mode wireframe --wireframe-edges silhouette --wireframe-hidden=1",
            "hidden lines and silhouettes are not drawn",
        ),
        ("cylindrical", "--wireframe", ""),
        ("perspective", "--wireframe --wireframe-hidden", ""),
        (
            "perspective",
            "--wireframe --wireframe-hidden --lens=-0.1,0,0,0,0",
            "hidden lines are not drawn: a picture through a lens has none",
        ),
    ] {
        let picture = folder.path().join("a.png");
        let mut arguments = arguments![
            "render",
            asset("cube.obj"),
            "-o",
            &picture,
            "--size",
            "40x20"
        ];
        arguments.extend(arguments!["--projection", projection]);
        arguments.extend(options.split_whitespace().map(OsString::from));
        let message = succeed(&arguments).errors;
        assert_eq!(
            message.is_empty(),
            named.is_empty(),
            "{projection} {options}: {message}"
        );
        assert!(message.contains(named), "{projection} {options}: {message}");
    }
}
