//! Files that lie, break off or never were maps: an error with a place, no panic, no hunger.

use crate::{CELLS_PER_SIDE_MAX, parse_pgm, parse_yaml};
use proptest::prelude::*;

fn pgm_error(bytes: &[u8]) -> String {
    parse_pgm(bytes, "m.pgm").unwrap_err().to_string()
}

fn yaml_error(line: &str) -> String {
    let text = format!("image: a.pgm\nresolution: 0.1\n{line}\n");
    parse_yaml(&text, "m.yaml").unwrap_err().to_string()
}

#[test]
fn pictures_that_are_refused_and_where() {
    let cases: [(&[u8], &str); 14] = [
        (b"", "m.pgm:1: starts with \"\""),
        (
            b"P2\n1 1\n255\n0",
            "m.pgm:1: starts with \"P2\", not with \"P5\"",
        ),
        (b"\x89PNG\r\n", "m.pgm:1: starts with \"\u{fffd}P\""),
        (b"P5", "m.pgm:1: no number for the width"),
        (b"P512 3\n255\n", "m.pgm:1: no number for the width"),
        (b"P5\n-3 4\n255\n", "m.pgm:2: no number for the width"),
        (b"P5\n3 x\n255\n", "m.pgm:2: no number for the height"),
        (b"P5\n0 4\n255\n", "m.pgm:2: width is 0"),
        (b"P5\n4 4097\n255\n", "m.pgm:2: height is 4097"),
        (
            b"P5\n99999999999999999999999 1\n255\n",
            "m.pgm:2: width 99999999999999999999999 is too large",
        ),
        (
            b"P5\n# a\n# b\n1 1\n65535\n\0\0",
            "m.pgm:5: largest grey is 65535",
        ),
        (b"P5\n1 1\n0\n\0", "m.pgm:3: largest grey is 0"),
        (
            b"P5\n1 1\n255",
            "m.pgm:3: no white space after the largest grey",
        ),
        (
            b"P5\n2 2\n255\n\0\0\0",
            "m.pgm: truncated: 2 x 2 pixels are 4 bytes, found 3",
        ),
    ];
    for (bytes, expected) in cases {
        let error = pgm_error(bytes);
        assert!(error.starts_with(expected), "{error} instead of {expected}");
    }
    let error = pgm_error(b"P5\n1 1\n255\n\0\0");
    assert!(
        error.contains("too long: 1 x 1 pixels are 1 bytes, found 2"),
        "{error}"
    );
}

#[test]
fn a_claimed_size_costs_nothing() {
    let claim = format!("P5\n{CELLS_PER_SIDE_MAX} {CELLS_PER_SIDE_MAX}\n255\nab");
    assert!(pgm_error(claim.as_bytes()).contains("truncated"));
    let mut endless = b"P5\n#".to_vec();
    endless.resize(1 << 20, b'#');
    assert!(pgm_error(&endless).starts_with("m.pgm:2: no number for the width"));
    endless.fill(b'7');
    endless[..3].copy_from_slice(b"P5 ");
    let error = pgm_error(&endless);
    assert!(error.len() < 200, "{error}");
}

#[test]
fn descriptions_that_are_refused_and_where() {
    let cases = [
        (
            "origin: [0, 0]",
            "m.yaml:3: origin is `[0, 0]`; write [x, y, yaw]",
        ),
        ("origin: [0, 0, .inf]", "m.yaml:3: origin is"),
        ("origin: [0, 0, nan]", "m.yaml:3: origin is"),
        ("origin: [0, 0, 1e999]", "m.yaml:3: origin is"),
        ("origin: 5", "m.yaml:3: origin is `5`"),
        ("origin:[0, 0, 0]", "m.yaml:3: cannot read `[0, 0, 0]`"),
        ("image: b.pgm", "m.yaml:3: image is given twice"),
        (
            "colour: red",
            "m.yaml:3: unknown key `colour`; use image, mode,",
        ),
        ("  origin: [0, 0, 0]", "m.yaml:3: unknown key `  origin`"),
        ("- 1", "m.yaml:3: `- 1` is not `key: value`"),
        ("origin: &a [0, 0, 0]", "m.yaml:3: cannot read"),
        ("origin: 'open", "m.yaml:3: cannot read"),
        ("origin: \"a\" b", "m.yaml:3: cannot read"),
        (
            "origin: [0,0,0]\nmode: scale",
            "m.yaml:4: mode is `scale`; write `mode: trinary`",
        ),
        (
            "origin: [0,0,0]\nnegate: 2",
            "m.yaml:4: negate is `2`; write 0 or 1",
        ),
        (
            "origin: [0,0,0]\nfree_thresh: 0.7",
            "m.yaml:4: free_thresh is `0.7`; keep",
        ),
        (
            "origin: [0,0,0]\noccupied_thresh: 0.1",
            "m.yaml:4: occupied_thresh is `0.1`; keep",
        ),
        (
            "origin: [0,0,0]\noccupied_thresh: 1.1",
            "m.yaml:4: occupied_thresh is `1.1`; write a number from 0 to 1",
        ),
        (
            "origin: [0,0,0]\nfree_thresh: NaN",
            "m.yaml:4: free_thresh is `NaN`",
        ),
    ];
    for (line, expected) in cases {
        let error = yaml_error(line);
        assert!(error.starts_with(expected), "{error} instead of {expected}");
    }
    for resolution in ["0", "-0.1", "inf", "", "0.0005", "1e4"] {
        let text = format!("image: a\nresolution: {resolution}\norigin: [0, 0, 0]");
        let error = parse_yaml(&text, "m.yaml").unwrap_err().to_string();
        assert!(error.starts_with("m.yaml:2: resolution is"), "{error}");
    }
    let error = parse_yaml("image:\nresolution: 1\norigin: [0,0,0]", "m.yaml").unwrap_err();
    assert_eq!(error.line, 1);
    let shouting = "x".repeat(100_000);
    let error = yaml_error(&format!("\u{1b}[2J{shouting}: 1"));
    assert!(error.len() < 300 && !error.contains('\u{1b}'), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn any_bytes_are_an_answer(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = parse_pgm(&bytes, "m.pgm");
        let _ = parse_yaml(&String::from_utf8_lossy(&bytes), "m.yaml");
    }

    #[test]
    fn any_header_is_an_answer(header in "P5[ \n#0-9]{0,20}[ \n]255\n[\\x00-\\x7f]{0,40}") {
        if let Ok(picture) = parse_pgm(header.as_bytes(), "m.pgm") {
            prop_assert_eq!(picture.greys.len(), picture.width * picture.height);
        }
    }

    #[test]
    fn any_value_is_an_answer(key in 0_usize..7, value in "[ \\[\\],.0-9'\"#e:-]{0,24}") {
        let keys = ["image", "mode", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"];
        let text = format!("{}: {value}\n", keys[key]);
        let _ = parse_yaml(&text, "m.yaml");
    }

    /// Every file that breaks off is refused.
    #[test]
    fn every_prefix_is_refused(cut in 0_usize..1000) {
        let whole = b"P5\n# a comment\n3 3\n255\n123456789";
        prop_assert!(parse_pgm(whole, "m.pgm").is_ok());
        prop_assert!(parse_pgm(&whole[..cut % whole.len()], "m.pgm").is_err());
    }
}
