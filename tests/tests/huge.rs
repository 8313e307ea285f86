//! Pictures larger than memory, and files that are gone on with after they were ended: the same bytes, the
//! same pixels, little memory.

use raycast_core::picture::RowReader;
use raycast_tests::arguments;
use raycast_tests::binary::{command, refuse, run, succeed};
use raycast_tests::files::{asset, bytes, folder, names};
use std::ffi::OsString;
use std::io::Cursor;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

/// Just more pixels than a PNG that is encoded as one.
const SIZE: &str = "4200x4096";

fn render(output: &Path, more: &[&str]) {
    let mut arguments = arguments!["render", asset("torus.obj"), "-o", output];
    arguments.extend(more.iter().map(OsString::from));
    succeed(arguments);
}

/// A PNG's pixels as red, green and blue, row by row.
fn rgb(png: &Path) -> Vec<u8> {
    let file = bytes(png);
    let mut reader = RowReader::open(Cursor::new(&file), file.len() as u64).expect("a PNG");
    let (_, height) = reader.size();
    let picture = reader.rows(height).expect("its rows");
    let opaque = |&[r, g, b, a]: &[u8; 4]| {
        assert_eq!(a, 255);
        [r, g, b]
    };
    picture.pixels.iter().flat_map(opaque).collect()
}

#[test]
fn a_picture_in_bands_is_the_stitched_one_and_the_same_for_any_split() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    render(&at("whole.png"), &["--size", SIZE]);
    render(
        &at("other.png"),
        &["--size", SIZE, "--tile-size", "100", "--threads", "1"],
    );
    assert!(bytes(&at("whole.png")) == bytes(&at("other.png")));
    let mut stitch = arguments!["stitch"];
    for cell in ["0,0", "1,0", "0,1", "1,1"] {
        let part = at(&format!("{cell}.png"));
        render(
            &part,
            &["--size", SIZE, "--tiles", "2x2", "--sub-camera", cell],
        );
        stitch.push(part.into());
    }
    let mut stitched = stitch.clone();
    stitched.extend(arguments!["-o", at("stitched.png")]);
    succeed(stitched);
    assert!(bytes(&at("whole.png")) == bytes(&at("stitched.png")));
    stitch.pop();
    stitch.extend(arguments!["-o", at("lacking.png")]);
    let line = refuse(1, stitch);
    assert!(line.contains("pixels are in no fragment"), "{line}");
    let message = succeed(arguments![
        "verify",
        at("whole.png"),
        asset("torus.obj"),
        "--checks",
        "300"
    ]);
    let message = String::from_utf8_lossy(&message.output).into_owned();
    assert!(
        message.contains("300 of 17203200 pixels checked"),
        "{message}"
    );

    // The same pixels in files without compression, and in one that another program reads.
    render(&at("whole.ppm"), &["--size", SIZE]);
    let ppm = bytes(&at("whole.ppm"));
    let pixels = ppm.strip_prefix(b"P6\n4200 4096\n255\n").expect("a PPM");
    assert!(rgb(&at("whole.png")) == pixels);
}

#[test]
fn memory_does_not_grow_with_the_picture() {
    let folder = folder();
    let peak = |name: &str, size: &str, more: &[&str]| {
        let stats = folder.path().join("stats.json");
        let output = folder.path().join(name);
        let path = stats.to_string_lossy();
        let options = [&["--size", size, "--stats", &path], more].concat();
        render(&output, &options);
        let stats: serde_json::Value = serde_json::from_slice(&bytes(&stats)).expect("JSON");
        stats["peak_bytes"].as_u64().expect("a number")
    };
    let small = peak("small.png", "64x64", &[]);
    // In one piece these are 300 MB to 2 GB more.
    let fragment = ["--tiles", "2x2", "--sub-camera", "1,1"];
    for (name, size, options) in [
        ("a.ppm", "8192x8192", &[][..]),
        ("a.tif", "8192x8192", &[]),
        ("a.exr", "4096x2048", &[]),
        ("part.exr", "8192x4096", &fragment),
        ("part.png", "16384x16384", &fragment),
    ] {
        let more = peak(name, size, options).saturating_sub(small);
        assert!(
            more < 200 << 20,
            "{name}: {more} bytes more than the smallest"
        );
    }
}

/// Renders, and tells how many rays were cast.
fn rays(output: &Path, more: &[&str]) -> u64 {
    let stats = output.with_extension("json");
    let mut more = more.to_vec();
    let name = stats.to_string_lossy();
    more.extend(["--stats", &name]);
    render(output, &more);
    let message: serde_json::Value = serde_json::from_slice(&bytes(&stats)).expect("JSON");
    std::fs::remove_file(stats).expect("it was written");
    message["rays"].as_u64().expect("a number")
}

