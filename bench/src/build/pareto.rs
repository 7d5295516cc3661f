//! What a tree costs to build against what it costs to trace, as a picture: a panel for each scene, a mark for each way to build, and the
//! front of those that no other beats in both.

use std::collections::BTreeMap;
use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use serde_json::Value;

use super::labels::{Rect, places};
use crate::peers::PEERS;
use crate::table::{count, list};

const PANEL: (u32, u32) = (620, 470);
const LEGEND: u32 = 36;
const TEXT: u32 = 14;
const INK: RGBColor = RGBColor(0x3C, 0x40, 0x43);
const GRID: RGBColor = RGBColor(0xE3, 0xE5, 0xE8);
const FRONT: RGBColor = RGBColor(0x9A, 0xA0, 0xA6);

/// Of the libraries, in their order; Okabe and Ito's, darkened.
const COLORS: [RGBColor; 5] = [
    RGBColor(0x00, 0x67, 0xA5),
    RGBColor(0xC0, 0x4A, 0x00),
    RGBColor(0x00, 0x80, 0x5C),
    RGBColor(0xA8, 0x4C, 0x8C),
    RGBColor(0x9A, 0x6A, 0x00),
];

/// Nanoseconds a ray through the tree of a build: the geometric mean over the sets, of each the library's best mode.
pub(super) fn tracing_time(build: &Value) -> Option<f64> {
    let mut best = BTreeMap::<&str, f64>::new();
    for trace in build["traces"].as_array()? {
        if let (Some(set), Some(ns)) = (trace["set"].as_str(), trace["ns_per_ray"].as_f64()) {
            best.entry(set).and_modify(|least| *least = least.min(ns)).or_insert(ns);
        }
    }
    let mean = best.values().map(|ns| ns.ln()).sum::<f64>() / best.len() as f64;
    mean.is_finite().then(|| mean.exp())
}

/// One way to build.
#[derive(Clone, Debug, PartialEq)]
struct Point {
    /// The library's place in the order of all.
    peer: usize,
    preset: String,
    build_ms: f64,
    trace_ns: f64,
}

/// Of the points those that no other is as good as in both and better in one, from the fastest build on.
fn front(points: &[Point]) -> Vec<&Point> {
    let mut order: Vec<_> = points.iter().collect();
    order.sort_by(|a, b| a.build_ms.total_cmp(&b.build_ms).then(a.trace_ns.total_cmp(&b.trace_ns)));
    let mut least = f64::INFINITY;
    order.retain(|point| {
        let better = point.trace_ns < least;
        least = least.min(point.trace_ns);
        better
    });
    order
}

/// The picture as SVG.
///
/// # Errors
///
/// The JSON is not that of a run with `--trace`.
pub(crate) fn svg(run: &Value) -> Result<String, String> {
    let (scenes, builds) = (list(run, "scenes")?, list(run, "builds")?);
    let mut panels: Vec<(String, Vec<Point>)> = Vec::new();
    let places: Vec<_> = builds.iter().map(|build| (&build["scene"], &build["threads"])).collect();
    for (number, place) in places.iter().enumerate() {
        if places[..number].contains(place) {
            continue;
        }
        let (scene, threads) = *place;
        let of_place = builds.iter().zip(&places).filter(|(_, other)| *other == place);
        let points: Vec<_> = of_place.filter_map(|(build, _)| point(build)).collect();
        let triangles = scenes.iter().find(|entry| entry["name"] == *scene);
        let triangles = triangles.map_or("?".to_owned(), |entry| count(&entry["triangles"]));
        let plural = if *threads == 1 { "" } else { "s" };
        let name = scene.as_str().unwrap_or("?");
        if !points.is_empty() {
            panels
                .push((format!("{name}, {triangles} triangles, {threads} thread{plural}"), points));
        }
    }
    if panels.is_empty() {
        return Err("nothing was traced: make the run with --trace".to_owned());
    }
    draw(&panels).map_err(|error| error.to_string())
}

