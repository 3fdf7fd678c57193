//! Replays the inputs of the fuzzer without one: every target takes its seeds, and the inputs that once failed. libFuzzer
//! itself runs in `tests/soak`. The modules are those of `fuzz/src`; a broken oracle is a panic.

#[path = "../../fuzz/src/case.rs"]
mod case;
#[path = "../../fuzz/src/generated.rs"]
mod generated;
#[path = "../../fuzz/src/oracles.rs"]
mod oracles;
#[path = "../../fuzz/src/seeds.rs"]
mod seeds;
#[path = "../../fuzz/src/targets.rs"]
mod targets;

use std::path::Path;

/// The repository.
const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// Runs a target on its seeds, one of which must be accepted, and on its corpus.
fn replay(target: &str, accepts: fn(&[u8]) -> bool) {
    let seeds = seeds::seeds(target);
    let accepted = seeds.iter().filter(|seed| accepts(seed)).count();
    assert!(accepted > 0, "{target}: none of {} seeds is accepted", seeds.len());
    let corpus = Path::new(ROOT).join("fuzz/corpus").join(target);
    for entry in corpus.read_dir().into_iter().flatten() {
        let _ = accepts(&std::fs::read(entry.unwrap().path()).unwrap());
    }
}

/// One test for each target: they run beside each other.
macro_rules! targets {
    ($($target:ident)*) => { $(
        #[test]
        fn $target() {
            replay(stringify!($target), targets::$target);
        }
    )* };
}

targets! { generated_machines imports locks machine_files manifests measurements readers tables tool_poses }

#[test]
fn no_target_is_left_out() {
    let manifest = std::fs::read_to_string(Path::new(ROOT).join("fuzz/Cargo.toml")).unwrap();
    let source = std::fs::read_to_string(Path::new(ROOT).join("tests/it/corpora.rs")).unwrap();
    let list = source.split("targets! {").nth(1).unwrap().split('}').next().unwrap();
    let listed: Vec<&str> = list.split_whitespace().collect();
    let named: Vec<&str> =
        manifest.lines().filter_map(|line| line.strip_prefix("name = \"")?.strip_suffix('"')).collect();
    assert_eq!(listed, named.into_iter().filter(|name| *name != "abbe-fuzz").collect::<Vec<_>>());
}
