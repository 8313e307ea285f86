//! `render --save-scene`: the scene that is saved, rendered alone, is the picture to the byte.

use raycast_tests::binary::{refuse, succeed};
use raycast_tests::files::{asset, bytes, folder};
use std::ffi::OsString;

fn words(words: &[&str]) -> Vec<OsString> {
    words.iter().map(OsString::from).collect()
}

#[test]
fn a_saved_scene_renders_to_the_bytes_of_the_picture() {
    let folder = folder();
    let texture = asset("leopard.png");
    let texture = texture.to_str().expect("Unicode");
    let cases: [(&[&str], &[&str]); 9] = [
        (&["monkey.obj"], &["--size", "61x47"]),
        (
            &["torus.obj", "monkey.obj"],
            &[
                "--orbit=33.3,12.1",
                "--size=70x41",
                "--step=0.0333",
                "--cull=back",
                "--precision=fast",
                "--samples=3",
                "--pixel-filter=mitchell",
                "--shift=0.25,-0.1",
                "--up-axis=z",
                "--mode=flat",
                "--wireframe=1.3",
                "--wireframe-edges=feature:25,silhouette",
                "--wireframe-hidden=0.3",
                "--background=#102030,#ffeedd",
            ],
        ),
        (
            &["torus.obj"],
            &[
                "--projection=orthographic",
                "--fov=31.7",
                "--size=64x48",
                "--clip=x:0.1",
                "--clip=-y:0.3",
                "--color=area",
                "--color-map=magma",
                "--legend",
            ],
        ),
        (
            &["torus.obj"],
            &[
                "--mode=texture",
                "--texture",
                texture,
                "--crop=3,5,40,31",
                "--wrap=mirror,clamp",
                "--texture-projection=sphere",
                "--texture-center=0.1,0.2,0.3",
                "--filter=ewa",
                "--blend=0.7",
                "--size=80x60",
                "--eye=1.7,0.9,2.3",
                "--up=0.1,1,0.3",
            ],
        ),
        (
            &["demo.raycast.toml"],
            &[
                "--projection=equirectangular",
                "--eye=1.3,0.8,0.9",
                "--target=0,0.9,0",
                "--size=90x45",
            ],
        ),
        (
            &["demo.raycast.toml"],
            &[
                "--lens=-0.3,0.1,0.001,-0.0005,0",
                "--size=70x50",
                "--pixel-filter=gaussian",
                "--samples=2",
            ],
        ),
        (
            &["demo.raycast.toml"],
            &["--cull=back", "--fov=33", "--size=50x50"],
        ),
        (
            &["demo.raycast.toml"],
            &["--stereo=pair", "--eye-distance=0.2", "--size=80x30"],
        ),
        (
            &["demo.raycast.toml"],
            &[
                "--projection=equirectangular",
                "--stereo=ods",
                "--eye-distance=0.2",
                "--eye=1.3,0.8,0.9",
                "--target=0,0.9,0",
                "--size=60x60",
            ],
        ),
    ];
    for (number, (files, options)) in cases.into_iter().enumerate() {
        let at = |name: &str| folder.path().join(format!("{number}-{name}"));
        let scene = at("scene.raycast.toml");
        let mut line = words(&["render"]);
        line.extend(files.iter().map(|file| asset(file).into()));
        line.extend(words(options));
        line.extend(["-o".into(), at("a.exr").into()]);
        line.extend(["--save-scene".into(), scene.clone().into()]);
        succeed(&line);
        let mut again = words(&["render"]);
        again.extend([scene.clone().into(), "-o".into(), at("b.exr").into()]);
        succeed(&again);
        let text = String::from_utf8_lossy(&bytes(&scene)).into_owned();
        assert!(
            bytes(&at("a.exr")) == bytes(&at("b.exr")),
            "{options:?}:\n{text}"
        );
        // Options go before what the scene says.
        again.extend(words(&["--cull=none", "--precision=exact", "--size=20x10"]));
        succeed(&again);
    }
}

#[test]
fn a_saved_scene_is_no_file_that_is_read_or_written() {
    let folder = folder();
    let mesh = folder.path().join("a.obj");
    std::fs::copy(asset("torus.obj"), &mesh).expect("a copy");
    let scene = folder.path().join("own.raycast.toml");
    std::fs::write(&scene, "[[object]]\nmesh = \"a.obj\"\n").expect("a scene");
    let message = |input: &std::path::Path, saved: &std::path::Path| {
        let mut line = words(&["render"]);
        line.extend([
            input.into(),
            "-o".into(),
            folder.path().join("a.png").into(),
        ]);
        line.extend(["--save-scene".into(), saved.into()]);
        refuse(2, &line)
    };
    let own = message(&scene, &scene);
    assert!(own.contains("reads or writes that already"), "{own}");
    let name = message(&mesh, &folder.path().join("scene.txt"));
    assert!(name.contains("ends in .toml"), "{name}");
    assert!(!folder.path().join("a.png").exists());
}
