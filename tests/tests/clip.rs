//! Clipping planes in the program: pictures of sections are verified, files and options mean the same, rays and
//! outlines are cut as pictures are.

use raycast_core::glam::DVec3;
use raycast_core::picture::{Format, ImageFile};
use raycast_core::scene::Color;
use raycast_tests::arguments;
use raycast_tests::binary::{command, refuse, run, succeed};
use raycast_tests::files::{asset, bytes, folder, write, write_rays};
use std::ffi::OsString;
use std::path::Path;

/// The colour of sections in every mode that fills them: orange, #e07b39.
const SECTION: Color = Color([0xe0, 0x7b, 0x39]);

fn strings<const N: usize>(words: [&str; N]) -> impl Iterator<Item = OsString> {
    words.into_iter().map(OsString::from)
}

/// A torus that its transform mirrors, cut in the scene file.
fn mirrored(folder: &Path) -> std::path::PathBuf {
    let text = format!(
        "version = 1\n\
         [[object]]\nname = \"torus\"\nmesh = {:?}\nscale = [-1.0, 1.0, 1.0]\n\
         [[clip]]\nnormal = [1.0, 0.0, 0.0]\noffset = 0.1\n",
        asset("torus.obj")
    );
    write(folder, "mirrored.toml", text)
}

/// Of each kind of cut picture `verify --all` finds every pixel right; where one pixel of the section is painted as another
/// section would be, it finds that one.
#[test]
fn pictures_of_sections_are_verified_and_a_changed_section_is_found() {
    let folder = folder();
    let (torus, mirrored) = (asset("torus.obj"), mirrored(folder.path()));
    let path = folder.path().join("picture.png");
    let options: [(&Path, &[&str]); 9] = [
        (&torus, &["--clip", "x:0.1", "--mode", "color"]),
        (&torus, &["--clip", "x:0.1", "--mode", "flat"]),
        // A slab: behind its section the rays leave what is kept again.
        (&torus, &["--clip", "x:0.1", "--clip=-x:0.2"]),
        (
            &torus,
            &["--clip", "x:0.1", "--clip", "1,1,0.3,0.05", "--clip=-x:0.7"],
        ),
        (&torus, &["--clip=-y:0", "--projection", "orthographic"]),
        (&mirrored, &["--mode", "flat"]),
        (&mirrored, &["--clip=-z:0"]),
        (
            &torus,
            &["--clip", "x:0.1", "--mode", "depth", "--color-map", "turbo"],
        ),
        (&torus, &["--clip", "x:0.1", "--cull", "back"]),
    ];
    for (mesh, more) in options {
        let case = format!("{} {more:?}", mesh.display());
        let mut arguments = arguments!["render", mesh, "-o", &path];
        arguments.extend(strings(["--size", "90x70", "--orbit=-40,20"]));
        arguments.extend(more.iter().map(OsString::from));
        succeed(arguments);
        let verify = || {
            let mut arguments = arguments!["verify", &path, mesh, "--all"];
            let cull = more.contains(&"back").then_some(["--cull", "back"]);
            arguments.extend(cull.into_iter().flatten().map(OsString::from));
            run(&mut command(arguments))
        };
        let message = verify();
        assert_eq!(message.status, Some(0), "{case}: {}", message.errors);
        let text = String::from_utf8(message.output).expect("a report is UTF-8");
        assert!(
            text.starts_with("6300 of 6300 pixels checked"),
            "{case}: {text}"
        );

        // Sections are the one thing here whose red, green and blue differ by this much, whatever light falls on them.
        let ImageFile {
            mut picture,
            recipe,
            ..
        } = ImageFile::decode(&bytes(&path)).expect("a PNG");
        let hue = |[r, g, b, _]: [u8; 4]| {
            let [red, green, blue] = SECTION.0.map(f32::from);
            let scale = f32::from(r) / red;
            (f32::from(g) - green * scale).abs() < 12.0
                && (f32::from(b) - blue * scale).abs() < 12.0
                && r > 60
        };
        let sections = picture.pixels.iter().filter(|&&pixel| hue(pixel)).count();
        let shows_sections = !more.contains(&"depth") && !more.contains(&"back");
        assert_eq!(sections > 60, shows_sections, "{case}: {sections}");
        if !shows_sections {
            continue;
        }
        let at = picture.pixels.iter().position(|&pixel| hue(pixel));
        let pixel = &mut picture.pixels[at.expect("a section")];
        *pixel = [pixel[2], pixel[1], pixel[0], 255];
        let changed = picture.encode_with(Format::Png, recipe.as_ref());
        std::fs::write(&path, changed.expect("encodes")).expect("writes");
        let message = verify();
        assert_eq!(message.status, Some(1), "{case}: {}", message.errors);
        assert!(
            message
                .errors
                .contains("1 of 6300 pixels checked are wrong"),
            "{case}: {}",
            message.errors
        );
    }
}

