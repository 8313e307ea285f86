//! Makes the fuzzers' seeds that are no text: images, fragments, meshes, rays.
//!
//! `cargo run --release -p raycast-tests --example seeds` writes them into `fuzz/seeds`, the same each
//! time. Seeds that are text were written by hand.

use exr::prelude::{Compression, WritableImage, read_all_data_from_file};
use image::codecs::{jpeg::JpegEncoder, png::PngEncoder};
use image::{DynamicImage, Rgba, RgbaImage};
use raycast_core::formats::{MeshFormat, read_scene, write_meshes, write_prepared};
use raycast_tests::binary::succeed;
use raycast_tests::fuzz::reading::{IMAGE, LIBRARY, MESH, read_mesh};
use raycast_tests::fuzz::threemf;
use std::error::Error;
use std::ffi::OsStr;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use zip::CompressionMethod;

fn main() -> Result<(), Box<dyn Error>> {
    textures()?;
    fragments()?;
    meshes()?;
    files_of_objects()?;
    prepared()?;
    rays()
}

fn seed(target: &str, name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../fuzz/seeds")
        .join(target)
        .join(name)
}

/// A small mesh with everything in binary PLY of both byte orders, in binary STL, and with colours of
/// facets as two programs have them.
fn meshes() -> Result<(), Box<dyn Error>> {
    let read = read_mesh("mesh.obj", MESH.as_bytes())??;
    let write = |format| {
        let mut bytes = Vec::new();
        write_meshes(&read.scene, format, None, &mut bytes).map(|_| bytes)
    };
    std::fs::write(
        seed("ply", "binary"),
        write(MeshFormat::Ply { ascii: false })?,
    )?;
    let stl = write(MeshFormat::Stl { ascii: false })?;
    std::fs::write(seed("stl", "binary"), &stl)?;
    let mut viscam = stl.clone();
    viscam[84 + 48..84 + 50].copy_from_slice(&[0x1f, 0x80]);
    std::fs::write(seed("stl", "colors_viscam"), &viscam)?;
    let mut magics = stl;
    magics[32..42].copy_from_slice(b"COLOR=abcd");
    magics[84 + 48..84 + 50].copy_from_slice(&[0x1f, 0x02]);
    std::fs::write(seed("stl", "colors_magics"), &magics)?;
    let mut big = b"ply\nformat binary_big_endian 1.0\nelement vertex 4\nproperty double x\n\
        property short y\nproperty float z\nelement face 2\n\
        property list ushort uint vertex_index\nend_header\n"
        .to_vec();
    for [x, y, z] in [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 2i16]] {
        big.extend(f64::from(x).to_be_bytes());
        big.extend(y.to_be_bytes());
        big.extend(f32::from(z).to_be_bytes());
    }
    for face in [&[0u32, 1, 2, 3][..], &[0, 2, 3]] {
        big.extend((face.len() as u16).to_be_bytes());
        big.extend(face.iter().flat_map(|corner| corner.to_be_bytes()));
    }
    std::fs::write(seed("ply", "big_endian"), big)?;
    Ok(())
}

/// Small images of every kind of sample that PNG has, JPEG in grey and in colour, every kind of PNM.
fn textures() -> Result<(), Box<dyn Error>> {
    let pixel = |x, y| {
        let level = (x * 40 + y * 7) as u8;
        Rgba([level, 255 - level, 3 * level, 255 - 30 * y as u8])
    };
    let image = DynamicImage::ImageRgba8(RgbaImage::from_fn(5, 3, pixel));
    let kinds = [
        ("grey", DynamicImage::ImageLuma8(image.to_luma8())),
        (
            "grey_alpha",
            DynamicImage::ImageLumaA8(image.to_luma_alpha8()),
        ),
        ("rgb", DynamicImage::ImageRgb8(image.to_rgb8())),
        ("rgb_16", DynamicImage::ImageRgb16(image.to_rgb16())),
        ("rgba", image.clone()),
    ];
    for (name, kind) in &kinds {
        let mut png = Vec::new();
        kind.write_with_encoder(PngEncoder::new(&mut png))?;
        std::fs::write(seed("texture", &format!("png_{name}")), png)?;
    }
    for (name, kind) in [&kinds[0], &kinds[2]] {
        let mut jpeg = Vec::new();
        kind.write_with_encoder(JpegEncoder::new_with_quality(&mut jpeg, 50))?;
        std::fs::write(seed("texture", &format!("jpeg_{name}")), jpeg)?;
    }
    for (name, bytes) in [
        ("p1", &b"P1\n3 2\n1 0 1\n0 1 0\n"[..]),
        ("p2", b"P2\n# grey\n2 2\n15\n0 5\n10 15\n"),
        ("p3", b"P3\n1 2\n255\n255 0 0\n0 128 255\n"),
        ("p4", b"P4\n9 2\n\xaa\x80\x55\0"),
        ("p5", b"P5\n2 2\n255\n\x00\x40\x80\xff"),
        ("p6", b"P6\n1 2\n65535\nabcdefghijkl"),
    ] {
        std::fs::write(seed("texture", &format!("pnm_{name}")), bytes)?;
    }
    Ok(())
}

