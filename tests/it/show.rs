//! The minimal set of location errors, and what `show` prints.

use crate::configs::{all, machine};
use abbe::analysis::{LocationSet, Status};
use abbe::machine::AxisKind;

fn names(set: &LocationSet) -> Vec<String> {
    set.members.iter().map(|(id, _)| id.to_string()).collect()
}

#[test]
fn the_sets_are_those_of_the_field() {
    let set = |name: &str| names(&LocationSet::of(&machine(name))).join(" ");
    assert_eq!(set("vmc-cframe-754.yaml"), "EC0Y EB0Z EA0Z EA0S EB0S");
    assert_eq!(set("trunnion.yaml"), "EC0Y EB0Z EA0Z EX0C EY0C EA0C EB0C EY0A EZ0A EB0A EC0A");
    assert_eq!(set("ht-b-c.yaml"), "EC0Y EB0Z EA0Z EX0C EY0C EA0C EB0C EX0B EZ0B EA0B EC0B EA0S EB0S");
}

#[test]
fn their_size_is_the_rule_of_the_field() {
    for (name, machine) in all() {
        if name.starts_with("papers") {
            continue; // Other conventions, and a chain of one axis.
        }
        let of = |kind| machine.axes().iter().filter(|axis| axis.kind == kind).count();
        let spindle = 2 * usize::from(machine.chain().spindle().is_some());
        let linear = of(AxisKind::Linear);
        let expected = 3 + 2 * linear.saturating_sub(3) + 4 * of(AxisKind::Rotary) + spindle;
        let set = LocationSet::of(&machine);
        println!("{name}: {:?} besides {:?}", set.members.iter().map(|(id, s)| format!("{id} {s:?}")).collect::<Vec<_>>(), set.besides);
        assert_eq!(set.members.len(), expected, "{name}: {:?}", names(&set));
    }
}

#[test]
fn what_the_file_gives_is_told_from_what_it_lacks() {
    let set = LocationSet::of(&machine("trunnion.yaml"));
    assert!(set.members.iter().all(|(_, status)| *status == Status::Given), "{set:?}");
    let bare = LocationSet::of(&machine("trunnion.yaml").filtered(|id| id.to_string() != "EX0C"));
    let missing: Vec<_> = bare.members.iter().filter(|(_, s)| *s == Status::Missing).map(|(id, _)| id.to_string()).collect();
    assert_eq!(missing, ["EX0C"]);
}
