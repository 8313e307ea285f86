use super::Progress;
use super::error::{FormatError, shorten};
use super::files::Files;
use super::guard::guarded;
use super::lines::without_mark;
use super::mesh_file;
use super::scene_file::{CameraFile, FileKind, ImageSettings, SceneFile};
use super::scene_text::{Reader, line_at};
use super::scene_toml::{
    AnimationToml, BackgroundToml, CameraToml, ClipToml, GroundToml, ImageToml, SceneToml,
    ShadingToml, VERSION, VersionToml,
};
use super::scene_words::ProjectionToml;
use crate::camera::{
    BrownConrady, CameraPath, ImagePlane, Keyframe, Pose, PoseError, Projection, Stereo,
};
use crate::quote::{self, quote};
use crate::ranges;
use crate::scene::{ClippingPlane, ClippingPlanes, ColorMap, ColorScale, Scene, Unseen};
use crate::shade::{Background, Ground, Shading, Wireframe};
use glam::DVec3;
use std::path::Path;
use toml::Spanned;

/// Reads a scene file's text, and through `files` the files that it names.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    files: &dyn Files,
    progress: Progress<'_>,
) -> Result<SceneFile, FormatError> {
    let (reader, parsed) = parse(path, bytes, files)?;
    let mut file = reader.settings(&parsed)?;
    let (warnings, notes) = (&mut file.warnings, &mut file.notes);
    let objects = reader.objects(&parsed.objects, progress, warnings, notes)?;
    file.scene = Scene { objects };
    let mut unseen = unseen(path, &file.scene);
    mesh_file::limit_warnings(path, &mut unseen);
    file.warnings.append(&mut unseen);
    mesh_file::limit_warnings(path, &mut file.warnings);
    file.opened = files.opened();
    Ok(file)
}

/// Reads everything in a scene file's text but its objects, of which it checks that `files` has what they name.
pub(super) fn read_settings(
    path: &Path,
    bytes: &[u8],
    files: &dyn Files,
) -> Result<SceneFile, FormatError> {
    let (reader, parsed) = parse(path, bytes, files)?;
    let mut file = reader.settings(&parsed)?;
    for object in &parsed.objects {
        let object = object.get_ref();
        for named in [&object.mesh, &object.texture].into_iter().flatten() {
            reader.check_file(named)?;
        }
    }
    file.opened = files.opened();
    Ok(file)
}

/// Parses a scene file's text, and checks its version.
fn parse<'a>(
    path: &'a Path,
    bytes: &'a [u8],
    files: &'a dyn Files,
) -> Result<(Reader<'a>, SceneToml), FormatError> {
    let bytes = without_mark(bytes);
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = line_at(bytes, error.valid_up_to());
        FormatError::unexpected(path, Some(line), "UTF-8 text", "other bytes")
    })?;
    let reader = Reader { path, text, files };
    let parsed: SceneToml = guarded(path, || toml::from_str(text))?.map_err(|error| {
        // A newer version may contain tables that are unknown here, so its number is read first.
        let newer = guarded(path, || toml::from_str::<VersionToml>(text));
        let newer = newer.ok().and_then(Result::ok);
        if let Some(fault) = newer.and_then(|newer| reader.version(newer.version.as_ref()).err()) {
            return fault;
        }
        let line = error.span().map(|span| line_at(bytes, span.start));
        FormatError::refused(path, line, &shorten(error.message()))
    })?;
    reader.version(parsed.version.as_ref())?;
    Ok((reader, parsed))
}

/// A warning for each object that is placed so that nothing of it is visible, and for a scene without visible
/// objects.
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
    let placed = scene.objects.iter().zip(transforms);
    let warnings = placed.filter_map(|(object, world_from_object)| {
        let why = Unseen::of(object, &world_from_object)?;
        let count = object.kept().len();
        let name = quote(&object.name);
        Some(format!(
            "{path}: none of the {count} triangles of object {name} is seen: {why}"
        ))
    });
    warnings.collect()
}

