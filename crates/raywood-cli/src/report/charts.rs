//! Charts as inline SVG: lines over an axis and grouped bars, with a legend in HTML that wraps on narrow screens.

use std::fmt::Display;

use maud::{Markup, PreEscaped, html};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use raywood_lab::figures::{BarChart, Chart, Line, Plot, Scale, Series};

use super::axis::AxisRange;
use super::palette::{AXIS, GRID, IDEAL, INK, SERIES, Shade};
use super::values::number;
use crate::failure::Failure;

// In half pixels of the page, because plotters rounds to whole ones.
const WIDTH: u32 = 1040;
const PLOT_HEIGHT: u32 = 680;
const TEXT: u32 = 30;
const LINE: u32 = 4;
const MARK: i32 = 8;
const BAR: i32 = 32;

type Canvas<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

/// A chart with its title and legend.
pub(crate) fn figure(chart: &Chart) -> Result<Markup, Failure> {
    let (title, svg, legend) = match chart {
        Chart::Plot(plot) => (&plot.title, plot_svg(plot), plot_legend(plot)),
        Chart::Bars(bars) => (&bars.title, bars_svg(bars), bars_legend(bars)),
    };
    let svg = svg.map_err(|error| Failure::while_running(format_args!("{title}: {error}")))?;
    Ok(html! {
        figure {
            figcaption { (title) }
            @if legend.len() > 1 {
                ul.legend { @for (entry, name) in &legend { li { (entry) (name) } } }
            }
            div.chart role="img" aria-label=(title) { (PreEscaped(svg)) }
        }
    })
}

/// The series' colour: grey for what measurements are compared with, which takes no colour from the others.
fn plot_shades(plot: &Plot) -> Vec<Shade> {
    let mut measured = SERIES.iter().cycle();
    let shade = |series: &Series| match series.line {
        Line::Measured => *measured.next().unwrap_or(&INK),
        Line::Ideal => IDEAL,
    };
    plot.series.iter().map(shade).collect()
}

fn plot_legend(plot: &Plot) -> Vec<(Markup, &str)> {
    let shades = plot_shades(plot);
    let swatches = plot
        .series
        .iter()
        .enumerate()
        .map(|(number, series)| line_swatch(shades[number], number, series.line));
    swatches.zip(plot.series.iter().map(|series| series.name.as_str())).collect()
}

/// A piece of a line with its mark.
fn line_swatch(shade: Shade, number: usize, line: Line) -> Markup {
    let color = shade.html();
    let dashes = match line {
        Line::Measured => None,
        Line::Ideal => Some("5 3"),
    };
    let mark = match line {
        Line::Measured => mark_outline(number, [14, 7], 4),
        Line::Ideal => Vec::new(),
    };
    let points: Vec<_> = mark.iter().map(|[x, y]| format!("{x},{y}")).collect();
    html! {
        svg width="28" height="14" viewBox="0 0 28 14" aria-hidden="true" {
            line x1="1" y1="7" x2="27" y2="7" stroke=(color) stroke-width="2" stroke-dasharray=[dashes] {}
            @if !points.is_empty() { polygon points=(points.join(" ")) fill=(color) {} }
        }
    }
}

/// The mark of a series as a polygon around a point: a different shape for each of a few.
fn mark_outline(series: usize, [x, y]: [i32; 2], size: i32) -> Vec<[i32; 2]> {
    let s = size;
    let around = |offsets: &[[i32; 2]]| offsets.iter().map(|[dx, dy]| [x + dx, y + dy]).collect();
    let most = s * 5 / 4;
    let thin = (s / 3).max(1);
    match series % 6 {
        0 => {
            let corner = |i: i32| {
                let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 16.0).sin_cos();
                [(f64::from(s) * cos).round() as i32, (f64::from(s) * sin).round() as i32]
            };
            around(&(0..16).map(corner).collect::<Vec<_>>())
        }
        1 => around(&[[-s, -s], [s, -s], [s, s], [-s, s]]),
        2 => around(&[[0, -most], [most, s], [-most, s]]),
        3 => around(&[[0, -most], [most, 0], [0, most], [-most, 0]]),
        4 => around(&[[0, most], [most, -s], [-most, -s]]),
        _ => around(&[
            [-thin, -s],
            [thin, -s],
            [thin, -thin],
            [s, -thin],
            [s, thin],
            [thin, thin],
            [thin, s],
            [-thin, s],
            [-thin, thin],
            [-s, thin],
            [-s, -thin],
            [-thin, -thin],
        ]),
    }
}

