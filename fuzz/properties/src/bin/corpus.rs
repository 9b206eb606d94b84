//! Corpora between the repository, one case a line in hexadecimal digits, and the folders that fuzzers work in.

use haltline_fuzz_properties::{ALL, Draw, Property};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

const HELP: &str = "usage: corpus list [--runs]           names of all targets; and how long a short search of each is
       corpus unpack TARGET FOLDER   the committed cases as files, for a fuzzer
       corpus pack TARGET FOLDER     a folder of cases becomes the committed corpus
       corpus draw TARGET FOLDER N   N drawn cases as files, to begin with";

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let done = match words[..] {
        ["list"] => {
            ALL.iter()
                .for_each(|property| println!("{}", property.name));
            Ok(())
        }
        ["list", "--runs"] => {
            ALL.iter()
                .for_each(|property| println!("{} {}", property.name, property.cases / 10));
            Ok(())
        }
        ["unpack", target, folder] => {
            property(target).and_then(|one| unpack(one, Path::new(folder)))
        }
        ["pack", target, folder] => property(target).and_then(|one| pack(one, Path::new(folder))),
        ["draw", target, folder, count] => property(target).and_then(|one| {
            let count = count
                .parse()
                .map_err(|_| wrong(&format!("`{count}` is no number")))?;
            draw(one, Path::new(folder), count)
        }),
        _ => Err(wrong(HELP)),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

fn wrong(message: &str) -> io::Error {
    io::Error::other(message.to_owned())
}

fn property(name: &str) -> io::Result<&'static Property> {
    let found = ALL.iter().find(|property| property.name == name);
    found.ok_or_else(|| wrong(&format!("no target `{name}`; `corpus list` names them")))
}

fn unpack(property: &Property, folder: &Path) -> io::Result<()> {
    let cases = haltline_fuzz_properties::corpus(property.name)?;
    fs::create_dir_all(folder)?;
    for (number, case) in cases.iter().enumerate() {
        fs::write(folder.join(format!("{number:04}")), case)?;
    }
    Ok(())
}

fn pack(property: &Property, folder: &Path) -> io::Result<()> {
    let files: Result<Vec<PathBuf>, _> = fs::read_dir(folder)?
        .map(|entry| entry.map(|entry| entry.path()))
        .collect();
    let cases: Result<Vec<Vec<u8>>, _> = files?.iter().map(fs::read).collect();
    let mut cases = cases?;
    // Short cases first, in an order that does not depend on the names of files.
    cases.sort_by(|one, two| one.len().cmp(&two.len()).then_with(|| one.cmp(two)));
    cases.dedup();
    haltline_fuzz_properties::write_corpus(property.name, &cases)
}

fn draw(property: &Property, folder: &Path, count: usize) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    let mut draw = Draw::new(1);
    for number in 0..count {
        fs::write(
            folder.join(format!("drawn-{number:04}")),
            (property.draw)(&mut draw),
        )?;
    }
    Ok(())
}
