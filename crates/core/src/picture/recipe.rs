//! The recipe of a picture: everything that decides its bytes.

use crate::camera::{Camera, PixelFilter};
use crate::digest::Digest;
use crate::hit::{Cull, Precision};
use crate::scene::ClippingPlanes;
use crate::shade::{Background, Shading};

/// Everything that decides a picture's bytes, and nothing else: not the split, the number of threads, the names of
/// files or the time. All fragments of a picture have the same recipe, and so has the stitched picture.
///
/// Its text is canonical: equal recipes have equal texts in any process. It has a line for each key in a fixed order,
/// and floats with the fewest digits that read back as the same number. The last line is the [`Digest`] of the lines
/// before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recipe {
    /// The checksum of as much of the scene as the picture shows: its
    /// [`triangle_content`](crate::scene::Scene::triangle_content) where that is all, as in flat pictures in one
    /// colour, else its [`content`](crate::scene::Scene::content).
    pub scene: Digest,
    /// The camera.
    pub camera: Camera,
    /// Samples a pixel.
    pub samples: u32,
    /// The filter that weighs them.
    pub pixel_filter: PixelFilter,
    /// Which faces rays hit.
    pub cull: Cull,
    /// The enabled clipping planes.
    pub clip: ClippingPlanes,
    /// Exact or rounded casting.
    pub precision: Precision,
    /// Mode, colours, light, textures and lines.
    pub shading: Shading,
}

impl Recipe {
    /// A checksum of the whole recipe.
    pub fn digest(&self) -> Digest {
        Digest::of(self.lines().as_bytes())
    }

    /// Whether every pixel covers what lies behind the picture.
    pub fn is_opaque(&self) -> bool {
        self.shading.background != Background::Transparent && self.camera.is_filled()
    }