/// A plane through three corners of a wall, as picks make it: rounding decides which parts of the wall it keeps, and `verify`
/// finds all of them right.
#[test]
fn a_plane_through_a_face_is_verified() {
    let folder = folder();
    let corners: [[f32; 3]; 4] = [
        [-1.03, -0.97, 0.11],
        [1.07, -1.01, -0.35],
        [1.01, 0.93, 0.27],
        [-0.99, 1.02, 0.73],
    ];
    let vertices = corners.map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let text = vertices.concat() + "f 1 2 3\nf 1 3 4\n";
    let wall = write(folder.path(), "wall.obj", text);
    let [a, b, c, _] = corners.map(|corner| DVec3::from_array(corner.map(f64::from)));
    let normal = (b - a).cross(c - a).normalize();
    let path = folder.path().join("wall.png");
    for sign in [1.0, -1.0] {
        let DVec3 { x, y, z } = normal * sign;
        let clip = format!("--clip={x:?},{y:?},{z:?},{:?}", normal.dot(a) * sign);
        for projection in ["perspective", "orthographic", "fisheye"] {
            let mut arguments = arguments!["render", &wall, "-o", &path, &clip];
            arguments.extend(strings(["--size", "90x70", "--mode", "color"]));
            arguments.extend(strings(["--projection", projection]));
            succeed(arguments);
            let message = run(&mut command(arguments!["verify", &path, &wall, "--all"]));
            assert_eq!(
                message.status,
                Some(0),
                "{clip} {projection}: {}",
                message.errors
            );
        }
    }
}

/// A scene file's plane, the same plane as an option, and one that takes the place of another: the same bytes.
#[test]
fn planes_of_files_and_of_options_are_one() {
    let folder = folder();
    let torus = asset("torus.obj");
    let scene =
        |clip: &str| format!("version = 1\n[[object]]\nname = \"torus\"\nmesh = {torus:?}\n{clip}");
    let plane = |offset: &str, more: &str| {
        format!("[[clip]]\nnormal = [0.0, 2.0, 0.5]\noffset = {offset}\n{more}")
    };
    let files = [
        ("cut", scene(&plane("0.05", ""))),
        ("other", scene(&plane("-0.1", ""))),
        ("off", scene(&plane("0.05", "enabled = false\n"))),
        ("none", scene("")),
    ];
    for (name, text) in files {
        write(folder.path(), &format!("{name}.toml"), text);
    }
    let render = |name: &str, clip: Option<&str>| {
        let path = folder.path().join("picture.exr");
        let scene = folder.path().join(format!("{name}.toml"));
        let mut arguments = arguments!["render", &scene, "-o", &path];
        arguments.extend(strings(["--size", "70x50", "--orbit", "30,20"]));
        arguments.extend(clip.map(|clip| format!("--clip={clip}").into()));
        succeed(arguments);
        bytes(&path)
    };
    let cut = render("cut", None);
    for name in ["other", "off", "none"] {
        assert!(render(name, Some("0,2,0.5,0.05")) == cut, "{name}");
    }
    let whole = render("none", None);
    assert!(whole != cut && render("other", None) != cut);
    assert!(render("cut", Some("none")) == whole && render("none", Some("none")) == whole);
    // A plane that is off cuts nothing: it is no part of the picture's recipe.
    assert!(render("off", None) == whole);
}

