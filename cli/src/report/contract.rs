//! The contract of the report: checks, and the two tables with every term drawn to scale.

use crate::picture::svg::{self, escape};
use crate::picture::{Anchor, Picture, Style};
use haltline_robots::contract::{Check, Contract, Finding, GapRow, SpeedRow, Term};
use std::fmt::Write as _;

/// A colour for each term; the same term has the same colour in every bar of the report.
const TERM_STYLES: [Style; 10] = [
    Style::TermA,
    Style::TermB,
    Style::TermC,
    Style::TermD,
    Style::TermE,
    Style::TermF,
    Style::TermG,
    Style::TermH,
    Style::TermI,
    Style::TermJ,
];

/// The section.
pub fn write(page: &mut String, contract: &Contract) {
    page.push_str(
        "<h2 id=\"contract\">Contract</h2>\n<p class=\"soft\">Arithmetic on the robot file, worst case in every term: \
         do the limits fit together, how fast may the robot drive, how narrow may a gap be, and which term decides?</p>\n",
    );
    checks(page, &contract.checks);
    page.push_str("<div class=\"two\">");
    let names = term_names(contract);
    speeds(page, &contract.speed_table, &names);
    gaps(page, &contract.gap_table, &names);
    page.push_str("</div>\n");
    assumed(page, contract);
}

fn finding(finding: Finding) -> (&'static str, &'static str) {
    match finding {
        Finding::Holds => ("holds", "holds"),
        Finding::Fails => ("failed", "FAILS"),
        Finding::NotCovered => ("not_claimed", "not covered"),
    }
}

fn checks(page: &mut String, checks: &[Check]) {
    page.push_str(
        "<div class=\"card scroll\"><table><tr><th>check</th><th></th><th class=\"num\">value</th>\
         <th class=\"num\">bound</th><th>in words</th></tr>",
    );
    for check in checks {
        let (class, word) = finding(check.finding);
        let _ = write!(
            page,
            "<tr id=\"{id}\"><td><b>{title}</b><div class=\"mono soft small\">{id}</div></td>\
             <td><span class=\"chip {class}\">{word}</span></td><td class=\"num\">{value} {unit}</td>\
             <td class=\"num\">{bound} {unit}</td><td class=\"small\">{sentence}</td></tr>",
            id = escape(check.id),
            title = escape(check.title),
            value = short(check.value),
            bound = short(check.bound),
            unit = escape(check.unit),
            sentence = escape(&check.sentence),
        );
    }
    page.push_str("</table></div>\n");
}

/// Three significant decimals, without a tail of zeros.
fn short(value: f64) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0" } else { text }.to_owned()
}

fn speeds(page: &mut String, rows: &[SpeedRow], names: &[&str]) {
    page.push_str("<div class=\"card\">");
    let bars: Vec<Bar<'_>> = rows
        .iter()
        .map(|row| Bar {
            label: format!("{} m/s", short(row.obstacle_speed_mps)),
            result: format!("{} m/s", short(row.top_speed_mps)),
            terms: &row.terms,
            limit_m: Some(row.known_m),
        })
        .collect();
    let heading = "Top speed, by speed of obstacles";
    let axis = "path and margins ahead of the front edge; dashes: how far ahead bodies are known";
    page.push_str(&svg::element(&stacked([heading, axis], &bars, names)));
    page.push_str("<div class=\"body\"><table><tr><th>obstacles up to</th><th>top speed</th><th>decides</th></tr>");
    for row in rows {
        let _ = write!(
            page,
            "<tr><td>{} m/s</td><td><b>{} m/s</b></td><td>{}<div class=\"soft small\">{}</div></td></tr>",
            short(row.obstacle_speed_mps),
            short(row.top_speed_mps),
            escape(row.decides),
            escape(&row.sentence)
        );
    }
    page.push_str("</table></div></div>");
}

fn gaps(page: &mut String, rows: &[GapRow], names: &[&str]) {
    page.push_str("<div class=\"card\">");
    let bars: Vec<Bar<'_>> = rows
        .iter()
        .map(|row| Bar {
            label: format!("{} m/s", short(row.obstacle_speed_mps)),
            result: row
                .gap_m
                .map_or_else(|| "none".to_owned(), |gap| format!("{} m", short(gap))),
            terms: &row.terms,
            limit_m: None,
        })
        .collect();
    let heading = "Smallest passable gap, by speed of obstacles";
    let axis = "margin on each side of the robot";
    page.push_str(&svg::element(&stacked([heading, axis], &bars, names)));
    page.push_str(
        "<div class=\"body\"><table><tr><th>obstacles up to</th><th>gap</th><th>at top speed</th><th>decides</th></tr>",
    );
    for row in rows {
        let gap = |gap: Option<f64>| {
            gap.map_or_else(|| "none".to_owned(), |gap| format!("{} m", short(gap)))
        };
        let _ = write!(
            page,
            "<tr><td>{} m/s</td><td><b>{}</b> at {} m/s</td><td>{}</td><td>{}<div class=\"soft small\">{}</div></td></tr>",
            short(row.obstacle_speed_mps),
            gap(row.gap_m),
            short(row.at_speed_mps),
            gap(row.gap_at_top_speed_m),
            escape(row.decides),
            escape(&row.sentence)
        );
    }
    page.push_str("</table></div></div>");
}

