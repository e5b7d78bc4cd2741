//! The classical Runge-Kutta scheme: W. Kutta, Zeitschrift fuer Mathematik und Physik 46 (1901) 435-453; Hairer,
//! Norsett, Wanner, Solving Ordinary Differential Equations I, table 1.2.

use super::explicit::Tableau;

/// Four stages at 0, 1/2, 1/2, 1 with weights 1/6, 1/3, 1/3, 1/6.
pub const TABLEAU: Tableau = Tableau {
    c: &[0.0, 0.5, 0.5, 1.0],
    a: &[&[0.5], &[0.0, 0.5], &[0.0, 0.0, 1.0]],
    b: &[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
};
