//! A board whose devices a host plays: every bus asks by semihosting. The drivers above do not notice.

mod buses;
mod flash;
mod host;
mod meter;

pub use buses::{Delay, ImuBus, Motor, Pins, RangePort, SlowBus};
pub use flash::ParameterFlash;
pub use meter::Pace;

use crate::telemetry;
use core::sync::atomic::{AtomicBool, Ordering};
use heapless::String;
use stm32f4xx_hal::pac;
use stm32f4xx_hal::prelude::*;
use tautline_cortex::crash;
use tautline_firmware::param::Params;
use tautline_firmware::time::Micros;
use tautline_firmware::vehicle::StepOutput;
use tautline_hal_shim::battery::BatteryMonitor;
use tautline_hal_shim::motors::MotorOutputs;
use tautline_hal_shim::parameters::ParameterStore;
use tautline_runtime::comms::{Comms, LogFile};
use tautline_runtime::crash::Cause;
use tautline_runtime::inner_loop::protocol;
use tautline_runtime::port::{Port, Queued};
use tautline_runtime::recorder::Recorder;
use tautline_runtime::settings::Settings;
use tautline_runtime::slow::SlowDevices;
use tautline_runtime::wire::{Injury, OUTPUTS, Reply, Request};

/// Barometer, rangefinder and battery on their buses.
pub type Devices = SlowDevices<SlowBus, RangePort, Pins, Pins>;

/// None of them has anything to do.
pub type Usb = Option<Nobody>;
pub type Listener = Option<Nobody>;
pub type RadioUart = Nobody;

/// What the board needs for ever: nothing here.
pub struct Memory;

impl Memory {
    pub const fn new() -> Self {
        Self
    }
}

/// Everything on the board. Emulated and real differ in the types behind the names, not in the names.
pub struct Board {
    pub imu: ImuBus,
    pub motors: Motors,
    pub devices: Devices,
    pub flash: ParameterFlash,
    pub telemetry: Option<(telemetry::Port, Queued)>,
    pub console: Console,
    pub log: LogSink,
    pub background: Background,
    pub delay: Delay,
    pub pace: Pace,
    pub usb: Usb,
    pub listener: Listener,
    pub radio: Option<(RadioUart, Queued)>,
    pub notice: Option<String<50>>,
}

static READY: AtomicBool = AtomicBool::new(false);

pub fn start(
    device: pac::Peripherals,
    _core: rtic::export::Peripherals,
    memory: &'static mut telemetry::Memory,
    _: &'static mut Memory,
) -> Board {
    host::open();
    let (mut rcc, source) = crate::clock::start(device.RCC);
    defmt::info!("clock: {}", source);
    let gpioa = device.GPIOA.split(&mut rcc);
    Board {
        imu: ImuBus,
        motors: Motors,
        devices: SlowDevices::new(
            SlowBus,
            RangePort::default(),
            BatteryMonitor::new(Pins::Voltage, Pins::Current),
        ),
        flash: ParameterFlash,
        telemetry: telemetry::start(device.USART1, (gpioa.pa9, gpioa.pa10), memory, &mut rcc),
        console: Console,
        log: LogSink,
        background: Background,
        delay: Delay,
        pace: Pace::start(device.TIM2, &mut rcc),
        usb: None,
        listener: None,
        radio: None,
        notice: None,
    }
}

pub fn open_settings(flash: ParameterFlash) -> Option<Settings<ParameterFlash>> {
    let defaults = defaults();
    let store = ParameterStore::try_new(flash, flash::RANGE).ok()?;
    Settings::load(store, defaults).ok().map(|(settings, _)| settings)
}

/// None: no part is emulated that has one.
pub fn uid() -> u64 {
    0
}

/// The reference board's.
pub fn defaults() -> Params {
    Params::default()
}

/// The motors before anybody knows their protocol.
pub struct Motors;

impl Motors {
    pub fn run(self, params: &Params) -> MotorOutputs<Motor> {
        buses::set_stop(protocol(params));
        let channels = core::array::from_fn(Motor::new);
        match MotorOutputs::try_new(channels, protocol(params)) {
            Ok(outputs) => outputs,
            Err(never) => match never {},
        }
    }
}

/// The stop pulse on every motor, from any context.
pub fn stop_motors() {
    host::post(&Request::Motors([buses::stop(); OUTPUTS]));
}

pub fn now() -> Micros {
    Micros(host::now_us())
}

pub fn delay() -> Delay {
    Delay
}

/// Edges, timer, watchdog, USB and the rangefinder's UART have no part here.
pub fn data_ready() {}
pub fn pulse() {}

/// Nothing to serve.
pub struct Nobody;

impl Nobody {
    pub fn serve(&mut self) {}
}

/// MAVLink's second port; on a board this is USB.
pub struct Console;

impl Port for Console {
    fn take<'b>(&mut self, buffer: &'b mut [u8]) -> &'b [u8] {
        host::take_console(buffer)
    }
    fn put(&mut self, frame: &[u8]) -> bool {
        host::post(&Request::Console(frame));
        true
    }
    fn flush(&mut self) {}
}

/// The flight log goes to the host.
pub struct LogSink;

impl Recorder for LogSink {
    fn write<const PORTS: usize>(&mut self, comms: &mut Comms<PORTS>, out: &StepOutput) {
        let mut file = LogFile {
            has_room: true,
            begin: &mut || true,
            write: &mut |bytes| {
                for piece in bytes.chunks(512) {
                    host::post(&Request::Log(piece));
                }
                true
            },
            end: &mut || {},
        };
        comms.log(out, &mut file);
    }
}

/// Lockstep: a millisecond at the host, then whatever it causes.
pub struct Background;

impl Background {
    pub fn run(&mut self) -> ! {
        loop {
            match host::advance() {
                Some((is_ready, injury)) => {
                    match injury {
                        Some(Injury::HardFault) => fault(),
                        Some(Injury::Panic) => {
                            crash::end(Cause::Panic, [line!(), 0], stop_motors);
                        }
                        None => {}
                    }
                    READY.store(is_ready, Ordering::Relaxed);
                    rtic::pend(crate::app::FLIGHT);
                }
                None => {
                    Pace::report();
                    host::exit();
                }
            }
        }
    }
}

/// An access that no bus answers.
fn fault() {
    // SAFETY: it faults, which is what is wanted.
    unsafe { core::ptr::read_volatile(0xF000_0000 as *const u32) };
}

/// The reply is of another kind than the question: the host is not ours.
fn bytes_of<'r>(reply: Option<Reply<'r>>) -> Option<&'r [u8]> {
    match reply {
        Some(Reply::Bytes(bytes)) => Some(bytes),
        _ => None,
    }
}