fn plot_svg(plot: &Plot) -> Result<String, String> {
    let points = || plot.series.iter().flat_map(|series| &series.points);
    let x = AxisRange::around(plot.x.scale, points().map(|p| p[0]), 0.02);
    let y = AxisRange::around(plot.y.scale, points().map(|p| p[1]), 0.04);
    draw(PLOT_HEIGHT, |root| {
        let mut chart = ChartBuilder::on(root)
            .margin_top(TEXT / 2)
            .margin_right(TEXT)
            .margin_bottom(6)
            .margin_left(6)
            .x_label_area_size(3 * TEXT)
            .y_label_area_size(number_width(y.longest_tick()) + 2 * TEXT)
            .build_cartesian_2d(x.clone(), y.clone())
            .map_err(text)?;
        chart
            .configure_mesh()
            .max_light_lines(0)
            .bold_line_style(GRID.drawn().stroke_width(2))
            .axis_style(AXIS.drawn().stroke_width(2))
            .label_style(letters(INK))
            .axis_desc_style(letters(INK))
            .x_desc(&plot.x.label)
            .y_desc(&plot.y.label)
            .draw()
            .map_err(text)?;

        // What measurements are compared with lies below them.
        let shades = plot_shades(plot);
        let mut order: Vec<_> = (0..plot.series.len()).collect();
        order.sort_by_key(|&number| plot.series[number].line == Line::Measured);
        for number in order {
            let series = &plot.series[number];
            let style = shades[number].drawn();
            let shown = |p: &&[f64; 2]| x.shows(p[0]) && y.shows(p[1]);
            let points: Vec<_> = series.points.iter().filter(shown).map(|&[x, y]| (x, y)).collect();
            match series.line {
                Line::Ideal => {
                    let line = style.stroke_width(LINE - 1);
                    let dashes = DashedLineSeries::new(points, 14, 10, line);
                    chart.draw_series(dashes).map_err(text)?;
                }
                Line::Measured => {
                    let line = style.stroke_width(LINE);
                    chart
                        .draw_series(LineSeries::new(points.iter().copied(), line))
                        .map_err(text)?;
                    let mark = |point: &(f64, f64)| {
                        let outline = mark_outline(number, [0, 0], MARK);
                        let outline = outline.iter().map(|&[x, y]| (x, y)).collect::<Vec<_>>();
                        EmptyElement::at(*point) + Polygon::new(outline, style.filled())
                    };
                    chart.draw_series(points.iter().map(mark)).map_err(text)?;
                }
            }
        }
        Ok(())
    })
}

fn bars_legend(bars: &BarChart) -> Vec<(Markup, &str)> {
    let swatch = |shade: &Shade| {
        html! {
            svg width="14" height="14" viewBox="0 0 14 14" aria-hidden="true" {
                rect x="1" y="1" width="12" height="12" fill=(shade.html()) {}
            }
        }
    };
    let shades = SERIES.iter().cycle();
    bars.series.iter().zip(shades).map(|(series, shade)| (swatch(shade), &*series.name)).collect()
}

