/// What casting a lattice took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CastCounts {
    /// Rays that met something.
    pub hits: u64,
    /// Nodes of the tree whose children's boxes were tested.
    pub nodes: u64,
    /// Triangles that a block's rays were held against, counted for each block: those set up, and those
    /// of few rays that needed no set-up and that some ray met first, of what it had met by then.
    pub triangles: u64,
    /// Rays that single precision with its bounds left open, and doubles decided.
    pub double_rays: u64,
    /// Rays that doubles with their bounds left open too, decided by exact arithmetic.
    pub exact_rays: u64,
}

impl std::ops::AddAssign for CastCounts {
    fn add_assign(&mut self, other: Self) {
        self.hits += other.hits;
        self.nodes += other.nodes;
        self.triangles += other.triangles;
        self.double_rays += other.double_rays;
        self.exact_rays += other.exact_rays;
    }
}
