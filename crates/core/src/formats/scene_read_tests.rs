//! Reading scene files.

use super::scene_file::SceneFile;
use super::*;
use crate::camera::Projection;
use crate::scene::{Color, ColorRule, Object, Photograph, TextureProjection, UpAxis, Wrap};
use crate::shade::{Background, EdgeKinds, Filter, Ground, Mode, Shading, Wireframe};
use glam::DVec3;
use std::path::{Path, PathBuf};

pub(super) const WHOLE: &str = r##"# A scene with everything.
[camera]
projection = "perspective"
eye = [3, 2.5, 5]
target = [0, 0, 0.1]
up = [0.0, 1.0, 0.0]
fov = 40.0

[image]
size = [1280, 720]
samples = 4
background = ["#20242c", "#3A4454"]

[shading]
mode = "barycentric"
wireframe = true
wireframe-width = 1.3
wireframe-edges = "feature:25,boundary"
wireframe-hidden = 0.2
blend = 0.7
filter = "nearest"
texture-projection = "triplanar"

[[object]]
name = "moon"
mesh = "./parts/a.obj"
color = "per-triangle"
seed = 3
texture = "t.ppm"
translate = [4, 0, 0]
parent = "planet"

[[object]]
name = "planet"
mesh = "parts/a.obj"
color = "#ff8000"
rotate = [0, 90, 0]
scale = [1, 2, -1]

[[object]]
mesh = "b.txt"
texture = "t.ppm"
"##;

pub(super) fn files(name: &str) -> Option<Vec<u8>> {
    match name {
        "parts/a.obj" => Some("mtllib a.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3".into()),
        "parts/a.mtl" => Some("newmtl x\nKd 0 1 0".into()),
        "groups.obj" => Some(
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\ng lid\nf 1 2 4\ng \"box\" é\nf 1 3 4\n".into(),
        ),
        "b.txt" => Some("(0,0,0);(1,0,0);(0,1,0)".into()),
        "wide.ppm" => Some("P3\n4 1\n255\n1 2 3 4 5 6 7 8 9 10 11 12\n".into()),
        "t.ppm" => Some("P3\n1 1\n255\n1 2 3\n".into()),
        "heat.ply" => Some(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             property float heat\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
             0 0 0 0\n1 0 0 0.5\n0 1 0 1\n3 0 1 2\n"
                .into(),
        ),
        "bad.obj" => Some("v 0 0 0\nf 1 2 3\n".into()),
        _ => None,
    }
}

pub(super) fn parse(text: &str) -> SceneFile {
    read_scene_from(text, &files).expect("a good scene")
}

#[test]
fn reads_everything() {
    let file = parse(WHOLE);
    let camera = file.camera.expect("a camera");
    assert_eq!(camera.pose.eye, DVec3::new(3.0, 2.5, 5.0));
    assert_eq!(camera.pose.target, DVec3::new(0.0, 0.0, 0.1));
    assert_eq!(
        (camera.projection, camera.frame),
        (Projection::Perspective, 40.0)
    );
    assert_eq!(file.image.size, Some((1280, 720)));
    assert_eq!(file.image.samples, Some(4));
    let shading = Shading {
        mode: Mode::Barycentric,
        wireframe: Some(Wireframe {
            width: 1.3,
            edges: EdgeKinds {
                feature: Some(25.0),
                boundary: true,
                ..EdgeKinds::NONE
            },
            hidden: 0.2,
            ..Wireframe::default()
        }),
        background: Background::default(),
        blend: 0.7,
        filter: Filter::Nearest,
        projection: TextureProjection::Triplanar,
        ..Shading::default()
    };
    assert_eq!(file.shading, Some(shading));
    let [moon, planet, plain] = &file.scene.objects[..] else {
        panic!("three objects");
    };
    assert_eq!((moon.parent, planet.parent), (Some(1), None));
    assert_eq!(moon.color, ColorRule::PerTriangle { seed: 3 });
    assert_eq!(planet.color, ColorRule::Uniform(Color([255, 128, 0])));
    assert_eq!(planet.transform.scale, DVec3::new(1.0, 2.0, -1.0));
    assert_eq!(plain.name, "b");
    assert!(Arc::ptr_eq(&moon.mesh, &planet.mesh), "one mesh, read once");
    let image = |object: &Object| object.texture.clone().expect("a texture");
    assert!(Arc::ptr_eq(&image(moon), &image(plain)));
    assert_eq!(moon.source.as_deref(), Some(Path::new("parts/a.obj")));
    assert_eq!(moon.mesh.materials()[0].color, Color([0, 255, 0]));
}