/// Begins a render with `--resume`, and kills it once its journal tells of a band that is safe.
fn end_amid(output: &Path, more: &[&str]) {
    let name = output.file_name().expect("a name").to_string_lossy();
    let journal = output.with_file_name(format!(".{name}.raycast-journal"));
    let lines =
        || std::fs::read(&journal).map_or(0, |text| text.split(|b| *b == b'\n').count() - 1);
    let before = lines();
    let mut render = arguments!["render", asset("torus.obj"), "-o", output, "--resume"];
    render.extend(more.iter().map(OsString::from));
    let mut child = command(render)
        .stderr(Stdio::null())
        .spawn()
        .expect("it starts");
    // The first line says of what picture it is. That of another picture is begun anew.
    while lines() < 2 || lines() == before {
        let ended = child.try_wait().expect("a child");
        assert!(
            ended.is_none(),
            "it was done before it could be ended: {ended:?}"
        );
        std::thread::sleep(Duration::from_millis(2));
    }
    // SIGKILL: no handler has a part in it.
    child.kill().expect("killed");
    child.wait().expect("it has ended");
    assert!(
        journal.exists() && lines() >= 2,
        "it was done before it could be ended"
    );
}

#[test]
fn a_render_that_is_ended_goes_on_to_the_same_bytes() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    // One thread and many samples: bands take long enough to be ended among them, on a busy machine, too.
    let slow = ["--threads", "1", "--samples", "32"];
    for (end, size) in [("png", "5000x4096"), ("exr", "3000x2000")] {
        let (whole, out) = (at(&format!("whole.{end}")), at(&format!("out.{end}")));
        let more = [&["--size", size][..], &slow].concat();
        let all = rays(&whole, &more);
        end_amid(&out, &more);
        end_amid(&out, &more);
        let left = rays(&out, &[&more[..], &["--resume"]].concat());
        assert!(0 < left && left < all, "{end}: {left} of {all} rays");
        assert!(bytes(&out) == bytes(&whole), "{end}");
        assert_eq!(names(folder.path()).len(), 2, "nothing else is left");

        // Another picture does not go on with this one's part.
        end_amid(&out, &more);
        let other = [&["--size", size, "--mode", "flat"][..], &slow].concat();
        let anew = rays(&out, &[&other[..], &["--resume"]].concat());
        assert_eq!(anew, rays(&whole, &other), "{end}");
        assert!(bytes(&out) == bytes(&whole), "{end}");
        std::fs::remove_file(&out).expect("it is there");
        std::fs::remove_file(&whole).expect("it is there");
    }
    assert!(names(folder.path()).is_empty());
}

#[test]
fn a_render_that_cannot_be_resumed_says_why() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let mesh = asset("torus.obj");
    for name in ["a.png", "a.jpg"] {
        let small = arguments![
            "render",
            &mesh,
            "-o",
            at(name),
            "--size",
            "64x48",
            "--resume"
        ];
        let message = succeed(small).errors;
        assert!(
            message.contains(name) && message.contains("--resume has no effect"),
            "{message}"
        );
    }
    let frames = arguments![
        "render",
        &mesh,
        "-o",
        at("b.png"),
        "--turntable",
        "2",
        "--resume"
    ];
    let line = refuse(2, frames);
    assert!(line.contains("--resume"), "{line}");
    for other in [["--unfinished", "1"], ["--sub-camera", "0,0"]] {
        let mut parts = arguments!["render", &mesh, "-o", at("b.png"), "--resume"];
        parts.extend(other.map(OsString::from));
        let line = refuse(2, parts);
        assert!(line.contains("--resume"), "{line}");
    }
    assert_eq!(names(folder.path()), ["a.jpg", "a.png"]);
}

#[test]
fn a_tiff_is_read_by_another_program() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    for background in ["transparent", "#102030"] {
        let more = ["--size", "701x530", "--background", background];
        render(&at("a.tif"), &more);
        render(&at("a.png"), &more);
        let convert = |name: &str| {
            let mut convert = std::process::Command::new("convert");
            let convert = convert.arg(at(name)).args(["-depth", "8", "rgba:-"]);
            run(convert)
        };
        if std::process::Command::new("convert")
            .arg("-version")
            .output()
            .is_err()
        {
            assert!(std::env::var_os("CI").is_none(), "CI has ImageMagick");
            return;
        }
        let (tiff, png) = (convert("a.tif"), convert("a.png"));
        assert_eq!(
            (tiff.status, png.status),
            (Some(0), Some(0)),
            "{}",
            tiff.errors
        );
        assert!(tiff.output == png.output && tiff.output.len() == 701 * 530 * 4);
    }
}

