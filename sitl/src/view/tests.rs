use super::{Ask, Snapshot, TRIALS, View};
use crate::flight::Flight;
use crate::scenario::{FaultSection, Scenario};
use serde_json::Value;
use std::io::{Read, Sink, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};
use tautline_firmware::supervisor::{GroundState, Mode};
use tungstenite::client::IntoClientRequest;
use tungstenite::http::HeaderValue;
use tungstenite::{Error, Message, WebSocket};

const HOLD: &str = "[[mission]]\ndo = \"arm\"\n[[mission]]\ndo = \"takeoff\"\naltitude = 5\n[[mission]]\ndo = \"hold\"\nseconds = 1000\n";

fn flight(toml: &str) -> (Scenario, Flight<Sink>) {
    let scenario = Scenario::parse(toml, "view.toml").unwrap();
    let flight = Flight::unrecorded(&scenario, scenario.params().unwrap(), 1).unwrap();
    (scenario, flight)
}

/// A flight, its server, and clients as browsers are.
struct Stage {
    flight: Flight<Sink>,
    view: View,
}

type Client = WebSocket<TcpStream>;

impl Stage {
    fn new() -> Self {
        let (scenario, flight) = flight("");
        Self { view: View::open(0, &scenario).unwrap(), flight }
    }

    fn address(&self) -> String {
        self.view.url().trim_start_matches("http://").trim_end_matches('/').to_owned()
    }

