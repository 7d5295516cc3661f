//! The legend of a heat map: a strip below the picture with a bar of the colours, numbers, and what was counted in which structure.

use super::HeatMap;
use super::colors::color;
use super::font::Font;
use super::scale::{number, ticks, usable};
use crate::rgb_image::RgbImage;

const BACKGROUND: [u8; 3] = [24, 24, 27];
const TEXT: [u8; 3] = [232, 232, 232];
const TICK: [u8; 3] = [160, 160, 160];

/// The longest word must fit a row, and so must two numbers.
const LEAST_COLUMNS: u32 = 12;

/// More numbers than this at a bar are no clearer.
const MOST_INTERVALS: usize = 6;

impl HeatMap {
    /// A picture of the map with a legend on a strip below it, which covers nothing. `maximum` must be that of the picture.
    ///
    /// The picture may be that of [`picture`](Self::picture) or one with more drawn into it. The size of the text follows that of the picture; the
    /// strip is never narrower than its words need, and then the picture stands in its middle.
    pub fn with_legend(&self, picture: &RgbImage, maximum: f32) -> RgbImage {
        let layout = Layout::new(self, maximum, picture.width(), picture.height());
        picture.stacked_on(&layout.draw(), BACKGROUND)
    }
}

/// A line of text and where its upper left corner is.
struct Line {
    x: u32,
    y: u32,
    text: String,
}

/// What stands where on the strip.
struct Layout {
    font: Font,
    width: u32,
    height: u32,
    lines: Vec<Line>,
    /// The bar's left, top, width and height.
    bar: [u32; 4],
    /// Columns of the marks below the bar.
    marks: Vec<u32>,
}

impl Layout {
    fn new(map: &HeatMap, maximum: f32, picture_width: u32, picture_height: u32) -> Self {
        // Rows of about a hundred characters; on flat pictures smaller ones, so that the strip does not outgrow them.
        let font = Font::of_height((picture_width / 50).min(picture_height / 12));
        let (unit, row) = (font.width(), font.height());
        let width = picture_width.max((LEAST_COLUMNS + 2) * unit);
        let (left, room) = (unit, width - 2 * unit);
        let columns = (room / unit) as usize;

        // What it is on the left, how much on the right; below each other where there is no room.
        let what = [map.quantity.label().to_owned(), map.structure.name().to_owned()];
        let mean = format!("mean {}", number(map.mean() as f32));
        let how_much = [mean, format!("maximum {}", number(map.max()))];
        let [what_line, how_much_line] = [&what, &how_much].map(|parts| parts.join(", "));
        let mut lines = Vec::new();
        let mut y = row / 2;
        if what_line.len() + 3 + how_much_line.len() <= columns {
            let x = left + room - how_much_line.len() as u32 * unit;
            lines.push(Line { x: left, y, text: what_line });
            lines.push(Line { x, y, text: how_much_line });
            y += row;
        } else {
            for text in flow(what.iter().chain(&how_much), columns) {
                lines.push(Line { x: left, y, text });
                y += row;
            }
        }

        // The bar, and as many numbers as have room beside each other.
        y += row / 4;
        let bar = [left, y, room, row.max(20) * 3 / 4];
        y += bar[3] + row / 4;
        let maximum = usable(maximum);
        let clipped = map.pixels_above(maximum) > 0;
        let numbers = |intervals| numbers(maximum, clipped, intervals, left, room, unit);
        let placed = (2..=MOST_INTERVALS).rev().find_map(numbers);
        let placed = placed.or_else(|| numbers(1)).unwrap_or_default();
        let marks = placed.iter().map(|(mark, ..)| *mark).collect();
        lines.extend(placed.into_iter().map(|(_, x, text)| Line { x, y, text }));
        y += row + row / 4;
        Self { font, width, height: y, lines, bar, marks }
    }

    fn draw(&self) -> RgbImage {
        let mut strip = RgbImage::filled(self.width, self.height, BACKGROUND);
        let [left, top, width, height] = self.bar;
        for x in 0..width {
            strip.fill(left + x, top, 1, height, color((x as f32 + 0.5) / width as f32));
        }
        let thickness = (self.font.height() / 16).max(1);
        for &mark in &self.marks {
            // The last mark stands at the bar's end, not beyond.
            let x = mark.min(left + width - thickness);
            strip.fill(x, top + height, thickness, self.font.height() / 4, TICK);
        }
        for Line { x, y, text } in &self.lines {
            self.font.draw(&mut strip, (*x, *y), text, TEXT);
        }
        strip
    }
}

/// The numbers at a bar: where each has its mark, where its text begins, and the text. `None` if they would touch.
fn numbers(
    maximum: f32,
    clipped: bool,
    intervals: usize,
    left: u32,
    room: u32,
    unit: u32,
) -> Option<Vec<(u32, u32, String)>> {
    let mut placed: Vec<(u32, u32, String)> = Vec::new();
    let mut free_from = left;
    for tick in ticks(maximum, intervals) {
        let last = tick == maximum;
        let text = format!("{}{}", if last && clipped { ">=" } else { "" }, number(tick));
        let mark = left + (f64::from(tick / maximum) * f64::from(room)) as u32;
        // Centred below the mark, but within the bar's ends.
        let length = text.len() as u32 * unit;
        let x = mark.saturating_sub(length / 2).clamp(left, left + room - length.min(room));
        if length > room || x < free_from {
            return None;
        }
        free_from = x + length + unit;
        placed.push((mark, x, text));
    }
    Some(placed)
}

