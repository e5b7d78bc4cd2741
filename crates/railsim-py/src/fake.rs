//! The names of the core that the binding calls, until the core has them.
#![allow(dead_code, missing_docs, clippy::unnecessary_wraps)]

pub mod schema {
    use railsim::{Error, Fault, KeyPath, Result};
    pub struct Case(pub serde_json::Value);
    impl Case {
        pub fn from_json(text: &str) -> Result<Self> {
            serde_json::from_str(text)
                .map(Self)
                .map_err(|e| Error::input(Fault::new(KeyPath::default(), e.to_string(), "JSON")))
        }
    }
    pub fn resolve_vehicle(document: &str, _overrides: &str, _condition: Option<&str>) -> Result<String> {
        let document = Case::from_json(document)?.0;
        Ok(serde_json::json!({"document": document, "name": "fake", "title": "fake", "design_speed": 31.9,
            "wheel_radius": 0.46, "wheel_profile": "anzr1_new", "track": {}, "conditions": ["tare"],
            "design_condition": "tare", "mass": 134e3, "bodies": ["carbody"]})
        .to_string())
    }
}

pub mod run {
    use super::schema::Case;
    use railsim::{Error, Result};
    pub trait Control: Sync {
        fn progress(&self, t: f64, s: f64, fraction: f64);
        fn stop(&self) -> bool;
    }
    pub enum Ended {
        EndOfTrack,
        Diverged(Error),
    }
    pub struct Outcome {
        pub columns: Vec<(String, Vec<f64>)>,
        pub ended: Ended,
        pub statistics: serde_json::Value,
    }
    pub struct Channel {
        pub name: String,
        pub unit: String,
        pub meaning: String,
    }
    pub fn simulate(case: &Case, control: &dyn Control) -> Result<Outcome> {
        let length = case.0["track"]["length"].as_f64().unwrap_or(100.0);
        let speed = case.0["run"]["speed"].as_f64().unwrap_or(35.0);
        let (mut ts, mut ss, mut ys) = (vec![], vec![], vec![]);
        for i in 0_u32.. {
            let t = f64::from(i) * 0.005;
            let s = speed * t;
            if s > length {
                break;
            }
            if control.stop() {
                return Err(Error::Interrupted);
            }
            control.progress(t, s, s / length);
            ts.push(t);
            ss.push(s);
            ys.push(0.1 * t.sin());
        }
        let columns = vec![("t".into(), ts), ("s".into(), ss), ("carbody.y".into(), ys)];
        Ok(Outcome { columns, ended: Ended::EndOfTrack, statistics: serde_json::json!({}) })
    }
    pub fn channels(_case: &Case) -> Result<Vec<Channel>> {
        let channel =
            |n: &str, u: &str, m: &str| Channel { name: n.into(), unit: u.into(), meaning: m.into() };
        Ok(vec![
            channel("t", "s", "time"),
            channel("s", "m", "distance"),
            channel("carbody.y", "m", "lateral"),
        ])
    }
}

pub mod track {
    pub fn extremes(_case: &super::schema::Case) -> railsim::Result<[(f64, f64); 4]> {
        Ok([(0.0, 0.0); 4])
    }
}

pub mod contact {
    pub fn equivalent_conicity(_case: &super::schema::Case, _amplitude: f64) -> railsim::Result<f64> {
        Ok(0.1)
    }
    pub mod profile {
        pub fn read_csv(text: &str, _name: &str) -> railsim::Result<Vec<[f64; 2]>> {
            let lines = text.lines().filter(|l| !l.starts_with('#'));
            let row = |l: &str| -> Option<[f64; 2]> {
                let (y, z) = l.split_once(',')?;
                Some([y.trim().parse::<f64>().ok()? * 1e-3, z.trim().parse::<f64>().ok()? * 1e-3])
            };
            Ok(lines.filter_map(row).collect())
        }
    }
}
