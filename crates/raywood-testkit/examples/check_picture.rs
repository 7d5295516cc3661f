//! Checks that a file is a PNG picture of a given size that shows something: `check_picture FILE WIDTH HEIGHT`.

use std::path::Path;
use std::process::ExitCode;

use raywood_testkit::image::Picture;

/// A picture with fewer colours than this shows nothing.
const FEWEST_COLORS: usize = 1000;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match check(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(complaint) => {
            eprintln!("{complaint}");
            ExitCode::FAILURE
        }
    }
}

fn check(arguments: &[String]) -> Result<(), String> {
    let [file, width, height] = arguments else {
        return Err("usage: check_picture FILE WIDTH HEIGHT".to_owned());
    };
    let picture = Picture::read(Path::new(file))?;
    let size = format!("{}x{}", picture.width, picture.height);
    let colors = picture.colors();
    if size != format!("{width}x{height}") {
        return Err(format!("{file}: is {size}, expected {width}x{height}"));
    }
    if colors < FEWEST_COLORS {
        return Err(format!("{file}: has only {colors} colours"));
    }
    println!("{file}: {size}, {colors} colours");
    Ok(())
}
