//! Bad input beside its exact message: each row damages the good vehicle or case of `fixtures/` in one place.

use railsim::schema::{self, Case, Vehicle, line_of, toml_to_json};
use railsim::{Error, KeyPath};
use serde_json::{Value, json};

const TROLLEY: &str = include_str!("fixtures/trolley.toml");

fn faults<T>(result: railsim::Result<T>) -> Vec<railsim::Fault> {
    match result {
        Err(Error::Input(faults)) => faults,
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("accepted"),
    }
}

/// `line: message` of each fault, as a person sees it. Lines are those of the vehicle file.
fn said(text: &str, condition: Option<&str>) -> Vec<String> {
    let document = toml_to_json(text).unwrap();
    faults(Vehicle::resolve(&document, condition))
        .iter()
        .map(|fault| {
            let in_file = KeyPath(fault.key.0[1..].to_vec());
            let line = line_of(text, &in_file).map_or("?".to_owned(), |l| l.to_string());
            format!("{line}: {fault}")
        })
        .collect()
}

/// (what stands in trolley.toml, what is written instead, the one message)
const VEHICLES: &[(&str, &str, &str)] = &[
    // Keys.
    (
        "damping = 1e5",
        "dampign = 1e5",
        "68: vehicle.contact.dampign: found an unknown key; allowed: averaging_load, damping, poisson, \
         youngs_modulus (did you mean damping?)",
    ),
    ("wheel_profile = \"round\"", "", "?: vehicle.wheel_profile: found nothing; allowed: a text"),
    (
        "carries_weight = true",
        "carries_wieght = true",
        "56: vehicle.template.axle.connection[0].carries_wieght: found an unknown key; allowed: \
         axes, between, carries_weight, damping, kind, mirror, name, position, positions, preload, \
         rotational_damping, rotational_stiffness, stiffness (did you mean carries_weight?)",
    ),
    (
        "[[template.axle.sensor]]",
        "[[template.axle.sensors]]",
        "60: vehicle.template.axle.sensors: found an unknown key; allowed: body, connection, gap, \
         sensor, wheelset, use (did you mean sensor?)",
    ),
    (
        "[contact]\n",
        "[[gap]]\nname = \"side\"\nbetween = [\"frame\", \"frame\"]\npositions = [[0.0, 1.0, 0.0], [0.0, 1.1, 0.0]]\n\n[contact]\n",
        "67: vehicle.gap[0].between: found frame and frame; allowed: two different bodies",
    ),
    (
        "[contact]\n",
        "[[gap]]\nname = \"side\"\nbetween = [\"frame\", \"ws1\"]\npositions = [[0.0, 1.0, 0.0], [0.0, 1.0, 0.0]]\n\n[contact]\n",
        "68: vehicle.gap[0].positions: found the same point twice; allowed: two points apart: their distance is the clearance",
    ),
    (
        "[contact]\n",
        "[[gap]]\nname = \"side\"\nbetween = [\"frame\", \"ws1\"]\npositions = [[0.0, -1.0, 0.0], [0.0, -1.1, 0.0]]\nmirror = true\n\n[contact]\n",
        "68: vehicle.gap[0].positions: found mirror = true with y = -1; allowed: y > 0 m: the right one, from which the left one is made",
    ),
    // Types and ranges.
    (
        "design_speed_kmh = 36.0",
        "design_speed_kmh = \"fast\"",
        "4: vehicle.design_speed_kmh: found \"fast\"; allowed: a number > 0 km/h",
    ),
    (
        "inertia = [50.0, 60.0, 70.0]",
        "inertia = [50.0, 60.0]",
        "29: vehicle.body[0].inertia: found a list of 2; allowed: a list of 3, each a number > 0 kg \
         m2",
    ),
    (
        "inertia = [50.0, 60.0, 70.0]",
        "inertia = [50.0, 0.0, 70.0]",
        "29: vehicle.body[0].inertia[1]: found 0.0; allowed: a number > 0 kg m2",
    ),
    (
        "mass = 1000.0",
        "mass = -1000.0",
        "28: vehicle.body[0].mass: found -1000.0 (from $frame.mass); allowed: a number > 0 kg",
    ),
    (
        "stiffness = [\"$spring.k\", \"$spring.k\", \"$spring.k\"]",
        "stiffness = [\"-$spring.k\", \"$spring.k\", \"$spring.k\"]",
        "57: vehicle.template.axle.connection[0].stiffness[0]: found -1000000.0 (from -$spring.k); \
         allowed: a finite number >= 0 N/m",
    ),
    (
        "stiffness = [\"$spring.k\", \"$spring.k\", \"$spring.k\"]",
        "stiffness = [1, 2]",
        "57: vehicle.template.axle.connection[0].stiffness: found a list of 2; allowed: a list of 3, \
         each a number",
    ),
    (
        "poisson = 0.28",
        "poisson = 0.5",
        "67: vehicle.contact.poisson: found 0.5; allowed: a number >= 0 and < 0.5",
    ),
    // Names.
    (
        "kind = \"bushing\"",
        "kind = \"bushin\"",
        "52: vehicle.template.axle.connection[0].kind: found \"bushin\"; allowed: \"anti_roll_bar\", \
         \"bump_stop\", \"bushing\", \"bushing_matrix\", \"coupler\", \"friction\", \"friction_plate\", \
         \"maxwell\", \"point_damper\", \"point_spring\", \"shear_spring\", \"traction_rod\" \
         (did you mean bushing?)",
    ),
    (
        "between = [\"{axle}\", \"frame\"]",
        "between = [\"{axle}\", \"fram\"]",
        "53: vehicle.template.axle.connection[0].between[1]: found \"fram\"; allowed: a body or \
         wheelset: frame, ws1, ws2 (did you mean frame?)",
    ),
    (
        "body = \"frame\"",
        "body = \"farme\"",
        "62: vehicle.template.axle.sensor[0].body: found \"farme\"; allowed: a body or wheelset: \
         frame, ws1, ws2 (did you mean frame?)",
    ),
    (
        "with = { axle = \"ws2\" }",
        "with = { axle = \"frame\" }",
        "43: vehicle.template.axle.wheelset[0].name: found \"frame\", the name of vehicle.body[0] \
         too; allowed: each name once\n\
         53: vehicle.template.axle.connection[0].between: found frame and frame; allowed: two \
         different bodies",
    ),
    (
        "name = \"frame\"",
        "name = \"frame.1\"",
        "27: vehicle.body[0].name: found \"frame.1\"; allowed: a letter, then letters, digits and _\n\
         53: vehicle.template.axle.connection[0].between[1]: found \"frame\"; allowed: a body or \
         wheelset: frame.1, ws1, ws2 (did you mean frame.1?)\n\
         62: vehicle.template.axle.sensor[0].body: found \"frame\"; allowed: a body or wheelset: \
         frame.1, ws1, ws2 (did you mean frame.1?)",
    ),
    // Parameters and conditions.
    (
        "mass = \"$frame.mass\"",
        "mass = \"$frame.mas\"",
        "28: vehicle.body[0].mass: found the unknown name frame.mas; allowed: a named parameter: \
         frame.height, frame.mass (did you mean frame.mass?)",
    ),
    (
        "\"frame.mass\" = 600.0",
        "\"frame.weight\" = 600.0",
        "24: vehicle.condition.empty.frame.weight: found the unknown name frame.weight; allowed: a \
         named parameter: frame.height, frame.mass (did you mean frame.height?)",
    ),
    (
        "[parameters.frame]\nmass = 1000.0",
        "[parameters.frame]\nmass = \"heavy\"",
        "9: vehicle.parameters.frame.mass: found \"heavy\"; allowed: a number, or a reference as \
         \"$group.key\" or \"-$group.key\"",
    ),
    (
        "k = 1e6\nc = 2e3",
        "k = \"$spring.c\"\nc = \"-$spring.k\"",
        "19: vehicle.parameters.spring.c: found \"-$spring.k\", which comes back to itself; allowed: \
         references that end at a number\n\
         18: vehicle.parameters.spring.k: found \"$spring.c\", which comes back to itself; allowed: \
         references that end at a number",
    ),
    (
        "[condition.laden]",
        "[parameters.run]\nspeed = 3.0\n\n[condition.laden]",
        "21: vehicle.parameters.run: found the group name run; allowed: any name but condition, run, \
         test, track, vehicle (on the command line these are keys of the spec)",
    ),
    (
        "design_condition = \"laden\"",
        "design_condition = \"loaded\"",
        "6: vehicle.design_condition: found \"loaded\"; allowed: a [condition] of the vehicle: \
         empty, laden (did you mean laden?)",
    ),
    // Templates.
    (
        "template = \"axle\"\nat = [\"$axle.x\"",
        "template = \"axel\"\nat = [\"$axle.x\"",
        "33: vehicle.use[0].template: found \"axel\"; allowed: the name of a [template]: axle (did you \
             mean axle?)",
    ),
    (
        "with = { axle = \"ws1\" }",
        "with = { axel = \"ws1\" }",
        "35: vehicle.use[0].with.axel: found an unknown key; allowed: axle (did you mean axle?)",
    ),
    (
        "[contact]",
        "[[template.axle.use]]\ntemplate = \"axle\"\nwith = { axle = \"{axle}_inner\" }\n\n[contact]",
        "66: vehicle.template.axle.use[0].template: found a template that uses itself: axle -> axle; \
         allowed: no such ring",
    ),
    (
        "name = \"frame\"",
        "name = \"{frame}\"",
        "27: vehicle.body[0].name: found the placeholder {frame}; allowed: placeholders in templates \
         only",
    ),
    (
        "position = [0.0, 1.0, \"-$axle.radius\"]",
        "position = [0.0, -1.0, \"-$axle.radius\"]",
        "54: vehicle.template.axle.connection[0].position: found mirror = true with y = -1; allowed: \
         y > 0 m: the right one, from which the left one is made",
    ),
    (
        "at = [\"$axle.x\", 0.0, 0.0]",
        "at = [\"$axle.x\", 0.0, 0.1]",
        "42: vehicle.template.axle.wheelset[0]: found a shift of 0.1 m in z by use; allowed: 0 m: a \
         wheelset stands on the rail",
    ),
    // A template that nobody uses is read all the same.
    (
        "[contact]",
        "[[template.spare.body]]\nname = \"{spare}\"\nmas = 1.0\ninertia = [1.0, 1.0, 1.0]\n\
         position = [0.0, 0.0, 0.0]\n\n[contact]",
        "67: vehicle.template.spare.body[0].mas: found an unknown key; allowed: guided, inertia, mass, name, \
         position (did you mean mass?)",
    ),
];