#[test]
fn x_ray_and_backs_are_read_and_written() {
    let text = "[shading]\nmode = \"x-ray\"\nground = \"-0.25\"\nback-faces = \"#010203\"\nx-ray-opacity = 0.25\n\
        [[object]]\nmesh = \"b.txt\"\n";
    let file = parse(text);
    let shading = Shading {
        mode: Mode::XRay,
        back_faces: Some(Color([1, 2, 3])),
        ground: Some(Ground::At(-0.25)),
        x_ray_opacity: 0.25,
        ..Shading::default()
    };
    assert_eq!(file.shading, Some(shading));
    let saved = file
        .to_toml(Path::new("/nowhere"))
        .expect("it can be saved");
    assert_eq!(parse(&saved).shading, Some(shading));
}

#[test]
fn an_object_declares_the_up_axis_of_its_file() {
    let text = "[[object]]\nmesh = \"b.txt\"\n[[object]]\nmesh = \"b.txt\"\nup-axis = \"z\"\n";
    let file = parse(text);
    let corner = |index: usize| file.scene.objects[index].mesh.corners(0).expect("corners")[2];
    assert_eq!(corner(0), glam::Vec3::Y);
    assert_eq!(corner(1), glam::Vec3::NEG_Z);
    let saved = file
        .to_toml(Path::new("/nowhere"))
        .expect("it can be saved");
    assert_eq!(saved.matches("up-axis").count(), 1, "{saved}");
    let again = parse(&saved);
    assert_eq!(again.scene.content(), file.scene.content());
    assert_eq!(again.scene.objects[1].up_axis, UpAxis::Z);
    assert!(
        file.notes[1].ends_with("z is taken to be up"),
        "{:?}",
        file.notes
    );
}

#[test]
fn missing_settings_are_left_to_the_caller() {
    let file = parse("");
    let nothing = "scene: the scene has no objects: there is nothing to see";
    assert_eq!(file.warnings, [nothing]);
    assert!(file.camera.is_none() && file.shading.is_none() && file.scene.objects.is_empty());
    assert_eq!(file.image, ImageSettings::default());
    let file = parse("[image]\nbackground = \"transparent\"\n");
    let shading = Shading {
        background: Background::Transparent,
        ..Shading::default()
    };
    assert_eq!(file.shading, Some(shading));
}

/// Two objects with parts of one image, each mapped differently.
pub(super) const MAPPED: &str = r##"[[object]]
mesh = "b.txt"
texture = "wide.ppm"
crop = [1, 0, 2, 1]
wrap = ["mirror", "border:#ff0000"]
texture-projection = "cylinder"
texture-center = [0.5, 0.25, 0]
texture-size = [1, 3]

[[object]]
mesh = "b.txt"
texture = "wide.ppm"
texture-projection = "per-triangle"
texture-camera = { eye = [3, 2, 4], target = [0, 0.5, 0], fov = 35.5, shift = [0.25, 0], lens = [-0.1, 0.02, 0, 0, 0] }
"##;

#[test]
fn a_scalar_that_blends_is_one_of_the_meshes() {
    let text = "[[object]]\nmesh = \"heat.ply\"\ntexture = \"t.ppm\"\nblend-by = \"heat\"\n";
    let file = parse(text);
    let object = &file.scene.objects[0];
    assert_eq!(object.blend_numbers(0), Some([0.0, 0.5, 1.0]));
    let saved = file.to_toml(Path::new("/nowhere")).expect("it is saved");
    let again = parse(&saved);
    assert_eq!(again.scene.objects[0].blend_by, object.blend_by);
    let message = |text: &str| {
        read_scene_from(text, &files)
            .expect_err("refused")
            .to_string()
    };
    assert_eq!(
        message(&text.replace("\"heat\"", "\"cold\"")),
        "scene:4: expected one of the mesh's scalars, \"heat\", found \"cold\""
    );
    assert_eq!(
        message(&text.replace("heat.ply", "b.txt")),
        "scene:4: expected no `blend-by`: the mesh has no scalars, found \"heat\""
    );
}

/// Images are decoded together, and the first fault in the file is reported.
#[test]
fn each_object_has_its_own_of_several_images() {
    let table = |texture: &str| format!("[[object]]\nmesh = \"b.txt\"\ntexture = \"{texture}\"\n");
    let scene = |names: &[&str]| names.iter().map(|name| table(name)).collect::<String>();
    let file = parse(&scene(&["wide.ppm", "t.ppm", "wide.ppm"]));
    let texels = |at: usize| {
        file.scene.objects[at]
            .texture
            .as_ref()
            .map(|texture| texture.texels())
    };
    assert_eq!(texels(1), Some(&[[1, 2, 3, 255]][..]));
    assert_eq!(texels(0), texels(2));
    assert_eq!(texels(0).map(|texels| texels.len()), Some(4));
    for (names, fault) in [
        (
            ["t.ppm", "bad.obj", "wide.ppm"],
            "bad.obj: expected an image",
        ),
        (["t.ppm", "none.ppm", "bad.obj"], "scene:6: "),
        (
            ["bad.obj", "none.ppm", "t.ppm"],
            "bad.obj: expected an image",
        ),
    ] {
        let error = read_scene_from(&scene(&names), &files).expect_err("a fault");
        assert!(error.to_string().starts_with(fault), "{names:?}: {error}");
    }
}

