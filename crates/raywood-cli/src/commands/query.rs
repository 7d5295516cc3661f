//! `raywood query`: rays or points in, what a scene answers to each out.

use std::io::{self, BufWriter, IsTerminal};
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::thread_pool;
use crate::build_args::BuildArgs;
use crate::failure::Failure;
use crate::output_file::OutputFile;
use crate::print::{self, thousands};
use crate::progress_bar::{during_rows, during_step};
use crate::query::field::Field;
use crate::query::formats::{Format, Layout, Rows};
use crate::query::input::{Input, STANDARD};
use crate::query::kind::{Kind, Subject};
use crate::query::questioner::Questioner;
use crate::query::sink::Sink;
use crate::scene_source;
use crate::simd_args::SimdArgs;

/// What follows the list of options.
const AFTER_HELP: &str = "\
Kinds: of rays closest (default), any, all, count;
       of points closest-point (default), inside, signed-distance

Try:
  raywood query part.stl --rays rays.npy -o hits.npz
  raywood query part.stl --points points.csv --kind inside -o inside.csv";

/// The arrays in and out.
const AFTER_LONG_HELP: &str = r#"Try:
  raywood query part.stl --rays rays.npy -o hits.npz
  raywood query part.stl --rays rays.csv | head
  raywood query part.stl --points points.csv --kind inside -o inside.csv

Input, by the ending of the file's name:
  .npy           rays as rows of origin and direction, shape (N, 6), or with t_min and t_max
                 behind, (N, 8); points as rows of x, y, z, shape (N, 3). Numbers of
                 type float32, float64 or integer, in C or Fortran order.
  .npz           arrays `origins` and `directions`, each (N, 3), perhaps `t_min` and `t_max`;
                 or `rays`, as in .npy; or `points`
  .csv           a first line of names: origin_x,origin_y,origin_z,direction_x,direction_y,
                 direction_z (or ox,oy,oz,dx,dy,dz), perhaps t_min,t_max; or x,y,z.
                 Without names: 6 or 8 numbers a line in this order, or 3
  .jsonl         a line each: {"origin": [0, 0, 5], "direction": [0, 0, -1], "t_max": 10}
                 or {"point": [0, 0, 5]}
Directions need not be of unit length. Hits count at t_min <= t < t_max, else 0 and infinity.
Numbers are rounded to single precision. Rays and points that are not finite miss,
with a warning.

Output: a row for each ray or point, in their order, with the columns
  closest          t, primitive, u, v, position, normal; material if named by --columns
  any              hit
  all              as closest, a row for each hit, nearest first. .npz has `offsets` (N + 1):
                   the hits of ray i are rows offsets[i] to offsets[i+1] - 1; .csv and .npy
                   have a first column `ray`, from 0; .jsonl {"hits": [...]}
  count            count
  closest-point    distance, primitive, u, v, position; material if named by --columns
  inside           inside; winding_number if named by --columns
  signed-distance  signed_distance
Types: int32 of primitive, material and count; bool of hit and inside; float32 of all else,
position and normal (N, 3). An .npy of several columns is a structured array: hits["t"].
Where nothing is hit or found: t and distance infinite, primitive and material -1, all else
NaN; in .jsonl null.
t is in units of the direction's length; position = (1-u-v) p0 + u p1 + v p2 on a triangle
with corners p0, p1, p2; normal = (p1-p0) x (p2-p0) at unit length.

Primitives are numbered from 0: all triangles of the file in its order, those of all its
objects together (of glTF node by node; polygons are cut into triangles one after the other;
triangles with a vertex that is not finite are dropped and not counted, unless --strict
refuses them), then the spheres of built-in scenes. Positions are those of the file, of glTF
those of its scene.

.csv, .jsonl and .npy are read and written piece by piece, in little memory; of .npz the
output stays in memory until the end. A file is written whole or, if anything is wrong, not
at all."#;

