//! The levels of instructions, and which one is used.

use std::fmt;
use std::sync::OnceLock;

/// The level that kernels use unless they are told otherwise, once it is decided.
static ACTIVE: OnceLock<SimdLevel> = OnceLock::new();

/// A set of vector instructions that kernels are compiled for. All levels give the same answers to single rays, to the bit, and
/// [agreeing](crate::Hit::agrees_with) ones to batches.
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

    /// The levels that this processor has, the fastest last.
    pub fn available() -> impl DoubleEndedIterator<Item = Self> {
        Self::ALL.iter().copied().filter(|level| level.is_available())
    }

    /// The level that structures trace with unless they are [told otherwise](crate::Structure::set_simd_level): the best that the processor
    /// has, but none above the one that the environment variable [`RAYWOOD_SIMD`](Self::VARIABLE) names (`portable`, `avx2` or `avx512`;
    /// anything else counts for nothing). Decided once for the process.
    pub fn active() -> Self {
        *ACTIVE.get_or_init(|| {
            let named = std::env::var(Self::VARIABLE).ok();
            let most = named.and_then(|name| Self::from_name(&name)).unwrap_or(Self::Avx512);
            let usable = |level: &Self| *level <= most;
            Self::available().rev().find(usable).unwrap_or(Self::Portable)
        })
    }

    /// Makes this the [active](Self::active) level, whatever the environment says. Before the first structure is built: what is decided
    /// stays.
    ///
    /// # Errors
    ///
    /// The processor lacks the instructions, or another level is active already.
    pub fn activate(self) -> Result<(), SimdLevelError> {
        if !self.is_available() {
            return Err(SimdLevelError::Unavailable { level: self });
        }
        match *ACTIVE.get_or_init(|| self) {
            active if active == self => Ok(()),
            active => Err(SimdLevelError::Decided { level: self, active }),
        }
    }
}

/// Why a level cannot be the active one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SimdLevelError {
    /// The processor lacks the instructions.
    Unavailable {
        /// The level asked for.
        level: SimdLevel,
    },
    /// Another level is active already.
    Decided {
        /// The level asked for.
        level: SimdLevel,
        /// The level that is active.
        active: SimdLevel,
    },
}

impl fmt::Display for SimdLevelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unavailable { level } => {
                let available: Vec<_> = SimdLevel::available().map(SimdLevel::name).collect();
                write!(f, "this machine has no {}: it has {}", level.name(), available.join(", "))
            }
            Self::Decided { level, active } => {
                write!(
                    f,
                    "{} is active already and stays, {} is too late",
                    active.name(),
                    level.name()
                )
            }
        }
    }
}

impl std::error::Error for SimdLevelError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_decided_stays() {
        let active = SimdLevel::active();
        assert!(
            active.is_available() && SimdLevel::available().next() == Some(SimdLevel::Portable)
        );
        for &level in SimdLevel::ALL {
            let expected = match level {
                level if !level.is_available() => Err(SimdLevelError::Unavailable { level }),
                level if level == active => Ok(()),
                level => Err(SimdLevelError::Decided { level, active }),
            };
            assert_eq!(level.activate(), expected);
            assert_eq!(SimdLevel::active(), active);
        }
    }

    #[test]
    fn an_error_names_what_there_is() {
        let said = SimdLevelError::Unavailable { level: SimdLevel::Avx512 }.to_string();
        assert!(said.starts_with("this machine has no avx512: it has portable"), "{said}");
    }
}
