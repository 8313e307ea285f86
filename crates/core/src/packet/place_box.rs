/// A box of places in a packet: the bounds of a triangle, of a cell or of a row of rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaceBox {
    pub(super) left: f32,
    pub(super) right: f32,
    pub(super) top: f32,
    pub(super) bottom: f32,
}

impl PlaceBox {
    /// The box without places.
    pub(super) const EMPTY: Self = Self {
        left: f32::INFINITY,
        right: f32::NEG_INFINITY,
        top: f32::INFINITY,
        bottom: f32::NEG_INFINITY,
    };
}
