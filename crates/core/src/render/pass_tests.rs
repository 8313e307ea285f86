//! Progressive pictures: every pixel is filled, and cancelling stops at once.

use super::{Cancel, Pass, Passes, Settings, Tile, View};
use crate::bvh::Accel;
use crate::camera::{Camera, Grid, ImagePlane, Pose, Projection, Rect};
use crate::random::Random;
use crate::scene::{Attribute, Mesh, MeshData, Object, Scene};
use crate::shade::{Ground, Mode, Shading, Wireframe};
use glam::DVec3;
use std::sync::Arc;
use std::sync::Mutex;
use std::time::Duration;

/// Random triangles in a picture of 77 × 45.
fn view() -> View {
    let mut random = Random(41);
    let positions: Vec<DVec3> = (0..300)
        .map(|_| random.point() * 2.0 + random.point() * 0.3)
        .collect();
    let normals = (0..300)
        .map(|_| random.point().normalize_or(DVec3::X).as_vec3())
        .collect();
    let mesh = Mesh::new(MeshData {
        positions,
        normals: Some(Attribute {
            values: normals,
            indices: None,
        }),
        triangles: (0..100).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        ..MeshData::default()
    });
    let scene = Arc::new(Scene {
        objects: vec![Object::new("mesh", Arc::new(mesh))],
    });
    let pose = Pose {
        eye: DVec3::Z * 6.0,
        target: DVec3::ZERO,
        up: DVec3::Y,
    };
    let plane = ImagePlane::new(77, 45, 0.06).expect("a good plane");
    View {
        accel: Arc::new(Accel::build(&scene).expect("a valid scene")),
        scene,
        camera: Camera::new(pose, Projection::Perspective, plane),
        settings: Settings {
            shading: Shading {
                mode: Mode::Normals,
                ..Shading::default()
            },
            ..Settings::default()
        },
    }
}

const CLOCK: &(dyn Fn() -> Duration + Sync) = &|| Duration::ZERO;

/// Tiles in the order of their arrival, and whether all were rendered.
fn progress(
    view: &View,
    tiles: &[Rect],
    passes: &[Pass],
    cancel: &Cancel,
    at: impl Fn(usize) + Sync,
) -> (Vec<(Pass, Tile)>, bool) {
    let come = Mutex::new(Vec::new());
    let done = view.render_progressively(tiles, passes, CLOCK, cancel, &|pass, tile| {
        let mut come = come.lock().expect("no sink panics");
        come.push((pass, tile));
        at(come.len());
    });
    (come.into_inner().expect("no sink panics"), done)
}

/// Checks that in each pass every pixel of a tile shows the ray above it and to the left, in the tile's last column and row
/// too, whatever is left of a block there; the truth is the picture of the finest pass. How many pixels differ from the
/// first.
fn check_blocks(view: &View, side: u32, passes: &[Pass]) -> u32 {
    let whole = view
        .render(Grid::default(), CLOCK, &Cancel::default(), &|_| ())
        .expect("nothing cancels it");
    let at = |x: u32, y: u32| whole.pixels[(y * 77 + x) as usize];
    let tiles: Vec<Rect> = (0..45u32.div_ceil(side))
        .flat_map(|row| (0..77u32.div_ceil(side)).map(move |column| (column, row)))
        .map(|(column, row)| Rect {
            x: column * side,
            y: row * side,
            width: side.min(77 - column * side),
            height: side.min(45 - row * side),
        })
        .collect();
    let (come, done) = progress(view, &tiles, passes, &Cancel::default(), |_| ());
    assert!(done && come.len() == tiles.len() * passes.len());
    let mut shown = 0;
    for (pass, tile) in come {
        let Rect {
            x: left,
            y: top,
            width,
            height,
        } = tile.rect;
        for (place, &pixel) in (0..).zip(&tile.pixels) {
            let (x, y) = (place % width, place / width);
            let block_start = |at: u32| at / pass.stride * pass.stride;
            let expected = at(left + block_start(x), top + block_start(y));
            let what = || format!("({x}, {y}) of {:?} in {pass:?}", tile.rect);
            assert_eq!(pixel, expected, "{} {:?}", what(), view.settings.shading);
            shown += u32::from(pixel != at(0, 0));
        }
        assert_eq!(tile.pixels.len(), (width * height) as usize);
    }
    shown
}

