//! Drawn machines at their worst poses: the 95 % value over a volume against as many poses as a budget never takes.

use crate::configs::machine;
use abbe::analysis::budget::{ActingErrors, Distribution, Draws, Request, Statistic, bounds, budget, budget_poses};
use abbe::evaluate::random_poses;
use abbe::machine::Machine;

/// The 95 % value of drawn machines with its upper end, um, and the value of each machine in the order drawn.
fn drawn(machine: &Machine, poses: &[Vec<f64>], searched: bool) -> (f64, f64, Vec<f64>) {
    let class = abbe::analysis::budget::classes().remove("production").unwrap();
    let (bounds, draws) = (bounds(machine, Some(&class)), Draws::new(3, Distribution::Uniform));
    let (acting, reference, at, draws) = (ActingErrors::None, None, None, &draws);
    let (samples, statistic, bounds) = (400, Statistic::Max, bounds.as_slice());
    let request = Request { machine, acting, bounds, poses, reference, searched, at, draws, samples, statistic };
    let found = budget(request, &|_| Ok(())).unwrap().position;
    let p95 = found.percentile(95);
    (p95.value, p95.high.unwrap(), found.drawn)
}

/// Poses drawn at random, as many as show how bad each machine is, and none at an end of an axis but by chance.
fn many(machine: &Machine) -> Vec<Vec<f64>> {
    random_poses(machine, 20_000, 77)
}

#[test]
fn the_interval_of_the_drawn_machines_covers_the_choice_of_poses() {
    for name in ["trunnion.yaml", "ht-b-c.yaml", "vmc-cframe-754.yaml"] {
        let machine = machine(name);
        let (value, high, each) = drawn(&machine, &budget_poses(&machine, 500, 1), true);
        let (many_value, _, of_many) = drawn(&machine, &many(&machine), false);
        assert!(many_value <= high && value > 0.99 * many_value, "{name}: {value} up to {high}, {many_value}");
        // Machine by machine, too.
        let worse = each.iter().zip(&of_many).filter(|(few, many)| **few < 0.97 * **many).count();
        assert_eq!(worse, 0, "{name}");
        // Without rotary axes the worst pose of every machine is one of the corners.
        let is_linear = machine.axes().iter().all(|axis| axis.kind == abbe::machine::AxisKind::Linear);
        assert!(!is_linear || each.iter().zip(&of_many).all(|(few, many)| few >= many), "{name}");
    }
}
