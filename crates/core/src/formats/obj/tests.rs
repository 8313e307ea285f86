//! Ground truth: short files whose meshes and messages are written out.

use super::{Obj, read};
use crate::formats::error::FormatError;
use crate::formats::held::Held;
use crate::formats::limits::Budget;
use crate::scene::{Alpha, Color, Opacity, Texture, Wrap};
use glam::{DVec3, Vec2, Vec3};
use std::cell::RefCell;
use std::path::Path;
use std::sync::Arc;

const LIBRARY: &str =
    "newmtl red\nKd 1 0 0\nmap_Kd skin.png\nnewmtl blue\nKd 0 0 1\nmap_Kd skin.png\n";

fn parse_bytes(bytes: &[u8]) -> Result<Obj, FormatError> {
    let budget = Budget::default();
    let resolve = |name: &str| (name == "parts/a.mtl").then(|| LIBRARY.into());
    let files = Held::new(&resolve, &budget);
    read(Path::new("parts/a.obj"), bytes, &files, &|_| ())
}

fn parse(text: &str) -> Obj {
    parse_bytes(text.as_bytes()).expect("a good file")
}

fn error(text: &str) -> String {
    let message = parse_bytes(text.as_bytes())
        .expect_err("a bad file")
        .to_string();
    assert_eq!(message.lines().count(), 1, "{message}");
    message.replace("parts/", "")
}

#[test]
fn triangles_are_in_the_order_of_faces() {
    let obj = parse(
        "mtllib a.mtl\no one\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0.5 0\n\
         usemtl blue\nf 1 2 3 4 5\no two\nusemtl red\nf -1 -2 -3\nusemtl blue\nf 1 2 3 4\n",
    );
    let corners: Vec<_> = (obj.mesh.triangles.iter())
        .map(|t| t.map(|i| obj.mesh.positions[i as usize].to_array()))
        .collect();
    let [a, b, c, d, e] = [
        [0., 0., 0.],
        [1., 0., 0.],
        [1., 1., 0.],
        [0., 1., 0.],
        [-1., 0.5, 0.],
    ];
    assert_eq!(
        corners,
        [
            [a, b, c],
            [a, c, d],
            [a, d, e],
            [e, d, c],
            [a, b, c],
            [a, c, d]
        ]
    );
    assert_eq!(obj.mesh.positions.len(), 5);
    assert_eq!(obj.mesh.material_of_triangle, [1, 1, 1, 0, 1, 1]);
    assert_eq!(obj.mesh.materials[1].color, Color([0, 0, 255]));
    assert_eq!(obj.texture.as_deref(), Some(Path::new("parts/skin.png")));
    assert!(obj.warnings.is_empty(), "{:?}", obj.warnings);
}

