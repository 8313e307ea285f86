/// A rectangle of pixels of the full picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Rect {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Rect {
    /// How many pixels it has.
    pub fn area(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// The column after the last.
    pub fn right(&self) -> u32 {
        self.x + self.width
    }

    /// The row after the last.
    pub fn bottom(&self) -> u32 {
        self.y + self.height
    }
}
