//! A program that renders for days through the library does not grow: reading, building, rendering and
//! encoding in a loop leave nothing behind.
//!
//! `RAYCAST_LOOPS` says how many passes (200 where it is not set).

#![cfg(target_os = "linux")]
#![allow(clippy::print_stdout, reason = "tests tell what they measured")]

use raycast_core::Accel;
use raycast_core::camera::{Camera, Grid, ImagePlane, fov_to_frame};
use raycast_core::formats::read_scene;
use raycast_core::picture::{Format, Fragment, Picture};
use raycast_core::render::{Cancel, Settings, View};
use raycast_core::shade::Mode;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// Columns and rows of a pass's picture.
const SIZE: (u32, u32) = (160, 120);

/// Memory that is resident, in kB; open files; threads.
fn usage() -> (u64, usize, usize) {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux tells of a process");
    let number = |key: &str| {
        let line = status.lines().find_map(|line| line.strip_prefix(key));
        let word = line.and_then(|rest| rest.split_whitespace().next());
        word.and_then(|word| word.parse::<u64>().ok())
            .unwrap_or_else(|| panic!("{status} has no {key}"))
    };
    let files = std::fs::read_dir("/proc/self/fd").expect("Linux tells of files");
    (number("VmRSS:"), files.count(), number("Threads:") as usize)
}

/// Reads the demo scene, renders it, writes it and reads that again. The picture's bytes.
fn pass(mode: Mode) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/demo.raycast.toml");
    let file = read_scene(&path, &|_| ()).expect("the demo scene is good");
    let camera = file.camera.expect("the demo scene has a camera");
    let pose = camera.pose;
    let height = fov_to_frame(camera.frame, (pose.target - pose.eye).length());
    let plane = ImagePlane::new(SIZE.0, SIZE.1, height / f64::from(SIZE.1)).expect("a good plane");
    let accel = Accel::build(&file.scene).expect("the demo scene is good");
    let mut shading = file.shading.unwrap_or_default();
    shading.mode = mode;
    let view = View {
        scene: Arc::new(file.scene),
        accel: Arc::new(accel),
        camera: Camera::new(pose, camera.projection, plane),
        settings: Settings {
            shading,
            samples: 1,
            layers: true,
            ..Settings::default()
        },
    };
    let clock = || Duration::ZERO;
    let picture = view
        .render(Grid::default(), &clock, &Cancel::default(), &|_| ())
        .expect("nobody cancels");
    let exr = picture.encode(Format::Exr).expect("it has layers");
    let again = Picture::decode_exr(&exr).expect("it was just written");
    assert_eq!(again.layers, picture.layers);
    let png = picture.encode(Format::Png).expect("it has pixels");
    assert!(Fragment::decode("png", &png).is_err(), "it has no place");
    png
}

#[test]
fn rendering_in_a_loop_leaves_nothing_behind() {
    let loops = std::env::var("RAYCAST_LOOPS").map_or(Ok(200), |text| text.parse());
    let loops: usize = loops.expect("RAYCAST_LOOPS is a number");
    let modes = [Mode::Smooth, Mode::Texture, Mode::Wireframe];
    let first = modes.map(pass);
    let mut resident = Vec::with_capacity(loops);
    let mut held = Vec::with_capacity(loops);
    for number in 0..loops {
        let at = number % modes.len();
        assert_eq!(
            pass(modes[at]),
            first[at],
            "pass {number} is another picture"
        );
        let (kb, files, threads) = usage();
        resident.push(kb);
        held.push((files, threads));
    }
    // A fifth is for warming up.
    let tenth = (loops / 10).max(1);
    // What is freed may be resident a moment longer, as a thread's stack is until the system has reaped it: what is lost
    // stays in the lowest of a tenth.
    let lowest = |range: &[u64]| range.iter().copied().min().unwrap_or_default();
    let warm = (loops / 5).min(loops - 1);
    let early = lowest(&resident[warm..(warm + tenth).min(loops)]);
    let late = lowest(&resident[loops - tenth..]);
    // Such a thread is counted too.
    let most = |of: fn(&(usize, usize)) -> usize| held[..=warm].iter().map(of).max();
    let fewest = |of: fn(&(usize, usize)) -> usize| held[loops - tenth..].iter().map(of).min();
    assert!(
        fewest(|&(files, _)| files) <= most(|&(files, _)| files)
            && fewest(|&(_, threads)| threads) <= most(|&(_, threads)| threads),
        "files and threads: {held:?}"
    );
    println!("{loops} passes: {early} kB resident early, {late} kB late");
    // Losing one value a pixel a pass (4 · 160 · 120 bytes) would show as 12 MB in 160 passes; a
    // quarter of that is more than an allocator's places for what comes and goes differ by.
    let slack = (loops as u64 * 4 * u64::from(SIZE.0 * SIZE.1)).div_ceil(4 * 1024);
    assert!(
        late <= early + slack,
        "{early} kB, then {late} kB: {resident:?}"
    );
}