/// The statement above a face counts, an `o` as a `g`; a name may come again, and none ends a group.
#[test]
fn faces_are_in_the_groups_of_the_statements_above_them() {
    let obj = parse(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\no car\ng left wheel \nf 1 2 4 3\ng\nf 2 3 4\n\
         o body\ng empty\ng left wheel\nf 1 3 4\ng body\ng other\ng body\nf 1 2 4\ng last\n",
    );
    let groups = &obj.mesh.groups;
    assert_eq!(groups.names(), ["left wheel", "body"]);
    let of: Vec<_> = (0..6).map(|at| groups.of(at).unwrap_or("-")).collect();
    let wheel = "left wheel";
    assert_eq!(of, ["-", wheel, wheel, "-", wheel, "body"]);
    assert_eq!(groups.sizes(6), [3, 1]);
    // A terminal and a window show names.
    let long = "x".repeat(1 << 20);
    let obj = parse(&format!(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\ng \u{1b}[31m{long}\nf 1 2 3\n"
    ));
    let name = obj.mesh.groups.of(0).expect("a group");
    assert!(
        name.len() < 300 && name.starts_with("\\u{1b}[31mxxx"),
        "{name}"
    );
}

#[test]
fn attributes_have_indices_of_their_own() {
    let obj = parse(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0.25 1\nvt nan 0\nvn 0 0 2\nvn 0 0 0\n\
         f 1 2 3\nf 1/3/1 2/2/1 3/1/1\nf 1/1/1 2/4/2 3/1/1\nf 1//1 2//1 3//1\n",
    );
    let uvs = obj.mesh.uvs.expect("texture coordinates");
    let normals = obj.mesh.normals.expect("normals");
    let shared = [7; 3];
    assert_eq!(uvs.corners(0, shared), None);
    assert_eq!(
        uvs.corners(1, shared),
        Some([Vec2::new(0.25, 1.0), Vec2::new(1.0, 0.0), Vec2::ZERO])
    );
    assert_eq!(uvs.corners(2, shared), None, "one is not a number");
    assert_eq!(normals.corners(0, shared), None);
    assert_eq!(normals.corners(1, shared), Some([Vec3::Z; 3]));
    assert_eq!(normals.corners(2, shared), None, "one has no direction");
    assert_eq!(normals.corners(3, shared), Some([Vec3::Z; 3]));
}

#[test]
fn reads_double_precision_and_odd_bytes() {
    let obj = parse_bytes(
        b"\xef\xbb\xbf# caf\xe9\r\ng t\xeate\r\nv 0.1 1e7 -3 1.0\nv 1 0 0 9 9 9\nv 0 1 0\nf 1// 2// 3//",
    )
    .expect("a good file");
    assert_eq!(obj.mesh.positions[0], DVec3::new(0.1, 1e7, -3.0));
    assert_eq!(obj.mesh.triangles, [[0, 1, 2]]);
}

#[test]
fn missing_attributes_are_left_out() {
    let obj = parse("mtllib no.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/1 2/2/2 3/3/3\n");
    assert!(obj.mesh.materials.is_empty() && obj.mesh.uvs.is_none());
    assert_eq!(obj.warnings.len(), 2, "{:?}", obj.warnings);
    assert!(obj.warnings[1].contains("\"no.mtl\""), "{:?}", obj.warnings);
}

#[test]
fn of_materials_with_one_name_the_last_counts() {
    let library = "newmtl x\nKd 1 0 0\nnewmtl y\nKd 1 1 1\nnewmtl x\nKd 0 0 1\nmap_Kd b.png\n";
    let budget = Budget::default();
    let resolve = |name: &str| (name == "a.mtl").then(|| library.into());
    let files = Held::new(&resolve, &budget);
    let text = b"mtllib a.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let obj = read(Path::new("a.obj"), text, &files, &|_| ()).expect("a good file");
    let number = obj.mesh.material_of_triangle[0] as usize;
    assert_eq!(obj.mesh.materials[number].color, Color([0, 0, 255]));
    assert_eq!(obj.texture.as_deref(), Some(Path::new("b.png")));
}

/// Options that move an image move the coordinates of its material's faces; one that is not repeated is the material's
/// own, also where all faces have it.
#[test]
fn images_lie_as_their_options_say() {
    let library = "newmtl plain\nmap_Kd a.ppm\nnewmtl moved\nmap_Kd -s 2 2 -o 0 1 a.ppm\n\
        newmtl once\nmap_Kd -clamp on a.ppm\n";
    let budget = Budget::default();
    let resolve = |name: &str| match name {
        "a.mtl" => Some(library.into()),
        "a.ppm" => Some(b"P6 1 1 255 \x01\x02\x03".to_vec()),
        _ => None,
    };
    let files = Held::new(&resolve, &budget);
    let read_with = |[first, second]: [&str; 2]| {
        let text = format!(
            "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 0.5\n\
             usemtl {first}\nf 1/1 2/2 3/3\nusemtl {second}\nf 3/3 2/2 1/1\n"
        );
        read(Path::new("a.obj"), text.as_bytes(), &files, &|_| ()).expect("a good file")
    };
    let obj = read_with(["plain", "moved"]);
    assert_eq!(obj.texture.as_deref(), Some(Path::new("a.ppm")));
    let uvs = obj.mesh.uvs.expect("coordinates");
    let indices = uvs.indices.expect("of corners");
    let of = |triangle: usize| indices[triangle].map(|index| uvs.values[index as usize].to_array());
    assert_eq!(of(0), [[0.0, 0.0], [1.0, 0.0], [0.0, 0.5]]);
    assert_eq!(of(1), [[0.0, 2.0], [2.0, 1.0], [0.0, 1.0]]);
    assert!(obj.notes.is_empty() && obj.warnings.is_empty());

    let obj = read_with(["once", "once"]);
    assert_eq!(obj.texture, None);
    let number = obj.mesh.material_of_triangle[0] as usize;
    let texture = obj.mesh.materials[number].texture.as_ref();
    assert_eq!(
        texture.map(|texture| texture.wrap()),
        Some([Wrap::Clamp; 2])
    );
    let obj = read_with(["plain", "once"]);
    let wraps = obj.mesh.material_of_triangle.iter().map(|&number| {
        let texture = obj.mesh.materials[number as usize].texture.as_ref();
        texture.expect("an image").wrap()
    });
    let wraps: Vec<_> = wraps.collect();
    assert_eq!(wraps, [[Wrap::Repeat; 2], [Wrap::Clamp; 2]]);
}

/// Where not all faces share an image, each material of a face has its own; each file is read once.
#[test]
fn materials_have_images_of_their_own() {
    let library = "newmtl x\nmap_Kd a.ppm\nnewmtl y\nmap_Kd b.ppm\nnewmtl z\nKd 1 0 0\n\
        newmtl x again\nmap_Kd a.ppm\nmap_d a.ppm\nnewmtl lost\nmap_Kd no.ppm\n\
        newmtl unused\nmap_Kd c.ppm\n";
    let budget = Budget::default();
    let reads = RefCell::new(Vec::new());
    let resolve = |name: &str| {
        reads.borrow_mut().push(name.to_owned());
        match name {
            "a.mtl" => Some(library.into()),
            "a.ppm" => Some(b"P6 1 1 255 \x01\x02\x03".to_vec()),
            "b.ppm" => Some(b"P6 1 1 255 \x04\x05\x06".to_vec()),
            _ => None,
        }
    };
    let files = Held::new(&resolve, &budget);
    let read_with = |materials: [&str; 2]| {
        let [first, second] = materials;
        let text = format!(
            "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl {first}\nf 1 2 3\nusemtl {second}\nf 3 2 1\n"
        );
        reads.borrow_mut().clear();
        read(Path::new("a.obj"), text.as_bytes(), &files, &|_| ()).expect("a good file")
    };
    let images = |obj: &Obj| {
        let image = |&number: &u32| {
            let texture = obj.mesh.materials[number as usize].texture.as_ref();
            texture.map(|texture| texture.texels()[0])
        };
        let of_triangles = &obj.mesh.material_of_triangle;
        of_triangles.iter().map(image).collect::<Vec<_>>()
    };
    let (a, b) = (Some([1, 2, 3, 255]), Some([4, 5, 6, 255]));
    for (materials, expected, files) in [
        (["x", "y"], [a, b], &["a.mtl", "a.ppm", "b.ppm"][..]),
        (["z", "x"], [None, a], &["a.mtl", "a.ppm"]),
        (["x", "lost"], [a, None], &["a.mtl", "a.ppm", "no.ppm"]),
    ] {
        let obj = read_with(materials);
        assert_eq!(obj.texture, None);
        assert_eq!(images(&obj), expected);
        assert_eq!(*reads.borrow(), files);
        let lost = materials.contains(&"lost");
        assert_eq!(obj.warnings.len(), usize::from(lost), "{:?}", obj.warnings);
        if let Some(warning) = obj.warnings.first() {
            let start = "a.obj: its image in \"no.ppm\" cannot be read: ";
            assert!(warning.starts_with(start), "{warning}");
        }
    }
    // The same image everywhere is the object's, and is read with it; but for its opacity.
    let obj = read_with(["x", "x again"]);
    assert_eq!(obj.texture.as_deref(), Some(Path::new("a.ppm")));
    assert_eq!(images(&obj), [None, None]);
    assert_eq!(*reads.borrow(), ["a.mtl", "a.ppm"]);
    assert!(read_with(["z", "z"]).warnings.is_empty());
}

#[test]
fn materials_are_masks_or_blended() {
    let library = "newmtl leaf\nmap_d leaf.pgm\nnewmtl glass\nTr 0.75\nmap_d leaf.pgm\n\
        newmtl stone\nd 1\nTr 0.5\nnewmtl unused\nd 0.5\nmap_d none.pgm\nnewmtl lost\nmap_d none.pgm\n";
    let text =
        b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl leaf\nf 1 2 3\nusemtl glass\nf 1 2 3\n\
        usemtl stone\nf 1 2 3\nusemtl lost\nf 1 2 3\n";
    let budget = Budget::default();
    let resolve = |name: &str| match name {
        "a.mtl" => Some(library.as_bytes().to_vec()),
        "leaf.pgm" => Some(b"P5 2 1 255 \xff\x20".to_vec()),
        _ => None,
    };
    let files = Held::new(&resolve, &budget);
    let obj = read(Path::new("a.obj"), text, &files, &|_| ()).expect("a good file");
    let image = Texture::new(2, 1, vec![[255; 4], [32; 4]]).map(Arc::new);
    let alpha = |factor| Alpha {
        factor,
        image: image.clone(),
    };
    let mask = Opacity::Mask {
        alpha: alpha(1.0),
        cutoff: 0.5,
    };
    let materials = &obj.mesh.materials;
    let found: Vec<_> = materials.iter().map(|m| m.opacity.clone()).collect();
    let glass = Opacity::Blend(alpha(0.25));
    assert_eq!(found[..3], [mask, glass, Opacity::Opaque]);
    assert_eq!(found[4], Opacity::Opaque);
    let [lost, blended] = &obj.warnings[..] else {
        panic!("{:?}", obj.warnings)
    };
    assert!(
        lost.starts_with("a.obj: its opacity in \"none.pgm\" cannot be read: "),
        "{lost}"
    );
    assert!(blended.ends_with("nothing refracted: 1"), "{blended}");
}

#[test]
fn scalars_are_read_from_the_channel_that_is_named() {
    let names = [
        "",
        "-imfchan r",
        "-imfchan g",
        "-imfchan b",
        "-imfchan m",
        "-imfchan l",
    ];
    let mask = |(number, options)| format!("newmtl m{number}\nmap_d {options} rgb.ppm\n");
    let masks: String = names.into_iter().enumerate().map(mask).collect();
    let library = format!(
        "{masks}newmtl m6\nmap_Pr -imfchan b rgb.ppm\nmap_Pm -imfchan l rgb.ppm\n\
        newmtl m7\nmap_Pr rgb.ppm\nmap_Pm -imfchan g rgb.ppm\n\
        newmtl m8\nmap_Kd -imfchan r rgb.ppm\nmap_Ke -imfchan r rgb.ppm\nmap_d -imfchan z rgb.ppm\n"
    );
    let faces: String = (0..9)
        .map(|number| format!("usemtl m{number}\nf 1 2 3\n"))
        .collect();
    let text = format!("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}");
    let budget = Budget::default();
    let resolve = |name: &str| match name {
        "a.mtl" => Some(library.clone().into_bytes()),
        "rgb.ppm" => Some(b"P6 1 1 255 \xc8\x64\x32".to_vec()),
        _ => None,
    };
    let files = Held::new(&resolve, &budget);
    let obj = read(Path::new("a.obj"), text.as_bytes(), &files, &|_| ()).expect("a good file");
    let alpha = |number: usize| match &obj.mesh.materials[number].opacity {
        Opacity::Mask { alpha, .. } => alpha.image.as_ref().map(|image| image.texels()[0][3]),
        other => panic!("{other:?}"),
    };
    // 0.2126 · 200 + 0.7152 · 100 + 0.0722 · 50 = 117.65.
    let expected = [200, 200, 100, 50, 255, 118, 200].map(Some);
    assert_eq!([0, 1, 2, 3, 4, 5, 8].map(alpha), expected);
    let texel = |number: usize| {
        let reflectance = obj.mesh.materials[number].reflectance.as_ref();
        let texture = reflectance.and_then(|reflectance| reflectance.texture.as_ref());
        texture.map(|texture| texture.texels()[0])
    };
    assert_eq!(texel(6), Some([0, 50, 118, 255]));
    assert_eq!(texel(7), Some([0, 200, 100, 255]));
    let unused =
        ["map_Kd", "map_Ke", "map_d"].map(|image| format!("\"options of {image}\" (1 materials)"));
    assert_eq!(obj.notes, [format!("not used: {}", unused.join(", "))]);
}

/// Images of roughness and metal are put into one, as large as the larger; what a library says beside them does not count.
#[test]
fn images_say_how_materials_reflect_light() {
    let library = "newmtl worn\nPr 0.5\nPm 0.5\nmap_Pr rough.pgm\nmap_Pm metal.pgm\n\
        newmtl steel\nPr 0.5\nPm 0.25\nmap_Pm metal.pgm\nnewmtl lamp\nKe 0 0 0\nmap_Ke light.ppm\n\
        newmtl dim\nKe 0.5 0 0\nmap_Ke light.ppm\nnewmtl lost\nPr 0.5\nmap_Pr none.pgm\n\
        newmtl worn too\nmap_Pr rough.pgm\nmap_Pm metal.pgm\n";
    let names = ["worn", "steel", "lamp", "dim", "lost", "worn too"];
    let faces = names
        .map(|name| format!("usemtl {name}\nf 1 2 3\n"))
        .concat();
    let text = format!("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}");
    let budget = Budget::default();
    let resolve = |name: &str| match name {
        "a.mtl" => Some(library.as_bytes().to_vec()),
        "rough.pgm" => Some(b"P5 2 1 255 \x10\x20".to_vec()),
        "metal.pgm" => Some(b"P5 1 2 255 \x30\x40".to_vec()),
        "light.ppm" => Some(b"P6 1 1 255 \x01\x02\x03".to_vec()),
        _ => None,
    };
    let files = Held::new(&resolve, &budget);
    let obj = read(Path::new("a.obj"), text.as_bytes(), &files, &|_| ()).expect("a good file");
    let looks: Vec<_> = (obj.mesh.materials.iter())
        .map(|material| material.reflectance.clone().expect("a reflectance"))
        .collect();
    let of = |number: usize| (looks[number].roughness, looks[number].metallic);
    let texels = |number: usize| looks[number].texture.as_ref().map(|image| image.texels());
    assert_eq!(of(0), (1.0, 1.0));
    let both = [
        [0, 16, 48, 255],
        [0, 32, 48, 255],
        [0, 16, 64, 255],
        [0, 32, 64, 255],
    ];
    assert_eq!(texels(0), Some(&both[..]));
    assert!(
        matches!((&looks[0].texture, &looks[5].texture), (Some(a), Some(b)) if Arc::ptr_eq(a, b))
    );
    assert_eq!(of(1), (0.5, 1.0));
    assert_eq!(texels(1), Some(&[[0, 255, 48, 255], [0, 255, 64, 255]][..]));
    assert_eq!(
        (looks[2].emission, looks[3].emission),
        ([1.0; 3], [0.5, 0.0, 0.0])
    );
    for look in &looks[2..4] {
        let light = look.emission_texture.as_ref().map(|image| image.texels());
        assert_eq!(light, Some(&[[1, 2, 3, 255]][..]));
    }
    assert_eq!((of(4), texels(4)), ((0.5, 0.0), None));
    let [lost] = &obj.warnings[..] else {
        panic!("{:?}", obj.warnings)
    };
    assert!(
        lost.starts_with("a.obj: its roughness in \"none.pgm\" cannot be read: "),
        "{lost}"
    );
}

#[test]
fn oddities_are_counted() {
    let obj = parse("v 0 0 0 2\nv 2 0 0 1 1 1\nv 0 2 0 2 2 2 2\nf 1 2 3\n");
    let beginnings: Vec<_> = obj.warnings.iter().map(|w| &w[..w.len().min(40)]).collect();
    assert_eq!(
        beginnings,
        [
            "parts/a.obj: vertices with a fourth valu",
            "parts/a.obj: vertices with values behind",
            "parts/a.obj: vertices with a colour that",
        ]
    );
    assert_eq!(obj.mesh.colors[2], Some(Color([255; 3])));
    assert_eq!(obj.mesh.positions[0], DVec3::ZERO);
}

#[test]
fn names_of_libraries_may_contain_spaces() {
    let resolve = |name: &str| (name == "my own.mtl").then(|| b"newmtl x\nKd 1 0 0\n".to_vec());
    let budget = Budget::default();
    let files = Held::new(&resolve, &budget);
    let lines = [
        ("my own.mtl", 0),
        (r"my\ own.mtl", 0),
        (r"no.mtl my\ own.mtl ", 1),
        (r"my\ own.mtl\t no.mtl\ no.mtl", 2),
    ];
    for (line, lost) in lines {
        let text = format!("mtllib {line}\nusemtl x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        let obj = read(Path::new("a.obj"), text.as_bytes(), &files, &|_| ()).expect("a good file");
        let is_found = lost < 2;
        assert_eq!(obj.mesh.materials.len(), usize::from(is_found), "{line}");
        let missing = obj
            .warnings
            .iter()
            .filter(|warning| warning.contains("cannot be read"));
        assert_eq!(missing.count(), lost, "{line}: {:?}", obj.warnings);
    }
}

#[test]
fn says_where_and_what() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let check = |tail: &str, expected: &str| {
        assert_eq!(error(&format!("{vertices}{tail}")), expected);
    };
    check("", "a.obj: expected faces (lines of `f v v v`), found none");
    check(
        "f 1 2 3\n\nf 1 2 4\nf 1 2 9\n",
        "a.obj:6: expected a vertex index from 1 to 3, as the file has, found 4",
    );
    check(
        "f 1 2 0\n",
        "a.obj:4: expected a vertex index from 1, found 0",
    );
    check(
        "f 1 2 -4\n",
        "a.obj:4: expected a vertex index down to -3, found -4",
    );
    assert_eq!(
        error("f -3 -2 -1\n"),
        "a.obj:1: expected vertices before it (lines of `v x y z`), found -3"
    );
    check(
        "vt 0 0\nf 1/1 2/1 3/2\n",
        "a.obj:5: expected a texture coordinate index from 1 to 1, as the file has, found 2",
    );
    check(
        "f 1 2",
        "a.obj:4: expected three or more corners behind `f`, found \"f 1 2\"",
    );
    check(
        "f 1 2 3\nv 1 2\n",
        "a.obj:5: expected three numbers behind `v`, found \"v 1 2\"",
    );
    check(
        "f 1 2 3\nv 1 2 x\n",
        "a.obj:5: expected three numbers behind `v`, found \"v 1 2 x\"",
    );
    check(
        "f 1 2 3x\n",
        "a.obj:4: expected a corner as `v`, `v/vt`, `v//vn` or `v/vt/vn`, found \"3x\"",
    );
    check(
        "f 1/1/1/1 2 3\n",
        "a.obj:4: expected a corner of at most three indices, found \"1/1/1/1\"",
    );
    assert_eq!(
        error("f 1 2 3\n"),
        "a.obj:1: expected vertices in the file (lines of `v x y z`), found 1"
    );
}

#[test]
fn a_cut_file_is_an_error_or_whole_faces() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 3//1 2//1 1//1";
    // A truncation that cannot be noticed: after a complete face, or where a shortened number is still valid.
    for end in 0..text.len() {
        match parse_bytes(&text.as_bytes()[..end]) {
            Ok(obj) => {
                let faces = text[..end].matches('f').count();
                let last = text[..end].rsplit('\n').next().unwrap_or_default();
                let whole = last.is_empty() || last.split_whitespace().count() == 4;
                assert!(whole, "{last:?}");
                assert_eq!(obj.mesh.triangles.len(), faces);
            }
            Err(error) => assert_eq!(error.to_string().lines().count(), 1),
        }
    }
}

