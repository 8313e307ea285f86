//! The words of a `.raycast.toml`: its projections, colours, modes and other choices.

use crate::camera::{Curve, Ease, PixelFilter, Projection, StereoKind};
use crate::hit::{Cull, Precision};
use crate::scene::{Color, ColorMap, ColorRule, TextureProjection, UpAxis, Wrap};
use crate::shade::{Filter, LightSet, Mode};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

/// A value whose word in the file is its displayed text.
macro_rules! displayed {
    ($(#[$about:meta])* $name:ident($of:ident)) => {
        $(#[$about])*
        #[derive(Clone, Debug)]
        pub(super) struct $name(pub(super) $of);

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let text = String::deserialize(deserializer)?;
                text.parse().map(Self).map_err(D::Error::custom)
            }
        }

        impl Serialize for $name {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.collect_str(&self.0)
            }
        }
    };
}

displayed! {
    /// The camera's projection.
    #[derive(Default)]
    ProjectionToml(Projection)
}
displayed! {
    /// A colour as `#rrggbb`.
    #[derive(Copy)]
    ColorToml(Color)
}
displayed! {
    /// A texture's wrapping.
    #[derive(Copy)]
    WrapToml(Wrap)
}

displayed! {
    /// An object's colour rule; the seed is a key of its own.
    ColorRuleToml(ColorRule)
}

impl ColorRuleToml {
    pub(super) fn rule(&self, seed: Option<u32>) -> ColorRule {
        match (&self.0, seed) {
            (ColorRule::PerTriangle { .. }, Some(seed)) => ColorRule::PerTriangle { seed },
            (rule, _) => rule.clone(),
        }
    }

    /// The rule and the seed as the file stores them.
    pub(super) fn from_rule(rule: &ColorRule) -> (Self, Option<u32>) {
        match rule {
            ColorRule::PerTriangle { seed } => {
                (Self(ColorRule::PerTriangle { seed: 0 }), Some(*seed))
            }
            rule => (Self(rule.clone()), None),
        }
    }
}

/// An enum whose words in the file are the kebab-case names of another enum's variants.
macro_rules! words {
    ($name:ident for $target:ident { $($variant:ident),+ }) => {
        #[derive(Clone, Copy, Debug, Deserialize, Serialize)]
        #[serde(rename_all = "kebab-case")]
        pub(super) enum $name { $($variant),+ }

        impl From<$name> for $target {
            fn from(word: $name) -> Self {
                match word { $($name::$variant => Self::$variant),+ }
            }
        }

        impl From<$target> for $name {
            fn from(value: $target) -> Self {
                match value { $($target::$variant => Self::$variant),+ }
            }
        }
    };
}

words!(ModeToml for Mode {
    Color, Flat, Smooth, Material, Normals, Depth, Barycentric, Uv, Texture, Wireframe, XRay
});
words!(CullToml for Cull { None, Back });
words!(PrecisionToml for Precision { Fast, Exact });
words!(PixelFilterToml for PixelFilter { Box, Tent, Mitchell, Gaussian });
words!(StereoKindToml for StereoKind { Pair, Ods });
words!(CurveToml for Curve { Linear, CatmullRom });
words!(EaseToml for Ease { None, Smooth });
words!(UpAxisToml for UpAxis { Y, Z });
words!(LightSetToml for LightSet { Soft, Headlight, ThreePoint });
words!(FilterToml for Filter { Nearest, Bilinear, Trilinear, Ewa });
words!(ColorMapToml for ColorMap { Viridis, Magma, Turbo, Cividis, Diverging });
words!(TextureProjectionToml for TextureProjection {
    Uv, Triplanar, PerTriangle, Plane, Sphere, Cylinder, Camera
});

impl Default for CurveToml {
    fn default() -> Self {
        Curve::default().into()
    }
}

impl Default for EaseToml {
    fn default() -> Self {
        Ease::default().into()
    }
}
