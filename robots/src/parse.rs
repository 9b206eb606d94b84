//! From the text of a robot file to [`Values`], table by table.

use crate::error::{RobotError, Source};
use crate::reader::{self, Places, TableReader};
use crate::robot::{
    Footprint, HostDeath, Kinematics, Limits, Memory, Ramps, Silence, Steering, Timing, Tolerances,
    Values, Zone,
};
use crate::scanner::{Encoding, Mask, Scanner};

/// Name, values and the places of all values.
pub(crate) fn values(source: Source<'_>) -> Result<(String, Values, Places), RobotError> {
    let document = reader::document(source)?;
    let root = document.get_ref();
    reader::check_top_level(source, root)?;
    let mut places = Places::default();
    let mut open = |name| reader::table(source, root, name, &mut places);

    let head = open("robot")?;
    let name = head.text("name")?;
    let footprint = footprint(&open("footprint")?)?;
    let kinematics = match head.choice("kinematics")? {
        "ackermann" => Kinematics::Ackermann(steering(&open("steering")?)?),
        _ => Kinematics::Differential,
    };
    if let (Kinematics::Differential, Some(value)) = (kinematics, root.get("steering")) {
        return Err(source.error(
            &value.span(),
            "table `[steering]` does not fit kinematics = \"differential\"",
            "remove it or write `kinematics = \"ackermann\"` in `[robot]`",
        ));
    }
    let limits = limits(&open("limits")?)?;
    let timing = timing(&open("timing")?)?;
    let tolerances = tolerances(&open("tolerances")?)?;
    let zone = zone(&open("zone")?)?;
    let memory = memory(&open("memory")?)?;
    let obstacle_speed_mps = open("obstacles")?.number("speed_mps")?;
    let host_death = host_death(&open("host_death")?)?;
    let mut scanners = Vec::new();
    let readers = reader::tables(source, root, "scanner", "scanner", &mut places)?;
    for (index, table) in readers.iter().enumerate() {
        let path = format!("scanner[{index}].mask");
        let masks = reader::tables(source, table.entries(), "scanner.mask", &path, &mut places)?;
        scanners.push(scanner(table, &masks)?);
    }
    let values = Values {
        footprint,
        kinematics,
        limits,
        timing,
        tolerances,
        zone,
        memory,
        obstacle_speed_mps,
        host_death,
        scanners,
    };
    Ok((name, values, places))
}

fn footprint(table: &TableReader<'_>) -> Result<Footprint, RobotError> {
    Ok(Footprint {
        front_m: table.number("front_m")?,
        rear_m: table.number("rear_m")?,
        left_m: table.number("left_m")?,
        right_m: table.number("right_m")?,
    })
}

fn steering(table: &TableReader<'_>) -> Result<Steering, RobotError> {
    Ok(Steering {
        wheelbase_m: table.number("wheelbase_m")?,
        turning_radius_m: table.number("turning_radius_m")?,
        sweep_s: table.number("sweep_s")?,
        tolerance_rad: table.number("tolerance_deg")?.to_radians(),
    })
}

fn limits(table: &TableReader<'_>) -> Result<Limits, RobotError> {
    Ok(Limits {
        speed_forward_mps: table.number("speed_forward_mps")?,
        speed_reverse_mps: table.number("speed_reverse_mps")?,
        reverse_into_memory: table.flag("reverse_into_memory")?,
        angular_speed_radps: table.number("angular_speed_radps")?,
        acceleration_mps2: table.number("acceleration_mps2")?,
        braking_mps2: table.number("braking_mps2")?,
        angular_acceleration_radps2: table.number("angular_acceleration_radps2")?,
        angular_braking_radps2: table.number("angular_braking_radps2")?,
        ramps: match table.choice("ramps")? {
            "separate" => Ramps::Separate,
            _ => Ramps::Together,
        },
    })
}