#[test]
fn a_file_that_lost_faces_is_not_read_in_silence() {
    let mut text: String = (0..100).map(|i| format!("v {i} 0 {}\n", i * i)).collect();
    for i in 1..=98 {
        text.push_str(&format!("f {i} {} {}\n", i + 1, i + 2));
    }
    assert!(parse(&text).warnings.is_empty());
    assert!(parse(text.trim_end()).warnings.is_empty());
    let at_line_end = &text[..text.find("f 60 ").expect("a face")];
    assert_eq!(
        parse(at_line_end).warnings,
        ["parts/a.obj: 39 of 100 vertices are in no face: is it cut short?"]
    );
    assert_eq!(
        error(at_line_end.trim_end()),
        "a.obj:159: expected a newline behind the last face, found the file's end, and 39 of \
         100 vertices are in no face: it is cut short"
    );
}

/// No input causes a panic, here or in `tobj`, or an index out of range.
#[test]
fn damaged_files_never_panic() {
    let good = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0 1\nv 0 1 0 1 0 0\nvt 0 0\nvt 1 0\nvn 0 0 1\n\
        usemtl red\nf 1/1/1 2/2/1 3/1/1\nusemtl blue\nf -3//-1 -2//1 -1//1 1//1\nl 1 2 3\n\
        g a\no b\nf 1/2 2/1 \\\n3/1\n";
    let pieces: [&[u8]; 16] = [
        b"9223372036854775807",
        b"-9223372036854775808",
        b"4611686018427387905",
        b"18446744073709551615",
        b"/",
        b"//",
        b"-",
        b"0",
        b"\n",
        b"\\",
        b" ",
        b"nan",
        b"1e999",
        b"\xff",
        b"\xc2\xa0",
        b"f ",
    ];
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = |below: usize| {
        // Xorshift (Marsaglia, "Xorshift RNGs", 2003).
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 33) as usize % below
    };
    let mut read_well = 0;
    for _ in 0..20_000 {
        let mut bytes = good.to_vec();
        for _ in 0..1 + random(4) {
            let start = random(bytes.len() + 1);
            let end = (start + random(4)).min(bytes.len());
            let piece = pieces[random(pieces.len())];
            bytes.splice(start..end, piece.iter().copied());
        }
        if let Ok(obj) = parse_bytes(&bytes) {
            read_well += 1;
            let count = obj.mesh.positions.len() as u32;
            assert!(obj.mesh.triangles.iter().flatten().all(|&i| i < count));
        }
    }
    assert!((1000..19_000).contains(&read_well), "{read_well}");
}