/// Parts of a text in rows of at most `columns` characters: with commas between those in one row, broken between words where a part is longer
/// than a row, and after hyphens or anywhere where a word is.
fn flow<'a>(parts: impl Iterator<Item = &'a String>, columns: usize) -> Vec<String> {
    let mut rows: Vec<String> = Vec::new();
    for part in parts {
        match rows.last_mut() {
            Some(row) if row.len() + 2 + part.len() <= columns => *row += &format!(", {part}"),
            _ => rows.extend(broken(part, columns)),
        }
    }
    rows
}

/// A text in rows of at most `columns` characters. The text is ASCII, as all names and labels are.
fn broken(text: &str, columns: usize) -> Vec<String> {
    let columns = columns.max(1);
    let mut rows = Vec::new();
    let mut rest: Vec<char> = text.chars().collect();
    while rest.len() > columns {
        let at_space = (1..=columns).rev().find(|&i| rest[i] == ' ');
        let after_hyphen = (1..=columns).rev().find(|&i| rest[i - 1] == '-');
        let end = at_space.or(after_hyphen).unwrap_or(columns);
        let tail = rest.split_off(end);
        rows.push(rest.into_iter().collect());
        rest = tail.into_iter().skip_while(|&c| c == ' ').collect();
    }
    rows.push(rest.into_iter().collect());
    rows
}

#[cfg(test)]
mod tests {
    use raywood::StructureKind;

    use super::*;
    use crate::HeatQuantity;

    fn map(
        quantity: HeatQuantity,
        structure: StructureKind,
        width: u32,
        height: u32,
        most: f32,
    ) -> HeatMap {
        let values = (0..width * height).map(|i| if i % 7 == 0 { most } else { 1.0 }).collect();
        HeatMap { width, height, quantity, structure, values, rays: 0 }
    }

    /// Every line, number and mark of every legend lies on its strip with a margin, and none touches another.
    #[test]
    fn nothing_is_cut_off_at_any_size() {
        let sizes = [
            (1, 1),
            (1, 500),
            (500, 1),
            (64, 64),
            (97, 64),
            (160, 100),
            (320, 200),
            (640, 400),
            (1280, 800),
        ];
        for (width, height) in sizes.into_iter().chain([(3840, 2160), (8000, 3)]) {
            for &quantity in HeatQuantity::ALL {
                for &structure in StructureKind::ALL {
                    for (most, maximum) in [(0.0, 1.0), (1234.5, 1000.0), (8e6, 1e6), (3e9, 1e-6)] {
                        let map = map(quantity, structure, 8, 8, most);
                        let layout = Layout::new(&map, maximum, width, height);
                        check(&layout);
                        let words: String =
                            layout.lines.iter().map(|line| line.text.as_str()).collect();
                        let squeezed = |text: &str| text.replace([' ', ','], "");
                        for expected in [quantity.label(), structure.name(), "mean", "maximum"] {
                            assert!(squeezed(&words).contains(&squeezed(expected)), "{words}");
                        }
                        assert!(layout.marks.len() >= 2);
                        assert_eq!(words.contains(">="), most > maximum, "{words}");
                    }
                }
            }
        }
    }

    fn check(layout: &Layout) {
        let (unit, row) = (layout.font.width(), layout.font.height());
        let rectangles: Vec<_> = layout
            .lines
            .iter()
            .map(|line| [line.x, line.y, line.text.len() as u32 * unit, row])
            .chain([layout.bar])
            .collect();
        for (i, &[x, y, width, height]) in rectangles.iter().enumerate() {
            assert!(x >= unit && x + width + unit <= layout.width, "column {x}, {width} wide");
            assert!(y >= row / 4 && y + height + row / 4 <= layout.height, "row {y}");
            for &[x2, y2, width2, height2] in &rectangles[..i] {
                let apart =
                    x + width <= x2 || x2 + width2 <= x || y + height <= y2 || y2 + height2 <= y;
                assert!(apart, "two things at {x}, {y}");
            }
        }
    }

    #[test]
    fn the_text_is_drawn_and_the_picture_is_left_alone() {
        for (width, height) in [(64, 64), (400, 250), (3840, 40), (3840, 2160)] {
            let map = map(HeatQuantity::Tests, StructureKind::BvhSahBinned, width, height, 60.0);
            let picture = map.picture(50.0);
            let whole = map.with_legend(&picture, 50.0);
            assert!(whole.height() > height + 60 && whole.width() >= width);
            let left = (whole.width() - width) / 2;
            for y in 0..height {
                let row = &whole.row(y)[3 * left as usize..][..3 * width as usize];
                assert_eq!(row, picture.row(y));
            }
            // Bright pixels of text there are, but none in the margin.
            let bright = |x, y| whole.pixel(x, y).is_some_and(|c| c.iter().all(|&byte| byte > 128));
            let strip = height..whole.height();
            let count = strip
                .clone()
                .flat_map(|y| (0..whole.width()).map(move |x| (x, y)))
                .filter(|&(x, y)| bright(x, y));
            assert!(count.count() > 300, "{width} x {height}");
            for y in strip {
                for x in (0..5).chain(whole.width() - 5..whole.width()) {
                    assert_eq!(whole.pixel(x, y), Some(BACKGROUND));
                }
            }
        }
    }

    #[test]
    fn long_texts_are_broken_at_words_then_hyphens() {
        assert_eq!(broken("primitive tests per ray", 12), ["primitive", "tests per", "ray"]);
        assert_eq!(broken("bvh-sah-binned", 12), ["bvh-sah-", "binned"]);
        assert_eq!(broken("abcdefgh", 3), ["abc", "def", "gh"]);
        let parts = ["one".to_owned(), "two".to_owned(), "three".to_owned()];
        assert_eq!(flow(parts.iter(), 8), ["one, two", "three"]);
    }
}
