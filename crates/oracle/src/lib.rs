//! The truth about rays and triangles, by arithmetic without rounding.
