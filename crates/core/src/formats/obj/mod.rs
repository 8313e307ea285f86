mod content;
mod mtl;
mod pieces;
mod reader;
mod text;
mod words;

use crate::formats::Progress;
use crate::formats::error::FormatError;
use crate::formats::files::{By, Contents, Files, beside};
use crate::formats::limits::Budget;
use crate::formats::parsed::BLENDED;
use crate::formats::{polygon, texture};
use crate::quote::{self, quote};
use crate::scene::{Alpha, Attribute, Diagonals, MeshData, Opacity, Texture};
use content::{NONE, ObjText, Oddities};
use glam::Vec3;
use mtl::{MtlMaterial, Unused};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// An OBJ file.
#[derive(Debug)]
pub(super) struct Obj {
    pub(super) mesh: MeshData,
    /// The image, if the materials of all faces name the same one.
    pub(super) texture: Option<PathBuf>,
    /// Contents of its material libraries that are not shown.
    pub(super) notes: Vec<String>,
    /// Faults that are too small to refuse the file.
    pub(super) warnings: Vec<String>,
}

/// Reads an OBJ file, and through `files` its material libraries.
///
/// Triangles are in the file's order of faces, regardless of groups and materials. Positions are those of the file,
/// including unused ones, and keep their indices.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    files: &dyn Files,
    progress: Progress<'_>,
) -> Result<Obj, FormatError> {
    let mut text = text::read(path, bytes, files.budget(), &|share| progress(share * 0.9))?;
    if text.triangles.is_empty() {
        return Err(FormatError::unexpected(
            path,
            None,
            "faces (lines of `f v v v`)",
            "none",
        ));
    }
    let mut warnings = Vec::new();
    warnings.extend(loose_vertices(path, &text)?);
    warnings.extend(odd_lines(path, &text.oddities));
    let mut unused = Unused::new();
    let (materials, texture) = materials(path, &text, files, &mut warnings, &mut unused);
    let material_of_triangle = if materials.is_empty() {
        Vec::new()
    } else {
        spread(&text)
    };
    let mut mesh = MeshData {
        uvs: attribute(
            std::mem::take(&mut text.uvs),
            std::mem::take(&mut text.uv_triangles),
            text.triangles.len(),
            |uv| uv.is_finite(),
        ),
        normals: attribute(
            std::mem::take(&mut text.normals),
            std::mem::take(&mut text.normal_triangles),
            text.triangles.len(),
            |normal| *normal != Vec3::ZERO,
        ),
        positions: text.positions,
        triangles: text.triangles,
        colors: text.colors,
        material_of_triangle,
        materials: Vec::new(),
        scalars: Vec::new(),
        diagonals: Diagonals::default(),
    };
    progress(0.95);
    let uncut = polygon::cut(&mut mesh, &text.polygons);
    warnings.extend(uncut.warnings(path));
    let numbers = number_of(&materials);
    let named: Vec<u32> = text
        .materials
        .iter()
        .map(|name| numbers.get(name.as_str()).copied().unwrap_or(NONE))
        .collect();
    for material in &mut mesh.material_of_triangle {
        *material = named.get(*material as usize).copied().unwrap_or(NONE);
    }
    mesh.materials = materials
        .into_iter()
        .map(|(material, _)| material.material)
        .collect();
    progress(1.0);
    Ok(Obj {
        mesh,
        texture,
        notes: notes(&unused),
        warnings,
    })
}

/// The materials of a file's libraries, each with the path of its library.
type Materials = Vec<(MtlMaterial, PathBuf)>;

/// A note about contents that are not shown, if there are any.
fn notes(unused: &Unused) -> Vec<String> {
    let of = |(word, count): (&String, &usize)| format!("{} ({count} materials)", quote(word));
    let words: Vec<String> = unused.iter().map(of).collect();
    match words.is_empty() {
        true => Vec::new(),
        false => vec![format!("not used: {}", words.join(", "))],
    }
}

/// The index of each name. Of materials with the same name the last one counts.
fn number_of(materials: &Materials) -> HashMap<&str, u32> {
    materials
        .iter()
        .zip(0..)
        .map(|((material, _), number)| (material.material.name.as_str(), number))
        .collect()
}

