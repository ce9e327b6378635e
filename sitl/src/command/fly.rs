//! `cargo sitl [fly]`.

use super::Failure;
use super::console::Console;
use super::network::{Network, NetworkOptions};
use super::outcome;
use super::status::StatusLine;
use crate::flight::{Address, Autopilot, Flight, Physics, Progress, Shadow, World};
use crate::scenario::{Arithmetic, Scenario, TetherKind, set_param, standard_mission};
use crate::view::View;
use clap::Args;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use tautline_firmware::fixed::saturation;
use tautline_firmware::param::Params;

/// Network and pace are served every so many simulated milliseconds.
const CHUNK_MS: u64 = 4;
/// Of the page, where nobody names another one.
const VIEW_PORT: &str = "8765";

/// Options of a flight.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  cargo sitl fly --view\n  cargo sitl fly --speedup 5 --home 47.3977,8.5456,488,90 --param TET_TENSION=8
  cargo sitl fly --physics px4:127.0.0.1:4560 --headless"
)]
pub struct Options {
    /// No network and no status line; fly the scenario's mission (or a standard one) as fast as it goes
    #[arg(long)]
    headless: bool,
    /// Simulated per real seconds; 0 = as fast as it can
    #[arg(long, value_name = "N", value_parser = speedup)]
    speedup: Option<f64>,
    /// Anchor's latitude, longitude, altitude and the nose's heading, degrees and m
    #[arg(long, value_name = "LAT,LNG,ALT,YAW", value_parser = home, allow_hyphen_values = true)]
    home: Option<Home>,
    #[command(flatten)]
    network: NetworkOptions,
    /// Set a parameter (repeatable)
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    param: Vec<(String, f32)>,
    /// Parameters from a file of QGroundControl, Mission Planner or MAVProxy
    #[arg(long, value_name = "FILE")]
    params: Option<PathBuf>,
    /// What is simulated
    #[arg(long, value_name = "FILE.toml")]
    scenario: Option<PathBuf>,
    /// What the firmware computes with, if not what the scenario says
    #[arg(long, value_name = "TYPE")]
    scalar: Option<Arithmetic>,
    /// Fly in another simulator's physics: px4:HOST:PORT (PX4's interface) or json:PORT (ArduPilot's JSON)
    #[arg(long, value_name = "INTERFACE")]
    physics: Option<Address>,
    /// Serve a page on this machine that shows the flight and flies it, at a TCP port of 127.0.0.1
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = VIEW_PORT, value_parser = clap::value_parser!(u16).range(1..))]
    view: Option<u16>,
    /// Everything random follows from it
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// End after so many simulated seconds
    #[arg(long, value_name = "S", value_parser = duration)]
    duration: Option<f64>,
    /// Estimators that run beside, in the log: nothing flies on them
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    beside: Vec<Shadow>,
    /// Print the verdict, one JSON object, as the last line instead of the table
    #[arg(long)]
    json: bool,
    /// Where logs go
    #[arg(long, value_name = "DIR", default_value = "logs")]
    log_dir: PathBuf,
}

/// `--home`.
#[derive(Clone, Copy, Debug)]
struct Home {
    latitude: f32,
    longitude: f32,
    altitude: f32,
    heading: f64,
}

fn number(text: &str) -> Result<f64, String> {
    text.trim()
        .parse::<f64>()
        .ok()
        .filter(|x| x.is_finite())
        .ok_or(format!("{text} is not a number"))
}

fn speedup(text: &str) -> Result<f64, String> {
    let x = number(text)?;
    if (0.0..=10_000.0).contains(&x) { Ok(x) } else { Err("outside 0 to 10000".into()) }
}

fn duration(text: &str) -> Result<f64, String> {
    let x = number(text)?;
    if x > 0.0 && x <= 1e7 { Ok(x) } else { Err("outside 0 to 1e7 s".into()) }
}

fn home(text: &str) -> Result<Home, String> {
    let parts = text.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
    let [latitude, longitude, altitude, yaw] = parts.as_slice() else {
        return Err("expected four numbers: lat,lng,alt,yaw".into());
    };
    if yaw.abs() > 360.0 {
        return Err("yaw outside -360 to 360".into());
    }
    Ok(Home {
        latitude: *latitude as f32,
        longitude: *longitude as f32,
        altitude: *altitude as f32,
        heading: yaw.to_radians(),
    })
}

pub(super) fn assignment(text: &str) -> Result<(String, f32), String> {
    let (name, value) = text.split_once('=').ok_or("expected NAME=VALUE")?;
    Ok((name.to_owned(), number(value)? as f32))
}

fn set(params: &mut Params, name: &str, value: f32) -> Result<(), Failure> {
    set_param(params, name, value).map_err(Failure::Usage)
}

