//! The same bytes, however a picture is made: whole, in tiles, on more threads, in passes, by
//! fragments; and the same triangle as brute force, on every mesh.

use raycast_core::camera::{Camera, Grid, Orbit, Projection, Ray, Rect};
use raycast_core::formats::{read_mesh, read_scene};
use raycast_core::glam::DVec3;
use raycast_core::picture::{Format, Fragment, Picture, Recipe, stitch};
use raycast_core::render::{Cancel, Passes, Settings, TileStats, View};
use raycast_core::scene::{Mesh, Object, Scene, Transform};
use raycast_core::shade::{Mode, Shading, Wireframe};
use raycast_core::{Accel, Cull, Detail, Simd};
use raycast_oracle::random::Random;
use raycast_report::cameras::{PROJECTIONS, camera};
use raycast_report::meshes;
use raycast_tests::check::{Check, Stage, on_threads, pixel, render};
use raycast_tests::models;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Several objects, one of them moved, with edges and vertices on pixels' centres.
fn stage() -> Stage {
    let cube = Object::new(
        "cube",
        Arc::new(meshes::cuboid(DVec3::splat(-0.5), DVec3::splat(0.5))),
    );
    let sphere = Object {
        transform: Transform {
            translate: DVec3::new(0.7, 0.4, 0.2),
            rotate: DVec3::new(10.0, 20.0, 30.0),
            scale: DVec3::splat(0.6),
            ..Transform::IDENTITY
        },
        ..Object::new("sphere", Arc::new(meshes::sphere(DVec3::ZERO, 1.0, 40)))
    };
    let hills = Object {
        transform: Transform {
            translate: DVec3::new(-2.0, -0.7, 2.0),
            rotate: DVec3::new(-90.0, 0.0, 0.0),
            scale: DVec3::new(0.125, 0.125, 0.03),
            ..Transform::IDENTITY
        },
        ..Object::new("hills", Arc::new(meshes::integer_heights(32, 1)))
    };
    Stage::from_scene(Scene {
        objects: vec![cube, sphere, hills],
    })
}

fn front(projection: Projection, size: (u32, u32)) -> Camera {
    camera(
        DVec3::new(0.0, 0.0, 4.0),
        DVec3::ZERO,
        projection,
        size,
        2.5,
    )
}

/// Splits of a picture of some 150 × 110 pixels.
const GRIDS: [Grid; 9] = [
    Grid::Count {
        columns: 3,
        rows: 2,
    },
    Grid::Count {
        columns: 11,
        rows: 1,
    },
    Grid::Size(1),
    Grid::Size(8),
    Grid::Size(16),
    Grid::Size(17),
    Grid::Size(32),
    Grid::Size(64),
    Grid::Size(1000),
];

/// What has lines in every second mode; without the hidden ones in the first.
const EDGES: [&str; 5] = [
    "all",
    "silhouette,feature",
    "polygon",
    "boundary,non-manifold",
    "silhouette",
];

/// Every split and thread count gives the picture that one tile on one thread gives.
#[test]
fn stitched_equals_whole() {
    let stage = stage();
    let size = (150, 110);
    let whole = Grid::Count {
        columns: 1,
        rows: 1,
    };
    for projection in PROJECTIONS {
        for (index, mode) in Mode::ALL.into_iter().enumerate() {
            let mut view = stage.view(front(projection, size), Cull::None);
            view.settings.shading = Shading {
                mode,
                wireframe: (index % 2 == 1).then(|| Wireframe {
                    edges: EDGES[index / 2].parse().expect("kinds"),
                    hidden: index as f32 * 0.1,
                    ..Wireframe::default()
                }),
                ..Shading::default()
            };
            view.settings.samples = if index == 0 { 4 } else { 1 };
            let expected = on_threads(1, || render(&view, whole));
            for grid in GRIDS.into_iter().chain([whole]) {
                for threads in [1, 2, 5] {
                    let picture = on_threads(threads, || render(&view, grid));
                    assert!(
                        picture == expected,
                        "{projection:?} {mode:?} {grid:?} on {threads} threads"
                    );
                }
            }
        }
    }
}

