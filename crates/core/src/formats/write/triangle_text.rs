use super::parts::Parts;
use super::written::{WriteError, Written};
use std::io::Write;

/// Writes triangle text: only corners, object by object.
pub(super) fn write(
    parts: &Parts<'_>,
    out: &mut dyn Write,
    written: &mut Written,
) -> Result<(), WriteError> {
    for part in &parts.parts {
        for triangle in part.triangles.iter() {
            for (index, corner) in part.corners(*triangle).into_iter().enumerate() {
                let [x, y, z] = corner.to_array().map(|number| parts.decimal(number));
                let end = if index < 2 { ";" } else { "\n" };
                write!(out, "({x},{y},{z}){end}")?;
            }
        }
    }
    parts.count_moves(written, |_, position| position);
    parts.record_lost_attributes(written);
    Ok(())
}
