//! Map files: pictures have as many pixels as they say, and what is written is read back.

use crate::text::{points_into, spoiled, text};
use crate::{Judged, Property, demand};
use haltline::grid::GridRules;
use haltline_maps::{
    Description, Map, MapError, Picture, parse_pgm, parse_yaml, render_pgm, render_yaml,
};

pub const PGM: Property = Property {
    name: "pgm",
    judge: |bytes| picture(bytes, parse_pgm),
    twins: &[
        ("a pixel lost", |bytes| {
            picture(bytes, |bytes, file| {
                let mut picture = parse_pgm(bytes, file)?;
                picture.greys.pop();
                Ok(picture)
            })
        }),
        ("brighter", |bytes| {
            picture(bytes, |bytes, file| {
                let mut picture = parse_pgm(bytes, file)?;
                picture.greys[0] ^= 1;
                Ok(picture)
            })
        }),
    ],
    draw: |draw| {
        let (width, height) = (1 + draw.index(9), 1 + draw.index(9));
        let mut bytes = spoiled(draw, &format!("P5\n# map\n{width} {height}\n255"));
        let more = draw.index(3);
        bytes.extend((0..width * height + more * more / 4).map(|_| (draw.bits() >> 56) as u8));
        bytes
    },
    cases: 8000,
};

fn picture(bytes: &[u8], parse: fn(&[u8], &str) -> Result<Picture, MapError>) -> Judged {
    let picture = match parse(bytes, "m.pgm") {
        Ok(picture) => picture,
        Err(error) => {
            let lines = bytes.iter().filter(|byte| **byte == b'\n').count() + 2;
            return demand(error.line <= lines && !error.advice.is_empty(), || {
                format!("{error:?}")
            })
            .map(|()| 0);
        }
    };
    let (width, height) = (picture.width, picture.height);
    let whole = width.checked_mul(height) == Some(picture.greys.len());
    demand(whole && picture.greys.len() <= bytes.len(), || {
        format!("{width} x {height}")
    })?;
    // With 255 as the largest grey, pixels are the file's last bytes.
    let tail = &bytes[bytes.len() - picture.greys.len()..];
    let plain = text(&bytes[..bytes.len() - picture.greys.len()])
        .is_some_and(|head| head.trim_end().ends_with("255"));
    demand(!plain || picture.greys == tail, || {
        "other pixels than in the file".to_owned()
    })?;
    let again = parse(&render_pgm(&picture, 0.05), "m.pgm");
    demand(again.as_ref() == Ok(&picture), || {
        format!("read back: {again:?}")
    })?;
    if width <= 24 && height <= 24 {
        let map = Map::from_picture(&picture, &Description::new("m.pgm", 0.05, [0.0; 3]));
        let grid = map.to_grid::<24, 24>(GridRules::default());
        let grid = grid.map_err(|error| error.to_string())?;
        let back = Map::from_grid(&grid);
        for row in 0..height {
            for column in 0..width {
                demand(
                    map.occupancy(column, row) == back.occupancy(column, row),
                    || format!("cell {column}, {row} changed"),
                )?;
            }
        }
    }
    Ok(1)
}

pub const YAML: Property = Property {
    name: "yaml",
    judge: |bytes| description(bytes, parse_yaml),
    twins: &[
        ("a resolution of zero", |bytes| {
            description(bytes, |text, file| {
                let mut read = parse_yaml(text, file)?;
                read.resolution_m = 0.0;
                Ok(read)
            })
        }),
        ("free above occupied", |bytes| {
            description(bytes, |text, file| {
                let mut read = parse_yaml(text, file)?;
                read.free_thresh = 2.0;
                Ok(read)
            })
        }),
    ],
    draw: |draw| {
        spoiled(
            draw,
            "image: map.pgm\nresolution: 0.05\norigin: [-1.5, 2, 0.1]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\nmode: trinary",
        )
    },
    cases: 8000,
};

fn description(bytes: &[u8], parse: fn(&str, &str) -> Result<Description, MapError>) -> Judged {
    let Some(text) = text(bytes) else {
        return Ok(0);
    };
    let read = match parse(text, "m.yaml") {
        Ok(read) => read,
        Err(error) => return points_into(text, error.line, &error.problem).map(|()| 0),
    };
    let finite = read.origin.iter().all(|value| value.is_finite());
    let sizes = (0.001..=1000.0).contains(&read.resolution_m);
    let order = 0.0 <= read.free_thresh
        && read.free_thresh <= read.occupied_thresh
        && read.occupied_thresh <= 1.0;
    demand(finite && sizes && order && !read.image.is_empty(), || {
        format!("took {read:?}")
    })?;
    let again = parse(&render_yaml(&read), "m.yaml");
    demand(again.as_ref() == Ok(&read), || {
        format!("{read:?} read back: {again:?}")
    })?;
    Ok(1)
}
