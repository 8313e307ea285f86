/// The closest triangle that a ray hits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The object's number.
    pub object: u32,
    /// The triangle's number in its object's mesh.
    pub triangle: u32,
    /// The ray's parameter: the distance in lengths of the ray's direction.
    pub t: f64,
    /// Barycentric weight of the triangle's second corner, 0 to 1.
    pub u: f64,
    /// Weight of the third corner, 0 to 1: the point is `(1−u−v)·a + u·b + v·c`.
    pub v: f64,
}

/// Which faces rays hit. A face is a front where its corners run counter-clockwise as the ray sees them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cull {
    /// Fronts and backs.
    #[default]
    None,
    /// Fronts only.
    Back,
}

/// How a ray against a triangle is decided where the error bounds of double precision leave it undecided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Rounded arithmetic: where double precision leaves a ray undecided (within some 1e-15 of an edge, or of another
    /// surface's depth), the rounded signs decide, and a neighbouring triangle may be shown.
    Fast,
    /// Exact arithmetic.
    #[default]
    Exact,
}

/// Which numbers of a hit are needed; the others cost nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Detail {
    /// Which triangle is hit; t, u and v are unspecified.
    Triangle,
    /// The triangle, and t, u and v.
    #[default]
    Full,
}

/// Which of a hit's numbers are interpolated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum HitNumbers {
    /// t alone.
    T,
    /// u and v alone.
    Weights,
    /// All.
    All,
}

/// Stands in place of a primitive index where a ray hits nothing.
pub const MISS: u32 = u32::MAX;

/// A closest hit in single precision, as loops over many rays store it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrimitiveHit {
    /// The triangle's primitive index, or [`MISS`].
    pub primitive: u32,
    /// The ray's parameter; infinity at a miss.
    pub t: f32,
    /// Weight of the second corner.
    pub u: f32,
    /// Weight of the third corner.
    pub v: f32,
}

impl PrimitiveHit {
    /// A ray that hits nothing.
    pub const NONE: Self = Self {
        primitive: MISS,
        t: f32::INFINITY,
        u: 0.0,
        v: 0.0,
    };

    /// Whether the ray hits nothing.
    pub fn is_miss(&self) -> bool {
        self.primitive == MISS
    }
}
