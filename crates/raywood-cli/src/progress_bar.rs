//! What long work shows on a terminal: what it is doing, how far it is, how long it will take. Silent elsewhere.

use std::io::{IsTerminal, stderr};
use std::ops::ControlFlow;
use std::thread;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use raywood_render::{Progress, Standing};

/// How often the line is drawn anew.
const INTERVAL: Duration = Duration::from_millis(100);

/// Runs a step of unknown length while its name is shown.
pub(crate) fn during_step<T>(name: &str, step: impl FnOnce() -> T) -> T {
    during_steps(|say| {
        say(name);
        step()
    })
}

/// Runs several steps, each of which says its name when it begins.
pub(crate) fn during_steps<T>(steps: impl FnOnce(&mut (dyn FnMut(&str) + Send)) -> T) -> T {
    let line = new_line("{spinner} {msg} {elapsed}", None);
    line.enable_steady_tick(INTERVAL);
    let result = steps(&mut |name| line.set_message(name.to_owned()));
    line.finish_and_clear();
    result
}

/// In how many steps bars grow whose length is a share.
const STEPS: u64 = 1000;

/// Runs a build while a bar shows how far it is, which the build tells.
pub(crate) fn during_build<T>(
    build: impl FnOnce(&(dyn Fn(f64) -> ControlFlow<()> + Sync)) -> T,
) -> T {
    let bar = new_line("building [{wide_bar}] {percent}% {eta} left", Some(STEPS));
    let result = build(&|done| {
        bar.set_position((done * STEPS as f64) as u64);
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    result
}

/// Runs a rendering in passes while a bar shows how far it is, how many samples a pixel has and how noisy the picture is.
pub(crate) fn during_passes<T: Send>(
    progress: &Progress,
    rendering: impl FnOnce() -> T + Send,
) -> T {
    let template = "rendering [{wide_bar}] {percent}% {msg}{eta} left";
    watched(template, rendering, |bar| {
        let Standing { samples, noise, fraction } = progress.standing();
        bar.set_length(STEPS);
        bar.set_position((fraction * STEPS as f64) as u64);
        let noise = noise.map_or(String::new(), |noise| format!("noise {:.1}%, ", 100.0 * noise));
        bar.set_message(format!("{samples} samples, {noise}"));
    })
}

/// Runs a rendering while a bar shows how far it is.
pub(crate) fn during_rendering<T: Send>(
    progress: &Progress,
    rendering: impl FnOnce() -> T + Send,
) -> T {
    watched("rendering [{wide_bar}] {percent}% {eta} left", rendering, |bar| {
        bar.set_length(progress.pixels_total().max(1));
        bar.set_position(progress.pixels_done());
    })
}

/// Runs a rendering while a line is drawn anew again and again.
fn watched<T: Send>(
    template: &str,
    rendering: impl FnOnce() -> T + Send,
    update: impl Fn(&ProgressBar),
) -> T {
    if !stderr().is_terminal() {
        return rendering();
    }
    let bar = new_line(template, Some(0));
    thread::scope(|scope| {
        let rendering = scope.spawn(rendering);
        while !rendering.is_finished() {
            update(&bar);
            thread::sleep(INTERVAL);
        }
        bar.finish_and_clear();
        rendering.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// Runs work on rows while a bar shows how many are done, or a counter where nobody knows how many there are. The work says of rows that they are done.
pub(crate) fn during_rows<T>(
    name: &str,
    total: Option<u64>,
    work: impl FnOnce(&(dyn Fn(u64) + Sync)) -> T,
) -> T {
    let line = match total {
        Some(_) => new_line("{msg} [{wide_bar}] {percent}% {eta} left", total),
        None => new_line("{spinner} {msg} {human_pos} {elapsed}", None),
    };
    line.set_message(name.to_owned());
    let result = work(&|rows| line.inc(rows));
    line.finish_and_clear();
    result
}

/// A line on standard error, hidden where that is no terminal.
fn new_line(template: &str, length: Option<u64>) -> ProgressBar {
    let target = if stderr().is_terminal() {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    };
    let style =
        ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::with_draw_target(length, target).with_style(style.progress_chars("=> "))
}
