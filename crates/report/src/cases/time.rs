//! Scenes that take other kernels, or took this one, time without bound, each with as many ordinary triangles in the
//! same place: both should take about the same time.

mod hunted;
mod scene_pair;
mod scenes;

use super::{Case, CaseTheme, Setting};
use crate::cameras::PROJECTIONS;
pub use hunted::hunted;
pub use scene_pair::{ScenePair, SceneView};
use scenes::{
    about_eye, between_layers, closer_than_roundings, coincident, cone, crossing_layers, exponents,
    far_fan, far_part, far_vertex, flat_disc, inside_needle, integer_plane, mesh_copies,
    next_to_discs, next_to_fan, next_to_grid_plane, next_to_layers, next_to_planes,
    next_to_tilted_layers, next_to_vertex, one_plane, ray_plane, rounded_layers, rounded_plane,
    roundings_apart, shared_edge, shared_plane, shared_vertex, subnormal_layers, thin_boxes,
    tilted_layers, tiny_and_far,
};

/// The greatest ratio that the times of hostile and of ordinary triangles should have.
pub const SLOWDOWN_GOAL: f64 = 20.0;

/// A case of the theme `Time`, and the scenes whose times are compared.
#[derive(Clone, Copy, Debug)]
pub struct TimedCase {
    /// The case's name.
    pub name: &'static str,
    /// Makes the scenes.
    pub scenes: fn() -> ScenePair,
}

const fn timed(name: &'static str, scenes: fn() -> ScenePair) -> TimedCase {
    TimedCase { name, scenes }
}

/// All timed cases; those that come near [`SLOWDOWN_GOAL`] say why.
pub const TIMED_CASES: &[TimedCase] = &[
    timed("eye_at_a_cones_apex", cone),
    timed("eye_at_a_vertex_of_many", shared_vertex),
    timed("eye_on_an_edge_of_many", shared_edge),
    timed("eye_in_planes_of_many", shared_plane),
    timed("eye_next_to_a_vertex_of_many", next_to_vertex),
    timed("coincident_triangles", coincident),
    timed("copies_of_a_mesh", mesh_copies),
    // Every triangle is set up twice, and hardly any occludes another.
    timed("exponents_of_any_size", exponents),
    timed("eye_among_triangles_of_any_size", about_eye),
    // Along the silhouette of the first box cells of rays are not covered, and go through all boxes behind it.
    timed("thin_boxes_behind_one_another", thin_boxes),
    // Single precision does not tell the front from the back: each ray decides between the two.
    timed("tiny_and_far", tiny_and_far),
    timed("rays_closer_than_roundings", closer_than_roundings),
    timed("rays_roundings_apart_at_an_edge", roundings_apart),
    timed("triangles_about_a_corner_from_far_away", far_fan),
    timed("part_of_a_scene_from_far_away", far_part),
    timed("layers_in_one_plane", one_plane),
    timed("layers_a_rounding_apart", rounded_layers),
    timed("layers_apart_by_subnormal_numbers", subnormal_layers),
    timed("eye_next_to_a_corner_of_layers", next_to_layers),
    timed(
        "eye_at_a_vertex_of_thousands_far_from_the_origin",
        far_vertex,
    ),
    timed("eye_between_layers", between_layers),
    timed("eye_a_subnormal_number_from_planes", next_to_planes),
    timed("rays_through_edges_of_one_plane", integer_plane),
    timed("triangles_of_a_rounded_plane", rounded_plane),
    // Every two of them cross: each is ordered with what covers a cell by the planes of the two.
    timed("layers_that_cross_by_subnormal_numbers", crossing_layers),
    // Half of the rays of each cell start behind the plane: nothing covers it.
    timed("rays_that_start_in_a_plane", ray_plane),
    timed("eye_next_to_a_vertex_of_thousands", next_to_fan),
    // Each layer is nearer than the one before.
    timed("eye_next_to_a_vertex_of_layers", next_to_discs),
    timed("eye_next_to_thousands_of_one_plane", next_to_grid_plane),
    timed("eye_in_a_needle", inside_needle),
    timed("eye_in_a_flat_disc", flat_disc),
    // Double-double arithmetic orders none of them: their distances from each other's planes are computed in integers.
    timed(
        "layers_of_a_tilted_plane_apart_by_subnormal_numbers",
        tilted_layers,
    ),
    timed(
        "eye_next_to_layers_of_a_tilted_plane",
        next_to_tilted_layers,
    ),
];

