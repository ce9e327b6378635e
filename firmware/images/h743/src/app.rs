//! Vectors and priorities of the tasks, and what they share; as in the other family's image, whose crate this is not.

use crate::{board, motors};
use heapless::spsc::{Consumer, Producer, Queue};
use tautline_cortex::{crash, stack};
use tautline_firmware::mavlink::Identity;
use tautline_firmware::param::Params;
use tautline_firmware::vehicle::StepOutput;
use tautline_runtime::comms::Comms;
use tautline_runtime::crash::Cause;
use tautline_runtime::inbox::Inbox;
use tautline_runtime::inner_loop::InnerLoop;
use tautline_runtime::keys::KeyBox;
use tautline_runtime::port::{Inward, Port, Queued};
use tautline_runtime::radio::{self, Downlink, Receiver};
use tautline_runtime::settings::Settings;
use tautline_runtime::tasks::{self, OUTPUTS, PORTS};

/// What RTIC wants of a device.
pub mod device {
    pub use Interrupt as interrupt;
    pub use embassy_stm32::pac::{Interrupt, NVIC_PRIO_BITS};
}

/// The flight task has a vector of its own, which the data-ready edge or the timer pends.
pub const FLIGHT: device::Interrupt = device::Interrupt::FDCAN1_IT0;

#[rtic::app(device = crate::app::device, peripherals = false, dispatchers = [FDCAN1_IT1, FDCAN2_IT0])]
mod image {
    use super::*;

    #[shared]
    struct Shared {
        inbox: Inbox,
        params: Params,
        keys: KeyBox,
    }

    #[local]
    struct Local {
        flight: InnerLoop<board::ImuBus, motors::Motor>,
        pace: board::Pace,
        outputs_in: Producer<'static, StepOutput>,
        outputs_out: Consumer<'static, StepOutput>,
        comms: Comms<PORTS>,
        console: Queued,
        log: board::LogSink,
        telemetry: Option<Queued>,
        uart: Option<board::Telemetry>,
        devices: board::Devices,
        settings: Option<Settings<crate::flash::ParameterFlash>>,
        background: board::Background,
        usb: Option<board::Usb>,
        listener: Option<board::Listener>,
        radio_uart: Option<board::Telemetry>,
        receiver: Option<Receiver<Inward>>,
        downlink: Option<Downlink>,
    }

