//! What an image makes of the tasks: ports, shared resources, and what is left in flash when it is switched off.

use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use mavlink::dialects::common as mav;
use mavlink::{MavlinkVersion, MessageData};
use rtic_core::Mutex;
use std::cell::RefCell;
use std::rc::Rc;
use tautline_firmware::mavlink::{Identity, Parser};
use tautline_firmware::param::Params;
use tautline_firmware::sense::ImuScale;
use tautline_firmware::signal::Request;
use tautline_firmware::time::Micros;
use tautline_firmware::vehicle::{StepInput, StepOutput, Vehicle};
use tautline_hal_shim::battery::BatteryMonitor;
use tautline_hal_shim::fake::{FakeClock, FakeDps310, FakeFlash, FakePin, FakeTfMini, FlashError};
use tautline_hal_shim::parameters::ParameterStore;
use tautline_runtime::comms::{Comms, LogFile};
use tautline_runtime::inbox::Inbox;
use tautline_runtime::keys::KeyBox;
use tautline_runtime::port::{Inward, Port};
use tautline_runtime::radio::Receiver;
use tautline_runtime::recorder::Recorder;
use tautline_runtime::settings::Settings;
use tautline_runtime::slow::SlowDevices;
use tautline_runtime::tasks::{self, PORTS};
use tautline_sitl::flight::MavlinkSender;

/// Ports.
pub const USB: usize = 0;
pub const UART: usize = 1;

/// What outlives the board.
#[derive(Clone)]
pub struct Flash<const PAGE: usize, const WORD: usize> {
    pub chip: Rc<RefCell<FakeFlash<PAGE, WORD>>>,
    pub writes: Rc<RefCell<u32>>,
}

impl<const PAGE: usize, const WORD: usize> Flash<PAGE, WORD> {
    pub fn new() -> Self {
        let chip = Rc::new(RefCell::new(FakeFlash::new(3, 1)));
        Self { chip, writes: Rc::default() }
    }
}

impl<const PAGE: usize, const WORD: usize> ErrorType for Flash<PAGE, WORD> {
    type Error = FlashError;
}

impl<const PAGE: usize, const WORD: usize> ReadNorFlash for Flash<PAGE, WORD> {
    const READ_SIZE: usize = 1;
    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        self.chip.borrow_mut().read(offset, bytes)
    }
    fn capacity(&self) -> usize {
        self.chip.borrow().capacity()
    }
}

impl<const PAGE: usize, const WORD: usize> NorFlash for Flash<PAGE, WORD> {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = PAGE;
    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        self.chip.borrow_mut().erase(from, to)
    }
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        *self.writes.borrow_mut() += 1;
        self.chip.borrow_mut().write(offset, bytes)
    }
}

/// A resource that two tasks share, and only one runs.
struct Shared<T>(T);

impl<T> Mutex for Shared<T> {
    type T = T;
    fn lock<R>(&mut self, f: impl FnOnce(&mut T) -> R) -> R {
        f(&mut self.0)
    }
}

/// The vehicle's end of a wire.
#[derive(Default)]
struct Wire {
    inward: Vec<u8>,
    out: Vec<u8>,
}

impl Port for Wire {
    fn take<'b>(&mut self, buffer: &'b mut [u8]) -> &'b [u8] {
        let count = buffer.len().min(self.inward.len());
        for (slot, byte) in buffer.iter_mut().zip(self.inward.drain(..count)) {
            *slot = byte;
        }
        &buffer[..count]
    }
    fn put(&mut self, frame: &[u8]) -> bool {
        self.out.extend_from_slice(frame);
        true
    }
    fn flush(&mut self) {}
}

/// The log, in memory.
#[derive(Default)]
struct Log(Vec<u8>);

impl Recorder for Log {
    fn write<const PORTS: usize>(&mut self, comms: &mut Comms<PORTS>, out: &StepOutput) {
        let mut file = LogFile {
            has_room: true,
            begin: &mut || true,
            write: &mut |bytes| {
                self.0.extend_from_slice(bytes);
                true
            },
            end: &mut || {},
        };
        comms.log(out, &mut file);
    }
}

/// What was heard on a wire.
#[derive(Default)]
pub struct Heard {
    pub frames: Vec<(u32, Vec<u8>)>,
    /// Greatest time of a signature.
    pub latest: u64,
}

impl Heard {
    pub fn texts(&self) -> Vec<String> {
        let texts = self.frames.iter().filter(|(id, _)| *id == mav::STATUSTEXT_DATA::ID);
        let text = |payload: &[u8]| {
            let text = mav::STATUSTEXT_DATA::deser(MavlinkVersion::V2, payload).unwrap().text;
            text.to_str().unwrap().to_owned()
        };
        texts.map(|(_, payload)| text(payload)).collect()
    }

    pub fn count(&self, text: &str) -> usize {
        self.texts().iter().filter(|told| told.contains(text)).count()
    }

    /// Of the one command that was asked.
    pub fn acknowledged(&self) -> Option<u8> {
        let ack = self.frames.iter().find(|(id, _)| *id == mav::COMMAND_ACK_DATA::ID)?;
        Some(ack.1.get(2).copied().unwrap_or(0))
    }
}