/// Fragments as the program writes them, with and without alpha, whole and in part; EXR in every
/// compression that is read.
fn fragments() -> Result<(), Box<dyn Error>> {
    let whole = ["--tiles", "1x1", "--sub-camera", "0,0"];
    let part = [
        "--tiles",
        "2x2",
        "--sub-camera",
        "1,1",
        "--background",
        "transparent",
    ];
    render(&seed("fragment_png", "whole"), "png", &whole)?;
    render(&seed("fragment_png", "part"), "png", &part)?;
    render(&seed("picture_tiff", "opaque"), "tif", &[])?;
    render(
        &seed("picture_tiff", "transparent"),
        "tif",
        &["--background", "transparent"],
    )?;
    render(&seed("fragment_exr", "whole"), "exr", &whole)?;
    render(&seed("fragment_exr", "part"), "exr", &part)?;
    render(&seed("fragment_exr", "picture"), "exr", &[])?;
    for (name, compression) in [
        ("uncompressed", Compression::Uncompressed),
        ("rle", Compression::RLE),
        ("zip1", Compression::ZIP1),
    ] {
        for from in ["part", "picture"] {
            let mut image = read_all_data_from_file(seed("fragment_exr", from))?;
            for layer in &mut image.layer_data {
                layer.encoding.compression = compression;
            }
            let mut bytes = Cursor::new(Vec::new());
            image.write().to_buffered(&mut bytes)?;
            let name = format!("{from}_{name}");
            std::fs::write(seed("fragment_exr", &name), bytes.into_inner())?;
        }
    }
    Ok(())
}

/// Renders a small picture of a cube, or what else the options say.
fn render(place: &Path, ending: &str, options: &[&str]) -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let picture = folder.path().join(format!("picture.{ending}"));
    let cube = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/cube.obj");
    let arguments = [cube.as_path(), Path::new("-o"), &picture];
    let arguments = arguments.iter().map(|path| path.as_os_str());
    let options = options.iter().map(OsStr::new);
    let size = ["--size", "9x7"].map(OsStr::new);
    let render = std::iter::once(OsStr::new("render"));
    succeed(render.chain(arguments).chain(size).chain(options));
    std::fs::copy(&picture, place)?;
    Ok(())
}

