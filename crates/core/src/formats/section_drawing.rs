//! Outlines of sections as drawings: SVG and DXF.
//!
//! Both use the plane's own axes ([`SectionAxes`]) and the scene's units, with all digits of the numbers. DXF is
//! written as release 12 (AutoCAD, "DXF Reference", 1992): polylines without a header, which every reader supports.

use crate::section::{SectionAxes, SectionLine};
use glam::DVec2;
use std::io::{self, Write};

/// A format of drawings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawingFormat {
    /// SVG: a path for each object, filled by the even-odd rule; y is negated, since it points down there.
    Svg,
    /// DXF, release 12, as text: a polyline for each line of the outline, a layer for each object.
    Dxf,
}

impl DrawingFormat {
    /// The format of a file name, by its extension in any case.
    pub fn from_name(name: &str) -> Option<Self> {
        let (_, extension) = name.rsplit_once('.')?;
        match extension.to_ascii_lowercase().as_str() {
            "svg" => Some(Self::Svg),
            "dxf" => Some(Self::Dxf),
            _ => None,
        }
    }
}

/// Writes the outline of a section, in the axes of its plane; equal outlines give equal bytes.
///
/// # Errors
/// Those of `out`.
pub fn write_section(
    lines: &[SectionLine],
    axes: &SectionAxes,
    format: DrawingFormat,
    out: &mut dyn Write,
) -> io::Result<()> {
    let mut objects: Vec<(u32, Vec<Drawn>)> = Vec::new();
    let mut order: Vec<&SectionLine> = lines.iter().collect();
    order.sort_by_key(|line| line.object);
    for line in order {
        let drawn = Drawn {
            // Without minus zeros.
            points: line
                .points
                .iter()
                .map(|&p| axes.coordinates(p) + DVec2::ZERO)
                .collect(),
            is_closed: line.is_closed,
        };
        match objects.last_mut() {
            Some((object, drawings)) if *object == line.object => drawings.push(drawn),
            _ => objects.push((line.object, vec![drawn])),
        }
    }
    match format {
        DrawingFormat::Svg => svg(&objects, out),
        DrawingFormat::Dxf => dxf(&objects, out),
    }
}

struct Drawn {
    points: Vec<DVec2>,
    is_closed: bool,
}

fn svg(objects: &[(u32, Vec<Drawn>)], out: &mut dyn Write) -> io::Result<()> {
    let points = || {
        objects
            .iter()
            .flat_map(|(_, lines)| lines)
            .flat_map(|line| &line.points)
    };
    let least = points().copied().reduce(DVec2::min).unwrap_or_default();
    let most = points().copied().reduce(DVec2::max).unwrap_or_default();
    let size = most - least;
    let margin = 0.02 * size.max_element();
    let line = 0.002 * size.max_element();
    writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{} {} {} {}\">",
        least.x - margin,
        -most.y - margin,
        size.x + 2.0 * margin,
        size.y + 2.0 * margin
    )?;
    for (object, lines) in objects {
        write!(
            out,
            "<path id=\"object-{object}\" fill=\"#e07b39\" fill-rule=\"evenodd\" stroke=\"black\" stroke-width=\"{line}\" \
             stroke-linejoin=\"round\" d=\""
        )?;
        for Drawn { points, is_closed } in lines {
            for (index, point) in points.iter().enumerate() {
                let letter = if index == 0 { 'M' } else { 'L' };
                write!(out, "{letter}{} {}", point.x, 0.0 - point.y)?;
            }
            if *is_closed {
                out.write_all(b"Z")?;
            }
        }
        writeln!(out, "\"/>")?;
    }
    writeln!(out, "</svg>")
}

fn dxf(objects: &[(u32, Vec<Drawn>)], out: &mut dyn Write) -> io::Result<()> {
    out.write_all(b"0\nSECTION\n2\nENTITIES\n")?;
    for (object, lines) in objects {
        for Drawn { points, is_closed } in lines {
            let flags = u8::from(*is_closed);
            write!(
                out,
                "0\nPOLYLINE\n8\nOBJECT_{object}\n66\n1\n10\n0.0\n20\n0.0\n30\n0.0\n70\n{flags}\n"
            )?;
            for DVec2 { x, y } in points {
                write!(
                    out,
                    "0\nVERTEX\n8\nOBJECT_{object}\n10\n{x:?}\n20\n{y:?}\n30\n0.0\n"
                )?;
            }
            write!(out, "0\nSEQEND\n8\nOBJECT_{object}\n")?;
        }
    }
    out.write_all(b"0\nENDSEC\n0\nEOF\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn lines() -> [SectionLine; 2] {
        let line = |object, is_closed, points: &[[f64; 2]]| SectionLine {
            object,
            points: points
                .iter()
                .map(|[x, y]| DVec3::new(*x, *y, 7.0))
                .collect(),
            is_closed,
        };
        [
            line(1, false, &[[0.0, 0.0], [0.1, -2.0]]),
            line(0, true, &[[0.0, 0.0], [1.0, 0.0], [1.0, 0.5]]),
        ]
    }

    fn written(format: DrawingFormat) -> String {
        let axes = SectionAxes {
            right: DVec3::X,
            up: DVec3::Y,
        };
        let mut bytes = Vec::new();
        write_section(&lines(), &axes, format, &mut bytes).expect("written");
        String::from_utf8(bytes).expect("text")
    }

    #[test]
    fn an_svg_has_a_path_for_each_object() {
        let text = written(DrawingFormat::Svg);
        assert!(text.contains("viewBox=\"-0.05 -0.55 1.1 2.6\""), "{text}");
        assert!(text.contains("d=\"M0 0L1 0L1 -0.5Z\"/>"), "{text}");
        assert!(
            text.contains("id=\"object-1\"") && text.contains("d=\"M0 0L0.1 2\"/>"),
            "{text}"
        );
        assert!(text.ends_with("</svg>\n"));
    }

    #[test]
    fn a_dxf_has_a_polyline_for_each_line_and_pairs_of_lines_alone() {
        let text = written(DrawingFormat::Dxf);
        assert_eq!(text.lines().count() % 2, 0);
        assert_eq!(text.matches("\nPOLYLINE\n").count(), 2);
        assert_eq!(text.matches("\nVERTEX\n").count(), 5);
        assert!(text.contains("10\n0.1\n20\n-2.0\n"), "{text}");
        assert!(text.contains("70\n1\n0\nVERTEX\n8\nOBJECT_0\n"), "{text}");
        assert!(text.starts_with("0\nSECTION\n2\nENTITIES\n") && text.ends_with("0\nEOF\n"));
    }

    #[test]
    fn a_section_without_lines_makes_an_empty_drawing() {
        let axes = SectionAxes {
            right: DVec3::X,
            up: DVec3::Y,
        };
        for format in [DrawingFormat::Svg, DrawingFormat::Dxf] {
            let mut bytes = Vec::new();
            write_section(&[], &axes, format, &mut bytes).expect("written");
            let text = String::from_utf8(bytes).expect("text");
            assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        }
        assert_eq!(
            DrawingFormat::from_name("a.b.SVG"),
            Some(DrawingFormat::Svg)
        );
        assert_eq!(DrawingFormat::from_name("svg"), None);
    }
}