/// A picture without layers, which is shaded where it lies, has the pixels of one with them, and tells
/// of each tile once.
#[test]
fn strips_of_tiles_equal_tiles() {
    let stage = stage();
    let (columns, rows) = (150, 110);
    for (index, mode) in Mode::ALL.into_iter().enumerate() {
        let mut view = stage.view(front(PROJECTIONS[index % 2], (columns, rows)), Cull::None);
        view.settings.shading.mode = mode;
        view.settings.samples = 1;
        view.settings.layers = true;
        let expected = on_threads(1, || render(&view, Grid::Size(16)));
        view.settings.layers = false;
        let cast = view.cast(Grid::Size(16), Detail::Triangle);
        for grid in GRIDS {
            for threads in [1, 2, 5] {
                let message = Mutex::new((0, TileStats::default()));
                let sink = |stats: &TileStats| {
                    let mut message = message.lock().expect("no worker panicked");
                    message.0 += 1;
                    message.1 += *stats;
                };
                // Whatever was there before is gone.
                let mut picture = Picture::blank(columns, rows, false);
                picture.pixels.fill([1, 2, 3, 4]);
                let clock = || Duration::ZERO;
                let done = on_threads(threads, || {
                    view.render_into(grid, &clock, &Cancel::default(), &sink, &mut picture)
                });
                assert!(done);
                assert!(
                    picture.pixels == expected.pixels,
                    "{mode:?} {grid:?} {threads}"
                );
                let (tiles, stats) = message.into_inner().expect("no worker panicked");
                assert_eq!(tiles, grid.tiles(columns, rows).len());
                assert_eq!(stats.rays, u64::from(columns * rows));
                assert_eq!(stats.counts.hits, cast.counts.hits);
            }
        }
    }
}

/// The colours before they are rounded to bytes, and every other channel, to the bit: bytes forgive what a
/// fused multiplication on one instruction set changes, nearly always.
#[test]
fn every_instruction_set_gives_the_same_light_in_every_mode() {
    let stage = stage();
    for projection in PROJECTIONS {
        for (index, mode) in Mode::ALL.into_iter().enumerate() {
            let mut view = stage.view(front(projection, (150, 110)), Cull::None);
            view.settings.shading = Shading {
                mode,
                wireframe: (index % 2 == 1).then(|| Wireframe {
                    edges: EDGES[index / 2].parse().expect("kinds"),
                    hidden: index as f32 * 0.1,
                    ..Wireframe::default()
                }),
                ..Shading::default()
            };
            view.settings.samples = 2;
            let of = |simd| -> Vec<u32> {
                let accel = Accel::clone(&stage.accel).with_simd(simd);
                let view = View {
                    accel: Arc::new(accel),
                    ..view.clone()
                };
                let layers = render(&view, Grid::default()).layers;
                let layers = layers.expect("layers were asked for");
                let numbers = (layers.color.iter().flatten())
                    .chain(&layers.depth)
                    .chain(layers.normal.iter().flatten())
                    .chain(layers.uv.iter().flatten());
                let bits = numbers.map(|number| number.to_bits());
                bits.chain(layers.object).chain(layers.triangle).collect()
            };
            let sets: Vec<Simd> = Simd::available().collect();
            let plain = of(sets[0]);
            for &simd in &sets[1..] {
                assert!(of(simd) == plain, "{projection:?} {mode:?} {simd:?}");
            }
        }
    }
}

/// Any rectangle of the picture is what the whole shows there.
#[test]
fn a_sub_camera_shows_its_part_of_the_whole() {
    let stage = stage();
    let (columns, rows) = (90, 70);
    for projection in PROJECTIONS {
        let view = stage.view(front(projection, (columns, rows)), Cull::None);
        let whole = render(&view, Grid::default());
        for (x, y, width, height) in [
            (0, 0, 1, 1),
            (13, 7, 31, 45),
            (89, 0, 1, 70),
            (0, 69, 90, 1),
        ] {
            let rect = Rect {
                x,
                y,
                width,
                height,
            };
            let tile = view.render_sub_camera(view.camera.sub_camera(rect), &|| Duration::ZERO);
            let mut patched = whole.clone();
            assert!(patched.paste(tile.rect, &tile.pixels, tile.layers.as_ref()));
            assert!(patched == whole, "{rect:?} {projection:?}");
            assert_eq!((tile.rect, tile.pixels.len()), (rect, rect.area()));
        }
    }
}

