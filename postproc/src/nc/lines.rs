//! The lines of a program, as they are written.

use super::number;

/// Lines of a program, numbered where the dialect wants it.
#[derive(Debug, Default)]
pub(super) struct Lines {
    pub text: String,
    /// What stands before the number; `None`: no numbers.
    pub numbered: Option<&'static str>,
    pub next: u64,
    pub step: u64,
}

impl Lines {
    pub fn line(&mut self, words: &str) {
        if let Some(letter) = self.numbered {
            self.text.push_str(letter);
            number::push_whole(&mut self.text, self.next);
            self.text.push(' ');
            self.next += self.step;
        }
        self.plain(words);
    }

    /// A line without a number.
    pub fn plain(&mut self, words: &str) {
        self.text.push_str(words);
        self.text.push('\n');
    }
}
