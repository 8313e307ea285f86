//! Lines of chosen edges, hidden lines and silhouettes, against projected points and plane geometry.

use super::edge_choice::EdgeChoice;
use super::edges::LineStyle;
use super::*;
use crate::bvh::Accel;
use crate::camera::{Camera, Grid, ImagePlane, Pose, Projection};
use crate::picture::Picture;
use crate::render::{Cancel, Settings, View};
use crate::scene::{ClippingPlane, ClippingPlanes, Color, Mesh, MeshData, Object, Scene, Shape};
use glam::{DVec2, DVec3};
use std::sync::Arc;
use std::time::Duration;

const SIZE: (u32, u32) = (120, 90);

fn kinds(text: &str) -> EdgeKinds {
    text.parse().expect("kinds of edges")
}

fn cube() -> Mesh {
    let size = DVec3::ONE;
    Mesh::new(Shape::Cube { size }.mesh().expect("a good shape"))
}

fn camera(projection: Projection, eye: DVec3) -> Camera {
    let plane = ImagePlane::new(SIZE.0, SIZE.1, 0.03).expect("a good plane");
    let pose = Pose {
        eye,
        target: DVec3::ZERO,
        up: DVec3::Y,
    };
    Camera::new(pose, projection, plane)
}

/// A picture of red surfaces in front of a black background, with white lines.
fn picture(mesh: Mesh, camera: Camera, lines: Wireframe, clip: ClippingPlanes) -> Picture {
    let mut object = Object::new("it", Arc::new(mesh));
    object.color = crate::scene::ColorRule::Uniform(Color([255, 0, 0]));
    let scene = Scene {
        objects: vec![object],
    };
    let accel = Accel::build(&scene).expect("a good scene");
    let black = Color([0; 3]);
    let view = View {
        scene: Arc::new(scene),
        accel: Arc::new(accel),
        camera,
        settings: Settings {
            shading: Shading {
                mode: Mode::Color,
                wireframe: Some(Wireframe {
                    color: Color([255; 3]),
                    ..lines
                }),
                background: Background::Gradient(black, black),
                ..Shading::default()
            },
            clip,
            ..Settings::default()
        },
    };
    let clock = || Duration::ZERO;
    view.render(Grid::default(), &clock, &Cancel::default(), &|_| ())
        .expect("nobody cancels")
}

/// The fraction of white that a pixel shows, by its blue channel, which nothing else has: linear light.
fn white(picture: &Picture, x: u32, y: u32) -> f64 {
    let [_, _, blue, _] = picture.pixels[(y * SIZE.0 + x) as usize];
    let blue = f64::from(blue) / 255.0;
    if blue <= 0.04045 {
        blue / 12.92
    } else {
        crate::math::pow((blue + 0.055) / 1.055, 2.4)
    }
}

/// The distance of a point from a segment.
fn to_segment(place: DVec2, a: DVec2, b: DVec2) -> f64 {
    let share = (place - a).dot(b - a) / (b - a).length_squared();
    place.distance(a + (b - a) * share.clamp(0.0, 1.0))
}

/// The twelve edges of the unit cube.
fn cube_edges() -> Vec<[DVec3; 2]> {
    let corner = |bits: usize| {
        DVec3::from_array(std::array::from_fn(|axis| (bits >> axis & 1) as f64 - 0.5))
    };
    let pairs = (0..8).flat_map(|a| (0..3).map(move |axis| (a, a | 1 << axis)));
    pairs
        .filter(|(a, b)| a != b)
        .map(|(a, b)| [corner(a), corner(b)])
        .collect()
}

/// The truth is the cube's edges as projected points, and the pixels that show the cube at all.
#[test]
fn hidden_edges_of_a_cube_are_where_its_corners_are_seen() {
    let eye = DVec3::new(1.5, 1.1, 2.4);
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let camera = camera(projection, eye);
        let lines = Wireframe {
            width: 2.0,
            edges: kinds("feature"),
            hidden: 0.5,
            ..Wireframe::default()
        };
        let picture = picture(cube(), camera, lines, ClippingPlanes::NONE);
        let project = |point| DVec2::from(camera.project(point).expect("in front of the eye"));
        let edges: Vec<_> = cube_edges().iter().map(|edge| edge.map(project)).collect();
        assert_eq!(edges.len(), 12);
        let mut seen = [0; 3];
        for y in 0..SIZE.1 {
            for x in 0..SIZE.0 {
                let place = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let distances = edges.iter().map(|[a, b]| to_segment(place, *a, *b));
                let nearest = distances.fold(f64::INFINITY, f64::min);
                let faint = 0.5 * (1.5 - nearest).clamp(0.0, 1.0);
                let found = white(&picture, x, y);
                // Visible lines are at least as strong, and bytes are rounded.
                assert!(found > faint - 0.02, "{found} for {faint} at {x} {y}");
                let [r, ..] = picture.pixels[(y * SIZE.0 + x) as usize];
                if nearest > 1.6 {
                    assert_eq!(found, 0.0, "{x} {y}");
                    seen[0] += 1;
                } else if r != 255 {
                    // Beside the cube: half of a faint line.
                    assert!((found - faint).abs() < 0.02, "{found} for {faint}");
                    seen[1] += 1;
                } else if (found - 0.5).abs() < 0.01 {
                    seen[2] += 1;
                }
            }
        }
        assert!(seen.iter().all(|&count| count > 50), "{seen:?}");
    }
}

