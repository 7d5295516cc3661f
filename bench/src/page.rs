//! A page that shows summaries of runs, each between marks of its own.

/// What stands before and after a summary in a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Marks {
    /// Of a run of `trace`.
    Traces,
    /// Of a run of `build`.
    Builds,
    /// Of a run of `query`.
    Queries,
}

impl Marks {
    /// The lines between which the summary is.
    fn lines(self) -> [&'static str; 2] {
        match self {
            Self::Traces => [
                "<!-- made by `raywood-bench table`: begin -->",
                "<!-- made by `raywood-bench table`: end -->",
            ],
            Self::Builds => [
                "<!-- made by `raywood-bench table` of builds: begin -->",
                "<!-- made by `raywood-bench table` of builds: end -->",
            ],
            Self::Queries => [
                "<!-- made by `raywood-bench table` of queries: begin -->",
                "<!-- made by `raywood-bench table` of queries: end -->",
            ],
        }
    }
}

/// The page with what stands between its marks replaced.
///
/// # Errors
///
/// The page does not have these lines, in this order.
pub(crate) fn replace(page: &str, marks: Marks, summary: &str) -> Result<String, String> {
    let [begin, end] = marks.lines();
    let parts = page
        .split_once(begin)
        .and_then(|(before, rest)| rest.split_once(end).map(|(_, after)| (before, after)));
    let (before, after) =
        parts.ok_or_else(|| format!("expected the lines `{begin}` and `{end}`"))?;
    Ok(format!("{before}{begin}\n\n{summary}\n{end}{after}"))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use serde_json::Value;

    use super::*;

    #[test]
    fn pages_keep_what_is_around_the_summary() {
        let [begin, end] = Marks::Builds.lines();
        let page = format!("a\n{begin}\nold\n{end}\nb\n");
        assert_eq!(
            replace(&page, Marks::Builds, "new\n").as_deref(),
            Ok(&*format!("a\n{begin}\n\nnew\n\n{end}\nb\n"))
        );
        assert!(replace(&page, Marks::Traces, "new").is_err());
    }

    /// The page's tables are those that its recorded runs make, and so is the picture.
    #[test]
    fn the_readme_shows_recorded_runs() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
        let page = std::fs::read_to_string(folder.join("README.md")).expect("a README");
        let run = |mark: &str| -> (String, Value) {
            let link = |line: &str| Some(line.strip_prefix(mark)?.split('`').next()?.to_owned());
            let name = page.lines().find_map(link).expect(mark);
            let json = std::fs::read_to_string(folder.join(&name)).expect("the recorded run");
            (name, serde_json::from_str(&json).expect("JSON"))
        };
        let shown = |name: &str, marks, summary: &str| {
            let expected = replace(&page, marks, summary).expect("marks");
            assert!(page == expected, "raywood-bench table bench/{name} --into bench/README.md");
        };
        let (name, traces) = run("Recorded run: [`");
        shown(&name, Marks::Traces, &crate::table::markdown(&traces).expect("a run"));
        let (name, queries) = run("Recorded run of queries: [`");
        shown(&name, Marks::Queries, &crate::query::table::markdown(&queries).expect("a run"));
        let (name, builds) = run("Recorded run of builds: [`");
        shown(&name, Marks::Builds, &crate::build::table::markdown(&builds).expect("a run"));
        let picture =
            std::fs::read_to_string(folder.join("results/builds.svg")).expect("a picture");
        let expected = crate::build::pareto::svg(&builds).expect("a run");
        assert!(picture == expected, "raywood-bench plot bench/{name} -o bench/results/builds.svg");
    }
}
