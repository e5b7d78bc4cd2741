//! FaStrip: strip theory where the patch sticks, FASTSIM's directions where it slides.

use super::strip::{Strips, spaced};
use super::{CreepForce, Creepage, DEFAULT_POISSON, Patch, poisson_faults};
use crate::error::{Fault, KeyPath};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// FaStrip (M. Sh. Sichani, R. Enblom and M. Berg, Vehicle System Dynamics, 2016): the closed strip theory of Kalker (1967), scaled
/// to his coefficients of the elliptical patch, in the area of adhesion; Hertz's pressure times friction, in the direction that FASTSIM
/// finds, in the area of slip.
///
/// p0 = 3N/(2 pi a b), a_y = a sqrt(1 - (y/b)^2), c = sqrt(a b); scaled creepages
/// xi' = -2 G (1-nu) C11 xi/(pi^2 mu p0), eta' = -2 G (1-nu) C22 eta/(pi^2 mu p0), psi' = -3 G c C23 phi/(2 pi mu p0).
///
/// - half-length of the slip zone at the trailing edge: d = a (sqrt(eta'^2 + (1-psi'^2) u^2) + eta' psi')/((1-nu)(1-psi'^2)), u = xi' - psi' y/a;
///   the whole strip slides where d is not in 0 .. a_y or |psi'| >= 1,
/// - adhesion, x > 2d - a_y: p_x = mu p0/a k (S - S_d), p_y = mu p0/a (l S - (l - psi') S_d), S = sqrt(a_y^2 - x^2),
///   S_d = sqrt((a_y-d)^2 - (x-d)^2), (k, l) = (u, eta' + psi' d/a)/norm,
/// - slip: |p| = mu p0 sqrt(1 - (x/a)^2 - (y/b)^2) along FASTSIM's stress. That FASTSIM runs with one flexibility,
///   L = (|xi| L1 + |eta| L2 + c |phi| L3)/sqrt(xi^2 + eta^2 + c^2 phi^2), with Hertz's pressure for its bound and N (1 + (1 - a/b)^4) where
///   a < b. With FASTSIM's three flexibilities and paraboloid the direction in full sliding would be off by the ratio of L1 to L2, and the mean
///   error against the exact theory in combined creepage 0.045 mu N instead of 0.017.
///
/// The adhesion is integrated in closed form, the slip zone element by element with the exact load of each. Strips are spaced
/// evenly in the angle of the ellipse, on which the sums across converge fast. Slopes at zero are Kalker's on every grid, and |F| <= mu N.
/// Nearer to the exact theory than FASTSIM: 0.012 mu N in the mean, 0.07 at most (CONTACT, a/b = 1), and much better in the stresses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fastrip {
    /// Elements along rolling, 2 to 400. Default 20.
    #[serde(default = "twenty")]
    pub nx: u16,
    /// Strips across, 2 to 400. Default 20.
    #[serde(default = "twenty")]
    pub ny: u16,
    /// Poisson's ratio, 0 to 0.5; it matters with spin only. If absent, the vehicle's in a case and 0.28 elsewhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
    pub poisson: Option<f64>,
}

fn twenty() -> u16 {
    20
}

impl Default for Fastrip {
    fn default() -> Self {
        Self { nx: twenty(), ny: twenty(), poisson: None }
    }
}

/// Force and moment of a strip or a patch: x, y (N) and about the normal (N m).
type Resultant = [f64; 3];

/// Integrals over x in `from` .. `half` of sqrt(half^2 - x^2) and x sqrt(half^2 - x^2).
fn semicircle(half: f64, from: f64) -> [f64; 2] {
    let t = (from / half).clamp(-1.0, 1.0);
    let root = ((1.0 - t) * (1.0 + t)).sqrt();
    [0.5 * half * half * (t.acos() - t * root), half * half * half * root * root * root / 3.0]
}

/// Scaled creepages and the patch, for all strips.
struct Scaled<'a> {
    patch: &'a Patch,
    xi: f64,
    eta: f64,
    psi: f64,
    nu: f64,
    /// mu p0, Pa.
    limit: f64,
}

