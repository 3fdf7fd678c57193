//! Maps of more poses than are held at once: the deviations are not kept, files are written as they come.

use super::map_output::{Outputs, Tables};
use super::progress::Progress;
use super::session::Session;
use crate::analysis::survey;
use crate::analysis::{Block, Survey, SurveyTask, survey_with_rows};
use crate::cli::Exit;
use crate::cli::verbs::map::SurveyResult;
use crate::report::Rows;

/// Surveys a field, and writes the outputs that were asked for.
pub(crate) fn surveyed(
    session: &mut Session,
    task: SurveyTask<'_>,
    rows: &Rows<'_>,
    outputs: Option<&Outputs>,
) -> Result<SurveyResult, Exit> {
    let progress = Progress::new(task.poses.len(), session.is_quiet());
    let add = |count| progress.add(count);
    let survey = match outputs.filter(|outputs| !outputs.forms().is_empty()) {
        None => survey(task, &add),
        Some(outputs) => written(session, task, (rows, outputs), &add)?,
    };
    drop(progress);
    Ok(SurveyResult { statistics: survey.statistics, worst: survey.worst, sketched: true, csv: None })
}

fn written(
    session: &mut Session,
    task: SurveyTask<'_>,
    (rows, outputs): (&Rows<'_>, &Outputs),
    progress: &(dyn Fn(usize) + Sync),
) -> Result<Survey, Exit> {
    let forms = outputs.forms();
    let mut tables = Tables::new(session, outputs, rows)?;
    let make = |block: Block<'_>| rows.prepared(&forms, block.first, block.rows());
    let survey = survey_with_rows(task, &make, &mut |block| tables.put(&block), progress);
    tables.finish(session)?;
    survey.ok_or(Exit::Refused)
}
