//! The lesser and the greater of two numbers by one comparison, which the compiler does for eight lanes with one
//! instruction: `f64::min` also answers for NaN. Here the second number is the answer where either is NaN.

#[inline(always)]
pub(crate) fn lesser<T: PartialOrd + Copy>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

#[inline(always)]
pub(crate) fn greater<T: PartialOrd + Copy>(a: T, b: T) -> T {
    if a > b { a } else { b }
}
