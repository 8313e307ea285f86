use super::params::{CELLS, ROW};

/// The bounds of rays in a packet: first and last column and row, both included.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RayBox {
    pub(crate) left: i32,
    pub(crate) right: i32,
    pub(crate) top: i32,
    pub(crate) bottom: i32,
}

impl RayBox {
    /// The number of rays in it.
    #[inline(always)]
    pub(crate) fn count(self) -> i32 {
        (self.right - self.left + 1) * (self.bottom - self.top + 1)
    }

    /// The cells that it touches, as bits.
    pub(crate) fn cells(self) -> u32 {
        let first_to =
            |first: i32, last: i32| (2 << (last as usize / ROW)) - (1 << (first as usize / ROW));
        let (columns, rows): (u32, u32) = (
            first_to(self.left, self.right),
            first_to(self.top, self.bottom),
        );
        (0..CELLS).fold(0, |cells, row| {
            cells | (((rows >> row & 1) * columns) << (row * CELLS))
        })
    }

    /// Whether it has no more columns than a row of lanes.
    #[inline(always)]
    pub(crate) fn is_narrow(self) -> bool {
        self.right - self.left < ROW as i32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::packet::params::SIDE;

    #[test]
    fn cells_are_those_of_the_rays() {
        let all = 0..SIDE as i32;
        let boxes = all.clone().flat_map(|left| {
            (left..SIDE as i32)
                .step_by(3)
                .map(move |right| (left, right))
        });
        for (left, right) in boxes {
            for (top, bottom) in [
                (0, 0),
                (7, 8),
                (5, 31),
                (24, 24),
                (right, right),
                (left, right),
            ] {
                let rays = RayBox {
                    left,
                    right,
                    top,
                    bottom,
                };
                let mut cells = 0u32;
                for (row, column) in
                    (top..=bottom).flat_map(|row| (left..=right).map(move |column| (row, column)))
                {
                    cells |= 1 << (row as usize / ROW * CELLS + column as usize / ROW);
                }
                assert_eq!(rays.cells(), cells, "{rays:?}");
            }
        }
    }
}
