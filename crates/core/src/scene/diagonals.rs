/// The edges along which a file's polygons were triangulated: three bits a triangle, if the file has polygons.
///
/// Edge k of a triangle runs from its corner k to the next one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Diagonals {
    words: Vec<u64>,
}

/// Triangles in a 64-bit word.
const A_WORD: usize = 21;

impl Diagonals {
    /// For this many triangles; no edge is a diagonal.
    pub(crate) fn of(triangles: usize) -> Self {
        Self {
            words: vec![0; triangles.div_ceil(A_WORD)],
        }
    }

    /// Sets which edges of a triangle are diagonals. Out of range it does nothing.
    pub(crate) fn set(&mut self, triangle: usize, edges: [bool; 3]) {
        if let Some(word) = self.words.get_mut(triangle / A_WORD) {
            let shift = triangle % A_WORD * 3;
            let bits = edges
                .iter()
                .rev()
                .fold(0, |bits, &is| bits << 1 | u64::from(is));
            *word = *word & !(7 << shift) | bits << shift;
        }
    }

    /// Which edges of a triangle are diagonals; none out of range.
    pub fn on(&self, triangle: u32) -> [bool; 3] {
        let triangle = triangle as usize;
        let word = self.words.get(triangle / A_WORD).copied().unwrap_or(0);
        let bits = word >> (triangle % A_WORD * 3);
        [bits & 1 != 0, bits & 2 != 0, bits & 4 != 0]
    }

    /// Whether no polygon was triangulated.
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// The bits, as files store them.
    pub(crate) fn words(&self) -> &[u64] {
        &self.words
    }

    /// From stored bits; `None` where their number does not fit the number of triangles.
    pub(crate) fn from_words(words: Vec<u64>, triangles: usize) -> Option<Self> {
        let is_whole = words.is_empty() || words.len() == triangles.div_ceil(A_WORD);
        is_whole.then_some(Self { words })
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.words[..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_triangle_keeps_its_own_bits() {
        let of = |i: usize| [2, 3, 5].map(|n| i.is_multiple_of(n));
        let mut diagonals = Diagonals::of(100);
        for triangle in 0..100 {
            diagonals.set(triangle, [true; 3]);
            diagonals.set(triangle, of(triangle));
        }
        assert!((0..100).all(|i| diagonals.on(i as u32) == of(i)));
        assert_eq!(diagonals.bytes(), 40);
        // Out of range there is nothing to set.
        diagonals.set(105, [true; 3]);
        assert_eq!(diagonals.on(105), [false; 3]);
        assert!(Diagonals::default().is_empty() && !diagonals.is_empty());
    }
}