fn parameters(options: &Options, scenario: &Scenario) -> Result<Params, Failure> {
    let mut params = scenario.params().map_err(|e| Failure::Usage(e.0))?;
    if let Some(home) = &options.home {
        set(&mut params, "HOME_LAT", home.latitude)?;
        set(&mut params, "HOME_LON", home.longitude)?;
        set(&mut params, "HOME_ALT", home.altitude)?;
    }
    set(&mut params, "MAV_SYS_ID", f32::from(options.network.instance + 1))?;
    // A ground station's heartbeats come in real time: the silence that counts as loss grows with the
    // speed-up (PX4's SITL does the same).
    if let Some(factor) = options.speedup.filter(|&factor| factor > 1.0) {
        let scaled = (f64::from(params.link_loss_time) * factor).min(600.0);
        set(&mut params, "FS_LINK_T", scaled as f32)?;
    }
    if let Some(file) = &options.params {
        super::load_params(&mut params, file)?;
    }
    for (name, value) in &options.param {
        set(&mut params, name, *value)?;
    }
    Ok(params)
}

/// The next free name in the log folder.
fn log_path(folder: &Path) -> Result<PathBuf, Failure> {
    fs::create_dir_all(folder).map_err(|e| Failure::Usage(format!("{}: {e}", folder.display())))?;
    (1..100_000)
        .map(|n| folder.join(format!("flight-{n:04}.ulg")))
        .find(|path| !path.exists())
        .ok_or_else(|| Failure::Usage(format!("{}: too many logs", folder.display())))
}

fn describe(scenario: &Scenario, options: &Options, params: &Params) {
    let (v, t, w) = (&scenario.vehicle, &scenario.tether, &scenario.wind);
    if !scenario.title.is_empty() {
        say!("{}", scenario.title);
    }
    let tether = match t.kind {
        TetherKind::Winch => format!(
            "on a constant-tension winch, {} N, {} m paid out in flight",
            params.tension, params.tether_length
        ),
        TetherKind::Fixed => format!("on a fixed tether of {} m", t.length),
        TetherKind::Strut => format!("on a strut of {} m", t.length),
        TetherKind::Bar => format!("on a bar of {} m", t.length),
        TetherKind::None => "without a tether".into(),
    };
    let gusts = if w.gusts { " with Dryden gusts" } else { "" };
    say!(
        "Simulating a {} kg quadrotor {tether}; wind {} m/s{gusts}; seed {}.",
        v.mass,
        w.speed,
        options.seed
    );
}

/// Flies.
pub fn run(options: &Options) -> Result<(), Failure> {
    let mut scenario = match &options.scenario {
        Some(path) => Scenario::load(path).map_err(|e| Failure::Usage(e.0))?,
        None => Scenario::default(),
    };
    scenario.scalar = options.scalar.unwrap_or(scenario.scalar);
    if let Some(home) = &options.home {
        scenario.vehicle.heading = home.heading;
    }
    if options.headless && scenario.mission.is_empty() {
        scenario.mission = standard_mission();
    }
    let params = parameters(options, &scenario)?;
    for warning in scenario.contradictions(&params).map_err(|e| Failure::Usage(e.0))? {
        eprintln!("warning: {warning}");
    }
    let path = log_path(&options.log_dir)?;
    let file =
        File::create(&path).map_err(|e| Failure::Usage(format!("{}: {e}", path.display())))?;
    let log = BufWriter::with_capacity(1 << 16, file);
    let mut flight = Flight::beside(&scenario, params, options.seed, log, &options.beside)
        .map_err(|e| Failure::Run(e.0))?;
    let links = &mut flight.world.links;
    let open = || Network::open(&options.network, &options.log_dir, links);
    let mut network = (!options.headless).then(open).transpose()?;
    let open = |port| View::open(port, &scenario).map_err(Failure::Usage);
    let mut view = options.view.map(open).transpose()?;

    describe(&scenario, options, &params);
    connect(options, &mut flight)?;
    if let Some(network) = &network {
        let homes: Vec<_> = network.homes().iter().map(ToString::to_string).collect();
        say!(
            "MAVLink over UDP to {} (ground stations, then programs), system {}.",
            homes.join(" and "),
            params.system_id
        );
        say!("Connect QGroundControl, or: mavproxy.py --master=udp:127.0.0.1:14550. Ctrl-C ends.");
    }
    if let Some(view) = &view {
        say!("See and fly: {}", view.url());
    }
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    // Ctrl-C a second time would be lost without a handler; a failure to set one only costs the clean end.
    let _ = ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed));

    let began = Instant::now();
    simulate(options, &mut flight, (network.as_mut(), view.as_mut()), &stop)?;
    let physics = flight.world.environment.physics.as_ref();
    let failure = physics.and_then(Physics::failure).map(|why| Failure::Run(why.to_owned()));
    let finished = finish(options, flight, network, began, &path);
    failure.map_or(finished, Err)
}