#[test]
fn every_damage_to_a_vehicle_has_its_message() {
    assert!(Vehicle::resolve(&toml_to_json(TROLLEY).unwrap(), None).is_ok());
    let mut wrong = Vec::new();
    for (written, instead, message) in VEHICLES {
        assert!(TROLLEY.contains(written), "{written}");
        let said = said(&TROLLEY.replacen(written, instead, 1), None).join("\n");
        if said != *message {
            wrong.push(format!("{instead}\n  said:     {said}\n  expected: {message}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn all_faults_are_said_at_once_and_each_once() {
    let text = TROLLEY
        .replace("mass = 200.0", "mass = 0")
        .replace("poisson = 0.28", "poisson = true")
        .replace("title = ", "titel = ")
        .replace("kind = \"bushing\"", "kind = \"spring\"");
    assert_eq!(
        said(&text, Some("empty")),
        [
            "52: vehicle.template.axle.connection[0].kind: found \"spring\"; allowed: \"anti_roll_bar\", \
             \"bump_stop\", \"bushing\", \"bushing_matrix\", \"coupler\", \"friction\", \"friction_plate\", \
             \"maxwell\", \"point_damper\", \"point_spring\", \"shear_spring\", \"traction_rod\" \
             (did you mean point_spring?)",
            "67: vehicle.contact.poisson: found true; allowed: a number >= 0 and < 0.5",
            "3: vehicle.titel: found an unknown key; allowed: air_brake, body, condition, connection, contact, \
             design_condition, design_speed_kmh, dynamic_brake, equipment, gap, include, load_case, name, outline, \
             parameters, parking_brake, sensor, shape, speed_hold, template, title, track, traction, use, wheel_profile, wheelset (did you mean title?)",
            "44: vehicle.template.axle.wheelset[0].mass: found 0 (from $axle.mass); allowed: a number > 0 kg",
        ]
    );
}

#[test]
fn a_condition_that_does_not_exist_is_refused_at_the_case_key() {
    let document = toml_to_json(TROLLEY).unwrap();
    let said = faults(Vehicle::resolve(&document, Some("emtpy")));
    assert_eq!(
        said[0].to_string(),
        "condition: found \"emtpy\"; allowed: a [condition] of the vehicle: empty, laden (did you mean empty?)"
    );
}

fn overridden(name: &str, value: Value, condition: Option<&str>) -> Vec<String> {
    let document = toml_to_json(TROLLEY).unwrap();
    let overrides = serde_json::Map::from_iter([(name.to_owned(), value)]);
    faults(schema::resolve_summary(&document, &overrides, condition))
        .iter()
        .map(ToString::to_string)
        .collect()
}

#[test]
fn an_override_of_what_is_no_parameter_is_refused_with_the_nearest_name() {
    assert_eq!(
        overridden("sprign.k", json!(1.0), None),
        [
            "set.sprign.k: found the unknown name sprign.k; allowed: a named parameter, in axle, frame, spring \
          (did you mean spring.k?)"
        ]
    );
    assert_eq!(
        overridden("spring.k", json!("stiff"), None),
        [
            "set.spring.k: found \"stiff\"; allowed: a number, or a reference as \"$group.key\" or \"-$group.key\""
        ]
    );
}

#[test]
fn an_override_that_the_condition_would_hide_is_refused() {
    assert_eq!(
        overridden("frame.mass", json!(1.0), Some("empty")),
        [
            "set.frame.mass: found a parameter that condition empty gives its own value; allowed: a parameter that the \
          condition leaves alone (let the condition refer to a parameter of its own and set that one)"
        ]
    );
}

fn case() -> Value {
    let points: Vec<[f64; 2]> = (0..9).map(|i| [f64::from(i) - 4.0, 0.01 * f64::from(i)]).collect();
    json!({
        "format": 1,
        "label": "round",
        "condition": "empty",
        "vehicle": toml_to_json(TROLLEY).unwrap(),
        "track": {
            "length": 100.0, "gauge": 1.435, "gauge_point_depth": 0.014, "rail_inclination": 0.05,
            "rail_profile": "head",
            "support": { "mass": 600.0, "Ixx": 340.0, "ky": 4e7, "kz": 1.5e8, "cy": 1e5, "cz": 2e5, "half_base": 0.75 },
        },
        "run": {
            "kind": "time", "speed": 10.0, "friction": 0.4,
            "integrator": { "kind": "heun", "step": 0.00025 }, "output_step": 0.005,
        },
        "profiles": {
            "round": { "kind": "wheel", "points": points },
            "head": { "kind": "rail", "points": points },
        },
    })
}

/// (pointer, value put there, messages)
fn cases() -> Vec<(&'static str, Value, &'static str)> {
    vec![
        ("/run/speed", json!(0), "run.speed: found 0; allowed: a number > 0 m/s, or 0 with run.drive"),
        (
            "/run/speed",
            json!(216),
            "run.speed: found 216 m/s; allowed: at most 200 m/s, which is 720 km/h (216 km/h is 60 m/s)",
        ),
        (
            "/run/friction",
            json!(1.6),
            "run.friction: found 1.6; allowed: a number > 0 and <= 1.5, or a table",
        ),
        (
            "/run/output_step",
            json!(0.0001),
            "run.output_step: found 0.0001; allowed: a whole multiple of run.integrator.step = 0.00025 s",
        ),
        (
            "/run/output_step",
            json!(0.0006),
            "run.output_step: found 0.0006; allowed: a whole multiple of run.integrator.step = 0.00025 s",
        ),
        (
            "/run/integrator/kind",
            json!("huen"),
            "run.integrator.kind: found \"huen\"; allowed: \"heun\", \"heun_controlled\", \"rk4\", \"ros2\" (did you mean \
         heun?)",
        ),
        (
            "/run/integrator",
            json!("heun"),
            "run.integrator: found \"heun\"; allowed: a table with kind = \"heun\", \"heun_controlled\", \"rk4\", \"ros2\"",
        ),
        (
            "/run/integrator",
            json!({ "kind": "heun", "stp": 0.001 }),
            "run.integrator.stp: found an unknown key; allowed: kind, step (did you mean step?)",
        ),
        (
            "/run/integrator/step",
            json!(0),
            "run.integrator.step: found 0 s; allowed: above 0, at most 0.05 s",
        ),
        (
            "/run/kind",
            json!("tiem"),
            "run.kind: found \"tiem\"; allowed: \"time\", \"equilibrium\", \"quasi_static\", \"modal\", \"critical_speed\", \"air_brake\", \"lint\" (did you mean time?)",
        ),
        ("/track/length", json!(-1.5), "track.length: found -1.5; allowed: a number > 0 and <= 1000000.0 m"),
        (
            "/track/rail_profile",
            json!("hed"),
            "track.rail_profile: found \"hed\"; allowed: a profile in profiles: head, round (did you \
         mean head?)",
        ),
        (
            "/track/rail_profile",
            json!("round"),
            "track.rail_profile: found \"round\", a wheel profile; allowed: a rail profile",
        ),
        (
            "/vehicle/wheel_profile",
            json!("square"),
            "vehicle.wheel_profile: found \"square\"; allowed: a profile in profiles: head, round",
        ),
        (
            "/profiles/head/points",
            json!([[0, 0], [1, 0]]),
            "profiles.head.points: found 2 points; allowed: 8 points or more",
        ),
        (
            "/profiles/head/points/3",
            json!([0]),
            "profiles.head.points[3]: found a list of 1; allowed: a list of 2, each a number",
        ),
        (
            "/profiles/head/points/3/1",
            json!("x"),
            "profiles.head.points[3][1]: found \"x\"; allowed: a number",
        ),
        (
            "/track/irregularity",
            json!({ "kind": "psd", "form": "fra_hamid_yang", "class": 7, "wavelengths": [1.5, 40], "seed": 1, "period": 1000 }),
            "track.irregularity.class: found 7; allowed: 1 (worst) to 6 (best)",
        ),
        (
            "/track/irregularity",
            json!([{ "kind": "psd", "form": "fra_hamid_yang", "clas": 6, "wavelengths": [1.5], "seed": 0.5, "period": 1000 }]),
            "track.irregularity[0].clas: found an unknown key; allowed: class, density, density_rad, form, gauge, \
         kind, level, period, scale, seed, wavelengths (did you mean class?)\n\
         track.irregularity[0].seed: found 0.5; allowed: a whole number >= 0\n\
         track.irregularity[0].wavelengths: found a list of 1; allowed: a list of 2, each a number",
        ),
        (
            "/track/irregularity",
            json!({ "kind": "bump" }),
            "track.irregularity.kind: found \"bump\"; allowed: \"psd\", \"shape\", \"measured\"",
        ),
        (
            "/track/layout",
            json!([{ "kind": "curve", "length": 50, "radius": 300, "cant": 20 }]),
            "track.layout[0].cant: found an unknown key; allowed: cant_mm, curvature, gradient, kind, \
         length, radius, widening_mm (did you mean cant_mm?)",
        ),
        (
            "/track/layout",
            json!([{ "kind": "tangent", "length": 0 }]),
            "track.layout[0].length: found 0; allowed: above 0 m",
        ),
        (
            "/track/fade_start",
            json!(10),
            "track.fade_in: found 0 m; allowed: above 0 m where fade_start is above 0 (the track would \
         begin with a step)",
        ),
        ("/run/creep", json!({ "kind": "fastsim", "nx": 0 }), "run.creep.nx: found 0; allowed: 2 to 400"),
        ("/format", json!(2), "format: found 2; allowed: 1"),
        ("/label", json!(null), "label: found null; allowed: a text"),
        ("/vehicle/body/0/mass", json!(0), "vehicle.body[0].mass: found 0; allowed: a number > 0 kg"),
        ("/vehicle", json!(3), "vehicle: found 3; allowed: a table"),
        ("/track/support/kz", json!("x"), "track.support.kz: found \"x\"; allowed: a number > 0 N/m"),
        (
            "/run/creep",
            json!({ "kind": "fastism" }),
            "run.creep.kind: found \"fastism\"; allowed: \"fastrip\", \"fastsim\", \"kalker_linear\", \
             \"modified_fastsim\", \"polach\", \"shen_hedrick_elkins\", \"vermeulen_johnson\" (did you \
             mean fastsim?)",
        ),
        (
            "/run/disturbance",
            json!({ "carbody.y": "x" }),
            "run.disturbance.carbody.y: found \"x\"; allowed: a number",
        ),
        (
            "/run/spede",
            json!(3),
            "run.spede: found an unknown key; allowed: contact, couplers, creep, disturbance, drive, friction, gravity, hold, \
         integrator, kind, load, load_steps, output_step, place, search, speed, speeds, start, train, wheel_profile (did you mean speeds?)",
        ),
    ]
}

#[test]
fn every_damage_to_a_case_has_its_message() {
    Case::from_json(&case().to_string()).unwrap_or_else(|e| panic!("{e}"));
    let mut wrong = Vec::new();
    for (pointer, value, message) in cases() {
        let mut json = case();
        let (table, key) = pointer.rsplit_once('/').unwrap();
        match json.pointer_mut(table).unwrap() {
            Value::Array(items) => items[key.parse::<usize>().unwrap()] = value,
            table => table[key] = value,
        }
        let said: Vec<String> =
            faults(Case::from_json(&json.to_string())).iter().map(ToString::to_string).collect();
        let said = said.join("\n");
        if said != message {
            wrong.push(format!("{pointer}\n  said:     {said}\n  expected: {message}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn a_case_is_read_with_its_defaults_and_its_profiles_in_metres() {
    let case = Case::from_json(&case().to_string()).unwrap();
    assert_eq!(case.run.gravity, 9.80665);
    assert_eq!(case.run.wheel_profile, "round");
    assert_eq!(case.vehicle.bodies[0].mass, 600.0);
    assert_eq!(case.design.bodies[0].mass, 1000.0);
    assert_eq!(case.profiles["head"].points[0], [-4.0 * 1e-3, 0.0]);
    assert!(case.track.layout.is_empty() && case.track.irregularity.is_empty());
}

#[test]
fn faults_of_vehicle_track_and_run_come_together() {
    let mut json = case();
    json["run"]["speed"] = json!(-1);
    json["track"]["length"] = json!("long");
    json["vehicle"]["parameters"]["axle"]["mass"] = json!(0);
    let keys: Vec<String> =
        faults(Case::from_json(&json.to_string())).iter().map(|f| f.key.to_string()).collect();
    assert_eq!(keys, ["vehicle.template.axle.wheelset[0].mass", "run.speed", "track.length"]);
}

#[test]
fn text_that_is_not_json_is_refused_with_its_place() {
    let said = faults(Case::from_json("{ \"format\": 1,\n  oops }"));
    assert_eq!(said[0].key.to_string(), "line 2, column 3");
}

#[test]
fn text_that_is_not_toml_is_refused_with_its_place() {
    let text = "name = \"x\"\nmass = = 3\n";
    let error = schema::syntax_error(text).unwrap();
    assert_eq!((error.line, error.column), (2, 8));
    let said = faults(toml_to_json(text));
    assert_eq!(said[0].to_string(), format!("line 2, column 8: found {}; allowed: TOML", error.message));
    assert_eq!(schema::syntax_error("a = 1\na = 2\n").unwrap().line, 2);
    let said: Vec<String> =
        faults(toml_to_json("[a]\nx = nan\ny = 2020-01-01\n")).iter().map(ToString::to_string).collect();
    assert_eq!(
        said,
        [
            "a.x: found NaN; allowed: a finite number",
            "a.y: found the date 2020-01-01; allowed: a text, in quotes"
        ]
    );
}

#[test]
fn a_key_path_is_found_at_its_line() {
    let text = "\
top = 1

[run]
integrator = { kind = \"heun\", step = 1 }
points = [
  [0, 1],
  [2, 3],
]

[[body]]
name = \"a\"

[[body]]
name = \"b\"
[body.deep]
x = 1

[template.t]
[[template.t.body]]
name = \"c\"
";
    let line = |key: KeyPath| line_of(text, &key);
    let of = KeyPath::of;
    assert_eq!(line(of("top")), Some(1));
    assert_eq!(line(of("run")), Some(3));
    assert_eq!(line(of("run.integrator.step")), Some(4));
    assert_eq!(line(of("run.points").index(1).index(0)), Some(7));
    assert_eq!(line(of("run.missing")), Some(3));
    assert_eq!(line(of("body").index(1).key("name")), Some(14));
    assert_eq!(line(of("body").index(1).key("mass")), Some(13));
    assert_eq!(line(of("body").index(0)), Some(10));
    assert_eq!(line(of("body").index(1).key("deep").key("x")), Some(16));
    assert_eq!(line(of("template.t.body").index(0).key("name")), Some(20));
    assert_eq!(line(of("template.t.body").index(0)), Some(19));
    assert_eq!(line(of("nowhere")), None);
}
