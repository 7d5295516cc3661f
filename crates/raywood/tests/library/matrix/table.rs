//! What is covered and what is not offered, as the page `docs/conformance.md` tells it.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use raywood::StructureKind;

use super::axes::{Choice, Query};

type Row = (Query, Choice);

/// What is known of a cell: a query with options, of a structure.
#[derive(Default)]
struct Cell {
    /// On which geometries it was compared.
    geometries: BTreeSet<String>,
    compared: usize,
    reasons: BTreeSet<&'static str>,
}

/// All cells.
#[derive(Default)]
pub(crate) struct Matrix {
    columns: Vec<String>,
    cells: BTreeMap<(String, Row), Cell>,
    geometries: BTreeMap<String, Vec<String>>,
    wrong: Vec<String>,
}

impl Matrix {
    pub(crate) fn covered(&mut self, column: &str, geometry: &str, row: Row, compared: usize) {
        let cell = self.cell(column, geometry, row);
        cell.geometries.insert(geometry.into());
        cell.compared += compared;
    }

    pub(crate) fn not_offered(
        &mut self,
        column: &str,
        geometry: &str,
        row: Row,
        reason: &'static str,
    ) {
        self.cell(column, geometry, row).reasons.insert(reason);
    }

    /// Something is not as it should be.
    pub(crate) fn wrong(&mut self, what: String) {
        self.wrong.push(what);
    }

    /// Panics with everything that is not.
    pub(crate) fn expect_all_right(&self) {
        assert!(self.wrong.is_empty(), "{} wrong:\n{}", self.wrong.len(), self.wrong.join("\n"));
    }

    fn cell(&mut self, column: &str, geometry: &str, row: Row) -> &mut Cell {
        if !self.columns.iter().any(|known| known == column) {
            self.columns.push(column.into());
        }
        let known = self.geometries.entry(column.into()).or_default();
        if !known.iter().any(|known| known == geometry) {
            known.push(geometry.into());
        }
        self.cells.entry((column.into(), row)).or_default()
    }

    /// The reason why a cell is not offered; `None` if it is covered.
    ///
    /// # Panics
    ///
    /// If it is neither, or not the same on all geometries.
    fn reason(&self, column: &str, row: Row) -> Option<&'static str> {
        let what = format!("{} {} of {column}", row.0.name(), row.1.name());
        let Some(cell) = self.cells.get(&(column.into(), row)) else {
            panic!("{what} is neither covered nor named as not offered")
        };
        let mut reasons = cell.reasons.iter().copied();
        match (cell.geometries.len(), reasons.next()) {
            (0, Some(reason)) if reasons.next().is_none() => Some(reason),
            (covered, None) if covered == self.geometries[column].len() && cell.compared > 0 => {
                None
            }
            _ => panic!("{what} is covered on {:?}, and not: {:?}", cell.geometries, cell.reasons),
        }
    }

    /// The options of a query that a column covers, in words, and the reasons why it lacks others.
    fn words(&self, column: &str, query: Query) -> (String, Vec<&'static str>) {
        let (mut covered, mut reasons) = (Vec::new(), Vec::new());
        for &choice in query.choices() {
            match self.reason(column, (query, choice)) {
                None => covered.push(choice),
                Some(reason) if !reasons.contains(&reason) => reasons.push(reason),
                Some(_) => {}
            }
        }
        let words = match &covered[..] {
            [] => "",
            [Choice::Plain] => "yes",
            [Choice::Plain, Choice::Mask] => "yes, mask",
            all if all == Choice::ALL => "yes, options",
            others => panic!("{column} has {others:?} of {}", query.name()),
        };
        (words.into(), reasons)
    }

    /// The page.
    pub(crate) fn page(&self) -> String {
        // The structures of the registry have one column, as all of them offer the same.
        let is_kind = |column: &&String| {
            StructureKind::ALL.iter().any(|kind| **column == format!("`{}`", kind.name()))
        };
        let kinds: Vec<_> = self.columns.iter().filter(is_kind).collect();
        let mut columns: Vec<_> = self.columns.iter().filter(|c| !is_kind(c)).collect();
        columns.insert(0, kinds[0]);
        let title = |column: &String| match column == kinds[0] {
            true => format!("`Structure`, all {} kinds", kinds.len()),
            false => column.clone(),
        };

        let mut page = String::from(PROLOGUE);
        let titles: Vec<_> = columns.iter().map(|column| title(column)).collect();
        let _ = writeln!(page, "| query | {} |", titles.join(" | "));
        let _ = writeln!(page, "| --- |{}", " --- |".repeat(columns.len()));
        let mut notes: Vec<&str> = Vec::new();
        for &query in Query::ALL {
            let _ = write!(page, "| {} |", query.name());
            for column in &columns {
                let (words, reasons) = self.words(column, query);
                if *column == kinds[0] {
                    for other in &kinds {
                        assert_eq!(self.words(other, query), (words.clone(), reasons.clone()));
                    }
                }
                let mut cell = words;
                for reason in reasons {
                    let known = notes.iter().position(|note| *note == reason);
                    let number = known.unwrap_or_else(|| {
                        notes.push(reason);
                        notes.len() - 1
                    });
                    let _ =
                        write!(cell, "{}[{}]", if cell.is_empty() { "" } else { " " }, number + 1);
                }
                let _ = write!(page, " {cell} |");
            }
            page.push('\n');
        }
        page.push_str("\nNot offered:\n\n");
        for (number, note) in notes.iter().enumerate() {
            let _ = writeln!(page, "- [{}] {note}.", number + 1);
        }
        let all = &self.geometries[columns[0]];
        let _ = writeln!(page, "\nGeometries: {}.", all.join(", "));
        page
    }
}

const PROLOGUE: &str = "\
# Conformance

`crates/raywood/tests/library/matrix/` asks every query of every structure, with every option that makes sense for it, on every kind of geometry, and compares the answers with brute force in double precision, which finds
them primitive by primitive (`raywood_testkit::reference`): on all levels of vector instructions, with rays along edges, through vertices and in the planes of faces, rays that are none, points and regions that
touch, and every primitive there twice, so that of equally near ones the lower number must be named. `Tlas` has its instances moved, turned, mirrored, scaled, sheared, one place twice, and one that nobody sees;
`Bvh64` lies at 10,000,000 and is a thousandth wide. A cell that is neither compared nor named here as not offered fails the test, which also writes this page (`RAYWOOD_BLESS=1`).

- **yes**: compared, on all geometries. `Bvh64` has triangles alone.
- **options**: also with `QueryOptions` that ask for nothing, cull front or back faces, have a mask, skip a primitive, have a filter, and all of these together.
- **mask**: also with a mask, which only instances are asked about.

The rule for ties is that of [`Hit`](../crates/raywood/src/hit.rs).

";

/// Checks that the page stands in the documentation; with `RAYWOOD_BLESS=1` it is written there.
pub(crate) fn compare_with_docs(page: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/conformance.md");
    if std::env::var_os("RAYWOOD_BLESS").is_some() {
        fs::write(&path, page).expect("the page can be written");
    }
    let there = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        there.replace("\r\n", "\n") == page,
        "{} is not what the matrix says: RAYWOOD_BLESS=1 cargo test --release --test library -- matrix",
        path.display()
    );
}
