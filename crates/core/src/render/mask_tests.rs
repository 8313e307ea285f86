//! Pictures of masked and blended materials. The truth is every triangle, tested one by one.

use super::{Cancel, Pass, Settings, View};
use crate::bvh::Accel;
use crate::camera::{Camera, Grid, ImagePlane, Panorama, Pose, Projection};
use crate::hit::Cull;
use crate::picture::Picture;
use crate::random::Random;
use crate::scene::{
    Alpha, Attribute, ClippingPlane, ClippingPlanes, Color, Masks, Material, Mesh, MeshData,
    Object, Opacity, Scene, Texture,
};
use crate::shade::{Background, Mode, Shading};
use glam::{DVec3, Vec2};
use std::sync::{Arc, Mutex};
use std::time::Duration;

const CLOCK: &(dyn Fn() -> Duration + Sync) = &|| Duration::ZERO;

/// An image of round leaves.
fn leaf() -> Arc<Texture> {
    let side = 16u32;
    let texels = (0..side * side).map(|at| {
        let (x, y) = (at % side, at / side);
        let (x, y) = (x as f32 - 7.5, y as f32 - 7.5);
        let away = (x * x + y * y).sqrt();
        [
            40,
            160,
            30,
            (255.0 * (1.5 - away / 6.0)).clamp(0.0, 255.0) as u8,
        ]
    });
    Arc::new(Texture::new(side, side, texels.collect()).expect("as many texels"))
}

/// Squares of two triangles, each with the whole image.
fn squares(places: &[[DVec3; 4]], opacity: Opacity) -> Mesh {
    let corner = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let count = places.len() as u32;
    let mut material = Material::new("leaf", Color([40, 160, 30]));
    material.opacity = opacity;
    Mesh::new(MeshData {
        positions: places.iter().flatten().copied().collect(),
        triangles: (0..count)
            .flat_map(|i| [[4 * i, 4 * i + 1, 4 * i + 2], [4 * i, 4 * i + 2, 4 * i + 3]])
            .collect(),
        uvs: Some(Attribute {
            values: places.iter().flat_map(|_| corner).collect(),
            indices: None,
        }),
        materials: vec![material],
        material_of_triangle: vec![0; 2 * places.len()],
        ..MeshData::default()
    })
}

fn mask(alpha: Alpha) -> Opacity {
    Opacity::Mask {
        alpha,
        cutoff: Opacity::CUTOFF,
    }
}

/// A cloud of leaves, as two objects, in front of an opaque square.
fn cloud() -> Scene {
    let mut random = Random(71);
    let places: Vec<_> = (0..300)
        .map(|_| {
            let middle = random.point();
            let (p, q) = (random.point() * 0.15, random.point() * 0.15);
            [
                middle - p - q,
                middle + p - q,
                middle + p + q,
                middle - p + q,
            ]
        })
        .collect();
    let alpha = Alpha {
        factor: 1.0,
        image: Some(leaf()),
    };
    let leaves = Arc::new(squares(&places, mask(alpha)));
    let wall = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let wall = wall.map(|(x, y)| DVec3::new(x, y, -0.8));
    let mut twin = Object::new("twin", Arc::clone(&leaves));
    twin.transform.rotate = DVec3::new(10.0, 80.0, 0.0);
    Scene {
        objects: vec![
            Object::new("leaves", leaves),
            twin,
            Object::new("wall", Arc::new(squares(&[wall], Opacity::Opaque))),
        ],
    }
}

fn view(scene: Scene, projection: Projection, settings: Settings) -> View {
    let pose = Pose {
        eye: DVec3::new(0.5, 0.7, 3.0),
        target: DVec3::ZERO,
        up: DVec3::Y,
    };
    let plane = ImagePlane::new(90, 64, 0.04).expect("a good plane");
    View {
        accel: Arc::new(Accel::build(&scene).expect("a valid scene")),
        scene: Arc::new(scene),
        camera: Camera::new(pose, projection, plane),
        settings,
    }
}

fn render(view: &View, grid: Grid) -> Picture {
    let picture = view.render(grid, CLOCK, &Cancel::default(), &|_| ());
    picture.expect("nothing cancels it")
}

fn layers() -> Settings {
    Settings {
        layers: true,
        ..Settings::default()
    }
}

