//! A real board: the pins of one of the files here, and what is the same on all.

mod flash;
mod motors;
#[cfg_attr(feature = "matek-f405-te", path = "matek_f405_te.rs")]
#[cfg_attr(not(feature = "matek-f405-te"), path = "speedybee_f405_v4.rs")]
mod pins;
mod radio;
mod range;
mod time;
mod wiring;

pub use flash::ParameterFlash;
pub use motors::{Motor, Motors, stop_motors};
pub use time::{Delay, delay, now, pulse};

use crate::telemetry;
use core::cell::RefCell;
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use critical_section::Mutex;
use embedded_sdmmc::SdCard;
use heapless::String;
use stm32f4xx_hal::otg_fs::{USB, UsbBus, UsbBusType};
use stm32f4xx_hal::pac;
use stm32f4xx_hal::spi::Spi;
use tautline_cortex::crash;
use tautline_firmware::param::Params;
use tautline_firmware::time::Micros;
use tautline_firmware::vehicle::StepOutput;
use tautline_hal_shim::battery::BatteryMonitor;
use tautline_hal_shim::parameters::ParameterStore;
use tautline_runtime::port::{Inward, Queued};
use tautline_runtime::recorder::{self, CardWriter, LogQueue, RecorderEvent};
use tautline_runtime::settings::Settings;
use tautline_runtime::slow::SlowDevices;
use tautline_runtime::{tasks, usb};
use wiring::{BatteryCell, CurrentPin, VoltagePin};

/// The inertial sensor's bus.
pub type ImuBus = wiring::Device<Spi<pac::SPI1>>;
/// Barometer, rangefinder and battery on their buses.
pub type Devices = SlowDevices<stm32f4xx_hal::i2c::I2c<pac::I2C1>, Inward, VoltagePin, CurrentPin>;
/// MAVLink's first port.
pub type Console = Queued;
/// Where the log goes.
pub type LogSink = LogQueue;
/// The interrupt's side of USB, where there is a clock for it.
pub type Usb = Option<usb::Usb<UsbBusType>>;
/// Listens to the rangefinder.
pub type Listener = Option<range::Listener>;
/// The interrupt's side of a pilot's receiver.
pub type RadioUart = radio::Port;

static BATTERY: BatteryCell = Mutex::new(RefCell::new(None));
static READY: AtomicBool = AtomicBool::new(false);
/// Outputs that found no room.
static LOST: AtomicU32 = AtomicU32::new(0);

/// What lives for ever.
pub struct Memory {
    endpoints: [u32; 512],
    bus: MaybeUninit<usb_device::bus::UsbBusAllocator<UsbBusType>>,
    usb: usb::Memory,
    range: range::Memory,
    radio: radio::Memory,
    /// A fifth of a second of log, and the header of a file, which is longer.
    log: recorder::Memory<16_384>,
}

impl Memory {
    pub const fn new() -> Self {
        Self {
            endpoints: [0; 512],
            bus: MaybeUninit::uninit(),
            usb: usb::Memory::new(),
            range: range::Memory::new(),
            radio: radio::Memory::new(),
            log: recorder::Memory::new(),
        }
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
    let bus = board_memory.bus.write(UsbBus::new(usb, &mut board_memory.endpoints));
    let pend = || rtic::pend(pac::Interrupt::OTG_FS);
    let (port, console) = usb::Usb::new(bus, pins::NAME, &mut board_memory.usb, pend);
    let (log, card) = board_memory.log.split(SdCard::new(wired.card, Delay));
    let battery = BatteryMonitor::new(VoltagePin(&BATTERY), CurrentPin(&BATTERY));
    Board {
        imu: wired.imu,
        devices: SlowDevices::new(wired.i2c, range, battery),
        flash: ParameterFlash(wired.flash),
        telemetry,
        console,
        log,
        background: Background(card),
        delay: Delay,
        pace: Pace,
        // Without the crystal USB's clock is off by too much.
        usb: port.filter(|_| source == crate::clock::Source::Crystal),
        listener,
        radio: radio::start(wired.radio, &mut board_memory.radio, &mut wired.rcc),
        notice: was_watchdog.then(|| String::try_from("Reset: watchdog").unwrap_or_default()),
        motors: Motors { timers: wired.motors, rcc: wired.rcc },
    }
}

/// Which part this is.
pub fn uid() -> u64 {
    let uid = stm32f4xx_hal::signature::Uid::get();
    let place = (u64::from(uid.x()) << 16) | u64::from(uid.y());
    uid.lot_num().bytes().fold(place, |sum, byte| sum.wrapping_mul(31) ^ u64::from(byte))
        ^ (u64::from(uid.waf_num()) << 56)
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

/// The board's part in the flight task. A step's cost is measured under emulation.
pub struct Pace;

impl tasks::Pace for Pace {
    fn now(&mut self) -> Micros {
        now()
    }
    fn take_ready(&mut self) -> bool {
        READY.swap(false, Ordering::Relaxed)
    }
    fn stepped(&mut self, out: &StepOutput) {
        crash::ARMED.store(out.is_armed, Ordering::Relaxed);
        time::feed();
    }
    fn lost(&mut self) {
        // Not told here: the logger may panic.
        LOST.store(LOST.load(Ordering::Relaxed).wrapping_add(1), Ordering::Relaxed);
    }
}

/// The card, when nothing else wants the processor.
pub struct Background(CardWriter<SdCard<wiring::Device<pins::CardSpi>, Delay>>);

impl Background {
    pub fn run(&mut self) -> ! {
        let mut told = 0;
        loop {
            let lost = LOST.load(Ordering::Relaxed);
            if lost != told {
                defmt::warn!("{} outputs found no room", lost.wrapping_sub(told));
                told = lost;
            }
            match self.0.serve() {
                Some(RecorderEvent::Began(number)) => {
                    pins::card_fast();
                    defmt::info!("log {}", number);
                }
                Some(RecorderEvent::NoCard) => defmt::warn!("no card, no log"),
                Some(RecorderEvent::Failed) => defmt::warn!("card: write failed, the log ends"),
                Some(RecorderEvent::Closed(false)) => {
                    defmt::warn!("card: the last file may lack its end")
                }
                Some(RecorderEvent::Closed(true)) | None => {}
            }
        }
    }
}
