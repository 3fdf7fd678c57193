//! Maps of more poses than are held at once: the deviations are not kept, a CSV file is written as they come.

use super::Stop;
use super::map::Found;
use super::map_output::Outputs;
use super::progress::Progress;
use super::session::Session;
use super::write::write_streamed;
use crate::analysis::{Survey, SurveyTask, survey, survey_with_rows};
use crate::evaluate::{Batch, Columns};
use crate::report::{csv_header, csv_line};
use std::io::Write;
use std::path::Path;

/// Surveys a field; of the outputs only CSV can be written so.
pub(super) fn surveyed(session: &mut Session, task: SurveyTask<'_>, outputs: Option<&Outputs>) -> Result<Found, Stop> {
    let path = match outputs {
        Some(outputs) => outputs.streamed(session)?,
        None => None,
    };
    let progress = Progress::new(task.poses.len(), session.is_quiet());
    let add = |count| progress.add(count);
    let survey = match path {
        None => survey(task, &add),
        Some(path) => written(session, task, path, &add)?,
    };
    drop(progress);
    Ok(Found { statistics: survey.statistics, worst: survey.worst, sketched: true, csv: None })
}

fn written(
    session: &mut Session,
    task: SurveyTask<'_>,
    path: &Path,
    progress: &(dyn Fn(usize) + Sync),
) -> Result<Survey, Stop> {
    let mut found: Option<Survey> = None;
    let header = csv_header(task.field.machine());
    let result = write_streamed(path, |file| {
        file.write_all(header.as_bytes())?;
        let mut failure = Ok(());
        found = survey_with_rows(
            task,
            &rows,
            &mut |text| {
                failure = file.write_all(text.as_bytes());
                failure.is_ok()
            },
            progress,
        );
        failure
    });
    result.or_else(|d| session.refuse(d))?;
    found.ok_or(Stop::Refused)
}

/// The lines of a block of poses.
fn rows(poses: &Batch<'_>, columns: &Columns, len: usize) -> String {
    (0..len).map(|i| csv_line(poses.pose(i), &columns.get(i))).collect()
}
