//! Mapping a triangle into an image without distortion.

use glam::{DVec2, DVec3};

/// The texture coordinates of a triangle's corners when it is laid into an image of `width × height` texels: similar
/// to itself, unmirrored as seen from its front, as large as fits, centred, its longest edge (of equal ones the
/// first) along the bottom.
///
/// It fits between the centres of the outermost texels, so that no 2 × 2 filter reads beyond the image. Computed in
/// double precision from corners scaled to −1 to 1: coordinates are accurate to some 2⁻⁴⁸ of the image. A triangle
/// whose corners coincide lies in the image's middle, one without height along its middle row.
pub(in crate::shade) fn laid(corners: [DVec3; 3], width: u32, height: u32) -> [DVec2; 3] {
    let [a, b, c] = corners;
    let largest = [b - a, c - b, a - c]
        .iter()
        .fold(0.0, |largest: f64, edge| {
            largest.max(edge.abs().max_element())
        });
    let (width, height) = (f64::from(width), f64::from(height));
    let room = DVec2::new(width - 1.0, height - 1.0);
    // In units of the longest extent along an axis, so that squares stay in range.
    let edges = [b - a, c - b, a - c].map(|edge| edge / largest);
    let lengths = edges.map(|edge| edge.length());
    if !(largest > 0.0 && lengths.iter().all(|length| length.is_finite())) {
        return [DVec2::splat(0.5); 3];
    }
    let first = (0..3).fold(
        0,
        |best, i| if lengths[i] > lengths[best] { i } else { best },
    );
    let length = lengths[first];
    let along = edges[first] / length;
    // From the bottom's left end to the apex.
    let side = -edges[(first + 2) % 3];
    let x = side.dot(along).clamp(0.0, length);
    let y = along.cross(side).length();
    let scale = (room.x / length).min(if y > 0.0 { room.y / y } else { f64::INFINITY });
    let corner = (DVec2::new(width, height) - DVec2::new(length, y) * scale) * 0.5;
    let place = |x: f64, y: f64| (corner + DVec2::new(x, y) * scale) / DVec2::new(width, height);
    let mut laid = [DVec2::ZERO; 3];
    laid[first] = place(0.0, 0.0);
    laid[(first + 1) % 3] = place(length, 0.0);
    laid[(first + 2) % 3] = place(x, y);
    laid
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn the_shape_is_kept_and_touches_two_opposite_sides() {
        let mut random = Random(7);
        for i in 0..1000 {
            // Over many decades, and images wide and high.
            let scale = 10f64.powi(i % 37 - 18);
            let corners: [DVec3; 3] = std::array::from_fn(|_| random.point() * scale);
            let (width, height) = [(300, 200), (64, 512), (2, 2)][i as usize % 3];
            let size = DVec2::new(width.into(), height.into());
            let laid = laid(corners, width, height).map(|uv| uv * size);
            let [a, b, c] = corners;
            let true_edges = [b - a, c - b, a - c].map(|edge| edge.length());
            let edges = [laid[1] - laid[0], laid[2] - laid[1], laid[0] - laid[2]];
            let ratios: [f64; 3] = std::array::from_fn(|i| edges[i].length() / true_edges[i]);
            for ratio in ratios {
                assert!((ratio / ratios[0] - 1.0).abs() < 1e-9, "{ratios:?}");
            }
            // Counter-clockwise stays counter-clockwise.
            assert!(edges[0].perp_dot(edges[1]) > 0.0);
            let low = laid[0].min(laid[1]).min(laid[2]);
            let high = laid[0].max(laid[1]).max(laid[2]);
            let room = size - 1.0;
            assert!(low.min_element() > 0.5 - 1e-9 && (high - size + 0.5).max_element() < 1e-9);
            let touches = (high - low - room).abs();
            assert!(touches.min_element() < 1e-9 * size.max_element());
        }
    }

    #[test]
    fn the_longest_edge_is_the_bottom() {
        let corners = [DVec3::X * 4.0, DVec3::new(1.0, 2.0, 0.0), DVec3::ZERO];
        // 9 × 9 texels have a distance of 8 between the outermost centres; a width of 4 becomes 8.
        let laid = laid(corners, 9, 9).map(|uv| uv * 9.0);
        let expected = [(8.5, 2.5), (2.5, 6.5), (0.5, 2.5)].map(|(x, y)| DVec2::new(x, y));
        for (found, expected) in laid.iter().zip(expected) {
            assert!((*found - expected).length() < 1e-12, "{laid:?}");
        }
    }

    #[test]
    fn triangles_without_area_are_laid_into_the_image() {
        let middle = [DVec2::splat(0.5); 3];
        assert_eq!(laid([DVec3::ONE; 3], 10, 10), middle);
        let nan = [DVec3::NAN, DVec3::X, DVec3::Y];
        assert_eq!(laid(nan, 10, 10), middle);
        let line = laid([DVec3::ZERO, DVec3::X, DVec3::X * 2.0], 10, 10);
        assert!(line.iter().all(|uv| uv.y == 0.5), "{line:?}");
        let texel = laid([DVec3::ZERO, DVec3::X, DVec3::Y], 1, 1);
        assert_eq!(texel, middle);
    }
}
