//! The words and numbers of a Gmsh file, as PETSc reads them: text, or binary between words.

/// No word of a Gmsh file is near as long; PETSc reads words into buffers of fixed size.
const LONGEST: usize = 1000;

/// A position in a file. Errors are messages that begin with the line, or the byte of a binary file.
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Where the last item began.
    start: usize,
    /// Whether numbers are binary, of this machine's (little-endian) byte order.
    pub binary: bool,
}

impl<'a> Words<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, start: 0, binary: false }
    }

    /// `what` is wrong with the last item.
    pub fn error<T>(&self, what: impl std::fmt::Display) -> Result<T, String> {
        let line = 1 + self.bytes[..self.start].iter().filter(|byte| **byte == b'\n').count();
        let place = if self.binary { format!("byte {}", self.start) } else { format!("line {line}") };
        Err(format!("{place}: {what}"))
    }

    /// The next word, which is text in a binary file too; with the blank behind it, where binary numbers may begin.
    pub fn word(&mut self) -> Result<&'a str, String> {
        let rest = &self.bytes[self.at..];
        let blanks = rest.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        let length = rest[blanks..].iter().take_while(|byte| !byte.is_ascii_whitespace()).count();
        self.start = self.at + blanks;
        if length == 0 {
            return self.error("the file ends too early: it is cut off");
        }
        self.at = self.bytes.len().min(self.start + length + 1);
        match std::str::from_utf8(&self.bytes[self.start..self.start + length]) {
            Ok(word) if length <= LONGEST => Ok(word),
            _ => self.error("this is no text of a Gmsh file"),
        }
    }

    /// The rest of the line.
    pub fn line(&mut self) -> Result<&'a str, String> {
        let length = self.bytes[self.at..].iter().take_while(|byte| **byte != b'\n').count();
        self.start = self.at;
        self.at = self.bytes.len().min(self.at + length + 1);
        match std::str::from_utf8(&self.bytes[self.start..self.start + length]) {
            Ok(line) if length <= LONGEST => Ok(line),
            _ => self.error("this is no text in UTF-8"),
        }
    }

    /// Exactly this word.
    pub fn expect(&mut self, word: &str) -> Result<(), String> {
        match self.word()? {
            found if found == word => Ok(()),
            found => self.error(format!("expected {word}, found {found:?}")),
        }
    }

    fn parsed<T: std::str::FromStr>(&mut self, kind: &str) -> Result<T, String> {
        let word = self.word()?;
        word.parse().or_else(|_| self.error(format!("expected {kind}, found {word:?}")))
    }

    fn raw<const N: usize>(&mut self) -> Result<[u8; N], String> {
        self.start = self.at;
        match self.bytes[self.at..].first_chunk() {
            Some(chunk) => {
                self.at += N;
                Ok(*chunk)
            }
            None => self.error("the file ends too early: it is cut off"),
        }
    }

    /// A whole number of 32 bits.
    pub fn int(&mut self) -> Result<i32, String> {
        if self.binary { self.raw().map(i32::from_le_bytes) } else { self.parsed("a whole number") }
    }

    /// A count, in words even where the file is binary.
    pub fn written_count(&mut self) -> Result<usize, String> {
        let count: i32 = self.parsed("a count")?;
        usize::try_from(count).or_else(|_| self.error(format!("{count} is not a count")))
    }

    /// A count or a number of a node, of 64 bits but of a value that 32 hold.
    pub fn size(&mut self) -> Result<usize, String> {
        if !self.binary {
            return self.written_count();
        }
        let size = self.raw().map(u64::from_le_bytes)?;
        i32::try_from(size).map(|size| size as usize).or_else(|_| self.error(format!("{size} is too large")))
    }

    /// A real number; it may be infinite or no number.
    pub fn real(&mut self) -> Result<f64, String> {
        if self.binary { self.raw().map(f64::from_le_bytes) } else { self.parsed("a number") }
    }
}
