//! Lines of a text with the bytes where they begin; CR LF, LF and CR end a line, also mixed in one file.

/// The lines that are still to come.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lines<'a> {
    text: &'a str,
    offset: usize,
}

/// The lines of a text.
pub(crate) fn lines(text: &str) -> Lines<'_> {
    Lines { text, offset: 0 }
}

impl Lines<'_> {
    /// Where the next line begins.
    pub fn offset(&self) -> usize {
        self.offset
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a str);

    fn next(&mut self) -> Option<Self::Item> {
        let tail = self.text.get(self.offset..).filter(|tail| !tail.is_empty())?;
        let length = tail.find(['\r', '\n']).unwrap_or(tail.len());
        let ending = if tail[length..].starts_with("\r\n") { 2 } else { 1 };
        let line = (self.offset, &tail[..length]);
        self.offset += length + ending;
        Some(line)
    }
}
