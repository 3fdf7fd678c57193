//! Tables of a map: every pose with its deviation, written side by side while the map is made.

use crate::analysis::{Survey, SurveyBlock, SurveyTask, survey, survey_with_rows};
use crate::diagnostic::{Diagnostic, codes};
use crate::report::{RowBlock, RowFormat, RowValues, Rows, Sink, Stream};
use crate::run::finite::not_finite;
use crate::run::{Call, Refused};

/// A table of every pose with its deviation, and where it goes. Positions are in mm and deg, deviations in um and urad.
pub struct MapTable<'a> {
    /// Name of the destination, for the refusal if it cannot be written.
    pub name: String,
    /// Form of the table.
    pub form: RowFormat,
    /// The destination.
    pub sink: Box<dyn Sink + 'a>,
}

/// Rows of a block of a map that is held.
const BLOCK: usize = 1 << 14;

pub(crate) struct Tables<'a> {
    rows: Rows<'a>,
    forms: Vec<RowFormat>,
    streams: Vec<(String, Box<dyn Stream + 'a>)>,
}

impl<'a> Tables<'a> {
    pub(crate) fn new(rows: Rows<'a>, tables: Vec<MapTable<'a>>) -> Result<Self, Diagnostic> {
        let forms = tables.iter().map(|table| table.form).collect();
        let begin = |MapTable { name, form, sink }: MapTable<'a>| match rows.stream(form, sink) {
            Ok(stream) => Ok((name, stream)),
            Err(failure) => Err(unwritable(&name, &failure)),
        };
        let streams = tables.into_iter().map(begin).collect::<Result<_, _>>()?;
        Ok(Self { rows, forms, streams })
    }

    fn put(&mut self, block: &RowBlock) -> Result<(), Diagnostic> {
        if let Some(row) = block.not_finite() {
            return Err(not_finite(&format!("pose {}", row + 1)));
        }
        self.streams
            .iter_mut()
            .try_for_each(|(name, stream)| stream.put(block).map_err(|failure| unwritable(name, &failure)))
    }

    fn finish(self) -> Result<(), Diagnostic> {
        let end = |(name, stream): (String, Box<dyn Stream + 'a>)| {
            stream.finish().map_err(|failure| unwritable(&name, &failure))
        };
        self.streams.into_iter().try_for_each(end)
    }

    pub(crate) fn write(mut self, values: &[impl RowValues + Copy]) -> Result<(), Diagnostic> {
        let count = if self.streams.is_empty() { 0 } else { values.len() };
        for (k, block) in values[..count].chunks(BLOCK).enumerate() {
            let first = k * BLOCK;
            let rows = self.rows;
            let pairs = block.iter().enumerate().map(|(i, values)| (rows.poses.get(first + i), *values));
            let block = rows.prepare(&self.forms, first, pairs);
            self.put(&block)?;
        }
        self.finish()
    }

    /// Surveys a field and writes its rows as they come: the deviations are not kept.
    pub(crate) fn survey(mut self, call: &mut Call<'_>, task: SurveyTask<'_>) -> Result<Survey, Refused> {
        if self.streams.is_empty() {
            return call.stage("poses", task.poses.len(), |advance| survey(task, advance));
        }
        let (rows, forms) = (self.rows, self.forms.clone());
        let make = |block: SurveyBlock<'_>| rows.prepare(&forms, block.first, block.rows());
        let mut failure = None;
        let mut put = |block: RowBlock| {
            failure = self.put(&block).err();
            failure.is_none()
        };
        let survey =
            call.stage("poses", task.poses.len(), |advance| survey_with_rows(task, &make, &mut put, advance))?;
        failure.map_or(Ok(()), Err).and_then(|()| self.finish()).or_else(|refusal| call.refuse(refusal))?;
        survey.ok_or(Refused)
    }
}

fn unwritable(name: &str, failure: &std::io::Error) -> Diagnostic {
    let help = "name a file in a folder that exists and that you may write to; nothing was written";
    Diagnostic::new(codes::E0810, format!("cannot write `{name}`: {failure}")).help(help)
}
