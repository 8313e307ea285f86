//! What the JPEG decoder does not say of a file: that it ends early, or claims more pixels than its
//! bytes can hold. The decoder fills what is missing with grey.

/// Why a JPEG file cannot hold the picture that it claims; `None` where it may.
///
/// Follows the markers (ITU-T T.81, "Digital compression and coding of continuous-tone still
/// images", 1992, annex B) from the first to the end of the image, without decoding. A file that is
/// no JPEG at all, or has no frame header, is left to the decoder's own words.
pub(super) fn fault(bytes: &[u8]) -> Option<String> {
    const CUT: &str = "the image is damaged: the file ends before the image does";
    let mut rest = bytes.strip_prefix(&[0xff, 0xd8])?;
    let mut least_bits = None;
    let mut scan_bytes = 0;
    loop {
        let Some(at) = rest.iter().position(|&byte| byte == 0xff) else {
            return Some(CUT.to_owned());
        };
        rest = &rest[at + 1..];
        let Some((&marker, after)) = rest.split_first() else {
            return Some(CUT.to_owned());
        };
        match marker {
            // Stuffing, fill bytes and restarts: within entropy-coded data, or before a marker.
            0x00 | 0x01 | 0xd0..=0xd8 => rest = after,
            0xff => {}
            END_OF_IMAGE => break,
            _ => {
                let Some(&[high, low]) = after.first_chunk() else {
                    return Some(CUT.to_owned());
                };
                let length = usize::from(u16::from_be_bytes([high, low])).max(2);
                let Some((segment, behind)) = after.split_at_checked(length) else {
                    return Some(CUT.to_owned());
                };
                match marker {
                    // Baseline, extended and progressive frames with Huffman codes.
                    0xc0..=0xc2 => least_bits = least_bits.or(frame_bits(&segment[2..])),
                    START_OF_SCAN => scan_bytes = scan_bytes.max(behind.len()),
                    _ => {}
                }
                rest = behind;
            }
        }
    }
    let (width, height, bits) = least_bits?;
    let holds = scan_bytes as u64 * 8;
    (bits > holds).then(|| {
        format!(
            "the image is damaged: it claims {width}x{height} pixels, more than its {} bytes can \
             hold",
            bytes.len()
        )
    })
}

const END_OF_IMAGE: u8 = 0xd9;
const START_OF_SCAN: u8 = 0xda;

/// Columns, rows, and the fewest bits that they take: each 8 × 8 block of each component has a DC
/// coefficient, whose code has one bit at least.
fn frame_bits(header: &[u8]) -> Option<(u16, u16, u64)> {
    let &[_precision, h1, h2, w1, w2, components] = header.first_chunk()?;
    let (height, width) = (u16::from_be_bytes([h1, h2]), u16::from_be_bytes([w1, w2]));
    let factors: Vec<(u64, u64)> = header[6..]
        .chunks_exact(3)
        .take(components.into())
        .map(|component| (u64::from(component[1] >> 4), u64::from(component[1] & 15)))
        .collect();
    let across = factors.iter().map(|(h, _)| *h).max().filter(|h| *h > 0)?;
    let down = factors.iter().map(|(_, v)| *v).max().filter(|v| *v > 0)?;
    let blocks = |side: u16, factor: u64, most: u64| {
        let samples = (u64::from(side) * factor).div_ceil(most);
        samples.div_ceil(8)
    };
    let bits = factors
        .iter()
        .map(|&(h, v)| blocks(width, h, across) * blocks(height, v, down))
        .sum();
    Some((width, height, bits))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn jpeg(side: u32, grey: bool) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 50);
        let noise = |i: u32| (i.wrapping_mul(2_654_435_761) >> 24) as u8;
        let (count, kind) = if grey {
            (1, image::ExtendedColorType::L8)
        } else {
            (3, image::ExtendedColorType::Rgb8)
        };
        let pixels: Vec<u8> = (0..side * side * count).map(noise).collect();
        encoder
            .encode(&pixels, side, side, kind)
            .expect("an image can be encoded");
        bytes
    }

    #[test]
    fn a_cut_file_is_known_by_its_missing_end() {
        for grey in [false, true] {
            let whole = jpeg(40, grey);
            assert_eq!(fault(&whole), None);
            assert_eq!(fault(&[&whole[..], b"a trailer"].concat()), None);
            for end in 2..whole.len() {
                assert!(fault(&whole[..end]).is_some(), "{end} of {}", whole.len());
            }
        }
    }

    #[test]
    fn a_file_holds_no_more_pixels_than_it_has_bits_for() {
        for grey in [false, true] {
            let mut bytes = jpeg(16, grey);
            let frame = bytes
                .windows(2)
                .position(|pair| pair == [0xff, 0xc0])
                .expect("a frame");
            let side = 16_000u16.to_be_bytes();
            bytes[frame + 5..frame + 7].copy_from_slice(&side);
            bytes[frame + 7..frame + 9].copy_from_slice(&side);
            let told = fault(&bytes).expect("a fault");
            assert!(told.contains("claims 16000x16000 pixels"), "{told}");
        }
        // One grey block of one colour is as small as blocks get.
        let mut flat = Vec::new();
        image::codecs::jpeg::JpegEncoder::new_with_quality(&mut flat, 1)
            .encode(&[128; 256 * 256], 256, 256, image::ExtendedColorType::L8)
            .expect("an image can be encoded");
        assert_eq!(fault(&flat), None);
    }

    #[test]
    fn what_is_no_jpeg_is_left_to_others() {
        assert_eq!(fault(b"\x89PNG"), None);
        assert_eq!(fault(b""), None);
        assert!(fault(b"\xff\xd8").is_some());
    }
}
