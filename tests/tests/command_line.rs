//! The real binary, from outside: kinds of image, instruction sets, statistics, help, the report.

use raycast_tests::arguments;
use raycast_tests::binary::{command, refuse, run, succeed};
use raycast_tests::files::{asset, bytes, folder, names, write, write_rays};
use serde_json::Value;
use std::path::Path;

/// The channels that the format promises, with the truth in them.
#[test]
fn exr_holds_depth_and_numbers() {
    use exr::prelude::*;
    let folder = folder();
    let output = folder.path().join("a.exr");
    let mesh = asset("cube.obj");
    succeed(arguments![
        "render", &mesh, "-o", &output, "--size", "48x40", "--eye", "0,0,5", "--target", "0,0,0"
    ]);
    let image = read_first_flat_layer_from_file(&output).expect("an EXR");
    let channel = |name: &str| {
        let channels = &image.layer_data.channel_data.list;
        let found = channels.iter().find(|channel| channel.name.eq(name));
        &found
            .unwrap_or_else(|| panic!("no channel {name}"))
            .sample_data
    };
    for name in ["R", "G", "B", "A", "N.X", "N.Y", "N.Z", "uv.U", "uv.V"] {
        assert_eq!(channel(name).len(), 48 * 40, "{name}");
    }
    let (FlatSamples::F32(depth), FlatSamples::U32(object), FlatSamples::U32(triangle)) =
        (channel("Z"), channel("id.object"), channel("id.triangle"))
    else {
        panic!("Z must be 32-bit floats, id.object and id.triangle 32-bit unsigned");
    };
    assert_eq!(
        (depth[0], object[0], triangle[0]),
        (f32::INFINITY, u32::MAX, u32::MAX)
    );
    let middle = 20 * 48 + 24;
    assert!(
        depth[middle] > 1.0 && depth[middle] < 5.0,
        "{}",
        depth[middle]
    );
    assert_eq!(object[middle], 0);
    assert!(triangle[middle] < 12);
}

#[test]
fn other_kinds_of_image_are_written() {
    let folder = folder();
    for (name, start) in [
        ("a.ppm", &b"P6"[..]),
        ("a.jpg", b"\xff\xd8"),
        ("a.PNG", b"\x89PNG"),
    ] {
        let output = folder.path().join(name);
        succeed(arguments![
            "render",
            asset("cube.obj"),
            "-o",
            &output,
            "--size",
            "40x30"
        ]);
        assert!(bytes(&output).starts_with(start), "{name}");
    }
    assert_eq!(names(folder.path()).len(), 3, "nothing else is left behind");
}

/// Without a display the window cannot open: one line that names what works.
#[cfg(target_os = "linux")]
#[test]
fn without_a_display_the_window_says_what_to_do() {
    for arguments in [vec![], arguments!["view"], arguments![asset("cube.obj")]] {
        let mut command = command(arguments);
        command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
        command.env_remove("WAYLAND_SOCKET");
        let message = run(&mut command);
        assert_eq!(message.status, Some(1), "{message:?}");
        assert_eq!(message.errors.lines().count(), 1, "{message:?}");
        assert!(message.errors.contains("raycast render"), "{message:?}");
    }
}

/// Every command that builds a tree takes the instruction set from the environment, and refuses one
/// that there is not.
#[test]
fn the_instruction_set_is_forced_everywhere() {
    let mesh = asset("cube.obj");
    let folder = folder();
    let place = |name: &str| folder.path().join(name);
    let rays = place("rays");
    write_rays(&rays, &[[0.0, 0.0, 9.0, 0.0, 0.0, 0.0, -1.0, 1e9]]);
    let commands = [
        arguments![],
        arguments!["view", &mesh],
        arguments!["render", &mesh, "-o", place("a.png"), "--size", "8x8"],
        arguments!["cast", &mesh, "--rays", &rays, "--hits", place("h")],
        arguments!["info", &mesh],
        arguments!["bench", &mesh, "--frames", "1"],
        arguments!["verify", &mesh, "--size", "8x8"],
        arguments!["report", &mesh, "-o", place("report"), "--quick"],
    ];
    for arguments in commands {
        let mut command = command(&arguments);
        let message = run(command.env("RAYCAST_SIMD", "mmx"));
        assert_eq!(message.status, Some(2), "{arguments:?}: {message:?}");
        assert_eq!(message.errors.lines().count(), 1, "{message:?}");
        let named = message
            .errors
            .contains("RAYCAST_SIMD: expected plain, neon or avx2");
        assert!(named && message.errors.contains("mmx"), "{message:?}");
    }
    let mut bench = command(arguments!["bench", &mesh, "--frames", "1", "--size", "8x8"]);
    let message = run(bench.env("RAYCAST_SIMD", "plain"));
    assert_eq!(json(&message.output)[0]["simd"], "plain");
    let mut verify = command(arguments!["verify", &mesh, "--size", "64x64"]);
    assert_eq!(run(verify.env("RAYCAST_SIMD", "plain")).status, Some(0));
}

