//! The colours of an OFF, whose scale only the whole file shows.

use crate::formats::face_colors;
use crate::scene::Color;

/// Colours as the file has them, each with the first vertex or triangle that has it.
#[derive(Default)]
pub(super) struct RawColors {
    pub(super) colors: Vec<(u32, [f32; 3])>,
    /// The largest channel of all of them.
    largest: f32,
}

impl RawColors {
    pub(super) fn add(&mut self, at: usize, channels: [f64; 3]) {
        let channels = channels.map(|channel| channel as f32);
        self.largest = channels.into_iter().fold(self.largest, f32::max);
        self.colors.push((at as u32, channels));
    }

    /// The colours as bytes. Some programs write 0 to 255, others 0 to 1: the latter if no channel of the file is
    /// above 1.
    pub(super) fn bytes(&self) -> impl Iterator<Item = (u32, Color)> {
        let scale = if self.largest > 1.0 { 1.0 / 255.0 } else { 1.0 };
        self.colors.iter().map(move |(at, channels)| {
            let byte = |channel: f32| face_colors::byte(f64::from(channel) * scale);
            (*at, Color(channels.map(byte)))
        })
    }
}