    fn connect(&self, headers: &[(&'static str, &str)]) -> Result<Client, Error> {
        let address = self.address();
        let mut request = format!("ws://{address}/ws").into_client_request()?;
        for (name, value) in headers {
            request.headers_mut().insert(*name, HeaderValue::from_str(value).unwrap());
        }
        let stream = TcpStream::connect(&address).unwrap();
        match tungstenite::client(request, stream) {
            Ok((socket, _)) => {
                socket.get_ref().set_read_timeout(Some(Duration::from_millis(1))).unwrap();
                Ok(socket)
            }
            Err(tungstenite::HandshakeError::Failure(e)) => Err(e),
            Err(tungstenite::HandshakeError::Interrupted(_)) => panic!("it blocks"),
        }
    }

    fn page(&self) -> Client {
        self.connect(&[("Origin", self.view.url().trim_end_matches('/'))]).unwrap()
    }

    /// The flight goes on, and the client listens, until a message is what it waits for.
    fn until(&mut self, client: &mut Client, mut is: impl FnMut(&Value) -> bool) -> Value {
        let began = Instant::now();
        while began.elapsed() < Duration::from_secs(20) {
            self.view.serve(&mut self.flight);
            for _ in 0..20 {
                self.flight.step(&mut |_| {});
            }
            match client.read() {
                Ok(Message::Text(text)) => {
                    let value: Value = serde_json::from_str(&text).unwrap();
                    if is(&value) {
                        return value;
                    }
                }
                Ok(other) => panic!("{other:?}"),
                Err(Error::Io(_)) => {}
                Err(e) => panic!("{e}"),
            }
        }
        panic!("it never came");
    }
}

fn say(client: &mut Client, text: &str) {
    client.send(Message::text(text)).unwrap();
}

fn is_note(message: &Value, part: &str) -> bool {
    message["type"] == "note" && message["text"].as_str().unwrap().contains(part)
}

/// Armed by this page, which has shown that it is there for a while.
fn armed(stage: &mut Stage, page: &mut Client) {
    say(page, r#"{"do":"beat"}"#);
    stage.until(page, |m| m["is_armable"] == true);
    say(page, r#"{"do":"arm"}"#);
    stage.until(page, |m| m["is_armed"] == true);
}

#[test]
fn a_page_sees_the_flight_arms_it_and_has_command() {
    let mut stage = Stage::new();
    let mut page = stage.page();
    let mut first = None;
    stage.until(&mut page, |m| {
        first.get_or_insert_with(|| m["type"].clone());
        m["type"] == "snapshot"
    });
    assert_eq!(first.unwrap(), "panel", "what there is comes before how it stands");
    armed(&mut stage, &mut page);
    assert_eq!(stage.flight.output().commander, Some(240));
    say(&mut page, r#"{"do":"takeoff","altitude_m":3}"#);
    let up = stage.until(&mut page, |m| m["truth"]["height_m"].as_f64() > Some(2.0));
    assert_eq!(up["mode"], "Takeoff");
}

#[test]
fn a_second_page_looks_and_is_refused_what_it_asks() {
    let mut stage = Stage::new();
    let (mut first, mut second) = (stage.page(), stage.page());
    armed(&mut stage, &mut first);
    for ask in [r#"{"do":"mode","name":"Descent"}"#, r#"{"do":"fault","kind":"imu_dead"}"#] {
        say(&mut second, ask);
        stage.until(&mut second, |m| is_note(m, "not now") || is_note(m, "has command"));
    }
    assert_eq!(stage.flight.output().mode, Mode::TetherHold);
    assert!(stage.flight.world.environment.active_faults().is_empty());
}

#[test]
fn sticks_arrive_as_a_joystick_and_faults_in_the_world() {
    let mut stage = Stage::new();
    let mut page = stage.page();
    say(&mut page, r#"{"do":"sticks","pitch":0.5,"roll":-0.25,"throttle":0.75,"yaw":0}"#);
    say(&mut page, r#"{"do":"fault","kind":"range_offset","value":1.5}"#);
    stage.until(&mut page, |m| m["faults"][0] == "range_offset");
    let sticks = stage.flight.world.links.iter_mut().find_map(|peer| peer.connection.sticks());
    let sticks = sticks.unwrap().value;
    let got = [sticks.pitch, sticks.roll, sticks.throttle];
    assert!(got.iter().zip([0.5, -0.25, 0.75]).all(|(a, b)| (a - b).abs() < 1e-3), "{got:?}");
    say(&mut page, r#"{"do":"clear"}"#);
    stage.until(&mut page, |m| m["faults"] == Value::Array(Vec::new()));
}

#[test]
fn nonsense_is_noted_and_the_talk_goes_on() {
    let mut stage = Stage::new();
    let mut page = stage.page();
    let long = format!(r#"{{"do":"mode","name":"{}"}}"#, "x".repeat(3000));
    for text in ["", "{", "[]", r#"{"do":"loop"}"#, r#"{"do":"takeoff","altitude_m":"x"}"#] {
        say(&mut page, text);
        stage.until(&mut page, |m| is_note(m, "not understood"));
    }
    for (text, answer) in [
        (r#"{"do":"fault","kind":"range_offset","value":1e9}"#, "a value from -100 to 100"),
        (r#"{"do":"fault","kind":"motor_stopped","motor":0}"#, "a motor from 1 to 8"),
        (long.as_str(), "no mode"),
    ] {
        say(&mut page, text);
        stage.until(&mut page, |m| is_note(m, answer));
    }
    assert!(!stage.flight.output().is_armed);
}

#[test]
fn only_pages_of_this_server_may_speak_to_the_flight() {
    let stage = Stage::new();
    let port = stage.address().rsplit_once(':').unwrap().1.to_owned();
    let status = |headers: &[(&'static str, &str)]| match stage.connect(headers) {
        Err(Error::Http(response)) => response.status().as_u16(),
        other => panic!("{other:?}"),
    };
    for origin in ["http://example.com", "null", "http://127.0.0.1:1", "https://localhost"] {
        assert_eq!(status(&[("Origin", origin)]), 403, "{origin}");
    }
    assert_eq!(status(&[("Host", &format!("example.com:{port}"))]), 403, "a name that points here");
    assert!(stage.connect(&[("Origin", &format!("http://localhost:{port}"))]).is_ok());
}

fn fetch(stage: &Stage, head: &str) -> String {
    let mut stream = TcpStream::connect(stage.address()).unwrap();
    write!(stream, "{head}\r\nHost: {}\r\n\r\n", stage.address()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

#[test]
fn the_page_is_served_whole_and_nothing_else() {
    let stage = Stage::new();
    let page = fetch(&stage, "GET / HTTP/1.1");
    assert!(page.starts_with("HTTP/1.1 200 OK"));
    assert!(page.contains("<title>Tautline</title>") && page.ends_with("</html>\n"));
    for (head, status) in [
        ("GET /../Cargo.toml HTTP/1.1", "404"),
        ("POST / HTTP/1.1", "405"),
        ("GET /ws HTTP/1.1", "426"),
        ("nonsense", "400"),
    ] {
        assert!(fetch(&stage, head).starts_with(&format!("HTTP/1.1 {status} ")), "{head}");
    }
}

#[test]
fn a_port_that_is_taken_is_named() {
    let stage = Stage::new();
    let port: u16 = stage.address().rsplit_once(':').unwrap().1.parse().unwrap();
    let why = View::open(port, &Scenario::default()).unwrap_err();
    assert!(why.starts_with(&format!("--view: TCP port {port}: ")), "{why}");
}

#[test]
fn a_chain_is_drawn_by_its_nodes_and_a_straight_line_by_its_ends() {
    let points = |toml: &str| {
        let (_, mut flight) = flight(toml);
        flight.step(&mut |_| {});
        let truth = Snapshot::of(&flight).truth.unwrap();
        let end = *truth.line_m.last()?;
        let apart = (0..3).map(|i| (end[i] - truth.position_m[i]).powi(2)).sum::<f64>().sqrt();
        assert!(apart < 0.2, "it ends at the vehicle: {apart} m");
        Some(truth.line_m.len())
    };
    assert_eq!(points("[tether]\nmodel = \"chain\"\nsegments = 7"), Some(8));
    assert_eq!(points(""), Some(2));
    assert_eq!(points("[tether]\nkind = \"none\"\n[capture]\nrate = 100"), None);
}

#[test]
fn every_trial_shows_its_row_in_a_hold() {
    let mut missed = Vec::new();
    for trial in TRIALS {
        let (_, mut flight) = flight(HOLD);
        let is_holding = |flight: &Flight<Sink>| {
            let out = flight.output();
            out.mode == Mode::TetherHold && out.ground == GroundState::InAir
        };
        while !is_holding(&flight) && flight.world.time() < 60.0 {
            flight.step(&mut |_| {});
        }
        let begins = flight.world.time() + 4.0;
        while flight.world.time() < begins {
            flight.step(&mut |_| {});
        }
        let time = flight.world.now().0 as f64 * 1e-6;
        flight.world.environment.faults.add(FaultSection {
            rotor: trial.motor,
            ..FaultSection::new(trial.kind, trial.value, time)
        });
        let is_shown = |f: &Flight<Sink>| f.output().failures & trial.failure.mask() != 0;
        while !is_shown(&flight) && flight.world.time() < begins + 60.0 {
            flight.step(&mut |_| {});
        }
        if !is_shown(&flight) {
            let texts: Vec<_> = flight.events.iter().map(|(_, event)| event.text).collect();
            missed.push(format!("{:?} by {:?}: {texts:?}", trial.failure, trial.kind));
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

#[test]
fn what_a_page_may_ask_for_is_spelled_as_the_tables_do() {
    let ask = Ask::parse(r#"{"do":"fault","kind":"motor_thrust","value":0.5,"motor":2}"#).unwrap();
    let Ask::Fault { kind, value, motor } = ask else { panic!("{ask:?}") };
    assert_eq!((kind.rule().name, value, motor), ("motor_thrust", 0.5, Some(2)));
}
