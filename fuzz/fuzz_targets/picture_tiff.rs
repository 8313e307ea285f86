#![no_main]

use raycast_fuzz::{alone, expect};

libfuzzer_sys::fuzz_target!(
    init: alone(),
    |bytes: &[u8]| expect(raycast_tests::fuzz::picture_tiff::check(bytes))
);
