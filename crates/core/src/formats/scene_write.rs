use super::files::relative;
use super::scene_animation;
use super::scene_file::{CameraFile, SceneFile};
use super::scene_toml::{
    BackgroundToml, CameraToml, ClipToml, GroundToml, ImageToml, ObjectToml, PhotographToml,
    SceneToml, ShadingToml, StereoToml, Transparent, VERSION,
};
use super::scene_words::{ColorRuleToml, ColorToml, ProjectionToml, WrapToml};
use crate::camera::Projection;
use crate::quote::shorten;
use crate::scene::{ClippingPlane, Photograph, Scene, SceneError, Transform, UpAxis, Wrap};
use crate::shade::{Background, EdgeKinds, Shading};
use glam::DAffine3;
use std::path::Path;
use toml::Spanned;

/// Why a scene cannot be saved.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// An object whose mesh came from no file.
    #[error("object {object:?} has a mesh that is in no file: a scene file cannot name it")]
    NoSource {
        /// The object's name.
        object: String,
    },
    /// An object whose texture came from no file.
    #[error("object {object:?} has a texture that is in no file: a scene file cannot name it")]
    NoTextureSource {
        /// The object's name.
        object: String,
    },
    /// A file whose name is not Unicode.
    #[error("object {object:?} has a file whose name is not Unicode: a scene file cannot name it")]
    NotUnicode {
        /// The object's name.
        object: String,
    },
    /// Parents that do not exist or form a cycle, or a transform that is not finite.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// An error of the TOML encoder.
    #[error("the scene cannot be written: {0}")]
    Encode(String),
}

impl SceneFile {
    /// The text of a scene file in the folder `base_dir`, which need not exist yet.
    ///
    /// Paths are relative to that folder. A source that is relative already (a file from the store that
    /// [`super::read_scene_from`] was given) is written as it is; the caller must provide it there. Parents whose
    /// names are not unique are renamed. Reading the text gives the same scene.
    ///
    /// # Errors
    /// An object whose mesh or texture came from no file, or from one whose name is not Unicode; invalid parents or
    /// transforms.
    pub fn to_toml(&self, base_dir: &Path) -> Result<String, SaveError> {
        self.scene.world_from_objects()?;
        let names = names(&self.scene);
        let objects = (0..names.len())
            .map(|index| Ok(spanned(object(&self.scene, index, &names, base_dir)?)))
            .collect::<Result<_, SaveError>>()?;
        let file = SceneToml {
            version: Some(spanned(VERSION)),
            camera: self.camera.map(|camera| spanned(camera_table(&camera))),
            animation: self.animation.as_ref().map(|path| {
                let projection = self.camera.map(|camera| camera.projection);
                spanned(scene_animation::table(path, projection.unwrap_or_default()))
            }),
            image: ImageToml {
                size: self
                    .image
                    .size
                    .map(|(columns, rows)| spanned([columns, rows])),
                samples: self.image.samples.map(spanned),
                pixel_filter: self.image.pixel_filter.map(Into::into),
                step: self.image.step.map(spanned),
                shift: self.image.shift.map(spanned),
                stereo: self.image.stereo.map(|stereo| {
                    spanned(StereoToml {
                        kind: stereo.kind.into(),
                        eye_distance: stereo.eye_distance,
                        convergence: stereo.convergence,
                    })
                }),
                cull: self.image.cull.map(Into::into),
                precision: self.image.precision.map(Into::into),
                background: self.shading.map(|shading| {
                    spanned(match shading.background {
                        Background::Transparent => BackgroundToml::Word(Transparent::Transparent),
                        Background::Gradient(top, bottom) => {
                            BackgroundToml::Gradient([ColorToml(top), ColorToml(bottom)])
                        }
                    })
                }),
            },
            shading: self.shading.map(|shading| shading_table(&shading)),
            clip: self.clip.all().iter().map(clip_table).collect(),
            objects,
        };
        toml::to_string(&file).map_err(|error| SaveError::Encode(error.to_string()))
    }
}

