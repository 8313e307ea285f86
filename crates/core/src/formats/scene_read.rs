use super::error::{FormatError, quote};
use super::files::{Files, beside};
use super::kind::without_mark;
use super::mesh_file;
use super::scene_file::{CameraFile, ImageFile, SceneFile};
use super::scene_toml::{
    BackgroundToml, CameraToml, ImageToml, ObjectToml, SceneToml, ShadingToml,
};
use super::{Progress, texture};
use crate::camera::{ImagePlane, Placement, Projection};
use crate::scene::{Mesh, Object, Scene, Texture, Transform};
use crate::shade::{Background, Shading, Wireframe};
use glam::DVec3;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::Spanned;

/// The vertical field of view, in degrees, of a perspective camera that names none.
const DEFAULT_FOV: f64 = 45.0;

/// The most rays a pixel.
const SAMPLE_LIMIT: u32 = 65_536;

/// Reads a scene file's text, and through `files` what it names.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    files: &dyn Files,
    progress: Progress<'_>,
) -> Result<SceneFile, FormatError> {
    let bytes = without_mark(bytes);
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = line_at(bytes, error.valid_up_to());
        FormatError::unexpected(path, Some(line), "UTF-8 text", "other bytes")
    })?;
    let reader = Reader { path, text, files };
    let parsed: SceneToml = toml::from_str(text).map_err(|error| {
        let line = error.span().map(|span| line_at(bytes, span.start));
        FormatError::refused(path, line, error.message())
    })?;
    let mut warnings = Vec::new();
    let camera = parsed.camera.map(|camera| reader.camera(&camera));
    let image = reader.image(&parsed.image)?;
    let shading = reader.shading(parsed.shading.as_ref(), &parsed.image)?;
    let objects = reader.objects(&parsed.objects, progress, &mut warnings)?;
    Ok(SceneFile {
        scene: Scene { objects },
        camera: camera.transpose()?,
        image,
        shading,
        warnings,
    })
}

/// The line, from 1, that holds the byte at `offset`.
fn line_at(bytes: &[u8], offset: usize) -> usize {
    let before = &bytes[..offset.min(bytes.len())];
    1 + before.iter().filter(|&&b| b == b'\n').count()
}

/// What objects share: a file is read once.
type Shared<T> = HashMap<PathBuf, T>;

struct Reader<'a> {
    path: &'a Path,
    text: &'a str,
    files: &'a dyn Files,
}

