//! The look of a picture's lines.

use super::Wireframe;
use super::edge_choice::EdgeChoice;
use super::edges::LineStyle;
use super::facet::Needs;
use super::line_overlay::LineOverlay;
use super::srgb::{self, over};
use crate::scene::Scene;
use glam::Vec3;

/// How lines look.
#[derive(Debug)]
pub(super) struct Lines<'a> {
    color: Vec3,
    boundary: Vec3,
    non_manifold: Vec3,
    pub(super) width: f64,
    /// Which edges have them; `None`: all.
    pub(super) choice: Option<EdgeChoice<'a>>,
    /// How strongly hidden ones show.
    pub(super) hidden: f32,
    /// Those that no triangle at a pixel has, where any are to be seen.
    pub(super) overlay: Option<LineOverlay>,
}

impl<'a> Lines<'a> {
    pub(super) fn new(scene: &'a Scene, lines: Wireframe, needs: Needs) -> Self {
        let width = if lines.width.is_finite() {
            lines.width.max(0.0)
        } else {
            Wireframe::ALONE.width
        };
        Self {
            color: srgb::linear(lines.color),
            boundary: srgb::linear(Wireframe::BOUNDARY),
            non_manifold: srgb::linear(Wireframe::NON_MANIFOLD),
            width: f64::from(width),
            choice: (needs.edges)
                .then(|| EdgeChoice::new(scene, lines.edges))
                .flatten(),
            hidden: if needs.edges { lines.hidden } else { 0.0 },
            overlay: None,
        }
    }

    /// A line over what it lies on.
    pub(super) fn over(&self, (coverage, style): (f32, LineStyle), under: [f32; 4]) -> [f32; 4] {
        over(self.color_of(style), coverage, under)
    }

    /// The colour of lines of a style.
    pub(super) fn color_of(&self, style: LineStyle) -> Vec3 {
        match style {
            LineStyle::Plain | LineStyle::Feature => self.color,
            LineStyle::Boundary => self.boundary,
            LineStyle::NonManifold => self.non_manifold,
        }
    }

    /// Hidden lines over what hides them.
    pub(super) fn seen_through(&self, x: f64, y: f64, under: [f32; 4]) -> [f32; 4] {
        match &self.overlay {
            Some(overlay) if self.hidden > 0.0 => {
                let (coverage, style) = overlay.hidden(x, y);
                self.over((coverage * self.hidden, style), under)
            }
            _ => under,
        }
    }

    /// Silhouettes over what lies behind them, at `t`.
    pub(super) fn outlined(&self, x: f64, y: f64, t: f32, under: [f32; 4]) -> [f32; 4] {
        match &self.overlay {
            Some(overlay) if self.has_silhouettes() => {
                self.over(overlay.silhouette(x, y, t), under)
            }
            _ => under,
        }
    }

    pub(super) fn has_silhouettes(&self) -> bool {
        (self.choice.as_ref()).is_some_and(EdgeChoice::has_silhouettes)
    }
}