#[test]
fn textures_have_their_own_crop_wrap_and_projector() {
    let file = parse(MAPPED);
    let [first, second] = &file.scene.objects[..] else {
        panic!("two objects");
    };
    let texture = first.texture.as_ref().expect("a texture");
    assert_eq!(texture.texels(), [[4, 5, 6, 255], [7, 8, 9, 255]]);
    let red = Wrap::Border(Some(Color([255, 0, 0])));
    assert_eq!(texture.wrap(), [Wrap::Mirror, red]);
    let projector = first.mapping.projector.expect("a place");
    assert_eq!(projector.center, DVec3::new(0.5, 0.25, 0.0));
    assert_eq!((projector.front, projector.up), (DVec3::Z, DVec3::Y));
    assert_eq!(projector.size.to_array(), [1.0, 3.0]);
    let whole = second.texture.as_ref().expect("a texture");
    assert_eq!((whole.width(), whole.crop()), (4, None));
    assert_eq!(
        second.mapping.projection,
        Some(TextureProjection::PerTriangle)
    );
    assert_eq!(second.mapping.projector, None);
    let photograph = Photograph {
        eye: DVec3::new(3.0, 2.0, 4.0),
        target: DVec3::new(0.0, 0.5, 0.0),
        up: DVec3::Y,
        fov: 35.5,
        shift: [0.25, 0.0],
        lens: Some([-0.1, 0.02, 0.0, 0.0, 0.0]),
    };
    assert_eq!(second.mapping.photograph, Some(photograph));
    let message = |from: &str, to: &str| {
        let text = MAPPED.replacen(from, to, 1);
        let error = read_scene_from(&text, &files).expect_err(to);
        error.to_string()
    };
    assert_eq!(
        message("crop = [1, 0, 2, 1]", "crop = [3, 0, 2, 1]"),
        "scene:4: expected a part of an image of 4x1, found [3, 0, 2, 1]"
    );
    assert_eq!(
        message("eye = [3, 2, 4]", "eye = [0, 0.5, 0]"),
        "scene:14: a camera cannot look from [0.0, 0.5, 0.0] at the same point: expected a target away from the eye"
    );
    let fov = message("fov = 35.5", "fov = 180");
    assert!(fov.starts_with("scene:14: "), "{fov}");
    assert_eq!(
        message("texture = \"wide.ppm\"\n", ""),
        "scene:3: expected a `texture` beside what says how it lies, found none"
    );
    let wrap = message("mirror", "bounce");
    assert!(
        wrap.starts_with("scene:5: ") && wrap.contains("\"bounce\""),
        "{wrap}"
    );
    assert_eq!(
        message("texture-size = [1, 3]", "texture-up = [0, 0, 1e-9]"),
        "scene:7: expected a texture's front and up in two directions, found [0, 0, 1] and [0, 0, 0.000000001]"
    );
    assert_eq!(
        message("texture-size = [1, 3]", "texture-size = [1, -3]"),
        "scene:7: expected a texture's size above 0, found [1, -3]"
    );
}

#[test]
fn files_append() {
    let mut file = parse("[image]\nsamples = 2\n[[object]]\nmesh = \"b.txt\"");
    file.append(parse(WHOLE));
    let opened = ["b.txt", "parts/a.obj", "parts/a.mtl", "t.ppm"].map(PathBuf::from);
    assert_eq!(file.opened, opened, "what both opened is named once");
    assert_eq!(file.scene.objects.len(), 4);
    assert_eq!(file.scene.objects[1].parent, Some(2));
    assert_eq!(file.image.samples, Some(2));
    assert_eq!(file.image.size, Some((1280, 720)));
}

/// A file of a hundred thousand keyframes is read once, not as often as it has keyframes: that would take minutes.
#[test]
fn many_keyframes_are_read_in_one_go() {
    use std::fmt::Write;
    let mut text = "[animation]\n".to_owned();
    for at in 0..100_000 {
        let key = format!("[[animation.key]]\nat = {at}\neye = [0, 0, 9]\ntarget = [0, 0, 0]");
        writeln!(text, "{key}").expect("text can be written");
    }
    let path = parse(&text).animation.expect("an animation");
    assert_eq!(path.keys().len(), 100_000);
}
