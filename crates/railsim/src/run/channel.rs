//! Channels: what a run records, with unit and meaning. The unit follows from the last part of a name.

use crate::body::coordinate;
use crate::dynamics::{Contact, Model};
use crate::equipment::Quantity;
use crate::error::Result;
use crate::schema::Case;

/// A recorded quantity.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Channel {
    /// Dotted name, e.g. `ws3.left.Q`.
    pub name: String,
    /// SI unit; `1` for a ratio.
    pub unit: &'static str,
    /// One line for a person.
    pub meaning: &'static str,
}

/// Last part of a name, unit, meaning. Sorted by name.
const PARTS: [(&str, &str, &str); 73] = [
    ("Fx", "N", "longitudinal creep force on the wheel, + forward"),
    ("LV", "1", "lateral over vertical wheel force, Y/Q"),
    ("N_flange", "N", "normal force on the flange, all contacts there"),
    ("N_second_flange", "N", "normal force of the contact nearer to the flange tip, of two on the flange"),
    ("N_second_tread", "N", "normal force of the contact nearer to the flange, of two on the tread"),
    ("N_tread", "N", "normal force on the tread, all contacts there"),
    ("Q", "N", "vertical wheel force, + presses on the rail"),
    ("Y", "N", "lateral wheel force on the rail, + outward"),
    ("adhesion", "1", "longitudinal creep force over the load of the same wheels, + forward"),
    ("ax", "m/s2", "acceleration along the body's x axis, without gravity"),
    ("ay", "m/s2", "acceleration along the body's y axis (right), without gravity"),
    ("az", "m/s2", "acceleration along the body's z axis (down), without gravity"),
    ("block_force", "N", "force of all brake blocks of a wheelset by the air brake"),
    ("branch", "1", "number of the root locus that a mode belongs to"),
    ("cant", "rad", "cant under the vehicle's centre, + right rail lower"),
    ("clearance", "m", "what is left between the two points of a gap, negative where they have met"),
    ("contact_y", "m", "lateral place of the main contact on the wheel profile, + to the field side"),
    ("creep_x", "1", "longitudinal creepage of the main contact"),
    ("creep_y", "1", "lateral creepage of the main contact, + outward"),
    ("critical_speed", "m/s", "speed above which the vehicle hunts, as found"),
    ("critical_speed_up", "m/s", "speed at which it begins to hunt when it is stepped up"),
    ("cross_level", "m", "irregularity: height of the left rail above the right over 1.5 m"),
    ("curvature", "1/m", "curvature under the vehicle's centre, + to the right"),
    ("cylinder", "Pa", "pressure in the brake cylinders, gauge"),
    ("damping_ratio", "1", "share of critical damping, negative where the motion grows"),
    ("direction", "1", "-1 while the speed is stepped down, +1 up"),
    ("drawbar", "N", "force in a coupling, + pull"),
    ("effort", "N", "force at the rims by motors or blocks, + forward"),
    ("flange_angle", "rad", "steepest angle of the wheel profile's flange face against the axle"),
    ("force_x", "N", "load on the body, + forward"),
    ("force_y", "N", "load on the body, + right"),
    ("force_z", "N", "load on the body, + down"),
    ("frequency", "Hz", "frequency of the damped motion"),
    ("gauge", "m", "irregularity: widening of the gauge"),
    ("gradient", "rad", "gradient under the vehicle's centre, + uphill"),
    ("imag", "rad/s", "imaginary part of the eigenvalue"),
    ("lateral", "m", "irregularity: lateral deviation of the centre line, + right"),
    ("mode", "1", "number of the mode at its speed, by frequency"),
    ("natural_frequency", "Hz", "size of the eigenvalue over 2 pi"),
    ("notch", "1", "notch of the traction controller"),
    ("phi", "rad", "roll against the track frame"),
    ("pipe", "Pa", "pressure in the brake pipe, gauge"),
    ("pitch", "rad", "coupler against the car body, up and down, + where it leads up"),
    ("psi", "rad", "yaw against the track frame, + nose right"),
    ("reaction", "N", "force that holds the displaced coordinate where it is"),
    ("reaction_moment", "N m", "moment that holds the displaced coordinate where it is"),
    ("real", "1/s", "real part of the eigenvalue, positive where the motion grows"),
    ("reservoir", "Pa", "pressure in the auxiliary reservoir, gauge"),
    ("s", "m", "place of the vehicle along the track"),
    ("sanding", "1", "what sand makes of the coefficient of friction, a factor; 1 without"),
    ("shift", "m", "outward lateral shift of the wheel on its rail"),
    (
        "slip",
        "1",
        "slip of the axle: rim speed at the nominal radius less the vehicle's, over it (over 1 m/s at least)",
    ),
    ("speed_hold", "N", "force of the speed controller, + forward"),
    ("spin", "1/m", "spin creepage of the main contact"),
    ("step", "1", "load step"),
    ("sum_LV", "1", "axle-sum L/V: |Y/Q| left plus |Y/Q| right"),
    ("sum_Y", "N", "track-shifting force of the axle, Y right minus Y left, + right"),
    ("swing", "m", "lateral motion of the axle, peak to peak within the window"),
    ("t", "s", "time"),
    ("temperature", "1", "temperature rise of the motors over what their continuous rating gives"),
    ("theta", "rad", "pitch against the track frame, + nose up"),
    ("torque", "N m", "motor torque on the axle, + forward"),
    ("track_phi", "rad", "roll of the track mass"),
    ("track_y", "m", "lateral displacement of the track mass, + right"),
    ("track_z", "m", "vertical displacement of the track mass, + down"),
    (
        "unbalanced",
        "m/s2",
        "lateral acceleration in the plane of the rails that cant does not balance, + outward in a right-hand curve",
    ),
    ("v", "m/s", "speed of the vehicle along the track"),
    ("vertical", "m", "irregularity: vertical deviation of the centre line, + down"),
    ("x", "m", "place along the track relative to the vehicle's place"),
    ("y", "m", "lateral displacement from the track centre line, + right"),
    ("yaw", "rad", "coupler against the car body, sideways, + where it leads to the vehicle's right"),
    (
        "yaw_moment",
        "N m",
        "moment of the car body on a bogie frame about the frame's vertical axis, + nose right",
    ),
    ("z", "m", "height: depth below the top of rail, negative above"),
];

