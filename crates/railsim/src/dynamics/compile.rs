//! A case, as written, becomes a [`Model`]: names turn into indices, points into levers, preloads are solved, wheel and
//! rail profiles into a geometry table. After this nobody looks at the document.

use std::sync::Arc;

use crate::body::{RigidBody, Wheelset};
use crate::connection::{ForceLaw, Mount};
use crate::contact::friction::FrictionField;
use crate::contact::geometry_table::{GeometryTable, PENETRATION, Pair, Placement};
use crate::contact::profile::{Profile, ProfileKind};
use crate::contact::search::Side;
use crate::dynamics::model::{Contact, Gap, Link, Model, Sensor, SpeedHold, Support};
use crate::dynamics::preload;
use crate::equipment::coupled::{Angled, ENDS, Faces};
use crate::equipment::train::Wagons;
use crate::equipment::{Bogie, Equipment};
use crate::error::{Error, Fault, KeyPath, Result};
use crate::math::{Vec3, rotation};
use crate::schema::drive::Drive;
use crate::schema::run::SimpleContact;
use crate::schema::track::TrackSupport;
use crate::schema::{Case, Connection, Track, Vehicle};
use crate::track::DeviationField;
use crate::track::{Layout, Segment};

/// Compiles a case.
///
/// # Errors
/// Faults in profiles, track or the vehicle's structure, each with its key path from the root of the case.
pub fn model(case: &Case) -> Result<Model> {
    let vehicle = &case.vehicle;
    let (bodies, wheelsets) = bodies(vehicle);
    round(vehicle)?;
    let links = links(case)?;
    let sensors = vehicle
        .sensors
        .iter()
        .map(|sensor| {
            let body = index(vehicle, &sensor.body, &sensor.key)?;
            let p_B = Vec3::from(sensor.position) - position(vehicle, body);
            Ok(Sensor { name: sensor.name.clone(), body, p_B })
        })
        .collect::<Result<Vec<_>>>()?;
    let speed_hold = match &vehicle.speed_hold {
        Some(hold) => Some(SpeedHold {
            body: index(vehicle, &hold.body, &KeyPath::of("vehicle.speed_hold.body"))?,
            stiffness: hold.stiffness,
            damping: hold.damping,
        }),
        None => None,
    };
    let track = &case.track;
    let layout = Layout::new(&track.layout, track.length, &KeyPath::of("track.layout"))?;
    let deviation = DeviationField::new(
        &track.irregularity,
        track.length,
        track.fade_start,
        track.fade_in,
        &KeyPath::of("track.irregularity"),
    )?;
    let contact = contact(case)?;
    let mut model = Model::new(
        bodies,
        wheelsets,
        links,
        sensors,
        speed_hold,
        layout,
        deviation,
        support(track),
        contact,
        case.run.gravity,
    );
    model.guided = guided(vehicle);
    model.gaps = gaps(vehicle)?;
    model.angled = angled(case, &model)?;
    model.equipment = equipment(case, &model)?.map(Box::new);
    Ok(model)
}

/// Traction, brakes and train, where the run has a driver.
fn equipment(case: &Case, model: &Model) -> Result<Option<Equipment>> {
    let Some(drive) = &case.run.drive else { return Ok(None) };
    let vehicle = &case.vehicle;
    equipment_needed(case, drive)?;
    let bogies = bogies(model)?;
    let parking = vehicle.parking_brake.as_ref().map(|brake| {
        let on = vehicle.wheelsets.iter().map(|w| brake.wheelsets.contains(&w.name)).collect();
        (brake.clone(), on)
    });
    Ok(Some(Equipment {
        drive: drive.clone(),
        bogies,
        traction: vehicle.traction.clone(),
        dynamic_brake: vehicle.dynamic_brake,
        air_brake: vehicle.air_brake.clone(),
        parking,
        train: case.run.train.clone().map(|written| Wagons::new(written, case.run.gravity)),
        faces: faces(case, model)?,
    }))
}

/// Pulling faces, on the body that the speed is held on, else on the heaviest.
fn faces(case: &Case, model: &Model) -> Result<Faces> {
    let body = match &model.speed_hold {
        Some(hold) => hold.body,
        None => model
            .car_body()
            .ok_or_else(|| Error::input(Fault::new(KeyPath::of("vehicle.body"), "none", "a car body")))?,
    };
    let places = ENDS.map(|end| {
        let face =
            case.vehicle.outline.as_ref().map_or(Vec3::zeros(), |o| {
                Vec3::new(0.5 * end * o.length_over_couplers, 0.0, -o.coupler_height)
            });
        face - model.bodies[body].position
    });
    Ok(Faces { body, places })
}

