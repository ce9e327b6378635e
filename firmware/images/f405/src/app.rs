//! Tasks and what they share.

use crate::{board, crash, telemetry};
use core::sync::atomic::Ordering;
use heapless::spsc::{Consumer, Producer, Queue};
use stm32f4xx_hal::pac;
use tautline_board::comms::Comms;
use tautline_board::flight::Flight;
use tautline_board::inbox::Inbox;
use tautline_board::settings::Settings;
use tautline_cortex::stack;
use tautline_firmware::param::Params;
use tautline_firmware::vehicle::StepOutput;

/// Steps that may wait for the communications task.
const OUTPUTS: usize = 5;
/// The flight task has a vector of its own, which the data-ready edge, the timer or an emulator pends.
pub const FLIGHT: pac::Interrupt = pac::Interrupt::CAN1_SCE;
/// MAVLink connections.
pub const CONSOLE: usize = 0;
/// USART1.
pub const UART: usize = 1;

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true, dispatchers = [CAN2_TX, CAN2_RX0])]
mod tasks {
    use super::*;

    #[shared]
    struct Shared {
        inbox: Inbox,
        params: Params,
    }

    #[local]
    struct Local {
        flight: Flight<board::ImuBus, board::Motor>,
        meter: board::Meter,
        outputs_in: Producer<'static, StepOutput>,
        outputs_out: Consumer<'static, StepOutput>,
        comms: Comms<2>,
        console: board::Console,
        log: board::LogSink,
        uart: Option<telemetry::Port>,
        uart_io: Option<(crate::bytes::Into, crate::bytes::OutOf)>,
        devices: board::Devices,
        settings: Option<Settings<board::ParameterFlash>>,
        background: board::Background,
        usb: board::Usb,
        listener: board::Listener,
    }

    #[init(local = [
        outputs: Queue<StepOutput, OUTPUTS> = Queue::new(),
        memory: telemetry::Memory = telemetry::Memory::new(),
        board_memory: board::Memory = board::Memory::new(),
    ])]
    fn init(cx: init::Context) -> (Shared, Local) {
        stack::paint();
        let record = crash::take();
        let mut board = board::start(cx.device, cx.core, cx.local.memory, cx.local.board_memory);
        let settings = board::open_settings(board.flash);
        let params = settings.as_ref().map_or_else(board::defaults, |s| *s.params());

        let motors = board.motors.run(&params);
        let mut flight = Flight::new(board.imu, motors, params);
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
        let (outputs_in, outputs_out) = cx.local.outputs.split();
        let (uart, uart_io) = match board.telemetry {
            Some((port, into, out_of)) => (Some(port), Some((into, out_of))),
            None => (None, None),
        };
        (
            Shared { inbox: Inbox::default(), params },
            Local {
                flight,
                meter: board.meter,
                outputs_in,
                outputs_out,
                comms: Comms::new(params, notice),
                console: board.console,
                log: board.log,
                uart,
                uart_io,
                devices: board.devices,
                settings,
                background: board.background,
                usb: board.usb,
                listener: board.listener,
            },
        )
    }

    /// One inertial sample.
    #[task(binds = CAN1_SCE, priority = 5, local = [flight, meter, outputs_in], shared = [inbox, params])]
    fn flight(mut cx: flight::Context) {
        let flight = cx.local.flight;
        let now = board::now();
        let imu = flight.read(now, board::take_ready());
        let mut input = cx.shared.inbox.lock(|inbox| inbox.take(now));
        input.sensors.imu = imu;
        cx.local.meter.begin();
        let out = flight.step(&input);
        cx.local.meter.end();
        flight.drive(&out);
        crash::ARMED.store(out.is_armed, Ordering::Relaxed);
        board::stepped(&out);
        if out.reply.is_some() {
            cx.shared.params.lock(|params| *params = *flight.vehicle.params());
        }
        if cx.local.outputs_in.enqueue(out).is_err() {
            cx.local.meter.lost();
        }
        // Already waiting is as good.
        let _ = comms::spawn();
    }

    /// MAVLink and the log.
    #[task(priority = 2, local = [comms, outputs_out, console, log, uart_io], shared = [inbox, params])]
    async fn comms(mut cx: comms::Context) {
        let comms = cx.local.comms;
        while let Some(out) = cx.local.outputs_out.dequeue() {
            let now = out.now;
            let mut buffer = [0; 64];
            if out.reply.is_some() {
                let params = cx.shared.params.lock(|params| *params);
                comms.set_params(&params);
            }
            loop {
                let bytes = cx.local.console.take(&mut buffer);
                if bytes.is_empty() {
                    break;
                }
                comms.receive(CONSOLE, now, bytes, &mut |frame| cx.local.console.put(frame));
            }
            comms.transmit(CONSOLE, &out, &mut |frame| cx.local.console.put(frame));
            if let Some((into, out_of)) = cx.local.uart_io {
                loop {
                    let bytes = out_of.take(&mut buffer);
                    if bytes.is_empty() {
                        break;
                    }
                    comms.receive(UART, now, bytes, &mut |frame| into.put(frame));
                }
                comms.transmit(UART, &out, &mut |frame| into.put(frame));
                rtic::pend(pac::Interrupt::USART1);
            }
            cx.local.console.flush();
            cx.shared.inbox.lock(|inbox| comms.collect(inbox));
            cx.local.log.write(comms, &out);
            let _ = devices::spawn(out.is_armed);
        }
    }

    /// Barometer, rangefinder, battery; on the ground also the parameters.
    #[task(priority = 1, local = [devices, settings], shared = [inbox, params])]
    async fn devices(mut cx: devices::Context, is_armed: bool) {
        let devices = cx.local.devices;
        let mut sensors = Default::default();
        devices.poll(board::now(), &mut sensors);
        cx.shared.inbox.lock(|inbox| inbox.put(&sensors));
        if is_armed {
            return;
        }
        if devices.wants_set_up() {
            devices.revive(&mut board::delay());
        }
        if let Some(settings) = cx.local.settings {
            let params = cx.shared.params.lock(|params| *params);
            if settings.store_next(&params).is_err() {
                defmt::error!("parameters: not stored");
                // Once; the flash is worn or the range is full, and it would say so every millisecond.
                *cx.local.settings = None;
            }
        }
    }

    #[task(binds = USART1, priority = 4, local = [uart])]
    fn uart(cx: uart::Context) {
        if let Some(port) = cx.local.uart {
            port.serve();
        }
    }

    /// Data-ready edges: pin 4 of a port on one board, pin 15 on another.
    #[task(binds = EXTI4, priority = 6)]
    fn edge_4(_: edge_4::Context) {
        board::data_ready();
    }

    #[task(binds = EXTI15_10, priority = 6)]
    fn edge_15(_: edge_15::Context) {
        board::data_ready();
    }

    /// The millisecond timer: paces the flight task when the inertial sensor is silent.
    #[task(binds = SysTick, priority = 6)]
    fn pulse(_: pulse::Context) {
        board::pulse();
    }

    #[task(binds = OTG_FS, priority = 3, local = [usb])]
    fn usb(cx: usb::Context) {
        cx.local.usb.serve();
    }

    #[task(binds = USART6, priority = 4, local = [listener])]
    fn range(cx: range::Context) {
        cx.local.listener.serve();
    }

    /// The supply is going.
    #[task(binds = PVD, priority = 7)]
    fn brown_out(_: brown_out::Context) {
        crash::end(tautline_board::crash::Cause::BrownOut, [0, 0])
    }

    #[idle(local = [background])]
    fn idle(cx: idle::Context) -> ! {
        cx.local.background.run()
    }
}
