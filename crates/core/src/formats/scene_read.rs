use super::error::{FormatError, shorten};
use super::files::{By, Contents, Files, beside};
use super::guard::guarded;
use super::kind::without_mark;
use super::mesh_file::{self, MeshObject};
use super::scene_file::{CameraFile, FileKind, ImageFile, SceneFile};
use super::scene_toml::{
    AnimationToml, BackgroundToml, CameraToml, ImageToml, ObjectToml, SceneToml, ShadingToml,
    ShapeToml,
};
use super::{Progress, texture};
use crate::camera::{CameraPath, ImagePlane, Keyframe, Placement, PlacementError, Projection};
use crate::quote::{self, quote};
use crate::ranges::{self, OutOfRange};
use crate::scene::{
    Bounds, COORDINATE_LIMIT, Object, Scene, Shape, ShapeError, Texture, Transform, UpAxis,
};
use crate::shade::{Background, Shading, Wireframe};
use glam::{DAffine3, DMat3, DVec3};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::Spanned;

/// The vertical field of view, in degrees, of a perspective camera that names none.
const DEFAULT_FOV: f64 = 45.0;

/// The most ancestors of an object: each is looked at for each object below it.
const ANCESTOR_LIMIT: usize = 1000;

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
    let parsed: SceneToml = guarded(path, || toml::from_str(text))?.map_err(|error| {
        let line = error.span().map(|span| line_at(bytes, span.start));
        FormatError::refused(path, line, &shorten(error.message()))
    })?;
    let (mut warnings, mut notes) = (Vec::new(), Vec::new());
    let camera = parsed
        .camera
        .map(|camera| reader.camera(&camera))
        .transpose()?;
    let projection = camera.map(|camera| camera.projection);
    let animation = parsed
        .animation
        .map(|animation| reader.animation(&animation, projection));
    let image = reader.image(&parsed.image)?;
    let shading = reader.shading(parsed.shading.as_ref(), &parsed.image)?;
    let objects = reader.objects(&parsed.objects, progress, &mut warnings, &mut notes)?;
    let scene = Scene { objects };
    let mut unseen = unseen(path, &scene);
    mesh_file::limit_warnings(path, &mut unseen);
    warnings.append(&mut unseen);
    mesh_file::limit_warnings(path, &mut warnings);
    Ok(SceneFile {
        kind: FileKind::Scene,
        scene,
        camera,
        animation: animation.transpose()?,
        image,
        shading,
        warnings,
        notes,
        opened: files.opened(),
    })
}

/// A warning for each object of which its place leaves nothing to see, and for a scene without any.
fn unseen(path: &Path, scene: &Scene) -> Vec<String> {
    let path = quote::path(path);
    if scene.objects.is_empty() {
        return vec![format!(
            "{path}: the scene has no objects: there is nothing to see"
        )];
    }
    let Ok(transforms) = scene.world_from_objects() else {
        return Vec::new();
    };
    let told = scene.objects.iter().zip(transforms);
    let told = told.filter_map(|(object, world_from_object)| {
        let count = object.mesh.kept().len();
        if count == 0 {
            return None;
        }
        let bounds = object.mesh.bounds();
        let corners = bounds
            .corners()
            .map(|corner| world_from_object.transform_point3(corner));
        let placed = Bounds::around(corners);
        // Of a box beyond the limit along an axis, or one that is a line, nothing can be met.
        let nearest = DVec3::ZERO.clamp(placed.min, placed.max);
        let is_far = nearest.abs().max_element() > COORDINATE_LIMIT;
        let [x, y, z] = world_from_object
            .matrix3
            .to_cols_array_2d()
            .map(DVec3::from_array);
        let is_line = [x.cross(y), y.cross(z), z.cross(x)] == [DVec3::ZERO; 3];
        let why = match (is_far, is_line) {
            (true, _) => format!("it lies further than {COORDINATE_LIMIT:e} from zero"),
            (_, true) => "it is scaled to nothing".to_owned(),
            _ => return None,
        };
        let name = quote(&object.name);
        Some(format!(
            "{path}: none of the {count} triangles of object {name} is seen: {why}"
        ))
    });
    told.collect()
}

/// The line, from 1, that holds the byte at `offset`.
fn line_at(bytes: &[u8], offset: usize) -> usize {
    let before = &bytes[..offset.min(bytes.len())];
    1 + before.iter().filter(|&&b| b == b'\n').count()
}

/// What objects share: a file is read once.
type Shared<T> = HashMap<PathBuf, T>;

