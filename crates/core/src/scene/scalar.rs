/// A named number that a file gives each vertex or each triangle.
#[derive(Clone, Debug, PartialEq)]
pub struct Scalar {
    /// The file's name for it.
    pub name: String,
    /// Whether vertices or triangles have it.
    pub at: ScalarAt,
    /// The values in order of vertices or triangles, in single precision; NaN where there is none.
    pub values: Vec<f32>,
}

/// What a [`Scalar`]'s values belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScalarAt {
    /// Vertices: between them values are interpolated.
    Vertices,
    /// Triangles: the value is constant on each.
    Triangles,
}

impl Scalar {
    /// The least and the greatest finite value; `None` where none is finite.
    pub fn range(&self) -> Option<[f32; 2]> {
        let finite = self.values.iter().filter(|value| value.is_finite());
        finite.fold(None, |range, &value| {
            let [low, high] = range.unwrap_or([value; 2]);
            Some([low.min(value), high.max(value)])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_range_is_that_of_finite_values() {
        let scalar = |values: &[f32]| Scalar {
            name: "s".to_owned(),
            at: ScalarAt::Vertices,
            values: values.to_vec(),
        };
        let range = scalar(&[f32::NAN, 2.0, -1.0, f32::INFINITY]).range();
        assert_eq!(range, Some([-1.0, 2.0]));
        assert_eq!(scalar(&[]).range(), None);
        assert_eq!(scalar(&[f32::NAN]).range(), None);
    }
}
