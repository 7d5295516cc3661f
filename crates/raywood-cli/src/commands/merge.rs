//! `raywood merge`: films of shares, regions or seeds in, the whole picture out.

use std::path::{Path, PathBuf};

use raywood_render::{Contents, Film, FilmFile};
use serde_json::json;

use crate::checkpoint::read_film;
use crate::failure::Failure;
use crate::image_args::{ImageArgs, ImageFile, Made};
use crate::output_file::OutputFile;
use crate::picture::{exposure_of, samples_in_words};
use crate::print;
use crate::settings::{Settings, Weight};

/// Put films of one picture together: shares, regions, seeds.
///
/// Films are what `raywood render --checkpoint` writes, on one machine or many. Those of the same seed complete each other: tiles that several have count once, of the one that has more samples. Those of other seeds (`--seed`) add
/// up to less noise. The picture is the same, bit for bit, as one rendered whole. With `-o NAME.film` they become one film. If it is of a single seed, `raywood render --checkpoint NAME.film --resume` goes on with it: to finish it, or for --denoise and --aovs.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Films to put together
    #[arg(required = true, value_name = "FILM")]
    films: Vec<PathBuf>,

    /// Leave black what no film has, and take unfinished ones
    #[arg(long)]
    partial: bool,

    /// Print what was done as JSON
    #[arg(long, hide_short_help = true)]
    json: bool,

    #[command(flatten)]
    image: ImageArgs,
}

/// Where the result goes.
enum Target {
    Image(ImageFile),
    Film(OutputFile),
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    // Say what is wrong with the request before any work is done for it.
    let path = args.image.path();
    let is_film = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("film"));
    let target = match is_film {
        true => Target::Film(OutputFile::new(path)?),
        false => Target::Image(args.image.file(false)?),
    };
    let merged = merge(args)?;

    let samples = samples_in_words(merged.film.samples(), merged.film.mean_samples());
    let exposure = match target {
        Target::Film(file) => {
            file.write(|writer| merged.write(writer))?;
            None
        }
        Target::Image(ImageFile { file, format, mut options, .. }) => {
            let image = merged.film.image(merged.is_light);
            let asked = args.image.exposure.filter(|_| !format.holds_light);
            let exposure = match format.holds_light {
                true => 1.0,
                false => exposure_of(&image, asked, || Ok(merged.exposure))?,
            };
            let image = image.exposed(exposure).with_tone_map(args.image.tone_map());
            options.metadata = args.image.metadata(&Made {
                settings: &Settings::of_file(merged.settings.clone()),
                samples: &samples,
                is_denoised: false,
                exposure: (!format.holds_light && merged.is_light).then_some(exposure),
                seconds: None,
                threads: 1,
            });
            file.write_with(|writer| {
                let written = format.write(Contents::Computed(&image, &[]), &options, writer);
                written.map_err(|error| file.cannot_write(&error))
            })?;
            Some(exposure)
        }
    };

    let (films, (width, height)) = (args.films.len(), (merged.film.width(), merged.film.height()));
    let output = path.display().to_string();
    if args.json {
        return print::json(&json!({
            "output": output,
            "films": films,
            "width": width,
            "height": height,
            "seeds": merged.setting("--seed"),
            "finished": merged.is_finished,
            "fewest_samples": merged.film.samples().0,
            "most_samples": merged.film.samples().1,
            "mean_samples": merged.film.mean_samples(),
            "exposure": exposure,
        }));
    }
    let films = if films == 1 { "1 film".to_owned() } else { format!("{films} films") };
    print::result(&format!(
        "wrote {output}: {films}, {width}x{height}, {samples} samples per pixel\n"
    ))
}

/// A film and where it comes from.
struct Source<'a> {
    path: &'a Path,
    settings: Settings,
    film: FilmFile<'static>,
}

impl<'a> Source<'a> {
    fn read(path: &'a Path) -> Result<Self, Failure> {
        let film = read_film(path)?;
        Ok(Self { path, settings: Settings::of_file(film.settings.clone()), film })
    }

    fn seed(&self) -> &str {
        self.settings.value(SEED).unwrap_or_default()
    }

    /// The seeds, of which a merged film has several.
    fn seeds(&self) -> impl Iterator<Item = &str> {
        self.seed().split(", ")
    }

