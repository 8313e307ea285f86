//! Pictures of objects that photographs are projected onto.

use super::{Cancel, Pass, Settings, View};
use crate::bvh::Accel;
use crate::camera::{Camera, Grid, ImagePlane, Pose, Projection};
use crate::hit::Cull;
use crate::picture::Picture;
use crate::scene::{
    ClippingPlane, ClippingPlanes, Color, ColorRule, Object, Photograph, Scene, Shape, Texture,
    TextureProjection,
};
use crate::shade::{Filter, Mode, Shading};
use glam::{DVec2, DVec3};
use std::sync::{Arc, Mutex};
use std::time::Duration;

const CLOCK: &(dyn Fn() -> Duration + Sync) = &|| Duration::ZERO;

const EYE: DVec3 = DVec3::new(1.5, 2.5, 3.0);

/// The camera of the photographs: 50 degrees above the horizon.
const TAKEN: Photograph = Photograph {
    eye: EYE,
    target: DVec3::ZERO,
    up: DVec3::Y,
    fov: 50.0,
    shift: [0.0; 2],
    lens: None,
};

const WHITE: Color = Color([255; 3]);

fn object(name: &str, shape: Shape, at: DVec3) -> Object {
    let mesh = shape.mesh().expect("a shape");
    let mut object = Object::new(name, Arc::new(crate::scene::Mesh::new(mesh)));
    object.transform.translate = at;
    object.color = ColorRule::PerTriangle { seed: 7 };
    object
}

/// A ring in two objects, so that there are instances, in front of a floor.
fn rings() -> Scene {
    let ring = Shape::Torus {
        radius: 0.8,
        tube: 0.3,
        segments: 40,
        rings: 24,
    };
    let first = object("first", ring, DVec3::new(-0.2, 0.3, 0.1));
    let mut second = Object {
        name: "second".to_owned(),
        ..first.clone()
    };
    second.transform.rotate = DVec3::new(80.0, 20.0, 0.0);
    let floor = Shape::Plane {
        size: DVec2::splat(6.0),
    };
    Scene {
        objects: vec![first, second, object("floor", floor, DVec3::NEG_Y * 0.7)],
    }
}

fn view(scene: Scene, eye: DVec3, settings: Settings) -> View {
    let target = DVec3::ZERO;
    let pose = Pose {
        eye,
        target,
        up: DVec3::Y,
    };
    let frame = crate::camera::fov_to_frame(50.0, eye.length());
    let plane = ImagePlane::new(97, 71, frame / 71.0).expect("a good plane");
    View {
        accel: Arc::new(Accel::build(&scene).expect("a valid scene")),
        scene: Arc::new(scene),
        camera: Camera::new(pose, Projection::Perspective, plane),
        settings,
    }
}

fn settings(mode: Mode, projection: TextureProjection) -> Settings {
    Settings {
        shading: Shading {
            mode,
            projection,
            filter: Filter::Nearest,
            ..Shading::default()
        },
        ..Settings::default()
    }
}

fn render(view: &View, grid: Grid) -> Picture {
    let picture = view.render(grid, CLOCK, &Cancel::default(), &|_| ());
    picture.expect("nothing cancels it")
}

/// The scene in white, with a picture of it as every object's texture.
fn textured(mut scene: Scene, picture: &Picture) -> Scene {
    let texture = Texture::new(picture.width, picture.height, picture.pixels.clone());
    let texture = texture.map(Arc::new).expect("as many texels");
    for object in &mut scene.objects {
        object.texture = Some(Arc::clone(&texture));
        object.color = ColorRule::Uniform(WHITE);
        object.mapping.photograph = Some(TAKEN);
    }
    scene
}

/// A photograph of the scene gives the scene's colours back, seen from its own camera: culled, clipped and whole.
#[test]
fn a_photograph_of_the_scene_gives_its_colors_back() {
    let cut = ClippingPlane::new(DVec3::new(-1.0, 0.2, 0.0), -0.3).expect("a plane");
    let cut = ClippingPlanes::new(&[cut]).expect("one");
    for (cull, clip) in [
        (Cull::None, ClippingPlanes::NONE),
        (Cull::Back, ClippingPlanes::NONE),
        (Cull::Back, cut),
    ] {
        let with = |settings: Settings| Settings {
            cull,
            clip,
            ..settings
        };
        let colors = settings(Mode::Color, TextureProjection::Uv);
        let taken = render(&view(rings(), EYE, with(colors)), Grid::Size(32));
        let shown = settings(Mode::Texture, TextureProjection::Camera);
        let scene = textured(rings(), &taken);
        let again = view(scene.clone(), EYE, with(shown));
        for grid in [Grid::Size(16), Grid::Size(97)] {
            assert!(render(&again, grid).pixels == taken.pixels, "{cull:?}");
        }
        // From another eye parts are visible that the photograph does not show.
        let elsewhere = view(scene, DVec3::new(-3.0, 1.0, 1.0), with(shown));
        let elsewhere = render(&elsewhere, Grid::Size(32));
        let white = elsewhere
            .pixels
            .iter()
            .filter(|pixel| pixel[..3] == [255; 3]);
        assert!(white.count() > 300);
    }
}

