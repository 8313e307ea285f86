//! Scene files.

use super::picture::is_seen_soundly;
use super::reading::{IMAGE, LIBRARY, MESH, Reading, is_message, read};
use raycast_core::formats::{SaveError, SceneFile};
use raycast_core::scene::Object;
use std::path::Path;

/// What must hold of a scene file.
///
/// # Errors
/// What does not.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    // What is not UTF-8 is refused before it is a text at all: nothing to look for here.
    let Ok(text) = std::str::from_utf8(bytes) else {
        return Ok(());
    };
    let Ok(file) = read_scene(text)? else {
        return Ok(());
    };
    // Transforms that are finite one by one, and not together, are known when they are put together:
    // such a scene cannot be shown either.
    let saved = match file.to_toml(Path::new("")) {
        Err(SaveError::Scene(refusal)) => return is_message(&refusal.to_string()),
        saved => saved.map_err(|error| format!("it cannot be saved: {error}"))?,
    };
    let again = read_scene(&saved)?.map_err(|error| format!("saved, it is refused: {error}"))?;
    are_equal(&file, &again)?;
    let twice = again.to_toml(Path::new(""));
    if twice.as_ref().ok() != Some(&saved) {
        return Err(format!("saved as {saved:?}, then as {twice:?}"));
    }
    is_seen_soundly(&file)
}

/// Reads a scene for which every mesh and image that it may name is there.
fn read_scene(text: &str) -> Result<Reading, String> {
    let files = |name: &str| match Path::new(name).extension()?.to_str()? {
        // Its last triangle is a group, which a scene can hide.
        "obj" => Some(MESH.replace("usemtl b", "g lid\nusemtl b").into()),
        "txt" => Some("(0,0,0);(1,0,0);(0,1,0)\n".into()),
        "mtl" => Some(LIBRARY.into()),
        "ppm" => Some(IMAGE.into()),
        _ => None,
    };
    read(text, &files)
}

/// Whether two scenes are the same but for names, which a saved scene may have to change.
fn are_equal(a: &SceneFile, b: &SceneFile) -> Result<(), String> {
    let differ = |what: &str, a: String, b: String| match a == b {
        true => Ok(()),
        false => Err(format!("{what} {a} is saved as {b}")),
    };
    differ(
        "camera",
        format!("{:?}", a.camera),
        format!("{:?}", b.camera),
    )?;
    differ("image", format!("{:?}", a.image), format!("{:?}", b.image))?;
    differ(
        "shading",
        format!("{:?}", a.shading),
        format!("{:?}", b.shading),
    )?;
    let objects = |file: &SceneFile| file.scene.objects.len();
    differ("count", objects(a).to_string(), objects(b).to_string())?;
    for (a, b) in a.scene.objects.iter().zip(&b.scene.objects) {
        let plain = |object: &Object| {
            let Object {
                transform,
                parent,
                color,
                source,
                texture_source,
                visible,
                hidden_groups,
                node,
                shape,
                ..
            } = object;
            let hidden = hidden_groups.as_ref().map(|hidden| hidden.names());
            format!(
                "{transform:?} {parent:?} {color:?} {source:?} {texture_source:?} {node:?} {shape:?} {visible} {hidden:?}"
            )
        };
        differ("object", plain(a), plain(b))?;
        if a.texture != b.texture {
            return Err("an object's texture is not the same when saved".to_owned());
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_found() {
        let text = "[camera]\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n\n[image]\nsize = [8, 8]\n\n\
            [shading]\nmode = \"flat\"\n\n[[object]]\nmesh = \"a.obj\"\ntexture = \"t.ppm\"\n\
            translate = [1, 2, 3]\nhidden-groups = [\"lid\"]\n";
        assert_eq!(check(text.as_bytes()), Ok(()));
        let read = |text: &str| read_scene(text).expect("fit messages").expect("a scene");
        for (from, to) in [
            ("eye = [0", "eye = [1"),
            ("[8, 8]", "[8, 9]"),
            ("flat", "smooth"),
            ("a.obj", "b.obj"),
            ("t.ppm", "u.ppm"),
            ("[1, 2, 3]", "[1, 2, 4]"),
            ("[\"lid\"]", "[\"\"]"),
        ] {
            let other = read(&text.replace(from, to));
            assert!(are_equal(&read(text), &other).is_err(), "{from} as {to}");
        }
    }
}
