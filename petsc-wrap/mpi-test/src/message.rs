//! Messages between the test program and its ranks: one line of JSON for each message.

use std::io::{self, BufRead, Write};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// Message to a rank.
#[derive(Debug, Serialize, Deserialize)]
pub enum Order {
    /// Run the test of this name.
    Run(String),
}

/// Message from a rank.
#[derive(Debug, Serialize, Deserialize)]
pub enum Report {
    /// The first message, which tells the rank's number.
    Ready {
        /// Number of the rank.
        rank: usize,
    },
    /// The test has passed on this rank.
    Passed {
        /// Processor time used by the test, s.
        processor: f64,
    },
    /// The test has panicked on this rank, which ends.
    Failed {
        /// The panic's message.
        message: String,
    },
}

/// Sends a message.
pub fn send(message: &impl Serialize, to: &mut impl Write) -> io::Result<()> {
    let mut line = serde_json::to_string(message)?;
    line.push('\n');
    to.write_all(line.as_bytes())?;
    to.flush()
}

/// Waits for a message; returns `None` at the end of the connection.
pub fn receive<M: DeserializeOwned>(from: &mut impl BufRead) -> io::Result<Option<M>> {
    let mut line = String::new();
    if from.read_line(&mut line)? == 0 {
        return Ok(None);
    }
    Ok(Some(serde_json::from_str(&line)?))
}