/// Last part of every name that a channel may have, with unit and meaning, sorted.
#[must_use]
pub fn parts() -> &'static [(&'static str, &'static str, &'static str)] {
    &PARTS
}

/// Unit and meaning that go with the last part of a channel name.
#[must_use]
pub fn describe(name: &str) -> Option<(&'static str, &'static str)> {
    let last = name.rsplit('.').next()?;
    PARTS.binary_search_by(|p| p.0.cmp(last)).ok().map(|i| (PARTS[i].1, PARTS[i].2))
}

/// Where a channel's number comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Source {
    Time,
    Place,
    Speed,
    HoldForce,
    Coordinate(usize, usize),
    TrackMass(usize, usize),
    Irregularity(usize),
    SensorPlace(usize, usize),
    SensorAcceleration(usize, usize),
    Gap(usize),
    /// On a bogie frame, by the car body.
    YawMoment(usize, usize),
    Wheel(usize, usize, WheelQuantity),
    SumLV(usize),
    SumY(usize),
    /// Front (0) or rear (1), sideways (0) or up and down (1).
    CouplerAngle(usize, usize),
    Equipment(Quantity),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum WheelQuantity {
    Q,
    Y,
    LV,
    Shift,
    NTread,
    NFlange,
    NSecondTread,
    NSecondFlange,
    CreepX,
    CreepY,
    Spin,
    ContactY,
}

