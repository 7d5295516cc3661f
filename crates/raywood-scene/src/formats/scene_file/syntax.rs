//! Reading what stands in a TOML document, so that every complaint names the line and column of what is wrong and what was expected there.

use std::ops::{Range, RangeInclusive};
use std::path::Path;

use raywood::Vec3;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::error::{LoadError, Place, quoted};
use crate::{Rgb, closest_name, srgb_to_linear};

/// The text of a scene file.
pub(super) struct Source<'a> {
    pub(super) path: &'a Path,
    pub(super) text: &'a str,
}

impl Source<'_> {
    /// An error at a byte of the text.
    pub(super) fn error(&self, byte: usize, message: impl Into<String>) -> LoadError {
        let before = self.text.get(..byte).unwrap_or(self.text);
        let line_start = before.rfind('\n').map_or(0, |end| end + 1);
        let line = 1 + before.bytes().filter(|byte| *byte == b'\n').count();
        let column = 1 + before[line_start..].chars().count();
        LoadError::new(self.path, Place::Column { line, column }, message)
    }
}

/// What follows a complaint about a name: the name that was probably meant, and the first of those that there are.
pub(super) fn known_names(name: &str, known: &[&str]) -> String {
    const MOST: usize = 16;
    let known: Vec<_> = known.iter().copied().filter(|name| !name.is_empty()).collect();
    let question = closest_name(name, known.iter().copied())
        .map_or(String::new(), |meant| format!(", did you mean {}?", quoted(meant.as_bytes())));
    let dots = if known.len() > MOST { ", ..." } else { "" };
    let shown: Vec<_> = known.iter().take(MOST).map(|name| quoted(name.as_bytes())).collect();
    let shown = if shown.is_empty() { "none".to_owned() } else { shown.join(", ") };
    format!("{question} (there are: {shown}{dots})")
}

/// A table, of which it is known that it has no other keys than it may have.
#[derive(Clone)]
pub(super) struct Fields<'a> {
    source: &'a Source<'a>,
    /// What the table describes, for messages: `[[sphere]]`.
    what: &'a str,
    table: &'a DeTable<'a>,
    span: Range<usize>,
}

impl<'a> Fields<'a> {
    /// The whole document.
    pub(super) fn of_document(
        source: &'a Source<'a>,
        document: &'a Spanned<DeTable<'a>>,
        keys: &[&str],
    ) -> Result<Self, LoadError> {
        let what = "a scene file";
        let fields = Self { source, what, table: document.get_ref(), span: document.span() };
        fields.check_keys(keys)?;
        Ok(fields)
    }

    /// Complains about the first key that is not among those given.
    fn check_keys(&self, keys: &[&str]) -> Result<(), LoadError> {
        let unknown = self.table.keys().filter(|key| !keys.contains(&&**key.get_ref()));
        let Some(key) = unknown.min_by_key(|key| key.span().start) else { return Ok(()) };
        let name = key.get_ref();
        let message = format!(
            "{} has no key {}{}",
            self.what,
            quoted(name.as_bytes()),
            known_names(name, keys)
        );
        Err(self.source.error(key.span().start, message))
    }

