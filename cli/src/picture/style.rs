//! Meanings and their colours, for light and dark paper, in one table.

use std::fmt::Write as _;

/// What a drawn thing means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Style {
    Paper,
    Frame,
    Grid,
    Label,
    LabelStrong,
    KnownFree,
    Wall,
    Invisible,
    Moving,
    MovingTrail,
    Swept,
    Footprint,
    FootprintStop,
    Actor,
    Start,
    Goal,
    PathPass,
    PathSlow,
    PathBrake,
    PathStop,
    PathNaked,
    NakedBody,
    Contact,
    ContactMoving,
    ContactResting,
    StopMark,
    MarkText,
    Scan,
    Memory,
    Deciding,
    Speed,
    SpeedFill,
    Clearance,
    ClearanceFill,
    Limit,
    Event,
    TermA,
    TermB,
    TermC,
    TermD,
    TermE,
    TermF,
    TermG,
    TermH,
    TermI,
    TermJ,
}

/// Colours as `0xRRGGBB` on light and on dark paper, with the opacity of the fill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Name of the CSS class.
    pub class: &'static str,
    /// Stroke colours (light, dark), if it has one.
    pub stroke: Option<(u32, u32)>,
    /// Stroke width in pixels.
    pub width: f64,
    /// Dash and gap in pixels, if dashed.
    pub dash: Option<(f64, f64)>,
    /// Fill colours (light, dark), if filled.
    pub fill: Option<(u32, u32)>,
    /// Opacity of the fill, 0 to 1.
    pub opacity: f64,
    /// Text size in pixels; zero if not a text.
    pub text: f64,
}

const fn stroke(class: &'static str, light: u32, dark: u32, width: f64) -> Look {
    Look {
        class,
        stroke: Some((light, dark)),
        width,
        dash: None,
        fill: None,
        opacity: 1.0,
        text: 0.0,
    }
}

const fn fill(class: &'static str, light: u32, dark: u32, opacity: f64) -> Look {
    Look {
        class,
        stroke: None,
        width: 0.0,
        dash: None,
        fill: Some((light, dark)),
        opacity,
        text: 0.0,
    }
}

const fn dashed(look: Look, dash: f64, gap: f64) -> Look {
    Look {
        dash: Some((dash, gap)),
        ..look
    }
}

const fn filled(look: Look, light: u32, dark: u32, opacity: f64) -> Look {
    Look {
        fill: Some((light, dark)),
        opacity,
        ..look
    }
}

const fn text(class: &'static str, light: u32, dark: u32, size: f64) -> Look {
    Look {
        text: size,
        ..fill(class, light, dark, 1.0)
    }
}

impl Style {
    /// Every style, for writing the style sheet.
    pub const ALL: [Self; 46] = [
        Self::Paper,
        Self::Frame,
        Self::Grid,
        Self::Label,
        Self::LabelStrong,
        Self::KnownFree,
        Self::Wall,
        Self::Invisible,
        Self::Moving,
        Self::MovingTrail,
        Self::Swept,
        Self::Footprint,
        Self::FootprintStop,
        Self::Actor,
        Self::Start,
        Self::Goal,
        Self::PathPass,
        Self::PathSlow,
        Self::PathBrake,
        Self::PathStop,
        Self::PathNaked,
        Self::NakedBody,
        Self::Contact,
        Self::ContactMoving,
        Self::ContactResting,
        Self::StopMark,
        Self::MarkText,
        Self::Scan,
        Self::Memory,
        Self::Deciding,
        Self::Speed,
        Self::SpeedFill,
        Self::Clearance,
        Self::ClearanceFill,
        Self::Limit,
        Self::Event,
        Self::TermA,
        Self::TermB,
        Self::TermC,
        Self::TermD,
        Self::TermE,
        Self::TermF,
        Self::TermG,
        Self::TermH,
        Self::TermI,
        Self::TermJ,
    ];

