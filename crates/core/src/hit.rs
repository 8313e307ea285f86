/// The nearest triangle that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The object's number.
    pub object: u32,
    /// The triangle's number in its object's mesh.
    pub triangle: u32,
    /// The ray's parameter there: the distance, in lengths of the ray's direction.
    pub t: f64,
    /// Weight of the triangle's second corner, 0 to 1.
    pub u: f64,
    /// Weight of the triangle's third corner, 0 to 1: the point is `(1−u−v)·a + u·b + v·c`.
    pub v: f64,
}

/// Which faces rays meet. A face is a front where its corners run counter-clockwise to the ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cull {
    /// Fronts and backs.
    #[default]
    None,
    /// Fronts alone.
    Back,
}

/// How sure a picture's triangles are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Rounded arithmetic alone: where doubles cannot tell (a ray within some 1e-15 of an edge or of
    /// another surface's depth), their rounding decides, and a neighbouring triangle may be shown.
    Fast,
    /// What exact arithmetic gives.
    #[default]
    Exact,
}

/// How much is wanted of a hit: what is not asked for costs nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Detail {
    /// Which triangle; parameter and weights may be anything.
    Triangle,
    /// Parameter and weights too.
    #[default]
    Full,
}

/// Marks a ray that meets nothing, in place of a triangle's slot.
pub const MISS: u32 = u32::MAX;

/// A nearest hit as the casting loops store it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlotHit {
    /// The triangle's place in leaf order, or [`MISS`].
    pub slot: u32,
    /// The ray's parameter; infinity at a miss.
    pub t: f32,
    /// Weight of the second corner.
    pub u: f32,
    /// Weight of the third corner.
    pub v: f32,
}

impl SlotHit {
    /// A ray that meets nothing.
    pub const NONE: Self = Self {
        slot: MISS,
        t: f32::INFINITY,
        u: 0.0,
        v: 0.0,
    };

    /// Whether the ray meets nothing.
    pub fn is_miss(&self) -> bool {
        self.slot == MISS
    }
}