    /// The value of a key, if it is given.
    pub(super) fn get(&self, key: &'a str) -> Option<Value<'a>> {
        let value = self.table.get(key)?;
        Some(Value { source: self.source, key, value })
    }

    /// The value of a key that must be given.
    pub(super) fn require(&self, key: &'a str) -> Result<Value<'a>, LoadError> {
        self.get(key).ok_or_else(|| self.error(format!("{} needs the key `{key}`", self.what)))
    }

    /// What a key's value is read as, if it is given.
    pub(super) fn read<T>(
        &self,
        key: &'a str,
        read: impl FnOnce(Value<'a>) -> Result<T, LoadError>,
    ) -> Result<Option<T>, LoadError> {
        self.get(key).map(read).transpose()
    }

    /// The tables of a key such as `sphere`, written `[[sphere]]`; none if it is not given.
    pub(super) fn tables(&self, key: &'a str) -> Result<Vec<Value<'a>>, LoadError> {
        let Some(value) = self.get(key) else { return Ok(Vec::new()) };
        match value.value.get_ref() {
            DeValue::Array(values) => {
                Ok(values.iter().map(|one| Value { value: one, ..value }).collect())
            }
            _ => Err(value.expected(&format!("tables, each headed [[{key}]]"))),
        }
    }

    /// The keys and values, in the order of the file.
    pub(super) fn entries(&self) -> Vec<(&'a str, Value<'a>)> {
        let mut entries: Vec<_> = self.table.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        let entry = |(key, value): (&'a Spanned<toml::de::DeString<'a>>, _)| {
            let key: &str = key.get_ref();
            (key, Value { source: self.source, key, value })
        };
        entries.into_iter().map(entry).collect()
    }

    /// An error about the table as a whole.
    pub(super) fn error(&self, message: impl Into<String>) -> LoadError {
        self.source.error(self.span.start, message)
    }
}

/// The value of a key.
#[derive(Clone, Copy)]
pub(super) struct Value<'a> {
    source: &'a Source<'a>,
    pub(super) key: &'a str,
    value: &'a Spanned<DeValue<'a>>,
}

impl<'a> Value<'a> {
    /// An error at the value.
    pub(super) fn error(&self, message: impl Into<String>) -> LoadError {
        self.source.error(self.value.span().start, message)
    }

    /// The error that something else was expected.
    pub(super) fn expected(&self, what: &str) -> LoadError {
        let found = self.source.text.get(self.value.span()).unwrap_or_default();
        let found = found.lines().next().unwrap_or_default();
        self.error(format!("`{}` is {}, expected {what}", self.key, quoted(found.as_bytes())))
    }

    /// A table whose keys are among those given.
    pub(super) fn fields(self, what: &'a str, keys: &[&str]) -> Result<Fields<'a>, LoadError> {
        let fields = self.any_fields(what)?;
        fields.check_keys(keys)?;
        Ok(fields)
    }

    /// A table whose keys are names.
    pub(super) fn any_fields(self, what: &'a str) -> Result<Fields<'a>, LoadError> {
        let Self { source, value, .. } = self;
        match value.get_ref() {
            DeValue::Table(table) => Ok(Fields { source, what, table, span: value.span() }),
            _ => Err(self.expected("a table")),
        }
    }

    /// Whether it is a table.
    pub(super) fn is_table(&self) -> bool {
        self.value.get_ref().is_table()
    }

    /// A text.
    pub(super) fn text(self) -> Result<&'a str, LoadError> {
        self.value.get_ref().as_str().ok_or_else(|| self.expected("a text in quotes"))
    }

    /// A text, if it is one.
    pub(super) fn as_text(&self) -> Option<&'a str> {
        self.value.get_ref().as_str()
    }

    /// One of some words.
    pub(super) fn word(self, words: &[&'a str]) -> Result<&'a str, LoadError> {
        let text = self.as_text().unwrap_or_default();
        let known = words.iter().find(|word| **word == text);
        known.copied().ok_or_else(|| {
            let question = closest_name(text, words.iter().copied())
                .map_or(String::new(), |meant| format!(", did you mean \"{meant}\"?"));
            let words: Vec<_> = words.iter().map(|word| format!("\"{word}\"")).collect();
            self.expected(&format!("one of {}{question}", words.join(", ")))
        })
    }

    /// `true` or `false`.
    pub(super) fn boolean(self) -> Result<bool, LoadError> {
        self.value.get_ref().as_bool().ok_or_else(|| self.expected("true or false"))
    }

    /// A whole number of at least 0, as it is written.
    pub(super) fn whole_number(self) -> Result<u64, LoadError> {
        let integer = self.value.get_ref().as_integer();
        integer
            .and_then(|integer| u64::from_str_radix(integer.as_str(), integer.radix()).ok())
            .ok_or_else(|| self.expected("a whole number of at least 0"))
    }

    /// A number that is finite, also as `f32`.
    pub(super) fn as_number(&self) -> Option<f32> {
        let number = match self.value.get_ref() {
            DeValue::Float(float) => float.as_str().parse::<f64>().ok()? as f32,
            DeValue::Integer(integer) => {
                i64::from_str_radix(integer.as_str(), integer.radix()).ok()? as f32
            }
            _ => return None,
        };
        number.is_finite().then_some(number)
    }

    /// A finite number.
    pub(super) fn number(self) -> Result<f32, LoadError> {
        self.as_number().ok_or_else(|| self.expected("a finite number"))
    }

    /// A number in a range.
    pub(super) fn number_in(self, range: RangeInclusive<f32>) -> Result<f32, LoadError> {
        let (least, most) = (range.start(), range.end());
        let what = match *most == f32::MAX {
            true => format!("a number of at least {least}"),
            false => format!("a number from {least} to {most}"),
        };
        let number = self.as_number().filter(|number| range.contains(number));
        number.ok_or_else(|| self.expected(&what))
    }

    /// A number above 0.
    pub(super) fn above_zero(self) -> Result<f32, LoadError> {
        let number = self.as_number().filter(|number| *number > 0.0);
        number.ok_or_else(|| self.expected("a number above 0"))
    }

    /// So many finite numbers in brackets, if it is that.
    pub(super) fn as_numbers<const N: usize>(&self) -> Option<[f32; N]> {
        let array = self.value.get_ref().as_array().filter(|array| array.len() == N)?;
        let mut numbers = [0.0; N];
        for (number, value) in numbers.iter_mut().zip(array.iter()) {
            *number = Value { value, ..*self }.as_number()?;
        }
        Some(numbers)
    }

    /// The values in brackets, if it is so many.
    pub(super) fn as_values<const N: usize>(&self) -> Option<[Value<'a>; N]> {
        let array = self.value.get_ref().as_array()?;
        let values: Vec<_> = array.iter().map(|value| Value { value, ..*self }).collect();
        values.try_into().ok()
    }

    /// A point or vector.
    pub(super) fn vector(self) -> Result<Vec3, LoadError> {
        let numbers = self.as_numbers();
        numbers.map(Vec3::from).ok_or_else(|| self.expected("three numbers, as in [1, 2.5, -3]"))
    }

    /// A direction, of unit length.
    pub(super) fn direction(self) -> Result<Vec3, LoadError> {
        let direction = self.as_numbers().map(|v| Vec3::from(v).normalize_or_zero());
        direction
            .filter(|direction| *direction != Vec3::ZERO)
            .ok_or_else(|| self.expected("a direction that is not [0, 0, 0], as in [0, 1, 0]"))
    }

    /// Light or a share of it: one number for all channels, three, or a colour of the web, none of them more than `most`.
    pub(super) fn color(self, most: f32) -> Result<Rgb, LoadError> {
        let color = match self.as_text() {
            Some(text) => web_color(text),
            None => self.as_number().map(Rgb::splat).or_else(|| self.as_numbers().map(Rgb::from)),
        };
        let is_share = |x: f32| (0.0..=most).contains(&x);
        color.filter(|color| color.to_array().into_iter().all(is_share)).ok_or_else(|| {
            let range = match most == f32::MAX {
                true => "at least 0".to_owned(),
                false => format!("from 0 to {most}"),
            };
            self.expected(&format!(
                "a colour: a number, three as in [0.8, 0.2, 0.1], each {range}, or \"#rrggbb\""
            ))
        })
    }
}

/// `#rrggbb` in sRGB, as linear light.
fn web_color(text: &str) -> Option<Rgb> {
    let digits = text.strip_prefix('#')?;
    if digits.len() != 6 || !digits.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return None;
    }
    let number = u32::from_str_radix(digits, 16).ok()?;
    let channel = |shift: u32| srgb_to_linear((number >> shift & 255) as f32 / 255.0);
    Some(Rgb::new(channel(16), channel(8), channel(0)))
}
