//! Animated GIF (CompuServe, "Graphics Interchange Format, Version 89a", 1990), by the `gif` crate. Each frame has a
//! palette of its own, of up to 256 colours: exact where it has no more, else by `color_quant`'s neural network (Dekker,
//! "Kohonen neural networks for optimal colour quantization", 1994).

use super::{ImageError, Picture};
use ::gif::{DisposalMethod, Encoder, Frame, Repeat};
use color_quant::NeuQuant;
use std::io::{self, Write};

/// The most colours in a frame's palette.
const COLORS: usize = 256;

/// The alpha from which a pixel is opaque: GIF has no alpha between.
const OPAQUE: u8 = 128;

/// Colours that fill at least this share of a frame's pixels stay exact, such as a background: the network would move them
/// by a step, a different one in each frame. With a larger share fewer do; with a smaller one fewer entries are left to the
/// network, which needs 64 at least.
const FREQUENT: usize = 64;

/// About how many pixels the network learns from. With more, frames take longer; with fewer, colours of small parts are
/// lost.
const LEARNT: usize = 100_000;

/// A GIF whose pictures repeat in a loop.
pub struct AnimatedGif<W: Write> {
    to: W,
    /// Writes to memory, since it ends its file when it is dropped, and panics where that fails.
    encoder: Encoder<Vec<u8>>,
    size: (u16, u16),
    rate: u16,
    is_opaque: bool,
    /// Frames so far.
    count: u64,
}

impl<W: Write> AnimatedGif<W> {
    /// The highest rate in frames a second. Delays are in hundredths of a second, and browsers show a delay of less than two
    /// as ten.
    pub const MOST_RATE: u16 = 50;

    /// An animation of pictures of one size, `rate` a second. `is_opaque` says whether every pixel of all of them covers
    /// what lies behind it; otherwise, a pixel is transparent where its alpha is below half.
    ///
    /// # Errors
    /// A side of zero or above 65535; a rate of zero or above [`Self::MOST_RATE`]; a write error.
    pub fn new(to: W, size: (u32, u32), rate: u16, is_opaque: bool) -> Result<Self, ImageError> {
        let side = |side: u32| u16::try_from(side).ok().filter(|&side| side > 0);
        let (Some(width), Some(height)) = (side(size.0), side(size.1)) else {
            let (width, height) = size;
            return Err(ImageError::Encode(format!(
                "a GIF has at most 65535 × 65535 pixels, not {width} × {height}"
            )));
        };
        if !(1..=Self::MOST_RATE).contains(&rate) {
            return Err(ImageError::Encode(format!(
                "a GIF has at most {} frames a second, not {rate}",
                Self::MOST_RATE
            )));
        }
        let mut encoder = Encoder::new(Vec::new(), width, height, &[]).map_err(failed)?;
        encoder.set_repeat(Repeat::Infinite).map_err(failed)?;
        Ok(Self {
            to,
            encoder,
            size: (width, height),
            rate,
            is_opaque,
            count: 0,
        })
    }

    /// The delays of frames, in hundredths of a second: the shortest and the longest. They differ where a frame's time is no
    /// whole number of hundredths.
    pub fn delays(rate: u16) -> (u16, u16) {
        let rate = rate.max(1);
        (100 / rate, 100u16.div_ceil(rate))
    }

    /// An upper bound of the bytes that encoding a frame takes: its pixels, also sorted and as the network learns from them
    /// (4 each), its colours in a list that doubles as it grows (10), its indices (1), and these compressed (2).
    pub fn memory_for(columns: u32, rows: u32) -> u64 {
        u64::from(columns) * u64::from(rows) * 25
    }

    /// Adds the next picture.
    ///
    /// # Errors
    /// A picture of another size; a write error.
    pub fn add(&mut self, picture: &Picture) -> Result<(), ImageError> {
        picture.check()?;
        let (width, height) = self.size;
        if (picture.width, picture.height) != (width.into(), height.into()) {
            return Err(ImageError::Encode("its frames differ in size".to_owned()));
        }
        let indexed = Indexed::of(&picture.pixels, self.is_opaque)?;
        let frame = Frame {
            delay: self.delay(self.count),
            // What is transparent must show the page, not the frame before.
            dispose: match indexed.transparent {
                Some(_) => DisposalMethod::Background,
                None => DisposalMethod::Keep,
            },
            transparent: indexed.transparent,
            width,
            height,
            palette: Some(indexed.palette),
            buffer: indexed.indices.into(),
            ..Frame::default()
        };
        self.count += 1;
        self.encoder.write_frame(&frame).map_err(failed)?;
        let bytes = std::mem::take(self.encoder.get_mut());
        self.to.write_all(&bytes).map_err(unwritten)
    }

    /// The delay of a frame: frames begin at the nearest hundredth, so that roundings do not add up.
    fn delay(&self, frame: u64) -> u16 {
        let rate = u64::from(self.rate);
        let begin = |frame: u64| (frame * 100 + rate / 2) / rate;
        (begin(frame + 1) - begin(frame)) as u16
    }