/// A board that is on.
pub struct Board<const PAGE: usize, const WORD: usize> {
    comms: Comms<PORTS>,
    keys: Shared<KeyBox>,
    inbox: Shared<Inbox>,
    params: Shared<Params>,
    settings: Option<Settings<Flash<PAGE, WORD>>>,
    devices: SlowDevices<FakeDps310, FakeTfMini, FakePin, FakePin>,
    clock: FakeClock,
    wires: [Wire; PORTS],
    log: Log,
    out: StepOutput,
    pub is_armed: bool,
    /// The flash has failed: the power is gone.
    pub is_off: bool,
    /// What the flight task would get.
    pub requests: Vec<Request>,
    /// Length of a step, µs.
    pub step_us: u64,
}

impl<const PAGE: usize, const WORD: usize> Board<PAGE, WORD> {
    /// Switched on; `None` if the power goes before it is up.
    pub fn start(flash: &Flash<PAGE, WORD>) -> Option<Self> {
        let store = ParameterStore::try_new(flash.clone(), 0..3 * PAGE as u32).ok()?;
        let (settings, _) = Settings::load(store, Params::default()).ok()?;
        let params = *settings.params();
        let clock = FakeClock::default();
        let battery = BatteryMonitor::new(FakePin::default(), FakePin::default());
        let (barometer, range) = (FakeDps310::new(clock.clone()), FakeTfMini::new(clock.clone()));
        let scale = ImuScale { gyro: 1.065e-3, accel: 4.788e-3, rate_hz: 1000.0 };
        let out = *Vehicle::<f32>::new(params, scale).step(&StepInput::default());
        Some(Self {
            comms: Comms::new(params, Identity::default(), None, settings.kept()),
            keys: Shared(KeyBox::default()),
            inbox: Shared(Inbox::default()),
            params: Shared(params),
            settings: Some(settings),
            devices: SlowDevices::new(barometer, range, battery),
            clock,
            wires: Default::default(),
            log: Log::default(),
            out,
            is_armed: false,
            is_off: false,
            requests: Vec::new(),
            step_us: 1000,
        })
    }

    pub fn run(&mut self, steps: u32) {
        for _ in 0..steps {
            if self.is_off {
                return;
            }
            self.out.now = Micros(self.out.now.0 + self.step_us);
            self.out.is_armed = self.is_armed;
            let [usb, uart] = &mut self.wires;
            let inbox = &mut self.inbox;
            let (mut receiver, mut downlink) = (None::<Receiver<Inward>>, None);
            let ports: [&mut dyn Port; PORTS] = [usb, uart];
            let kept = (&mut self.params, &mut self.keys);
            let (comms, log) = (&mut self.comms, &mut self.log);
            tasks::comms(comms, &self.out, ports, log, &mut downlink, inbox, kept);
            self.requests.extend(inbox.0.take(self.out.now).request);
            let at = (self.out.now, self.is_armed);
            let (devices, settings) = (&mut self.devices, &mut self.settings);
            let mut delay = self.clock.clone();
            let kept = (&mut self.params, &mut self.keys);
            let stored =
                tasks::devices(devices, &mut receiver, settings, at, &mut delay, inbox, kept);
            self.is_off = stored.is_err();
        }
    }

    /// Bytes into a port; what comes out of it within 5 steps.
    pub fn say(&mut self, port: usize, bytes: &[u8]) -> Heard {
        self.listen(port);
        self.wires[port].inward.extend_from_slice(bytes);
        self.run(5);
        self.listen(port)
    }

    /// Whether a command comes through; without an answer it does not count.
    pub fn obeys(&mut self, port: usize, bytes: &[u8]) -> bool {
        self.requests.clear();
        self.say(port, bytes);
        !self.requests.is_empty()
    }

    /// What came out of a port since the last time.
    pub fn listen(&mut self, port: usize) -> Heard {
        let mut heard = Heard::default();
        Parser::new().push(&std::mem::take(&mut self.wires[port].out), |frame| {
            heard.frames.push((frame.id, frame.payload.to_vec()));
            let time = frame.signature.map_or(0, |signature| signature.timestamp);
            heard.latest = heard.latest.max(time);
        });
        heard
    }

    /// Everything that has left it by its ports since they were listened to, its log, and what a debugger would print.
    pub fn everything_told(&self) -> (Vec<u8>, String) {
        let wires = self.wires.iter().flat_map(|wire| wire.out.clone());
        let bytes = wires.chain(self.log.0.iter().copied()).collect();
        (bytes, format!("{:?}{:?}", self.comms, self.keys.0))
    }
}

/// A frame of the ground station.
pub fn frame<D: MessageData>(message: &D) -> Vec<u8> {
    MavlinkSender::new(255, 190).frame(message)
}

/// Take-off mode: any command that the flight task would get.
pub fn command() -> Vec<u8> {
    frame(&mav::COMMAND_LONG_DATA {
        command: mav::MavCmd::MAV_CMD_NAV_LAND,
        target_system: 1,
        target_component: 1,
        ..Default::default()
    })
}

/// A key to set.
pub fn set_up(secret_key: [u8; 32], initial_timestamp: u64) -> Vec<u8> {
    frame(&mav::SETUP_SIGNING_DATA {
        initial_timestamp,
        target_system: 1,
        target_component: 1,
        secret_key,
    })
}
