//! The start of a process of libFuzzer.

use super::seeds::seeds;
use std::path::PathBuf;

/// Prepares the process for a target. Writes its seeds into the folder that the environment variable `SEEDS` names, and
/// ends the process, if there is such a variable. Fails if all of them are refused: mutations of them would get nowhere.
pub fn begin(target: &str, accepts: fn(&[u8]) -> bool) {
    // What runs in parallel runs here, and hands nothing over. In vain if there is a pool already.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global();
    let Some(folder) = std::env::var_os("SEEDS").map(PathBuf::from) else { return };
    let seeds = seeds(target);
    let accepted = seeds.iter().filter(|seed| accepts(seed)).count();
    assert!(accepted > 0, "none of {} seeds is accepted", seeds.len());
    println!("{accepted} of {} seeds are accepted", seeds.len());
    let written = std::fs::create_dir_all(&folder).and_then(|()| {
        let mut numbered = seeds.into_iter().enumerate();
        numbered.try_for_each(|(number, seed)| std::fs::write(folder.join(format!("{number:03}")), seed))
    });
    match written {
        Ok(()) => std::process::exit(0),
        Err(why) => panic!("{}: {why}", folder.display()),
    }
}