/// Names of all terms of both tables, in the order in which they appear.
fn term_names(contract: &Contract) -> Vec<&'static str> {
    let speeds = contract.speed_table.iter().flat_map(|row| &row.terms);
    let gaps = contract.gap_table.iter().flat_map(|row| &row.terms);
    let mut names = Vec::new();
    for term in speeds.chain(gaps) {
        if !names.contains(&term.name) {
            names.push(term.name);
        }
    }
    names
}

struct Bar<'a> {
    label: String,
    result: String,
    terms: &'a [Term],
    limit_m: Option<f64>,
}

/// Horizontal bars of stacked terms, each term in the same colour in every bar.
fn stacked([heading, axis]: [&str; 2], bars: &[Bar<'_>], names: &[&str]) -> Picture {
    const WIDTH: f64 = 620.0;
    const LEFT: f64 = 68.0;
    const INNER: f64 = WIDTH - LEFT - 84.0;
    let legend_rows = names.len().div_ceil(3);
    let top = 48.0;
    let bottom = top + 34.0 * bars.len() as f64;
    let mut picture = Picture::new(WIDTH, bottom + 16.0 + 17.0 * legend_rows as f64, heading);
    picture.rect([0.0, 0.0], [WIDTH, picture.height], Style::Paper);
    picture.text([12.0, 22.0], Anchor::Start, Style::LabelStrong, heading);
    picture.text([12.0, 38.0], Anchor::Start, Style::Label, axis);
    let sum = |bar: &Bar<'_>| {
        bar.terms
            .iter()
            .map(|term| term.value_m.max(0.0))
            .sum::<f64>()
    };
    let longest = bars
        .iter()
        .map(|bar| sum(bar).max(bar.limit_m.unwrap_or(0.0)))
        .fold(1e-3, f64::max);
    for (index, bar) in bars.iter().enumerate() {
        let y = top + 34.0 * index as f64;
        picture.text(
            [LEFT - 8.0, y + 18.0],
            Anchor::End,
            Style::Label,
            bar.label.clone(),
        );
        let mut x = LEFT;
        for term in bar.terms {
            let width = INNER * term.value_m.max(0.0) / longest;
            let place = names
                .iter()
                .position(|name| *name == term.name)
                .unwrap_or(0);
            let style = TERM_STYLES[place % TERM_STYLES.len()];
            if width > 0.2 {
                picture.rect([x, y + 4.0], [width, 20.0], style);
            }
            x += width;
        }
        let end = (x + 8.0).min(WIDTH - 74.0);
        picture.text(
            [end, y + 19.0],
            Anchor::Start,
            Style::LabelStrong,
            bar.result.clone(),
        );
        if let Some(limit_m) = bar.limit_m {
            let at = LEFT + INNER * limit_m / longest;
            picture.line(vec![[at, y], [at, y + 28.0]], Style::Limit);
        }
    }
    draw_legend(&mut picture, names, bottom + 20.0);
    picture
}

fn draw_legend(picture: &mut Picture, names: &[&str], top: f64) {
    for (index, name) in names.iter().enumerate() {
        let x = 14.0 + 200.0 * (index % 3) as f64;
        let y = top + 17.0 * (index / 3) as f64;
        picture.rect(
            [x, y - 9.0],
            [11.0, 11.0],
            TERM_STYLES[index % TERM_STYLES.len()],
        );
        picture.text([x + 16.0, y], Anchor::Start, Style::Label, *name);
    }
}

fn assumed(page: &mut String, contract: &Contract) {
    if contract.assumed.is_empty() {
        return;
    }
    let _ = write!(
        page,
        "<details><summary>{} values of the robot file are assumed, not measured</summary>\
         <div class=\"card scroll\"><table><tr><th>key</th><th>value</th><th>source</th></tr>",
        contract.assumed.len()
    );
    for value in &contract.assumed {
        let _ = write!(
            page,
            "<tr><td class=\"mono\">{}</td><td class=\"mono\">{}</td><td class=\"small\">{}</td></tr>",
            escape(&value.key),
            escape(&value.value),
            escape(&value.source)
        );
    }
    page.push_str("</table></div></details>\n");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(short(1.25), "1.25");
        assert_eq!(short(3.0), "3");
        assert_eq!(short(-0.0001), "0");
        assert_eq!(short(f64::INFINITY), "–");
    }

    #[test]
    fn terms_keep_their_colour_from_bar_to_bar() {
        let terms = [
            vec![
                Term {
                    name: "sensor",
                    value_m: 0.1,
                },
                Term {
                    name: "spread",
                    value_m: 0.1,
                },
            ],
            vec![Term {
                name: "spread",
                value_m: 0.1,
            }],
        ];
        let bars: Vec<Bar<'_>> = terms
            .iter()
            .map(|terms| Bar {
                label: String::new(),
                result: String::new(),
                terms,
                limit_m: None,
            })
            .collect();
        let svg = svg::element(&stacked(["h", "a"], &bars, &["sensor", "spread"]));
        // One box for the sensor term and two for the spread, and one of each in the legend.
        assert_eq!(svg.matches("class=\"ta\"").count(), 2, "{svg}");
        assert_eq!(svg.matches("class=\"tb\"").count(), 3, "{svg}");
    }
}