fn json(bytes: &[u8]) -> Value {
    serde_json::from_slice(bytes)
        .unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(bytes)))
}

#[test]
fn stats_have_their_keys() {
    let folder = folder();
    let rays = folder.path().join("rays");
    write_rays(&rays, &[[0.0, 0.0, 9.0, 0.0, 0.0, 0.0, -1.0, 1e9]; 10]);
    let mesh = asset("cube.obj");
    let render = arguments![
        "render",
        &mesh,
        "-o",
        folder.path().join("a.png"),
        "--size",
        "30x20",
        "--threads",
        "2",
        "--stats",
        "-"
    ];
    let cast = arguments![
        "cast",
        &mesh,
        "--rays",
        rays,
        "--hits",
        folder.path().join("h"),
        "--threads",
        "2",
        "--stats",
        "-"
    ];
    for (arguments, rays) in [(render, 600), (cast, 10)] {
        let stats = json(&succeed(arguments).output);
        for key in [
            "triangles",
            "dropped",
            "load_ms",
            "build_ms",
            "cast_ms",
            "shade_ms",
            "total_ms",
            "rays",
            "hits",
            "mrays_per_s",
            "threads",
            "peak_bytes",
        ] {
            assert!(stats[key].is_number(), "{key}: {stats}");
        }
        assert!(stats["simd"].is_string(), "{stats}");
        assert_eq!(stats["triangles"], 12);
        assert_eq!(stats["dropped"], 0);
        assert_eq!(stats["rays"], rays);
        assert_eq!(stats["threads"], 2);
        assert!(stats["hits"].as_u64() > Some(0), "{stats}");
    }
    let file = folder.path().join("stats.json");
    succeed(arguments![
        "render",
        &mesh,
        "-o",
        folder.path().join("b.png"),
        "--size",
        "8x8",
        "--stats",
        &file
    ]);
    assert_eq!(json(&bytes(&file))["rays"], 64);
}

#[test]
fn bench_has_its_shape() {
    let meshes = ["cube.obj", "torus.obj"].map(asset);
    let message = succeed(arguments![
        "bench",
        &meshes[0],
        &meshes[1],
        "--frames",
        "2",
        "--size",
        "64x48",
        "--threads",
        "1"
    ]);
    let figures = json(&message.output);
    let files = figures.as_array().expect("an array");
    assert_eq!(files.len(), 2);
    for (file, mesh) in files.iter().zip(&meshes) {
        let named = file["file"].as_str().expect("a name");
        assert!(mesh.display().to_string().ends_with(named) || Path::new(named) == mesh);
        assert!(file["triangles"].as_u64() >= Some(12));
        assert!(file["build_ms"].is_number());
        assert_eq!(file["threads"], 1);
        assert!(file["simd"].is_string());
        assert_eq!(file["precision"], "exact");
        let views = file["views"].as_array().expect("views");
        let names: Vec<_> = views.iter().map(|view| &view["view"]).collect();
        assert_eq!(names, ["medium", "close"]);
        for view in views {
            assert_eq!(view["rays"], 64 * 48);
            assert!(view["hits"].as_u64() > Some(100), "{view}");
            assert!(view["mrays_per_s"].is_number());
            for times in ["cast_ms", "frame_ms"] {
                let [min, median] = ["min", "median"].map(|key| view[times][key].as_f64());
                assert!(min > Some(0.0) && min <= median, "{view}");
            }
        }
    }
    let message = succeed(arguments![
        "bench", &meshes[0], "--frames", "1", "--size", "8x8", "--eye", "0,0,9"
    ]);
    let figures = json(&message.output);
    assert_eq!(figures[0]["views"][0]["view"], "given");
    assert_eq!(figures[0]["views"].as_array().map(Vec::len), Some(1));
    assert!(figures[0]["views"][0].get("passes").is_none());
}

#[test]
fn bench_measures_passes() {
    let mesh = asset("cube.obj");
    let message = succeed(arguments![
        "bench", &mesh, "--passes", "--frames", "2", "--size", "64x48"
    ]);
    let figures = json(&message.output);
    for view in figures[0]["views"].as_array().expect("views") {
        let passes = view["passes"].as_array().expect("passes");
        let strides: Vec<_> = passes.iter().map(|pass| pass["stride"].as_u64()).collect();
        assert_eq!(strides, [1, 2, 4, 8].map(Some));
        for pass in passes {
            let [min, median] = ["min", "median"].map(|key| pass["ms"][key].as_f64());
            assert!(min > Some(0.0) && min <= median, "{pass}");
        }
    }
}

