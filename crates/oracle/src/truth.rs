//! The exact hit of a ray.

/// How a ray hits a triangle, by exact arithmetic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// The object's number.
    pub object: u32,
    /// The triangle's number in its object.
    pub triangle: u32,
    /// The ray's parameter, as the nearest double.
    pub t: f64,
    /// Weight of the second corner, as the nearest double.
    pub u: f64,
    /// Weight of the third corner, as the nearest double.
    pub v: f64,
    /// The cosine between the ray and the triangle's normal, 0 to 1 (rounded).
    pub cosine: f64,
}
