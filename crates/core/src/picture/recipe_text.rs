//! A recipe's text: a line for each key.

use super::recipe_values::{
    BACKGROUND, SCALE, STEREO, WIREFRAME, background_text, cull_word, filter_word, float,
    lights_word, mode_word, parse_background, parse_color, parse_cull, parse_filter, parse_lights,
    parse_list, parse_mode, parse_precision, parse_scale, parse_stereo, parse_texture_projection,
    parse_wireframe, precision_word, scale_text, stereo_text, texture_projection_word, unquoted,
    vector, wireframe_text,
};
use super::{ImageError, Recipe};
use crate::camera::{BrownConrady, Camera, ImagePlane, PixelFilter, Pose, Projection};
use crate::digest::Digest;
use crate::ranges;
use crate::scene::{ClippingPlane, ClippingPlanes};
use crate::shade::{Mode, Shading};
use glam::DVec3;
use std::fmt;
use std::str::FromStr;

/// The version of the text. A reader refuses others.
const VERSION: &str = "1";

impl Recipe {
    /// All lines except the checksum.
    pub(super) fn lines(&self) -> String {
        let Self {
            scene,
            camera,
            samples,
            cull,
            clip,
            precision,
            shading,
            ..
        } = self;
        let ImagePlane {
            columns,
            rows,
            step,
        } = camera.plane();
        let Pose { eye, target, up } = camera.pose();
        let Shading {
            mode,
            wireframe,
            background,
            blend,
            filter,
            projection,
            ..
        } = shading;
        let wireframe = wireframe_text(wireframe.as_ref());
        let background = background_text(background);
        // Recipes without planes keep the text that they had before planes existed.
        let clip: String = (clip.all().iter())
            .map(|ClippingPlane { normal, offset, .. }| {
                let numbers = [normal.x, normal.y, normal.z, *offset].map(|number| float(&number));
                format!("clip = [{}]\n", numbers.join(", "))
            })
            .collect();
        let more = self.optional_lines();
        format!(
            "raycast-recipe = {VERSION}\n\
             scene = \"{scene}\"\n\
             size = [{columns}, {rows}]\n\
             step = {}\n\
             projection = \"{}\"\n\
             eye = {}\n\
             target = {}\n\
             up = {}\n\
             samples = {samples}\n\
             cull = \"{}\"\n\
             {clip}\
             precision = \"{}\"\n\
             mode = \"{}\"\n\
             wireframe = {wireframe}\n\
             background = {background}\n\
             blend = {}\n\
             filter = \"{}\"\n\
             texture-projection = \"{}\"\n{more}",
            float(&step),
            camera.projection(),
            vector(eye),
            vector(target),
            vector(up),
            cull_word(*cull),
            precision_word(*precision),
            mode_word(*mode),
            float(blend),
            filter_word(*filter),
            texture_projection_word(*projection),
        )
    }

    /// Lines of what few pictures have; each is left out where it says the usual.
    fn optional_lines(&self) -> String {
        let Self {
            camera,
            pixel_filter,
            shading:
                Shading {
                    mode,
                    crease,
                    lights,
                    plain_color,
                    scale,
                    back_faces,
                    x_ray_opacity,
                    ground,
                    ..
                },
            ..
        } = self;
        let usual = Shading::default();
        let mut more = String::new();
        if *crease != usual.crease {
            more += &format!("crease = {}\n", float(crease));
        }
        if *lights != usual.lights {
            more += &format!("lights = \"{}\"\n", lights_word(*lights));
        }
        if *plain_color != usual.plain_color {
            more += &format!("plain-color = \"{plain_color}\"\n");
        }
        if let Some(scale) = scale {
            more += &format!("color-scale = {}\n", scale_text(scale));
        }
        if *pixel_filter != PixelFilter::default() {
            more += &format!("pixel-filter = \"{pixel_filter}\"\n");
        }
        if camera.shift() != [0.0; 2] {
            let [right, up] = camera.shift().map(|number| float(&number));
            more += &format!("shift = [{right}, {up}]\n");
        }
        if let Some(lens) = camera.projection().lens() {
            let numbers = lens.coefficients().map(|number| float(&number));
            more += &format!("lens = [{}]\n", numbers.join(", "));
        }
        if let Some(stereo) = camera.stereo() {
            more += &format!("stereo = {}\n", stereo_text(&stereo));
        }
        if let Some(color) = back_faces {
            more += &format!("back-faces = \"{color}\"\n");
        }
        if let Some(ground) = ground {
            more += &format!("ground = \"{ground}\"\n");
        }
        if *mode == Mode::XRay {
            more += &format!("x-ray-opacity = {}\n", float(x_ray_opacity));
        }
        more
    }
}

