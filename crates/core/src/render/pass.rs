/// A pass over a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pass {
    /// Every `stride`-th ray in both directions is cast: a power of two, 1 for every ray.
    pub stride: u32,
    /// Samples a pixel in the picture after the pass.
    pub samples: u32,
}

/// The sequence of passes of progressive rendering.
#[derive(Clone, Copy, Debug)]
pub struct Passes;

impl Passes {
    /// From coarse to fine (every `first_stride`-th ray, then half of that, down to every ray), then twice as many
    /// samples each time, up to `samples`. `first_stride` is rounded up to a power of two, at most 2³¹; zeros count as
    /// one.
    pub fn plan(first_stride: u32, samples: u32) -> Vec<Pass> {
        let mut passes = Vec::new();
        let mut stride = first_stride.clamp(1, 1 << 31).next_power_of_two();
        while stride > 0 {
            passes.push(Pass { stride, samples: 1 });
            stride /= 2;
        }
        let mut done = 1;
        while done < samples {
            done = (done * 2).min(samples);
            passes.push(Pass {
                stride: 1,
                samples: done,
            });
        }
        passes
    }
}