/// Ask a scene about rays or points of your own: arrays in, arrays out.
#[derive(clap::Args)]
#[command(after_help = AFTER_HELP, after_long_help = AFTER_LONG_HELP)]
#[command(mut_arg("preset", |arg| arg.hide_short_help(true)), mut_arg("simd", |arg| arg.hide_short_help(true)))]
pub(crate) struct Args {
    /// Model file, or built-in scene such as builtin:hall
    ///
    /// Files may be OBJ, glTF, GLB, PLY or STL, a scene file (TOML) that puts several together, or a scene saved by `raywood build`; `raywood scenes` lists the built-in scenes.
    #[arg(value_name = "MESH")]
    scene: String,

    /// Rays: .npy, .npz, .csv, .jsonl; - is standard input
    #[arg(
        long,
        value_name = "FILE",
        required_unless_present = "points",
        conflicts_with = "points"
    )]
    rays: Option<PathBuf>,

    /// Points, in place of rays
    #[arg(long, value_name = "FILE")]
    points: Option<PathBuf>,

    /// What to ask, one of the kinds below
    ///
    /// closest: where each ray first hits something. any: whether it hits anything. all: everything that it hits, nearest first, each crossing of a surface once. count: how many hits `all` would give. closest-point: the point of a surface that is closest to each point. inside: whether the point is inside of a solid. signed-distance: how far it is from the surface, negative inside.
    #[arg(short, long, value_name = "KIND", value_enum, hide_possible_values = true)]
    kind: Option<Kind>,

    /// Where to write, in any of these formats
    ///
    /// By the ending of the name; - is standard output.
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,

    /// Columns to write, else the usual ones
    ///
    /// In this order, separated by commas. What is left out need not be computed or written.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    columns: Vec<String>,

    /// csv, jsonl, npy or npz where no file's ending tells [default: csv]
    #[arg(
        long,
        value_name = "FORMAT",
        value_enum,
        hide_possible_values = true,
        hide_short_help = true
    )]
    format: Option<Format>,

    /// The format of the input, where it differs from --format
    #[arg(
        long,
        value_name = "FORMAT",
        value_enum,
        hide_possible_values = true,
        hide_short_help = true
    )]
    input_format: Option<Format>,

    /// With closest-point: ignore surfaces further away
    #[arg(long, value_name = "D", value_parser = crate::parse::above_zero)]
    max_distance: Option<f32>,

    /// With all: only the N nearest hits of each ray
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    max_hits: Option<u32>,

    /// Threads to use, else all cores
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    #[command(flatten)]
    build: BuildArgs,

    #[command(flatten)]
    simd: SimdArgs,

    /// Refuse what is otherwise mended, and rays or points that are not finite
    #[arg(long, hide_short_help = true)]
    strict: bool,
}

/// How many rows are read, asked and written at a time: a multiple of the 256 rays of a packet, so that answers are those of one large batch.
const PIECE: usize = 1 << 16;

/// The same where each row has a list of answers, of which nobody knows how long it is.
const PIECE_OF_LISTS: usize = 1 << 12;

/// What was done.
struct Summary {
    rows: u64,
    successes: u64,
    seconds: f64,
    /// How many rows are not finite, and the number of the first.
    unusable: u64,
    first_unusable: u64,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    // Say what is wrong with the request before any work is done for it.
    args.simd.activate()?;
    let (subject, source) = subject(args)?;
    let kind = kind(args, subject)?;
    let fields = fields(args, kind)?;
    let input_format = input_format(args, source)?;
    let output_format = output_format(args)?;
    let is_binary = matches!(output_format, Format::Npy | Format::Npz);
    if is_binary && is_standard(&args.output) && io::stdout().is_terminal() {
        return Err(Failure::bad_input("a terminal cannot show arrays of numpy, expected -o FILE"));
    }
    let output = match is_standard(&args.output) {
        true => None,
        false => Some(OutputFile::new(&args.output)?.apart_from(source)?),
    };
    let input = Input::new(source);
    let mut rows = input_format.read(input.clone(), subject)?;

