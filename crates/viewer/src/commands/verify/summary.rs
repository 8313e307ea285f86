//! The result of a verification, in words.

use raycast_report::WrongAnswer;
use raycast_report::verify::{Channels, Verification, WrongPixel};
use std::fmt::Write;

/// The result, in words.
pub(super) fn summary(found: &Verification) -> String {
    let Verification {
        pixels,
        checked,
        silhouettes,
        edges,
        channels,
        wrong,
        first_wrong,
    } = found;
    let Channels {
        numbers,
        depth,
        normal,
        uv,
        color,
    } = channels;
    let mut text = format!("{checked} of {pixels} pixels checked");
    // Writing to a string does not fail.
    let _ = match numbers {
        0 => writeln!(
            text,
            "\nchannels: colour at {color}; the picture tells no other"
        ),
        _ => writeln!(
            text,
            ": {silhouettes} where an object ends, {edges} where triangles meet, {} inside of one\n\
             channels: object and triangle at {numbers}, distance at {depth}, normal at {normal}, texture coordinates at {uv}, colour at {color}",
            checked - silhouettes - edges
        ),
    };
    if [depth, normal, uv].iter().any(|count| *count < numbers) || color < checked {
        let _ = writeln!(
            text,
            "not checked: what hangs on the place in a triangle that its ray grazes, colours under lines, textures that are \
             filtered by trilinear or ewa, do not repeat, or lie by triangle, plane, sphere or cylinder, colours by curvature, \
             what a legend covers, what rounding leaves open"
        );
    }
    let _ = match (wrong, checked == pixels) {
        (0, true) if *numbers > 0 => {
            writeln!(text, "0 wrong: every pixel shows what its ray meets first")
        }
        (0, true) => writeln!(
            text,
            "0 wrong: every colour checked is that of what its rays meet first"
        ),
        (0, false) => writeln!(
            text,
            "0 wrong of {checked}: with 95 % certainty, fewer than 3 in {checked} such pixels are"
        ),
        (wrong, _) => writeln!(text, "{wrong} wrong, of which the first are"),
    };
    for pixel in first_wrong {
        let WrongPixel {
            x,
            y,
            fault,
            shown,
            truth,
        } = pixel;
        let expected = truth.map_or_else(
            || "nothing".to_owned(),
            |truth| describe_hit(truth.object, truth.triangle, truth.t),
        );
        let _ = match (shown, fault) {
            (Some((object, triangle, depth)), fault)
                if !matches!(fault, WrongAnswer::Channel { .. }) =>
            {
                let found = describe_hit(*object, *triangle, f64::from(*depth));
                writeln!(
                    text,
                    "  column {x}, row {y}: {fault}: expected {expected}, found {found}"
                )
            }
            _ => writeln!(
                text,
                "  column {x}, row {y}: {fault}, where its ray meets {expected}"
            ),
        };
    }
    text
}

fn describe_hit(object: u32, triangle: u32, depth: f64) -> String {
    if (object, triangle) == (u32::MAX, u32::MAX) {
        "nothing".to_owned()
    } else {
        format!("object {object}, triangle {triangle} at {depth}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_gives_counts_and_wrong_pixels() {
        let good = Verification {
            pixels: 100,
            checked: 20,
            silhouettes: 5,
            edges: 6,
            channels: Channels {
                numbers: 20,
                depth: 19,
                normal: 20,
                uv: 20,
                color: 18,
            },
            ..Verification::default()
        };
        let text = summary(&good);
        assert!(text.contains("fewer than 3 in 20"), "{text}");
        assert!(text.contains("distance at 19, normal at 20"), "{text}");
        assert!(text.contains("not checked: "), "{text}");
        let colors = Verification {
            checked: 100,
            channels: Channels {
                color: 100,
                ..Channels::default()
            },
            ..Verification::default()
        };
        let text = summary(&colors);
        assert!(
            text.contains("colour at 100; the picture tells no other"),
            "{text}"
        );
        assert!(!text.contains("not checked"), "{text}");
        let all = Verification {
            checked: 100,
            ..good.clone()
        };
        assert!(summary(&all).contains("every pixel"));
        let bad = Verification {
            wrong: 1,
            first_wrong: vec![WrongPixel {
                x: 3,
                y: 4,
                fault: WrongAnswer::Hit,
                shown: Some((1, 7, 2.5)),
                truth: None,
            }],
            ..good
        };
        let line = "  column 3, row 4: a hit where there is a miss: expected nothing, found object 1, triangle 7 at 2.5\n";
        assert!(summary(&bad).ends_with(line), "{}", summary(&bad));
        let mut repainted = bad;
        repainted.first_wrong[0].fault = WrongAnswer::Channel {
            channel: "G",
            found: 7.0,
            low: 9.0,
            high: 10.0,
        };
        let line = "  column 3, row 4: G is 7, expected 9 to 10, where its ray meets nothing\n";
        assert!(
            summary(&repainted).ends_with(line),
            "{}",
            summary(&repainted)
        );
    }
}
