//! Tables in Markdown, as GitHub and others read it.

use super::Contents;
use crate::report::values::cell;

pub(super) fn write(Contents { heading, facts, tables, notes }: &Contents) -> String {
    let mut text = format!("### {}\n\n", escaped(heading));
    for fact in facts {
        text += &format!("- {fact}\n");
    }
    for table in tables {
        text += &format!("\n{}:\n\n| {} |\n", table.caption, table.columns.join(" | "));
        text += &format!("| --- |{}\n", " ---: |".repeat(table.columns.len() - 1));
        for row in &table.rows {
            let cells: Vec<_> = row.iter().map(cell).collect();
            text += &format!("| {} |\n", cells.join(" | "));
        }
    }
    text += "\n";
    for note in notes {
        text += &format!("{note}\n");
    }
    text
}

/// The text with whatever would be read as Markdown escaped.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for letter in text.chars() {
        if letter.is_ascii_punctuation() && !"-./:,".contains(letter) {
            escaped.push('\\');
        }
        escaped.push(letter);
    }
    escaped
}
