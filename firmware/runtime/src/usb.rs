//! MAVLink over USB: a serial port of the CDC class, served by its interrupt.

use crate::port::{Inward, Outward, Queued};
use heapless::spsc::{Consumer, Producer, Queue};
use usb_device::bus::{UsbBus, UsbBusAllocator};
use usb_device::device::{StringDescriptors, UsbDevice, UsbDeviceBuilder, UsbVidPid};
use usbd_serial::{SerialPort, USB_CLASS_CDC};

/// The pair that open hardware may share for serial ports.
const ID: UsbVidPid = UsbVidPid(0x16C0, 0x27DD);
const PACKET: usize = 64;

/// Memory of the queues: out has room for a parameter list in flight.
#[derive(Debug)]
pub struct Memory {
    out: Queue<u8, 2048>,
    inward: Queue<u8, 512>,
}

impl Memory {
    /// Empty.
    #[must_use]
    pub const fn new() -> Self {
        Self { out: Queue::new(), inward: Queue::new() }
    }
}

impl Default for Memory {
    fn default() -> Self {
        Self::new()
    }
}

/// The interrupt's side.
pub struct Usb<B: UsbBus + 'static> {
    device: UsbDevice<'static, B>,
    serial: SerialPort<'static, B>,
    out: Consumer<'static, u8>,
    inward: Producer<'static, u8>,
}

impl<B: UsbBus> Usb<B> {
    /// Interrupt's and task's side; `product` is what the board calls itself, `pend` pends the interrupt.
    pub fn new(
        bus: &'static UsbBusAllocator<B>,
        product: &'static str,
        memory: &'static mut Memory,
        pend: fn(),
    ) -> (Option<Self>, Queued) {
        let serial = SerialPort::new(bus);
        let texts = StringDescriptors::default().manufacturer("Tautline").product(product);
        let device = UsbDeviceBuilder::new(bus, ID).device_class(USB_CLASS_CDC).strings(&[texts]);
        let (into, out) = memory.out.split();
        let (inward, out_of) = memory.inward.split();
        let port = device.ok().map(|device| Self { device: device.build(), serial, out, inward });
        (port, Queued { out: Outward(into), inward: Inward(out_of), pend })
    }

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