#[test]
fn pixels_show_the_nearest_hit_that_masks_keep() {
    let cut = ClippingPlane::new(DVec3::new(0.2, 0.1, -1.0), -0.3).expect("a plane");
    let cut = ClippingPlanes::new(&[cut]).expect("one plane");
    let fisheye = Projection::Panoramic(Panorama::Equidistant);
    let cases = [
        (Projection::Perspective, Cull::None, ClippingPlanes::NONE),
        (Projection::Orthographic, Cull::Back, ClippingPlanes::NONE),
        (Projection::Perspective, Cull::Back, cut),
        (fisheye, Cull::None, cut),
    ];
    for (projection, cull, clip) in cases {
        let settings = Settings {
            cull,
            clip,
            ..layers()
        };
        let view = view(cloud(), projection, settings);
        let masks = Masks::of(&view.scene);
        let masks = masks.as_ref().expect("masks");
        let kept = view.accel.clipped(&clip).masked(Some(masks));
        let shown = render(&view, Grid::default()).layers.expect("layers");
        let (mut leaves, mut rejected) = (0, 0);
        for at in 0..shown.depth.len() {
            let (x, y) = ((at % 90) as f64 + 0.5, (at / 90) as f64 + 0.5);
            let ray = view.camera.ray(x, y);
            let truth = kept.cast_brute_force(&ray, cull);
            assert_eq!(kept.cast(&ray, cull), truth);
            let numbers = truth.map_or((u32::MAX, u32::MAX), |hit| (hit.object, hit.triangle));
            assert_eq!((shown.object[at], shown.triangle[at]), numbers, "{x} {y}");
            let depth = truth.map_or(f32::INFINITY, |hit| hit.t as f32);
            assert_eq!(shown.depth[at], depth);
            leaves += u32::from(numbers.0 < 2);
            let geometry = view.accel.clipped(&clip).cast(&ray, cull);
            rejected += u32::from(geometry != truth);
        }
        assert!(leaves > 100 && rejected > 100, "{leaves} {rejected}");
    }
}

#[test]
fn pictures_with_masks_and_layers_are_the_same_for_any_split_and_tree() {
    let mut blended = cloud();
    let glass = Alpha {
        factor: 0.4,
        image: None,
    };
    let places = [[-0.5, -0.5], [0.6, -0.5], [0.6, 0.4], [-0.5, 0.4]];
    let places = places.map(|[x, y]| DVec3::new(x, y, 0.9));
    let pane = Arc::new(squares(&[places], Opacity::Blend(glass)));
    blended.objects.push(Object::new("glass", pane));
    for mode in Mode::ALL {
        for samples in [1, 3] {
            let settings = Settings {
                shading: Shading {
                    mode,
                    background: Background::Transparent,
                    back_faces: Some(Color([200, 0, 200])),
                    ..Shading::default()
                },
                samples,
                ..Settings::default()
            };
            let one = view(blended.clone(), Projection::Perspective, settings);
            let whole = render(&one, Grid::default());
            let split = render(&one, Grid::Size(7));
            assert!(whole == split, "{mode:?} {samples}");
            let placed = View {
                accel: Arc::new(Accel::build_instances(&blended).expect("a valid scene")),
                ..one.clone()
            };
            assert!(
                whole == render(&placed, Grid::Size(64)),
                "{mode:?} {samples}"
            );
            // A coarse pass shows rays of the full picture.
            let tiles = Grid::Size(32).tiles(90, 64);
            let pass = Pass {
                stride: 4,
                samples: 1,
            };
            let come = Mutex::new(Vec::new());
            let sink = |_: Pass, tile: super::Tile| come.lock().expect("no panic").push(tile);
            one.render_progressively(&tiles, &[pass], CLOCK, &Cancel::default(), &sink);
            for tile in come.into_inner().expect("no panic") {
                let super::Tile { rect, pixels, .. } = tile;
                let at = rect.y as usize * 90 + rect.x as usize;
                assert!(samples > 1 || pixels[0] == whole.pixels[at], "{mode:?}");
            }
        }
    }
}

