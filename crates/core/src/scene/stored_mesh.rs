//! A mesh that was checked once and then stored in a file.

use super::measures::Measures;
use super::mesh::has_no_area;
use super::{
    Attribute, Bounds, COORDINATE_LIMIT, Color, Diagonals, Dropped, Groups, Material, Mesh,
    Rounding, Scalar, ScalarAt,
};
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::sync::OnceLock;

/// Triangles, or vertices, in one parallel task.
const CHUNK: usize = 1 << 15;

/// The fields of a [`Mesh`], unchecked: [`StoredMesh::mesh`] checks them.
#[derive(Clone, Debug, Default)]
pub(crate) struct StoredMesh {
    pub(crate) offset: DVec3,
    pub(crate) positions: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The numbers of the triangles that were dropped, ascending.
    pub(crate) dropped_numbers: Vec<u32>,
    /// How many were dropped for each reason.
    pub(crate) dropped: Dropped,
    pub(crate) normals: Option<Attribute<Vec3>>,
    pub(crate) uvs: Option<Attribute<Vec2>>,
    pub(crate) materials: Vec<Material>,
    pub(crate) material_of_triangle: Vec<u32>,
    pub(crate) colors: Vec<Option<Color>>,
    pub(crate) scalars: Vec<Scalar>,
    pub(crate) diagonals: Diagonals,
    pub(crate) groups: Groups,
    pub(crate) rounding: Rounding,
}