/// Bars lie, so that categories may have long names.
fn bars_svg(bars: &BarChart) -> Result<String, String> {
    let categories = bars.categories.len();
    let per_group = bars.series.len().max(1) as i32;
    let group = per_group * BAR + BAR * 3 / 5;
    let plot_height = (group * categories.max(1) as i32) as u32;
    let values = || bars.series.iter().flat_map(|series| series.values.iter().flatten().copied());
    let value_axis = AxisRange::around(bars.value.scale, values().chain(root_of_bars(bars)), 0.22);
    let longest = bars.categories.iter().map(|name| name.chars().count()).max().unwrap_or(0);
    let names_width = number_width(longest).min(WIDTH / 2) + TEXT / 2;
    draw(plot_height + 3 * TEXT + TEXT / 2 + 6, |root| {
        let mut chart = ChartBuilder::on(root)
            .margin_top(TEXT / 2)
            .margin_right(TEXT)
            .margin_bottom(6)
            .margin_left(6)
            .x_label_area_size(3 * TEXT)
            .y_label_area_size(names_width)
            .build_cartesian_2d(
                value_axis.clone(),
                RangedCoordf64::from(categories.max(1) as f64..0.0),
            )
            .map_err(text)?;
        chart
            .configure_mesh()
            .max_light_lines(0)
            .disable_y_mesh()
            .y_labels(0)
            .y_label_formatter(&|_| String::new())
            .bold_line_style(GRID.drawn().stroke_width(2))
            .axis_style(AXIS.drawn().stroke_width(2))
            .label_style(letters(INK))
            .axis_desc_style(letters(INK))
            .x_desc(&bars.value.label)
            .draw()
            .map_err(text)?;

        let group_height = f64::from(group);
        for (category, name) in bars.categories.iter().enumerate() {
            let top = category as f64 + 0.5 * f64::from(group - per_group * BAR) / group_height;
            let style = letters(INK).pos(Pos::new(HPos::Right, VPos::Center));
            let name_at = (value_axis.min(), category as f64 + 0.5);
            let label = EmptyElement::at(name_at) + Text::new(name.clone(), (-12, 0), style);
            chart.draw_series([label]).map_err(text)?;

            for (number_in_group, series) in bars.series.iter().enumerate() {
                let shown = series.values.get(category).copied().flatten();
                let Some(value) = shown.filter(|value| value_axis.shows(*value)) else { continue };
                let shade = SERIES[number_in_group % SERIES.len()];
                let height = f64::from(BAR) / group_height;
                let from = top + number_in_group as f64 * height;
                // Linear axes hold zero, where bars begin; logarithmic ones have none.
                let begin = value_axis.min().max(0.0);
                let corners = [(begin, from + 0.06 * height), (value, from + 0.94 * height)];
                let bar = Rectangle::new(corners, shade.drawn().filled());
                chart.draw_series([bar]).map_err(text)?;
                let style = letters(INK).pos(Pos::new(HPos::Left, VPos::Center));
                let value_text = number(value, bars.decimals);
                let end = (value.max(begin), from + 0.5 * height);
                let label = EmptyElement::at(end) + Text::new(value_text, (10, 0), style);
                chart.draw_series([label]).map_err(text)?;
            }
        }
        Ok(())
    })
}

/// Where bars on a logarithmic axis begin: at a power of ten that leaves some length to the shortest.
fn root_of_bars(bars: &BarChart) -> Option<f64> {
    let values = bars.series.iter().flat_map(|series| series.values.iter().flatten().copied());
    let least = values.filter(|value| *value > 0.0).min_by(f64::total_cmp)?;
    (bars.value.scale == Scale::Logarithmic).then(|| 10f64.powf((0.7 * least).log10().floor()))
}

/// About how wide so many letters or digits are.
fn number_width(letters: usize) -> u32 {
    (letters as u32 * TEXT * 56) / 124 + TEXT / 2
}

fn letters<'a>(shade: Shade) -> TextStyle<'a> {
    ("sans-serif", TEXT as i32).into_font().color(&shade.drawn())
}

fn draw(
    height: u32,
    content: impl FnOnce(&Canvas<'_>) -> Result<(), String>,
) -> Result<String, String> {
    let mut svg = String::new();
    let root = SVGBackend::with_string(&mut svg, (WIDTH, height)).into_drawing_area();
    content(&root)?;
    root.present().map_err(text)?;
    drop(root);
    Ok(svg)
}

fn text(error: impl Display) -> String {
    error.to_string()
}
