//! What every fake behind I2C does with a transaction: a register's address, then bytes from or to it on.

use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource, Operation};

/// Registers behind an address.
pub(super) trait RegisterPart {
    /// Whether it answers there now.
    fn answers(&self, address: u8) -> bool;
    fn read(&mut self, register: u8) -> u8;
    fn write(&mut self, register: u8, value: u8);
    /// Where the part's pointer goes after `register`.
    fn next(&self, register: u8) -> u8 {
        register.wrapping_add(1)
    }
}

/// The bus of a fake; a blanket implementation of a foreign trait is not to be had.
macro_rules! on_i2c {
    ($part:ty) => {
        impl embedded_hal::i2c::ErrorType for $part {
            type Error = embedded_hal::i2c::ErrorKind;
        }

        impl embedded_hal::i2c::I2c for $part {
            fn transaction(
                &mut self,
                address: u8,
                operations: &mut [embedded_hal::i2c::Operation<'_>],
            ) -> Result<(), embedded_hal::i2c::ErrorKind> {
                crate::fake::registers::transact(self, address, operations)
            }
        }
    };
}
pub(super) use on_i2c;

/// One transaction with a part that answers or does not.
pub(super) fn transact(
    part: &mut impl RegisterPart,
    address: u8,
    operations: &mut [Operation<'_>],
) -> Result<(), ErrorKind> {
    if !part.answers(address) {
        return Err(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address));
    }
    let mut at: u8 = 0;
    for operation in operations {
        match operation {
            Operation::Write(bytes) => {
                let mut bytes = bytes.iter();
                at = bytes.next().copied().unwrap_or(at);
                for &byte in bytes {
                    part.write(at, byte);
                    at = part.next(at);
                }
            }
            Operation::Read(bytes) => {
                for byte in bytes.iter_mut() {
                    *byte = part.read(at);
                    at = part.next(at);
                }
            }
        }
    }
    Ok(())
}
