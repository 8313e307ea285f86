//! Connected faces, and their relative orientation.

/// Disjoint sets of faces (Tarjan, "Efficiency of a good but not linear set union algorithm", 1975), with each face's
/// orientation relative to the root of its set.
pub(super) struct Sets {
    root: Vec<u32>,
    /// Whether a face is oriented against the face that it points to.
    turned: Vec<bool>,
    size: Vec<u32>,
}

impl Sets {
    pub(super) fn new(faces: usize) -> Self {
        Self {
            root: (0..faces as u32).collect(),
            turned: vec![false; faces],
            size: vec![1; faces],
        }
    }

    /// The root of a face's set, and whether the face is oriented against it.
    pub(super) fn find(&mut self, face: u32) -> (u32, bool) {
        let (mut root, mut turned) = (face, false);
        while self.root[root as usize] != root {
            turned ^= self.turned[root as usize];
            root = self.root[root as usize];
        }
        // Path compression: all faces on the way point to the root from now on.
        let (mut at, mut left) = (face, turned);
        while at != root {
            let i = at as usize;
            let next = self.root[i];
            let own = std::mem::replace(&mut self.turned[i], left);
            self.root[i] = root;
            left ^= own;
            at = next;
        }
        (root, turned)
    }

    /// Joins the sets of two faces that are oriented against one another if `turned`. Returns `false` where they are
    /// in one set already, with the other relative orientation.
    pub(super) fn join(&mut self, a: u32, b: u32, turned: bool) -> bool {
        let ((a, a_turned), (b, b_turned)) = (self.find(a), self.find(b));
        let between = a_turned ^ b_turned ^ turned;
        if a == b {
            return !between;
        }
        let (small, large) = match self.size[a as usize] < self.size[b as usize] {
            true => (a, b),
            false => (b, a),
        };
        self.root[small as usize] = large;
        self.turned[small as usize] = between;
        self.size[large as usize] += self.size[small as usize];
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orientations_compose_along_a_chain_and_a_twist_is_rejected() {
        let mut sets = Sets::new(6);
        assert!(sets.join(0, 1, true));
        assert!(sets.join(2, 3, true));
        assert!(sets.join(1, 2, false));
        let turns: Vec<bool> = (0..4).map(|face| sets.find(face).1).collect();
        let relative: Vec<bool> = turns.iter().map(|turned| turned ^ turns[0]).collect();
        assert_eq!(relative, [false, true, true, false]);
        assert!(sets.join(3, 0, false), "round and back");
        assert!(!sets.join(3, 0, true), "a band with one side");
        assert_ne!(sets.find(4).0, sets.find(5).0);
    }
}