/// With the other simulator, if one is asked for.
fn connect(options: &Options, flight: &mut Flight<BufWriter<File>>) -> Result<(), Failure> {
    let Some(address) = &options.physics else { return Ok(()) };
    say!("Physics comes from {address}.");
    let system = flight.world.vehicle.params().system_id as u8;
    let environment = &mut flight.world.environment;
    let physics = Physics::connect(address, system, &environment.plant).map_err(Failure::Run)?;
    environment.physics = Some(physics);
    Ok(())
}

/// The other simulator has failed.
fn has_failed(flight: &Flight<BufWriter<File>>) -> bool {
    flight.world.environment.physics.as_ref().is_some_and(|physics| physics.failure().is_some())
}

fn simulate(
    options: &Options,
    flight: &mut Flight<BufWriter<File>>,
    (mut network, mut view): (Option<&mut Network>, Option<&mut View>),
    stop: &AtomicBool,
) -> Result<(), Failure> {
    // Another simulator sets the pace.
    let is_watched = !options.headless || options.view.is_some();
    let is_paced = is_watched && options.physics.is_none();
    let factor = options.speedup.unwrap_or(if is_paced { 1.0 } else { 0.0 });
    let has_mission = *flight.mission.progress() == Progress::Flying;
    let mut status = StatusLine::new();
    let limit = options.duration.unwrap_or(f64::INFINITY);
    let began = Instant::now();
    // A flight that nobody watches ends to the millisecond, as a campaign's does: its figures are the same.
    let chunk = if options.headless { 1 } else { CHUNK_MS };
    let mut printed = 0;
    let console = (!options.headless).then(Console::open);
    while !stop.load(Ordering::Relaxed)
        && flight.world.time() < limit
        && !(has_mission && flight.is_over())
    {
        if has_failed(flight) {
            break;
        }
        if let Some(console) = &console {
            console.serve(flight, |line| status.print(line));
        }
        if let Some(network) = network.as_deref_mut() {
            network.receive(&mut flight.world.links);
        }
        if let Some(view) = view.as_deref_mut() {
            view.serve(flight);
        }
        for _ in 0..chunk {
            flight.step(&mut |_| {});
        }
        if let Some(network) = network.as_deref_mut() {
            network.send(&mut flight.world.links)?;
        }
        for (time, event) in flight.events.iter().skip(printed) {
            status.tell(*time, &event.to_string());
        }
        printed = flight.events.len();
        if let Some(why) = flight.log_trouble() {
            status.print(&format!("error: the log has ended: {why}"));
        }
        if !options.headless {
            status.show(&flight.world, flight.output());
        }
        if factor > 0.0 {
            let due = Duration::from_secs_f64(flight.world.time() / factor);
            if let Some(ahead) = due.checked_sub(began.elapsed()) {
                std::thread::sleep(ahead);
            }
        }
    }
    status.finish();
    Ok(())
}

fn finish(
    options: &Options,
    mut flight: Flight<BufWriter<File>>,
    network: Option<Network>,
    began: Instant,
    path: &Path,
) -> Result<(), Failure> {
    let (simulated, real) = (flight.world.time(), began.elapsed().as_secs_f64());
    say!("{simulated:.1} s simulated in {real:.1} s ({:.0} x).", simulated / real.max(1e-3));
    let unsent = match network {
        Some(network) => network.close(&flight.world.links)?,
        None => 0,
    };
    tell_traffic(&flight.world, unsent);
    if let Autopilot::Q16(_) = flight.world.vehicle {
        say!("Fixed point: {} operations saturated.", saturation::count());
    }
    let verdict = flight.verdict();
    if !options.json && flight.metrics.verdict.has_armed {
        say!("{}", outcome::table(&verdict));
    }
    let shortcoming = flight.shortcoming();
    let closed = flight.finish_log().map_err(|e| Failure::Run(format!("{}: {e}", path.display())));
    say!("Log: {}", path.display());
    if options.json {
        say!("{}", serde_json::to_string(&verdict).map_err(|e| Failure::Run(e.to_string()))?);
    }
    closed?;
    shortcoming.map_or(Ok(()), |why| Err(Failure::Run(why)))
}

/// MAVLink's traffic where there was any from outside, and what went wrong with it.
fn tell_traffic(world: &World, unsent: u64) {
    let counters = world.links.counters();
    let bad = [
        (u64::from(counters.bad_frames), "frames dropped"),
        (counters.garbage_bytes.into(), "bytes dropped"),
        (counters.refused.into(), "refused"),
        (counters.overflowed.into(), "queue overflows"),
        (world.links.dropped, "datagrams of too many peers, or too many of one, dropped"),
        (unsent, "datagrams not sent"),
    ];
    let bad: String =
        bad.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!(", {n} {what}")).collect();
    if counters.received > 0 || !bad.is_empty() {
        say!("MAVLink: {} received, {} sent{bad}.", counters.received, counters.sent);
    }
}