macro_rules! case {
    ($name:literal, $scenes:ident, $size:expr, $difficulty:literal) => {
        Case {
            name: $name,
            theme: CaseTheme::Time,
            difficulty: $difficulty,
            variants: 2,
            setting: |variant| setting(variant, $scenes(), $size),
        }
    };
}

pub(super) const CASES: &[Case] = &[
    case!(
        "eye_at_a_cones_apex",
        cone,
        (48, 36),
        "The eye exactly at the apex of a cone of 64 triangles: every ray asks each of them by exact arithmetic."
    ),
    case!(
        "eye_at_a_vertex_of_many",
        shared_vertex,
        (48, 36),
        "The eye at a vertex that 12 random triangles share."
    ),
    case!(
        "eye_on_an_edge_of_many",
        shared_edge,
        (48, 36),
        "The eye on an edge that 12 random triangles share."
    ),
    case!(
        "eye_in_planes_of_many",
        shared_plane,
        (48, 36),
        "The eye in the planes of faces that fill the picture."
    ),
    case!(
        "eye_next_to_a_vertex_of_many",
        next_to_vertex,
        (48, 36),
        "The eye a rounding away from a vertex that 12 random triangles share."
    ),
    case!(
        "coincident_triangles",
        coincident,
        (6, 4),
        "20,000 triangles in one place: each ray tells all of them apart."
    ),
    case!(
        "copies_of_a_mesh",
        mesh_copies,
        (6, 4),
        "1,000 copies of one mesh in one place."
    ),
    case!(
        "exponents_of_any_size",
        exponents,
        (16, 12),
        "5,000 triangles whose coordinates have random exponents of ±18: no bound that goes by the largest says anything."
    ),
    case!(
        "eye_among_triangles_of_any_size",
        about_eye,
        (16, 12),
        "6,000 triangles with corners all about the eye, 1e-12 to 1e12 from it: each packet's frustum meets the boxes of all, and their corners have no places in it."
    ),
    case!(
        "thin_boxes_behind_one_another",
        thin_boxes,
        (24, 18),
        "360,000 triangles of thin boxes behind one another: layers that roundings do not tell apart."
    ),
    case!(
        "tiny_and_far",
        tiny_and_far,
        (24, 18),
        "A sphere some 1e-11 of its distance across: single precision sees all its triangles in every ray."
    ),
    case!(
        "rays_closer_than_roundings",
        closer_than_roundings,
        (24, 18),
        "A sphere some 1e-15 of its distance across: rays' directions are rounded by more than they differ."
    ),
    case!(
        "rays_roundings_apart_at_an_edge",
        roundings_apart,
        (24, 18),
        "300 triangles about an edge, next to its corner: parallel rays that are a few roundings of their origins apart."
    ),
    case!(
        "triangles_about_a_corner_from_far_away",
        far_fan,
        (24, 18),
        "6,000 large triangles about a corner, from 1e13 of their lengths away: cast alone, a ray meets most of them."
    ),
    case!(
        "part_of_a_scene_from_far_away",
        far_part,
        (24, 18),
        "A hundred-thousandth of 125 triangles whose coordinates have random exponents, from a billion of their lengths away: rays are as close together there as they are rounded."
    ),
    case!(
        "layers_in_one_plane",
        one_plane,
        (24, 18),
        "64 large triangles in one plane: a tie at every ray, and each tells all of them apart."
    ),
    case!(
        "layers_a_rounding_apart",
        rounded_layers,
        (6, 4),
        "20,000 layers some units in the last place apart: single precision leaves all of them undecided at every ray."
    ),
    case!(
        "layers_apart_by_subnormal_numbers",
        subnormal_layers,
        (24, 18),
        "2,000 triangles of one plane but for corners up to 4e-45 off it: double precision does not tell their distances apart."
    ),
    case!(
        "eye_next_to_a_corner_of_layers",
        next_to_layers,
        (24, 18),
        "The eye next to the corner that 2,000 layers share but for roundings: beside the far edge's, the edge functions of the two near edges are zero."
    ),
    case!(
        "eye_at_a_vertex_of_thousands_far_from_the_origin",
        far_vertex,
        (24, 18),
        "The eye at a vertex that 4,000 triangles share, a million units from the origin: each packet asks each of them whether its plane holds the eye, whose place relative to the tree double precision may round."
    ),
    case!(
        "eye_between_layers",
        between_layers,
        (24, 18),
        "The eye between 200 layers a rounding apart: planes next to it are closer together than double precision tells a corner's distance from them."
    ),
    case!(
        "eye_a_subnormal_number_from_planes",
        next_to_planes,
        (24, 18),
        "The eye in a plane that the corners of 4,000 triangles are in or 1e-45 beside: their inverse depths overflow single precision."
    ),
    case!(
        "rays_through_edges_of_one_plane",
        integer_plane,
        (16, 12),
        "12,000 overlapping triangles of one plane with integer corners, rays exactly through edges and corners: a ray that one edge leaves undecided may hit thousands."
    ),
    case!(
        "triangles_of_a_rounded_plane",
        rounded_plane,
        (6, 4),
        "15,000 overlapping triangles of a tilted plane, their corners rounded: each pair crosses."
    ),
    case!(
        "layers_that_cross_by_subnormal_numbers",
        crossing_layers,
        (6, 4),
        "16,000 overlapping triangles of a plane but for corners up to 2e-41 off it: each pair crosses."
    ),
    case!(
        "rays_that_start_in_a_plane",
        ray_plane,
        (6, 4),
        "12,000 overlapping triangles of the plane that orthographic rays start in but for rounding: each starts on either side, and all are left undecided."
    ),
    case!(
        "eye_next_to_a_vertex_of_thousands",
        next_to_fan,
        (24, 18),
        "The eye 3e-45 from a vertex that 4,000 triangles share: their planes pass it within all roundings, and their inverse depths overflow single precision."
    ),
    case!(
        "eye_next_to_a_vertex_of_layers",
        next_to_discs,
        (24, 18),
        "The eye 3e-45 from a vertex that 4,000 layers share, which part by 1e-12 of the distance from it."
    ),
    case!(
        "eye_next_to_thousands_of_one_plane",
        next_to_grid_plane,
        (24, 18),
        "The eye 3e-45 from a plane that 4,000 triangles with corners on a grid lie in: double precision does not tell on which side of it, or of their edges."
    ),
    case!(
        "eye_in_a_needle",
        inside_needle,
        (48, 36),
        "The eye in the middle of a needle but for rounding, which half of the rays hit: double precision gives neither the distance nor the weights of a hit to single precision."
    ),
    case!(
        "eye_in_a_flat_disc",
        flat_disc,
        (24, 18),
        "2,880 slices of a disc some 1e-15 of its width deep, from the middle of it: a ray's direction is as small across the disc as the roundings along it."
    ),
    case!(
        "layers_of_a_tilted_plane_apart_by_subnormal_numbers",
        tilted_layers,
        (6, 4),
        "8,000 overlapping triangles of a tilted plane with whole coordinates but for corners 1e-41 off it: double-double arithmetic tells none of their distances apart."
    ),
    case!(
        "eye_next_to_layers_of_a_tilted_plane",
        next_to_tilted_layers,
        (16, 12),
        "The eye 3e-45 from such a plane, and next to a corner that hundreds of its 2,000 triangles share."
    ),
];

fn setting(variant: u32, scenes: ScenePair, size: (u32, u32)) -> Setting {
    let camera = scenes
        .hostile
        .camera(PROJECTIONS[variant as usize % 2], size);
    Setting::new(scenes.hostile.scene).with_cameras([camera])
}
