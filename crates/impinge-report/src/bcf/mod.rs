//! BCF files of clashes: issues that people open in their modeling program, discuss and settle.
//!
//! [`write_bcf`] writes one topic for each group of clashes, and one for each set of duplicates.
//! [`load_previous_bcf`] reads the statuses back. The files follow the BCF-XML standard of
//! buildingSMART, versions 2.1 and 3.0. The same report gives the same bytes.
//!
//! `topic` makes the topics, with their texts in `description` and `status`, in the coordinates of
//! `frame`. `markup`, `viewpoint` and `project` write the files of the archive with `xml`, dated by
//! `date`, and `archive` puts them together. `previous` reads an archive. `page` has the topics
//! for a page, which writes the same file with edited statuses. Guarded by
//! `tests/cli/clash_bcf.rs` of `impinge-cli`.

mod archive;
mod date;
mod description;
mod frame;
mod markup;
mod page;
mod previous;
mod project;
mod status;
mod topic;
mod version;
mod viewpoint;
mod xml;

pub use archive::{BcfOptions, write_bcf};
pub use previous::{BcfError, is_bcf, load_previous_bcf, parse_previous_bcf};
pub use version::BcfVersion;

pub(crate) use page::PageBcf;
