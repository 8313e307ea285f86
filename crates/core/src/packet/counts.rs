/// Statistics of casting a lattice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CastCounts {
    /// Rays that hit something.
    pub hits: u64,
    /// Nodes whose children's boxes were tested.
    pub nodes: u64,
    /// Triangles tested against a packet's rays, counted once a packet: those set up, and small ones merged without
    /// set-up.
    pub triangles: u64,
    /// Rays that packets left undecided and the single ray decided in double precision.
    pub double_rays: u64,
    /// Rays for which it needed exact arithmetic.
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
