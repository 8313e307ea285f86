use super::{Alpha, Material, Opacity, Scene};

/// The alpha masks of a scene's materials: they decide which hits count.
#[derive(Clone, Debug)]
pub struct Masks<'a> {
    scene: &'a Scene,
    /// For each object, whether any of its materials is a mask.
    has_any: Vec<bool>,
}

impl<'a> Masks<'a> {
    /// `None` where no material is a mask.
    pub fn of(scene: &'a Scene) -> Option<Self> {
        let is_mask = |opacity: &Opacity| matches!(opacity, Opacity::Mask { .. });
        let has_any = scene.objects_whose(is_mask)?;
        Some(Self { scene, has_any })
    }

    /// Whether a triangle's material is a mask.
    pub fn is_masked(&self, object: u32, triangle: u32) -> bool {
        self.mask(object, triangle).is_some()
    }

    /// Whether a hit at barycentrics (u, v), rounded to single precision, counts.
    pub fn keeps(&self, object: u32, triangle: u32, (u, v): (f32, f32)) -> bool {
        let Some((alpha, cutoff)) = self.mask(object, triangle) else {
            return true;
        };
        let mesh = &self.scene.objects[object as usize].mesh;
        alpha.at(mesh.corner_uvs(triangle), u, v) >= f64::from(cutoff)
    }

    fn mask(&self, object: u32, triangle: u32) -> Option<(&'a Alpha, f32)> {
        let number = object as usize;
        if !self.has_any.get(number).is_some_and(|has| *has) {
            return None;
        }
        match self.scene.objects[number].mesh.opacity(triangle) {
            Opacity::Mask { alpha, cutoff } => Some((alpha, *cutoff)),
            Opacity::Opaque | Opacity::Blend(_) => None,
        }
    }
}

impl Scene {
    /// For each object, whether the opacity of any of its mesh's materials satisfies the predicate; `None` where that
    /// of no object does.
    pub(crate) fn objects_whose(&self, is_it: impl Fn(&Opacity) -> bool) -> Option<Vec<bool>> {
        let has = |materials: &[Material]| materials.iter().any(|m| is_it(&m.opacity));
        let objects = self.objects.iter();
        let all: Vec<bool> = objects.map(|o| has(o.mesh.materials())).collect();
        all.contains(&true).then_some(all)
    }
}