    /// How it looks. Blue, amber, orange and red tell the verdicts apart for colour-blind readers too.
    #[must_use]
    pub const fn look(self) -> Look {
        match self {
            Self::Paper => fill("paper", 0xff_ff_ff, 0x15_1a_21, 1.0),
            Self::Frame => stroke("frame", 0xd5_da_e1, 0x33_3c_48, 1.0),
            Self::Grid => stroke("grid", 0xe9_ec_f0, 0x24_2b_35, 1.0),
            Self::Label => text("label", 0x5b_66_75, 0x9a_a6_b5, 11.0),
            Self::MarkText => text("marktext", 0xff_ff_ff, 0x15_1a_21, 11.0),
            Self::LabelStrong => text("strong", 0x1d_25_30, 0xe6_ea_f0, 13.0),
            Self::KnownFree => fill("free", 0xdf_f1_e6, 0x1d_33_27, 1.0),
            Self::Wall => fill("wall", 0x3d_47_55, 0xa3_af_bf, 1.0),
            Self::Invisible => dashed(
                filled(
                    stroke("glass", 0x3d_8f_b5, 0x6c_c0_e6, 1.2),
                    0x9f_d4_ea,
                    0x2a_60_7a,
                    0.35,
                ),
                4.0,
                3.0,
            ),
            Self::Moving => filled(
                stroke("mover", 0x6d_28_d9, 0xb7_94_f6, 1.2),
                0x8b_5c_f6,
                0x8b_5c_f6,
                0.55,
            ),
            Self::MovingTrail => dashed(stroke("trail", 0x8b_5c_f6, 0xa7_86_f5, 1.0), 2.0, 4.0),
            _ => self.look_robot(),
        }
    }

    const fn look_robot(self) -> Look {
        match self {
            Self::Swept => fill("swept", 0x25_63_eb, 0x5b_92_f5, 0.08),
            Self::Footprint => filled(
                stroke("body", 0x25_63_eb, 0x7a_a8_f8, 1.0),
                0x25_63_eb,
                0x5b_92_f5,
                0.10,
            ),
            Self::FootprintStop => filled(
                stroke("rest", 0xc0_27_2d, 0xff_7b_7b, 1.4),
                0xc0_27_2d,
                0xff_7b_7b,
                0.14,
            ),
            Self::Actor => filled(
                stroke("actor", 0x0b_3d_c2, 0xcf_e0_ff, 1.8),
                0x25_63_eb,
                0x7a_a8_f8,
                0.55,
            ),
            Self::Start => filled(
                stroke("start", 0x1d_25_30, 0xe6_ea_f0, 1.2),
                0x1d_25_30,
                0xe6_ea_f0,
                0.10,
            ),
            Self::Goal => filled(
                stroke("goal", 0x15_80_3d, 0x4c_d2_8a, 1.6),
                0x22_c5_5e,
                0x22_c5_5e,
                0.25,
            ),
            _ => self.look_path(),
        }
    }

    const fn look_path(self) -> Look {
        match self {
            Self::PathPass => stroke("pass", 0x25_63_eb, 0x6f_a3_ff, 2.0),
            Self::PathSlow => stroke("slow", 0xe0_9a_00, 0xff_c9_4a, 2.6),
            Self::PathBrake => stroke("brake", 0xd9_5f_02, 0xff_93_4d, 2.8),
            Self::PathStop => stroke("stop", 0xc0_27_2d, 0xff_6b_6b, 3.0),
            Self::PathNaked => dashed(stroke("naked", 0xa2_1c_af, 0xe8_79_f9, 1.6), 5.0, 3.0),
            Self::NakedBody => dashed(
                filled(
                    stroke("nakedbody", 0xa2_1c_af, 0xe8_79_f9, 1.0),
                    0xa2_1c_af,
                    0xe8_79_f9,
                    0.10,
                ),
                3.0,
                2.0,
            ),
            Self::Contact => filled(
                stroke("contact", 0xa2_1c_af, 0xe8_79_f9, 2.2),
                0xff_ff_ff,
                0x15_1a_21,
                0.85,
            ),
            Self::ContactMoving => filled(
                stroke("hit", 0xc0_27_2d, 0xff_6b_6b, 2.2),
                0xff_ff_ff,
                0x15_1a_21,
                0.85,
            ),
            Self::ContactResting => filled(
                stroke("bump", 0x5b_66_75, 0x9a_a6_b5, 2.0),
                0xff_ff_ff,
                0x15_1a_21,
                0.85,
            ),
            Self::StopMark => filled(
                stroke("mark", 0xff_ff_ff, 0x15_1a_21, 1.0),
                0xc0_27_2d,
                0xff_6b_6b,
                1.0,
            ),
            Self::Scan => fill("scan", 0x1d_25_30, 0xd5_dc_e6, 1.0),
            Self::Memory => fill("memory", 0x0e_9a_a7, 0x3f_d0_dc, 1.0),
            Self::Deciding => stroke("deciding", 0xc0_27_2d, 0xff_6b_6b, 1.2),
            _ => self.look_plot(),
        }
    }

