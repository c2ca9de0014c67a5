//! Opening the browser, where there is one.

/// Where somebody would see a browser that this program opens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Screen {
    /// On this machine.
    Here,
    /// Behind an ssh connection.
    OverSsh,
    /// Nowhere: there is no display.
    None,
}

impl Screen {
    /// By the variables of the environment.
    pub(crate) fn find() -> Self {
        Self::by(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()))
    }

    fn by(is_set: impl Fn(&str) -> bool) -> Self {
        let needs_display = cfg!(all(unix, not(target_os = "macos")));
        if is_set("SSH_CONNECTION") || is_set("SSH_TTY") {
            Self::OverSsh
        } else if needs_display && !is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY") {
            Self::None
        } else {
            Self::Here
        }
    }
}

/// Opens an address in the browser of the user, and does not wait for it.
///
/// # Errors
/// When no program opens it: a sentence.
pub(crate) fn open(address: &str) -> Result<(), String> {
    ::open::that_detached(address).map_err(|e| format!("cannot open a browser: {e}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_browser_is_opened_only_where_it_is_seen() {
        let by = |set: &'static [&str]| Screen::by(|name| set.contains(&name));
        assert_eq!(by(&["DISPLAY", "SSH_CONNECTION"]), Screen::OverSsh);
        assert_eq!((by(&["DISPLAY"]), by(&["WAYLAND_DISPLAY"])), (Screen::Here, Screen::Here));
        if cfg!(target_os = "linux") {
            assert_eq!(by(&[]), Screen::None);
        }
    }
}
