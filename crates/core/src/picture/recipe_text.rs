//! A recipe's text: a line for each key.

use super::{ImageError, Recipe};
use crate::camera::{BrownConrady, Camera, ImagePlane, PixelFilter, Placement, Projection, Stereo};
use crate::digest::Digest;
use crate::hit::{Cull, Precision};
use crate::ranges;
use crate::scene::{ClippingPlane, ClippingPlanes, Color, ColorMap, ColorScale};
use crate::shade::{
    Background, EdgeKinds, Filter, Ground, LightSet, Mode, Shading, TextureProjection, Wireframe,
};
use glam::DVec3;
use std::fmt::{self, LowerExp};
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
            pixel_filter,
            cull,
            clip,
            precision,
            shading,
        } = self;
        let ImagePlane {
            columns,
            rows,
            step,
        } = camera.plane();
        let Placement { eye, target, up } = camera.placement();
        let Shading {
            mode,
            wireframe,
            background,
            blend,
            filter,
            projection,
            crease,
            lights,
            plain_color,
            scale,
            back_faces,
            x_ray_opacity,
            ground,
        } = shading;
        let usual = Shading::default();
        let lines = match wireframe {
            None => "\"none\"".to_owned(),
            Some(lines) => lines_text(lines),
        };
        let background = match background {
            Background::Transparent => "\"transparent\"".to_owned(),
            Background::Gradient(top, bottom) => format!("[\"{top}\", \"{bottom}\"]"),
        };
        // Recipes without planes keep the text that they had before planes existed.
        let clip: String = (clip.all().iter())
            .map(|ClippingPlane { normal, offset, .. }| {
                let numbers = [normal.x, normal.y, normal.z, *offset].map(|number| float(&number));
                format!("clip = [{}]\n", numbers.join(", "))
            })
            .collect();
        // Optional lines, for what few pictures have.
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
            let distances = [Some(stereo.eye_distance), stereo.convergence];
            let distances = distances.iter().flatten().map(float);
            let kind = format!("\"{}\"", stereo.kind);
            let items: Vec<_> = std::iter::once(kind).chain(distances).collect();
            more += &format!("stereo = [{}]\n", items.join(", "));
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
             wireframe = {lines}\n\
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
    let step = lines.one("step", "a number")?;
    let projection = lines.word("projection", |word| word.parse::<Projection>().ok())?;
    let [eye, target, up] = [
        lines.vector("eye")?,
        lines.vector("target")?,
        lines.vector("up")?,
    ];
    let samples = lines.one("samples", "a whole number")?;
    let cull = lines.word("cull", cull_of)?;
    let clip = lines.clip()?;
    let precision = lines.word("precision", precision_of)?;
    let mode = lines.word("mode", mode_of)?;
    let wireframe = lines.wireframe()?;
    let background = lines.background()?;
    let blend = lines.one("blend", "a number")?;
    let filter = lines.word("filter", filter_of)?;
    let texture_projection = lines.word("texture-projection", texture_projection_of)?;
    let usual = Shading::default();
    let crease = match lines.optional("crease") {
        None => usual.crease,
        Some(value) => value.parse().map_err(|_| lines.wrong("a number", value))?,
    };
    let lights = match lines.optional("lights") {
        None => usual.lights,
        Some(value) => unquoted(value)
            .and_then(lights_of)
            .ok_or_else(|| lines.wrong("lights that this program knows", value))?,
    };
    let plain_color = match lines.optional("plain-color") {
        None => usual.plain_color,
        Some(value) => unquoted(value)
            .and_then(|color| color.parse().ok())
            .ok_or_else(|| lines.wrong("a colour", value))?,
    };
    let scale = lines.scale()?;
    let pixel_filter = lines.pixel_filter()?;
    let shift = match lines.has("shift") {
        true => lines.list("shift", "two numbers")?,
        false => [0.0; 2],
    };
    ranges::shift(shift).map_err(|error| error.to_string())?;
    let projection = match (lines.has("lens"), projection) {
        (false, _) => projection,
        (true, Projection::Perspective) => {
            let lens = BrownConrady::new(lines.list("lens", "five numbers")?);
            Projection::through(lens.map_err(|error| error.to_string())?)
        }
        (true, _) => return Err(format!("a lens, which {projection} does not have")),
    };
    let stereo = lines.stereo()?;
    let back_faces = lines.back_faces()?;
    let ground = lines.ground()?;
    let x_ray_opacity = match lines.has("x-ray-opacity") {
        true => lines.one("x-ray-opacity", "a number")?,
        false => Shading::X_RAY_OPACITY,
    };
    let digest: Digest = lines.quoted("digest")?.parse()?;
    let plane = ImagePlane::new(columns, rows, step).map_err(|error| error.to_string())?;
    if let Some(stereo) = stereo {
        let checked = stereo.check(projection, Some(plane));
        checked.map_err(|error| error.to_string())?;
    }
    let camera = Camera::new(Placement { eye, target, up }, projection, plane);
    let recipe = Recipe {
        scene,
        camera: camera.shifted(shift).in_stereo(stereo),
        samples,
        pixel_filter,
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
            crease,
            lights,
            plain_color,
            scale,
            back_faces,
            x_ray_opacity,
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

    fn quoted(&mut self, key: &str) -> Result<&'t str, String> {
        let value = self.value(key)?;
        unquoted(value).ok_or_else(|| self.wrong("a word in quotes", value))
    }

    fn one<T: FromStr>(&mut self, key: &str, expected: &str) -> Result<T, String> {
        let value = self.value(key)?;
        value.parse().map_err(|_| self.wrong(expected, value))
    }

    fn word<T>(&mut self, key: &str, meaning: fn(&str) -> Option<T>) -> Result<T, String> {
        let value = self.value(key)?;
        unquoted(value)
            .and_then(meaning)
            .ok_or_else(|| self.wrong(&format!("a {key} that this program knows"), value))
    }

    fn list<T: FromStr, const N: usize>(
        &mut self,
        key: &str,
        expected: &str,
    ) -> Result<[T; N], String> {
        let value = self.value(key)?;
        items(value)
            .and_then(|items| {
                let items: Option<Vec<T>> = items.map(|item| item.parse().ok()).collect();
                items?.try_into().ok()
            })
            .ok_or_else(|| self.wrong(expected, value))
    }

    fn vector(&mut self, key: &str) -> Result<DVec3, String> {
        self.list(key, "three numbers").map(DVec3::from_array)
    }

    /// The clipping planes, a line each.
    fn clip(&mut self) -> Result<ClippingPlanes, String> {
        let mut planes = ClippingPlanes::NONE;
        while self
            .lines
            .clone()
            .next()
            .is_some_and(|line| line.starts_with("clip = "))
        {
            let [x, y, z, offset] = self.list("clip", "four numbers")?;
            ClippingPlane::new(DVec3::new(x, y, z), offset)
                .and_then(|plane| planes.push(plane))
                .map_err(|error| format!("line {}: {error}", self.number))?;
        }
        Ok(planes)
    }

    fn wireframe(&mut self) -> Result<Option<Wireframe>, String> {
        let value = self.value("wireframe")?;
        if value == "\"none\"" {
            return Ok(None);
        }
        let read = || {
            let mut items = items(value)?;
            let (width, color) = (items.next()?, unquoted(items.next()?)?);
            let lines = Wireframe {
                width: width.parse().ok()?,
                color: color.parse().ok()?,
                edges: EdgeKinds::ALL,
                hidden: 0.0,
            };
            Some(match (items.next(), items.next()) {
                (Some(edges), Some(hidden)) => Wireframe {
                    edges: unquoted(edges)?.parse().ok()?,
                    hidden: hidden.parse().ok()?,
                    ..lines
                },
                _ => lines,
            })
        };
        read()
            .map(Some)
            .ok_or_else(|| self.wrong("a width, a colour and perhaps edges, or \"none\"", value))
    }

    /// Whether the next line has this key.
    fn has(&self, key: &str) -> bool {
        let next = self.lines.clone().next();
        let rest = next.and_then(|line| line.strip_prefix(key));
        rest.is_some_and(|rest| rest.starts_with(" = "))
    }

    /// The value of the next line, if that has this key.
    fn optional(&mut self, key: &str) -> Option<&'t str> {
        self.has(key).then(|| self.value(key).ok())?
    }

    fn stereo(&mut self) -> Result<Option<Stereo>, String> {
        let Some(value) = self.optional("stereo") else {
            return Ok(None);
        };
        let read = || {
            let mut items = items(value)?;
            Some(Stereo {
                kind: unquoted(items.next()?)?.parse().ok()?,
                eye_distance: items.next()?.parse().ok()?,
                convergence: items.next().map(str::parse).transpose().ok()?,
            })
        };
        let expected = "a kind of picture for two eyes, and one or two distances";
        read().map(Some).ok_or_else(|| self.wrong(expected, value))
    }

    fn back_faces(&mut self) -> Result<Option<Color>, String> {
        let Some(value) = self.optional("back-faces") else {
            return Ok(None);
        };
        let color = unquoted(value).and_then(|word| word.parse().ok());
        color.map(Some).ok_or_else(|| self.wrong("a colour", value))
    }

    fn ground(&mut self) -> Result<Option<Ground>, String> {
        let Some(value) = self.optional("ground") else {
            return Ok(None);
        };
        let ground = unquoted(value).and_then(|word| word.parse().ok());
        (ground.map(Some)).ok_or_else(|| self.wrong("lowest or a height", value))
    }

    fn scale(&mut self) -> Result<Option<ColorScale>, String> {
        let Some(value) = self.optional("color-scale") else {
            return Ok(None);
        };
        let read = || {
            let mut items = items(value)?.peekable();
            let map = color_map_of(unquoted(items.next()?)?)?;
            let range = match items.next()? {
                "\"fitted\"" => None,
                low => Some([low.parse().ok()?, items.next()?.parse().ok()?]),
            };
            let legend = items.next().is_some();
            Some(ColorScale { map, range, legend })
        };
        read().map(Some).ok_or_else(|| {
            self.wrong(
                "a color map, \"fitted\" or two numbers, and perhaps \"legend\"",
                value,
            )
        })
    }

    fn pixel_filter(&mut self) -> Result<PixelFilter, String> {
        match self.optional("pixel-filter") {
            None => Ok(PixelFilter::default()),
            Some(value) => unquoted(value)
                .and_then(|word| word.parse().ok())
                .ok_or_else(|| self.wrong("a pixel filter that this program knows", value)),
        }
    }

    fn background(&mut self) -> Result<Background, String> {
        let value = self.value("background")?;
        if value == "\"transparent\"" {
            return Ok(Background::Transparent);
        }
        let read = || {
            let mut colors = items(value)?.map(|item| unquoted(item)?.parse::<Color>().ok());
            Some(Background::Gradient(colors.next()??, colors.next()??))
        };
        read().ok_or_else(|| self.wrong("two colours, or \"transparent\"", value))
    }
}