    const fn look_plot(self) -> Look {
        match self {
            Self::SpeedFill => fill("speedfill", 0x25_63_eb, 0x6f_a3_ff, 0.12),
            Self::Clearance => stroke("gap", 0x0e_9a_a7, 0x3f_d0_dc, 1.6),
            Self::ClearanceFill => fill("gapfill", 0x0e_9a_a7, 0x3f_d0_dc, 0.10),
            Self::Limit => dashed(stroke("limit", 0xc0_27_2d, 0xff_7b_7b, 1.0), 4.0, 3.0),
            Self::Event => fill("event", 0xc0_27_2d, 0xff_6b_6b, 0.18),
            Self::TermA => fill("ta", 0x25_63_eb, 0x6f_a3_ff, 1.0),
            Self::TermB => fill("tb", 0x0e_9a_a7, 0x3f_d0_dc, 1.0),
            Self::TermC => fill("tc", 0xe0_9a_00, 0xff_c9_4a, 1.0),
            Self::TermD => fill("td", 0xc0_27_2d, 0xff_6b_6b, 1.0),
            Self::TermE => fill("te", 0x6d_28_d9, 0xb7_94_f6, 1.0),
            Self::TermF => fill("tf", 0x15_80_3d, 0x4c_d2_8a, 1.0),
            Self::TermG => fill("tg", 0xa1_62_07, 0xd9_a4_41, 1.0),
            Self::TermI => fill("ti", 0xdb_27_77, 0xf4_72_b6, 1.0),
            Self::TermJ => fill("tj", 0x7c_9a_1e, 0xb5_d3_4f, 1.0),
            Self::TermH => fill("th", 0x6b_72_80, 0x9c_a3_af, 1.0),
            // `Speed`, and nothing else: the other meanings were answered above.
            _ => stroke("speed", 0x25_63_eb, 0x6f_a3_ff, 1.6),
        }
    }
}

/// The style sheet of all meanings; dark colours follow the reader's preference.
#[must_use]
pub fn style_sheet() -> String {
    let mut sheet = String::from("svg.hl text{font-family:ui-sans-serif,system-ui,sans-serif}\n");
    let mut dark = String::new();
    for style in Style::ALL {
        let look = style.look();
        let class = look.class;
        let mut rule = String::new();
        let mut dark_rule = String::new();
        match look.fill {
            Some((light, dark)) => {
                let _ = write!(rule, "fill:#{light:06x};");
                let _ = write!(dark_rule, "fill:#{dark:06x};");
                if look.opacity < 1.0 {
                    let _ = write!(rule, "fill-opacity:{};", look.opacity);
                }
            }
            None => rule.push_str("fill:none;"),
        }
        if let Some((light, dark)) = look.stroke {
            let _ = write!(rule, "stroke:#{light:06x};stroke-width:{};", look.width);
            let _ = write!(dark_rule, "stroke:#{dark:06x};");
        }
        if let Some((dash, gap)) = look.dash {
            let _ = write!(rule, "stroke-dasharray:{dash} {gap};");
        }
        if look.text > 0.0 {
            let _ = write!(rule, "font-size:{}px;", look.text);
            if style != Style::MarkText {
                // A halo of paper keeps words readable across walls and paths.
                let (light, dark) = Style::Paper.look().fill.unwrap_or((0xff_ff_ff, 0));
                let _ = write!(
                    rule,
                    "paint-order:stroke;stroke-width:3px;stroke-linejoin:round;stroke:#{light:06x};"
                );
                let _ = write!(dark_rule, "stroke:#{dark:06x};");
            }
        }
        let _ = writeln!(sheet, ".hl .{class}{{{rule}}}");
        let _ = writeln!(dark, ".hl .{class}{{{dark_rule}}}");
    }
    sheet.push_str(".hl .strong{font-weight:600}.hl path{stroke-linejoin:round}\n");
    let _ = write!(sheet, "@media (prefers-color-scheme:dark){{\n{dark}}}\n");
    sheet
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_meaning_has_its_own_class_and_look() {
        let classes: BTreeSet<_> = Style::ALL.iter().map(|s| s.look().class).collect();
        assert_eq!(classes.len(), Style::ALL.len());
        let styles: BTreeSet<_> = Style::ALL.iter().collect();
        assert_eq!(styles.len(), Style::ALL.len());
    }
}
