//! The built program in words.

use std::path::Path;
use std::process::Command;

use relief_tests::program::Run;

/// Runs the program in words, `FILE` standing for a path.
pub fn reliefd(words: &str, file: &Path) -> Run {
    with_input(words, file, "")
}

/// The same with text on standard input.
pub fn with_input(words: &str, file: &Path, text: &str) -> Run {
    let arguments = words.split_whitespace().map(|word| match word {
        "FILE" => file.display().to_string(),
        // Outputs lie beside the file.
        word => match word.strip_prefix("OUT/") {
            Some(name) => file.with_file_name(name).display().to_string(),
            None => word.to_owned(),
        },
    });
    Run::of(program().args(arguments), text)
}

/// The program.
pub fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_reliefd"))
}

/// A file's samples, as [`relief_tests::png::decode`] gives them.
pub fn png(path: &Path) -> (u32, u32, usize, Vec<u8>) {
    relief_tests::png::decode(&std::fs::read(path).unwrap())
}
