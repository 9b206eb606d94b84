//! `trace.jsonl`: one line for every dynamics step, so that anyone can recount.

use core::fmt::Write as _;

/// State at one dynamics step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceStep<'a> {
    /// Time since the start of the run.
    pub t_s: f64,
    /// True position along x.
    pub x_m: f64,
    /// True position along y.
    pub y_m: f64,
    /// True heading in (−π, π].
    pub theta_rad: f64,
    /// True forward speed.
    pub v_mps: f64,
    /// True turn rate.
    pub omega_radps: f64,
    /// Action in force.
    pub decision: &'a str,
    /// Its reason.
    pub reason: &'a str,
}

/// Appends one line; numbers have six decimals, and zero has no sign.
pub fn push_line(text: &mut String, step: &TraceStep<'_>) {
    let written = write!(
        text,
        "{{\"t_s\":{:.3},\"x_m\":{},\"y_m\":{},\"theta_rad\":{},\"v_mps\":{},\"omega_radps\":{},\
         \"decision\":\"{}\",\"reason\":\"{}\"}}",
        step.t_s,
        six(step.x_m),
        six(step.y_m),
        six(step.theta_rad),
        six(step.v_mps),
        six(step.omega_radps),
        step.decision,
        step.reason,
    );
    // Writing to a String cannot fail; the result exists only for the trait.
    debug_assert!(written.is_ok());
    text.push('\n');
}

fn six(value: f64) -> String {
    let text = format!("{value:.6}");
    if text == "-0.000000" {
        "0.000000".to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_has_fixed_form() {
        let mut text = String::new();
        push_line(
            &mut text,
            &TraceStep {
                t_s: 0.01,
                x_m: -1e-9,
                y_m: 1.0,
                theta_rad: -0.5,
                v_mps: 0.1234567,
                omega_radps: 0.0,
                decision: "Pass",
                reason: "None",
            },
        );
        assert_eq!(
            text,
            "{\"t_s\":0.010,\"x_m\":0.000000,\"y_m\":1.000000,\"theta_rad\":-0.500000,\
             \"v_mps\":0.123457,\"omega_radps\":0.000000,\"decision\":\"Pass\",\"reason\":\"None\"}\n"
        );
    }
}