#[test]
fn features_are_whole_edges_without_diagonals() {
    let eye = DVec3::new(1.5, 1.1, 2.4);
    let camera = camera(Projection::Perspective, eye);
    let project = |point| DVec2::from(camera.project(point).expect("in front of the eye"));
    let of = |edges: &str| {
        let lines = Wireframe {
            width: 2.0,
            edges: kinds(edges),
            ..Wireframe::default()
        };
        picture(cube(), camera, lines, ClippingPlanes::NONE)
    };
    let features = of("feature:89");
    let edges: Vec<_> = cube_edges().iter().map(|edge| edge.map(project)).collect();
    for y in 0..SIZE.1 {
        for x in 0..SIZE.0 {
            let place = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let distances = edges.iter().map(|[a, b]| to_segment(place, *a, *b));
            let nearest = distances.fold(f64::INFINITY, f64::min);
            let found = white(&features, x, y);
            assert!(found <= (1.5 - nearest).clamp(0.0, 1.0) + 0.02, "{x} {y}");
        }
    }
    // The front's diagonal and every other edge that is no right angle.
    assert_ne!(of("all").pixels, features.pixels);
    assert!((0..SIZE.1).any(|y| (0..SIZE.0).any(|x| white(&features, x, y) > 0.99)));
    // No edge turns by more than a right angle.
    let none = of("feature:91");
    let bare = of("boundary,non-manifold");
    assert_eq!(none.pixels, bare.pixels);
    assert!((0..SIZE.1).all(|y| (0..SIZE.0).all(|x| white(&none, x, y) == 0.0)));
}

/// The truth is the disc as which a fine sphere is seen.
#[test]
fn silhouettes_lie_around_a_sphere_and_nowhere_on_it() {
    let sphere = Shape::Sphere {
        radius: 1.0,
        segments: 256,
        rings: 128,
    };
    let mesh = || Mesh::new(sphere.mesh().expect("a good shape"));
    let camera = camera(Projection::Orthographic, DVec3::new(0.3, 0.2, 3.0));
    let lines = Wireframe {
        width: 3.0,
        edges: kinds("silhouette"),
        ..Wireframe::default()
    };
    let picture = picture(mesh(), camera, lines, ClippingPlanes::NONE);
    let mut counts = [0; 3];
    for y in 0..SIZE.1 {
        for x in 0..SIZE.0 {
            let place = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let middle = DVec2::new(60.0, 45.0);
            let outside = place.distance(middle) - 1.0 / 0.03;
            let found = white(&picture, x, y);
            // Faces lie some 0.01 pixels inside the sphere.
            if outside < -0.1 {
                assert_eq!(found, 0.0, "{x} {y}");
                counts[0] += 1;
            } else if (0.1..2.4).contains(&outside) {
                assert_eq!(found, 1.0, "{x} {y}");
                counts[1] += 1;
            } else if outside > 3.6 {
                assert_eq!(found, 0.0, "{x} {y}");
                counts[2] += 1;
            }
        }
    }
    assert!(counts.iter().all(|&count| count > 300), "{counts:?}");
}

#[test]
fn silhouettes_behind_a_surface_are_not_seen_and_faintly_where_hidden_lines_are() {
    // A wide square in front of a small one.
    let square = |half: f64, z: f64| {
        [(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)].map(|(x, y)| DVec3::new(x * half, y * half, z))
    };
    let mesh = || {
        Mesh::new(MeshData {
            positions: [square(1.0, 0.5), square(0.5, 0.0)].concat(),
            triangles: vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]],
            ..MeshData::default()
        })
    };
    let camera = camera(Projection::Perspective, DVec3::Z * 4.0);
    let of = |hidden: f32, clip: ClippingPlanes| {
        let lines = Wireframe {
            edges: kinds("silhouette"),
            hidden,
            ..Wireframe::default()
        };
        picture(mesh(), camera, lines, clip)
    };
    // The small square's upper edge: half a unit above the middle, at the target's distance.
    let (x, y) = (60, (45.0 - 0.5 / 0.03) as u32);
    assert_eq!(white(&of(0.0, ClippingPlanes::NONE), x, y), 0.0);
    assert!((white(&of(0.5, ClippingPlanes::NONE), x, y) - 0.5).abs() < 0.2);
    // The plane removes the triangles that have it.
    let plane = ClippingPlane::new(DVec3::Z, 0.25).expect("a plane");
    let clip = ClippingPlanes::new(&[plane]).expect("one plane");
    assert_eq!(white(&of(0.5, clip), x, y), 0.0);
}

#[test]
fn edge_styles_follow_from_adjacent_triangles() {
    // A quad that is bent along its diagonal by 90 degrees, and a third triangle at one of its sides.
    let mesh = Mesh::new(MeshData {
        positions: [
            [0., 0., 0.],
            [1., 0., 0.],
            [0., 1., 0.],
            [0., 0., 1.],
            [2., 0., 0.],
            [2., 1., 0.],
        ]
        .map(DVec3::from_array)
        .to_vec(),
        triangles: vec![[0, 1, 2], [0, 3, 1], [1, 0, 4], [2, 1, 5]],
        ..MeshData::default()
    });
    let scene = Scene::from(mesh);
    let styles = |text: &str| {
        let choice = EdgeChoice::new(&scene, kinds(text)).expect("a choice");
        [0, 3].map(|triangle| choice.styles(0, triangle))
    };
    use LineStyle::{Boundary, Feature, NonManifold, Plain};
    assert_eq!(
        styles("all,boundary,non-manifold"),
        [
            [Some(NonManifold), Some(Plain), Some(Boundary)],
            [Some(Plain), Some(Boundary), Some(Boundary)]
        ]
    );
    // The surface is flat across the edge from 1 to 2.
    assert_eq!(styles("feature:1,boundary")[0][1], None);
    assert_eq!(styles("feature:0")[0][1], Some(Feature));
    assert!(EdgeChoice::new(&scene, EdgeKinds::ALL).is_none());
}
