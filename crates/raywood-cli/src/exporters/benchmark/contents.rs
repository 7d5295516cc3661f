//! What a benchmark shows people: tables of rounded numbers, and what must be said of them.

use raywood::{SimdLevel, StructureKind};
use raywood_lab::figures::{Cell, Table};
use raywood_lab::frame_budget::{CYCLES_PER_RAY, FRAMES_PER_SECOND};
use raywood_lab::{Benchmark, Clock, RaySetSummary, RaySpeed, Speed};

use super::{Benched, PICTURE, million_rays_per_second, nanoseconds, set_of};
use crate::exporters::contents::{Contents, measured};
use crate::print::{self, thousands};

pub(super) fn contents(benched: &Benched<'_>) -> Contents {
    let Benched { scene, build: (seconds, threads), benchmark } = benched;
    let primitives = thousands(benchmark.primitives as u64);
    let (structure, threads) = (benchmark.structure.name(), print::threads(*threads));
    let mut tables = vec![rays(benchmark)];
    if benchmark.levels.len() > 1 {
        tables.extend(by_level(benchmark));
    }
    tables.push(frame(benchmark));
    Contents {
        heading: format!(
            "{scene}: {primitives} primitives in {structure}, built in {seconds:.2} s on {threads}"
        ),
        facts: vec![instructions(benchmark), clocks(benchmark)],
        tables,
        notes: notes(benchmark),
    }
}

fn instructions(benchmark: &Benchmark) -> String {
    let Some(level) = benchmark.level else {
        return format!("instructions: scalar, {} has no others", benchmark.structure.name());
    };
    let available: Vec<_> = SimdLevel::available().map(SimdLevel::name).collect();
    format!("instructions: {}; this machine has {}", level.name(), available.join(", "))
}

fn clocks(benchmark: &Benchmark) -> String {
    let clock = |clock: &Clock| {
        let (gigahertz, spread) = (1e-9 * clock.hertz(), 100.0 * clock.cycle.spread());
        format!("{gigahertz:.2} GHz \u{b1}{spread:.0}% on {}", print::threads(clock.threads))
    };
    let clocks: Vec<_> = benchmark.clocks.iter().map(clock).collect();
    format!("core clock, estimated: {}", clocks.join(", "))
}

/// Rays and pictures on every number of threads.
fn rays(benchmark: &Benchmark) -> Table {
    let columns =
        ["rays", "number", "hit", "threads", "ns/ray", "Mrays/s", "cycles/ray", "scaling"];
    let mut table = Table::new("Rays of each kind, and pictures as a whole", &columns);
    let mut row = |name: &str, hit: Cell, speed: &Speed, alone: Option<&Speed>| {
        let scaling = alone.map(|alone| speed.rays_per_second() / alone.rays_per_second());
        let mut cells = vec![Cell::text(name), Cell::Count(speed.rays), hit];
        cells.push(Cell::count(speed.threads));
        cells.extend(if speed.rays == 0 {
            vec![Cell::Nothing; 4]
        } else {
            vec![
                measured(nanoseconds(speed), &speed.timing),
                Cell::significant(million_rays_per_second(speed)),
                Cell::significant(benchmark.cycles_per_ray(speed)),
                scaling.map_or(Cell::Nothing, |scaling| Cell::Number(scaling, 2)),
            ]
        });
        table.rows.push(cells);
    };
    for set in &benchmark.ray_sets {
        let speeds: Vec<_> = benchmark.by_threads(set.kind).collect();
        for rays in &speeds {
            let hit = set_of(benchmark, rays).map_or(Cell::Nothing, hit_share);
            row(set.kind.name(), hit, &rays.speed, speeds.first().map(|rays| &rays.speed));
        }
    }
    let pictures = &benchmark.pictures.speeds;
    for speed in pictures {
        row(PICTURE, Cell::Nothing, speed, pictures.first());
    }
    table
}

fn hit_share(set: &RaySetSummary) -> Cell {
    Cell::Share(set.hits as f64 / set.rays as f64)
}

