//! Random names that nobody can guess.

use crate::ServeError;
use std::fmt;

/// 128 random bits of the operating system.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(crate) struct Token(String);

impl Token {
    pub(crate) fn random() -> Result<Self, ServeError> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes).map_err(|e| ServeError::Random { reason: e.to_string() })?;
        Ok(Self(bytes.iter().map(|byte| format!("{byte:02x}")).collect()))
    }

    /// As 32 hexadecimal digits.
    pub(crate) fn text(&self) -> &str {
        &self.0
    }

    /// Whether `given` is this token. The time does not tell how much of it is right.
    pub(crate) fn is(&self, given: &str) -> bool {
        let differences = self.0.bytes().zip(given.bytes()).fold(0, |sum, (a, b)| sum | (a ^ b));
        std::hint::black_box(differences) == 0 && self.0.len() == given.len()
    }
}

/// Without the digits: a log must not give a token away.
impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Token")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_whole_token_is_right() {
        let token = Token::random().unwrap();
        let text = token.text().to_owned();
        assert!(text.len() == 32 && token.is(&text));
        let mut other = text.clone();
        other.replace_range(31.., if text.ends_with('0') { "1" } else { "0" });
        for wrong in ["", &text[..31], &format!("{text}0"), &other, Token::random().unwrap().text()] {
            assert!(!token.is(wrong), "{wrong}");
        }
        assert_eq!(format!("{token:?}"), "Token");
    }
}
