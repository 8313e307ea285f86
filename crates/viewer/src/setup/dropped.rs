use raycast_core::Accel;
use raycast_core::scene::{Dropped, Scene};

/// The triangles of a scene that were dropped, by reason: by its meshes, and by transforms.
pub fn dropped(scene: &Scene, accel: &Accel) -> Dropped {
    let mut sum = Dropped {
        too_far: accel.out_of_range(),
        ..Dropped::default()
    };
    for object in &scene.objects {
        let dropped = object.mesh.dropped();
        sum.not_finite += dropped.not_finite;
        sum.too_far += dropped.too_far;
        sum.bad_index += dropped.bad_index;
        sum.zero_area += dropped.zero_area;
        sum.rounded_away += dropped.rounded_away;
    }
    sum
}

/// The reasons for dropping triangles, in words: `3 without area, 1 not finite`.
pub fn reasons(dropped: &Dropped) -> String {
    let counts = [
        (dropped.zero_area, "without area"),
        (dropped.rounded_away, "rounded away by single precision"),
        (dropped.not_finite, "not finite"),
        (dropped.too_far, "too far away"),
        (dropped.bad_index, "with a vertex that is not there"),
    ];
    let reasons: Vec<_> = counts
        .iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, reason)| format!("{count} {reason}"))
        .collect();
    reasons.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_are_listed_where_there_are_any() {
        let dropped = Dropped {
            zero_area: 3,
            not_finite: 1,
            ..Dropped::default()
        };
        assert_eq!(reasons(&dropped), "3 without area, 1 not finite");
        assert_eq!(reasons(&Dropped::default()), "");
    }
}