    /// Refuses a film of another picture than another one, and says if only last digits differ.
    fn compare(&self, other: &Self) -> Result<(), Failure> {
        let name = self.path.display();
        // Seeds may differ.
        let [own, others] = [self, other].map(|source| source.settings.clone().with(SEED, ""));
        let place = format!("in {}", other.path.display());
        let mut differences = own.differences(&others, &place, Weight::Picture);
        let [size, other_size] =
            [self, other].map(|source| [source.film.film.width(), source.film.film.height()]);
        if differences.is_empty() && size != other_size {
            differences.push(format!("it has {}x{} pixels", size[0], size[1]));
        }
        if !differences.is_empty() {
            return Err(Failure::BadInput(format!(
                "{name}: is of another picture than {}: {}",
                other.path.display(),
                differences.join("; ")
            )));
        }
        let digits = own.differences(&others, &place, Weight::Digits);
        if !digits.is_empty() {
            print::warning(format_args!(
                "{name}: last digits may differ from those of one rendering: {}",
                digits.join("; ")
            ));
        }
        Ok(())
    }
}

/// The option that films of one picture may differ in.
const SEED: &str = "--seed";

/// Reads all films and puts them together. Never more than two of a seed, and one of every other, are in memory.
fn merge(args: &Args) -> Result<FilmFile<'static>, Failure> {
    // Complete each other, seed by seed.
    let mut of_seeds: Vec<Source<'_>> = Vec::new();
    for path in &args.films {
        let source = Source::read(path)?;
        let name = path.display();
        if let Some(first) = of_seeds.first() {
            source.compare(first)?;
        }
        if !source.film.is_finished && !args.partial {
            let (_, most) = source.film.film.samples();
            return Err(Failure::BadInput(format!(
                "{name}: is not finished, it has {most} samples per pixel so far: expected --partial, or to go on by `raywood render --resume` first"
            )));
        }
        match of_seeds.iter_mut().find(|other| other.seed() == source.seed()) {
            None => of_seeds.push(source),
            Some(other) => {
                other.film.film.to_mut().unite(&source.film.film);
                other.film.is_finished &= source.film.is_finished;
            }
        }
    }

    // What was merged before may have seeds that others have, too.
    for (number, source) in of_seeds.iter().enumerate() {
        let shared = |other: &&Source<'_>| {
            source.seeds().any(|seed| other.seeds().any(|others| others == seed))
        };
        if let Some(other) = of_seeds[..number].iter().find(shared) {
            let [name, other_name] = [source, other].map(|source| source.path.display());
            return Err(Failure::BadInput(format!(
                "{name}: has samples of seed {}, and {other_name} of seed {}: some would count twice, expected films of other seeds, or those that were merged instead of what they became",
                source.seed(),
                other.seed()
            )));
        }
    }

    // Add up what seeds have, in an order that does not depend on that of the files.
    let number = |source: &Source<'_>| source.seed().parse::<u32>().ok();
    of_seeds.sort_by(|a, b| (number(a), a.seed()).cmp(&(number(b), b.seed())));
    let seeds = of_seeds.iter().map(|source| source.seed().to_owned()).collect::<Vec<_>>();
    let merged = of_seeds.into_iter().reduce(|mut sum, source| {
        sum.film.film.to_mut().merge(&source.film.film);
        sum.film.is_finished &= source.film.is_finished;
        sum
    });
    let Some(Source { settings, mut film, .. }) = merged else {
        return Err(Failure::BadInput("there are no films to merge".to_owned()));
    };
    film.settings = settings.with(SEED, &seeds.join(", ")).into_pairs();

    let missing = Missing::of(&film.film);
    if missing.tiles > 0 {
        film.is_finished = false;
        if !args.partial {
            let Missing { tiles, all, first: [x, y] } = missing;
            return Err(Failure::BadInput(format!(
                "{tiles} of {all} tiles of 32x32 pixels are in no film, the first at column {x}, row {y}: expected the films of all shares or regions, or --partial"
            )));
        }
    }
    Ok(film)
}

/// Which tiles have no samples.
struct Missing {
    tiles: usize,
    all: usize,
    /// The column and row of the uppermost one.
    first: [u32; 2],
}

impl Missing {
    fn of(film: &Film) -> Self {
        const TILE: usize = 32;
        let starts = |size: u32| (0..size).step_by(TILE);
        let corners = starts(film.height()).flat_map(|y| starts(film.width()).map(move |x| [x, y]));
        let is_empty = |&[x, y]: &[u32; 2]| {
            film.pixels()[y as usize * film.width() as usize + x as usize].samples == 0
        };
        let all = corners.clone().count();
        let mut missing = corners.filter(is_empty);
        let first = missing.next();
        let tiles = missing.count() + usize::from(first.is_some());
        Self { tiles, all, first: first.unwrap_or_default() }
    }
}
