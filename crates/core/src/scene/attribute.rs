use std::mem::size_of;

/// Values at vertices, with indices of their own where the file stores them apart from positions.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute<T> {
    /// The values.
    pub values: Vec<T>,
    /// Three indices into `values` a triangle; `None` when positions and values share indices.
    pub indices: Option<Vec<[u32; 3]>>,
}

impl<T> Attribute<T> {
    pub(super) fn bytes(&self) -> usize {
        let indices = self.indices.as_ref().map_or(0, Vec::len);
        self.values.len() * size_of::<T>() + indices * size_of::<[u32; 3]>()
    }
}

impl<T: Copy> Attribute<T> {
    /// The values at a triangle's corners; `shared` are the indices of its positions.
    ///
    /// `None` where an index is out of range: the triangle lacks the attribute.
    pub fn corners(&self, triangle: u32, shared: [u32; 3]) -> Option<[T; 3]> {
        let indices = match &self.indices {
            Some(indices) => *indices.get(triangle as usize)?,
            None => shared,
        };
        let [a, b, c] = indices.map(|i| self.values.get(i as usize).copied());
        Some([a?, b?, c?])
    }
}
