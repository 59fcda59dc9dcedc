//! The two streams of the command, and its one last word.
//!
//! Colours reach terminals alone, and not where `NO_COLOR` is set. A reader that leaves early (`impinge ... | head`) is
//! no error, and takes nothing from the exit code.

use std::io::{self, Write};
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use anstyle::{AnsiColor, Style};
use serde::Serialize;

use crate::NO_ANSWER;
use crate::failure::Failure;
use crate::output;

/// Whether the last word on standard output is being said: an interrupt from then on adds nothing to it.
static CONCLUDED: AtomicBool = AtomicBool::new(false);

/// Prints the report or the JSON.
///
/// # Errors
/// Where standard output cannot take it, unless nobody reads it any more.
pub(crate) fn conclude(report: &str) -> Result<(), Failure> {
    CONCLUDED.store(true, Ordering::SeqCst);
    let mut stdout = anstream::stdout().lock();
    match stdout.write_all(report.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::from_io(&error, "the report cannot be written to standard output"))
        }
        _ => Ok(()),
    }
}

/// Says why there is no answer.
pub(crate) fn conclude_with_failure(failure: &Failure, json: bool) {
    say(&failure.to_string());
    if json && !CONCLUDED.load(Ordering::SeqCst) {
        // Whether this is read or not, the exit code is the same.
        let _ = conclude(&to_line(&NoAnswer { error: failure, complete: None }));
    }
}

/// From here on, an interrupt ends the process with the exit code for "no answer".
pub(crate) fn conclude_when_interrupted(json: bool) {
    // Where there can be no handler, an interrupt still ends the process, without the last word.
    let _ = ctrlc::set_handler(move || {
        let failure = Failure::new("interrupted", "interrupted before the answer was known");
        if !CONCLUDED.load(Ordering::SeqCst) {
            say(&failure.to_string());
            if json {
                let _ = conclude(&to_line(&NoAnswer { error: &failure, complete: Some(false) }));
            }
        }
        output::abandon();
        process::exit(i32::from(NO_ANSWER));
    });
}

/// What a user should know before trusting the answer.
pub(crate) fn warn(what: &str) {
    let style = Style::new().bold().fg_color(Some(AnsiColor::Yellow.into()));
    say(&format!("{style}warning{style:#}: {what}"));
}

/// What was done, or is worth knowing.
pub(crate) fn note(what: &str) {
    let style = Style::new().bold();
    say(&format!("{style}note{style:#}: {what}"));
}

/// One line of JSON.
pub(crate) fn to_line(value: &impl Serialize) -> String {
    // Plain structs of text and finite numbers always serialise.
    serde_json::to_string(value).unwrap_or_default() + "\n"
}

#[derive(Serialize)]
struct NoAnswer<'a> {
    error: &'a Failure,
    #[serde(skip_serializing_if = "Option::is_none")]
    complete: Option<bool>,
}

fn say(line: &str) {
    // Where standard error is gone there is nobody to tell.
    let _ = writeln!(anstream::stderr(), "{line}");
}
