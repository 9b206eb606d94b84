//! Through the file system and back.

use super::any_map;
use crate::{Map, load, save};
use haltline::grid::Occupancy;
use proptest::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// A folder of its own that goes away with it.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("haltline-maps-{}-{number}", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn put(&self, name: &str, content: &[u8]) -> PathBuf {
        std::fs::write(self.file(name), content).unwrap();
        self.file(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn load_error(path: &Path) -> String {
    load(path).unwrap_err().to_string()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_map_survives_its_files(map in any_map(), name in "[a-z0-9 '#:-]{0,12}") {
        let folder = Folder::new();
        let path = folder.file(&format!("m{name}.yaml"));
        save(&map, &path).unwrap();
        prop_assert_eq!(load(&path).unwrap(), map);
    }
}

#[test]
fn errors_name_the_file_that_is_wrong() {
    let folder = Folder::new();
    let yaml = b"image: picture.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n";
    let path = folder.put("m.yaml", yaml);
    let error = load_error(&path);
    assert!(error.contains("picture.pgm: cannot be read"), "{error}");
    folder.put("picture.pgm", b"P5\n9 9\n255\n");
    let error = load_error(&path);
    assert!(error.contains("picture.pgm: truncated"), "{error}");
    folder.put("picture.pgm", b"P5\n1 1\n255\n\0");
    assert_eq!(load(&path).unwrap().cells, [Occupancy::Occupied]);
    assert!(load_error(&folder.0).contains("is not a file"));
    assert!(load_error(&folder.file("none.yaml")).contains("none.yaml: cannot be read"));
    // Somebody names the picture instead of its description.
    let error = load_error(&folder.put("p.pgm", b"P5\n1 1\n255\n\xff"));
    assert!(
        error.contains("p.pgm:4: is not UTF-8 text; name the YAML file"),
        "{error}"
    );
    let error = load_error(&folder.put("long.yaml", &[b'\n'; 70_000]));
    assert!(error.contains("is longer than 65536 bytes"), "{error}");
}

#[cfg(unix)]
#[test]
fn devices_are_not_maps() {
    let folder = Folder::new();
    let yaml = b"image: /dev/zero\nresolution: 0.1\norigin: [0, 0, 0]\n";
    let error = load_error(&folder.put("m.yaml", yaml));
    assert!(error.contains("/dev/zero: is not a file"), "{error}");
}

#[test]
fn maps_that_cannot_be_read_again_are_not_written() {
    let folder = Folder::new();
    let good = Map {
        width: 1,
        height: 1,
        resolution_m: 0.1,
        origin: [0.0; 3],
        cells: vec![Occupancy::Free],
    };
    let refused = |change: fn(&mut Map), name: &str| {
        let mut map = good.clone();
        change(&mut map);
        save(&map, &folder.file(name)).is_err()
    };
    assert!(!refused(|_| (), "good.yaml"));
    assert!(refused(|_| (), "bad.pgm"));
    assert!(refused(|map| map.cells.clear(), "bad.yaml"));
    assert!(refused(|map| map.width = 5000, "bad.yaml"));
    assert!(refused(|map| map.width = 0, "bad.yaml"));
    assert!(refused(|map| map.resolution_m = f64::NAN, "bad.yaml"));
    assert!(refused(|map| map.resolution_m = 0.0, "bad.yaml"));
    assert!(refused(|map| map.resolution_m = 0.0009, "bad.yaml"));
    assert!(refused(|map| map.origin[1] = f64::INFINITY, "bad.yaml"));
    assert!(refused(|_| (), "no/such/folder.yaml"));
    assert!(!folder.file("bad.yaml").exists() && !folder.file("bad.pgm").exists());
}