/// The types of edges and the strength of hidden lines, where they are not the defaults.
fn lines_text(lines: &Wireframe) -> String {
    let Wireframe {
        width,
        color,
        edges,
        hidden,
    } = lines;
    let more = match (*edges, *hidden) {
        (EdgeKinds::ALL, 0.0) => String::new(),
        _ => format!(", \"{edges}\", {}", float(hidden)),
    };
    format!("[{}, \"{color}\"{more}]", float(width))
}

fn scale_text(ColorScale { map, range, legend }: &ColorScale) -> String {
    let range = match range {
        None => "\"fitted\"".to_owned(),
        Some([low, high]) => format!("{}, {}", float(low), float(high)),
    };
    let legend = if *legend { ", \"legend\"" } else { "" };
    format!("[\"{}\", {range}{legend}]", color_map_word(*map))
}

/// The text between quotes.
fn unquoted(value: &str) -> Option<&str> {
    value.strip_prefix('"')?.strip_suffix('"')
}

/// The items between brackets.
fn items(value: &str) -> Option<std::str::Split<'_, &'static str>> {
    Some(value.strip_prefix('[')?.strip_suffix(']')?.split(", "))
}

/// The fewest digits that read back as the same number.
fn float(number: &impl LowerExp) -> String {
    format!("{number:e}")
}