fn point(build: &Value) -> Option<Point> {
    Some(Point {
        peer: PEERS.iter().position(|peer| build["peer"] == peer.name)?,
        preset: build["preset"].as_str()?.trim_end_matches("_build").replace('_', " "),
        build_ms: build["warm_ms"].as_f64()?,
        trace_ns: tracing_time(build)?,
    })
}

type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Failed = Box<dyn std::error::Error>;

/// All panels below each other, under one legend.
fn draw(panels: &[(String, Vec<Point>)]) -> Result<String, Failed> {
    let mut svg = String::new();
    {
        let height = LEGEND + PANEL.1 * panels.len() as u32;
        let root = SVGBackend::with_string(&mut svg, (PANEL.0, height)).into_drawing_area();
        root.fill(&WHITE)?;
        let (top, rest) = root.split_vertically(LEGEND);
        legend(&top, panels)?;
        for (area, (title, points)) in rest.split_evenly((panels.len(), 1)).iter().zip(panels) {
            panel(area, title, points)?;
        }
        root.present()?;
    }
    Ok(svg)
}

fn legend(area: &Canvas<'_>, panels: &[(String, Vec<Point>)]) -> Result<(), Failed> {
    let mut x = 70;
    let present = |peer| panels.iter().any(|(_, points)| points.iter().any(|p| p.peer == peer));
    for (number, peer) in PEERS.iter().enumerate().filter(|(number, _)| present(*number)) {
        let style = COLORS[number % COLORS.len()];
        area.draw(&Circle::new((x, 18), 5, style.filled()))?;
        area.draw(&Text::new(peer.name, (x + 10, 18), letters(INK, HPos::Left)))?;
        x += 24 + 8 * peer.name.len() as i32;
    }
    area.draw(&PathElement::new([(x, 18), (x + 24, 18)], FRONT.stroke_width(2)))?;
    area.draw(&Text::new("no other beats these in both", (x + 30, 18), letters(INK, HPos::Left)))?;
    Ok(())
}

fn panel(area: &Canvas<'_>, title: &str, points: &[Point]) -> Result<(), Failed> {
    let x = LogAxis::around(points.iter().map(|point| point.build_ms), 0.12);
    let y = LogAxis::around(points.iter().map(|point| point.trace_ns), 0.03);
    let mut chart = ChartBuilder::on(area)
        .caption(title, letters(INK, HPos::Left))
        .margin_top(14)
        .margin_right(20)
        .margin_left(6)
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(x, y)?;
    chart
        .configure_mesh()
        .max_light_lines(0)
        .bold_line_style(GRID)
        .axis_style(FRONT)
        .label_style(letters(INK, HPos::Left))
        .axis_desc_style(letters(INK, HPos::Left))
        .x_desc("ms to build, memory warm")
        .y_desc("ns a ray, geometric mean of the sets")
        .draw()?;

    // The front goes in steps: who is between two of its marks has to build as long as the left one at least.
    let mut steps = Vec::new();
    for Point { build_ms, trace_ns, .. } in front(points) {
        let (x, y) = (build_ms.log10(), trace_ns.log10());
        if let Some(&(_, before)) = steps.last() {
            steps.push((x, before));
        }
        steps.push((x, y));
    }
    let corners: Vec<_> = steps.iter().map(|corner| chart.backend_coord(corner)).collect();
    let lines: Vec<_> = corners.windows(2).map(|pair| Rect::between(pair[0], pair[1], 1)).collect();
    chart.draw_series(LineSeries::new(steps, FRONT.stroke_width(2)))?;

    let place = |point: &Point| (point.build_ms.log10(), point.trace_ns.log10());
    let label = |point: &Point| (chart.backend_coord(&place(point)), text_width(&point.preset));
    let labels: Vec<_> = points.iter().map(label).collect();
    let (across, down) = chart.plotting_area().get_pixel_range();
    let frame = Rect::between((across.start, down.start), (across.end, down.end), 0);
    for (point, offset) in points.iter().zip(places(&labels, &lines, frame)) {
        let color = COLORS[point.peer % COLORS.len()];
        let label = Text::new(point.preset.clone(), offset, letters(color, HPos::Center));
        let mark = EmptyElement::at(place(point)) + Circle::new((0, 0), 5, color.filled()) + label;
        chart.draw_series([mark])?;
    }
    Ok(())
}