/// Coincident squares, of which the masks keep one, or some.
#[test]
fn of_ten_thousand_coincident_layers_the_lowest_that_is_kept_counts() {
    let place = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let place = place.map(|(x, y)| DVec3::new(x, y, 0.0));
    let layer = |factor: f32| {
        let alpha = Alpha {
            factor,
            image: None,
        };
        Arc::new(squares(&vec![place; 5000], mask(alpha)))
    };
    let clear = layer(0.25);
    for (last, shown) in [(0.75, 2), (0.5, 2), (0.25, u32::MAX)] {
        let objects = [Arc::clone(&clear), Arc::clone(&clear), layer(last)];
        let objects = objects.map(|mesh| Object::new("layers", mesh));
        let scene = Scene {
            objects: objects.into(),
        };
        let mut view = view(scene, Projection::Perspective, layers());
        let plane = ImagePlane::new(9, 7, 0.1).expect("a good plane");
        let pose = view.camera.pose();
        view.camera = Camera::new(pose, Projection::Perspective, plane);
        let picture = render(&view, Grid::default()).layers.expect("layers");
        for (object, triangle) in picture.object.iter().zip(&picture.triangle) {
            assert_eq!(*object, shown);
            assert!(shown == u32::MAX || *triangle < 2, "{triangle}");
        }
    }
}

/// Panes in a row, the nearest of them last in the file.
#[test]
fn blended_panes_are_composited_in_the_order_of_the_ray() {
    let pane = |z: f64, color: Color, opacity: Opacity| {
        let place = [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)];
        let place = place.map(|(x, y)| DVec3::new(x, y, z));
        let mesh = Arc::new(squares(&[place], opacity));
        let mut object = Object::new("pane", mesh);
        object.color = crate::scene::ColorRule::Uniform(color);
        object
    };
    let (red, green, blue) = (Color([255, 0, 0]), Color([0, 255, 0]), Color([0, 0, 255]));
    let glass = |factor| {
        Opacity::Blend(Alpha {
            factor,
            image: None,
        })
    };
    let mut objects = vec![
        pane(-2.0, blue, Opacity::Opaque),
        pane(0.0, green, glass(0.25)),
        pane(-3.0, red, Opacity::Opaque),
        pane(1.0, red, glass(0.5)),
    ];
    let color = |objects: &[Object], mode: Mode| {
        let settings = Settings {
            shading: Shading {
                mode,
                x_ray_opacity: 0.5,
                background: Background::Transparent,
                ..Shading::default()
            },
            ..layers()
        };
        let scene = Scene {
            objects: objects.to_vec(),
        };
        let view = view(scene, Projection::Orthographic, settings);
        render(&view, Grid::default()).layers.expect("layers").color[90 * 32 + 45]
    };
    assert_eq!(color(&objects, Mode::Color), [0.5, 0.125, 0.375, 1.0]);
    objects.truncate(2);
    assert_eq!(color(&objects, Mode::Color), [0.0, 0.25, 0.75, 1.0]);
    objects.remove(0);
    // With premultiplied alpha.
    assert_eq!(color(&objects, Mode::Color), [0.0, 0.25, 0.0, 0.25]);
    let [_, _, _, opacity] = color(&objects, Mode::XRay);
    let straight = DVec3::new(0.5, 0.7, 3.0).normalize().z;
    let expected = 0.5 / (0.5 + 0.5 * straight as f32);
    assert!((opacity - expected).abs() < 1e-5, "{opacity} {expected}");
}

#[test]
fn backs_alone_are_in_their_own_color() {
    let own = Color([1, 200, 3]);
    let settings = |back_faces, cull| Settings {
        shading: Shading {
            mode: Mode::Color,
            back_faces,
            background: Background::Transparent,
            ..Shading::default()
        },
        cull,
        ..Settings::default()
    };
    let view = |settings| view(cloud(), Projection::Perspective, settings);
    let plain = render(&view(settings(None, Cull::None)), Grid::default());
    let view = view(settings(Some(own), Cull::None));
    let colored = render(&view, Grid::default());
    let masks = Masks::of(&view.scene);
    let kept = view
        .accel
        .clipped(&ClippingPlanes::NONE)
        .masked(masks.as_ref());
    let mut backs = 0;
    for (at, (plain, colored)) in plain.pixels.iter().zip(&colored.pixels).enumerate() {
        let ray = view
            .camera
            .ray((at % 90) as f64 + 0.5, (at / 90) as f64 + 0.5);
        let hit = kept.cast(&ray, Cull::None);
        let front = kept.cast(&ray, Cull::Back);
        if hit == front {
            assert_eq!(plain, colored);
        } else {
            assert_eq!(*colored, [1, 200, 3, 255]);
            backs += 1;
        }
    }
    assert!(backs > 100, "{backs}");
}