#[test]
fn a_deep_zooms_finest_tiles_are_the_picture_and_its_coarsest_one_pixel() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let size = ["--size", "1000x700"];
    render(&at("a.dzi"), &size);
    render(&at("whole.png"), &size);
    let whole = rgb(&at("whole.png"));
    let tile = |level: u32, column: u32, row: u32| {
        let path = at(&format!("a_files/{level}/{column}_{row}.png"));
        let file = bytes(&path);
        let reader = RowReader::open(Cursor::new(&file), file.len() as u64).expect("a PNG");
        (reader.size(), rgb(&path))
    };
    for (column, row) in [(0, 0), (3, 2), (1, 2)] {
        let ((width, height), pixels) = tile(10, column, row);
        assert_eq!(
            (width, height),
            ((1000 - column * 256).min(256), (700 - row * 256).min(256))
        );
        for (y, line) in pixels.chunks_exact(3 * width as usize).enumerate() {
            let start = ((row as usize * 256 + y) * 1000 + column as usize * 256) * 3;
            assert!(
                line == &whole[start..start + line.len()],
                "{column} {row}: {y}"
            );
        }
    }
    assert_eq!(tile(9, 1, 1).0, (500 - 256, 350 - 256));
    assert_eq!(tile(0, 0, 0).0, (1, 1));
    assert_eq!(names(&at("a_files")).len(), 11);
    let dzi = String::from_utf8(bytes(&at("a.dzi"))).expect("text");
    assert!(dzi.contains("Width=\"1000\" Height=\"700\""), "{dzi}");
    let page = String::from_utf8(bytes(&at("a.html"))).expect("text");
    assert!(page.contains("tiles = \"a_files\", columns = 1000, rows = 700, top_level = 10"));
}

/// Runs the functions of a page's script beside stand-ins for the browser, and prints what it fetched.
const FETCHES: &str = r#"
const page = require("fs").readFileSync(process.argv[1], "utf8");
const script = page.split("<script>")[1].split("</script>")[0];
const any = new Proxy(function () {}, { get: () => any, apply: () => any, set: () => true });
const fetched = [];
class Image { set src(name) { fetched.push(name.split("/")[2]); } }
const names = ["document", "window", "Image", "innerWidth", "innerHeight", "addEventListener", "requestAnimationFrame"];
const image = new Function(...names, script + "\nreturn image;")(
  any, { devicePixelRatio: 1 }, Image, 800, 600, () => {}, () => {});
for (let column = 0; column < 600; column++) image(0, column, 0);
image(0, 0, 0);
image(0, 600, 0);
fetched.length = 0;
image(0, 0, 0);
image(0, 1, 0);
console.log(fetched.join(" "));
"#;

/// Of 601 tiles the page forgets the one whose use is longest ago, not the one that it fetched first.
#[test]
fn a_deep_zooms_page_forgets_the_least_recently_used_tile() {
    if std::process::Command::new("node")
        .arg("--version")
        .output()
        .is_err()
    {
        eprintln!("skipped: node is not installed");
        return;
    }
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    render(&at("a.dzi"), &["--size", "64x48"]);
    let ended = std::process::Command::new("node")
        .args(["-e", FETCHES])
        .arg(at("a.html"))
        .output()
        .expect("node runs");
    let errors = String::from_utf8_lossy(&ended.stderr);
    assert!(ended.status.success(), "{errors}");
    assert_eq!(ended.stdout, b"1_0.png\n", "{errors}");
}

#[test]
fn a_deep_zoom_writes_over_no_page_and_no_tiles_and_nothing_over_its_page() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let zoom = |more: &[&str]| {
        let mut zoom = arguments!["render", asset("torus.obj"), "-o", at("a.dzi")];
        zoom.extend(["--size", "64x48"].map(OsString::from));
        zoom.extend(more.iter().map(OsString::from));
        zoom
    };
    std::fs::write(at("a.html"), "a letter").expect("written");
    let line = refuse(1, zoom(&[]));
    assert!(
        line.contains("a.html: cannot be made: it is there already"),
        "{line}"
    );
    assert_eq!(bytes(&at("a.html")), b"a letter");
    assert_eq!(names(folder.path()), ["a.html"]);
    std::fs::remove_file(at("a.html")).expect("removed");
    for taken in ["a.html", "a.dzi"] {
        let line = refuse(2, zoom(&["--stats", &at(taken).to_string_lossy()]));
        assert!(line.contains(taken), "{line}");
        assert!(names(folder.path()).is_empty(), "{taken}");
    }
    succeed(zoom(&[]));
    assert_eq!(names(folder.path()), ["a.dzi", "a.html", "a_files"]);
    // Tiles are not mixed with those of another picture.
    std::fs::remove_file(at("a.html")).expect("removed");
    let line = refuse(1, zoom(&[]));
    assert!(
        line.contains("a_files: cannot be made: it is there already"),
        "{line}"
    );
    assert_eq!(names(folder.path()), ["a.dzi", "a_files"]);
}
