//! What the benchmark runs on, and when.

use std::time::{SystemTime, UNIX_EPOCH};

use serde_json::{Value, json};

/// The names of those of the given processor features that the processor has.
macro_rules! features_at_run_time {
    ($($feature:tt)*) => {
        [$((($feature), std::is_x86_feature_detected!($feature))),*]
    };
}

/// The names of those of the given processor features that this program was compiled for.
macro_rules! features_at_compile_time {
    ($($feature:tt)*) => {
        [$((($feature), cfg!(target_feature = $feature))),*]
    };
}

fn present<const N: usize>(features: [(&'static str, bool); N]) -> Vec<&'static str> {
    features.into_iter().filter(|(_, present)| *present).map(|(name, _)| name).collect()
}

/// The machine as JSON.
pub(crate) fn machine() -> Value {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    #[cfg(target_arch = "x86_64")]
    let features = present(features_at_run_time!("sse4.2" "avx" "avx2" "fma" "avx512f" "avx512vl"));
    #[cfg(not(target_arch = "x86_64"))]
    let features: Vec<&str> = Vec::new();
    json!({
        "cpu": cpu_name(&info),
        "cores": std::thread::available_parallelism().map_or(0, usize::from),
        "features": features,
        "compiled_for": present(features_at_compile_time!("sse2" "sse4.2" "avx" "avx2" "fma" "avx512f" "avx512vl" "neon")),
        "os": std::env::consts::OS,
        "architecture": std::env::consts::ARCH,
    })
}

/// The processor's name with its family and model, which tell more where machines are virtual.
fn cpu_name(info: &str) -> String {
    let field = |name: &str| {
        info.lines()
            .filter_map(|line| line.split_once(':'))
            .find(|(key, _)| key.trim() == name)
            .map(|(_, value)| value.trim())
    };
    match (field("model name"), field("cpu family"), field("model")) {
        (Some(name), Some(family), Some(model)) => {
            format!("{name} (family {family}, model {model})")
        }
        (Some(name), ..) => name.to_owned(),
        _ => "unknown".to_owned(),
    }
}

/// Now, as in `2026-11-23T19:05:00Z`.
pub(crate) fn now() -> String {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    date_and_time(since.as_secs())
}

/// The date and time so many seconds after 1970 began, in UTC.
fn date_and_time(seconds: u64) -> String {
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    // Years that begin in March end with the leap day: Hinnant, "chrono-compatible low-level date algorithms".
    let shifted = days + 719_468;
    let (era, day_of_era) = (shifted / 146_097, shifted % 146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    let year = 400 * era + year_of_era + u64::from(month <= 2);
    let [h, m, s] = [second / 3600, second / 60 % 60, second % 60];
    format!("{year:04}-{month:02}-{day:02}T{h:02}:{m:02}:{s:02}Z")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        assert_eq!(date_and_time(0), "1970-01-01T00:00:00Z");
        assert_eq!(date_and_time(951_782_399), "2000-02-28T23:59:59Z");
        assert_eq!(date_and_time(951_782_400), "2000-02-29T00:00:00Z");
        assert_eq!(date_and_time(951_868_800), "2000-03-01T00:00:00Z");
        assert_eq!(date_and_time(1_795_393_925), "2026-11-23T00:32:05Z");
        assert_eq!(date_and_time(4_107_542_400), "2100-03-01T00:00:00Z");
    }

    #[test]
    fn processors_are_named() {
        let info = "processor\t: 0\ncpu family\t: 26\nmodel\t\t: 2\nmodel name\t: AMD EPYC\n";
        assert_eq!(cpu_name(info), "AMD EPYC (family 26, model 2)");
        assert_eq!(cpu_name("model name : X"), "X");
        assert_eq!(cpu_name(""), "unknown");
    }
}
