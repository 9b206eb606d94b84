//! The ledger: what was shown, of which sources, with which tools, and what its false twin did.

use std::fmt;
use std::fs;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::tools::ProveError;

/// How something was shown. The words are those a certificate may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Means {
    /// Bit-precise model checking of the compiled function: proved, with the bounds stated.
    ModelChecked,
    /// Every case of a stated domain was run on the compiled function: enumerated.
    Enumerated,
    /// Every state that a stated alphabet of events can reach was visited: proved to that depth.
    StateSpace,
    /// Mathematics over the reals, by two SMT solvers: lemma, not code.
    Lemma,
    /// Mathematics over intervals with outward rounding: lemma, not code.
    Intervals,
}

impl fmt::Display for Means {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::ModelChecked => "proved",
            Self::Enumerated => "enumerated",
            Self::StateSpace => "all sequences visited",
            Self::Lemma | Self::Intervals => "lemma",
        })
    }
}

/// What came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// It holds, it is not vacuous, and its false twin failed.
    Holds,
    /// It does not hold, or its twin does, or it is vacuous.
    Fails,
    /// No answer within time and memory. Not a pass.
    Unknown,
}

/// One proof.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Unique name, for instance `stop::a_latch_holds`.
    pub id: String,
    /// How it was shown.
    pub means: Means,
    /// What it says, one sentence.
    pub claim: String,
    /// Requirements it is evidence for.
    pub requirements: Vec<String>,
    /// File and line of the harness, from the root of the repository.
    pub place: String,
    /// Bounds and solver, or the domain.
    pub bounds: String,
    /// Kernel sources it speaks about, from the root of the repository.
    pub sources: Vec<String>,
    /// Hash of these sources, the harness and the bounds.
    pub hash: String,
    /// Tools that were used, with versions.
    pub tools: Vec<String>,
    /// What came out.
    pub verdict: Verdict,
    /// What the false twin did, or why there is no answer.
    pub twin: String,
    /// Conditions shown to be reachable, or cases run.
    pub reached: u64,
    /// Wall-clock time of all runs of this entry, whole seconds.
    pub seconds: u64,
}

/// All entries, sorted by name.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ledger {
    /// The entries.
    pub entries: Vec<Entry>,
}

impl Ledger {
    /// Reads a ledger; an absent file is an empty ledger.
    ///
    /// # Errors
    /// If the file cannot be read or is not a ledger.
    pub fn read(path: &Path) -> Result<Self, ProveError> {
        if !path.exists() {
            return Ok(Self::default());
        }
        let text = fs::read_to_string(path).map_err(|error| ProveError::file(path, error))?;
        serde_json::from_str(&text)
            .map_err(|error| ProveError::Words(format!("{}: {error}", path.display())))
    }

    /// Writes the ledger, sorted, one field a line.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&mut self, path: &Path) -> Result<(), ProveError> {
        self.entries.sort_by(|a, b| a.id.cmp(&b.id));
        let mut text = serde_json::to_string_pretty(self)
            .map_err(|error| ProveError::Words(error.to_string()))?;
        text.push('\n');
        fs::write(path, text).map_err(|error| ProveError::file(path, error))
    }

    /// The entry of this name.
    #[must_use]
    pub fn entry(&self, id: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.id == id)
    }

    /// Puts an entry in the place of the one of the same name.
    pub fn put(&mut self, entry: Entry) {
        self.entries.retain(|other| other.id != entry.id);
        self.entries.push(entry);
    }
}