/// Binary meshes: a GLB with an image of its own, and 3MF archives of the model parts that are text.
fn files_of_objects() -> Result<(), Box<dyn Error>> {
    let mut binary: Vec<u8> = [0f32, 0., 0., 1., 0., 0., 0., 1., 0.]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let image = b"P3\n1 1\n255\n9 200 30\n";
    binary.extend(image);
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{}}}],"bufferViews":[{{"buffer":0,"byteLength":36}},
{{"buffer":0,"byteOffset":36,"byteLength":{}}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},
{{"bufferView":0,"byteOffset":8,"componentType":5121,"normalized":true,"count":3,"type":"VEC2"}}],"images":[{{"bufferView":1}}],
"textures":[{{"source":0}}],"materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1}},"material":0}}]}}],"nodes":[{{"mesh":0}}]}}"#,
        binary.len(),
        image.len()
    );
    let mut json = json.into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let number = |x: usize| (x as u32).to_le_bytes();
    let mut glb = [
        &b"glTF"[..],
        &number(2),
        &number(28 + json.len() + binary.len()),
    ]
    .concat();
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &binary)] {
        glb.extend(number(chunk.len()));
        glb.extend(kind);
        glb.extend(chunk);
    }
    std::fs::write(seed("gltf", "binary"), glb)?;
    for (name, compression) in [
        ("archive", CompressionMethod::Deflated),
        ("archive_stored", CompressionMethod::Stored),
    ] {
        let model = std::fs::read(seed("threemf", "components"))?;
        let other = std::fs::read(seed("threemf", "colors"))?;
        let parts = [
            ("_rels/.rels", threemf::RELATIONSHIPS.as_bytes()),
            ("3D/m.model", &model),
            ("3D/other.model", &other),
        ];
        std::fs::write(
            seed("threemf", name),
            threemf::archive(&parts, compression)?,
        )?;
    }
    Ok(())
}

/// Prepared files: of an OBJ with everything, of the objects of a 3MF, of a PLY with scalars.
fn prepared() -> Result<(), Box<dyn Error>> {
    let scalars = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n\
        property float z\nproperty float height\nelement face 2\nproperty list uchar int vertex_indices\n\
        property float part\nend_header\n0 0 0 1\n1 0 0 2\n1 1 0 3\n0 1 0 4\n5 5 1 0\n4 0 1 2 3 7\n3 0 2 4 8\n";
    // Of one material, whose image is on all of it.
    let plain = MESH.replace("usemtl b\n", "");
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("a.mtl"), LIBRARY)?;
    std::fs::write(folder.path().join("t.ppm"), IMAGE)?;
    for (name, from, bytes) in [
        ("everything", "mesh.obj", MESH.as_bytes()),
        (
            "objects",
            "mesh.3mf",
            &std::fs::read(seed("threemf", "archive"))?,
        ),
        ("scalars", "mesh.ply", scalars.as_bytes()),
        ("textured", "plain.obj", plain.as_bytes()),
    ] {
        let mesh = folder.path().join(from);
        std::fs::write(&mesh, bytes)?;
        let file = read_scene(&mesh, &|_| ())?;
        let mut prepared = Vec::new();
        write_prepared(&file, &folder.path().join("mesh.raycast"), &mut prepared)?;
        std::fs::create_dir_all(seed("prepared", "").as_path())?;
        std::fs::write(seed("prepared", name), prepared)?;
    }
    Ok(())
}

/// Rays along the axes, at corners, at edges, in planes, and such as are none, at every scene.
fn rays() -> Result<(), Box<dyn Error>> {
    let far = f32::MAX;
    let rays: [[f32; 8]; 10] = [
        [0.2, 0.3, 5.0, 0.0, 0.0, 0.0, -1.0, far],
        [1.0, 0.25, 5.0, 0.0, -0.0, 0.0, -1.0, 100.0],
        [0.0, 0.0, 5.0, 0.0, 0.0, 0.0, -1.0, 4.0],
        [0.5, 0.5, 120_500.0, 0.0, 0.0, 0.0, -1.0, far],
        [1.0, 1.0, 1.0, 0.0, -1.0, -1.0, -1.0, 2.0],
        [148_376.0, 1234.0, -223_418.0, 0.0, 0.1, 0.2, -1.0, far],
        [-5.0, 0.0, 0.0, 0.0, 1e-9, 0.0, 0.0, f32::INFINITY],
        [0.25, 0.5, 3.0, -2.0, 0.0, 1e-30, -1e9, 1.0],
        [f32::NAN, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, far],
        [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, far],
    ];
    let bytes: Vec<u8> = rays
        .iter()
        .flatten()
        .flat_map(|n| n.to_le_bytes())
        .collect();
    for scene in 0..8 {
        for (name, choice) in [("all", scene), ("culled", 0x80 | scene)] {
            let file = [&[choice][..], &bytes].concat();
            std::fs::write(seed("rays", &format!("scene_{scene}_{name}")), file)?;
        }
    }
    Ok(())
}
