//! Committed corpora: one case a line, in hexadecimal digits.

use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::PathBuf;

fn path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("../corpus/{name}.hex"))
}

/// The committed cases of a property.
///
/// # Errors
/// The file cannot be read, or is not made of pairs of hexadecimal digits.
pub fn corpus(name: &str) -> io::Result<Vec<Vec<u8>>> {
    let path = path(name);
    let wrong =
        |line: usize| io::Error::other(format!("{}:{line}: not hexadecimal", path.display()));
    let text = fs::read_to_string(&path)
        .map_err(|error| io::Error::other(format!("{}: {error}", path.display())))?;
    text.lines()
        .zip(1..)
        .map(|(line, number)| bytes(line).ok_or_else(|| wrong(number)))
        .collect()
}

fn bytes(line: &str) -> Option<Vec<u8>> {
    let pairs = line.as_bytes().chunks(2);
    pairs
        .map(|pair| {
            let pair = std::str::from_utf8(pair)
                .ok()
                .filter(|pair| pair.len() == 2)?;
            u8::from_str_radix(pair, 16).ok()
        })
        .collect()
}

/// Replaces the committed cases of a property.
///
/// # Errors
/// The file cannot be written.
pub fn write_corpus(name: &str, cases: &[Vec<u8>]) -> io::Result<()> {
    let mut text = String::new();
    for case in cases {
        for byte in case {
            // Writing to a String cannot fail.
            let _ = write!(text, "{byte:02x}");
        }
        text.push('\n');
    }
    fs::write(path(name), text)
}
