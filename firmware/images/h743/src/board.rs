//! Matek H743-SLIM V3: which pin is what, and the start of everything.
//!
//! Pins as ArduPilot's, Betaflight's and PX4's board files give them. The first inertial sensor's axes are parameters'
//! business: body = (-x, -y, z) of the chip, SENS_BOARD_ROT = 4. The second sensor is not read.

use crate::battery::{self, CurrentPin, VoltagePin};
use crate::card::SdCard;
use crate::flash::{self, ParameterFlash};
use crate::motors::Motors;
use crate::serial::{self, Rx, Tx};
use crate::time::{self, Delay};
use crate::{clock, usb};
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use embassy_stm32::Peri;
use embassy_stm32::flash::Flash;
use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::i2c::{self, I2c};
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::mode::Blocking;
use embassy_stm32::pac;
use embassy_stm32::peripherals;
use embassy_stm32::sdmmc::{self, Sdmmc};
use embassy_stm32::spi::{self, Spi};
use embassy_stm32::time::Hertz;
use embassy_stm32::usart::Uart;
use embassy_stm32::{bind_interrupts, interrupt};
use embedded_hal_bus::spi::ExclusiveDevice;
use heapless::String;
use heapless::spsc::Queue;
use synopsys_usb_otg::UsbBus;
use tautline_cortex::crash;
use tautline_firmware::param::Params;
use tautline_firmware::time::Micros;
use tautline_firmware::vehicle::StepOutput;
use tautline_hal_shim::battery::BatteryMonitor;
use tautline_hal_shim::parameters::ParameterStore;
use tautline_hal_shim::radio::crsf;
use tautline_runtime::port::{Inward, Queued};
use tautline_runtime::recorder::{self, CardWriter, LogQueue, RecorderEvent};
use tautline_runtime::serial::{Listener as Ear, Memory as SerialMemory, Serial};
use tautline_runtime::settings::Settings;
use tautline_runtime::slow::SlowDevices;
use tautline_runtime::{tasks, usb as port};
use usb_device::bus::UsbBusAllocator;

const NAME: &str = "Tautline Matek H743-SLIM V3";
const IMU_HZ: Hertz = Hertz(12_500_000);
const I2C_HZ: Hertz = Hertz(400_000);

bind_interrupts!(struct Bound {
    SDMMC1 => sdmmc::InterruptHandler<peripherals::SDMMC1>;
});

/// The inertial sensor's bus. Without a delay of its own it would panic when asked for one.
pub type ImuBus =
    ExclusiveDevice<Spi<'static, Blocking, spi::mode::Master>, Output<'static>, Delay>;
/// Barometer, rangefinder and battery on their buses.
pub type Devices = SlowDevices<I2c<'static, Blocking, i2c::Master>, Inward, VoltagePin, CurrentPin>;
/// Where the log goes.
pub type LogSink = LogQueue;
/// UART7's interrupt, and USART6's.
pub type Telemetry = Serial<Rx, Tx>;
/// USART2's interrupt: the rangefinder.
pub type Listener = Ear<Rx>;
/// USB's interrupt.
pub type Usb = port::Usb<UsbBus<usb::Usb>>;

static READY: AtomicBool = AtomicBool::new(false);
/// Outputs that found no room.
static LOST: AtomicU32 = AtomicU32::new(0);

/// What lives for ever.
pub struct Memory {
    endpoints: [u32; 512],
    bus: MaybeUninit<UsbBusAllocator<UsbBus<usb::Usb>>>,
    usb: port::Memory,
    telemetry: SerialMemory<1024, 512>,
    range: Queue<u8, 64>,
    radio: SerialMemory<128, 256>,
    card: MaybeUninit<Sdmmc<'static>>,
    /// Two fifths of a second of log.
    log: recorder::Memory<32_768>,
}

impl Memory {
    pub const fn new() -> Self {
        Self {
            endpoints: [0; 512],
            bus: MaybeUninit::uninit(),
            usb: port::Memory::new(),
            telemetry: SerialMemory::new(),
            range: Queue::new(),
            radio: SerialMemory::new(),
            card: MaybeUninit::uninit(),
            log: recorder::Memory::new(),
        }
    }
}

/// Everything on the board.
pub struct Board {
    pub imu: ImuBus,
    pub motors: Motors,
    pub devices: Devices,
    pub telemetry: Option<(Telemetry, Queued)>,
    pub console: Queued,
    pub log: LogSink,
    pub background: Background,
    pub delay: Delay,
    pub usb: Option<Usb>,
    pub listener: Option<Listener>,
    pub radio: Option<(Telemetry, Queued)>,
    pub notice: Option<String<50>>,
    pub watchdog: Peri<'static, peripherals::IWDG1>,
}

