//! `haltline replay --format carmen`: recorded drives of the CARMEN toolkit.
//!
//! `FLASER` lines are all that is needed: each has one sweep, the pose that the recording
//! believed in (drawn as the map), and the odometry (what the kernel is shown).

mod map;

pub use haltline_logs::carmen::{Carmen, read};
pub use map::write_map;

use crate::failure::Failure;
use haltline_logs::sena::Header;
use haltline_robots::Robot;

/// The SENA wheelchair with this log's laser: logs say nothing about the robot.
///
/// # Errors
/// A laser that no robot file can state.
pub fn assumed_robot(header: &Header) -> Result<Robot, Failure> {
    let own = Robot::embedded("sena").map_err(|error| Failure::input(error.to_string()))?;
    let [x_m, y_m, yaw_rad] = header.sensor_m_rad;
    let stated = [
        ("x_m", x_m),
        ("y_m", y_m),
        ("yaw_deg", yaw_rad.to_degrees()),
        ("field_of_view_deg", header.aperture_rad.to_degrees()),
        ("beams", header.beams as f64),
    ];
    let mut in_scanner = false;
    let mut text = String::new();
    for line in own.text.lines() {
        in_scanner |= line.trim() == "[[scanner]]";
        let key = line.split('=').next().unwrap_or_default().trim();
        match stated
            .iter()
            .find(|(stated, _)| in_scanner && *stated == key)
        {
            Some(("beams", _)) => text += &format!("beams = {}\n", header.beams),
            Some((key, value)) => text += &format!("{key} = {value:.6}\n"),
            None => text += &format!("{line}\n"),
        }
    }
    Robot::parse(&text, "sena.toml with the log's laser")
        .map_err(|error| Failure::input(error.to_string()))
}
