//! Test pieces as jobs.

use crate::diagnostic::Sources;
use crate::job::test_piece::{TestPiece, TestPieceOptions, test_piece};
use crate::run::{Call, Reply, Run};

/// Returns a test piece as a job: a job file, and its table of tool poses with normals and features.
///
/// Fails for sizes and angles that no such piece has.
pub fn testpiece(options: &TestPieceOptions, run: Run<'_>) -> Reply<TestPiece> {
    Call::answer(run, &Sources::default(), |call| test_piece(options).or_else(|refusal| call.refuse(refusal)))
}
