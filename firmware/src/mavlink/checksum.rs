//! MAVLink's checksum, CRC-16/MCRF4XX, four bytes at a time.
//!
//! 2 KB of tables: the checksum of what comes in and goes out is most of what a frame costs.

/// Of one byte, and of one byte with one, two and three zeros behind it.
static TABLES: [[u16; 256]; 4] = tables();

#[expect(clippy::indexing_slicing, reason = "the compiler runs it")]
const fn tables() -> [[u16; 256]; 4] {
    const POLYNOMIAL: u16 = 0x8408;
    let mut tables = [[0; 256]; 4];
    let mut byte = 0;
    while byte < 256 {
        let mut crc = byte as u16;
        let mut bit = 0;
        while bit < 8 {
            crc = if crc & 1 == 0 { crc >> 1 } else { crc >> 1 ^ POLYNOMIAL };
            bit += 1;
        }
        tables[0][byte] = crc;
        byte += 1;
    }
    let mut zeros = 1;
    while zeros < 4 {
        byte = 0;
        while byte < 256 {
            let before: u16 = tables[zeros - 1][byte];
            tables[zeros][byte] = before >> 8 ^ tables[0][(before & 0xFF) as usize];
            byte += 1;
        }
        zeros += 1;
    }
    tables
}

/// Of `bytes` and the byte that stands for the message's definition.
pub fn checksum(bytes: &[u8], extra: u8) -> u16 {
    let [last, one, two, three] = &TABLES;
    // An index of one byte is in any table: the compiler drops the check.
    let of = |table: &[u16; 256], byte: u8| table.get(usize::from(byte)).copied().unwrap_or(0);
    let step = |crc: u16, byte: u8| {
        let [low, _] = crc.to_le_bytes();
        crc >> 8 ^ of(last, low ^ byte)
    };
    let (fours, rest) = bytes.as_chunks::<4>();
    let crc = fours.iter().fold(0xFFFF_u16, |crc, [a, b, c, d]| {
        let [low, high] = crc.to_le_bytes();
        of(three, low ^ a) ^ of(two, high ^ b) ^ of(one, *c) ^ of(last, *d)
    });
    step(rest.iter().fold(crc, |crc, byte| step(crc, *byte)), extra)
}

/// CRC-32 as MAVLink FTP and ground stations compute it, continued from `crc`; it begins at zero.
#[must_use]
pub fn crc32(crc: u32, bytes: &[u8]) -> u32 {
    const POLYNOMIAL: u32 = 0xEDB8_8320;
    bytes.iter().fold(crc, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ (POLYNOMIAL & (crc & 1).wrapping_neg())
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn it_is_the_published_one() {
        // The catalogue's check value is that of "123456789".
        assert_eq!(checksum(b"12345678", b'9'), 0x6F91);
    }

    #[test]
    fn it_agrees_with_the_crate_at_any_length() {
        let bytes: Vec<u8> = (0..=255_u8).map(|i| i.wrapping_mul(97) ^ 0x5A).collect();
        for length in 0..bytes.len() {
            let bytes = bytes.get(..length).unwrap();
            assert_eq!(checksum(bytes, 39), mavlink::calculate_crc(bytes, 39), "{length}");
        }
    }
}