    /// Ends the file.
    ///
    /// # Errors
    /// No picture; a write error.
    pub fn finish(mut self) -> Result<(), ImageError> {
        if self.count == 0 {
            return Err(ImageError::Encode("it has no frames".to_owned()));
        }
        let bytes = self.encoder.into_inner().map_err(failed)?;
        self.to.write_all(&bytes).map_err(unwritten)?;
        self.to.flush().map_err(unwritten)
    }
}

fn failed(error: ::gif::EncodingError) -> ImageError {
    ImageError::Encode(error.to_string())
}

fn unwritten(error: io::Error) -> ImageError {
    ImageError::Encode(error.to_string())
}

/// A picture as indices into a palette.
struct Indexed {
    palette: Vec<u8>,
    indices: Vec<u8>,
    transparent: Option<u8>,
}

impl Indexed {
    fn of(pixels: &[[u8; 4]], is_opaque: bool) -> Result<Self, ImageError> {
        let is_seen = |pixel: &[u8; 4]| is_opaque || pixel[3] >= OPAQUE;
        let mut seen: Vec<[u8; 4]> = super::buffers::reserved(pixels.len())?;
        let opaque = |&[r, g, b, _]: &[u8; 4]| [r, g, b, u8::MAX];
        seen.extend(pixels.iter().filter(|pixel| is_seen(pixel)).map(opaque));
        let has_transparent = seen.len() < pixels.len();
        let palette = Palette::of(&seen, COLORS - usize::from(has_transparent))?;
        let mut colors: Vec<u8> = palette.entries.iter().flatten().copied().collect();
        // An entry of its own, so that no colour becomes a hole.
        let transparent = has_transparent.then_some(palette.entries.len() as u8);
        if has_transparent {
            colors.extend([0; 3]);
        }
        let mut indices: Vec<u8> = super::buffers::reserved(pixels.len())?;
        indices.extend(pixels.iter().map(|pixel| match transparent {
            Some(transparent) if !is_seen(pixel) => transparent,
            _ => palette.index_of(opaque(pixel)),
        }));
        Ok(Self {
            palette: colors,
            indices,
            transparent,
        })
    }
}

/// The palette of some pixels, and the entry of each of their colours.
struct Palette {
    entries: Vec<[u8; 3]>,
    /// The colours, ascending, each with its entry.
    colors: Vec<([u8; 4], u8)>,
}

impl Palette {
    fn of(pixels: &[[u8; 4]], most: usize) -> Result<Self, ImageError> {
        let mut sorted: Vec<[u8; 4]> = super::buffers::reserved(pixels.len())?;
        sorted.extend_from_slice(pixels);
        sorted.sort_unstable();
        let runs = || sorted.chunk_by(|one, other| one == other);
        let has_few = runs().take(most + 1).count() <= most;
        let is_exact = |count: usize| has_few || count * FREQUENT >= pixels.len();
        let exact = runs().filter(|run| is_exact(run.len())).map(|run| run[0]);
        let exact: Vec<[u8; 4]> = exact.collect();
        let mut palette = Self {
            entries: exact.iter().map(|&[r, g, b, _]| [r, g, b]).collect(),
            colors: Vec::new(),
        };
        let first = palette.entries.len();
        let network = (!has_few).then(|| {
            let is_learnt = |pixel: &&[u8; 4]| exact.binary_search(pixel).is_err();
            let learnt: Vec<[u8; 4]> = pixels.iter().filter(is_learnt).copied().collect();
            let share = (learnt.len() / LEARNT).clamp(1, 30);
            NeuQuant::new(share as i32, most - first, learnt.as_flattened())
        });
        if let Some(network) = &network {
            let colors = network.color_map_rgb();
            palette.entries.extend(colors.as_chunks::<3>().0);
        }
        let entry = |color: [u8; 4]| match (exact.binary_search(&color), &network) {
            (Ok(entry), _) => entry as u8,
            (Err(_), Some(network)) => (first + network.index_of(&color)) as u8,
            // Without a network all colours are exact.
            (Err(_), None) => 0,
        };
        palette.colors = runs().map(|run| (run[0], entry(run[0]))).collect();
        Ok(palette)
    }