impl Reader<'_> {
    fn line<T>(&self, value: &Spanned<T>) -> Option<usize> {
        Some(line_at(self.text.as_bytes(), value.span().start))
    }

    fn fault<T>(&self, value: &Spanned<T>, expected: &str, found: &str) -> FormatError {
        FormatError::unexpected(self.path, self.line(value), expected, found)
    }

    /// Three finite numbers.
    fn vector(&self, value: &Spanned<[f64; 3]>) -> Result<DVec3, FormatError> {
        let vector = DVec3::from_array(*value.get_ref());
        if vector.is_finite() {
            Ok(vector)
        } else {
            Err(self.fault(value, "finite numbers", &format!("{:?}", value.get_ref())))
        }
    }

    fn camera(&self, camera: &Spanned<CameraToml>) -> Result<CameraFile, FormatError> {
        let line = self.line(camera);
        let camera = camera.get_ref();
        let projection = camera.projection.into();
        let misplaced = |value: &Spanned<f64>, key, other| {
            let found = format!("`{key}`, which is for {other} cameras");
            self.fault(value, "another key", &found)
        };
        let frame = match (projection, &camera.fov, &camera.frame) {
            (Projection::Perspective, _, Some(frame)) => {
                return Err(misplaced(frame, "frame", "orthographic"));
            }
            (Projection::Orthographic, Some(fov), _) => {
                return Err(misplaced(fov, "fov", "perspective"));
            }
            (Projection::Perspective, None, None) => DEFAULT_FOV,
            (Projection::Perspective, Some(fov), None) => {
                let degrees = *fov.get_ref();
                if !(degrees > 0.0 && degrees < 180.0) {
                    let expected = "a field of view above 0 and below 180 degrees";
                    return Err(self.fault(fov, expected, &degrees.to_string()));
                }
                degrees
            }
            (Projection::Orthographic, None, Some(frame)) => {
                let height = *frame.get_ref();
                if !(height > 0.0 && height.is_finite()) {
                    let expected = "a frame's height above 0";
                    return Err(self.fault(frame, expected, &height.to_string()));
                }
                height
            }
            (Projection::Orthographic, None, None) => {
                let expected = "`frame`, the height of an orthographic camera's frame";
                return Err(FormatError::unexpected(self.path, line, expected, "none"));
            }
        };
        let placement = Placement {
            eye: self.vector(&camera.eye)?,
            target: self.vector(&camera.target)?,
            up: camera
                .up
                .as_ref()
                .map_or(Ok(DVec3::Y), |up| self.vector(up))?,
        };
        if placement.eye == placement.target {
            return Err(self.fault(
                &camera.target,
                "a target away from the eye",
                "the eye itself",
            ));
        }
        Ok(CameraFile {
            placement,
            projection,
            frame,
        })
    }

    fn image(&self, image: &ImageToml) -> Result<ImageFile, FormatError> {
        let size = image.size.as_ref().map(|size| {
            let [columns, rows] = *size.get_ref();
            ImagePlane::new(columns, rows, 1.0)
                .map(|_| (columns, rows))
                .map_err(|error| {
                    FormatError::refused(self.path, self.line(size), &error.to_string())
                })
        });
        let samples = image.samples.as_ref().map(|samples| {
            let count = *samples.get_ref();
            if (1..=SAMPLE_LIMIT).contains(&count) {
                Ok(count)
            } else {
                let expected = format!("1 to {SAMPLE_LIMIT} samples");
                Err(self.fault(samples, &expected, &count.to_string()))
            }
        });
        Ok(ImageFile {
            size: size.transpose()?,
            samples: samples.transpose()?,
        })
    }

    /// `[shading]` and the background; `None` where the file has neither.
    fn shading(
        &self,
        shading: Option<&ShadingToml>,
        image: &ImageToml,
    ) -> Result<Option<Shading>, FormatError> {
        if shading.is_none() && image.background.is_none() {
            return Ok(None);
        }
        let defaults = Shading::default();
        let empty = ShadingToml::default();
        let file = shading.unwrap_or(&empty);
        let ranged = |value: &Option<Spanned<f32>>, default, most: f32, expected: &str| match value
        {
            None => Ok(default),
            Some(value) if (0.0..=most).contains(value.get_ref()) => Ok(*value.get_ref()),
            Some(value) => Err(self.fault(value, expected, &value.get_ref().to_string())),
        };
        let lines = Wireframe::default();
        let lines = Wireframe {
            width: ranged(
                &file.wireframe_width,
                lines.width,
                1000.0,
                "a width from 0 to 1000 pixels",
            )?,
            color: file.wireframe_color.map_or(lines.color, |color| color.0),
        };
        Ok(Some(Shading {
            mode: file.mode.map_or(defaults.mode, Into::into),
            wireframe: file.wireframe.unwrap_or(false).then_some(lines),
            background: match image.background.as_ref().map(Spanned::get_ref) {
                None => defaults.background,
                Some(BackgroundToml::Word(_)) => Background::Transparent,
                Some(BackgroundToml::Gradient([top, bottom])) => {
                    Background::Gradient(top.0, bottom.0)
                }
            },
            blend: ranged(&file.blend, defaults.blend, 1.0, "a blend from 0 to 1")?,
            filter: file.filter.map_or(defaults.filter, Into::into),
            projection: file
                .texture_projection
                .map_or(defaults.projection, Into::into),
        }))
    }

    fn objects(
        &self,
        tables: &[Spanned<ObjectToml>],
        progress: Progress<'_>,
        warnings: &mut Vec<String>,
    ) -> Result<Vec<Object>, FormatError> {
        // Parents first: they cost nothing, and a fault in them is known before anything is read.
        let parents = self.parents(tables)?;
        let mut meshes: Shared<Arc<Mesh>> = HashMap::new();
        let mut textures: Shared<Arc<Texture>> = HashMap::new();
        let mut objects = Vec::with_capacity(tables.len());
        let share = 1.0 / tables.len().max(1) as f32;
        for (index, (table, parent)) in tables.iter().zip(parents).enumerate() {
            let table = table.get_ref();
            let step = |part: f32| progress((index as f32 + part) * share);
            let mesh_path = beside(self.path, table.mesh.get_ref());
            let mesh = match meshes.get(&mesh_path) {
                Some(mesh) => Arc::clone(mesh),
                None => {
                    let bytes = self.bytes(&table.mesh, &mesh_path, &|part| step(part * 0.5))?;
                    let read = mesh_file::read(&mesh_path, &bytes, self.files, &|part| {
                        step(0.5 + part * 0.5);
                    })?;
                    warnings.extend(read.warnings);
                    let mesh = Arc::new(read.mesh);
                    meshes.insert(mesh_path.clone(), Arc::clone(&mesh));
                    mesh
                }
            };
            let name = match &table.name {
                Some(name) => name.clone(),
                None => mesh_file::name(&mesh_path),
            };
            let mut object = Object::new(name, mesh);
            object.source = Some(self.files.source(&mesh_path));
            object.parent = parent;
            if let Some(color) = table.color {
                object.color = color.rule(table.seed);
            }
            if let Some(named) = &table.texture {
                let path = beside(self.path, named.get_ref());
                let texture = match textures.get(&path) {
                    Some(texture) => Arc::clone(texture),
                    None => {
                        let bytes = self.bytes(named, &path, &|_| ())?;
                        let texture = Arc::new(texture::decode(&path, &bytes)?);
                        textures.insert(path.clone(), Arc::clone(&texture));
                        texture
                    }
                };
                object.texture = Some(texture);
                object.texture_source = Some(self.files.source(&path));
            }
            let place = |value: &Option<Spanned<[f64; 3]>>, default| match value {
                Some(value) => self.vector(value),
                None => Ok(default),
            };
            object.transform = Transform {
                translate: place(&table.translate, DVec3::ZERO)?,
                rotate: place(&table.rotate, DVec3::ZERO)?,
                scale: place(&table.scale, DVec3::ONE)?,
            };
            objects.push(object);
        }
        progress(1.0);
        Ok(objects)
    }

    /// The bytes of a file that the scene names.
    fn bytes(
        &self,
        named: &Spanned<String>,
        path: &Path,
        progress: Progress<'_>,
    ) -> Result<Vec<u8>, FormatError> {
        self.files.read(path, progress).map_err(|error| {
            let reason = format!("{} cannot be read: {error}", path.display());
            FormatError::refused(self.path, self.line(named), &reason)
        })
    }

    /// Each object's parent, by index: one that exists, has its name alone, and is no descendant.
    fn parents(&self, tables: &[Spanned<ObjectToml>]) -> Result<Vec<Option<usize>>, FormatError> {
        let mut named: HashMap<&str, Vec<usize>> = HashMap::new();
        for (index, table) in tables.iter().enumerate() {
            if let Some(name) = &table.get_ref().name {
                named.entry(name).or_default().push(index);
            }
        }
        let parent_of = |table: &Spanned<ObjectToml>| {
            let Some(parent) = &table.get_ref().parent else {
                return Ok(None);
            };
            match named.get(parent.get_ref().as_str()).map(Vec::as_slice) {
                Some(&[index]) => Ok(Some(index)),
                None | Some([]) => {
                    let found = quote(parent.get_ref());
                    Err(self.fault(parent, "the name of an object as parent", &found))
                }
                Some(several) => {
                    let found = format!("{} of {} objects", quote(parent.get_ref()), several.len());
                    Err(self.fault(parent, "the name of one object as parent", &found))
                }
            }
        };
        let parents: Vec<Option<usize>> = tables.iter().map(parent_of).collect::<Result<_, _>>()?;
        for start in 0..tables.len() {
            // After so many steps up, whoever is left is on a cycle.
            let mut ancestor = Some(start);
            for _ in 0..tables.len() {
                ancestor = ancestor.and_then(|next| parents[next]);
            }
            if let Some(parent) = ancestor.and_then(|index| tables[index].get_ref().parent.as_ref())
            {
                let found = format!("{}, its own descendant", quote(parent.get_ref()));
                return Err(self.fault(parent, "a parent that is no descendant", &found));
            }
        }
        Ok(parents)
    }
}
