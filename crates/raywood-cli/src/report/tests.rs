//! Pages with everything that can stand in them, harmless and not.

use maud::html;
use raywood_lab::figures::{Axis, BarChart, BarSeries, Cell, Chart, Plot, Series, Table};
use raywood_testkit::html::{check_well_formed, is_self_contained};

use super::{charts, page};

/// A name that would break a page that does not escape.
const NASTY: &str = "a <script>\"b\" & 'c'</p>";

fn plot(x: Axis, y: Axis, points: &[[f64; 2]]) -> Chart {
    let measured = |name: &str| Series::measured(name, points.to_vec());
    let series = vec![measured(NASTY), measured("b"), Series::ideal("ideal", points.to_vec())];
    Chart::Plot(Plot { title: NASTY.to_owned(), x, y, series })
}

fn bars(values: &[Option<f64>]) -> Chart {
    let series = |name: &str| BarSeries { name: name.to_owned(), values: values.to_vec() };
    Chart::Bars(BarChart {
        title: "bars".to_owned(),
        value: Axis::linear("time per ray (ns)"),
        decimals: 1,
        categories: (0..values.len()).map(|i| format!("{NASTY} {i}")).collect(),
        series: vec![series("first"), series(NASTY)],
    })
}

#[test]
fn pages_are_well_formed_and_load_nothing() {
    let mut table = Table::new(NASTY, &[NASTY, "count"]);
    table.rows.push(vec![Cell::text(NASTY), Cell::Count(1_234_567)]);
    let points = [[1e3, 10.0], [1e6, 1000.0], [2e6, 70.0]];
    let charts = [
        plot(Axis::logarithmic(NASTY), Axis::logarithmic("time (ns)"), &points),
        plot(Axis::linear("threads"), Axis::linear(NASTY), &points),
        bars(&[Some(10.0), None, Some(123.4)]),
    ];
    let body = html! {
        (page::facts(&[(NASTY, NASTY.to_owned())]))
        (page::table(&table))
        @for chart in &charts { (charts::figure(chart).expect("a chart")) }
    };
    let page = page::html(NASTY, "p{color:red}", &body);
    assert_eq!(check_well_formed(&page), Ok(()));
    assert!(is_self_contained(&page));
    assert!(page.contains("1,234,567") && page.contains("123.4"));
    assert!(!page.contains("<script>"));
}

#[test]
fn charts_without_sound_values_are_drawn_empty() {
    let nothing: &[[f64; 2]] = &[];
    let odd = [[f64::NAN, 1.0], [1.0, f64::INFINITY], [0.0, -1.0], [1e-300, 1e300]];
    for points in [nothing, &odd, &[[5.0, 5.0]]] {
        for chart in [
            plot(Axis::logarithmic("x"), Axis::logarithmic("y"), points),
            plot(Axis::linear("x"), Axis::linear("y"), points),
        ] {
            let figure = charts::figure(&chart).expect("a chart").into_string();
            assert_eq!(check_well_formed(&figure), Ok(()));
            assert!(!figure.contains("NaN") && !figure.contains("inf"), "{figure}");
        }
    }
    for values in [&[][..], &[None], &[Some(f64::NAN), Some(-1.0)], &[Some(0.0)]] {
        let figure = charts::figure(&bars(values)).expect("a chart").into_string();
        assert_eq!(check_well_formed(&figure), Ok(()));
    }
}

#[test]
fn a_chart_shows_every_point_and_every_bar() {
    let points = [[1.0, 1.0], [2.0, 4.0], [3.0, 9.0]];
    let chart = plot(Axis::linear("x"), Axis::linear("y"), &points);
    let figure = charts::figure(&chart).expect("a chart").into_string();
    // Three marks for each of two measured lines, and two in the legend.
    assert_eq!(figure.matches("<polygon").count(), 3 * 2 + 2);
    let figure = charts::figure(&bars(&[Some(3.0), None, Some(5.0)])).expect("a chart");
    // Two bars in each of two series, and two in the legend.
    assert_eq!(figure.into_string().matches("<rect").count(), 2 * 2 + 2);
}