/// A ray through a cube in steps of a plane: it hits the near face, or the far one where the plane has cut the near one away.
#[test]
fn rays_of_a_file_are_cut_exactly() {
    let folder = folder();
    let (rays, hits) = (folder.path().join("rays"), folder.path().join("hits"));
    let z = 5.0;
    write_rays(
        &rays,
        &[[0.125, 0.0625, z, 0.0, 0.0, 0.0, -1.0, f32::INFINITY]],
    );
    let mesh = asset("cube.obj");
    let answer = |clip: &str| {
        succeed(arguments![
            "cast",
            &mesh,
            "--rays",
            &rays,
            "--hits",
            &hits,
            &format!("--clip={clip}")
        ]);
        let hit = bytes(&hits);
        f32::from_le_bytes([hit[0], hit[1], hit[2], hit[3]])
    };
    let near = answer("none");
    let (top, far) = (z - near, answer("-z:0"));
    assert!(near < far && far.is_finite());
    assert!((z - far + top).abs() < 1e-6, "the cube is about zero");
    // What lies on the plane is kept; half a millionth further and it is not.
    for (clip, expected) in [
        (format!("-z:{top}"), near),
        (format!("-z:{}", top - 5e-7), far),
        (format!("z:{top}"), near),
        (format!("z:{}", top + 5e-7), f32::INFINITY),
        ("x:0.125".into(), near),
        ("x:0.1250001".into(), f32::INFINITY),
    ] {
        assert_eq!(answer(&clip), expected, "{clip}");
    }
}

/// The outline of a cube's section by a level plane is its square, in both formats.
#[test]
fn outlines_are_those_of_the_section() {
    let folder = folder();
    let mesh = asset("cube.obj");
    let write = |name: &str| {
        let path = folder.path().join(name);
        succeed(arguments![
            "section", &mesh, "--clip", "y:0.25", "-o", &path
        ]);
        String::from_utf8(bytes(&path)).expect("text")
    };
    let svg = write("section.svg");
    let path = svg.split(" d=\"").nth(1).expect("a path");
    let path = path.split('"').next().expect("an end");
    assert!(path.starts_with('M') && path.ends_with('Z'), "{path}");
    let mut corners: Vec<[f64; 2]> = path[1..path.len() - 1]
        .split('L')
        .map(|point| {
            let mut numbers = point.split(' ').map(|n| n.parse().expect("a number"));
            [(); 2].map(|()| numbers.next().expect("two numbers"))
        })
        .collect();
    let side = corners
        .iter()
        .flatten()
        .fold(0.0, |a: f64, b| a.max(b.abs()));
    assert!(side > 0.1, "{side}");
    // Each face is two triangles, so that a point of its diagonal lies within each side.
    corners.retain(|[x, y]| x.abs() == side && y.abs() == side);
    assert_eq!(corners.len(), 4, "{path}");
    let area: f64 = (0..4)
        .map(|i| {
            let ([ax, ay], [bx, by]) = (corners[i], corners[(i + 1) % 4]);
            (ax * by - bx * ay) / 2.0
        })
        .sum();
    assert_eq!(area.abs(), 4.0 * side * side);

    let dxf = write("section.dxf");
    let count = dxf.lines().filter(|line| *line == "VERTEX").count();
    assert_eq!(count, path.matches(['M', 'L']).count());
    assert!(dxf.trim_end().ends_with("EOF"));
    let line = refuse(
        2,
        arguments![
            "section",
            &mesh,
            "--clip",
            "0,0,0,1",
            "-o",
            &folder.path().join("none.svg")
        ],
    );
    assert!(line.contains("normal"), "{line}");
}
