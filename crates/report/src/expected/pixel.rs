//! An 8-bit pixel against the light that it should show.

use super::range::Single;
use super::srgb;
use crate::wrong_answer::WrongAnswer;

/// Whether an 8-bit pixel may show this light of its samples, with premultiplied alpha; `None` where that is
/// undecided.
pub(crate) fn shows(pixel: [u8; 4], [r, g, b, a]: [Single; 4]) -> Option<Result<(), WrongAnswer>> {
    if ![r, g, b, a].iter().all(|channel| channel.is_known()) {
        return None;
    }
    let check = |channel, found: u8, [low, high]: [u8; 2]| {
        if (low..=high).contains(&found) {
            Ok(())
        } else {
            Err(WrongAnswer::Channel {
                channel,
                found: found.into(),
                low: low.into(),
                high: high.into(),
            })
        }
    };
    let [red, green, blue, alpha] = pixel;
    let alpha_of = |alpha: f64| (alpha.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    if let Err(fault) = check("A", alpha, [alpha_of(a.low), alpha_of(a.high)]) {
        return Some(Err(fault));
    }
    for (channel, found, light) in [("R", red, r), ("G", green, g), ("B", blue, b)] {
        // A transparent pixel has no colour.
        let bytes = match alpha {
            0 => [0, 0],
            _ => srgb::byte_range(light / a)?,
        };
        if let Err(fault) = check(channel, found, bytes) {
            return Some(Err(fault));
        }
    }
    Some(Ok(()))
}