pub fn start(mut core: cortex_m::Peripherals, memory: &'static mut Memory) -> Board {
    // Before the clocks touch its register.
    let was_watchdog = pac::RCC.rsr().read().iwdg1rstf();
    pac::RCC.rsr().modify(|w| w.set_rmvf(true));
    let (p, source) = clock::start();
    defmt::info!("clock: {}", source);
    // Flash is slow; the data cache stays off, since the card's DMA does not look into it.
    core.SCB.enable_icache();
    let clocks = embassy_stm32::rcc::clocks(&p.RCC);
    let [sys, hclk] =
        [clocks.sys, clocks.hclk1].map(|clock| clock.to_hertz().map_or(0, |hertz| hertz.0));
    time::start(core.SYST, sys);
    watch_supply();

    let mut config = spi::Config::default();
    config.frequency = IMU_HZ;
    config.mode = spi::MODE_0;
    let bus = Spi::new_blocking(p.SPI1, p.PA5, p.PD7, p.PA6, config);
    let select = Output::new(p.PC15, Level::High, Speed::VeryHigh);
    let imu = match ExclusiveDevice::new(bus, select, Delay) {
        Ok(device) => device,
        Err(never) => match never {},
    };
    watch_edge();

    let mut config = i2c::Config::default();
    config.frequency = I2C_HZ;
    let barometer = I2c::new_blocking(p.I2C2, p.PB10, p.PB11, config);
    let (voltage, current) = battery::start(p.ADC1, p.PC0, p.PC1);

    let uart = Uart::new_blocking(p.UART7, p.PE7, p.PE8, serial::config()).ok();
    let telemetry = uart.map(|uart| {
        let (tx, rx) = uart.split();
        serial::listen(pac::UART7);
        let tx = Tx { tx, registers: pac::UART7 };
        Serial::new(rx, tx, &mut memory.telemetry, || rtic::pend(pac::Interrupt::UART7))
    });
    let uart = Uart::new_blocking(p.USART6, p.PC7, p.PC6, serial::at(crsf::BAUD)).ok();
    let radio = uart.map(|uart| {
        let (tx, rx) = uart.split();
        serial::listen(pac::USART6);
        let tx = Tx { tx, registers: pac::USART6 };
        Serial::new(rx, tx, &mut memory.radio, || rtic::pend(pac::Interrupt::USART6))
    });
    let (inward, range) = memory.range.split();
    let ear = Rx::new_blocking(p.USART2, p.PD6, serial::config()).ok();
    let listener = ear.map(|rx| {
        serial::listen(pac::USART2);
        Ear::new(rx, inward)
    });

    let core_usb = usb::Usb::new(p.PA11, p.PA12, hclk);
    let bus = memory.bus.write(UsbBus::new(core_usb, &mut memory.endpoints));
    let pend = || rtic::pend(pac::Interrupt::OTG_FS);
    let (usb, console) = port::Usb::new(bus, NAME, &mut memory.usb, pend);

    // Below every task: its handler only wakes who waits in the idle one.
    interrupt::SDMMC1.set_priority(Priority::P15);
    let card = memory.card.write(Sdmmc::new_4bit(
        p.SDMMC1,
        Bound,
        p.PC12,
        p.PD2,
        p.PC8,
        p.PC9,
        p.PC10,
        p.PC11,
        sdmmc::Config::default(),
    ));
    let (log, card) = memory.log.split(SdCard::new(card));
    let devices = SlowDevices::new(barometer, Inward(range), BatteryMonitor::new(voltage, current));
    Board {
        imu,
        motors: Motors { front: p.TIM3, rear: p.TIM5, pins: (p.PB0, p.PB1, p.PA0, p.PA1) },
        devices,
        telemetry,
        console,
        log,
        background: Background(card),
        delay: Delay,
        usb,
        listener,
        radio,
        notice: was_watchdog.then(|| String::try_from("Reset: watchdog").unwrap_or_default()),
        watchdog: p.IWDG1,
    }
}

/// Which part this is.
pub fn uid() -> u64 {
    let bytes = embassy_stm32::uid::uid();
    bytes.iter().fold(0, |sum: u64, byte| sum.wrapping_mul(257) ^ u64::from(*byte))
}

/// The board's own defaults.
pub fn defaults() -> Params {
    Params {
        board_rotation: 4.0,
        battery_divider: 11.0,
        battery_amps_per_volt: 40.0,
        ..Params::default()
    }
}

/// Parameters from flash; call it once.
pub fn open_settings() -> Option<Settings<ParameterFlash>> {
    // SAFETY: nobody else has it.
    let flash = ParameterFlash(Flash::new_blocking(unsafe { peripherals::FLASH::steal() }));
    let store = ParameterStore::try_new(flash, flash::RANGE).ok()?;
    Settings::load(store, defaults()).ok().map(|(settings, _)| settings)
}

/// Below 2.85 V the supply is going: the motors stop before the brown-out reset comes.
fn watch_supply() {
    const LINE: usize = 16;
    pac::PWR.cr1().modify(|w| {
        w.set_pls(6);
        w.set_pvde(true);
    });
    pac::EXTI.rtsr(0).modify(|w| w.set_line(LINE, true));
    pac::EXTI.imr(0).modify(|w| w.set_line(LINE, true));
}

const EDGE_LINE: usize = 2;

/// PB2 rises when the first inertial sensor has a sample.
fn watch_edge() {
    const PORT_B: u8 = 1;
    critical_section::with(|_| {
        pac::RCC.apb4enr().modify(|w| w.set_syscfgen(true));
    });
    pac::GPIOB.moder().modify(|w| w.set_moder(EDGE_LINE, pac::gpio::vals::Moder::INPUT));
    pac::GPIOB.pupdr().modify(|w| w.set_pupdr(EDGE_LINE, pac::gpio::vals::Pupdr::PULL_DOWN));
    pac::SYSCFG.exticr(0).modify(|w| w.set_exti(EDGE_LINE, PORT_B));
    pac::EXTI.rtsr(0).modify(|w| w.set_line(EDGE_LINE, true));
    pac::EXTI.imr(0).modify(|w| w.set_line(EDGE_LINE, true));
}

/// The inertial sensor has a sample: its edge.
pub fn data_ready() {
    pac::EXTI.pr(0).write(|w| w.set_line(EDGE_LINE, true));
    time::saw_sample();
    READY.store(true, Ordering::Relaxed);
    rtic::pend(crate::app::FLIGHT);
}

/// The board's part in the flight task.
pub struct Pace;

impl tasks::Pace for Pace {
    fn now(&mut self) -> Micros {
        time::now()
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
pub struct Background(CardWriter<SdCard>);

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
                Some(RecorderEvent::Began(number)) => defmt::info!("log {}", number),
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
