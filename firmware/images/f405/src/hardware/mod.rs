//! A real board: the pins of one of the files here, and what is the same on all.

mod card;
mod flash;
mod motors;
#[cfg_attr(feature = "matek-f405-te", path = "matek_f405_te.rs")]
#[cfg_attr(not(feature = "matek-f405-te"), path = "speedybee_f405_v4.rs")]
mod pins;
mod range;
mod time;
mod usb;
mod wiring;

pub use card::{Background, LogSink};
pub use flash::ParameterFlash;
pub use motors::{Motor, Motors, stop_motors};
pub use range::RangePort;
pub use time::{Delay, Meter, delay, now, pulse};
pub use usb::Console;

use crate::telemetry;
use core::cell::RefCell;
use core::sync::atomic::{AtomicBool, Ordering};
use critical_section::Mutex;
use heapless::String;
use stm32f4xx_hal::otg_fs::USB;
use stm32f4xx_hal::pac;
use stm32f4xx_hal::spi::Spi;
use tautline_board::settings::Settings;
use tautline_board::slow::SlowDevices;
use tautline_firmware::param::Params;
use tautline_firmware::vehicle::StepOutput;
use tautline_hal_shim::battery::BatteryMonitor;
use tautline_hal_shim::parameters::ParameterStore;
use wiring::{BatteryCell, CurrentPin, VoltagePin};

/// The inertial sensor's bus.
pub type ImuBus = wiring::Device<Spi<pac::SPI1>>;
/// Barometer, rangefinder and battery on their buses.
pub type Devices =
    SlowDevices<stm32f4xx_hal::i2c::I2c<pac::I2C1>, RangePort, VoltagePin, CurrentPin>;

static BATTERY: BatteryCell = Mutex::new(RefCell::new(None));
static READY: AtomicBool = AtomicBool::new(false);

/// What lives for ever.
pub struct Memory {
    usb: usb::Memory,
    range: range::Memory,
    log: card::Memory,
}

impl Memory {
    pub const fn new() -> Self {
        Self { usb: usb::Memory::new(), range: range::Memory::new(), log: card::Memory::new() }
    }
}

/// Everything on the board.
pub struct Board {
    pub imu: ImuBus,
    pub motors: Motors,
    pub devices: Devices,
    pub flash: ParameterFlash,
    pub telemetry: Option<(telemetry::Port, crate::bytes::Into, crate::bytes::OutOf)>,
    pub console: Console,
    pub log: LogSink,
    pub background: Background,
    pub delay: Delay,
    pub meter: Meter,
    pub usb: Usb,
    pub listener: Listener,
    pub notice: Option<String<50>>,
}

/// Serves USB where there is a clock for it.
pub struct Usb(Option<usb::Port>);

impl Usb {
    pub fn serve(&mut self) {
        if let Some(port) = &mut self.0 {
            port.serve();
        }
    }
}

/// Listens to the rangefinder.
pub struct Listener(Option<range::Listener>);

impl Listener {
    pub fn serve(&mut self) {
        if let Some(listener) = &mut self.0 {
            listener.serve();
        }
    }
}

pub fn start(
    device: pac::Peripherals,
    core: rtic::export::Peripherals,
    memory: &'static mut telemetry::Memory,
    board_memory: &'static mut Memory,
) -> Board {
    // Before the clocks touch its register.
    let was_watchdog = device.RCC.csr().read().wdgrstf().bit();
    device.RCC.csr().modify(|_, w| w.rmvf().set_bit());
    // SAFETY: the one owner; what `wire` takes of the rest does not include it.
    let (rcc, source) = crate::clock::start(unsafe { pac::RCC::steal() });
    defmt::info!("clock: {}", source);
    let mut wired = pins::wire(device, rcc);
    critical_section::with(|cs| BATTERY.borrow(cs).replace(Some(wired.battery)));
    time::start(wired.timer, core.SYST, wired.watchdog, &mut wired.rcc);
    watch_supply(&wired.power, &wired.exti);

    let (usart, tx, rx) = wired.telemetry;
    let telemetry = telemetry::start(usart, (tx, rx), memory, &mut wired.rcc);
    let (listener, range) = range::start(wired.range, &mut board_memory.range, &mut wired.rcc);
    let (global, usb_device, clock, minus, plus) = wired.usb;
    let usb = USB::new((global, usb_device, clock), (minus, plus), &wired.rcc.clocks);
    let (port, console) = usb::start(usb, &mut board_memory.usb);
    let (log, background) = card::start(wired.card, &mut board_memory.log);
    let battery = BatteryMonitor::new(VoltagePin(&BATTERY), CurrentPin(&BATTERY));
    Board {
        imu: wired.imu,
        devices: SlowDevices::new(wired.i2c, range, battery),
        flash: ParameterFlash(wired.flash),
        telemetry,
        console,
        log,
        background,
        delay: Delay,
        meter: Meter,
        // Without the crystal USB's clock is off by too much.
        usb: Usb(port.filter(|_| source == crate::clock::Source::Crystal)),
        listener: Listener(listener),
        notice: was_watchdog.then(|| String::try_from("Reset: watchdog").unwrap_or_default()),
        motors: Motors { timers: wired.motors, rcc: wired.rcc },
    }
}

/// The board's own defaults.
pub fn defaults() -> Params {
    let mut params = Params::default();
    pins::defaults(&mut params);
    params
}

pub fn open_settings(flash: ParameterFlash) -> Option<Settings<ParameterFlash>> {
    let store = ParameterStore::try_new(flash, flash::RANGE).ok()?;
    Settings::load(store, defaults()).ok().map(|(settings, _)| settings)
}

/// Below 2.9 V the supply is going: the motors stop before the brown-out reset comes.
fn watch_supply(power: &pac::PWR, exti: &pac::EXTI) {
    const LINE: u32 = 1 << 16;
    // SAFETY: level 7 of eight; and the one line of the detector.
    power.cr().modify(|_, w| unsafe { w.pls().bits(7) }.pvde().set_bit());
    exti.rtsr().modify(|r, w| unsafe { w.bits(r.bits() | LINE) });
    exti.imr().modify(|r, w| unsafe { w.bits(r.bits() | LINE) });
}

/// The inertial sensor has a sample: its edge.
pub fn data_ready() {
    // SAFETY: writing ones clears the pending bits of the two lines that boards use.
    let exti = unsafe { pac::EXTI::steal() };
    exti.pr().write(|w| unsafe { w.bits(1 << 4 | 1 << 15) });
    time::saw_sample();
    READY.store(true, Ordering::Relaxed);
    rtic::pend(crate::app::FLIGHT);
}

/// Whether the inertial sensor has a sample since the last call.
pub fn take_ready() -> bool {
    READY.swap(false, Ordering::Relaxed)
}

/// After each step: whoever steps is alive.
pub fn stepped(_: &StepOutput) {
    time::feed();
}