/// After the last pass the picture is the one that is rendered at once.
#[test]
fn the_last_pass_equals_the_render() {
    let stage = stage();
    let (columns, rows) = (100, 70);
    for (projection, samples) in [
        (Projection::Perspective, 1),
        (Projection::Perspective, 4),
        (Projection::Orthographic, 3),
    ] {
        let mut view = stage.view(front(projection, (columns, rows)), Cull::None);
        view.settings.samples = samples;
        view.settings.shading.mode = Mode::Smooth;
        let expected = render(&view, Grid::default());
        for tile_size in [16, 33] {
            let tiles = Grid::Size(tile_size).tiles(columns, rows);
            let passes = Passes::plan(8, samples);
            let picture = Mutex::new(Picture::blank(columns, rows, true));
            let finished = on_threads(2, || {
                view.render_progressively(
                    &tiles,
                    &passes,
                    &|| Duration::ZERO,
                    &Cancel::default(),
                    &|_, tile| {
                        let mut picture = picture.lock().expect("no worker panicked");
                        assert!(picture.paste(tile.rect, &tile.pixels, tile.layers.as_ref()));
                    },
                )
            });
            assert!(finished);
            let picture = picture.into_inner().expect("no worker panicked");
            assert!(
                picture.pixels == expected.pixels,
                "{projection:?} {samples}"
            );
            assert!(
                picture.layers == expected.layers,
                "{projection:?} {samples}"
            );
        }
    }
}

/// A cancelled render does not say that it is done.
#[test]
fn a_cancelled_render_is_none() {
    let stage = stage();
    let view = stage.view(front(Projection::Perspective, (200, 200)), Cull::None);
    let cancel = Cancel::default();
    let picture = view.render(Grid::Size(8), &|| Duration::ZERO, &cancel, &|_| {
        cancel.cancel();
    });
    assert!(picture.is_none());
}

/// Fragments written to bytes, read again, and stitched: the same file as the whole, byte for byte.
#[test]
fn fragments_stitch_to_the_same_bytes() {
    let stage = stage();
    let (columns, rows) = (100, 70);
    let view = stage.view(front(Projection::Perspective, (columns, rows)), Cull::None);
    let whole = render(&view, Grid::default());
    let recipe = Recipe::of(&view);
    for format in [Format::Png, Format::Exr] {
        let expected = whole
            .encode_with(format, Some(&recipe))
            .expect("a picture with layers");
        for grid in [
            Grid::Count {
                columns: 3,
                rows: 2,
            },
            Grid::Size(33),
        ] {
            let mut fragments: Vec<(String, Fragment)> = grid
                .tiles(columns, rows)
                .into_iter()
                .map(|rect| {
                    let tile =
                        view.render_sub_camera(view.camera.sub_camera(rect), &|| Duration::ZERO);
                    let fragment = Fragment {
                        rect,
                        recipe,
                        picture: Picture {
                            width: rect.width,
                            height: rect.height,
                            pixels: tile.pixels,
                            layers: tile.layers,
                        },
                    };
                    let bytes = fragment.encode(format).expect("a fragment");
                    let name = format!("{},{}", rect.x, rect.y);
                    let again = Fragment::decode(&name, &bytes).expect("what was written");
                    assert_eq!((again.rect, again.recipe), (rect, recipe));
                    (name, again)
                })
                .collect();
            fragments.reverse();
            let stitched = stitch(&fragments).expect("all parts are there");
            let bytes = stitched.encode_with(format, Some(&recipe));
            let bytes = bytes.expect("a picture");
            assert!(bytes == expected, "{format:?} {grid:?}");
        }
    }
}

fn name(path: &Path) -> String {
    path.file_name()
        .expect("a file")
        .to_string_lossy()
        .into_owned()
}

fn read(path: &Path) -> Mesh {
    read_mesh(path, &|_| ()).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn demo_meshes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("the assets can be listed")
        .map(|entry| entry.expect("the assets can be listed").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "obj"))
        .collect();
    files.sort();
    assert!(files.len() >= 4, "{files:?}");
    files
}

