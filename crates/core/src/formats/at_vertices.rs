use crate::scene::Attribute;

/// Values that share the positions' indices. A triangle with a corner whose value is invalid has no values; `None`
/// where no triangle has any.
pub(super) fn at_vertices<T>(
    values: Vec<T>,
    triangles: &[[u32; 3]],
    is_usable: impl Fn(&T) -> bool,
) -> Option<Attribute<T>> {
    if values.is_empty() {
        return None;
    }
    if values.iter().all(&is_usable) {
        let indices = None;
        return Some(Attribute { values, indices });
    }
    let usable = |index: &u32| values.get(*index as usize).is_some_and(&is_usable);
    let indices = triangles.iter().map(|triangle| {
        let has_all = triangle.iter().all(usable);
        if has_all { *triangle } else { [u32::MAX; 3] }
    });
    let indices: Vec<_> = indices.collect();
    let some = indices.iter().any(|triangle| *triangle != [u32::MAX; 3]);
    let indices = Some(indices);
    some.then_some(Attribute { values, indices })
}
