//! A command line that makes a picture: written so that it reads back as the same.

use super::values::{CULLS, FILTERS, MODES, Names, PRECISIONS, PROJECTIONS, TEXTURE_PROJECTIONS};
use raycast_core::camera::Camera;
use raycast_core::formats::Limits;
use raycast_core::glam::DVec3;
use raycast_core::render::Settings;
use raycast_core::scene::UpAxis;
use raycast_core::shade::Background;
use std::path::PathBuf;

/// `raycast render` with all that decides the picture's bytes: whatever a scene file among `files` says of camera
/// and shading, but for lines along edges, which an option switches on and none switches off.
///
/// Numbers have the fewest digits that read back as the same, and words are quoted for a shell where they
/// need to be. `None` where a path is no text.
pub fn render_command(
    files: &[PathBuf],
    output: &str,
    camera: &Camera,
    settings: &Settings,
    limits: &Limits,
) -> Option<String> {
    let mut words = vec!["raycast".to_owned(), "render".to_owned()];
    for file in files {
        // A command is run anywhere.
        let file = std::path::absolute(file).ok()?;
        words.push(file.to_str()?.to_owned());
    }
    let mut option = |name: &str, value: String| words.extend([name.to_owned(), value]);
    option("-o", output.to_owned());
    let (plane, placement) = (camera.plane(), camera.placement());
    option("--size", format!("{}x{}", plane.columns, plane.rows));
    option("--step", plane.step.to_string());
    option("--projection", word(PROJECTIONS, camera.projection()));
    option("--eye", point(placement.eye));
    option("--target", point(placement.target));
    option("--up", point(placement.up));
    let shading = &settings.shading;
    option("--mode", word(MODES, shading.mode));
    option(
        "--background",
        match shading.background {
            Background::Transparent => "transparent".to_owned(),
            Background::Gradient(top, bottom) => format!("{top},{bottom}"),
        },
    );
    option("--blend", shading.blend.to_string());
    option("--filter", word(FILTERS, shading.filter));
    let projection = word(TEXTURE_PROJECTIONS, shading.projection);
    option("--texture-projection", projection);
    option("--samples", settings.samples.max(1).to_string());
    option("--cull", word(CULLS, settings.cull));
    option("--precision", word(PRECISIONS, settings.precision));
    if let Some(lines) = shading.wireframe {
        option("--wireframe-color", lines.color.to_string());
        words.push(format!("--wireframe={}", lines.width));
    }
    words.extend(reading(limits));
    let words: Vec<_> = words.iter().map(|word| quoted(word)).collect();
    Some(words.join(" "))
}

/// The options of reading that are not at their defaults.
fn reading(limits: &Limits) -> Vec<String> {
    let mut words = Vec::new();
    let usual = Limits::default();
    for (name, most, usual) in [
        ("bytes", limits.bytes, usual.bytes),
        ("pixels", limits.pixels, usual.pixels),
        ("triangles", limits.triangles, usual.triangles),
    ] {
        if most != usual {
            words.extend(["--limit".to_owned(), format!("{name}={most}")]);
        }
    }
    if limits.follow_anywhere {
        words.push("--follow-anywhere".to_owned());
    }
    if limits.up_axis == UpAxis::Z {
        words.extend(["--up-axis".to_owned(), "z".to_owned()]);
    }
    words
}

fn word<T: PartialEq>(names: Names<T>, value: T) -> String {
    let name = names.iter().find(|(_, named)| *named == value);
    name.map_or_else(String::new, |(name, _)| (*name).to_owned())
}

fn point(point: DVec3) -> String {
    format!("{},{},{}", point.x, point.y, point.z)
}

/// A word as a shell takes it: in single quotes (on Windows in double ones) unless it is plain.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-./:,=+@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    if cfg!(windows) {
        format!("\"{word}\"")
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_would_split_or_change_them() {
        assert_eq!(quoted("/a/b-1.obj"), "/a/b-1.obj");
        assert_eq!(quoted("--wireframe=1.5"), "--wireframe=1.5");
        if !cfg!(windows) {
            assert_eq!(quoted("a b"), "'a b'");
            assert_eq!(quoted("it's $HOME"), r"'it'\''s $HOME'");
            assert_eq!(quoted("#102030"), "'#102030'");
        }
    }

    #[test]
    fn options_of_reading_are_told_where_they_differ() {
        assert!(reading(&Limits::default()).is_empty());
        let limits = Limits {
            pixels: 5,
            follow_anywhere: true,
            up_axis: UpAxis::Z,
            ..Limits::default()
        };
        let words = ["--limit", "pixels=5", "--follow-anywhere", "--up-axis", "z"];
        assert_eq!(reading(&limits), words);
    }
}
