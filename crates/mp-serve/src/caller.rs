//! Whose requests are answered.

use hyper::HeaderMap;
use hyper::header::{HOST, HeaderName, ORIGIN};

/// Why a request with these headers is refused, or `None`.
///
/// The name in `Host` must be of this machine, or a name of somebody else has been pointed here (DNS
/// rebinding). The page that sends the request, `Origin`, must be our own.
pub(crate) fn refusal(headers: &HeaderMap, port: u16) -> Option<&'static str> {
    let own = |text: &str| text == format!("127.0.0.1:{port}") || text == format!("localhost:{port}");
    let Ok(Some(host)) = only(headers, HOST) else {
        return Some("The request must name its host once.");
    };
    if !own(host) {
        return Some("The request names another host: open the address as it was printed.");
    }
    match only(headers, ORIGIN) {
        Ok(None) => None,
        Ok(Some(origin)) if origin.strip_prefix("http://") == Some(host) => None,
        _ => Some("The request comes from another page."),
    }
}

/// The value of a header that may be given once, as text.
fn only(headers: &HeaderMap, name: HeaderName) -> Result<Option<&str>, ()> {
    let mut values = headers.get_all(name).iter();
    match (values.next(), values.next()) {
        (None, _) => Ok(None),
        (Some(value), None) => value.to_str().map(Some).map_err(|_| ()),
        _ => Err(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(given: &[(HeaderName, &str)]) -> bool {
        let headers = given.iter().map(|(name, value)| (name.clone(), value.parse().unwrap()));
        let mut map = HeaderMap::new();
        headers.for_each(|(name, value)| {
            map.append(name, value);
        });
        refusal(&map, 8080).is_some()
    }

    #[test]
    fn only_our_own_page_on_this_machine_is_answered() {
        assert!(!refused(&[(HOST, "127.0.0.1:8080")]));
        assert!(!refused(&[(HOST, "localhost:8080"), (ORIGIN, "http://localhost:8080")]));
        for host in ["", "localhost", "127.0.0.1:8081", "evil.example:8080", "127.0.0.1:8080.evil.example"] {
            assert!(refused(&[(HOST, host)]), "{host}");
        }
        let others = ["null", "", "http://127.0.0.1", "https://127.0.0.1:8080", "http://evil.example:8080"];
        for origin in others {
            assert!(refused(&[(HOST, "127.0.0.1:8080"), (ORIGIN, origin)]), "{origin}");
        }
        let own = (HOST, "127.0.0.1:8080");
        assert!(refused(&[]) && refused(&[own.clone(), own.clone()]));
        let origin = (ORIGIN, "http://127.0.0.1:8080");
        assert!(refused(&[own.clone(), origin.clone(), origin]));
        assert!(refused(&[own, (ORIGIN, "http://localhost:8080")]));
    }
}
