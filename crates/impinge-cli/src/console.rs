//! Output to standard output and standard error.
//!
//! Colors are printed only on terminals, and not if `NO_COLOR` is set. A reader that closes the
//! pipe early (`impinge ... | head`) causes no error and does not change the exit code.

use std::io::{self, Write};
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use anstyle::{AnsiColor, Style};
use serde::Serialize;

use crate::NO_ANSWER;
use crate::failure::Failure;
use crate::output;

/// Whether printing the answer has begun. An interrupt after that prints nothing on standard
/// output.
static ANSWER_PRINTED: AtomicBool = AtomicBool::new(false);

/// Prints the report or the JSON object on standard output.
///
/// # Errors
/// Returns an error if standard output cannot be written, except if its reader has closed it.
pub(crate) fn print_answer(report: &str) -> Result<(), Failure> {
    ANSWER_PRINTED.store(true, Ordering::SeqCst);
    let mut stdout = anstream::stdout().lock();
    match stdout.write_all(report.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::from_io(&error, "the report cannot be written to standard output"))
        }
        _ => Ok(()),
    }
}

/// Prints a failure on standard error and, if `json` is set and no answer was printed, as JSON on
/// standard output.
pub(crate) fn print_failure(failure: &Failure, json: bool) {
    print_line(&failure.to_string());
    if json && !ANSWER_PRINTED.load(Ordering::SeqCst) {
        // Ignore an error: the exit code stays the same.
        let _ = print_answer(&to_line(&NoAnswer { error: failure, complete: None }));
    }
}

/// Installs a handler that ends the process with exit code 2 on an interrupt.
pub(crate) fn exit_on_interrupt(json: bool) {
    // If no handler can be installed, an interrupt still ends the process, but without a message.
    let _ = ctrlc::set_handler(move || {
        exit_without_answer(&Failure::new("interrupted", "interrupted before the answer was known"), json);
        output::abandon();
        process::exit(i32::from(NO_ANSWER));
    });
}

/// Ends the process with exit code 2, for a reason that is printed. Does nothing once printing the
/// answer has begun.
pub(crate) fn exit_without_answer(failure: &Failure, json: bool) {
    if ANSWER_PRINTED.load(Ordering::SeqCst) {
        return;
    }
    print_line(&failure.to_string());
    if json {
        let _ = print_answer(&to_line(&NoAnswer { error: failure, complete: Some(false) }));
    }
    output::abandon();
    process::exit(i32::from(NO_ANSWER));
}

/// Prints a warning on standard error: something that may make the answer wrong.
pub(crate) fn warn(message: &str) {
    let style = Style::new().bold().fg_color(Some(AnsiColor::Yellow.into()));
    print_line(&format!("{style}warning{style:#}: {message}"));
}

/// Prints a note on standard error: an action taken, or a hint.
pub(crate) fn note(message: &str) {
    let style = Style::new().bold();
    print_line(&format!("{style}note{style:#}: {message}"));
}

/// Returns the value as one line of JSON, with a line end.
pub(crate) fn to_line(value: &impl Serialize) -> String {
    // Structs of text and finite numbers always serialize.
    serde_json::to_string(value).unwrap_or_default() + "\n"
}

#[derive(Serialize)]
struct NoAnswer<'a> {
    error: &'a Failure,
    #[serde(skip_serializing_if = "Option::is_none")]
    complete: Option<bool>,
}

fn print_line(line: &str) {
    // Ignore a closed standard error: there is no other place for messages.
    let _ = writeln!(anstream::stderr(), "{line}");
}