    let pool = thread_pool(args.threads.map(usize::from))?;
    let loaded =
        during_step("loading", || pool.install(|| scene_source::load(&args.scene, args.strict)))?;
    loaded.print_warnings();
    let loaded = loaded.without_instances("a query")?;
    let scene = &loaded.scene;
    let tree = args.build.tree(scene, loaded.tree.as_ref(), &pool)?;

    let max_distance = args.max_distance.unwrap_or(f32::INFINITY);
    let max_hits = args.max_hits.map(|most| most as usize);
    let make = || Questioner::new(kind, &fields, max_distance, max_hits, scene, &tree);
    let questioner = during_step("preparing", || pool.install(make));
    let mut answer = |sink: Sink<'_>| {
        let refused = args.strict.then_some(&input);
        pool.install(|| answer_all(rows.as_mut(), &questioner, output_format, sink, refused))
    };
    let Some(output) = output else {
        return match answer(Sink::Pipe(BufWriter::new(io::stdout()))) {
            Ok(summary) => {
                warn_of_unusable(&summary, &input, subject);
                Ok(())
            }
            Err(Ending::Failed(failure)) => Err(failure),
            // A reader who has gone (`raywood query ... | head`) is no failure.
            Err(Ending::NotWritten(error)) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
            Err(Ending::NotWritten(error)) => {
                Err(Failure::while_running(format!("standard output: {error}")))
            }
        };
    };
    let summary = output.write_with(|file| {
        answer(Sink::File(file)).map_err(|ending| match ending {
            Ending::Failed(failure) => failure,
            Ending::NotWritten(error) => output.cannot_write(&error),
        })
    })?;
    warn_of_unusable(&summary, &input, subject);
    let Summary { rows, successes, seconds, .. } = summary;
    print::result(&format!(
        "{}: {} {} in {seconds:.3} s, {} {}\n",
        args.output.display(),
        thousands(rows),
        subject.name(),
        thousands(successes),
        kind.success(),
    ))
}

/// Why not all was answered.
enum Ending {
    Failed(Failure),
    NotWritten(io::Error),
}

impl From<Failure> for Ending {
    fn from(failure: Failure) -> Self {
        Self::Failed(failure)
    }
}

impl From<io::Error> for Ending {
    fn from(error: io::Error) -> Self {
        Self::NotWritten(error)
    }
}

/// Tells of rows that can have no answer.
fn warn_of_unusable(summary: &Summary, input: &Input, subject: Subject) {
    let &Summary { unusable, first_unusable, .. } = summary;
    if unusable > 0 {
        print::warning(format_args!(
            "{}: {} of the {} are not finite and miss, the first in row {first_unusable} (from 0)",
            input.name(),
            thousands(unusable),
            subject.name()
        ));
    }
}

/// Whether a ray or point is finite; a ray's interval need not be.
fn is_usable(row: &[f32]) -> bool {
    let (vectors, interval) = row.split_at(row.len().min(6));
    vectors.iter().all(|x| x.is_finite()) && !interval.iter().any(|x| x.is_nan())
}

/// Reads, asks and writes piece by piece, on the threads of the current pool. With `refused`, the input's name for that, a row that is not finite is an error.
fn answer_all(
    input: &mut dyn Rows,
    questioner: &Questioner<'_>,
    format: Format,
    sink: Sink<'_>,
    refused: Option<&Input>,
) -> Result<Summary, Ending> {
    let started = Instant::now();
    let (width, total) = (input.width(), input.total());
    let layout =
        Layout { fields: questioner.fields, lists: questioner.kind.gives_lists(), rows: total };
    let mut writer = format.write(sink, &layout)?;
    let mut summary =
        Summary { rows: 0, successes: 0, seconds: 0.0, unusable: 0, first_unusable: 0 };
    let piece = if layout.lists { PIECE_OF_LISTS } else { PIECE };
    during_rows("asking", total, |done| {
        let mut numbers = Vec::new();
        loop {
            numbers.clear();
            let count = input.read(piece, &mut numbers)?;
            if count == 0 {
                break;
            }
            for (row, values) in (summary.rows..).zip(numbers.chunks_exact(width)) {
                if is_usable(values) {
                    continue;
                }
                if let Some(input) = refused {
                    let message = format!("row {row} (from 0) is not finite, refused by --strict");
                    return Err(input.complain(message).into());
                }
                if summary.unusable == 0 {
                    summary.first_unusable = row;
                }
                summary.unusable += 1;
            }
            let table = questioner.ask(&numbers, width, summary.rows);
            writer.write(&table)?;
            summary.rows += count as u64;
            summary.successes += table.successes;
            done(count as u64);
        }
        writer.finish()?;
        Ok::<_, Ending>(())
    })?;
    summary.seconds = started.elapsed().as_secs_f64();
    Ok(summary)
}