/// A value without a position in a text.
fn spanned<T>(value: T) -> Spanned<T> {
    Spanned::new(0..0, value)
}

fn camera_table(camera: &CameraFile) -> CameraToml {
    let frame = Some(spanned(camera.frame));
    let (fov, frame) = match camera.projection {
        Projection::Orthographic => (None, frame),
        Projection::Perspective | Projection::Panoramic(_) => (frame, None),
    };
    CameraToml {
        projection: ProjectionToml(camera.projection),
        lens: (camera.projection.lens()).map(|lens| spanned(lens.coefficients().to_vec())),
        eye: spanned(camera.pose.eye.to_array()),
        target: spanned(camera.pose.target.to_array()),
        up: Some(spanned(camera.pose.up.to_array())),
        fov,
        frame,
    }
}

fn clip_table(plane: &ClippingPlane) -> Spanned<ClipToml> {
    spanned(ClipToml {
        normal: plane.normal.to_array(),
        offset: plane.offset,
        enabled: (!plane.enabled).then_some(false),
    })
}

fn shading_table(shading: &Shading) -> ShadingToml {
    let usual = Shading::default();
    ShadingToml {
        mode: Some(shading.mode.into()),
        wireframe: Some(shading.wireframe.is_some()),
        wireframe_width: shading.wireframe.map(|lines| spanned(lines.width)),
        wireframe_color: shading.wireframe.map(|lines| ColorToml(lines.color)),
        wireframe_edges: (shading.wireframe)
            .filter(|lines| lines.edges != EdgeKinds::ALL)
            .map(|lines| spanned(lines.edges.to_string())),
        wireframe_hidden: (shading.wireframe)
            .filter(|lines| lines.hidden != 0.0)
            .map(|lines| spanned(lines.hidden)),
        blend: Some(spanned(shading.blend)),
        filter: Some(shading.filter.into()),
        texture_projection: Some(shading.projection.into()),
        // Written only where they differ from the defaults, so that other files stay readable for programs that do
        // not know these keys.
        crease: (shading.crease != usual.crease).then(|| spanned(shading.crease)),
        lights: (shading.lights != usual.lights).then(|| shading.lights.into()),
        plain_color: (shading.plain_color != usual.plain_color)
            .then_some(ColorToml(shading.plain_color)),
        color_map: shading.scale.map(|scale| scale.map.into()),
        color_range: shading.scale.and_then(|scale| scale.range).map(spanned),
        legend: shading.scale.filter(|scale| scale.legend).map(|_| true),
        back_faces: shading.back_faces.map(ColorToml),
        ground: (shading.ground).map(|ground| spanned(GroundToml::Text(ground.to_string()))),
        x_ray_opacity: (shading.x_ray_opacity != Shading::X_RAY_OPACITY)
            .then(|| spanned(shading.x_ray_opacity)),
    }
}

/// Every object's name in the file: its own, unless it is a parent whose name is not unique.
fn names(scene: &Scene) -> Vec<String> {
    let mut names: Vec<String> = scene.objects.iter().map(|o| o.name.clone()).collect();
    let mut parents: Vec<usize> = scene.objects.iter().filter_map(|o| o.parent).collect();
    parents.sort_unstable();
    parents.dedup();
    for parent in parents {
        let is_taken = |name: &str, names: &[String]| {
            let mut others = names.iter().enumerate();
            others.any(|(index, other)| index != parent && other == name)
        };
        let mut number = 1;
        let mut name = names[parent].clone();
        while is_taken(&name, &names) {
            number += 1;
            name = format!("{} {number}", names[parent]);
        }
        names[parent] = name;
    }
    names
}