impl fmt::Display for Recipe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines = self.lines();
        let digest = Digest::of(lines.as_bytes());
        writeln!(f, "{lines}digest = \"{digest}\"")
    }
}

impl FromStr for Recipe {
    type Err = ImageError;

    fn from_str(text: &str) -> Result<Self, ImageError> {
        read(text).map_err(|reason| ImageError::Decode(format!("its recipe: {reason}")))
    }
}

fn read(text: &str) -> Result<Recipe, String> {
    let mut lines = Lines::new(text);
    let version = lines.value("raycast-recipe")?;
    if version != VERSION {
        return Err(format!(
            "it is of version {}, and this program knows version {VERSION}",
            crate::quote::quote(version)
        ));
    }
    let scene = lines.quoted("scene")?.parse()?;
    let [columns, rows] = lines.list("size", "two whole numbers")?;
    let step = lines.number("step", "a number")?;
    let projection = lines.word("projection", |word| word.parse::<Projection>().ok())?;
    let [eye, target, up] = [
        lines.vector("eye")?,
        lines.vector("target")?,
        lines.vector("up")?,
    ];
    let samples = lines.number("samples", "a whole number")?;
    let cull = lines.word("cull", parse_cull)?;
    let clip = lines.clip()?;
    let precision = lines.word("precision", parse_precision)?;
    let mode = lines.word("mode", parse_mode)?;
    let wireframe = lines.one("wireframe", WIREFRAME, parse_wireframe)?;
    let background = lines.one("background", BACKGROUND, parse_background)?;
    let blend = lines.number("blend", "a number")?;
    let filter = lines.word("filter", parse_filter)?;
    let texture_projection = lines.word("texture-projection", parse_texture_projection)?;
    let usual = Shading::default();
    let number = |value: &str| value.parse().ok();
    let crease = lines.optional("crease", "a number", number)?;
    let lights = "lights that this program knows";
    let lights = lines.optional("lights", lights, |value| parse_lights(unquoted(value)?))?;
    let plain_color = lines.optional("plain-color", "a colour", parse_color)?;
    let scale = lines.optional("color-scale", SCALE, parse_scale)?;
    let pixel_filter = "a pixel filter that this program knows";
    let pixel_filter = lines.optional("pixel-filter", pixel_filter, |value| {
        unquoted(value)?.parse().ok()
    })?;
    let shift = lines.optional("shift", "two numbers", parse_list)?;
    let shift = ranges::shift(shift.unwrap_or([0.0; 2])).map_err(|error| error.to_string())?;
    let projection = match (lines.has("lens"), projection) {
        (false, _) => projection,
        (true, Projection::Perspective) => {
            let lens = BrownConrady::new(lines.list("lens", "five numbers")?);
            Projection::through(lens.map_err(|error| error.to_string())?)
        }
        (true, _) => return Err(format!("a lens, which {projection} does not have")),
    };
    let stereo = lines.optional("stereo", STEREO, parse_stereo)?;
    let back_faces = lines.optional("back-faces", "a colour", parse_color)?;
    let ground = lines.optional("ground", "lowest or a height", |value| {
        unquoted(value)?.parse().ok()
    })?;
    let x_ray_opacity = lines.optional("x-ray-opacity", "a number", number)?;
    let digest: Digest = lines.quoted("digest")?.parse()?;
    let plane = ImagePlane::new(columns, rows, step).map_err(|error| error.to_string())?;
    if let Some(stereo) = stereo {
        let checked = stereo.check(projection, Some(plane));
        checked.map_err(|error| error.to_string())?;
    }
    let camera = Camera::new(Pose { eye, target, up }, projection, plane);
    let recipe = Recipe {
        scene,
        camera: camera.shifted(shift).in_stereo(stereo),
        samples,
        pixel_filter: pixel_filter.unwrap_or_default(),
        cull,
        clip,
        precision,
        shading: Shading {
            mode,
            wireframe,
            background,
            blend,
            filter,
            projection: texture_projection,
            crease: crease.unwrap_or(usual.crease),
            lights: lights.unwrap_or(usual.lights),
            plain_color: plain_color.unwrap_or(usual.plain_color),
            scale,
            back_faces,
            x_ray_opacity: x_ray_opacity.unwrap_or(Shading::X_RAY_OPACITY),
            ground,
        },
    };
    // The recipe that was read must give the same text again: otherwise a line was damaged.
    if digest != recipe.digest() || recipe.to_string() != text {
        return Err("it was changed since it was written: its digest is another".to_owned());
    }
    Ok(recipe)
}

