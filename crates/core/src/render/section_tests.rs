//! Sections of solids that are cut open: filled and outlined, the same for any split.

use super::{Cancel, Settings, View};
use crate::bvh::Accel;
use crate::camera::{Camera, Grid, ImagePlane, Pose, Projection};
use crate::scene::{ClippingPlane, ClippingPlanes, Mesh, Object, Scene, Shape};
use crate::shade::{Mode, Shading};
use glam::DVec3;
use std::sync::Arc;
use std::time::Duration;

/// A ball in a torus, the nearer half of both clipped away, in a picture of 131 × 97.
fn view(projection: Projection, samples: u32) -> View {
    let object = |name: &str, shape: Shape| {
        let mesh = Mesh::new(shape.mesh().expect("a shape"));
        Object::new(name, Arc::new(mesh))
    };
    let torus = Shape::Torus {
        radius: 1.0,
        tube: 0.3,
        segments: 48,
        rings: 24,
    };
    let ball = Shape::Sphere {
        radius: 0.5,
        segments: 32,
        rings: 16,
    };
    let scene = Arc::new(Scene {
        objects: vec![object("torus", torus), object("ball", ball)],
    });
    let pose = Pose {
        eye: DVec3::new(1.0, 2.0, 4.0),
        target: DVec3::ZERO,
        up: DVec3::Y,
    };
    let plane = ClippingPlane::new(DVec3::new(-0.1, 0.0, -1.0), 0.0).expect("a plane");
    View {
        accel: Arc::new(Accel::build(&scene).expect("a valid scene")),
        scene,
        camera: Camera::new(
            pose,
            projection,
            ImagePlane::new(131, 97, 0.025).expect("a good plane"),
        ),
        settings: Settings {
            shading: Shading {
                mode: Mode::Flat,
                ..Shading::default()
            },
            clip: ClippingPlanes::new(&[plane]).expect("one plane"),
            samples,
            ..Settings::default()
        },
    }
}

fn render(view: &View, grid: Grid) -> Vec<[u8; 4]> {
    let clock = &|| Duration::ZERO;
    let picture = view.render(grid, clock, &Cancel::default(), &|_| ());
    picture.expect("nothing cancels it").pixels
}

/// The same solids, clipped to a slab that is thinner than the torus's tube.
fn slab(projection: Projection, samples: u32) -> View {
    let mut view = view(projection, samples);
    let back = ClippingPlane::new(DVec3::new(0.1, 0.0, 1.0), -0.05).expect("a plane");
    view.settings.clip.push(back).expect("a second plane");
    view
}

#[test]
fn a_slab_shows_the_section_that_all_behind_it_shows() {
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let (half, slab) = (view(projection, 1), slab(projection, 1));
        let (half, slab) = (
            render(&half, Grid::default()),
            render(&slab, Grid::default()),
        );
        let is_section = |p: &[u8; 4]| p[0] > 150 && p[0] > p[1] + 50 && p[1] > p[2] + 30;
        let mut count = 0;
        for (half, slab) in half.iter().zip(&slab) {
            assert_eq!(is_section(half), is_section(slab));
            if is_section(half) {
                assert_eq!(half, slab);
                count += 1;
            }
        }
        assert!(count > 300, "{count}");
    }
}

#[test]
fn sections_are_the_same_for_any_split() {
    type Make = fn(Projection, u32) -> View;
    let cases: [(u32, Make); 4] = [(1, view), (3, view), (1, slab), (3, slab)];
    for projection in [Projection::Perspective, Projection::Orthographic] {
        for (samples, view) in cases {
            let view: View = view(projection, samples);
            let whole = render(&view, Grid::Size(256));
            for grid in [
                Grid::Size(64),
                Grid::Size(7),
                Grid::Size(1),
                Grid::Count {
                    columns: 3,
                    rows: 2,
                },
            ] {
                assert_eq!(
                    render(&view, grid),
                    whole,
                    "{grid:?} {projection:?} {samples}"
                );
            }
        }
    }
}

#[test]
fn a_section_is_filled_and_outlined_and_other_back_faces_keep_their_color() {
    let view = view(Projection::Perspective, 1);
    let cut = render(&view, Grid::default());
    let orange = |p: &&[u8; 4]| p[0] > 150 && p[0] > p[1] + 50 && p[1] > p[2] + 30;
    let fill: Vec<[u8; 4]> = cut.iter().filter(orange).copied().collect();
    assert!(fill.len() > 300, "{}", fill.len());
    assert!(fill.iter().all(|color| *color == fill[0]), "one colour");
    let dark = cut
        .iter()
        .filter(|p| **p == [0x2b, 0x15, 0x08, 255])
        .count();
    // The two discs of the torus and the one of the ball are some 20 pixels wide each.
    assert!((100..400).contains(&dark), "{dark}");
    // Without planes there are neither fillings nor outlines, although the same back faces are visible from inside.
    let whole = View {
        settings: Settings {
            clip: ClippingPlanes::NONE,
            ..view.settings
        },
        ..view.clone()
    };
    assert_eq!(
        render(&whole, Grid::default())
            .iter()
            .filter(orange)
            .count(),
        0
    );
    let depth = View {
        settings: Settings {
            shading: Shading {
                mode: Mode::Depth,
                ..view.settings.shading
            },
            ..view.settings
        },
        ..view
    };
    assert_eq!(
        render(&depth, Grid::default())
            .iter()
            .filter(orange)
            .count(),
        0
    );
}