/// A warning where many vertices are in no face: the file may be truncated.
///
/// # Errors
/// The same, where the file also ends in a face without a line end: then it is truncated.
fn loose_vertices(path: &Path, text: &ObjText) -> Result<Option<String>, FormatError> {
    // Complete files have unused vertices, too: the Stanford bunny 3 in 100; but hardly 5.
    const FEWEST: usize = 16;
    let vertices = text.positions.len();
    let mut is_used = vec![false; vertices];
    for &vertex in text.triangles.iter().flatten() {
        if let Some(is_used) = is_used.get_mut(vertex as usize) {
            *is_used = true;
        }
    }
    let loose = is_used.iter().filter(|is_used| !**is_used).count();
    if loose < FEWEST || loose * 20 < vertices {
        return Ok(None);
    }
    let what = format!("{loose} of {vertices} vertices are in no face");
    if text.open_end.is_some() {
        let found = format!("the file's end, and {what}: it is cut short");
        let expected = "a newline behind the last face";
        return Err(FormatError::unexpected(
            path,
            text.open_end,
            expected,
            found,
        ));
    }
    let path = quote::path(path);
    Ok(Some(format!("{path}: {what}: is it cut short?")))
}

/// A warning for each type of oddity in the file.
fn odd_lines(path: &Path, oddities: &Oddities) -> Vec<String> {
    let Oddities {
        dangling,
        weights,
        extra_values,
        colors_out_of_range,
    } = *oddities;
    let counts = [
        (
            dangling,
            "faces that name texture coordinates or normals of which the file has none",
        ),
        (
            weights,
            "vertices with a fourth value that is not 1, in OBJ a weight for rational curves and \
             surfaces alone, which is passed over",
        ),
        (
            extra_values,
            "vertices with values behind their colour, which are passed over",
        ),
        (
            colors_out_of_range,
            "vertices with a colour that is not from 0 to 1, which is clamped",
        ),
    ];
    let path = quote::path(path);
    let odd = counts.iter().filter(|(count, _)| *count > 0);
    odd.map(|(count, what)| format!("{path}: {what}: {count}"))
        .collect()
}

/// The materials of the file's libraries; and the image, if those of all faces name the same one.
fn materials(
    path: &Path,
    text: &ObjText,
    files: &dyn Files,
    warnings: &mut Vec<String>,
    unused: &mut Unused,
) -> (Materials, Option<PathBuf>) {
    let mut materials = Materials::new();
    for (library, bytes) in libraries(path, &text.libraries, files, warnings) {
        for image in mtl::images(&bytes) {
            files.name(&beside(&library, &image));
        }
        let read = mtl::read(&library, &bytes, warnings, unused);
        materials.extend(read.into_iter().map(|material| (material, library.clone())));
    }
    let numbers = number_of(&materials);
    let material = |name: u32| {
        let name = text.materials.get(name as usize)?;
        materials.get(*numbers.get(name.as_str())? as usize)
    };
    let unknown = (0..text.materials.len() as u32)
        .filter(|&name| material(name).is_none())
        .count();
    if !materials.is_empty() && unknown > 0 {
        warnings.push(format!(
            "{}: {unknown} materials are in none of its libraries",
            quote::path(path)
        ));
    }
    let used: Vec<usize> = (text.materials.iter())
        .filter_map(|name| numbers.get(name.as_str()).map(|&number| number as usize))
        .collect();
    let image = |name: u32| {
        let (material, library) = material(name)?;
        Some(beside(library, material.texture.as_deref()?))
    };
    let has_bare_start = text.material_runs.first().is_none_or(|run| run.0 > 0);
    let mut names: Vec<u32> = text.material_runs.iter().map(|run| run.1).collect();
    names.extend(has_bare_start.then_some(NONE));
    names.sort_unstable();
    names.dedup();
    let mut images = names.into_iter().map(image);
    let first = images.next().flatten();
    let texture = first.filter(|first| images.all(|image| image.as_ref() == Some(first)));
    masks(path, &mut materials, &used, files, warnings);
    let is_blended = |&&number: &&usize| {
        let opacity = &materials[number].0.material.opacity;
        matches!(opacity, Opacity::Blend(_))
    };
    let blended = used.iter().filter(is_blended).count();
    if blended > 0 {
        warnings.push(format!("{}: {BLENDED}: {blended}", quote::path(path)));
    }
    (materials, texture)
}

/// Reads the opacity images of the used materials. A material whose library gives no other opacity becomes a mask;
/// otherwise the image's alpha is part of its blending.
fn masks(
    path: &Path,
    materials: &mut Materials,
    used: &[usize],
    files: &dyn Files,
    warnings: &mut Vec<String>,
) {
    let mut images: HashMap<PathBuf, Option<Arc<Texture>>> = HashMap::new();
    for &number in used {
        let (material, library) = &mut materials[number];
        let Some(name) = &material.opacity else {
            continue;
        };
        let file = beside(library, name);
        let image = images.entry(file).or_insert_with_key(|file| {
            let read = files
                .read(file, By::Mesh(path), &|_| ())
                .and_then(|bytes| texture::decode(file, &bytes, files.budget()))
                .and_then(|image| as_alpha(file, image, files.budget()));
            match read {
                Ok(image) => Some(Arc::new(image)),
                Err(error) => {
                    let (path, name, why) = (quote::path(path), quote(name), error.reason());
                    warnings.push(format!(
                        "{path}: its opacity in {name} cannot be read: {why}"
                    ));
                    None
                }
            }
        });
        let Some(image) = image.clone() else { continue };
        material.material.opacity = match &material.material.opacity {
            Opacity::Blend(alpha) => Opacity::Blend(Alpha {
                image: Some(image),
                ..alpha.clone()
            }),
            Opacity::Opaque | Opacity::Mask { .. } => Opacity::Mask {
                alpha: Alpha {
                    factor: 1.0,
                    image: Some(image),
                },
                cutoff: Opacity::CUTOFF,
            },
        };
    }
}

