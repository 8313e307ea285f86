//! The first word of an OFF.

/// What a vertex may have besides its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum VertexAttribute {
    Normal,
    Color,
    Uv,
}

/// The first word of an OFF, which declares what vertices have: `[ST][C][N][4][n]OFF`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Keyword {
    /// In the order of the numbers, which is from the word's end to its start. Geomview's words have normals first;
    /// MeshLab writes `NCOFF`, with colours first.
    pub(super) attributes: Vec<VertexAttribute>,
    /// Four coordinates a vertex, or a number of them that the file gives: not a three-dimensional space.
    pub(super) other_space: bool,
}

impl Keyword {
    pub(super) fn parse(word: &[u8]) -> Option<Self> {
        let mut rest = word.strip_suffix(b"OFF")?;
        let mut keyword = Self::default();
        while let Some((last, before)) = rest.split_last() {
            rest = before;
            let attribute = match last {
                b'N' => VertexAttribute::Normal,
                b'C' => VertexAttribute::Color,
                b'T' => {
                    rest = rest.strip_suffix(b"S")?;
                    VertexAttribute::Uv
                }
                b'4' | b'n' => {
                    keyword.other_space = true;
                    continue;
                }
                _ => return None,
            };
            if keyword.attributes.contains(&attribute) {
                return None;
            }
            keyword.attributes.push(attribute);
        }
        Some(keyword)
    }

    pub(super) fn has(&self, attribute: VertexAttribute) -> bool {
        self.attributes.contains(&attribute)
    }
}