/// Couplers at an angle between the vehicle and its neighbours.
fn angled(case: &Case, model: &Model) -> Result<Option<Angled>> {
    let Some(written) = &case.run.couplers else { return Ok(None) };
    let at = KeyPath::of("run.couplers");
    let Some(outline) = &case.vehicle.outline else {
        let found = "it with a vehicle without [outline]";
        let allowed = "a vehicle with length_over_couplers and coupler_height in its [outline]";
        return Err(Error::input(Fault::new(at, found, allowed)));
    };
    let length = written.neighbour_length.unwrap_or(outline.length_over_couplers);
    let pivots = match written.neighbour_pivots {
        Some(pivots) => pivots,
        None => centres(model)?,
    };
    if !(pivots > 0.0 && pivots < length) {
        let allowed = format!("above 0 and below the neighbour's length of {length} m");
        return Err(Error::input(Fault::new(at.key("neighbour_pivots"), format!("{pivots} m"), allowed)));
    }
    let least = 0.5 * outline.length_over_couplers.min(length);
    if written.shank >= least {
        let allowed = format!("below half the length of either vehicle, {least} m");
        return Err(Error::input(Fault::new(at.key("shank"), format!("{} m", written.shank), allowed)));
    }
    room_ahead(case, model, 0.5 * (outline.length_over_couplers + length + pivots))?;
    let (faces, height) = (faces(case, model)?, outline.coupler_height);
    Ok(Some(Angled { written: written.clone(), faces, length, pivots, height }))
}

/// Distance of the bogie centres, m; of the outermost wheelsets, where there is one bogie or they hang on the car body.
fn centres(model: &Model) -> Result<f64> {
    let bogies = bogies(model)?;
    let span = |places: &mut dyn Iterator<Item = f64>| {
        let (rear, front) = places.fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)));
        front - rear
    };
    Ok(match bogies.len() {
        0 | 1 => span(&mut model.wheelsets.iter().map(|w| w.body.position.x)),
        _ => span(&mut bogies.iter().map(|b| model.bodies[b.body].position.x)),
    })
}

/// The neighbour in front, whose first bogie is `reach` m before the vehicle's middle, stands on the layout too: behind its end the track goes straight on.
fn room_ahead(case: &Case, model: &Model, reach: f64) -> Result<()> {
    let layout = &case.track.layout;
    let Some(Segment::Curve(_)) = layout.last() else { return Ok(()) };
    let first = model.wheelsets.iter().fold(0.0_f64, |front, w| front.max(w.body.position.x));
    let (sum, needed) = (layout.iter().map(Segment::length).sum::<f64>(), case.track.length - first + reach);
    if sum >= needed {
        return Ok(());
    }
    let found = format!("a layout that ends in a curve at {sum} m, with run.couplers");
    let allowed =
        format!("one of {} m or more: the neighbour in front is on it when the run ends", needed.ceil());
    Err(Error::input(Fault::new(KeyPath::of("track.layout"), found, allowed)))
}

/// What the driver asks for must be there.
fn equipment_needed(case: &Case, drive: &Drive) -> Result<()> {
    let vehicle = &case.vehicle;
    let at = KeyPath::of("run.drive");
    let needs = [
        ("notch", !drive.notch.is_idle(), vehicle.traction.is_some(), "traction"),
        ("dynamic_brake", !drive.dynamic_brake.is_idle(), vehicle.dynamic_brake.is_some(), "dynamic_brake"),
        ("dynamic_brake", !drive.dynamic_brake.is_idle(), vehicle.traction.is_some(), "traction"),
        (
            "brake_pipe_reduction",
            !drive.brake_pipe_reduction.is_idle(),
            vehicle.air_brake.is_some(),
            "air_brake",
        ),
        ("independent_brake", !drive.independent_brake.is_idle(), vehicle.air_brake.is_some(), "air_brake"),
        ("emergency", drive.emergency.is_some(), vehicle.air_brake.is_some(), "air_brake"),
        ("blending", drive.blending, vehicle.air_brake.is_some(), "air_brake"),
        ("parking_brake", drive.parking_brake, vehicle.parking_brake.is_some(), "parking_brake"),
    ];
    let mut faults: Vec<Fault> = needs
        .into_iter()
        .filter(|(_, asked, there, _)| *asked && !there)
        .map(|(key, _, _, table)| {
            Fault::new(at.key(key), format!("it with a vehicle without [{table}]"), "nothing of that vehicle")
        })
        .collect();
    if let Some(traction) = &vehicle.traction {
        let most = f64::from(traction.notches);
        for [_, notch] in drive.notch.steps() {
            if notch > most {
                faults.push(Fault::new(at.key("notch"), notch.to_string(), format!("0 to {most}")));
            }
        }
    }
    let wheelsets = vehicle.wheelsets.len();
    if !drive.observer.diameter_error.is_empty() && drive.observer.diameter_error.len() != wheelsets {
        faults.push(Fault::new(
            at.key("observer").key("diameter_error"),
            format!("{} numbers", drive.observer.diameter_error.len()),
            format!("one for each of the {wheelsets} wheelsets"),
        ));
    }
    if faults.is_empty() { Ok(()) } else { Err(Error::Input(faults)) }
}