/// Levels of instructions on one thread: their speeds, and these as shares of the best's.
fn by_level(benchmark: &Benchmark) -> [Table; 2] {
    let kinds = benchmark.ray_sets.iter().map(|set| set.kind);
    let columns: Vec<_> = ["level"].into_iter().chain(kinds.clone().map(|k| k.name())).collect();
    let best: Vec<_> = kinds
        .clone()
        .map(|kind| {
            let speeds = benchmark.by_level(kind).map(|rays| rays.speed.rays_per_second());
            speeds.fold(0.0, f64::max)
        })
        .collect();
    let table = |caption: &str, cell: &dyn Fn(&RaySpeed, f64) -> Cell| {
        let mut table = Table::new(caption, &columns);
        for &level in &benchmark.levels {
            let mut row = vec![Cell::text(level.name())];
            for (kind, &best) in kinds.clone().zip(&best) {
                let rays = benchmark.by_level(kind).find(|rays| rays.level == Some(level));
                let rays = rays.filter(|rays| rays.speed.rays > 0);
                row.push(rays.map_or(Cell::Nothing, |rays| cell(rays, best)));
            }
            table.rows.push(row);
        }
        table
    };
    let speed =
        |rays: &RaySpeed, _| measured(million_rays_per_second(&rays.speed), &rays.speed.timing);
    let share = |rays: &RaySpeed, best| Cell::Number(rays.speed.rays_per_second() / best, 2);
    [
        table("Levels of instructions on one thread: million rays a second", &speed),
        table("The same as shares of the best level", &share),
    ]
}

/// How far it is to the lecture's pictures in real time, on as many threads as there were.
fn frame(benchmark: &Benchmark) -> Table {
    let caption = "The lecture's frame: 1280x800 pixels of 10 rays, 80 cycles a ray, 30 a second";
    let columns = ["rays", "threads", "cycles/ray", "times 80", "frames/s", "of 30"];
    let mut table = Table::new(caption, &columns);
    let kinds = benchmark.ray_sets.iter().filter_map(|set| {
        let most = benchmark.by_threads(set.kind).last();
        most.map(|rays| (set.kind.name(), &rays.speed))
    });
    let picture = benchmark.pictures.speeds.last().map(|speed| (PICTURE, speed));
    for (name, speed) in kinds.chain(picture).filter(|(_, speed)| speed.rays > 0) {
        let (cycles, frames) = (benchmark.cycles_per_ray(speed), speed.frames_per_second());
        table.rows.push(vec![
            Cell::text(name),
            Cell::count(speed.threads),
            Cell::significant(cycles),
            Cell::Number(cycles / CYCLES_PER_RAY, 1),
            Cell::significant(frames),
            Cell::Share(frames / FRAMES_PER_SECOND),
        ]);
    }
    table
}

fn notes(benchmark: &Benchmark) -> Vec<String> {
    let variants = match benchmark.level {
        Some(_) => "level and number of threads",
        None => "number of threads",
    };
    let reference = match benchmark.structure {
        kind if kind == StructureKind::default() => "for a sample those of brute-force",
        _ => "those of the default structure",
    };
    let pictures = &benchmark.pictures;
    let (width, height) = (pictures.width, pictures.height);
    let picture = match pictures.speeds.last() {
        None => format!("A picture of {width}x{height} pixels would have taken too long."),
        Some(speed) => format!(
            "The picture has {width}x{height} pixels of one ray from the eye, traced by Whitted's method: shading and all else is included. {:.2} of them \
             a second on {}.",
            speed.rays_per_second() / speed.rays.max(1) as f64,
            print::threads(speed.threads)
        ),
    };
    vec![
        format!(
            "Answers agree on every {variants}, and {reference}."
        ),
        "Times are medians of rounds taken in turn; \u{b1} is half the distance between the quartiles. Cycles are those of all cores together."
            .to_owned(),
        "The core clock is an estimate: chains of dependent one-cycle operations, timed between the measurements."
            .to_owned(),
        picture,
    ]
}
