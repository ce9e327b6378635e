//! A part behind I2C whose registers are bytes at addresses of one byte.

use embedded_hal::i2c::I2c;

/// The bus and where the part answers on it.
#[derive(Debug)]
pub(crate) struct Registers<I2C> {
    pub i2c: I2C,
    pub address: u8,
}

impl<I2C: I2c> Registers<I2C> {
    pub fn write(&mut self, register: u8, value: u8) -> Result<(), I2C::Error> {
        self.i2c.write(self.address, &[register, value])
    }

    pub fn read(&mut self, register: u8) -> Result<u8, I2C::Error> {
        let [value] = self.read_from(register)?;
        Ok(value)
    }

    /// `N` registers in a row.
    pub fn read_from<const N: usize>(&mut self, register: u8) -> Result<[u8; N], I2C::Error> {
        let mut bytes = [0; N];
        self.i2c.write_read(self.address, &[register], &mut bytes)?;
        Ok(bytes)
    }
}