/// Bogies: wheelsets by the body that most of their connections go to.
fn bogies(model: &Model) -> Result<Vec<Bogie>> {
    let first = model.bodies.len();
    let mut bogies: Vec<Bogie> = Vec::new();
    for w in 0..model.wheelsets.len() {
        let mut count = vec![0_usize; first];
        for link in &model.links {
            let ends = [link.a, link.b];
            if ends.contains(&(first + w)) {
                ends.into_iter().filter(|end| *end < first).for_each(|end| count[end] += 1);
            }
        }
        let body =
            (0..first).max_by_key(|b| (count[*b], first - b)).filter(|b| count[*b] > 0).ok_or_else(|| {
                Error::input(Fault::new(
                    KeyPath::of("vehicle.connection"),
                    format!("none between {} and a body", model.wheelsets[w].body.name),
                    "one, so that a motor's or a block's torque has something to react on",
                ))
            })?;
        match bogies.iter_mut().find(|b| b.body == body) {
            Some(bogie) => bogie.wheelsets.push(w),
            None => bogies.push(Bogie { body, name: model.bodies[body].name.clone(), wheelsets: vec![w] }),
        }
    }
    Ok(bogies)
}

fn gaps(vehicle: &Vehicle) -> Result<Vec<Gap>> {
    vehicle
        .gaps
        .iter()
        .map(|gap| {
            let [from, to] = gap.points.map(Vec3::from);
            let a = index(vehicle, &gap.between[0], &gap.key)?;
            let b = index(vehicle, &gap.between[1], &gap.key)?;
            Ok(Gap {
                name: gap.name.clone(),
                bodies: [a, b],
                points: [from - position(vehicle, a), to - position(vehicle, b)],
                direction: (to - from).normalize(),
            })
        })
        .collect()
}

/// Bodies that are led along the track, by index.
fn guided(vehicle: &Vehicle) -> Vec<usize> {
    vehicle.bodies.iter().enumerate().filter(|(_, b)| b.guided).map(|(i, _)| i).collect()
}

/// Geometry table of the case's wheel on its rail, without the rest of the model; out of [`Case::tables`] where it has been
/// built before.
///
/// # Errors
/// Faults in the profiles.
pub fn geometry_table(case: &Case) -> Result<Arc<GeometryTable>> {
    let placement = placement(case)?;
    let wheel = points(case, &case.run.wheel_profile)?.to_vec();
    let rail = points(case, &case.track.rail_profile)?.to_vec();
    let penetration = penetration(case, &placement);
    let pair = Pair { wheel, rail, placement, penetration };
    case.tables.get(pair, || {
        let (wheel, rail, placement) = contact_pair(case)?;
        GeometryTable::build_at(&wheel, &rail, &placement, penetration)
    })
}

/// Interpenetration over which the tables of a case average, m: that of its `vehicle.contact.averaging_load`, else of the static wheel load. To a
/// tenth of a micrometre, so that vehicles of almost the same weight share their tables. A vehicle without weight takes [`PENETRATION`].
fn penetration(case: &Case, placement: &Placement) -> f64 {
    let load = case.vehicle.contact.averaging_load.unwrap_or_else(|| wheel_load(case));
    if load > 0.0 { 1e-7 * (1e7 * placement.penetration_under(load)).round() } else { PENETRATION }
}

/// Static wheel load, the mean of all wheels, N.
fn wheel_load(case: &Case) -> f64 {
    case.vehicle.mass() * case.run.gravity / (2.0 * case.vehicle.wheelsets.len().max(1) as f64)
}

/// The same pair for direct search ([`Side`]).
///
/// # Errors
/// As [`geometry_table`].
pub fn side(case: &Case) -> Result<Side> {
    let (wheel, rail, placement) = contact_pair(case)?;
    Side::new(&wheel, &rail, &placement)
}

