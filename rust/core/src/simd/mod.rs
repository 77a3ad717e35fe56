//! Which vector instructions the kernels use; chosen once, at run time.
//!
//! Everything that is written for one processor lives in this folder, and with it all `unsafe`
//! code of the crate. Every kernel has a portable form here too, and all forms give the same bits.

pub(crate) mod front_end;
pub(crate) mod lanes;
pub(crate) mod runs;
pub(crate) mod synth;

use std::sync::OnceLock;

/// Vector instructions, from none to most.
///
/// A level that the processor lacks may be named, but is never run: every kernel lowers it at its
/// door ([`Level::lowered`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Level {
    /// What every processor of the architecture has.
    Portable,
    /// x86-64 with AVX2.
    Avx2,
    /// x86-64 with AVX-512 F, BW, DQ, VL, VBMI and VNNI.
    Avx512,
}

impl Level {
    /// The best that this processor has, unless the environment variable `SDR_SPOOF_SIMD`
    /// (`portable`, `avx2` or `avx512`) asks for less.
    pub fn best() -> Level {
        static BEST: OnceLock<Level> = OnceLock::new();
        *BEST.get_or_init(|| {
            let wanted = std::env::var("SDR_SPOOF_SIMD").ok();
            let limit = wanted.and_then(|name| Level::parse(&name));
            limit.unwrap_or(Level::Avx512).lowered()
        })
    }

    /// The levels that this processor can run, lowest first.
    pub fn available() -> Vec<Level> {
        [Level::Portable, Level::Avx2, Level::Avx512]
            .into_iter()
            .filter(|&level| level.lowered() == level)
            .collect()
    }

    /// Its name, as `SDR_SPOOF_SIMD` takes it.
    pub fn name(self) -> &'static str {
        match self {
            Level::Portable => "portable",
            Level::Avx2 => "avx2",
            Level::Avx512 => "avx512",
        }
    }

    fn parse(name: &str) -> Option<Level> {
        [Level::Portable, Level::Avx2, Level::Avx512]
            .into_iter()
            .find(|l| l.name() == name)
    }

    /// This level, or the best that the processor has if that is less.
    pub(crate) fn lowered(self) -> Level {
        static DETECTED: OnceLock<Level> = OnceLock::new();
        self.min(*DETECTED.get_or_init(Level::detect))
    }

    #[cfg(target_arch = "x86_64")]
    fn detect() -> Level {
        let avx2 = is_x86_feature_detected!("avx2");
        let avx512 = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("avx512vbmi")
            && is_x86_feature_detected!("avx512vnni");
        match (avx2, avx512) {
            (true, true) => Level::Avx512,
            (true, false) => Level::Avx2,
            _ => Level::Portable,
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn detect() -> Level {
        Level::Portable
    }
}
