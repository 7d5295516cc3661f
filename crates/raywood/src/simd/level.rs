//! The levels of instructions, and which one is used.

use std::sync::OnceLock;

/// A set of vector instructions that kernels are compiled for. All levels give the same answers, to the bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum SimdLevel {
    /// What every processor has.
    Portable,
    /// AVX2 and FMA: eight numbers at once.
    Avx2,
    /// AVX-512 (F, VL, DQ, BW): sixteen numbers at once.
    Avx512,
}

impl SimdLevel {
    /// All levels, the fastest last.
    pub const ALL: &[Self] = &[Self::Portable, Self::Avx2, Self::Avx512];

    /// The environment variable that rules out the levels above the one that it names.
    pub const VARIABLE: &str = "RAYWOOD_SIMD";

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// The level of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|level| level.name() == name)
    }

    /// Whether this processor has the instructions.
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => {
                // The processors that have AVX2 count bits too; kernels rely on it.
                is_x86_feature_detected!("avx2")
                    && is_x86_feature_detected!("fma")
                    && is_x86_feature_detected!("bmi1")
                    && is_x86_feature_detected!("bmi2")
                    && is_x86_feature_detected!("lzcnt")
                    && is_x86_feature_detected!("popcnt")
            }
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                Self::Avx2.is_available()
                    && is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512vl")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512bw")
            }
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }

    /// The level that kernels use: the best that the processor has, but none above the one that the environment variable
    /// [`RAYWOOD_SIMD`](Self::VARIABLE) names (`portable`, `avx2` or `avx512`; anything else counts for nothing). Decided once.
    pub fn active() -> Self {
        static ACTIVE: OnceLock<SimdLevel> = OnceLock::new();
        *ACTIVE.get_or_init(|| {
            let named = std::env::var(Self::VARIABLE).ok();
            let most = named.and_then(|name| Self::from_name(&name)).unwrap_or(Self::Avx512);
            let usable = |level: &Self| *level <= most && level.is_available();
            Self::ALL.iter().rev().copied().find(usable).unwrap_or(Self::Portable)
        })
    }
}