fn contact_pair(case: &Case) -> Result<(Profile, Profile, Placement)> {
    let placement = placement(case)?;
    let wheel = profile(case, &case.run.wheel_profile, ProfileKind::Wheel)?;
    let rail = profile(case, &case.track.rail_profile, ProfileKind::Rail)?;
    Ok((wheel, rail, placement))
}

fn placement(case: &Case) -> Result<Placement> {
    let radius = case.vehicle.wheelsets.first();
    let Some(set) = radius else {
        return Err(Error::input(Fault::new(
            KeyPath::of("vehicle.wheelset"),
            "none",
            "at least one wheelset",
        )));
    };
    if let Some(other) = case
        .vehicle
        .wheelsets
        .iter()
        .find(|w| w.radius != set.radius || w.tape_half_distance != set.tape_half_distance)
    {
        return Err(Error::input(Fault::new(
            other.key.clone(),
            format!("radius {} m, tape_half_distance {} m", other.radius, other.tape_half_distance),
            format!("the same as the first wheelset's, {} m and {} m", set.radius, set.tape_half_distance),
        )));
    }
    Ok(Placement {
        gauge: case.track.gauge,
        gauge_point_depth: case.track.gauge_point_depth,
        rail_inclination: case.track.rail_inclination,
        tape_half_distance: set.tape_half_distance,
        wheel_radius: set.radius,
        youngs_modulus: case.vehicle.contact.youngs_modulus,
        poisson: case.vehicle.contact.poisson,
    })
}

fn profile(case: &Case, name: &str, kind: ProfileKind) -> Result<Profile> {
    Profile::new(points(case, name)?, kind, &points_key(name))
}

fn points<'a>(case: &'a Case, name: &str) -> Result<&'a [[f64; 2]]> {
    match case.profiles.get(name) {
        Some(data) => Ok(&data.points),
        None => Err(Error::input(Fault::new(points_key(name), "nothing", "the points of the profile"))),
    }
}

fn points_key(name: &str) -> KeyPath {
    KeyPath::of("profiles").key(name).key("points")
}

fn contact(case: &Case) -> Result<Contact> {
    if let Some(SimpleContact::Textbook(book)) = &case.run.contact {
        return Ok(Contact::Textbook(*book));
    }
    let settings = &case.vehicle.contact;
    let wheel_load = wheel_load(case);
    Ok(Contact::Profiles {
        table: geometry_table(case)?,
        law: case.run.creep.with_poisson(settings.poisson),
        shear_modulus: settings.youngs_modulus / (2.0 * (1.0 + settings.poisson)),
        dissipation: if wheel_load > 0.0 { settings.damping / wheel_load } else { 0.0 },
        friction: FrictionField::new(&case.run.friction),
    })
}

fn support(track: &Track) -> Option<Support> {
    let TrackSupport::Lumped(s) = &track.support else { return None };
    let lever = s.half_base * s.half_base;
    Some(Support {
        mass: s.mass,
        inertia: s.Ixx,
        stiffness: [s.ky, s.kz, s.kz * lever],
        damping: [s.cy, s.cz, s.cz * lever],
    })
}

/// The equations of a wheelset hold for one that is round.
fn round(vehicle: &Vehicle) -> Result<()> {
    let faults: Vec<Fault> = vehicle
        .wheelsets
        .iter()
        .filter(|w| (w.inertia[0] - w.inertia[2]).abs() > 1e-6 * w.inertia[0])
        .map(|w| {
            Fault::new(
                w.key.key("inertia"),
                format!("Ixx = {}, Izz = {} kg m2", w.inertia[0], w.inertia[2]),
                "Ixx = Izz: a wheelset is round",
            )
        })
        .collect();
    if faults.is_empty() { Ok(()) } else { Err(Error::Input(faults)) }
}

fn bodies(vehicle: &Vehicle) -> (Vec<RigidBody>, Vec<Wheelset>) {
    let bodies = vehicle
        .bodies
        .iter()
        .map(|b| RigidBody {
            name: b.name.clone(),
            mass: b.mass,
            inertia: Vec3::from(b.inertia),
            position: Vec3::from(b.position),
        })
        .collect();
    let wheelsets = vehicle
        .wheelsets
        .iter()
        .map(|w| Wheelset {
            body: RigidBody {
                name: w.name.clone(),
                mass: w.mass,
                inertia: Vec3::from(w.inertia),
                position: Vec3::from(w.position),
            },
            radius: w.radius,
            tape_half_distance: w.tape_half_distance,
        })
        .collect();
    (bodies, wheelsets)
}

