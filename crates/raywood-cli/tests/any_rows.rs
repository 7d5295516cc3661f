//! Files of whatever bytes as the rays or points of `raywood query`: rows, the same however many are read at a time, or an error of one line. The fuzz target `any_rows` runs this
//! on bytes of its own choice.

#![allow(unreachable_pub)]

use std::path::PathBuf;
use std::{env, fs, process};

use raywood_cli::{read_points, read_rays};

/// The endings of names, by which formats are told.
const ENDINGS: [&str; 4] = ["csv", "jsonl", "npy", "npz"];

/// As many rows as the command reads at a time.
const PIECE: usize = 1 << 16;

/// All bytes but the first, which says as what they are read.
pub fn any_rows(bytes: &[u8]) {
    let Some((&kind, bytes)) = bytes.split_first() else { return };
    let file = File::new(ENDINGS[usize::from(kind % 4)], bytes);
    let is_points = kind & 4 != 0;
    let read = if is_points { read_points } else { read_rays };
    let widths: &[usize] = if is_points { &[3] } else { &[6, 8] };
    let few = read(&file.0, 3);
    match read(&file.0, PIECE) {
        Ok(rows) => {
            assert!(widths.contains(&rows.width), "{} numbers a row", rows.width);
            assert_eq!(rows.numbers.len(), rows.rows * rows.width);
            assert!(rows.total.is_none_or(|total| total == rows.rows as u64), "{:?}", rows.total);
            assert_eq!(few.map(|few| bits(&few.numbers)), Ok(bits(&rows.numbers)));
        }
        Err(message) => {
            assert!(few.is_err(), "only in large pieces: {message}");
            let name = format!("{}:", file.0.display());
            assert!(message.starts_with(&name), "{message} does not begin with {name}");
            // Eight names at most, however long, as escapes.
            assert!(message.len() < name.len() + 2500, "{message}");
            assert!(!message.chars().any(char::is_control), "{message:?} is not one line");
        }
    }
}

/// Numbers to compare, NaN with NaN.
fn bits(numbers: &[f32]) -> Vec<u32> {
    numbers.iter().map(|number| number.to_bits()).collect()
}

/// A file of this process and thread, removed at the end.
struct File(PathBuf);

impl File {
    fn new(ending: &str, bytes: &[u8]) -> Self {
        // In memory where there is a place for that: a fuzzer writes thousands a second.
        let memory = PathBuf::from("/dev/shm");
        let folder = if memory.is_dir() { memory } else { env::temp_dir() };
        let thread = format!("{:?}", std::thread::current().id());
        let number: String = thread.chars().filter(char::is_ascii_digit).collect();
        let path = folder.join(format!("raywood-rows-{}-{number}.{ending}", process::id()));
        fs::write(&path, bytes).expect("a file");
        Self(path)
    }
}

impl Drop for File {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn sound_files_are_read() {
        for (ending, text) in [
            ("csv", "x,y,z\n1,2,3\n4,5,6\n"),
            ("csv", "1,2,3\n4,5,6\n"),
            ("jsonl", "{\"point\": [1, 2, 3]}\n\n{\"point\": [4, 5, 6]}\n"),
        ] {
            let file = File::new(ending, text.as_bytes());
            for piece in [1, 2, PIECE] {
                let read = read_points(&file.0, piece).expect(text);
                assert_eq!((read.width, read.rows), (3, 2), "{text}");
                assert_eq!(read.numbers, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "{text}");
            }
            assert!(read_rays(&file.0, PIECE).is_err(), "{text}");
        }
    }

    #[test]
    fn what_fuzzing_found_does_no_harm() {
        let found = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/found/any_rows");
        // A package on its own has no such folder.
        if !found.is_dir() {
            return;
        }
        let mut count = 0;
        for entry in fs::read_dir(found).expect("a folder") {
            any_rows(&fs::read(entry.expect("an entry").path()).expect("a file"));
            count += 1;
        }
        assert!(count >= 10, "{count} inputs");
    }
}