/// The alpha of an opacity image: its alpha channel if it has one, else its red channel, which is its grey.
fn as_alpha(path: &Path, image: Texture, budget: &Budget) -> Result<Texture, FormatError> {
    let texels = image.texels();
    if texels.iter().any(|texel| texel[3] < u8::MAX) {
        return Ok(image);
    }
    let _copy = budget.share(path, "the image's opacity", size_of_val(texels) as u64)?;
    let texels = texels.iter().map(|&[grey, ..]| [grey; 4]).collect();
    Ok(Texture::new(image.width(), image.height(), texels).unwrap_or(image))
}

/// The index of the material's name of every triangle.
fn spread(text: &ObjText) -> Vec<u32> {
    let mut names = vec![NONE; text.triangles.len()];
    for (index, &(first, name)) in text.material_runs.iter().enumerate() {
        let next = text.material_runs.get(index + 1);
        let end = next.map_or(names.len(), |next| next.0 as usize);
        names[first as usize..end].fill(name);
    }
    names
}

/// The most material libraries that a mesh may name: each costs a file access.
const LIBRARY_LIMIT: usize = 1000;

/// The bytes of the libraries after `mtllib`: each line is one name, which may contain spaces, or several names.
fn libraries<'f>(
    path: &Path,
    lines: &[String],
    files: &'f dyn Files,
    warnings: &mut Vec<String>,
) -> Vec<(PathBuf, Contents<'f>)> {
    let mut found: Vec<(PathBuf, Contents<'f>)> = Vec::new();
    let mut tried = 0;
    let mut add = |name: &str| -> Result<(), FormatError> {
        tried += 1;
        if tried > LIBRARY_LIMIT {
            let reason = format!("a mesh has at most {LIBRARY_LIMIT} material libraries");
            return Err(FormatError::refused(path, None, &reason));
        }
        let library = beside(path, name);
        if found.iter().all(|(known, _)| *known != library) {
            files.name(&library);
            let bytes = files.read(&library, By::Mesh(path), &|_| ())?;
            found.push((library, bytes));
        }
        Ok(())
    };
    for line in lines {
        let Err(error) = add(line) else { continue };
        let names: Vec<_> = line.split_whitespace().collect();
        let missing: Vec<_> = if names.len() > 1 {
            let failures = names.into_iter().map(|name| (name, add(name).err()));
            failures
                .filter_map(|(name, error)| Some((name, error?)))
                .collect()
        } else {
            vec![(line.as_str(), error)]
        };
        for (name, error) in missing {
            let path = quote::path(path);
            let (name, why) = (quote(name), error.reason());
            warnings.push(format!(
                "{path}: its materials in {name} cannot be read: {why}"
            ));
        }
    }
    found
}

/// Values at corners. A triangle without values, or with an invalid one, has no indices; `None` where that is every
/// triangle.
fn attribute<T>(
    values: Vec<T>,
    mut indices: Vec<[u32; 3]>,
    triangles: usize,
    is_good: impl Fn(&T) -> bool,
) -> Option<Attribute<T>> {
    let mut any = false;
    for triangle in &mut indices {
        let is_good = |&i: &u32| values.get(i as usize).is_some_and(&is_good);
        if triangle.iter().all(is_good) {
            any = true;
        } else {
            *triangle = [NONE; 3];
        }
    }
    any.then(|| {
        indices.resize(triangles, [NONE; 3]);
        Attribute {
            values,
            indices: Some(indices),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::held::Held;
    use crate::formats::limits::Budget;
    use crate::scene::Color;
    use glam::{DVec3, Vec2};

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
        let obj =
            parse("mtllib no.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/1 2/2/2 3/3/3\n");
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

    #[test]
    fn materials_are_masks_or_blended() {
        let library = "newmtl leaf\nmap_d leaf.pgm\nnewmtl glass\nTr 0.75\nmap_d leaf.pgm\n\
            newmtl stone\nd 1\nTr 0.5\nnewmtl unused\nd 0.5\nmap_d none.pgm\nnewmtl lost\nmap_d none.pgm\n";
        let text = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl leaf\nf 1 2 3\nusemtl glass\nf 1 2 3\n\
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
}
