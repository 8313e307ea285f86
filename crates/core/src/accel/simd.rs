//! One source for several instruction sets: the same code, compiled for each, picked at run time.
//!
//! None of them contracts a product and a sum into one rounding, so the bits are the same.

#![allow(
    unsafe_code,
    reason = "a function compiled for an instruction set may be called only where the machine has it"
)]

/// Instruction sets that tiles can be cast with, from the plainest to the widest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Simd {
    /// What every machine of this architecture has.
    Plain,
    /// AVX2: eight singles at once.
    Avx2,
    /// AVX-512: sixteen.
    Avx512,
}

impl Simd {
    /// The widest that this machine has.
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let has_512 = is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl");
            if has_512 {
                return Self::Avx512;
            }
            if is_x86_feature_detected!("avx2") {
                return Self::Avx2;
            }
        }
        Self::Plain
    }

    /// The name in statistics.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }
}

impl std::str::FromStr for Simd {
    type Err = String;

    /// Reads a name as [`Simd::name`] gives it.
    fn from_str(name: &str) -> Result<Self, String> {
        [Self::Plain, Self::Avx2, Self::Avx512]
            .into_iter()
            .find(|simd| simd.name() == name)
            .ok_or_else(|| format!("expected plain, avx2 or avx512, found {name:?}"))
    }
}

/// Work that is compiled for each instruction set. `run` must be inlined to be.
pub(super) trait Work {
    /// Does it.
    fn run(self);
}

/// Runs `work` as compiled for `simd`, or for the best below it that this machine has.
pub(super) fn dispatch(simd: Simd, work: impl Work) {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,bmi1,bmi2,popcnt,lzcnt")]
        fn avx512(work: impl Work) {
            work.run();
        }

        #[target_feature(enable = "avx2,bmi1,bmi2,popcnt,lzcnt")]
        fn avx2(work: impl Work) {
            work.run();
        }

        match simd.min(Simd::best()) {
            // SAFETY: `Simd::best` has just said that the machine has these features (every machine
            // with AVX2 has the bit manipulation ones).
            Simd::Avx512 => return unsafe { avx512(work) },
            // SAFETY: as above.
            Simd::Avx2 => return unsafe { avx2(work) },
            Simd::Plain => {}
        }
    }
    let _ = simd;
    work.run();
}