#[test]
fn coarse_passes_fill_every_pixel_from_its_block() {
    let view = view();
    for side in [33, 17, 8, 5, 1] {
        let shown = check_blocks(&view, side, &Passes::plan(16, 1));
        assert!(shown > 1000, "{shown}");
    }
}

/// Coarse passes are shaded in rows of eight, as whole pictures are: in each mode and projection, with lines and a ground, and
/// where the picture ends within its frame.
#[test]
fn coarse_passes_have_the_colors_of_whole_pictures() {
    let plain = view();
    let mut kinds = 0;
    for (_, projection) in Projection::all() {
        for mode in Mode::ALL {
            for (lines, ground) in [(false, false), (true, false), (false, true)] {
                let mut view = plain.clone();
                let camera = view.camera;
                view.camera = Camera::new(camera.pose(), projection, camera.plane());
                view.settings.shading = Shading {
                    mode,
                    wireframe: lines.then_some(Wireframe::ALONE),
                    ground: ground.then_some(Ground::Lowest),
                    ..Shading::default()
                };
                let passes = [8, 2].map(|stride| Pass { stride, samples: 1 });
                check_blocks(&view, 37, &passes);
                kinds += 1;
            }
        }
    }
    assert!(kinds > 200, "{kinds}");
}

/// The first stride saturates at the greatest power of two that a `u32` holds.
#[test]
fn a_first_stride_of_any_size_ends_with_every_ray() {
    let strides = |first| Passes::plan(first, 1).into_iter().map(|pass| pass.stride);
    let halved = || (0..32).rev().map(|power| 1 << power);
    for first in [1 << 31, (1 << 31) + 1, u32::MAX] {
        assert!(strides(first).eq(halved()), "{first}");
    }
    assert!(strides(0).eq([1]) && strides(5).eq([8, 4, 2, 1]));

    let view = view();
    let whole = [Rect {
        x: 0,
        y: 0,
        width: 77,
        height: 45,
    }];
    let passes = Passes::plan(u32::MAX, 1);
    let (come, done) = progress(&view, &whole, &passes, &Cancel::default(), |_| ());
    assert!(done && come.len() == 32);
    let expected = view
        .render(Grid::default(), CLOCK, &Cancel::default(), &|_| ())
        .expect("nothing cancels it");
    let coarsest = &come[0].1.pixels;
    assert!(coarsest.iter().all(|pixel| *pixel == expected.pixels[0]));
    assert_eq!(come[31].1.pixels, expected.pixels);
}

/// After cancelling no tile is started, within a pass or between two; tiles that arrived are whole.
#[test]
fn a_cancelled_picture_ends_at_once() {
    let view = view();
    let grid: Vec<Rect> = (0..20)
        .map(|tile| Rect {
            x: tile % 5 * 15,
            y: tile / 5 * 11,
            width: 15,
            height: 11,
        })
        .collect();
    let passes = Passes::plan(4, 2);
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let (all, done) = progress(&view, &grid, &passes, &Cancel::default(), |_| ());
    assert!(done && all.len() == 80);
    for threads in [1, 2] {
        let pool = pool(threads).expect("a pool");
        for after in [1, 7, 19, 20, 21, 40, 78] {
            let cancel = Cancel::default();
            let (come, done) = pool.install(|| {
                progress(&view, &grid, &passes, &cancel, |count| {
                    if count == after {
                        cancel.cancel();
                    }
                })
            });
            // Tiles that other workers had started may still arrive.
            assert!(!done && come.len() >= after, "{threads} {after}");
            assert!(come.len() < after + threads, "{threads} {after}");
            for (pass, tile) in &come {
                let is_it = |(other, whole): &&(Pass, Tile)| {
                    other == pass && whole.rect == tile.rect && whole.pixels == tile.pixels
                };
                assert!(all.iter().any(|whole| is_it(&whole)), "{pass:?}");
            }
        }
        let cancel = Cancel::default();
        cancel.cancel();
        let (come, done) = pool.install(|| progress(&view, &grid, &passes, &cancel, |_| ()));
        assert!(!done && come.is_empty());
        assert!(pool.install(|| {
            view.render(Grid::default(), CLOCK, &cancel, &|_| ())
                .is_none()
        }));
    }
}