/// The lines of a recipe, in order.
struct Lines<'t> {
    number: usize,
    lines: std::str::Lines<'t>,
}

impl<'t> Lines<'t> {
    fn new(text: &'t str) -> Self {
        Self {
            number: 0,
            lines: text.lines(),
        }
    }

    fn wrong(&self, expected: &str, found: &str) -> String {
        format!("line {}: expected {expected}, found {found:?}", self.number)
    }

    /// The value of the next line, which must have this key.
    fn value(&mut self, key: &str) -> Result<&'t str, String> {
        self.number += 1;
        let line = self.lines.next().unwrap_or_default();
        line.strip_prefix(key)
            .and_then(|rest| rest.strip_prefix(" = "))
            .ok_or_else(|| self.wrong(&format!("`{key} = `"), line))
    }

    /// The value of the next line, which must have this key, as `of` reads it.
    fn one<T>(
        &mut self,
        key: &str,
        expected: &str,
        of: impl FnOnce(&'t str) -> Option<T>,
    ) -> Result<T, String> {
        let value = self.value(key)?;
        of(value).ok_or_else(|| self.wrong(expected, value))
    }

    /// As [`Lines::one`]; `None` where the next line has another key.
    fn optional<T>(
        &mut self,
        key: &str,
        expected: &str,
        of: impl FnOnce(&'t str) -> Option<T>,
    ) -> Result<Option<T>, String> {
        match self.has(key) {
            true => self.one(key, expected, of).map(Some),
            false => Ok(None),
        }
    }

    /// Whether the next line has this key.
    fn has(&self, key: &str) -> bool {
        let next = self.lines.clone().next();
        let rest = next.and_then(|line| line.strip_prefix(key));
        rest.is_some_and(|rest| rest.starts_with(" = "))
    }

    fn quoted(&mut self, key: &str) -> Result<&'t str, String> {
        self.one(key, "a word in quotes", unquoted)
    }

    fn number<T: FromStr>(&mut self, key: &str, expected: &str) -> Result<T, String> {
        self.one(key, expected, |value| value.parse().ok())
    }

    fn word<T>(&mut self, key: &str, meaning: fn(&str) -> Option<T>) -> Result<T, String> {
        let expected = format!("a {key} that this program knows");
        self.one(key, &expected, |value| meaning(unquoted(value)?))
    }

    fn list<T: FromStr, const N: usize>(
        &mut self,
        key: &str,
        expected: &str,
    ) -> Result<[T; N], String> {
        self.one(key, expected, parse_list)
    }

    fn vector(&mut self, key: &str) -> Result<DVec3, String> {
        self.list(key, "three numbers").map(DVec3::from_array)
    }

    /// The clipping planes, a line each.
    fn clip(&mut self) -> Result<ClippingPlanes, String> {
        let mut planes = ClippingPlanes::NONE;
        while self.has("clip") {
            let [x, y, z, offset] = self.list("clip", "four numbers")?;
            ClippingPlane::new(DVec3::new(x, y, z), offset)
                .and_then(|plane| planes.push(plane))
                .map_err(|error| format!("line {}: {error}", self.number))?;
        }
        Ok(planes)
    }
}
