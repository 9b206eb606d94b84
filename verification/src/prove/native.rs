//! Checks that run every case of a stated domain on the compiled kernel.

use std::path::Path;

use super::check::{Blank, Check, Job, blank};
use super::ledger::Means;
use super::sources::kernel_files;
use super::tools::ProveError;
use crate::enumerate;

/// One enumeration.
#[derive(Clone, Copy, Debug)]
pub struct Enumeration {
    /// Unique name.
    pub id: &'static str,
    /// How it is shown.
    pub means: Means,
    /// What holds, one sentence.
    pub claim: &'static str,
    /// Requirements it is evidence for.
    pub requirements: &'static [&'static str],
    /// Every case of this domain is run.
    pub domain: &'static str,
    /// File of the function, from the root of the repository.
    pub file: &'static str,
    /// Runs all cases and counts them; with `true` it checks a falsehood and must fail.
    ///
    /// The error is the first case that does not hold.
    pub run: fn(bool) -> Result<u64, String>,
}

pub(super) fn checks(root: &Path) -> Result<Vec<Check>, ProveError> {
    enumerate::all()
        .into_iter()
        .map(|found| {
            let file = root.join(found.file);
            let entry = blank(
                root,
                Blank {
                    id: found.id.to_owned(),
                    means: found.means,
                    claim: found.claim.to_owned(),
                    requirements: found.requirements.iter().map(|&id| id.to_owned()).collect(),
                    place: format!("{}:1", found.file),
                    bounds: found.domain.to_owned(),
                    own: vec![file.clone()],
                    kernel: kernel_files(root, &file)?,
                },
            )?;
            Ok(Check {
                entry,
                job: Job::Native(found.run),
            })
        })
        .collect()
}
