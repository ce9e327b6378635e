//! MAVLink over USB: a serial port of the CDC class, served by its interrupt.

use super::pins;
use crate::bytes::{Into, OutOf};
use core::mem::MaybeUninit;
use heapless::spsc::{Consumer, Producer, Queue};
use stm32f4xx_hal::otg_fs::{USB, UsbBus, UsbBusType};
use usb_device::bus::UsbBusAllocator;
use usb_device::device::{StringDescriptors, UsbDevice, UsbDeviceBuilder, UsbVidPid};
use usbd_serial::{SerialPort, USB_CLASS_CDC};

/// The pair that open hardware may share for serial ports.
const ID: UsbVidPid = UsbVidPid(0x16C0, 0x27DD);
const PACKET: usize = 64;

/// Lives for ever.
pub struct Memory {
    endpoints: [u32; 512],
    bus: MaybeUninit<UsbBusAllocator<UsbBusType>>,
    out: Queue<u8, 2048>,
    inward: Queue<u8, 512>,
}

impl Memory {
    pub const fn new() -> Self {
        Self {
            endpoints: [0; 512],
            bus: MaybeUninit::uninit(),
            out: Queue::new(),
            inward: Queue::new(),
        }
    }
}

/// The interrupt's side.
pub struct Port {
    device: UsbDevice<'static, UsbBusType>,
    serial: SerialPort<'static, UsbBusType>,
    out: Consumer<'static, u8>,
    inward: Producer<'static, u8>,
}

/// The task's side: MAVLink's first port.
pub struct Console {
    out: Into,
    inward: OutOf,
}

pub fn start(usb: USB, memory: &'static mut Memory) -> (Option<Port>, Console) {
    let bus = memory.bus.write(UsbBus::new(usb, &mut memory.endpoints));
    let serial = SerialPort::new(bus);
    let texts = StringDescriptors::default().manufacturer("Tautline").product(pins::NAME);
    let device = UsbDeviceBuilder::new(bus, ID).device_class(USB_CLASS_CDC).strings(&[texts]);
    let (into, from_task) = memory.out.split();
    let (to_task, out_of) = memory.inward.split();
    let port = device.ok().map(|device| Port {
        device: device.build(),
        serial,
        out: from_task,
        inward: to_task,
    });
    (port, Console { out: Into(into), inward: OutOf(out_of) })
}

impl Port {
    /// The interrupt.
    pub fn serve(&mut self) {
        self.device.poll(&mut [&mut self.serial]);
        let mut packet = [0; PACKET];
        if let Ok(count) = self.serial.read(&mut packet) {
            for &byte in packet.iter().take(count) {
                let _ = self.inward.enqueue(byte);
            }
        }
        while let Some(&byte) = self.out.peek() {
            match self.serial.write(&[byte]) {
                Ok(1) => {
                    let _ = self.out.dequeue();
                }
                _ => break,
            }
        }
        let _ = self.serial.flush();
    }
}

impl Console {
    pub fn take<'b>(&mut self, buffer: &'b mut [u8]) -> &'b [u8] {
        self.inward.take(buffer)
    }
    /// With nobody at the other end the queue fills and frames are left out.
    pub fn put(&mut self, frame: &[u8]) -> bool {
        self.out.put(frame)
    }
    pub fn flush(&mut self) {
        rtic::pend(stm32f4xx_hal::pac::Interrupt::OTG_FS);
    }
}
