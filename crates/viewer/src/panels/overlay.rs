//! What is drawn over the tiles: borders, order, and statistics as colours.

use crate::state::{Overlay, Tint};
use crate::ui::canvas::{Canvas, TileNote};
use egui::{Align2, Color32, FontId, Mesh, Painter, Pos2, Rect, Shape, Stroke, pos2};
use std::sync::Arc;
use std::time::Duration;

/// The least height of a tile whose number is readable, in points.
pub const LEAST_FOR_NUMBERS: f32 = 17.0;

/// The overlay, kept from frame to frame while nothing changes.
#[derive(Default)]
pub struct TileOverlay {
    key: Option<(u64, Tint, Rect)>,
    tints: Arc<Mesh>,
    times: Option<(Duration, Duration)>,
}

impl TileOverlay {
    /// The least and the greatest time of a tile, when last coloured by time.
    pub fn times(&self) -> Option<(Duration, Duration)> {
        self.times
    }

    /// Draws over a picture that fills `rect`.
    pub fn show(&mut self, painter: &Painter, canvas: &Canvas, rect: Rect, overlay: Overlay) {
        let (columns, rows) = canvas.size();
        if columns == 0 || rows == 0 {
            return;
        }
        let scale = rect.size() / egui::vec2(columns as f32, rows as f32);
        let place = |x: u32, y: u32| rect.min + egui::vec2(x as f32, y as f32) * scale;
        let area = |tile: raycast_core::camera::Rect| {
            Rect::from_min_max(place(tile.x, tile.y), place(tile.right(), tile.bottom()))
        };
        if overlay.tint != Tint::None {
            let key = Some((canvas.notes_version, overlay.tint, rect));
            if self.key != key {
                self.times = times(canvas);
                self.tints = Arc::new(tints(canvas, overlay.tint, self.times, area));
                self.key = key;
            }
            painter.add(Shape::Mesh(Arc::clone(&self.tints)));
        }
        if overlay.borders {
            borders(painter, canvas, rect, place);
        }
        if overlay.order {
            for (tile, note) in canvas.notes() {
                if let Some(note) = note {
                    number(painter, area(tile), note.order + 1);
                }
            }
        }
    }
}

fn took(note: &TileNote) -> Duration {
    note.stats.cast + note.stats.shade
}

fn times(canvas: &Canvas) -> Option<(Duration, Duration)> {
    let taken = canvas.notes().filter_map(|(_, note)| Some(took(&note?)));
    taken.fold(None, |range: Option<(Duration, Duration)>, time| {
        Some(range.map_or((time, time), |(least, most)| {
            (least.min(time), most.max(time))
        }))
    })
}

fn tints(
    canvas: &Canvas,
    tint: Tint,
    times: Option<(Duration, Duration)>,
    area: impl Fn(raycast_core::camera::Rect) -> Rect,
) -> Mesh {
    let mut mesh = Mesh::default();
    let (least, most) = times.unwrap_or_default();
    let log = |time: Duration| (time.as_secs_f64() + 1e-7).ln();
    let span = (log(most) - log(least)).max(1e-9);
    for (tile, note) in canvas.notes() {
        let Some(note) = note else {
            continue;
        };
        let color = match tint {
            Tint::None => continue,
            Tint::Time => ramp(((log(took(&note)) - log(least)) / span) as f32, 150),
            Tint::Worker => worker_color(note.stats.worker, 110),
        };
        mesh.add_colored_rect(area(tile), color);
    }
    mesh
}

fn borders(painter: &Painter, canvas: &Canvas, rect: Rect, place: impl Fn(u32, u32) -> Pos2) {
    let stroke = Stroke::new(1.0, Color32::from_white_alpha(70));
    let (mut last_x, mut last_y) = (0, 0);
    // Tiles come row by row: the first row has every cut across, each row's first the cut down.
    for (tile, _) in canvas.notes() {
        if tile.y == 0 && tile.x > last_x {
            last_x = tile.x;
            painter.vline(place(tile.x, 0).x, rect.y_range(), stroke);
        }
        if tile.x == 0 && tile.y > last_y {
            last_y = tile.y;
            painter.hline(rect.x_range(), place(0, tile.y).y, stroke);
        }
    }
}

fn number(painter: &Painter, area: Rect, number: u32) {
    if area.height() < LEAST_FOR_NUMBERS || area.width() < LEAST_FOR_NUMBERS {
        return;
    }
    let size = (area.height() * 0.42)
        .min(area.width() / 3.2)
        .clamp(7.0, 20.0);
    let center = area.center();
    let font = FontId::proportional(size.round());
    let text = number.to_string();
    // A dark copy behind makes it readable on any picture.
    let behind = pos2(center.x + 1.0, center.y + 1.0);
    let dark = Color32::from_black_alpha(190);
    painter.text(behind, Align2::CENTER_CENTER, &text, font.clone(), dark);
    let light = Color32::from_white_alpha(230);
    painter.text(center, Align2::CENTER_CENTER, text, font, light);
}

/// From fast (0, deep blue) through red to slow (1, bright yellow), in even steps of lightness.
pub fn ramp(share: f32, alpha: u8) -> Color32 {
    const STOPS: [[f32; 3]; 5] = [
        [20.0, 20.0, 70.0],
        [90.0, 25.0, 130.0],
        [200.0, 60.0, 90.0],
        [245.0, 140.0, 40.0],
        [252.0, 240.0, 130.0],
    ];
    let at = share.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let low = (at as usize).min(STOPS.len() - 2);
    let part = at - low as f32;
    let channel = |c: usize| (STOPS[low][c] + (STOPS[low + 1][c] - STOPS[low][c]) * part) as u8;
    Color32::from_rgba_unmultiplied(channel(0), channel(1), channel(2), alpha)
}

/// A colour that tells workers apart: hues a golden ratio away from each other.
fn worker_color(worker: u32, alpha: u8) -> Color32 {
    let hue = (worker as f32 * 0.618_034 + 0.58).fract();
    let [r, g, b] = egui::ecolor::Hsva::new(hue, 0.75, 0.95, 1.0).to_srgb();
    Color32::from_rgba_unmultiplied(r, g, b, alpha)
}