impl Scaled<'_> {
    /// Half-length of the slip zone of a strip at `y`, if it does not slide as a whole.
    fn slip_half_length(&self, y: f64, half: f64) -> Option<f64> {
        let rest = 1.0 - self.psi * self.psi;
        let u = self.xi - self.psi * y / self.patch.a;
        let root = (self.eta * self.eta + rest * u * u).sqrt();
        let d = self.patch.a * (root + self.eta * self.psi) / ((1.0 - self.nu) * rest);
        (rest > 0.0 && d >= 0.0 && d < half).then_some(d)
    }

    /// Adhesion of a strip, per metre across.
    fn adhesion(&self, y: f64, half: f64, d: f64) -> Resultant {
        let a = self.patch.a;
        let (u, v) = (self.xi - self.psi * y / a, self.eta + self.psi * d / a);
        let size = u.hypot(v);
        let (k, l) = if size > 0.0 { (u / size, v / size) } else { (0.0, 0.0) };
        let whole = semicircle(half, 2.0 * d - half);
        let inner = 0.5 * PI * (half - d) * (half - d); // and its centre lies at x = d
        let scale = self.limit / a;
        let (px, py) = (k * (whole[0] - inner), l * whole[0] - (l - self.psi) * inner);
        let first = l * whole[1] - (l - self.psi) * inner * d;
        [scale * px, scale * py, scale * (first - y * px)]
    }

    /// Slip zone of a strip, per metre across: from the trailing edge to x = `end`.
    fn slip(&self, strips: &Strips, relative: f64, count: u16, end: f64) -> Resultant {
        let root = (1.0 - relative * relative).max(0.0).sqrt();
        let half = self.patch.a * root;
        let pressure = self.limit * root; // at the middle of the strip
        let step = 2.0 / f64::from(count);
        let mut sum = [0.0; 3];
        let mut before = semicircle(1.0, end / half);
        strips.march(relative, count, |x, stress| {
            let rear = (x - 0.5 * step).max(-1.0);
            if rear * half >= end {
                return;
            }
            let now = semicircle(1.0, rear);
            let load = [0, 1].map(|i| pressure * half * (now[i] - before[i]));
            before = now;
            let size = stress[0].hypot(stress[1]);
            if size > 0.0 {
                let (ex, ey) = (stress[0] / size, stress[1] / size);
                sum[0] += load[0] * ex;
                sum[1] += load[0] * ey;
                sum[2] += half * load[1] * ey - self.patch.b * relative * load[0] * ex;
            }
        });
        sum
    }
}

impl Fastrip {
    /// Force on the wheel and spin moment.
    fn resultant(&self, p: &Patch, creepage: &Creepage, mu: f64) -> Resultant {
        let limit = mu * 1.5 * p.n / (PI * p.a * p.b);
        if limit <= 0.0 {
            return [0.0; 3];
        }
        let nu = self.poisson.unwrap_or(DEFAULT_POISSON);
        let translation = -2.0 * p.shear_modulus * (1.0 - nu) / (PI * PI * limit);
        let spin = -1.5 * p.shear_modulus * (p.a * p.b).sqrt() / (PI * limit);
        let scaled = Scaled {
            patch: p,
            xi: translation * p.c11 * creepage.xi,
            eta: translation * p.c22 * creepage.eta,
            psi: spin * p.c23 * creepage.phi,
            nu,
            limit,
        };
        let narrow = (1.0 - p.a / p.b).max(0.0).powi(4);
        let strips = Strips::one_flexibility(p, creepage, mu, p.n * (1.0 + narrow));
        let mut sum = [0.0; 3];
        let mut load = 0.0;
        for j in 0..self.ny {
            let (relative, width) = spaced(j, self.ny);
            let (y, square) = (relative * p.b, 1.0 - relative * relative);
            let half = p.a * square.sqrt();
            load += width * square;
            let mut add = |part: Resultant| (0..3).for_each(|i| sum[i] += p.b * width * part[i]);
            match scaled.slip_half_length(y, half) {
                Some(d) => {
                    add(scaled.adhesion(y, half, d));
                    if d > 0.0 {
                        add(scaled.slip(&strips, relative, self.nx, 2.0 * d - half));
                    }
                }
                None => add(scaled.slip(&strips, relative, self.nx, half)),
            }
        }
        // the strips carry the load together, neither more nor less
        sum.map(|s| s * (4.0 / 3.0) / load)
    }

    /// Force on the wheel.
    #[must_use]
    pub fn force(&self, p: &Patch, creepage: &Creepage, mu: f64) -> CreepForce {
        let [fx, fy, _] = self.resultant(p, creepage, mu);
        CreepForce { fx, fy }
    }

    /// Spin moment on the wheel, N m.
    #[must_use]
    pub fn spin_moment(&self, p: &Patch, creepage: &Creepage, mu: f64) -> f64 {
        self.resultant(p, creepage, mu)[2]
    }

    /// Faults in the parameters.
    #[must_use]
    pub fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = super::Fastsim { nx: self.nx, ny: self.ny }.faults(at);
        faults.extend(poisson_faults(self.poisson, at));
        faults
    }

    /// Laws for the contract suite: the default and an odd, coarse grid.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        vec![Self::default(), Self { nx: 9, ny: 7, poisson: Some(0.3) }]
    }
}
