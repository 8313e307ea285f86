/// What lies across the edges of a mesh's triangles: twelve bytes a triangle.
///
/// Edge k of a triangle runs from its corner k to the next one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Adjacency {
    /// By triangle number.
    across: Vec<[u32; 3]>,
}

/// What lies across one edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Across {
    /// No face: a boundary.
    Boundary,
    /// One face, whose third corner is this vertex.
    Face(u32),
    /// Several faces.
    NonManifold,
    /// The edge is the edge of no face: its triangle has two corners at one position, or is a duplicate.
    NoFace,
}

impl Across {
    const NUMBERS: [(Self, u32); 3] = [
        (Self::Boundary, u32::MAX),
        (Self::NonManifold, u32::MAX - 1),
        (Self::NoFace, u32::MAX - 2),
    ];
}

impl Adjacency {
    /// For this many triangles, none of which is a face yet.
    pub(crate) fn of(triangles: usize) -> Self {
        let [.., (_, no_face)] = Across::NUMBERS;
        Self {
            across: vec![[no_face; 3]; triangles],
        }
    }

    /// Sets what lies across an edge of a triangle.
    pub(crate) fn set(&mut self, triangle: u32, edge: usize, across: Across) {
        let known = Across::NUMBERS.iter().find(|(known, _)| *known == across);
        let number = match (known, across) {
            (Some((_, number)), _) => *number,
            (None, Across::Face(vertex)) => vertex,
            (None, _) => return,
        };
        if let Some(edges) = self.across.get_mut(triangle as usize) {
            edges[edge] = number;
        }
    }

    /// What lies across the edges of a triangle.
    pub(crate) fn on(&self, triangle: u32) -> [Across; 3] {
        let numbers = self.across.get(triangle as usize);
        numbers.map_or([Across::NoFace; 3], |numbers| {
            numbers.map(|number| {
                let known = Across::NUMBERS.iter().find(|(_, known)| *known == number);
                known.map_or(Across::Face(number), |(across, _)| *across)
            })
        })
    }
}
