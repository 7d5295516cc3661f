//! Which vector instructions are used: the option that every command that traces shares, and the environment variable.

use std::env;

use raywood::SimdLevel;

use crate::failure::Failure;
use crate::parse::simd_level;

/// The option of the vector instructions.
#[derive(clap::Args)]
#[command(next_help_heading = "Acceleration structure")]
pub(crate) struct SimdArgs {
    /// Best of portable, avx2, avx512 to use
    ///
    /// One of portable, avx2 and avx512: levels above it are not used; times change, and last digits, which show in single pixels. Else the best that the machine has, or what the environment variable RAYWOOD_SIMD says.
    #[arg(long, value_name = "LEVEL", value_parser = simd_level)]
    simd: Option<SimdLevel>,
}

impl SimdArgs {
    /// Has the level used from here on. Before any structure is built.
    ///
    /// # Errors
    ///
    /// There is no such level, or the machine lacks it.
    pub(crate) fn activate(&self) -> Result<(), Failure> {
        let (level, source) = match self.simd {
            Some(level) => (level, "--simd"),
            None => match env::var_os(SimdLevel::VARIABLE).filter(|value| !value.is_empty()) {
                None => return Ok(()),
                Some(value) => {
                    let text = value.to_string_lossy();
                    let complain = |expected| {
                        let variable = SimdLevel::VARIABLE;
                        Failure::BadInput(format!("{variable}: `{text}` is no level: {expected}"))
                    };
                    (simd_level(&text).map_err(complain)?, SimdLevel::VARIABLE)
                }
            },
        };
        level.activate().map_err(|error| Failure::BadInput(format!("{source}: {error}")))
    }
}