/// A transform of all that a file places, for an object that the file places by a map of its own.
fn within(transform: &Transform, world_from_object: DAffine3) -> Transform {
    let matrix = if transform.matrix == DAffine3::IDENTITY {
        world_from_object
    } else if world_from_object == DAffine3::IDENTITY {
        transform.matrix
    } else {
        transform.matrix * world_from_object
    };
    Transform {
        matrix,
        ..*transform
    }
}

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

    /// A number that was held against its range.
    fn in_range<T, N>(
        &self,
        place: &Spanned<T>,
        number: Result<N, OutOfRange>,
    ) -> Result<N, FormatError> {
        number
            .map_err(|error| FormatError::refused(self.path, self.line(place), &error.to_string()))
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

    /// Keyframes, each a camera with the projection of the scene's.
    fn animation(
        &self,
        animation: &Spanned<AnimationToml>,
        projection: Option<Projection>,
    ) -> Result<CameraPath, FormatError> {
        let AnimationToml { curve, ease, key } = animation.get_ref();
        let mut keys: Vec<Keyframe> = Vec::with_capacity(key.len());
        for spanned in key {
            let key = spanned.get_ref();
            if let Some(last) = keys.last()
                && key.at <= last.frame
            {
                let expected = format!("a keyframe after {}", last.frame);
                return Err(self.fault(spanned, &expected, &key.at.to_string()));
            }
            let projection = projection.unwrap_or_default();
            let is_orthographic = projection == Projection::Orthographic;
            // Without a view of its own a keyframe has the camera's: any will do to be checked.
            let any = || Spanned::new(spanned.span(), 1.0);
            let frame = key.frame.clone().or_else(|| is_orthographic.then(any));
            let camera = CameraToml {
                projection: projection.into(),
                eye: key.eye.clone(),
                target: key.target.clone(),
                up: key.up.clone(),
                fov: key.fov.clone(),
                frame,
            };
            let camera = self.camera(&Spanned::new(spanned.span(), camera))?;
            keys.push(Keyframe {
                frame: key.at,
                placement: camera.placement,
                view: (key.fov.is_some() || key.frame.is_some()).then_some(camera.frame),
            });
        }
        CameraPath::new(keys, (*curve).into(), (*ease).into())
            .ok_or_else(|| self.fault(animation, "a keyframe ([[animation.key]])", "none"))
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
                self.in_range(fov, ranges::fov(*fov.get_ref()))?
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
        let (eye, target) = (self.vector(&camera.eye)?, self.vector(&camera.target)?);
        let placement = match &camera.up {
            Some(up) => Placement {
                eye,
                target,
                up: self.vector(up)?,
            },
            None => Placement::towards(eye, target),
        };
        if let Err(error) = placement.check() {
            let line = match (error, &camera.up) {
                (PlacementError::NoUp { .. } | PlacementError::UpAlongView { .. }, Some(up)) => {
                    self.line(up)
                }
                _ => self.line(&camera.target),
            };
            return Err(FormatError::refused(self.path, line, &error.to_string()));
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
        let samples = image
            .samples
            .as_ref()
            .map(|samples| self.in_range(samples, ranges::samples(*samples.get_ref())));
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
        let lines = Wireframe::default();
        let lines = Wireframe {
            width: match &file.wireframe_width {
                Some(width) => self.in_range(width, ranges::line_width(*width.get_ref()))?,
                None => lines.width,
            },
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
            blend: match &file.blend {
                Some(blend) => self.in_range(blend, ranges::blend(*blend.get_ref()))?,
                None => defaults.blend,
            },
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
        notes: &mut Vec<String>,
    ) -> Result<Vec<Object>, FormatError> {
        // Parents first: they cost nothing, and a fault in them is known before anything is read.
        let parents = self.parents(tables)?;
        let mut meshes: HashMap<(PathBuf, UpAxis), Vec<MeshObject>> = HashMap::new();
        let mut textures: Shared<Arc<Texture>> = HashMap::new();
        let mut objects: Vec<Object> = Vec::with_capacity(tables.len());
        let mut first_objects = Vec::with_capacity(tables.len());
        let share = 1.0 / tables.len().max(1) as f32;
        for (index, table) in tables.iter().enumerate() {
            let table = table.get_ref();
            let step = |part: f32| progress((index as f32 + part) * share);
            let made;
            let (read, source) = match (&table.mesh, &table.shape) {
                (Some(named), None) => {
                    let mesh_path = beside(self.path, named.get_ref());
                    let source = self.files.source(&mesh_path);
                    let up_axis = table.up_axis.map_or(UpAxis::default(), Into::into);
                    let key = (source.clone(), up_axis);
                    if !meshes.contains_key(&key) {
                        let bytes = self.bytes(named, &mesh_path, &|part| step(part * 0.5))?;
                        let read =
                            mesh_file::read(&mesh_path, &bytes, self.files, up_axis, &|part| {
                                step(0.5 + part * 0.5);
                            })?;
                        let path = quote::path(&mesh_path);
                        notes.extend(read.notes.iter().map(|note| format!("{path}: {note}")));
                        warnings.extend(read.warnings);
                        meshes.insert(key.clone(), read.objects);
                    }
                    let read = meshes.get(&key).map_or(&[][..], Vec::as_slice);
                    (read, Some(source))
                }
                (None, Some(shape)) => {
                    made = [self.shape(shape, warnings)?];
                    (&made[..], None)
                }
                (Some(_), Some(shape)) => {
                    return Err(self.fault(shape, "a mesh or a shape", "both"));
                }
                (None, None) => {
                    let line = self.line(&tables[index]);
                    let expected = "an object's `mesh`, or `shape`";
                    return Err(FormatError::unexpected(self.path, line, expected, "none"));
                }
            };
            let found = self.named_nodes(table, read)?;
            mesh_file::count_objects(self.path, found, self.files.budget())?;
            let texture = match &table.texture {
                Some(named) => {
                    let path = beside(self.path, named.get_ref());
                    let source = self.files.source(&path);
                    let texture = match textures.get(&source) {
                        Some(texture) => Arc::clone(texture),
                        None => {
                            let bytes = self.bytes(named, &path, &|_| ())?;
                            let texture =
                                Arc::new(texture::decode(&path, &bytes, self.files.budget())?);
                            textures.insert(source.clone(), Arc::clone(&texture));
                            texture
                        }
                    };
                    Some((texture, source))
                }
                None => None,
            };
            let transform = self.transform(table)?;
            first_objects.push(objects.len());
            for placed in found {
                let mut object = placed.placed(source.clone());
                object.shape = table.shape.as_ref().map(|shape| (*shape.get_ref()).into());
                if let Some(name) = &table.name {
                    object.name = match found {
                        [_] => name.clone(),
                        _ => format!("{name}: {}", placed.name),
                    };
                }
                object.transform = match &table.node {
                    // What names its node has all of its place in its table.
                    Some(_) => transform,
                    None => within(&transform, placed.world_from_object),
                };
                object.visible = table.visible.unwrap_or(true);
                if let Some(color) = table.color {
                    object.color = color.rule(table.seed);
                }
                if let Some((texture, source)) = &texture {
                    object.texture = Some(Arc::clone(texture));
                    object.texture_source = Some(source.clone());
                }
                objects.push(object);
            }
        }
        first_objects.push(objects.len());
        for (index, parent) in parents.into_iter().enumerate() {
            let Some(parent) = parent else { continue };
            let count = first_objects[parent + 1] - first_objects[parent];
            if let (2.., Some(named)) = (count, &tables[index].get_ref().parent) {
                let found = format!("{}, a file of {count} objects", quote(named.get_ref()));
                return Err(self.fault(named, "the name of one object as parent", &found));
            }
            for object in &mut objects[first_objects[index]..first_objects[index + 1]] {
                object.parent = Some(first_objects[parent]);
            }
        }
        progress(1.0);
        Ok(objects)
    }

    /// Those of a file's objects that a table stands for: the one that it names, else all.
    fn named_nodes<'o>(
        &self,
        table: &ObjectToml,
        read: &'o [MeshObject],
    ) -> Result<&'o [MeshObject], FormatError> {
        let Some(node) = &table.node else {
            return Ok(read);
        };
        let number = *node.get_ref();
        // A file without nodes has none to name.
        let nodes = read.iter().filter(|object| object.node.is_some()).count();
        match read.get(number as usize).filter(|_| nodes > 0) {
            Some(object) => Ok(std::slice::from_ref(object)),
            None => {
                let expected =
                    format!("the number of one of the file's {nodes} mesh nodes, from 0");
                Err(self.fault(node, &expected, &number.to_string()))
            }
        }
    }

    /// A shape's mesh, counted before it is made.
    fn shape(
        &self,
        shape: &Spanned<ShapeToml>,
        warnings: &mut Vec<String>,
    ) -> Result<MeshObject, FormatError> {
        let shape_line = self.line(shape);
        let refused =
            |error: ShapeError| FormatError::refused(self.path, shape_line, &error.to_string());
        let shape = Shape::from(*shape.get_ref());
        shape.check().map_err(refused)?;
        let budget = self.files.budget();
        if shape.triangles() > budget.triangles_left() {
            budget.add_triangles(self.path, shape.triangles())?;
        }
        // A triangle has three corners in each of three lists, and at most three vertices of its own.
        let bytes = shape.triangles() * 3 * (3 * 4 + 24 + 12 + 8);
        let _share = budget.share(self.path, "the shape", bytes)?;
        let data = shape.mesh().map_err(refused)?;
        let mesh = mesh_file::store(self.path, data, budget, warnings)?;
        Ok(MeshObject::made(shape.name(), mesh))
    }

    fn transform(&self, table: &ObjectToml) -> Result<Transform, FormatError> {
        let place = |value: &Option<Spanned<[f64; 3]>>, default| match value {
            Some(value) => self.vector(value),
            None => Ok(default),
        };
        Ok(Transform {
            translate: place(&table.translate, DVec3::ZERO)?,
            rotate: place(&table.rotate, DVec3::ZERO)?,
            scale: place(&table.scale, DVec3::ONE)?,
            matrix: match &table.matrix {
                Some(matrix) => self.matrix(matrix)?,
                None => DAffine3::IDENTITY,
            },
        })
    }

    /// An affine map: three rows of four finite numbers, and perhaps a fourth, 0 0 0 1.
    fn matrix(&self, value: &Spanned<Vec<f64>>) -> Result<DAffine3, FormatError> {
        let numbers = value.get_ref();
        if numbers.len() != 12 && numbers.len() != 16 {
            let found = format!("{}", numbers.len());
            return Err(self.fault(value, "a matrix of 12 or 16 numbers, row by row", &found));
        }
        if let Some(number) = numbers.iter().find(|number| !number.is_finite()) {
            return Err(self.fault(value, "finite numbers", &number.to_string()));
        }
        let (rows, last) = numbers.split_at(12);
        if !last.is_empty() && last != [0.0, 0.0, 0.0, 1.0] {
            let found = format!("{last:?}");
            return Err(self.fault(value, "0, 0, 0, 1 as a matrix's last row", &found));
        }
        let column = |at: usize| DVec3::new(rows[at], rows[4 + at], rows[8 + at]);
        Ok(DAffine3 {
            matrix3: DMat3::from_cols(column(0), column(1), column(2)),
            translation: column(3),
        })
    }

    /// The bytes of a file that the scene names.
    fn bytes(
        &self,
        named: &Spanned<String>,
        path: &Path,
        progress: Progress<'_>,
    ) -> Result<Contents<'_>, FormatError> {
        self.files.read(path, By::Scene, progress).map_err(|error| {
            let reason = match error {
                FormatError::Io { place, source } => format!("{place} cannot be read: {source}"),
                error => error.to_string(),
            };
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
        for (start, table) in tables.iter().enumerate() {
            let Some(parent) = &table.get_ref().parent else {
                continue;
            };
            let mut ancestors = std::iter::successors(parents[start], |&index| parents[index]);
            if ancestors
                .by_ref()
                .take(ANCESTOR_LIMIT)
                .any(|index| index == start)
            {
                let found = format!("{}, its own descendant", quote(parent.get_ref()));
                return Err(self.fault(parent, "a parent that is no descendant", &found));
            }
            if ancestors.next().is_some() {
                let expected = format!("at most {ANCESTOR_LIMIT} ancestors");
                return Err(self.fault(parent, &expected, "more"));
            }
        }
        Ok(parents)
    }
}

#[cfg(test)]
mod tests {
    use super::super::read_scene_from;
    use super::*;
    use crate::camera::{Curve, Ease};
    use crate::scene::{Color, ColorRule};
    use crate::shade::{Filter, Mode, TextureProjection};

    const WHOLE: &str = r##"# A scene with everything.
[camera]
projection = "perspective"
eye = [3, 2.5, 5]
target = [0, 0, 0.1]
up = [0.0, 1.0, 0.0]
fov = 40.0

[image]
size = [1280, 720]
samples = 4
background = ["#20242c", "#3A4454"]

[shading]
mode = "barycentric"
wireframe = true
wireframe-width = 1.3
blend = 0.7
filter = "nearest"
texture-projection = "triplanar"

[[object]]
name = "moon"
mesh = "./parts/a.obj"
color = "per-triangle"
seed = 3
texture = "t.ppm"
translate = [4, 0, 0]
parent = "planet"

[[object]]
name = "planet"
mesh = "parts/a.obj"
color = "#ff8000"
rotate = [0, 90, 0]
scale = [1, 2, -1]

[[object]]
mesh = "b.txt"
texture = "t.ppm"
"##;

    fn files(name: &str) -> Option<Vec<u8>> {
        match name {
            "parts/a.obj" => {
                Some("mtllib a.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3".into())
            }
            "parts/a.mtl" => Some("newmtl x\nKd 0 1 0".into()),
            "b.txt" => Some("(0,0,0);(1,0,0);(0,1,0)".into()),
            "t.ppm" => Some("P3\n1 1\n255\n1 2 3\n".into()),
            "bad.obj" => Some("v 0 0 0\nf 1 2 3\n".into()),
            _ => None,
        }
    }

    fn parse(text: &str) -> SceneFile {
        read_scene_from(text, &files).expect("a good scene")
    }

    #[test]
    fn reads_everything() {
        let file = parse(WHOLE);
        let camera = file.camera.expect("a camera");
        assert_eq!(camera.placement.eye, DVec3::new(3.0, 2.5, 5.0));
        assert_eq!(camera.placement.target, DVec3::new(0.0, 0.0, 0.1));
        assert_eq!(
            (camera.projection, camera.frame),
            (Projection::Perspective, 40.0)
        );
        assert_eq!(file.image.size, Some((1280, 720)));
        assert_eq!(file.image.samples, Some(4));
        let shading = Shading {
            mode: Mode::Barycentric,
            wireframe: Some(Wireframe {
                width: 1.3,
                ..Wireframe::default()
            }),
            background: Background::default(),
            blend: 0.7,
            filter: Filter::Nearest,
            projection: TextureProjection::Triplanar,
        };
        assert_eq!(file.shading, Some(shading));
        let [moon, planet, plain] = &file.scene.objects[..] else {
            panic!("three objects");
        };
        assert_eq!((moon.parent, planet.parent), (Some(1), None));
        assert_eq!(moon.color, ColorRule::PerTriangle { seed: 3 });
        assert_eq!(planet.color, ColorRule::Uniform(Color([255, 128, 0])));
        assert_eq!(planet.transform.scale, DVec3::new(1.0, 2.0, -1.0));
        assert_eq!(plain.name, "b");
        assert!(Arc::ptr_eq(&moon.mesh, &planet.mesh), "one mesh, read once");
        let image = |object: &Object| object.texture.clone().expect("a texture");
        assert!(Arc::ptr_eq(&image(moon), &image(plain)));
        assert_eq!(moon.source.as_deref(), Some(Path::new("parts/a.obj")));
        assert_eq!(moon.mesh.materials()[0].color, Color([0, 255, 0]));
    }

    #[test]
    fn an_object_says_what_is_up_in_its_file() {
        let text = "[[object]]\nmesh = \"b.txt\"\n[[object]]\nmesh = \"b.txt\"\nup-axis = \"z\"\n";
        let file = parse(text);
        let corner = |index: usize| file.scene.objects[index].mesh.corners(0).expect("corners")[2];
        assert_eq!(corner(0), glam::Vec3::Y);
        assert_eq!(corner(1), glam::Vec3::NEG_Z);
        let saved = file
            .to_toml(Path::new("/nowhere"))
            .expect("it can be saved");
        assert_eq!(saved.matches("up-axis").count(), 1, "{saved}");
        let again = parse(&saved);
        assert_eq!(again.scene.content(), file.scene.content());
        assert_eq!(again.scene.objects[1].up_axis, UpAxis::Z);
        assert!(
            file.notes[1].ends_with("z is taken to be up"),
            "{:?}",
            file.notes
        );
    }

    #[test]
    fn what_is_left_out_is_left_to_the_caller() {
        let file = parse("");
        let nothing = "scene: the scene has no objects: there is nothing to see";
        assert_eq!(file.warnings, [nothing]);
        assert!(file.camera.is_none() && file.shading.is_none() && file.scene.objects.is_empty());
        assert_eq!(file.image, ImageFile::default());
        let file = parse("[image]\nbackground = \"transparent\"\n");
        let shading = Shading {
            background: Background::Transparent,
            ..Shading::default()
        };
        assert_eq!(file.shading, Some(shading));
    }

    #[test]
    fn says_where_and_what() {
        let check = |text: &str, place: &str, what: &str| {
            let message = read_scene_from(text, &files)
                .expect_err("a bad scene")
                .to_string();
            assert!(message.starts_with(&format!("{place}: ")), "{message}");
            assert!(message.contains(what), "{message}");
            assert_eq!(message.lines().count(), 1, "{message}");
        };
        let edit = |from: &str, to: &str| {
            assert_eq!(WHOLE.matches(from).count(), 1, "{from}");
            WHOLE.replace(from, to)
        };
        check("[camera", "scene:1", "");
        check(
            &edit("samples", "sample"),
            "scene:11",
            "unknown field `sample`",
        );
        check(&edit("samples = 4", "samples = 0"), "scene:11", "found 0");
        check(&edit("[1280, 720]", "[0, 720]"), "scene:10", "0x720");
        check(&edit("[1280, 720]", "[-1, 720]"), "scene:10", "");
        check(&edit("[1280, 720]", "[1280]"), "scene:10", "length");
        check(
            &edit("\"barycentric\"", "\"pretty\""),
            "scene:15",
            "`pretty`",
        );
        check(&edit("0.7", "1.5"), "scene:18", "found 1.5");
        check(&edit("[3, 2.5, 5]", "[nan, 0, 0]"), "scene:4", "finite");
        check(
            &edit("[3, 2.5, 5]", "[0, 0, 0.1]"),
            "scene:5",
            "away from the eye",
        );
        let with_up = |up: &str| edit("[0.0, 1.0, 0.0]", up);
        check(&with_up("[0, 0, 0]"), "scene:6", "expected a direction");
        check(
            &with_up("[-3, -2.5, -4.9]"),
            "scene:6",
            "lies along the view",
        );
        check(&edit("= 1.3", "= 0"), "scene:17", "above 0 and at most 100");
        check(
            &edit("= 1.3", "= 101"),
            "scene:17",
            "above 0 and at most 100",
        );
        check(
            &edit("samples = 4", "samples = 4097"),
            "scene:11",
            "expected 1 to 4096 samples, found 4097",
        );
        check(&edit("fov = 40.0", "fov = 180"), "scene:7", "found 180");
        check(&edit("fov = 40.0", "frame = 2"), "scene:7", "orthographic");
        check(
            &edit("\"perspective\"", "\"orthographic\""),
            "scene:7",
            "perspective",
        );
        check(&edit("#20242c", "20242"), "scene:12", "transparent");
        check(&edit("\"#ff8000\"", "\"red\""), "scene:34", "found \"red\"");
        check(
            &edit("\"b.txt\"", "\"c.txt\""),
            "scene:39",
            "c.txt cannot be read",
        );
        check(&edit("\"b.txt\"", "\"bad.obj\""), "bad.obj:2", "found 2");
        check(
            &edit("parent = \"planet\"", "parent = \"sun\""),
            "scene:29",
            "\"sun\"",
        );
        check(
            &edit("parent = \"planet\"", "parent = \"moon\""),
            "scene:29",
            "descendant",
        );
        check(
            &edit("rotate = [0, 90, 0]", "parent = \"moon\""),
            "scene:29",
            "descendant",
        );
        check(
            &edit("name = \"moon\"", "name = \"planet\""),
            "scene:29",
            "2 objects",
        );
    }

    #[test]
    fn saved_scenes_read_the_same() {
        let orthographic = WHOLE
            .replace("\"perspective\"", "\"orthographic\"")
            .replace("fov = 40.0", "frame = 2.125")
            .replace("[\"#20242c\", \"#3A4454\"]", "\"transparent\"")
            .replace("wireframe = true\nwireframe-width = 1.3\n", "");
        for text in [WHOLE, &orthographic, "", "[[object]]\nmesh = \"b.txt\""] {
            let file = parse(text);
            let saved = file
                .to_toml(Path::new("/nowhere"))
                .expect("it can be saved");
            let again = parse(&saved);
            assert_eq!(file.camera, again.camera);
            assert_eq!(file.image, again.image);
            assert_eq!(file.shading, again.shading);
            assert_eq!(file.scene.objects.len(), again.scene.objects.len());
            for (object, other) in file.scene.objects.iter().zip(&again.scene.objects) {
                assert_eq!(object.name, other.name);
                assert_eq!(object.transform, other.transform);
                assert_eq!(object.parent, other.parent);
                assert_eq!(object.color, other.color);
                assert_eq!(object.source, other.source);
                assert_eq!(object.texture, other.texture);
                assert_eq!(object.texture_source, other.texture_source);
            }
            assert_eq!(again.to_toml(Path::new("/nowhere")).ok(), Some(saved));
        }
    }

    #[test]
    fn a_matrix_places_an_object_and_is_saved_with_its_bits() {
        let object = |more: &str| format!("[[object]]\nmesh = \"b.txt\"\n{more}\n");
        let rows = "1, 0.1, -0.0, 4, 0, 1e-300, 2, 0.3, 5, 0, 3, 1e17";
        let twelve = parse(&object(&format!("scale = [2, 2, 2]\nmatrix = [{rows}]")));
        let found = twelve.scene.objects[0].transform;
        assert_eq!(found.matrix.translation, DVec3::new(4.0, 0.3, 1e17));
        assert_eq!(found.matrix.matrix3.y_axis, DVec3::new(0.1, 1e-300, 0.0));
        assert_eq!(found.scale, DVec3::splat(2.0));
        let sixteen = parse(&object(&format!("matrix = [{rows}, 0, 0, 0, 1]")));
        let bits = |file: &SceneFile| {
            let matrix = file.scene.objects[0].transform.matrix;
            matrix.to_cols_array().map(f64::to_bits)
        };
        assert_eq!(bits(&sixteen), bits(&twelve));
        let saved = sixteen.to_toml(Path::new("")).expect("it can be saved");
        assert_eq!(bits(&parse(&saved)), bits(&twelve), "{saved}");

        for (matrix, told) in [
            (
                "[1, 2, 3]",
                "scene:3: expected a matrix of 12 or 16 numbers, row by row, found 3",
            ),
            (
                "[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, inf, 0]",
                "scene:3: expected finite numbers, found inf",
            ),
            (
                "[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1]",
                "scene:3: expected 0, 0, 0, 1 as a matrix's last row, found [4.0, 5.0, 6.0, 1.0]",
            ),
        ] {
            let error = read_scene_from(&object(&format!("matrix = {matrix}")), &files);
            assert_eq!(error.expect_err("a bad matrix").to_string(), told);
        }
        let node = read_scene_from(&object("node = 0"), &files).expect_err("no nodes");
        let told =
            "scene:3: expected the number of one of the file's 0 mesh nodes, from 0, found 0";
        assert_eq!(node.to_string(), told);
    }

    #[test]
    fn shapes_are_made_from_their_numbers_and_saved_as_them() {
        let text = "[[object]]\nshape = { kind = \"sphere\", radius = 2, rings = 4 }\n\n\
            [[object]]\nname = \"box\"\nshape = { kind = \"cube\", size = [1, 2, 0.1] }\nparent = \"ring\"\n\n\
            [[object]]\nname = \"ring\"\nshape = { kind = \"torus\" }\ntranslate = [1, 0, 0]\n";
        let file = parse(text);
        let names: Vec<&str> = file.scene.objects.iter().map(|o| o.name.as_str()).collect();
        assert_eq!(names, ["sphere", "box", "ring"]);
        assert_eq!(
            file.scene.objects[0].shape,
            Some(Shape::Sphere {
                radius: 2.0,
                segments: 64,
                rings: 4
            })
        );
        assert_eq!(file.scene.objects[0].mesh.triangles().len(), 2 * 64 * 3);
        assert_eq!(file.scene.objects[1].parent, Some(2));
        let saved = file
            .to_toml(Path::new("/nowhere"))
            .expect("it can be saved");
        assert_eq!(
            parse(&saved).scene.content(),
            file.scene.content(),
            "{saved}"
        );
        for (line, told) in [
            ("shape = { kind = \"egg\" }", "unknown variant `egg`"),
            (
                "shape = { kind = \"disc\", height = 1 }",
                "unknown field `height`",
            ),
            (
                "shape = { kind = \"disc\", segments = 2 }",
                "expected 3 to 16384 segments of a disc, found 2",
            ),
            (
                "shape = { kind = \"disc\", radius = -1 }",
                "expected a disc's radius above 0, found -1",
            ),
            (
                "mesh = \"b.txt\"\nshape = { kind = \"disc\" }",
                "expected a mesh or a shape, found both",
            ),
            (
                "name = \"a\"",
                "expected an object's `mesh`, or `shape`, found none",
            ),
            (
                "shape = { kind = \"sphere\", rings = 16384, segments = 16384 }",
                "(limit `triangles`)",
            ),
        ] {
            let error = read_scene_from(&format!("[[object]]\n{line}\n"), &files);
            let error = error.expect_err(line).to_string();
            assert!(error.starts_with("scene"), "{error}");
            assert!(error.contains(told), "{error}");
            assert_eq!(error.lines().count(), 1, "{error}");
        }
    }

    #[test]
    fn saving_gives_parents_names_of_their_own() {
        let mut file = parse(WHOLE);
        for object in &mut file.scene.objects {
            object.name = "same".into();
        }
        let saved = file
            .to_toml(Path::new("/nowhere"))
            .expect("it can be saved");
        let again = parse(&saved);
        assert_eq!(again.scene.objects[0].parent, Some(1));
        assert_eq!(again.scene.objects[1].name, "same 2");
        file.scene.objects[2].source = None;
        let error = file.to_toml(Path::new("/nowhere")).expect_err("no file");
        assert!(error.to_string().contains("\"same\""), "{error}");
    }

    #[test]
    fn files_append() {
        let mut file = parse("[image]\nsamples = 2\n[[object]]\nmesh = \"b.txt\"");
        file.append(parse(WHOLE));
        let opened = ["b.txt", "parts/a.obj", "parts/a.mtl", "t.ppm"].map(PathBuf::from);
        assert_eq!(file.opened, opened, "what both opened is named once");
        assert_eq!(file.scene.objects.len(), 4);
        assert_eq!(file.scene.objects[1].parent, Some(2));
        assert_eq!(file.image.samples, Some(2));
        assert_eq!(file.image.size, Some((1280, 720)));
    }

    #[test]
    fn chains_of_parents_have_an_end() {
        let chain = |count: usize| {
            let object = |i: usize| {
                let parent = format!("parent = \"{}\"\n", i + 1);
                let parent = if i + 1 < count { parent.as_str() } else { "" };
                format!("[[object]]\nname = \"{i}\"\nmesh = \"b.txt\"\n{parent}")
            };
            let text: String = (0..count).map(object).collect();
            read_scene_from(&text, &files).map_err(|error| error.to_string())
        };
        assert!(chain(ANCESTOR_LIMIT + 1).is_ok());
        let told = chain(ANCESTOR_LIMIT + 2).expect_err("too long");
        assert_eq!(told, "scene:4: expected at most 1000 ancestors, found more");
    }

    #[test]
    fn objects_that_nobody_will_see_are_told() {
        let object = |more: &str| format!("[[object]]\nmesh = \"b.txt\"\n{more}\n");
        for (place, why) in [
            ("scale = [0, 0, 0]", "scaled to nothing"),
            ("scale = [0, 2, 0]", "scaled to nothing"),
            ("translate = [0, -2e18, 0]", "further than 1e18 from zero"),
        ] {
            let warnings = parse(&object(place)).warnings;
            assert_eq!(warnings.len(), 1, "{place}: {warnings:?}");
            let start = "scene: none of the 1 triangles of object \"b\" is seen: it ";
            assert!(warnings[0].starts_with(start), "{warnings:?}");
            assert!(warnings[0].ends_with(why), "{warnings:?}");
        }
        for place in ["", "scale = [1, 0, 1]", "scale = [1e-30, 1e-30, 1e-30]"] {
            assert!(parse(&object(place)).warnings.is_empty(), "{place}");
        }
    }

    #[test]
    fn messages_show_no_more_of_a_file_than_they_should() {
        let long = "x".repeat(100_000);
        for text in [
            format!("[camera]\n{long} = 1\n"),
            format!("[shading]\nmode = \"{long}\"\n"),
            format!("[image]\nbackground = [\"{long}\", \"#000000\"]\n"),
            format!("[[object]]\nmesh = \"{long}\"\n"),
            format!("[[object]]\nmesh = \"b.txt\"\ncolor = \"{long}\"\n"),
            format!("[[object]]\nmesh = \"b.txt\"\nparent = \"{long}\"\n"),
        ] {
            let error = read_scene_from(&text, &files).expect_err("a bad scene");
            let told = error.to_string();
            assert!(told.len() < 500, "{} characters", told.len());
        }
    }

    #[test]
    fn an_animation_comes_back_and_its_faults_are_named() {
        let text = "\
[camera]
eye = [0.0, 1.0, 5.0]
target = [0.0, 0.0, 0.0]

[animation]
ease = \"smooth\"

[[animation.key]]
at = 3
eye = [0.0, 1.0, 5.0]
target = [0.0, 0.0, 0.0]

[[animation.key]]
at = 7
eye = [2.0, 1.0, 5.0]
target = [0.0, 0.5, 0.0]
fov = 20.0
";
        let read = |text: &str| crate::formats::read_scene_from(text, &|_| None);
        let file = read(text).expect("a scene");
        let path = file.animation.clone().expect("an animation");
        assert_eq!(path.frames(), (3, 7));
        assert_eq!(
            (path.curve(), path.ease()),
            (Curve::CatmullRom, Ease::Smooth)
        );
        let views: Vec<_> = path.keys().iter().map(|key| key.view).collect();
        assert_eq!(views, [None, Some(20.0)]);
        assert_eq!(path.keys()[1].placement.target, DVec3::new(0.0, 0.5, 0.0));
        let saved = file.to_toml(Path::new("/")).expect("it can be saved");
        assert_eq!(read(&saved).expect("a scene").animation, Some(path));

        for (from, to, line, told) in [
            ("at = 7", "at = 3", "scene:13", "a keyframe after 3"),
            ("fov = 20.0", "fov = 180.0", "scene:17", "found 180"),
            ("fov = 20.0", "frame = 2.0", "scene:17", "orthographic"),
            ("ease = \"smooth\"", "ease = \"fast\"", "scene:6", "fast"),
            (
                "[2.0, 1.0, 5.0]",
                "[0.0, 0.5, 0.0]",
                "scene:",
                "target away",
            ),
        ] {
            let error = read(&text.replace(from, to)).expect_err(to).to_string();
            assert!(error.contains(line) && error.contains(told), "{error}");
        }
        let none = "[animation]\nkey = []\n";
        let error = read(none).expect_err("no keyframes").to_string();
        assert!(error.contains("expected a keyframe"), "{error}");
    }
}
