#[path = "../tests/common/mod.rs"] mod common;
use railsim::dynamics::*; use railsim::integrator::System;
fn main() {
    let mut v = common::coco134();
    v["run"]["wheel_profile"] = serde_json::json!(std::env::args().nth(1).unwrap());
    v["profiles"][std::env::args().nth(1).unwrap()] = common::profile(&std::env::args().nth(1).unwrap(), "wheel");
    let model = compile::model(&common::case(&v)).unwrap();
    let x = equilibrium::solve(&model, 10.0, 35.0).unwrap();
    let mut s = VehicleSystem::new(&model, SpeedProgram { s: 10.0, speed: 35.0, acceleration: 0.0 });
    let mut dx = vec![0.0; x.len()];
    s.rhs(0.0, &x, &mut dx);
    for w in &s.scratch.wheels { for k in w { println!("shift {:.4} mm Q {:.1} {:?}", k.shift*1e3, k.Q, k.contacts.iter().flatten().map(|c| (c.geometry.unwrap().zone, c.normal, c.geometry.unwrap().share, c.geometry.unwrap().y_wheel, c.geometry.unwrap().angle, c.placed.creepage)).collect::<Vec<_>>()); } }
    let j = linearise::jacobian(&mut s, 0.0, &x);
    let mut big: Vec<(f64, usize, usize)> = (0..x.len()).flat_map(|i| (0..x.len()).map(move |k| (i,k))).map(|(i,k)| (j[(i,k)], i, k)).collect();
    big.sort_by(|a,b| b.0.abs().total_cmp(&a.0.abs()));
    for b in &big[..12] { println!("{:?} local {:?}", b, (if b.1>=36 {(b.1-36)%18} else {b.1%12}, if b.2>=36 {(b.2-36)%18} else {b.2%12})); }
}