    #[init(local = [
        outputs: Queue<StepOutput, OUTPUTS> = Queue::new(),
        memory: board::Memory = board::Memory::new(),
    ])]
    fn init(cx: init::Context) -> (Shared, Local) {
        stack::paint();
        let record = crash::take();
        let mut board = board::start(cx.core, cx.local.memory);
        let settings = board::open_settings();
        let params = settings.as_ref().map_or_else(board::defaults, |s| *s.params());

        let motors = board.motors.run(&params);
        let mut flight = InnerLoop::new(board.imu, motors, params);
        if flight.set_up(&mut board.delay).is_err() {
            defmt::error!("inertial sensor: no set-up");
        }
        if board.devices.set_up(&mut board.delay).is_err() {
            defmt::warn!("barometer: no set-up");
        }
        let notice = record.text().or(board.notice);
        if let Some(notice) = &notice {
            defmt::error!("{}", notice.as_str());
        }
        let identity = Identity::new(board::uid(), env!("TAUTLINE_REVISION"));
        let kept = settings.as_ref().and_then(Settings::kept);
        let comms = Comms::new(params, identity, notice, kept);
        let (outputs_in, outputs_out) = cx.local.outputs.split();
        let (uart, telemetry) = board.telemetry.unzip();
        let (radio_uart, radio) = board.radio.unzip();
        let (receiver, downlink) = radio.map(radio::split).unzip();
        crate::time::guard(board.watchdog);
        (
            Shared { inbox: Inbox::default(), params, keys: KeyBox::default() },
            Local {
                flight,
                pace: board::Pace,
                outputs_in,
                outputs_out,
                comms,
                console: board.console,
                log: board.log,
                telemetry,
                uart,
                devices: board.devices,
                settings,
                background: board.background,
                usb: board.usb,
                listener: board.listener,
                radio_uart,
                receiver,
                downlink,
            },
        )
    }

    /// One inertial sample.
    #[task(binds = FDCAN1_IT0, priority = 5, local = [flight, pace, outputs_in], shared = [inbox, params])]
    fn flight(mut cx: flight::Context) {
        let local = cx.local;
        let shared = (&mut cx.shared.inbox, &mut cx.shared.params);
        tasks::flight(local.flight, local.pace, local.outputs_in, shared.0, shared.1);
        // Already waiting is as good.
        let _ = comms::spawn();
    }

    /// MAVLink and the log.
    #[task(priority = 2, local = [comms, outputs_out, console, log, telemetry, downlink], shared = [inbox, params, keys])]
    async fn comms(mut cx: comms::Context) {
        let local = cx.local;
        while let Some(out) = local.outputs_out.dequeue() {
            let inbox = &mut cx.shared.inbox;
            let kept = (&mut cx.shared.params, &mut cx.shared.keys);
            let ports: [&mut dyn Port; PORTS] = [local.console, local.telemetry];
            tasks::comms(local.comms, &out, ports, local.log, local.downlink, inbox, kept);
            if local.comms.is_to_reboot(&out) {
                cortex_m::peripheral::SCB::sys_reset();
            }
            let _ = devices::spawn(out.is_armed);
        }
    }

    /// Barometer, rangefinder, battery, radio; on the ground also parameters and signing key.
    #[task(priority = 1, local = [devices, receiver, settings], shared = [inbox, params, keys])]
    async fn devices(mut cx: devices::Context, is_armed: bool) {
        let (devices, radio, settings) = (cx.local.devices, cx.local.receiver, cx.local.settings);
        let at = (crate::time::now(), is_armed);
        let inbox = &mut cx.shared.inbox;
        let kept = (&mut cx.shared.params, &mut cx.shared.keys);
        let mut delay = crate::time::Delay;
        let stored = tasks::devices(devices, radio, settings, at, &mut delay, inbox, kept);
        if stored.is_err() {
            defmt::error!("parameters: not stored");
        }
    }

    #[task(binds = UART7, priority = 4, local = [uart])]
    fn uart(cx: uart::Context) {
        if let Some(port) = cx.local.uart {
            port.serve();
        }
    }

    /// Data-ready edge of the first inertial sensor.
    #[task(binds = EXTI2, priority = 6)]
    fn edge(_: edge::Context) {
        board::data_ready();
    }

    /// The millisecond timer: paces the flight task when the inertial sensor is silent.
    #[task(binds = SysTick, priority = 6)]
    fn pulse(_: pulse::Context) {
        crate::time::pulse();
    }

    #[task(binds = OTG_FS, priority = 3, local = [usb])]
    fn usb(cx: usb::Context) {
        if let Some(port) = cx.local.usb {
            port.serve();
        }
    }

    #[task(binds = USART2, priority = 4, local = [listener])]
    fn range(cx: range::Context) {
        if let Some(listener) = cx.local.listener {
            listener.serve();
        }
    }

    /// A pilot's receiver has a byte each 24 us: a step may take longer, and must not hold it up.
    #[task(binds = USART6, priority = 6, local = [radio_uart])]
    fn pilot(cx: pilot::Context) {
        if let Some(port) = cx.local.radio_uart {
            port.serve();
        }
    }

    /// The supply is going.
    #[task(binds = PVD_AVD, priority = 7)]
    fn brown_out(_: brown_out::Context) {
        crash::end(Cause::BrownOut, [0, 0], motors::stop)
    }

    #[idle(local = [background])]
    fn idle(cx: idle::Context) -> ! {
        cx.local.background.run()
    }
}