impl StoredMesh {
    /// Checks the fields and makes the mesh.
    ///
    /// # Errors
    /// Which field no reader of meshes would have given, in words.
    pub(crate) fn mesh(self) -> Result<Mesh, &'static str> {
        let kept = self.kept()?;
        let bounds = self.check_corners(&kept)?;
        self.check_lists()?;
        self.check_attributes()?;
        let Rounding {
            distance,
            share_of_edge,
            bent,
        } = self.rounding;
        if !(distance >= 0.0 && share_of_edge >= 0.0 && bent as usize <= kept.len()) {
            return Err("how far its corners were rounded is no distance");
        }
        Ok(Mesh {
            offset: self.offset,
            positions: self.positions,
            triangles: self.triangles,
            kept,
            dropped: self.dropped,
            normals: self.normals,
            uvs: self.uvs,
            materials: self.materials,
            material_of_triangle: self.material_of_triangle,
            colors: self.colors,
            diagonals: self.diagonals,
            groups: self.groups,
            rounding: self.rounding,
            bounds: OnceLock::from(bounds),
            adjacency: OnceLock::new(),
            measures: Measures::new(self.scalars),
            tree: None,
        })
    }

    /// The numbers of the triangles that were not dropped.
    fn kept(&self) -> Result<Vec<u32>, &'static str> {
        let count = self.triangles.len() as u32;
        let is_ascending = self.dropped_numbers.is_sorted_by(|a, b| a < b);
        if !is_ascending || self.dropped_numbers.last().is_some_and(|&n| n >= count) {
            return Err("the numbers of dropped triangles do not ascend");
        }
        let Dropped {
            not_finite,
            too_far,
            bad_index,
            zero_area,
            rounded_away,
        } = self.dropped;
        let counts = [not_finite, too_far, bad_index, zero_area, rounded_away];
        if counts.into_iter().map(u64::from).sum::<u64>() != self.dropped_numbers.len() as u64 {
            return Err("not as many triangles are dropped as there are reasons");
        }
        if self.dropped_numbers.is_empty() {
            // Threads share the work of touching new memory.
            return Ok((0..count).into_par_iter().collect());
        }
        let mut kept = Vec::with_capacity(self.triangles.len() - self.dropped_numbers.len());
        let mut next = 0;
        for &dropped in &self.dropped_numbers {
            kept.extend(next..dropped);
            next = dropped + 1;
        }
        kept.extend(next..count);
        Ok(kept)
    }

    /// Checks that the kept triangles have corners that rays can hit: existing, finite, within range, not on one
    /// line. Returns the box around them.
    fn check_corners(&self, kept: &[u32]) -> Result<Bounds, &'static str> {
        let offset = self.offset;
        if !offset.is_finite() || offset.abs().max_element() > COORDINATE_LIMIT {
            return Err("its offset is not finite or too far");
        }
        let (min, max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let around = |numbers: &[u32]| {
            let (mut least, mut most) = (min, max);
            for &number in numbers {
                let corners =
                    self.triangles[number as usize].map(|i| self.positions.get(i as usize));
                let [Some(&a), Some(&b), Some(&c)] = corners else {
                    return Err("a triangle has a corner that is not there");
                };
                if !(a.is_finite() && b.is_finite() && c.is_finite()) {
                    return Err("a triangle has a corner that is not finite");
                }
                if has_no_area(a, b, c) {
                    return Err("a triangle has no area");
                }
                least = least.min(a).min(b).min(c);
                most = most.max(a).max(b).max(c);
            }
            Ok((least, most))
        };
        let (min, max) = kept
            .par_chunks(CHUNK)
            .map(around)
            .try_reduce(|| (min, max), |(a, b), (c, d)| Ok((a.min(c), b.max(d))))?;
        if kept.is_empty() {
            return Ok(Bounds::EMPTY);
        }
        // Adding the offset is monotone, so these are the extremes of the sums.
        let bounds = Bounds {
            min: offset + min.as_dvec3(),
            max: offset + max.as_dvec3(),
        };
        // A position was rounded once, by at most half a unit in its last place, 2⁻²⁴ of itself.
        let limit = COORDINATE_LIMIT * (1.0 + 2f64.powi(-24));
        let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
        match reach <= limit {
            true => Ok(bounds),
            false => Err("a triangle has a corner that is too far"),
        }
    }

    /// Checks that lists have the lengths that belong together, and that their indices are in range.
    fn check_lists(&self) -> Result<(), &'static str> {
        let (vertices, triangles) = (self.positions.len(), self.triangles.len());
        let is_of_triangles = |indices: &Option<Vec<[u32; 3]>>| {
            indices.as_ref().is_none_or(|all| all.len() == triangles)
        };
        let normals = self.normals.as_ref().map(|all| &all.indices);
        let uvs = self.uvs.as_ref().map(|all| &all.indices);
        if !normals.into_iter().chain(uvs).all(is_of_triangles) {
            return Err("normals or texture coordinates are not those of as many triangles");
        }
        let materials = &self.material_of_triangle;
        let most = self.materials.len() as u32;
        let is_there = |&number: &u32| number < most || number == u32::MAX;
        if !(materials.is_empty() || materials.len() == triangles)
            || !materials.par_iter().with_min_len(CHUNK).all(is_there)
        {
            return Err("a triangle's material is not there");
        }
        if self.colors.len() > vertices {
            return Err("there are more colours than vertices");
        }
        let is_whole = |scalar: &Scalar| {
            scalar.values.len()
                == match scalar.at {
                    ScalarAt::Vertices => vertices,
                    ScalarAt::Triangles => triangles,
                }
        };
        match self.scalars.iter().all(is_whole) {
            true => Ok(()),
            false => Err("a scalar has not as many numbers as the mesh needs"),
        }
    }

    /// Checks that normals are of unit length and texture coordinates finite, wherever triangles have them.
    fn check_attributes(&self) -> Result<(), &'static str> {
        if !self.holds_at_corners(&self.normals, |normal| normal.is_normalized()) {
            return Err("a normal is not of unit length");
        }
        if !self.holds_at_corners(&self.uvs, |uv| uv.is_finite()) {
            return Err("a texture coordinate is not finite");
        }
        Ok(())
    }

    fn holds_at_corners<T: Copy + Sync>(
        &self,
        attribute: &Option<Attribute<T>>,
        holds: impl Fn(&T) -> bool + Sync,
    ) -> bool {
        let Some(attribute) = attribute else {
            return true;
        };
        let values = attribute.values.par_iter().with_min_len(CHUNK);
        // Values that no triangle uses may be anything; that hardly ever occurs, so all are tested at once first.
        values.clone().all(&holds) || {
            let triangles = self.triangles.par_iter().with_min_len(CHUNK).enumerate();
            triangles.into_par_iter().all(|(number, &shared)| {
                let corners = attribute.corners(number as u32, shared);
                corners.is_none_or(|corners| corners.iter().all(&holds))
            })
        }
    }
}