    /// The first difference from another recipe, in words, in the order scene, size, camera, settings. `None` where
    /// they are equal.
    pub fn difference(&self, other: &Self) -> Option<String> {
        if self.scene != other.scene {
            return Some("it was made from another scene".to_owned());
        }
        if self.clip != other.clip {
            return Some("it was made with other clipping planes".to_owned());
        }
        let (mine, theirs) = (self.lines(), other.lines());
        // One of them may have more lines.
        let count = mine.lines().count().max(theirs.lines().count());
        let padded = |text: &str| -> Vec<String> {
            let lines = text.lines().chain(std::iter::repeat("nothing"));
            lines.take(count).map(str::to_owned).collect()
        };
        let (mine, theirs) = (padded(&mine), padded(&theirs));
        let (mine, theirs) = mine
            .iter()
            .zip(&theirs)
            .find(|(mine, theirs)| mine != theirs)?;
        let camera = [
            "size",
            "step",
            "projection",
            "eye",
            "target",
            "up",
            "shift",
            "lens",
            "stereo",
        ];
        let key = |line: &str| line.split(' ').next().unwrap_or_default().to_owned();
        Some(
            if camera.contains(&&*key(theirs)) || camera.contains(&&*key(mine)) {
                format!("it was made with another camera ({theirs}, not {mine})")
            } else {
                format!("it was made with other settings ({theirs}, not {mine})")
            },
        )
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::camera::{ImagePlane, Pose, Projection};
    use crate::scene::{ClippingPlane, Color, ColorMap, ColorScale, Scene, TextureProjection};
    use crate::shade::{Filter, Ground, Mode, Wireframe};
    use glam::DVec3;

    /// A recipe in which nothing is at its default.
    pub(in crate::picture) fn sample_recipe(columns: u32, rows: u32) -> Recipe {
        let plane = ImagePlane::new(columns, rows, 0.1 / 3.0).expect("a good plane");
        let pose = Pose {
            eye: DVec3::new(1e-40, -2.5, 1e18 / 3.0),
            target: DVec3::new(-0.0, 1.0 / 3.0, 7.0),
            up: DVec3::X,
        };
        Recipe {
            scene: Scene::default().content(),
            camera: Camera::new(pose, Projection::Orthographic, plane),
            samples: 16,
            pixel_filter: PixelFilter::Mitchell,
            cull: Cull::Back,
            clip: ClippingPlanes::NONE,
            precision: Precision::Fast,
            shading: Shading {
                mode: Mode::Normals,
                wireframe: Some(Wireframe {
                    width: 0.1,
                    color: Color([1, 2, 0xab]),
                    edges: "polygon,feature:12.5".parse().expect("kinds"),
                    hidden: 0.25,
                }),
                background: Background::Transparent,
                blend: 1.0 / 3.0,
                filter: Filter::Nearest,
                projection: TextureProjection::Triplanar,
                scale: Some(ColorScale {
                    map: ColorMap::Turbo,
                    range: Some([-1.5, 1e300]),
                    legend: true,
                }),
                back_faces: Some(Color([4, 5, 6])),
                ground: Some(Ground::At(0.1)),
                ..Shading::default()
            },
        }
    }

    #[test]
    fn text_comes_back_and_is_this() {
        let recipe = sample_recipe(40, 30);
        let text = recipe.to_string();
        assert_eq!(text.parse::<Recipe>().expect("reads"), recipe);
        let scene = Scene::default().content();
        let digest = recipe.digest();
        assert_eq!(
            text,
            format!(
                "raycast-recipe = 1\nscene = \"{scene}\"\nsize = [40, 30]\n\
                 step = 3.333333333333333e-2\nprojection = \"orthographic\"\n\
                 eye = [1e-40, -2.5e0, 3.333333333333333e17]\n\
                 target = [-0e0, 3.333333333333333e-1, 7e0]\nup = [1e0, 0e0, 0e0]\n\
                 samples = 16\ncull = \"back\"\nprecision = \"fast\"\nmode = \"normals\"\n\
                 wireframe = [1e-1, \"#0102ab\", \"polygon,feature:12.5\", 2.5e-1]\nbackground = \"transparent\"\n\
                 blend = 3.3333334e-1\nfilter = \"nearest\"\n\
                 texture-projection = \"triplanar\"\n\
                 color-scale = [\"turbo\", -1.5e0, 1e300, \"legend\"]\n\
                 pixel-filter = \"mitchell\"\nback-faces = \"#040506\"\nground = \"0.1\"\ndigest = \"{digest}\"\n"
            )
        );
        let plain = Recipe {
            shading: Shading::default(),
            pixel_filter: PixelFilter::Box,
            ..recipe
        };
        assert_eq!(plain.to_string().parse::<Recipe>().expect("reads"), plain);
        let lined = Recipe {
            shading: Shading {
                wireframe: Some(Wireframe::default()),
                ..Shading::default()
            },
            ..recipe
        };
        let text = lined.to_string();
        assert!(
            text.contains("\nwireframe = [1e0, \"#10141a\"]\n"),
            "{text}"
        );
        assert_eq!(text.parse::<Recipe>().expect("reads"), lined);
    }

    #[test]
    fn x_ray_tells_its_opacity() {
        let mut recipe = sample_recipe(40, 30);
        recipe.shading.mode = Mode::XRay;
        recipe.shading.x_ray_opacity = 0.5;
        let text = recipe.to_string();
        assert!(text.contains("\nx-ray-opacity = 5e-1\n"), "{text}");
        assert_eq!(text.parse::<Recipe>().expect("reads"), recipe);
    }

    #[test]
    fn lights_and_edges_have_lines_where_they_are_not_the_usual() {
        let recipe = Recipe {
            shading: Shading::studio(),
            ..sample_recipe(40, 30)
        };
        let text = recipe.to_string();
        let lines = "\ncrease = 4e1\nlights = \"three-point\"\nplain-color = \"#c8bfb2\"\n";
        assert!(text.contains(lines), "{text}");
        assert_eq!(text.parse::<Recipe>().expect("reads"), recipe);
        for (line, bad) in [
            ("4e1", "x"),
            ("three-point", "disco"),
            ("#c8bfb2", "#c8bfb"),
        ] {
            assert!(text.replace(line, bad).parse::<Recipe>().is_err(), "{bad}");
        }
    }

    #[test]
    fn clipping_planes_are_written_only_where_there_are_any() {
        let mut recipe = sample_recipe(40, 30);
        let plain = recipe;
        for (normal, offset) in [(DVec3::X, -0.5), (DVec3::new(1.0 / 3.0, 0.0, -2.0), 1e9)] {
            let plane = ClippingPlane::new(normal, offset).expect("a plane");
            recipe.clip.push(plane).expect("room");
        }
        let text = recipe.to_string();
        assert!(
            text.contains("\nclip = [1e0, 0e0, 0e0, -5e-1]\nclip = [3.33"),
            "{text}"
        );
        assert_eq!(text.parse::<Recipe>().expect("reads"), recipe);
        let message = plain.difference(&recipe).expect("they differ");
        assert_eq!(message, "it was made with other clipping planes");
        let zero = text.replace("[1e0, 0e0, 0e0, -5e-1]", "[0e0, 0e0, 0e0, -5e-1]");
        let message = zero.parse::<Recipe>().expect_err("refused").to_string();
        assert!(
            message.contains("line 11: a clipping plane's normal must not be zero"),
            "{message}"
        );
    }

    #[test]
    fn every_change_of_the_text_is_refused() {
        let text = sample_recipe(40, 30).to_string();
        for at in 0..text.len() {
            for with in ["", "0", "1", "x", "\n", " "] {
                let changed = format!("{}{with}{}", &text[..at], &text[at + 1..]);
                if changed != text {
                    assert!(changed.parse::<Recipe>().is_err(), "{changed}");
                }
            }
        }
        let message = |text: &str| text.parse::<Recipe>().expect_err("refused").to_string();
        assert!(message("raycast-recipe = 2\n").contains("version \"2\""));
        assert!(
            message(&text.replace("mode = \"normals\"", "mode = \"pretty\"")).contains(
                "line 12: expected a mode that this program knows, found \"\\\"pretty\\\"\""
            )
        );
        assert!(message(&text.replace("samples = 16", "samples = 17")).contains("changed"));
        assert!(message(&format!("{text}\n")).contains("changed"));
    }

    #[test]
    fn differences_are_named() {
        let recipe = sample_recipe(40, 30);
        assert_eq!(recipe.difference(&recipe), None);
        let mut other = recipe;
        other.shading.mode = Mode::Flat;
        assert_eq!(
            recipe.difference(&other).expect("they differ"),
            "it was made with other settings (mode = \"flat\", not mode = \"normals\")"
        );
        other.camera = sample_recipe(41, 30).camera;
        let message = recipe.difference(&other).expect("they differ");
        assert!(
            message.contains("another camera (size = [41, 30]"),
            "{message}"
        );
        other.scene = Digest::of(b"another");
        let message = recipe.difference(&other).expect("they differ");
        assert_eq!(message, "it was made from another scene");
    }
}
