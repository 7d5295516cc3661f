//! The page: one HTML file that needs nothing else, with the style that all pages share.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use raywood_lab::figures::{Cell, Table};

use super::palette::dark_rules;
use super::values;

/// The style of every page, for light ground.
const STYLE: &str = include_str!("page.css");
/// What is different on dark ground.
const DARK_STYLE: &str = "--ground:#1b1e22;--card:#24282d;--ink:#e4e7eb;--soft:#a3abb4;--rule:#3a4048;\
--link:#6cb6f0;--holds:#4fd1a5;--part:#f0b429;--fails:#ff8a80;";

/// A whole page. `style` is what this kind of page needs beside the common style, `body` what follows the heading.
pub(crate) fn html(title: &str, style: &str, body: &Markup) -> String {
    // Paper is light, whatever the screen is.
    let dark = format!(
        "@media screen and (prefers-color-scheme: dark){{:root{{{DARK_STYLE}}}{}}}",
        dark_rules()
    );
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="generator" content={ "raywood " (env!("CARGO_PKG_VERSION")) };
                title { (title) }
                style { (PreEscaped(STYLE)) (PreEscaped(style)) (PreEscaped(dark)) }
            }
            body {
                h1 { (title) }
                (body)
            }
        }
    }
    .into_string()
}

/// Names and values, such as what was run on what.
pub(crate) fn facts(facts: &[(&str, String)]) -> Markup {
    html! {
        dl.facts { @for (name, value) in facts { dt { (name) } dd { (value) } } }
    }
}

/// A table; one that is too wide for the screen can be pushed sideways.
pub(crate) fn table(table: &Table) -> Markup {
    // A column whose cells are numbers stands right, its heading too.
    let is_numeric = |column: usize| {
        let cells = || table.rows.iter().filter_map(|row| row.get(column));
        cells().next().is_some() && cells().all(Cell::is_numeric)
    };
    let class = |column: usize| is_numeric(column).then_some("number");
    html! {
        div.wide {
            table {
                caption { span { (table.caption) } }
                thead {
                    tr {
                        @for (number, name) in table.columns.iter().enumerate() {
                            th scope="col" class=[class(number)] { (name) }
                        }
                    }
                }
                tbody {
                    @for row in &table.rows {
                        tr {
                            @for (number, cell) in row.iter().enumerate() {
                                td class=[class(number)] { (values::cell(cell)) }
                            }
                        }
                    }
                }
            }
        }
    }
}