    fn index_of(&self, color: [u8; 4]) -> u8 {
        let found = self.colors.binary_search_by_key(&color, |entry| entry.0);
        found.map_or(0, |at| self.colors[at].1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    fn decoded(bytes: &[u8]) -> Vec<(u16, Vec<[u8; 4]>)> {
        let mut options = ::gif::DecodeOptions::new();
        options.set_color_output(::gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(bytes).expect("a GIF");
        let mut frames = Vec::new();
        while let Some(frame) = decoder.read_next_frame().expect("a frame") {
            frames.push((frame.delay, frame.buffer.as_chunks::<4>().0.to_vec()));
        }
        assert_eq!(decoder.repeat(), Repeat::Infinite);
        frames
    }

    fn encoded(pictures: &[Picture], rate: u16, is_opaque: bool) -> Vec<u8> {
        let mut bytes = Vec::new();
        let size = (pictures[0].width, pictures[0].height);
        let mut file = AnimatedGif::new(&mut bytes, size, rate, is_opaque).expect("a file");
        for picture in pictures {
            file.add(picture).expect("a frame");
        }
        assert!(file.add(&Picture::blank(1, 4, false)).is_err());
        file.finish().expect("all are there");
        bytes
    }

    /// A picture of few colours, in which alpha goes from 0 to 255.
    fn few(number: u8) -> Picture {
        let mut picture = Picture::blank(16, 15, false);
        for (at, pixel) in (0u8..).zip(&mut picture.pixels) {
            *pixel = [number, at, 255 - at, at];
        }
        picture
    }

    #[test]
    fn frames_of_few_colors_come_back_exactly() {
        let frames = [few(3), few(200)];
        for (frame, (_, pixels)) in frames.iter().zip(decoded(&encoded(&frames, 25, true))) {
            for (&[r, g, b, _], found) in frame.pixels.iter().zip(pixels) {
                assert_eq!([r, g, b, 255], found);
            }
        }
    }

    #[test]
    fn pixels_are_transparent_where_alpha_is_below_half() {
        let frames = [few(3)];
        let (_, pixels) = &decoded(&encoded(&frames, 25, false))[0];
        for (&[r, g, b, a], found) in frames[0].pixels.iter().zip(pixels) {
            match a < 128 {
                true => assert_eq!(found[3], 0),
                false => assert_eq!([r, g, b, 255], *found),
            }
        }
    }

    /// Smooth colours beside a transparent part and a background: the background stays exact, no seen pixel becomes a hole,
    /// and the mean error is that of a few steps of 255.
    #[test]
    fn many_colors_are_close_and_the_background_is_exact() {
        let mut random = Random(17);
        let mut picture = Picture::blank(300, 200, false);
        for (at, pixel) in picture.pixels.iter_mut().enumerate() {
            let (x, y) = ((at % 300) as f64 / 300.0, (at / 300) as f64 / 200.0);
            let noise = random.unit() * 4.0;
            let level = |share: f64| (share * 250.0 + noise) as u8;
            *pixel = match at % 300 {
                0..100 => [251, 252, 253, 255],
                100..150 => [9, 9, 9, 0],
                _ => [level(x), level(y), level(1.0 - x * y), 255],
            };
        }
        let bytes = encoded(std::slice::from_ref(&picture), 25, false);
        let again = encoded(std::slice::from_ref(&picture), 25, false);
        assert!(bytes == again);
        let (_, pixels) = &decoded(&bytes)[0];
        let (mut sum, mut count) = (0.0, 0.0);
        for (at, (before, found)) in picture.pixels.iter().zip(pixels).enumerate() {
            match at % 300 {
                0..100 => assert_eq!(before, found),
                100..150 => assert_eq!(found[3], 0),
                _ => {
                    assert_eq!(found[3], 255);
                    for channel in 0..3 {
                        let off = f64::from(before[channel]) - f64::from(found[channel]);
                        (sum, count) = (sum + off * off, count + 1.0);
                    }
                }
            }
        }
        let error = f64::sqrt(sum / count);
        assert!(error < 8.0, "{error}");
    }

    #[test]
    fn delays_add_up_to_the_rate() {
        for rate in [1, 7, 24, 30, 50] {
            let frames = vec![few(1); usize::from(rate)];
            let delays: Vec<u16> = decoded(&encoded(&frames, rate, true))
                .into_iter()
                .map(|(delay, _)| delay)
                .collect();
            assert_eq!(delays.iter().sum::<u16>(), 100, "{rate}");
            let (least, most) = AnimatedGif::<Vec<u8>>::delays(rate);
            assert!(delays.iter().all(|delay| (least..=most).contains(delay)));
        }
    }

    /// A file on a disk that is full.
    struct Full;

    impl Write for Full {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(io::ErrorKind::StorageFull.into())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_full_disk_is_an_error() {
        let mut file = AnimatedGif::new(Full, (16, 15), 25, true).expect("nothing is written yet");
        let error = file.add(&few(1)).expect_err("it is full").to_string();
        assert!(error.contains("could not be encoded"), "{error}");
    }

    #[test]
    fn what_a_gif_cannot_hold_is_an_error() {
        let refused = |size, rate| {
            let error = AnimatedGif::new(Vec::new(), size, rate, true).err();
            error.expect("an error").to_string()
        };
        assert!(refused((65536, 2), 25).contains("65535 × 65535 pixels, not 65536 × 2"));
        assert!(refused((0, 2), 25).contains("0 × 2"));
        assert!(refused((4, 4), 51).contains("at most 50 frames a second, not 51"));
        assert!(refused((4, 4), 0).contains("not 0"));
        let file = AnimatedGif::new(Vec::new(), (4, 4), 25, true).expect("a file");
        assert!(file.finish().is_err());
    }
}