fn vector(vector: DVec3) -> String {
    let [x, y, z] = vector.to_array().map(|number| float(&number));
    format!("[{x}, {y}, {z}]")
}

/// The word for each of an enum's variants, and back. A variant without a word does not compile.
macro_rules! words {
    ($word:ident, $of:ident: $kind:ident { $($variant:ident = $text:literal),+ $(,)? }) => {
        fn $word(value: $kind) -> &'static str {
            match value { $($kind::$variant => $text),+ }
        }

        fn $of(word: &str) -> Option<$kind> {
            match word { $($text => Some($kind::$variant),)+ _ => None }
        }
    };
}

words!(color_map_word, color_map_of: ColorMap {
    Viridis = "viridis",
    Magma = "magma",
    Turbo = "turbo",
    Cividis = "cividis",
    Diverging = "diverging",
});
words!(cull_word, cull_of: Cull { None = "none", Back = "back" });
words!(precision_word, precision_of: Precision { Fast = "fast", Exact = "exact" });
words!(mode_word, mode_of: Mode {
    Color = "color",
    Flat = "flat",
    Smooth = "smooth",
    Material = "material",
    Normals = "normals",
    Depth = "depth",
    Barycentric = "barycentric",
    Uv = "uv",
    Texture = "texture",
    Wireframe = "wireframe",
    XRay = "x-ray",
});
words!(lights_word, lights_of: LightSet {
    Soft = "soft",
    Headlight = "headlight",
    ThreePoint = "three-point",
});
words!(filter_word, filter_of: Filter {
    Nearest = "nearest",
    Bilinear = "bilinear",
    Trilinear = "trilinear",
    Ewa = "ewa",
});
words!(texture_projection_word, texture_projection_of: TextureProjection {
    Uv = "uv",
    Triplanar = "triplanar",
    PerTriangle = "per-triangle",
    Plane = "plane",
    Sphere = "sphere",
    Cylinder = "cylinder",
    Camera = "camera",
});
