//! What there is of a picture, kept in a file while it is rendered, so that nothing is lost when that is broken off: films in files.

use std::borrow::Cow;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use raywood_render::{Film, FilmFile, RenderOptions};

use crate::failure::Failure;
use crate::output_file::OutputFile;
use crate::print;
use crate::settings::{Settings, Weight};

/// A file that is known to be writable, and the film that was in it.
pub(crate) struct Begun {
    path: PathBuf,
    file: OutputFile,
    found: Option<FilmFile<'static>>,
}

impl Begun {
    /// Looks what is there. Only to go on is a file ever replaced.
    ///
    /// # Errors
    ///
    /// Something is there, but nobody asks to go on with it; or it is no film that can be used; or the place cannot be written.
    pub(crate) fn new(path: &Path, resume: bool) -> Result<Self, Failure> {
        let name = path.display();
        let exists = path.exists();
        if path.is_dir() {
            return Err(Failure::BadInput(format!("{name}: is a folder, expected a file")));
        }
        if exists && !resume {
            return Err(Failure::BadInput(format!(
                "{name}: is there already: expected --resume to go on with it, or another name"
            )));
        }
        let file = OutputFile::new(path)?;
        if resume && !exists {
            print::warning(format_args!("{name}: is not there yet, so the picture begins anew"));
        }
        let found = exists.then(|| read_film(path)).transpose()?;
        Ok(Self { path: path.to_owned(), file, found })
    }

    /// Goes on with the film if it is of a picture.
    ///
    /// # Errors
    ///
    /// It is of another.
    pub(crate) fn of_picture(
        self,
        settings: Settings,
        options: &RenderOptions,
        every: Duration,
    ) -> Result<Checkpoint, Failure> {
        let Self { path, file, found } = self;
        if let Some(found) = &found {
            let its = Settings::of_file(found.settings.clone());
            let other = |what: &str, differences: &[String]| {
                let (name, differences) = (path.display(), differences.join("; "));
                Err(Failure::BadInput(format!("{name}: {what}: {differences}")))
            };
            let differences = its.differences(&settings, "now", Weight::Picture);
            if !differences.is_empty() {
                return other("is of another picture", &differences);
            }
            let differences = its.differences(&settings, "now", Weight::Digits);
            if !differences.is_empty() {
                return other("cannot go on to the same last digits", &differences);
            }
            let size = [found.film.width(), found.film.height()];
            if size != [options.width, options.height] {
                let [width, height] = size;
                return other("is damaged", &[format!("it has {width}x{height} pixels")]);
            }
        }
        let is_light = options.integrator.shows_light;
        let film = Mutex::new(found.map(|found| found.film.into_owned()));
        Ok(Checkpoint { path, file, settings, is_light, every, film })
    }
}

/// Reads a film.
///
/// # Errors
///
/// The file cannot be read, or is no film that can be used.
pub(crate) fn read_film(path: &Path) -> Result<FilmFile<'static>, Failure> {
    let complain =
        |error: &dyn std::fmt::Display| Failure::BadInput(format!("{}: {error}", path.display()));
    if path.is_dir() {
        return Err(complain(&"is a folder, expected a film"));
    }
    let file = File::open(path).map_err(|error| complain(&error))?;
    FilmFile::read(BufReader::new(file)).map_err(|error| complain(&error))
}

/// Where what there is of a picture is kept.
pub(crate) struct Checkpoint {
    path: PathBuf,
    file: OutputFile,
    settings: Settings,
    is_light: bool,
    /// How long rendering goes on before it is kept.
    pub(crate) every: Duration,
    /// What was there before.
    film: Mutex<Option<Film>>,
}

impl Checkpoint {
    /// The film to go on with, if there is one. There is none any more then.
    pub(crate) fn take_film(&self) -> Option<Film> {
        self.film.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// Where it is.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the film; the one before stays until this one is whole.
    ///
    /// # Errors
    ///
    /// The file cannot be written.
    pub(crate) fn save(
        &self,
        film: &Film,
        exposure: f32,
        is_finished: bool,
    ) -> Result<(), Failure> {
        let (settings, is_light) = (self.settings.clone().into_pairs(), self.is_light);
        let film = Cow::Borrowed(film);
        let whole = FilmFile { film, settings, exposure, is_light, is_finished };
        self.file.write(|writer| whole.write(writer))
    }

    /// Writes the film while it is rendered, and tells when to do so again: keeping takes at most a fiftieth of the time. That it cannot be written stops nothing.
    pub(crate) fn keep(&self, film: &Film, exposure: f32) -> Duration {
        let started = Instant::now();
        if let Err(failure) = self.save(film, exposure, false) {
            print::warning(failure);
        }
        self.every.max(50 * started.elapsed())
    }
}
