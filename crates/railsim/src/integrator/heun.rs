//! Heun's scheme: K. Heun, Zeitschrift fuer Mathematik und Physik 45 (1900) 23-38; Hairer, Norsett, Wanner,
//! Solving Ordinary Differential Equations I, section II.1.

use super::explicit::Tableau;

/// k1 = f(t, x), k2 = f(t + h, x + h k1), x + h (k1 + k2)/2.
pub const TABLEAU: Tableau = Tableau { c: &[0.0, 1.0], a: &[&[1.0]], b: &[0.5, 0.5] };
