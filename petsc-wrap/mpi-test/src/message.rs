//! What the test program and its ranks tell each other: one line of JSON a message.

use std::io::{self, BufRead, Write};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// To a rank.
#[derive(Debug, Serialize, Deserialize)]
pub enum Order {
    /// Run the test of this name.
    Run(String),
}

/// From a rank.
#[derive(Debug, Serialize, Deserialize)]
pub enum Report {
    /// The first message: which rank this is.
    Ready {
        /// Its number.
        rank: usize,
    },
    /// The test has passed on this rank.
    Passed {
        /// What it has taken of the processor, s.
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

/// Waits for a message; `None` at the end of the connection.
pub fn receive<M: DeserializeOwned>(from: &mut impl BufRead) -> io::Result<Option<M>> {
    let mut line = String::new();
    if from.read_line(&mut line)? == 0 {
        return Ok(None);
    }
    Ok(Some(serde_json::from_str(&line)?))
}