/// A square over a floor, halfway to the eye, hides a square of the floor twice as wide; beyond the image's frame
/// nothing is projected.
#[test]
fn occluders_and_the_frame_bound_what_a_photograph_shows() {
    let floor = Shape::Plane {
        size: DVec2::splat(8.0),
    };
    let cover = Shape::Plane {
        size: DVec2::splat(1.0),
    };
    let red = Picture {
        width: 20,
        height: 10,
        pixels: vec![[255, 0, 0, 255]; 200],
        layers: None,
    };
    let mut scene = textured(
        Scene {
            objects: vec![
                object("floor", floor, DVec3::ZERO),
                object("cover", cover, DVec3::Y * 2.0),
            ],
        },
        &red,
    );
    // The eye is 4 above: a frame of 4 by 8, its height along z.
    for object in &mut scene.objects {
        object.mapping.photograph = Some(Photograph {
            eye: DVec3::Y * 4.0,
            target: DVec3::ZERO,
            up: DVec3::NEG_Z,
            fov: 2.0 * crate::math::atan(0.5).to_degrees(),
            ..TAKEN
        });
    }
    scene.objects[1].color = ColorRule::Uniform(Color([0, 255, 0]));
    let mut view = view(scene, DVec3::new(2.0, 5.0, 6.0), {
        settings(Mode::Texture, TextureProjection::Camera)
    });
    view.settings.layers = true;
    let picture = render(&view, Grid::Size(32));
    let layers = picture.layers.as_ref().expect("layers");
    let mut counts = [0; 3];
    for (at, pixel) in picture.pixels.iter().enumerate() {
        let (x, y) = ((at % 97) as f64 + 0.5, (at / 97) as f64 + 0.5);
        let point = view.camera.ray(x, y).at(layers.depth[at].into());
        let away = |from: f64| (from - point.x.abs().max(point.z.abs())).abs();
        if layers.object[at] != 0 || away(1.0) < 1e-3 {
            // All of the cover is in the frame and visible.
            assert!(layers.object[at] != 1 || pixel[..3] == [255, 0, 0]);
            continue;
        }
        if (point.z.abs() - 2.0).abs() < 1e-3 || (point.x.abs() - 4.0).abs() < 1e-3 {
            continue;
        }
        let is_hidden = point.x.abs().max(point.z.abs()) < 1.0;
        let is_framed = point.z.abs() < 2.0 && point.x.abs() < 4.0;
        let shows = is_framed && !is_hidden;
        assert_eq!(pixel[1] == 0, shows, "{point} {pixel:?}");
        counts[usize::from(is_hidden) + 2 * usize::from(shows)] += 1;
    }
    assert!(counts.iter().all(|&count| count > 50), "{counts:?}");
}

/// Passes, samples, layers and translucent surfaces all test the visibility of each hit.
#[test]
fn passes_samples_layers_and_translucency_agree_on_what_photographs_see() {
    let colors = settings(Mode::Color, TextureProjection::Uv);
    let taken = render(&view(rings(), EYE, colors), Grid::Size(32));
    let eye = DVec3::new(-2.0, 1.0, 3.0);
    for mode in [Mode::Texture, Mode::Smooth, Mode::XRay] {
        let shown = settings(mode, TextureProjection::Camera);
        let view = view(textured(rings(), &taken), eye, shown);
        let whole = render(&view, Grid::Size(97));
        let mut layered = view.clone();
        layered.settings.layers = true;
        assert!(
            render(&layered, Grid::Size(32)).pixels == whole.pixels,
            "{mode:?}"
        );
        let tiles = Grid::Size(32).tiles(97, 71);
        let passes = [4, 1].map(|stride| Pass { stride, samples: 1 });
        let shown = Mutex::new(Picture::blank(97, 71, false));
        let coarse = Mutex::new(0);
        view.render_progressively(&tiles, &passes, CLOCK, &Cancel::default(), &|pass, tile| {
            let mut shown = shown.lock().expect("no sink panics");
            shown.paste(tile.rect, &tile.pixels, None);
            if pass.stride == 4 {
                let first = tile.rect.y as usize * 97 + tile.rect.x as usize;
                *coarse.lock().expect("no sink panics") +=
                    u32::from(tile.pixels[0] == whole.pixels[first]);
            }
        });
        assert!(
            shown.into_inner().expect("whole").pixels == whole.pixels,
            "{mode:?}"
        );
        // A coarse pass shows rays of the full picture.
        assert_eq!(coarse.into_inner().expect("whole"), tiles.len() as u32);
    }
}
