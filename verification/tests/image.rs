//! The link check and its negative control (TIME-02: no panic, no allocation).
#![allow(clippy::unwrap_used, clippy::panic)]

use haltline_verification::image::{Image, Linked};
use std::path::{Path, PathBuf};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

#[test]
fn every_door_of_the_release_kernel_is_free_of_panics_and_allocation() {
    let image = Image::build(&folder("image"), false).unwrap();
    let functions = image.functions().unwrap();
    for door in [
        "image_step",
        "image_navigate",
        "image_grid",
        "image_correct",
    ] {
        assert!(
            functions.iter().any(|name| name == door),
            "{door} is among {functions:?}"
        );
    }
    for function in &functions {
        assert_eq!(
            image.link(function).unwrap(),
            Linked::PanicFree,
            "{function}"
        );
    }
}

#[test]
fn a_planted_panic_is_found() {
    let image = Image::build(&folder("image-planted"), true).unwrap();
    assert_eq!(image.link("image_planted").unwrap(), Linked::PanicReachable);
}