impl Reader<'_> {
    /// Everything in the file but its objects.
    fn settings(&self, parsed: &SceneToml) -> Result<SceneFile, FormatError> {
        let camera = parsed.camera.as_ref();
        let camera = camera.map(|camera| self.camera(camera)).transpose()?;
        let projection = camera.map(|camera| camera.projection);
        let animation = parsed.animation.as_ref();
        let animation = animation.map(|animation| self.animation(animation, projection));
        Ok(SceneFile {
            kind: FileKind::Scene,
            camera,
            image: self.image(&parsed.image)?,
            shading: self.shading(parsed.shading.as_ref(), &parsed.image)?,
            clip: self.clip(&parsed.clip)?,
            animation: animation.transpose()?,
            ..SceneFile::default()
        })
    }

    /// Checks that this program supports the file's version.
    fn version(&self, version: Option<&Spanned<i64>>) -> Result<(), FormatError> {
        match version {
            Some(version) if !(1..=VERSION).contains(version.get_ref()) => {
                let expected =
                    format!("a scene file of version {VERSION}, which this program reads");
                let found = format!("version {}", version.get_ref());
                Err(self.fault(version, &expected, &found))
            }
            _ => Ok(()),
        }
    }

    /// Keyframes, each checked as a camera with the scene's projection.
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
            // A keyframe without a view has the camera's: any value will do for the check.
            let any = || Spanned::new(spanned.span(), 1.0);
            let frame = key.frame.clone().or_else(|| is_orthographic.then(any));
            let camera = CameraToml {
                projection: ProjectionToml(projection),
                lens: None,
                eye: key.eye.clone(),
                target: key.target.clone(),
                up: key.up.clone(),
                fov: key.fov.clone(),
                frame,
            };
            let camera = self.camera(&Spanned::new(spanned.span(), camera))?;
            keys.push(Keyframe {
                frame: key.at,
                pose: camera.pose,
                view: (key.fov.is_some() || key.frame.is_some()).then_some(camera.frame),
            });
        }
        CameraPath::new(keys, (*curve).into(), (*ease).into())
            .ok_or_else(|| self.fault(animation, "a keyframe ([[animation.key]])", "none"))
    }

    pub(super) fn camera(&self, camera: &Spanned<CameraToml>) -> Result<CameraFile, FormatError> {
        let table = camera;
        let camera = table.get_ref();
        let mut projection = camera.projection.0;
        if let Some(lens) = &camera.lens {
            if projection != Projection::Perspective {
                let found = "`lens`, which is for perspective cameras";
                return Err(self.fault(lens, "another key", found));
            }
            projection = Projection::through(
                self.in_range(lens, BrownConrady::try_from(&lens.get_ref()[..]))?,
            );
        }
        let misplaced = |value: &Spanned<f64>, key, other| {
            let found = format!("`{key}`, which is for {other} cameras");
            self.fault(value, "another key", &found)
        };
        let frame = match (projection, &camera.fov, &camera.frame) {
            (Projection::Perspective | Projection::Panoramic(_), _, Some(frame)) => {
                return Err(misplaced(frame, "frame", "orthographic"));
            }
            (Projection::Orthographic, Some(fov), _) => {
                return Err(misplaced(fov, "fov", "perspective"));
            }
            (Projection::Perspective | Projection::Panoramic(_), None, None) => {
                projection.default_fov()
            }
            (Projection::Perspective | Projection::Panoramic(_), Some(fov), None) => {
                self.in_range(fov, projection.check_fov(*fov.get_ref()))?
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
                return Err(self.fault(table, expected, "none"));
            }
        };
        let (eye, target) = (self.vector(&camera.eye)?, self.vector(&camera.target)?);
        let pose = match &camera.up {
            Some(up) => Pose {
                eye,
                target,
                up: self.vector(up)?,
            },
            None => Pose::towards(eye, target),
        };
        if let Err(error) = pose.check() {
            let line = match (error, &camera.up) {
                (PoseError::NoUp { .. } | PoseError::UpAlongView { .. }, Some(up)) => self.line(up),
                _ => self.line(&camera.target),
            };
            return Err(FormatError::refused(self.path, line, &error.to_string()));
        }
        Ok(CameraFile {
            pose,
            projection,
            frame,
        })
    }

    fn image(&self, image: &ImageToml) -> Result<ImageSettings, FormatError> {
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
        let step = image.step.as_ref().map(|step| {
            ImagePlane::new(1, 1, *step.get_ref())
                .map(|plane| plane.step)
                .map_err(|error| {
                    FormatError::refused(self.path, self.line(step), &error.to_string())
                })
        });
        Ok(ImageSettings {
            size: size.transpose()?,
            samples: samples.transpose()?,
            pixel_filter: image.pixel_filter.map(Into::into),
            step: step.transpose()?,
            shift: (image.shift.as_ref())
                .map(|shift| self.in_range(shift, ranges::shift(*shift.get_ref())))
                .transpose()?,
            stereo: (image.stereo.as_ref())
                .map(|given| {
                    let stereo = Stereo {
                        kind: given.get_ref().kind.into(),
                        eye_distance: given.get_ref().eye_distance,
                        convergence: given.get_ref().convergence,
                    };
                    self.in_range(given, stereo.check_distances().map(|()| stereo))
                })
                .transpose()?,
            cull: image.cull.map(Into::into),
            precision: image.precision.map(Into::into),
        })
    }

    /// `[[clip]]`.
    fn clip(&self, tables: &[Spanned<ClipToml>]) -> Result<ClippingPlanes, FormatError> {
        let mut planes = ClippingPlanes::NONE;
        for table in tables {
            let ClipToml {
                normal,
                offset,
                enabled,
            } = table.get_ref();
            planes
                .push(ClippingPlane {
                    normal: DVec3::from_array(*normal),
                    offset: *offset,
                    enabled: enabled.unwrap_or(true),
                })
                .map_err(|error| {
                    FormatError::refused(self.path, self.line(table), &error.to_string())
                })?;
        }
        Ok(planes)
    }

    /// The colour scale, if the file sets any part of it.
    fn scale(&self, file: &ShadingToml) -> Result<Option<ColorScale>, FormatError> {
        if file.color_map.is_none() && file.color_range.is_none() && file.legend.is_none() {
            return Ok(None);
        }
        let range = file.color_range.as_ref().map(|range| {
            let [low, high] = *range.get_ref();
            ranges::color_range([low, high]).map_err(|error| {
                FormatError::refused(self.path, self.line(range), &error.to_string())
            })
        });
        Ok(Some(ColorScale {
            map: file.color_map.map_or(ColorMap::default(), Into::into),
            range: range.transpose()?,
            legend: file.legend.unwrap_or(false),
        }))
    }

    /// `[shading]` and the background; `None` if the file has neither.
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
            edges: match &file.wireframe_edges {
                Some(edges) => edges.get_ref().parse().map_err(|_| {
                    let expected = "kinds of edges: all, polygon, feature[:DEGREES], silhouette, \
                                    boundary, non-manifold";
                    self.fault(edges, expected, &quote(edges.get_ref()))
                })?,
                None => lines.edges,
            },
            hidden: match &file.wireframe_hidden {
                Some(hidden) => self.in_range(hidden, ranges::hidden_lines(*hidden.get_ref()))?,
                None => lines.hidden,
            },
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
            crease: match &file.crease {
                Some(crease) => self.in_range(crease, ranges::crease(*crease.get_ref()))?,
                None => defaults.crease,
            },
            lights: file.lights.map_or(defaults.lights, Into::into),
            plain_color: file
                .plain_color
                .map_or(defaults.plain_color, |color| color.0),
            scale: self.scale(file)?,
            back_faces: file.back_faces.map(|color| color.0),
            ground: match &file.ground {
                Some(ground) => Some(self.in_range(
                    ground,
                    match ground.get_ref() {
                        GroundToml::Text(text) => text.parse(),
                        GroundToml::Number(height) => Ground::at(*height),
                    },
                )?),
                None => None,
            },
            x_ray_opacity: match &file.x_ray_opacity {
                Some(opacity) => self.in_range(opacity, ranges::opacity(*opacity.get_ref()))?,
                None => defaults.x_ray_opacity,
            },
        }))
    }
}
