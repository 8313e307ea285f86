//! Names of the modes.

use raycast_core::shade::Mode;

/// The modes in the order of their keys, Alt+1 to Alt+9, Alt+0 and Alt+X, with name and description.
pub const MODES: [(Mode, &str, &str); 11] = [
    (Mode::Color, "Colors", "The triangles' own colors, unlit"),
    (Mode::Flat, "Flat", "Lit, one brightness a triangle"),
    (
        Mode::Smooth,
        "Smooth",
        "Lit, with the mesh's own normals where it has them",
    ),
    (
        Mode::Normals,
        "Normals",
        "Directions of the surface: x red, y green, z blue",
    ),
    (Mode::Depth, "Depth", "Distance: near is light, far is dark"),
    (
        Mode::Barycentric,
        "Barycentric",
        "The weights of a triangle's corners as red, green, blue",
    ),
    (Mode::Uv, "UV", "Texture coordinates as red and green"),
    (Mode::Texture, "Texture", "The texture, unlit"),
    (
        Mode::Wireframe,
        "Lines only",
        "Edges alone; what is hidden is left out",
    ),
    (
        Mode::Material,
        "Material",
        "Lit, as metals and dielectrics of the file's roughness are",
    ),
    (
        Mode::XRay,
        "X-ray",
        "All layers, each faint, the nearest over those behind it",
    ),
];