/// An axis on which equal factors are equally long, by the decimal logarithms of values.
struct LogAxis {
    range: Range<f64>,
    marks: Vec<f64>,
}

impl LogAxis {
    /// Around values, with a share of its length as room at both ends, marked at 1, 2, 5 and their tenfolds.
    fn around(values: impl Iterator<Item = f64>, room: f64) -> Self {
        let ends = |(least, most): (f64, f64), log: f64| (least.min(log), most.max(log));
        let (least, most) = values.map(f64::log10).fold((f64::INFINITY, f64::NEG_INFINITY), ends);
        let room = room * (most - least) + 0.06;
        let range = least - room..most + room;
        let factors = if most - least < 3.0 { &[1.0, 2.0, 5.0][..] } else { &[1.0] };
        let decades = range.start.floor() as i32..=range.end.ceil() as i32;
        let marks = decades
            .flat_map(|decade| factors.iter().map(move |f: &f64| f64::from(decade) + f.log10()))
            .filter(|mark| range.contains(mark))
            .collect();
        Self { range, marks }
    }
}

impl Ranged for LogAxis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, log: &f64, (from, to): (i32, i32)) -> i32 {
        let share = (log - self.range.start) / (self.range.end - self.range.start);
        from + (share * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.marks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

impl ValueFormatter<f64> for LogAxis {
    fn format_ext(&self, log: &f64) -> String {
        ((1e3 * 10f64.powf(*log)).round() / 1e3).to_string()
    }
}

/// About how wide text is, in pixels: which fonts there are is not known.
fn text_width(text: &str) -> i32 {
    let width = |letter: char| match letter {
        'i' | 'l' | 't' | 'f' | ' ' => 4,
        'm' | 'w' => 10,
        letter if letter.is_uppercase() => 9,
        _ => 7,
    };
    text.chars().map(width).sum()
}

fn letters(color: RGBColor, place: HPos) -> TextStyle<'static> {
    let style = ("sans-serif", TEXT).into_font().color(&color);
    style.pos(Pos::new(place, VPos::Center))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn the_front_is_who_is_beaten_by_nobody() {
        let point =
            |build_ms, trace_ns| Point { peer: 0, preset: String::new(), build_ms, trace_ns };
        let points =
            [point(5.0, 1.0), point(1.0, 9.0), point(2.0, 9.0), point(3.0, 4.0), point(4.0, 6.0)];
        let expected = [&points[1], &points[3], &points[0]];
        assert_eq!(front(&points), expected);
    }

    #[test]
    fn every_build_that_was_traced_is_in_the_picture() {
        let build = |peer: &str, preset: &str, ms: f64| {
            json!({ "scene": "hall", "threads": 1, "peer": peer, "preset": preset, "warm_ms": ms, "traces": [
                { "set": "primary", "mode": "a", "ns_per_ray": 90.0 },
                { "set": "primary", "mode": "b", "ns_per_ray": 10.0 },
                { "set": "diffuse", "mode": "a", "ns_per_ray": 40.0 },
                { "set": "diffuse", "mode": "b", "wrong": "why" },
            ] })
        };
        let mut run = json!({
            "scenes": [{ "name": "hall", "triangles": 1_000_000 }],
            "builds": [build("raywood", "fastest", 20.0), build("obvhs", "very_fast_build", 30.0)],
        });
        let time = tracing_time(&run["builds"][0]).expect("traced");
        assert!((time - 20.0).abs() < 1e-9, "{time}");
        let picture = svg(&run).expect("a picture");
        for text in ["hall, 1.0M triangles, 1 thread", "fastest", "very fast", "raywood", "obvhs"] {
            assert!(picture.contains(text), "{text}");
        }
        run["builds"] = json!([]);
        assert!(svg(&run).is_err());
        assert!(svg(&json!({})).is_err());
    }
}
