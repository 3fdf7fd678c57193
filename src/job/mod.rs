//! What a job is about: the machine, and the poses at which it works.
//!
//! - [`machine_file`]: a machine with the files that it was read from;
//! - [`poses`]: positions of the axes, as a caller gives them and as results name them;
//! - [`tool_poses`]: tool poses of a file, with those that the machine does not reach and the travel that they need;
//! - [`placement`]: where the part lies; [`place_grid`]: ranges of places; [`place_study`]: the part tried at each;
//! - [`job_file`]: a job as a file states it;
//! - `tool`: the tool that a job names, which the machine takes;
//! - [`limit`]: the largest deviation that a job allows;
//! - [`mod@reference`]: what the set-up of a part takes out of its deviations;
//! - [`reference_text`]: the same as a text;
//! - [`numbers`]: the numbers of a job, which are bounded;
//! - [`over`]: the statement of what a result is over;
//! - [`characteristics`]: tolerances of features, and the values that deviations and bounds lead to;
//! - [`test_piece`]: test pieces of standards as jobs;
//! - [`path`]: what tool poses ask of a machine as one path;
//! - [`round_features`]: those that are round, with their profile over the angle;
//! - [`played`]: the rows of a work one by one;
//! - [`features`]: the features of such a file, and the largest deviation on each.

pub mod characteristics;
pub mod features;
pub mod job_file;
pub mod limit;
pub mod machine_file;
pub mod numbers;
pub mod over;
pub mod path;
pub mod place_grid;
pub mod place_study;
pub mod placement;
pub mod played;
pub mod poses;
pub mod reference;
pub mod reference_text;
pub mod round_features;
pub mod test_piece;
mod tool;
pub mod tool_poses;
