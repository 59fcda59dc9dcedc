//! The values of options that name one of a few choices.

use clap::ValueEnum;
use impinge::clash::Grouping;

/// Values of `--group`.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum GroupingArgument {
    /// By the part that most clashes share
    Part,
    /// By the types of both parts
    Type,
    /// By the scenes of both parts
    Scene,
    /// Not at all
    None,
}

/// Values of `--bcf-version`.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum BcfVersionArgument {
    #[value(name = "2.1")]
    V2,
    #[value(name = "3.0")]
    V3,
}

impl From<GroupingArgument> for Grouping {
    fn from(by: GroupingArgument) -> Self {
        match by {
            GroupingArgument::Part => Self::Part,
            GroupingArgument::Type => Self::Type,
            GroupingArgument::Scene => Self::Scene,
            GroupingArgument::None => Self::None,
        }
    }
}
