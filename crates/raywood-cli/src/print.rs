//! Text for the user: results on standard output, everything else on standard error.

use std::fmt::Display;
use std::io::{self, Write};

use crate::failure::Failure;

/// Prints a result. A reader who has gone (`raywood scenes | head -1`) is no failure.
pub(crate) fn result(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::while_running(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints a value as JSON, indented.
pub(crate) fn json(value: &serde_json::Value) -> Result<(), Failure> {
    result(&format!("{value:#}\n"))
}

/// Says what the user should know but what stops nothing.
pub(crate) fn warning(text: impl Display) {
    say("warning", &text);
}

/// Says what happens.
pub(crate) fn note(text: impl Display) {
    say("note", &text);
}

/// Says why the command ends.
pub(crate) fn failure(failure: &Failure) {
    let kind = if matches!(failure, Failure::Interrupted(_)) { "stopped" } else { "error" };
    say(kind, failure);
}

/// Prints a line on standard error; if that is closed there is nobody to tell.
fn say(kind: &str, text: &dyn Display) {
    let _ = writeln!(io::stderr(), "raywood: {kind}: {text}");
}

/// A text in lines of at most so many characters, longer ones only where a single word is.
pub(crate) fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// So many threads.
pub(crate) fn threads(number: usize) -> String {
    if number == 1 { "1 thread".to_owned() } else { format!("{number} threads") }
}

/// A whole number with commas between thousands.
pub(crate) fn thousands(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::thousands;

    #[test]
    fn thousands_are_separated() {
        assert_eq!(
            [0, 7, 999, 1000, 123_456, 1_234_567].map(thousands),
            ["0", "7", "999", "1,000", "123,456", "1,234,567"]
        );
    }
}