/// A camera that sees a whole scene, from the yaw and pitch that a scene is first shown from.
fn whole(stage: &Stage, projection: Projection, size: (u32, u32)) -> Camera {
    let (center, radius) = stage.scene.bounding_sphere();
    let orbit = Orbit {
        pivot: center,
        yaw: Orbit::DEFAULT_ANGLES.0,
        pitch: Orbit::DEFAULT_ANGLES.1,
        distance: radius * 3.0,
    };
    camera(orbit.pose().eye, center, projection, size, radius * 2.0)
}

/// Every mesh renders without a window, and shows brute force's triangle and the oracle's on a grid
/// of pixels; tiles of other sizes and other threads show the same.
#[test]
fn every_mesh_matches_brute_force() {
    for path in demo_meshes().into_iter().chain(models::meshes()) {
        let stage = Stage::from_meshes([read(&path)]);
        for projection in PROJECTIONS {
            let (columns, rows) = (240, 180);
            let camera = whole(&stage, projection, (columns, rows));
            let picture = stage.check_picture(camera, Cull::None, 3);
            let layers = picture.layers.as_ref().expect("layers were asked for");
            let covered = layers.depth.iter().filter(|z| z.is_finite()).count();
            assert!(covered > 2000, "{}: {covered} pixels", name(&path));
            let lattice: Vec<(u32, u32)> = (5..rows)
                .step_by(11)
                .flat_map(|y| (5..columns).step_by(11).map(move |x| (x, y)))
                .collect();
            lattice.into_par_iter().for_each(|(x, y)| {
                let ray = camera.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let brute = stage.accel.cast_brute_force(&ray, Cull::None);
                let expected = brute.map_or((u32::MAX, u32::MAX, f32::INFINITY), |hit| {
                    (hit.object, hit.triangle, hit.t as f32)
                });
                assert_eq!(pixel(layers, columns, x, y), expected, "{x} {y}");
            });
            let view = stage.view(camera, Cull::None);
            let other = on_threads(1, || render(&view, Grid::Size(17)));
            assert!(other == picture, "{} {projection:?}", name(&path));
        }
    }
}

/// The demo scene: several objects in their places, textured.
#[test]
fn the_demo_scene_matches_the_oracle() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/demo.raycast.toml");
    let file = read_scene(&path, &|_| ()).unwrap_or_else(|error| panic!("{error}"));
    let shading = file.shading.unwrap_or_default();
    let stage = Stage::from_scene(file.scene);
    let camera = whole(&stage, Projection::Perspective, (200, 150));
    stage.check_picture(camera, Cull::None, 2);
    let view = View {
        scene: stage.scene.clone(),
        accel: Arc::new(Accel::build(&stage.scene).expect("a valid scene")),
        camera,
        settings: Settings {
            shading,
            samples: 2,
            layers: true,
            ..Settings::default()
        },
    };
    let expected = on_threads(1, || render(&view, Grid::Size(1000)));
    let tiled = on_threads(3, || render(&view, Grid::Size(19)));
    assert!(tiled == expected);
    let png = expected.encode(Format::Png).expect("a picture");
    assert!(tiled.encode(Format::Png).expect("a picture") == png);
}

/// No machine, compiler or instruction set changes a bit: a fused product and sum would change many,
/// and be no less exact. Where the arithmetic of a hit is changed on purpose, so is the number here.
#[test]
fn the_numbers_are_the_same_on_every_machine() {
    let mut random = Random::new(29);
    let stage = Stage::from_meshes([meshes::random_soup(
        &mut random,
        60,
        DVec3::new(5.0, -3.0, 2.0),
        1.0,
        0.5,
    )]);
    let mut hits = 0;
    // The hash of Fowler, Noll and Vo (FNV-1a), over words instead of bytes.
    let mut hash = 0xcbf2_9ce4_8422_2325u64;
    for _ in 0..20_000 {
        let origin = random.in_cube() * 9.0;
        let target = DVec3::new(5.0, -3.0, 2.0) + random.in_cube();
        let ray = Ray::new(origin, target - origin);
        if let Some(hit) = stage.accel.cast(&ray, Cull::None) {
            hits += 1;
            for word in [hit.t, hit.u, hit.v].map(f64::to_bits) {
                hash = (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3);
            }
        }
    }
    assert!(hits > 5000, "{hits}");
    assert_eq!(hash, 0x12e6_a852_eefc_ab9a, "{hash:#018x}");
}
