//! Every property on its committed corpus and on drawn bytes; every false twin is found.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // Tests may fail loudly.

use haltline_fuzz_properties::{ALL, Draw, Judge, Property, corpus};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Fewer without optimisation.
fn cases(property: &Property) -> usize {
    if cfg!(debug_assertions) {
        property.cases.div_ceil(10)
    } else {
        property.cases
    }
}

fn of(name: &str) -> &'static Property {
    let found = ALL.iter().find(|property| property.name == name);
    found.expect("a property of this name")
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Judges a case; a panic breaks every property.
fn judged(judge: Judge, bytes: &[u8]) -> Result<usize, String> {
    let answer = catch_unwind(AssertUnwindSafe(|| judge(bytes)));
    answer.unwrap_or_else(|_| Err("panicked".to_owned()))
}

fn holds(name: &str) {
    let property = of(name);
    let mut draw = Draw::new(0x5eed);
    let committed = corpus(name).unwrap();
    let drawn = (0..cases(property)).map(|_| (property.draw)(&mut draw));
    let (mut count, mut reached, mut things) = (0, 0, 0);
    for bytes in committed.iter().cloned().chain(drawn) {
        match judged(property.judge, &bytes) {
            Ok(found) => {
                count += 1;
                reached += usize::from(found > 0);
                things += found;
            }
            Err(broken) => panic!("{name}: {broken}\n{}", hex(&bytes)),
        }
    }
    println!(
        "{name}: {count} cases ({} committed), {reached} with something to judge, {things} things judged",
        committed.len()
    );
    assert!(!committed.is_empty(), "{name} has no corpus");
    assert!(reached * 20 > count, "{name}: hardly anything was judged");
}

fn finds_its_twins(name: &str) {
    let property = of(name);
    assert!(!property.twins.is_empty(), "{name} has no false twin");
    let committed = corpus(name).unwrap();
    for (twin, judge) in property.twins {
        let mut draw = Draw::new(0x5eed);
        let drawn = (0..property.cases * 10).map(|_| (property.draw)(&mut draw));
        let mut all = committed.iter().cloned().chain(drawn).enumerate();
        let found = all.find_map(|(number, bytes)| Some((number, judge(&bytes).err()?)));
        let (number, broken) = found.unwrap_or_else(|| panic!("{name}: `{twin}` was not found"));
        let first: String = broken.chars().take(160).collect();
        println!("{name}: `{twin}` found by case {number}: {first}");
    }
}

macro_rules! properties {
    ($($name:ident)*) => {
        $(mod $name {
            #[test]
            fn holds() {
                super::holds(stringify!($name));
            }

            #[test]
            fn finds_its_false_twins() {
                super::finds_its_twins(stringify!($name));
            }
        })*

        /// Every property is tested here and has a target of its own.
        #[test]
        fn none_is_left_out() {
            let tested = [$(stringify!($name)),*];
            let known: Vec<&str> = ALL.iter().map(|property| property.name).collect();
            assert_eq!(known, tested);
            let manifest = include_str!("../../Cargo.toml");
            for name in known {
                assert!(manifest.contains(&format!("path = \"fuzz_targets/{name}.rs\"")), "{name}");
            }
            assert_eq!(manifest.matches("[[bin]]").count(), tested.len());
        }
    };
}

properties! {
    guard stops latch inputs navigate grid ekf arc plan robot scenario marker_map barn sena carmen mrclam pgm yaml
    record arcos uc cola adapters emulators
}
