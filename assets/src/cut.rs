//! Makes a shell finer where it bends, and cuts it along curves, so that a colour's border is a
//! smooth line and not a staircase.

use std::collections::HashMap;

use glam::DVec3;

use crate::field::{gradient, onto_surface};
use crate::surface_nets::HalfShell;

/// A vertex nearer to the curve than this part of an edge that crosses it is moved onto it, as
/// cutting the edge there would leave a sliver.
const SNAP: f64 = 0.3;

/// Halves the edges of `shell` that `coarse` holds for, and puts their middles onto the surface of
/// `solid`.
pub(crate) fn refine(
    shell: &mut HalfShell,
    solid: impl Fn(DVec3) -> f64,
    coarse: impl Fn(DVec3, DVec3) -> bool,
) {
    let mut middles = HashMap::new();
    for &(triangle, _) in &shell.triangles {
        for (a, b) in edges(triangle).map(|(a, b)| (a.min(b), a.max(b))) {
            middles.entry((a, b)).or_insert_with(|| {
                let (start, end) = (shell.positions[a], shell.positions[b]);
                coarse(start, end).then(|| {
                    let reach = start.distance(end) / 4.0;
                    let mut p = onto_surface(&solid, start.midpoint(end), reach);
                    if start.x == 0.0 && end.x == 0.0 {
                        p.x = 0.0;
                    }
                    shell.positions.push(p);
                    shell.positions.len() - 1
                })
            });
        }
    }
    for (triangle, material) in std::mem::take(&mut shell.triangles) {
        let middle = edges(triangle).map(|(a, b)| middles[&(a.min(b), a.max(b))]);
        let mut push = |triangle| shell.triangles.push((triangle, material));
        // Turned so that the edges without a middle come last.
        let turn = match middle.map(|m| m.is_some()) {
            [false, true, false] | [false, true, true] => 1,
            [false, false, true] | [true, false, true] => 2,
            _ => 0,
        };
        let [a, b, c] = [0, 1, 2].map(|i| triangle[(i + turn) % 3]);
        match [0, 1, 2].map(|i| middle[(i + turn) % 3]) {
            [Some(ab), Some(bc), Some(ca)] => {
                for triangle in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
                    push(triangle);
                }
            }
            [Some(ab), Some(bc), None] => {
                push([ab, b, bc]);
                fill(&[a, ab, bc, c], &shell.positions, push);
            }
            [Some(ab), ..] => {
                push([a, ab, c]);
                push([ab, b, c]);
            }
            _ => push([a, b, c]),
        }
    }
}

/// Splits the triangles of `shell`, which lies on the surface of `solid`, along the zeros of
/// `region`, and gives those inside (negative) the material `inside` where `from` holds for theirs.
pub(crate) fn cut(
    shell: &mut HalfShell,
    solid: impl Fn(DVec3) -> f64,
    region: impl Fn(DVec3) -> f64,
    from: impl Fn(usize) -> bool,
    inside: usize,
) {
    let mut sides: Vec<f64> = shell.positions.iter().map(|&p| region(p)).collect();

    // The longest edge by which each vertex reaches across the curve.
    let mut reach = vec![0.0f64; sides.len()];
    let mut triangles_of = vec![Vec::new(); sides.len()];
    for &(triangle, material) in &shell.triangles {
        for (a, b) in edges(triangle) {
            triangles_of[a].push(triangle);
            if from(material) && sides[a] * sides[b] < 0.0 {
                let length = shell.positions[a].distance(shell.positions[b]);
                reach[a] = reach[a].max(length);
                reach[b] = reach[b].max(length);
            }
        }
    }
    for (vertex, reach) in reach.into_iter().enumerate() {
        let p = shell.positions[vertex];
        // A triangle with all its vertices on the curve would be next to nothing.
        let flattens = |t: &[usize; 3]| t.iter().all(|&v| v == vertex || sides[v] == 0.0);
        if reach > 0.0 && !triangles_of[vertex].iter().any(flattens) {
            let target = onto_curve(&solid, &region, p, p.x == 0.0);
            if target.distance(p) < SNAP * reach {
                shell.positions[vertex] = target;
                sides[vertex] = 0.0;
            }
        }
    }

    let mut vertex_of_edge = HashMap::new();
    for (triangle, material) in std::mem::take(&mut shell.triangles) {
        let crossed = edges(triangle)
            .iter()
            .any(|&(a, b)| sides[a] * sides[b] < 0.0);
        if !crossed {
            let is_inside = from(material) && triangle.iter().map(|&v| sides[v]).sum::<f64>() < 0.0;
            shell
                .triangles
                .push((triangle, if is_inside { inside } else { material }));
            continue;
        }
        // The two sides' polygons, with the curve's points in both.
        let mut polygons = [Vec::new(), Vec::new()];
        for (a, b) in edges(triangle) {
            if sides[a] <= 0.0 {
                polygons[0].push(a);
            }
            if sides[a] >= 0.0 {
                polygons[1].push(a);
            }
            if sides[a] * sides[b] < 0.0 {
                let split = *vertex_of_edge
                    .entry((a.min(b), a.max(b)))
                    .or_insert_with(|| {
                        let (start, end) = (shell.positions[a.min(b)], shell.positions[a.max(b)]);
                        let (from, to) = (sides[a.min(b)], sides[a.max(b)]);
                        let on_seam = start.x == 0.0 && end.x == 0.0;
                        let p = start.lerp(end, from / (from - to));
                        shell
                            .positions
                            .push(onto_curve(&solid, &region, p, on_seam));
                        shell.positions.len() - 1
                    });
                polygons[0].push(split);
                polygons[1].push(split);
            }
        }
        sides.resize(shell.positions.len(), 0.0);
        for (polygon, side) in polygons.iter().zip([inside, material]) {
            let material = if from(material) { side } else { material };
            fill(polygon, &shell.positions, |triangle| {
                shell.triangles.push((triangle, material))
            });
        }
    }
}

/// A triangle, or a quad cut along its shorter diagonal.
fn fill(polygon: &[usize], positions: &[DVec3], mut push: impl FnMut([usize; 3])) {
    match *polygon {
        [a, b, c] => push([a, b, c]),
        [a, b, c, d] => {
            let square = |i: usize, j: usize| positions[i].distance_squared(positions[j]);
            if square(a, c) <= square(b, d) {
                push([a, b, c]);
                push([a, c, d]);
            } else {
                push([a, b, d]);
                push([b, c, d]);
            }
        }
        _ => unreachable!("a line cuts a triangle into triangles and quads"),
    }
}

/// The longest step on the way to the curve, shorter than any feature.
const REACH: f64 = 0.02;

/// The point near `p` where both fields are zero, by turns.
fn onto_curve(
    solid: impl Fn(DVec3) -> f64,
    region: impl Fn(DVec3) -> f64,
    mut p: DVec3,
    on_seam: bool,
) -> DVec3 {
    for _ in 0..4 {
        // Along the surface only, or the two steps would undo one another.
        let normal = gradient(&solid, p).normalize_or_zero();
        let slope = gradient(&region, p);
        let slope = slope - normal * slope.dot(normal);
        let step = slope * (region(p) / slope.length_squared().max(1e-4));
        p = onto_surface(&solid, p - step.clamp_length_max(REACH), REACH);
        if on_seam {
            p.x = 0.0;
        }
    }
    p
}

fn edges([a, b, c]: [usize; 3]) -> [(usize, usize); 3] {
    [(a, b), (b, c), (c, a)]
}
