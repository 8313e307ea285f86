use super::curvature::{Curvatures, curvatures};
use super::measures::without_outliers;
use super::{Curvature, Mesh, Quantity, Scalar, ScalarAt};

/// The values of a quantity on a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TriangleValues {
    /// One for the whole triangle.
    One(f32),
    /// One at each corner.
    Corners([f32; 3]),
}

impl Mesh {
    /// The file's scalars of vertices and triangles.
    pub fn scalars(&self) -> &[Scalar] {
        &self.measures().scalars
    }

    /// The scalar of this name.
    pub fn scalar(&self, name: &str) -> Option<&Scalar> {
        self.scalars().iter().find(|scalar| scalar.name == name)
    }

    /// A triangle's area in the mesh's own coordinates, rounded to single precision; NaN where the triangle does not
    /// exist.
    pub fn area(&self, triangle: u32) -> f32 {
        let Some(corners) = self.corners(triangle) else {
            return f32::NAN;
        };
        let [a, b, c] = corners.map(|corner| corner.as_dvec3());
        ((b - a).cross(c - a).length() * 0.5) as f32
    }

    /// The values of a quantity on a triangle. `None` where the mesh lacks it, and for [`Quantity::Distance`], which
    /// depends on the mesh's transform.
    pub fn values(&self, quantity: &Quantity, triangle: u32) -> Option<TriangleValues> {
        let at_corners = |values: &[f32]| {
            let vertices = self.triangles().get(triangle as usize)?;
            let [a, b, c] = vertices.map(|vertex| values.get(vertex as usize).copied());
            Some(TriangleValues::Corners([a?, b?, c?]))
        };
        match quantity {
            Quantity::Distance(_) => None,
            Quantity::Area => Some(TriangleValues::One(self.area(triangle))),
            Quantity::Curvature(Curvature::Mean) => at_corners(&self.curvatures().mean),
            Quantity::Curvature(Curvature::Gaussian) => at_corners(&self.curvatures().gaussian),
            Quantity::Scalar(name) => {
                let scalar = self.scalar(name)?;
                match scalar.at {
                    ScalarAt::Vertices => at_corners(&scalar.values),
                    ScalarAt::Triangles => {
                        let value = scalar.values.get(triangle as usize);
                        value.map(|value| TriangleValues::One(*value))
                    }
                }
            }
        }
    }

    /// The range that colours are fitted to: all finite values of a scalar; areas and curvatures without the fraction
    /// [`OUTLIERS`](super::OUTLIERS) at each end. `None` where [`Mesh::values`] gives `None`, and where there are no
    /// values.
    pub fn value_range(&self, quantity: &Quantity) -> Option<[f32; 2]> {
        let measures = self.measures();
        match quantity {
            Quantity::Distance(_) => None,
            Quantity::Area => *measures.area_range.get_or_init(|| {
                let areas = self.kept().iter().map(|&number| self.area(number));
                without_outliers(areas.collect())
            }),
            Quantity::Curvature(kind) => {
                let ranges = measures.curvature_ranges.get_or_init(|| {
                    let Curvatures { mean, gaussian } = self.curvatures();
                    [mean, gaussian].map(|values| {
                        let finite = values.iter().copied().filter(|value| value.is_finite());
                        without_outliers(finite.collect())
                    })
                });
                match kind {
                    Curvature::Mean => ranges[0],
                    Curvature::Gaussian => ranges[1],
                }
            }
            Quantity::Scalar(name) => {
                let index = self.scalars().iter().position(|s| s.name == **name)?;
                let ranges = measures.scalar_ranges.get_or_init(|| {
                    let scalars = self.scalars().iter();
                    scalars.map(Scalar::range).collect()
                });
                ranges[index]
            }
        }
    }

    /// Whether [`Mesh::values`] gives an answer without computing curvatures first.
    pub fn knows_values(&self, quantity: &Quantity) -> bool {
        match quantity {
            Quantity::Curvature(_) => self.measures().curvatures.get().is_some(),
            Quantity::Distance(_) | Quantity::Area | Quantity::Scalar(_) => true,
        }
    }

    /// Whether [`Mesh::value_range`] gives an answer without visiting the whole mesh first.
    pub fn knows_range(&self, quantity: &Quantity) -> bool {
        let measures = self.measures();
        match quantity {
            Quantity::Distance(_) => true,
            Quantity::Area => measures.area_range.get().is_some(),
            Quantity::Curvature(_) => measures.curvature_ranges.get().is_some(),
            Quantity::Scalar(_) => measures.scalar_ranges.get().is_some(),
        }
    }

    fn curvatures(&self) -> &Curvatures {
        self.measures()
            .curvatures
            .get_or_init(|| curvatures(self.positions(), self.triangles(), self.kept()))
    }
}

#[cfg(test)]
mod tests {
    use super::super::MeshData;
    use super::*;
    use glam::DVec3;

    #[test]
    fn areas_and_scalars_have_their_values_and_ranges() {
        // Right triangles with legs of 1 and i + 1.
        let count = 101;
        let positions = (0..count)
            .flat_map(|i| [DVec3::ZERO, DVec3::X, DVec3::Y * f64::from(i + 1)])
            .collect();
        let mesh = Mesh::new(MeshData {
            positions,
            triangles: (0..count as u32)
                .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
                .collect(),
            scalars: vec![
                Scalar {
                    name: "height".to_owned(),
                    at: ScalarAt::Vertices,
                    values: (0..3 * count).map(|i| i as f32).collect(),
                },
                Scalar {
                    name: "part".to_owned(),
                    at: ScalarAt::Triangles,
                    values: vec![7.0; count as usize],
                },
            ],
            ..MeshData::default()
        });
        assert_eq!(mesh.area(9), 5.0);
        assert!(mesh.area(1000).is_nan());
        // Areas are 0.5 to 50.5; 2 of 101 at each end are left out.
        assert_eq!(mesh.value_range(&Quantity::Area), Some([1.5, 49.5]));
        let height = Quantity::Scalar("height".into());
        assert_eq!(
            mesh.values(&height, 1),
            Some(TriangleValues::Corners([3.0, 4.0, 5.0]))
        );
        assert_eq!(mesh.value_range(&height), Some([0.0, 302.0]));
        let part = Quantity::Scalar("part".into());
        assert_eq!(mesh.values(&part, 1), Some(TriangleValues::One(7.0)));
        assert_eq!(mesh.values(&Quantity::Scalar("none".into()), 1), None);
        assert_eq!(mesh.values(&part, 1000), None);
        assert_eq!(mesh.value_range(&Quantity::Distance(None)), None);
    }
}