fn is_standard(path: &Path) -> bool {
    path.as_os_str() == STANDARD
}

/// What is asked about, and where it is.
fn subject(args: &Args) -> Result<(Subject, &Path), Failure> {
    match (&args.rays, &args.points) {
        (Some(rays), _) => Ok((Subject::Rays, rays)),
        (None, Some(points)) => Ok((Subject::Points, points)),
        (None, None) => Err(Failure::bad_input("expected --rays FILE or --points FILE")),
    }
}

/// What is asked, where that can be asked of the subject.
fn kind(args: &Args, subject: Subject) -> Result<Kind, Failure> {
    let kind = args.kind.unwrap_or(subject.default_kind());
    if kind.subject() != subject {
        let (name, expected) = (kind.name(), kind.subject().name());
        return Err(Failure::BadInput(format!(
            "--kind {name} is asked of {expected}, expected --{expected} FILE"
        )));
    }
    if args.max_distance.is_some() && kind != Kind::ClosestPoint {
        return Err(Failure::BadInput(format!(
            "--max-distance is for --kind closest-point; of rays give t_max with each{}",
            if subject == Subject::Rays { "" } else { ", others have no limit" }
        )));
    }
    if args.max_hits.is_some() && kind != Kind::All {
        return Err(Failure::bad_input("--max-hits is for --kind all"));
    }
    Ok(kind)
}

/// The columns to write.
fn fields(args: &Args, kind: Kind) -> Result<Vec<Field>, Failure> {
    if args.columns.is_empty() {
        return Ok(kind.usual_fields().to_vec());
    }
    let all = || kind.usual_fields().iter().chain(kind.further_fields()).copied();
    let mut fields = Vec::new();
    for name in &args.columns {
        let Some(field) = all().find(|field| field.name() == name.trim()) else {
            let names: Vec<_> = all().map(Field::name).collect();
            return Err(Failure::BadInput(format!(
                "--columns: --kind {} has no column `{name}`, expected some of {}",
                kind.name(),
                names.join(", ")
            )));
        };
        if !fields.contains(&field) {
            fields.push(field);
        }
    }
    Ok(fields)
}

/// The formats for a message.
const FORMATS: &str = "csv, jsonl, npy or npz";

/// What the input's ending tells, or else the options.
fn input_format(args: &Args, source: &Path) -> Result<Format, Failure> {
    let told = args.input_format.or_else(|| Format::of_name(source)).or(args.format);
    match told {
        Some(format) => Ok(format),
        None if is_standard(source) => Ok(Format::Csv),
        None => Err(Failure::BadInput(format!(
            "{}: its ending tells no format, expected --input-format {FORMATS}",
            source.display()
        ))),
    }
}

/// What the output's ending tells, or else the option.
fn output_format(args: &Args) -> Result<Format, Failure> {
    match Format::of_name(&args.output).or(args.format) {
        Some(format) => Ok(format),
        None if is_standard(&args.output) => Ok(Format::Csv),
        None => Err(Failure::BadInput(format!(
            "{}: its ending tells no format, expected --format {FORMATS}",
            args.output.display()
        ))),
    }
}
