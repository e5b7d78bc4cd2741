//! A vehicle at its place on the design track, brought to balance there.

use crate::dynamics::coordinate;
use crate::dynamics::equilibrium::{self, Conditions};
use crate::dynamics::{Model, VehicleSystem, compile};
use crate::error::{Error, Fault, KeyPath, Result};
use crate::schema::Case;
use crate::track::{Layout, Segment};

/// Two places whose curvature (1/m), cant or gradient (rad) differ by less are on the same uniform stretch.
const SAME: f64 = 1e-9;
/// Share of the curve that the continuation begins with.
const FIRST_SHARE: f64 = 0.25;
/// Least share of the curve by which the continuation goes on.
const LEAST_SHARE: f64 = 1.0 / 128.0;

/// A compiled case with the place where its vehicle stands.
#[derive(Debug)]
pub struct Stand {
    /// The model.
    pub model: Model,
    /// Arc length of the vehicle's centre, m.
    pub s: f64,
    /// Coordinates that are held (indices into the state).
    pub held: Vec<usize>,
    segments: Vec<Segment>,
    length: f64,
}

impl Stand {
    /// Compiles a case.
    ///
    /// # Errors
    /// Faults of the case; a held coordinate that does not exist; a layout that changes under a rolling vehicle.
    pub fn new(case: &Case) -> Result<Self> {
        let model = compile::model(case)?;
        let s = case.run.place.unwrap_or(0.5 * case.track.length);
        let at = KeyPath::of("run.hold");
        let held = case
            .run
            .hold
            .iter()
            .enumerate()
            .map(|(i, name)| coordinate::find(&model, name, &at.index(i)).map(|c| c.q))
            .collect::<Result<_>>()?;
        let stand = Self { model, s, held, segments: case.track.layout.clone(), length: case.track.length };
        if case.run.speed > 0.0 || case.run.speeds.iter().any(|v| *v > 0.0) {
            stand.uniform()?;
        }
        Ok(stand)
    }

    /// Curvature (1/m), cant and gradient (rad) under the vehicle's centre.
    #[must_use]
    pub fn curve(&self) -> [f64; 3] {
        let layout = &self.model.layout;
        [layout.curvature(self.s), layout.cant(self.s), layout.gradient(self.s)]
    }

    /// A rolling vehicle is in balance only where the track is the same under all of it.
    fn uniform(&self) -> Result<()> {
        let layout = &self.model.layout;
        let places = (0..self.model.count()).map(|i| self.s + self.model.rigid(i).position.x);
        let (rear, front) = places.fold((f64::MAX, f64::MIN), |(a, b), s| (a.min(s), b.max(s)));
        let centre = self.curve();
        for s in [rear, front] {
            let here = [layout.curvature(s), layout.cant(s), layout.gradient(s), layout.widening(s).0];
            let [curvature, cant, gradient] = centre;
            let centre = [curvature, cant, gradient, layout.widening(self.s).0];
            let names = ["curvature, 1/m", "cant, rad", "gradient, rad", "widening, m"];
            for (name, (a, b)) in names.into_iter().zip(here.into_iter().zip(centre)) {
                if (a - b).abs() > SAME {
                    return Err(Error::input(
                        Fault::new(
                            KeyPath::of("run.place"),
                            format!("{} m, where the layout changes under the vehicle ({name}: {a:.3e} at {s:.1} m, {b:.3e} at {:.1} m)", self.s, self.s),
                            "a place with a uniform layout under the whole vehicle, or speed = 0",
                        )
                        .hint("without `run.place` the vehicle stands in the middle of the track"),
                    ));
                }
            }
        }
        Ok(())
    }

    /// The layout with a share of its curvature, cant and gradient.
    fn layout(&self, share: f64) -> Result<Layout> {
        let segments: Vec<Segment> = self.segments.iter().map(|s| s.scaled(share)).collect();
        Layout::new(&segments, self.length, &KeyPath::of("track.layout"))
    }

    /// A system at this place, on the ideal track, at a speed.
    #[must_use]
    pub fn system(&self, speed: f64) -> VehicleSystem<'_> {
        let mut system = equilibrium::standing(&self.model, self.s);
        equilibrium::roll(&mut system, speed);
        system
    }

    /// Balance at `speed`: on straight track first, then with ever more of the curve.
    ///
    /// # Errors
    /// [`Error::NotConverged`].
    pub fn settle(&mut self, speed: f64) -> Result<Vec<f64>> {
        let curved = !self.model.layout.is_tangent();
        if curved {
            self.model.layout = Layout::tangent(self.length);
        }
        let mut x = equilibrium::design_state(&self.model, self.s);
        let held = self.held.clone();
        for v in [0.0, speed] {
            let conditions = Conditions { speed: v, held: &held, push: &[], since: None };
            equilibrium::settle(&mut self.system(v), &mut x, conditions)?;
            if speed == 0.0 {
                break;
            }
        }
        if curved { self.enter_curve(x, speed) } else { Ok(x) }
    }

    fn enter_curve(&mut self, mut x: Vec<f64>, speed: f64) -> Result<Vec<f64>> {
        let held = self.held.clone();
        let conditions = Conditions { speed, held: &held, push: &[], since: None };
        let (mut done, mut share) = (0.0_f64, FIRST_SHARE);
        while done < 1.0 {
            let next = (done + share).min(1.0);
            self.model.layout = self.layout(next)?;
            let mut trial = x.clone();
            let mut system = self.system(speed);
            let outcome = if share > LEAST_SHARE {
                equilibrium::newton(&mut system, &mut trial, conditions)
            } else {
                equilibrium::settle(&mut system, &mut trial, conditions)
            };
            match outcome {
                Ok(()) => {
                    (x, done) = (trial, next);
                    share *= 2.0;
                }
                Err(error) if share <= LEAST_SHARE => {
                    self.model.layout = self.layout(1.0)?;
                    return Err(error);
                }
                Err(_) => share *= 0.5,
            }
        }
        Ok(x)
    }
}