#[test]
fn info_tells_what_a_file_holds() {
    let mesh = asset("cube.obj");
    let message = succeed(arguments!["info", &mesh]);
    let text = String::from_utf8(message.output).expect("UTF-8");
    assert!(text.contains("cube") && text.contains("12"), "{text}");
    let folder = folder();
    let dropped = write(
        folder.path(),
        "dropped.obj",
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nf 1 2 3\nf 1 1 2\nf 1 2 4\n",
    );
    let message = succeed(arguments!["info", "--json", &mesh, &dropped]);
    let files = json(&message.output);
    assert_eq!(files[0]["triangles"], 12);
    assert_eq!(files[1]["triangles"], 3);
    assert_eq!(files[1]["dropped"]["zero_area"], 1);
    assert_eq!(files[1]["dropped"]["not_finite"], 1);
    assert!(files[0]["objects"][0].get("health").is_none());
    let message = succeed(arguments!["info", "--json", "--health", &mesh, &dropped]);
    let files = json(&message.output);
    let cube = &files[0]["objects"][0]["health"];
    assert!(
        cube["closed"] == true && cube["euler_characteristic"] == 2,
        "{cube}"
    );
    let [area, volume] = ["area", "volume"].map(|key| cube[key].as_f64().expect("a number"));
    // A cube of any side.
    assert!(
        (volume.powi(2) / (area / 6.0).powi(3) - 1.0).abs() < 1e-12,
        "{cube}"
    );
    let one = &files[1]["objects"][0]["health"];
    assert!(
        one["open_edges"] == 3 && one["degenerate"] == 2 && one["volume"].is_null(),
        "{one}"
    );
    let text = String::from_utf8(succeed(arguments!["info", "--health", &dropped]).output);
    let text = text.expect("UTF-8");
    assert!(
        text.contains("not closed") && text.contains("3 open edges, 2 degenerate"),
        "{text}"
    );
    assert!(one["self_intersections"].is_null(), "{one}");
    let triangles = "(0,0,0);(2,0,0);(0,2,0)\n(0.5,0.5,-1);(0.5,0.5,1);(0.6,3,0)\n";
    let crossing = write(folder.path(), "crossing.txt", triangles);
    let deep = arguments![
        "info",
        "--json",
        "--health",
        "--self-intersections",
        &crossing,
        &mesh
    ];
    let files = json(&succeed(deep).output);
    let pairs = |file: usize| &files[file]["objects"][0]["health"]["self_intersections"];
    assert_eq!((pairs(0), pairs(1)), (&1.into(), &0.into()));
    refuse(2, arguments!["info", "--self-intersections", &crossing]);
    refuse(1, arguments!["info", folder.path().join("none.obj")]);
}

#[test]
fn help_and_version_go_to_output() {
    for (argument, said) in [("--help", "raycast render"), ("--version", "raycast")] {
        let message = succeed([argument]);
        assert!(String::from_utf8_lossy(&message.output).contains(said));
        assert!(message.errors.is_empty(), "{}", message.errors);
    }
}

#[test]
fn a_report_can_be_read_by_people_and_programs() {
    let folder = folder();
    let report = folder.path().join("new/report");
    succeed(arguments![
        "report",
        asset("cube.obj"),
        "-o",
        &report,
        "--quick"
    ]);
    let text = String::from_utf8(bytes(&report.join("report.md"))).expect("text");
    assert!(report.join(".raycast-report").is_file());
    for way in [
        "RayCast tiles, exact",
        "RayCast tiles, fast",
        "RayCast single rays, exact",
        "RayCast single rays, fast",
        "plane, then inside, f32",
        "plane, then inside, f64",
        "Möller–Trumbore, f32",
        "Möller–Trumbore, f64",
        "watertight, f32",
        "obvhs BVH2, f32",
        "obvhs CWBVH, f32",
        "Embree",
    ] {
        assert!(text.contains(way), "{way} is missing");
    }
    let (mut tables, mut pictures) = (0, 0);
    for name in names(&report) {
        let path = report.join(&name);
        let name = name.to_string_lossy().into_owned();
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("csv") => {
                let message = String::from_utf8(bytes(&path)).expect("text");
                let mut reader = csv::Reader::from_reader(message.as_bytes());
                assert!(reader.headers().expect("headings").len() > 1, "{name}");
                let rows = reader
                    .records()
                    .map(|row| row.expect("as many cells as headings"));
                assert!(rows.count() > 0, "{name}");
                tables += 1;
            }
            Some("png") => {
                let picture = image::load_from_memory(&bytes(&path))
                    .expect("a PNG")
                    .into_rgb8();
                assert!(text.contains(&format!("]({name})")), "{name} is not shown");
                let first = *picture.get_pixel(0, 0);
                assert!(
                    picture.pixels().any(|&pixel| pixel != first),
                    "{name} is empty"
                );
                pictures += 1;
            }
            Some("svg") => assert!(bytes(&path).starts_with(b"<svg")),
            // The report itself, and what says that this folder holds one.
            _ => assert!(name == "report.md" || name == ".raycast-report", "{name}"),
        }
    }
    assert!(
        tables >= 3 && pictures >= 1,
        "{tables} tables, {pictures} pictures"
    );
    assert!(text.contains(&format!("raycast report {}", asset("cube.obj").display())));
    assert!(refuse(2, arguments!["report"]).contains("--output"));
    let file = folder.path().join("in the way");
    std::fs::write(&file, "a file").expect("a file");
    assert!(refuse(1, arguments!["report", "-o", &file, "--quick"]).contains("in the way"));
}
