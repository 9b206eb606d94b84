//! Binary greymaps (PGM, `P5`), eight bits per pixel.

use crate::error::{MapError, shown};

/// Largest number of columns and of rows that is read or written: 102 m at 0.025 m a cell, and
/// what a grid of the kernel can hold.
pub const CELLS_PER_SIDE_MAX: usize = haltline::grid::CELLS_MAX;

/// Longest header, comments included, bytes.
const HEADER_MAX: usize = 4096;

/// Longest file that can be a picture of the allowed size, bytes.
pub(crate) const BYTES_MAX: usize = CELLS_PER_SIDE_MAX * CELLS_PER_SIDE_MAX + HEADER_MAX;

/// A grey picture; 0 is black, 255 is white.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Greys row by row, the top row first; `width * height` of them.
    pub greys: Vec<u8>,
}

/// Reads a binary greymap; `file` names it in errors.
///
/// A largest grey below 255 is scaled up to it.
///
/// # Errors
/// Another format, more than [`CELLS_PER_SIDE_MAX`] pixels per side, 16 bits per pixel, and
/// too few or too many bytes.
pub fn parse_pgm(bytes: &[u8], file: &str) -> Result<Picture, MapError> {
    let mut header = Header {
        bytes,
        at: 0,
        line: 1,
        file,
    };
    if bytes.get(..2) != Some(b"P5") {
        let start = String::from_utf8_lossy(bytes.get(..2).unwrap_or(bytes));
        return Err(header.error(
            format!("starts with {:?}, not with \"P5\"", shown(&start)),
            "save the picture as a binary greymap (PGM, P5)",
        ));
    }
    header.at = 2;
    let width = header.side("width")?;
    let height = header.side("height")?;
    let largest = header.number("largest grey")?;
    if !(1..=255).contains(&largest) {
        return Err(header.error(
            format!("largest grey is {largest}"),
            "write 255: one byte per pixel",
        ));
    }
    header.single_space()?;
    let greys = header.pixels(width, height)?;
    Ok(Picture {
        width,
        height,
        greys: greys.iter().map(|grey| scaled(*grey, largest)).collect(),
    })
}

/// `grey` of `largest` as one of 255, rounded to nearest.
fn scaled(grey: u8, largest: usize) -> u8 {
    let grey = usize::from(grey).min(largest);
    u8::try_from((grey * 255 + largest / 2) / largest.max(1)).unwrap_or(u8::MAX)
}

/// A binary greymap of `picture`.
#[must_use]
pub fn render_pgm(picture: &Picture, resolution_m: f64) -> Vec<u8> {
    let (width, height) = (picture.width, picture.height);
    let mut bytes =
        format!("P5\n# occupancy grid, {resolution_m} m per pixel\n{width} {height}\n255\n")
            .into_bytes();
    bytes.extend_from_slice(&picture.greys);
    bytes
}

/// A cursor over the text before the pixels.
struct Header<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
    file: &'a str,
}

impl<'a> Header<'a> {
    fn error(&self, problem: impl Into<String>, advice: impl Into<String>) -> MapError {
        MapError::new(self.file, self.line, problem, advice)
    }

    fn peek(&self) -> Option<u8> {
        let text = self.bytes.get(..HEADER_MAX).unwrap_or(self.bytes);
        text.get(self.at).copied()
    }

    fn advance(&mut self) {
        self.line += usize::from(self.peek() == Some(b'\n'));
        self.at += 1;
    }

    /// Past white space and comments.
    fn skip(&mut self) {
        let mut comment = false;
        while let Some(byte) = self.peek() {
            match byte {
                b'#' => comment = true,
                b'\n' => comment = false,
                _ if comment || byte.is_ascii_whitespace() => {}
                _ => return,
            }
            self.advance();
        }
    }

    fn number(&mut self, what: &str) -> Result<usize, MapError> {
        let before = self.at;
        self.skip();
        let spaced = self.at > before;
        let start = self.at;
        while self.peek().is_some_and(|byte| byte.is_ascii_digit()) {
            self.advance();
        }
        let digits = self.bytes.get(start..self.at).unwrap_or_default();
        let text = String::from_utf8_lossy(digits);
        match text.parse() {
            Ok(number) if spaced => Ok(number),
            _ if digits.is_empty() || !spaced => {
                Err(self.error(format!("no number for the {what}"), "write a whole number"))
            }
            _ => Err(self.error(
                format!("{what} {} is too large", shown(&text)),
                format!("use at most {CELLS_PER_SIDE_MAX}"),
            )),
        }
    }

    fn side(&mut self, what: &str) -> Result<usize, MapError> {
        let side = self.number(what)?;
        if (1..=CELLS_PER_SIDE_MAX).contains(&side) {
            Ok(side)
        } else {
            Err(self.error(
                format!("{what} is {side}"),
                format!("use 1 to {CELLS_PER_SIDE_MAX} pixels per side; crop or scale the map"),
            ))
        }
    }

    fn single_space(&mut self) -> Result<(), MapError> {
        if self.peek().is_some_and(|byte| byte.is_ascii_whitespace()) {
            self.advance();
            Ok(())
        } else {
            Err(self.error(
                "no white space after the largest grey",
                "end the header with one line break",
            ))
        }
    }

    /// All bytes after the header, if there are as many as the header says.
    fn pixels(&self, width: usize, height: usize) -> Result<&'a [u8], MapError> {
        let pixels = self.bytes.get(self.at..).unwrap_or_default();
        let expected = width * height;
        if pixels.len() == expected {
            return Ok(pixels);
        }
        let found = pixels.len();
        let (kind, advice) = if found < expected {
            ("truncated", "copy or export the picture again")
        } else {
            ("too long", "keep one picture per file")
        };
        Err(MapError::new(
            self.file,
            0,
            format!("{kind}: {width} x {height} pixels are {expected} bytes, found {found}"),
            advice,
        ))
    }
}
