//! `diff` of two machine files: what differs, and what each difference does to the deviations.

use super::compare::nothing_in_common;
use crate::analysis::{MachineResult, Work, compare as compared};
use crate::evaluate::{Bare, Field, Order};
use crate::job::machine_file::{MachineFile, order_of, sources_of};
use crate::machine::{Approach, Machine, MachineProperty};
use crate::report::{MachineDifference, describe};
use crate::run::{Call, Count, Refused, Reply, Run};

/// Options of [`diff_machines`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct DiffMachinesOptions {
    /// Number of tool poses, drawn from the volume of the first machine.
    pub poses: usize,
    /// Seed of the tool poses.
    pub seed: u64,
    /// Order of the errors; exact by default, unless the conventions of a machine name an order.
    pub order: Option<Order>,
    /// Side of approach, where forward and reverse curves were given.
    pub approach: Approach,
}

impl Default for DiffMachinesOptions {
    fn default() -> Self {
        Self { poses: 1000, seed: 1, order: None, approach: Approach::default() }
    }
}

/// Compares two machines property by property, and states the effect of each difference on the 95 % position
/// deviation over tool poses that both reach.
///
/// Fails if the files are not two, and if no tool pose is reached by both machines.
pub fn diff_machines(files: &[MachineFile], options: &DiffMachinesOptions, run: Run<'_>) -> Reply<MachineDifference> {
    Call::answer(run, &sources_of(files), |call| difference(call, files, options))
}

fn difference(
    call: &mut Call<'_>,
    files: &[MachineFile],
    options: &DiffMachinesOptions,
) -> Result<MachineDifference, Refused> {
    let [first, second] = files else { return call.usage("`diff` takes two machines") };
    call.check_counts(&[Count::Poses(options.poses)])?;
    let properties = first.differences(second);
    // These change no deviation, and a travel taken alone would change the work.
    let idle = |property: &MachineProperty| {
        matches!(
            property,
            MachineProperty::Travel(_)
                | MachineProperty::Controller(_)
                | MachineProperty::Class
                | MachineProperty::Tolerances
        )
    };
    let alone = |property: &&MachineProperty| !idle(property);
    let single: Vec<(&MachineProperty, Machine)> = properties
        .iter()
        .filter(alone)
        .filter_map(|property| Some((property, first.with_property_of(second, property)?)))
        .collect();
    let both = [&**first, &**second].into_iter();
    let machines: Vec<&Machine> = both.chain(single.iter().map(|(_, machine)| machine)).collect();
    let bare: Vec<Bare<'_>> =
        machines.iter().map(|machine| Bare { machine, order: order_of(machine, options.order) }).collect();
    let fields: Vec<&dyn Field> = bare.iter().map(|field| field as &dyn Field).collect();
    let work = Work::random(first, options.poses, options.seed);
    let found = call.stage(work.len(), |advance| compared(&fields, &work, options.approach.into(), advance))?;
    if found.common.is_empty() {
        return call.refuse(nothing_in_common(files, &found));
    }
    let p95 = |machine: usize| found.machines[machine].statistics.position_um.p95;
    let of = |property: &MachineProperty| {
        let index = single.iter().position(|(known, _)| *known == property)? + 2;
        covers(machines[index], &found.machines[index]).then(|| p95(index))
    };
    // Everything but the chain itself is judged on the chain of the second.
    let base = of(&MachineProperty::Chain).unwrap_or(p95(0));
    let effect = |property: &MachineProperty| {
        let from = if *property == MachineProperty::Chain { p95(0) } else { base };
        of(property).map(|um| um - from)
    };
    Ok(MachineDifference {
        machines: [first, second].map(|file| file.name().to_owned()),
        files: [first, second].map(|file| file.path().to_owned()),
        asked: found.asked,
        poses: found.common.len(),
        seed: options.seed,
        p95_um: [p95(0), p95(1)],
        minus_first_um: p95(1) - p95(0),
        differences: properties.iter().map(|property| describe(first, second, property, effect(property))).collect(),
    })
}

/// True if every error curve is defined at the poses.
fn covers(machine: &Machine, side: &MachineResult) -> bool {
    side.reached.iter().all(|(pose, _)| machine.outside(pose).is_none())
}