fn timing(table: &TableReader<'_>) -> Result<Timing, RobotError> {
    Ok(Timing {
        period_s: table.number("period_s")?,
        jitter_s: table.number("jitter_s")?,
        actuation_latency_s: table.number("actuation_latency_s")?,
        scan_age_max_s: table.number("scan_age_max_s")?,
        odometry_age_max_s: table.number("odometry_age_max_s")?,
        command_age_max_s: table.number("command_age_max_s")?,
        rest_s: table.number("rest_s")?,
        clear_s: table.number("clear_s")?,
        tracking_window_s: table.number("tracking_window_s")?,
    })
}

fn tolerances(table: &TableReader<'_>) -> Result<Tolerances, RobotError> {
    Ok(Tolerances {
        speed_mps: table.number("speed_mps")?,
        angular_speed_radps: table.number("angular_speed_radps")?,
        tracking_m: table.number("tracking_m")?,
        odometry_m_per_m: table.number("odometry_m_per_m")?,
        odometry_rad_per_rad: table.number("odometry_rad_per_rad")?,
        rest_speed_mps: table.number("rest_speed_mps")?,
        rest_angular_speed_radps: table.number("rest_angular_speed_radps")?,
        follow_speed_mps: table.number("follow_speed_mps")?,
        follow_angular_speed_radps: table.number("follow_angular_speed_radps")?,
    })
}

fn zone(table: &TableReader<'_>) -> Result<Zone, RobotError> {
    Ok(Zone {
        front_m: table.number("front_m")?,
        side_m: table.number("side_m")?,
    })
}

fn memory(table: &TableReader<'_>) -> Result<Memory, RobotError> {
    Ok(Memory {
        // The schema bounds the count by 255.
        clear_after_scans: u8::try_from(table.count("clear_after_scans")?).unwrap_or(u8::MAX),
        age_max_s: table.number("age_max_s")?,
        clear_at_start_m: table.number("clear_at_start_m")?,
        skirt_m: table.number("skirt_m")?,
        body_width_min_m: table.number("body_width_min_m")?,
    })
}

fn host_death(table: &TableReader<'_>) -> Result<HostDeath, RobotError> {
    Ok(HostDeath {
        watchdog_s: table.number("watchdog_s")?,
        behaviour: match table.choice("behaviour")? {
            "brake" => Silence::Brake,
            _ => Silence::Coast,
        },
        braking_mps2: table.number("braking_mps2")?,
        angular_braking_radps2: table.number("angular_braking_radps2")?,
        cover_host_death: table.flag("cover_host_death")?,
    })
}

fn scanner(table: &TableReader<'_>, masks: &[TableReader<'_>]) -> Result<Scanner, RobotError> {
    Ok(Scanner {
        name: table.text("name")?,
        x_m: table.number("x_m")?,
        y_m: table.number("y_m")?,
        yaw_rad: table.number("yaw_deg")?.to_radians(),
        field_of_view_rad: table.number("field_of_view_deg")?.to_radians(),
        upside_down: table.flag("upside_down")?,
        // The schema bounds the count by BEAMS.
        beams: u16::try_from(table.count("beams")?).unwrap_or(u16::MAX),
        scan_time_s: table.number("scan_time_s")?,
        rate_hz: table.number("rate_hz")?,
        encoding: match table.choice("encoding")? {
            "rep117" => Encoding::Rep117,
            "zero_is_none" => Encoding::ZeroIsNone,
            _ => Encoding::ZeroIsInvalid,
        },
        range_min_m: table.number("range_min_m")?,
        range_max_m: table.number("range_max_m")?,
        error_systematic_m: table.number("error_systematic_m")?,
        error_sigma_m: table.number("error_sigma_m")?,
        no_return_clear_m: table.number("no_return_clear_m")?,
        invalid_fraction_max: table.number("invalid_fraction_max")?,
        invalid_gap_max_rad: table.number("invalid_gap_max_deg")?.to_radians(),
        masks: masks.iter().map(mask).collect::<Result<_, _>>()?,
    })
}

fn mask(table: &TableReader<'_>) -> Result<Mask, RobotError> {
    Ok(Mask {
        x_min_m: table.number("x_min_m")?,
        x_max_m: table.number("x_max_m")?,
        y_min_m: table.number("y_min_m")?,
        y_max_m: table.number("y_max_m")?,
    })
}