/// Every channel of a model with its source, in the order of the columns.
pub(crate) fn plan(model: &Model) -> Vec<(String, Source)> {
    use WheelQuantity as W;
    let mut plan = vec![
        ("t".to_owned(), Source::Time),
        ("s".to_owned(), Source::Place),
        ("v".to_owned(), Source::Speed),
    ];
    if model.speed_hold.is_some() && model.equipment.as_ref().is_none_or(|e| e.drive.hold_speed) {
        plan.push(("speed_hold".to_owned(), Source::HoldForce));
    }
    let motions = [
        ("y", coordinate::Y),
        ("z", coordinate::Z),
        ("phi", coordinate::PHI),
        ("theta", coordinate::THETA),
        ("psi", coordinate::PSI),
    ];
    for i in 0..model.count() {
        for (part, index) in motions {
            // The turned angle of a wheelset grows for ever and tells nothing.
            if i < model.bodies.len() || index != coordinate::THETA {
                plan.push((format!("{}.{part}", model.rigid(i).name), Source::Coordinate(i, index)));
            }
        }
    }
    for (i, sensor) in model.sensors.iter().enumerate() {
        for (axis, part) in ["y", "z"].into_iter().enumerate() {
            plan.push((format!("{}.{part}", sensor.name), Source::SensorPlace(i, axis + 1)));
        }
        for (axis, part) in ["ax", "ay", "az"].into_iter().enumerate() {
            plan.push((format!("{}.{part}", sensor.name), Source::SensorAcceleration(i, axis)));
        }
    }
    for (i, gap) in model.gaps.iter().enumerate() {
        plan.push((format!("{}.clearance", gap.name), Source::Gap(i)));
    }
    if let Some(car) = model.car_body() {
        let bogies = (0..model.bodies.len()).filter(|i| *i != car && model.carried_by_axles(*i));
        for bogie in bogies.filter(|i| model.links.iter().any(|link| link.joins(*i, car))) {
            plan.push((format!("{}.yaw_moment", model.rigid(bogie).name), Source::YawMoment(bogie, car)));
        }
    }
    if !model.wheelsets.is_empty() {
        for (i, part) in ["lateral", "vertical", "cross_level", "gauge"].into_iter().enumerate() {
            plan.push((format!("track.{part}"), Source::Irregularity(i)));
        }
    }
    let of_profiles = match &model.contact {
        Contact::Profiles { table, .. } => {
            let mut of_profiles =
                vec![("N_tread", W::NTread), ("N_flange", W::NFlange), ("contact_y", W::ContactY)];
            let seconds = [("N_second_tread", W::NSecondTread), ("N_second_flange", W::NSecondFlange)];
            of_profiles
                .extend(seconds.iter().zip(table.seconds()).filter(|(_, is)| *is).map(|(second, _)| *second));
            of_profiles
        }
        Contact::Textbook(_) => Vec::new(),
    };
    for (w, set) in model.wheelsets.iter().enumerate() {
        let name = &set.body.name;
        if model.support.is_some() {
            for (d, part) in ["track_y", "track_z", "track_phi"].into_iter().enumerate() {
                plan.push((format!("{name}.{part}"), Source::TrackMass(w, d)));
            }
        }
        plan.push((format!("{name}.sum_LV"), Source::SumLV(w)));
        plan.push((format!("{name}.sum_Y"), Source::SumY(w)));
        for (side, label) in ["left", "right"].into_iter().enumerate() {
            let common = [
                ("Q", W::Q),
                ("Y", W::Y),
                ("LV", W::LV),
                ("shift", W::Shift),
                ("creep_x", W::CreepX),
                ("creep_y", W::CreepY),
                ("spin", W::Spin),
            ];
            for (part, quantity) in common.iter().chain(&of_profiles) {
                plan.push((format!("{name}.{label}.{part}"), Source::Wheel(w, side, *quantity)));
            }
        }
    }
    if model.angled.is_some() {
        for (end, name) in ["front", "rear"].into_iter().enumerate() {
            for (plane, part) in ["yaw", "pitch"].into_iter().enumerate() {
                plan.push((format!("coupler.{name}.{part}"), Source::CouplerAngle(end, plane)));
            }
        }
    }
    if let Some(equipment) = &model.equipment {
        let own = equipment.plan(model).into_iter();
        plan.extend(own.map(|(name, quantity)| (name, Source::Equipment(quantity))));
    }
    plan
}

/// The channels of a case.
///
/// # Errors
/// Whatever compiling the case finds.
pub fn channels(case: &Case) -> Result<Vec<Channel>> {
    let model = crate::dynamics::compile::model(case)?;
    crate::dynamics::coordinate::disturbance(&model, &case.run.disturbance)?;
    Ok(plan(&model)
        .into_iter()
        .map(|(name, _)| {
            let (unit, meaning) = describe(&name).unwrap_or(("1", ""));
            Channel { name, unit, meaning }
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_sorted_so_that_the_search_finds_each() {
        for (name, unit, _) in PARTS {
            assert_eq!(describe(&format!("a.b.{name}")).map(|d| d.0), Some(unit), "{name}");
        }
    }
}