/// Connections with preloads solved for the design condition, in which the vehicle stands at its written heights. Masses,
/// centres of mass and levers of that condition make the preloads; the levers of the case's own condition make the links.
fn links(case: &Case) -> Result<Vec<Link>> {
    let mut design = mounts(&case.design)?;
    let connections = &case.design.connections;
    let carries: Vec<bool> = connections.iter().map(|c| c.preload).collect();
    let (bodies, wheelsets) = bodies(&case.design);
    let key = |i: usize| connections[i].key.clone();
    let fixed = guided(&case.design);
    preload::solve(&bodies, &wheelsets, &mut design, &carries, &fixed, case.run.gravity, key)?;
    let mut links = mounts(&case.vehicle)?;
    for ((link, from), _) in links.iter_mut().zip(&design).zip(&carries).filter(|(_, c)| **c) {
        link.mount.preload = from.mount.preload;
        link.mount.stretched = from.mount.stretched;
    }
    Ok(links)
}

/// Connections between indices, with levers from the centres of mass; what carries the vehicle is not preloaded yet.
fn mounts(vehicle: &Vehicle) -> Result<Vec<Link>> {
    vehicle.connections.iter().map(|connection| mount(vehicle, connection)).collect()
}

fn mount(vehicle: &Vehicle, connection: &Connection) -> Result<Link> {
    let at = connection.key.key("between");
    let a = index(vehicle, &connection.between[0], &at.index(0))?;
    let b = index(vehicle, &connection.between[1], &at.index(1))?;
    let axes = connection.axes.map(|[roll, pitch, yaw]| {
        Box::new(rotation::rot_z(yaw) * rotation::rot_x(roll) * rotation::rot_y(pitch))
    });
    let own = |v: Vec3| axes.as_ref().map_or(v, |R| R.tr_mul(&v));
    let [p, q] = connection.points.map(Vec3::from);
    let mount = Mount::new(own(p - position(vehicle, a)), own(q - position(vehicle, b)), own(q - p));
    check_ends(vehicle, connection, [a, b], &mount)?;
    let law = connection.law.clone();
    let memory = 0..law.memory();
    let mut link = Link { name: connection.name.clone(), a, b, mount, law, axes, memory };
    if !connection.preload {
        let force = connection.force.map(Vec3::from);
        link.law.settle(&mut link.mount, force.as_ref()).map_err(|found| {
            let key = connection.key.key(if force.is_some() { "preload" } else { "kind" });
            Error::input(Fault::new(key, found, "a preload that this kind carries, or none"))
        })?;
    }
    Ok(link)
}

/// Farthest that a connection on a wheelset may be off the axle, m.
const OFF_THE_AXLE: f64 = 1e-3;

/// What a law asks of its two ends, and an axle box of what hangs on it.
fn check_ends(vehicle: &Vehicle, connection: &Connection, ends: [usize; 2], mount: &Mount) -> Result<()> {
    let refuse = |key: &str, found: String, allowed: String| {
        Err(Error::input(Fault::new(connection.key.key(key), found, allowed)))
    };
    if let Err((found, allowed)) = connection.law.check_ends(&mount.between) {
        return refuse(if mount.between.norm() > 0.0 { "positions" } else { "position" }, found, allowed);
    }
    if connection.preload && connection.law.nominal_stiffness(&mount.between).amax() == 0.0 {
        return refuse(
            "carries_weight",
            format!("true, of a `{}` without stiffness", connection.law.kind()),
            "false: this connection carries nothing at rest".into(),
        );
    }
    for (end, point) in ends.into_iter().zip(&connection.points) {
        let lever = Vec3::from(*point) - position(vehicle, end);
        if end >= vehicle.bodies.len() && lever.x.hypot(lever.z) > OFF_THE_AXLE {
            return refuse(
                "position",
                format!("a point {:.3} m off the axle of a wheelset", lever.x.hypot(lever.z)),
                "a point on the axle: axle boxes are no bodies, nothing would hold their pitch".into(),
            );
        }
    }
    Ok(())
}

fn index(vehicle: &Vehicle, name: &str, at: &KeyPath) -> Result<usize> {
    let names = vehicle.bodies.iter().map(|b| &b.name).chain(vehicle.wheelsets.iter().map(|w| &w.name));
    names.into_iter().position(|n| n == name).ok_or_else(|| {
        Error::input(Fault::new(at.clone(), format!("`{name}`"), "the name of a body or wheelset"))
    })
}

fn position(vehicle: &Vehicle, index: usize) -> Vec3 {
    Vec3::from(match vehicle.bodies.get(index) {
        Some(body) => body.position,
        None => vehicle.wheelsets[index - vehicle.bodies.len()].position,
    })
}
