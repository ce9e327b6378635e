//! `--physics`: which interface, and where.

use std::fmt;
use std::str::FromStr;

/// Port on which PX4's simulators listen.
const PX4_PORT: u16 = 4560;
/// Port on which ArduPilot's JSON physics listens.
const JSON_PORT: u16 = 9002;

/// Where physics comes from, as HOST:PORT.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Address {
    /// PX4's simulator interface, over TCP.
    Px4(String),
    /// ArduPilot's JSON backend, over UDP.
    Json(String),
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Px4(at) => write!(f, "px4:{at}"),
            Self::Json(at) => write!(f, "json:{at}"),
        }
    }
}

impl FromStr for Address {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (kind, at) = text.split_once(':').unwrap_or((text, ""));
        let place = |default: u16| {
            if at.is_empty() {
                return Ok(format!("127.0.0.1:{default}"));
            }
            let (host, port) = at.rsplit_once(':').unwrap_or(("127.0.0.1", at));
            match port.parse::<u16>() {
                Ok(port) if port > 0 && !host.is_empty() => Ok(format!("{host}:{port}")),
                _ => Err(format!("{at} is not HOST:PORT")),
            }
        };
        match kind {
            "px4" => place(PX4_PORT).map(Self::Px4),
            "json" => place(JSON_PORT).map(Self::Json),
            _ => Err("expected px4:HOST:PORT or json:PORT".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn host_and_port_have_defaults_and_nonsense_is_refused() {
        let good = |text: &str| text.parse::<Address>().unwrap().to_string();
        assert_eq!(good("px4"), "px4:127.0.0.1:4560");
        assert_eq!(good("px4:10.0.0.2:4561"), "px4:10.0.0.2:4561");
        assert_eq!(good("json:9003"), "json:127.0.0.1:9003");
        assert_eq!(good("json:[::1]:9002"), "json:[::1]:9002");
        for bad in ["", "gazebo:1", "px4:host", "json:0", "json:70000", "px4::4560"] {
            assert!(bad.parse::<Address>().is_err(), "{bad}");
        }
    }
}