fn object(
    scene: &Scene,
    index: usize,
    names: &[String],
    base_dir: &Path,
) -> Result<ObjectToml, SaveError> {
    let object = &scene.objects[index];
    let named = |path: &Path| {
        relative(path, base_dir)
            .map(spanned)
            .ok_or_else(|| SaveError::NotUnicode {
                object: shorten(&object.name),
            })
    };
    let mesh = match (&object.source, object.shape) {
        (Some(source), _) => Some(named(source)?),
        (None, Some(_)) => None,
        (None, None) => {
            return Err(SaveError::NoSource {
                object: shorten(&object.name),
            });
        }
    };
    let texture = match (&object.texture, &object.texture_source) {
        (None, _) => None,
        (Some(_), Some(path)) => Some(named(path)?),
        (Some(_), None) => {
            return Err(SaveError::NoTextureSource {
                object: shorten(&object.name),
            });
        }
    };
    let (image, projector) = (object.texture.as_ref(), object.mapping.projector);
    let photograph = object.mapping.photograph.as_ref();
    let (color, seed) = ColorRuleToml::from_rule(&object.color);
    let Transform {
        translate,
        rotate,
        scale,
        matrix,
    } = object.transform;
    let at_rest = Transform::IDENTITY;
    Ok(ObjectToml {
        name: Some(names[index].clone()),
        shape: match mesh {
            Some(_) => None,
            None => object.shape.map(|shape| spanned(shape.into())),
        },
        mesh,
        up_axis: (object.up_axis != UpAxis::default()).then(|| object.up_axis.into()),
        node: object.node.map(spanned),
        color: Some(spanned(color)),
        seed,
        texture,
        crop: image
            .and_then(|image| image.crop())
            .map(|crop| spanned([crop.x, crop.y, crop.width, crop.height])),
        wrap: image
            .map(|image| image.wrap())
            .filter(|wrap| *wrap != [Wrap::Repeat; 2])
            .map(|wrap| wrap.map(WrapToml)),
        texture_projection: object.mapping.projection.map(Into::into),
        texture_center: projector.map(|at| spanned(at.center.to_array())),
        texture_front: projector.map(|at| spanned(at.front.to_array())),
        texture_up: projector.map(|at| spanned(at.up.to_array())),
        texture_size: projector.map(|at| spanned(at.size.to_array())),
        texture_camera: photograph.map(|photograph| spanned(photograph_toml(photograph))),
        blend_by: object.blend_by.clone().map(spanned),
        translate: (translate != at_rest.translate).then(|| spanned(translate.to_array())),
        rotate: (rotate != at_rest.rotate).then(|| spanned(rotate.to_array())),
        scale: (scale != at_rest.scale).then(|| spanned(scale.to_array())),
        matrix: rows(matrix).map(spanned),
        parent: object.parent.map(|parent| spanned(names[parent].clone())),
        visible: (!object.visible).then_some(false),
        hidden_groups: (object.hidden_groups.as_ref())
            .map(|hidden| spanned(hidden.names().clone())),
    })
}

fn photograph_toml(photograph: &Photograph) -> PhotographToml {
    let Photograph {
        eye,
        target,
        up,
        fov,
        shift,
        lens,
    } = *photograph;
    PhotographToml {
        eye: spanned(eye.to_array()),
        target: spanned(target.to_array()),
        up: Some(spanned(up.to_array())),
        fov: Some(spanned(fov)),
        shift: (shift != [0.0; 2]).then(|| spanned(shift)),
        lens: lens.map(|lens| spanned(lens.to_vec())),
    }
}

/// A matrix row by row; `None` for the identity, to the last bit.
fn rows(matrix: DAffine3) -> Option<Vec<f64>> {
    let bits = |map: DAffine3| map.to_cols_array().map(f64::to_bits);
    if bits(matrix) == bits(DAffine3::IDENTITY) {
        return None;
    }
    let [x, y, z] = [
        matrix.matrix3.row(0),
        matrix.matrix3.row(1),
        matrix.matrix3.row(2),
    ];
    let rows = [x, y, z].into_iter().zip(matrix.translation.to_array());
    Some(
        rows.flat_map(|(row, moved)| [row.x, row.y, row.z, moved])
            .collect(),
    )
}
