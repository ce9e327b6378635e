//! One number that tells whether two steps said the same.

use tautline_firmware::vehicle::StepOutput;

/// FNV-1a.
const BASIS: u32 = 0x811C_9DC5;
const PRIME: u32 = 0x0100_0193;

/// Over what leaves the vehicle (motors, winch, mode, failures) and what it believes (attitude, rate, place, tether), bit
/// by bit.
#[must_use]
pub fn fingerprint(out: &StepOutput) -> u32 {
    let mut hash = BASIS;
    let mut take = |bits: u32| {
        for byte in bits.to_le_bytes() {
            hash = (hash ^ u32::from(byte)).wrapping_mul(PRIME);
        }
    };
    let flags = u32::from(out.is_armed) | u32::from(out.is_armable) << 1;
    [out.mode.rule().custom_mode, out.failures, flags].into_iter().for_each(&mut take);
    let estimate = &out.estimate;
    let throttle = out.actuation.throttle.iter().copied();
    let believed = [estimate.height, estimate.climb, out.actuation.winch.tension];
    let attitude = estimate.attitude.quaternion();
    let rate = estimate.rate.0;
    let numbers = throttle.chain(believed).chain(attitude).chain(rate.iter().copied());
    numbers.for_each(|x| take(x.to_bits()));
    for place in [estimate.position, estimate.velocity].into_iter().flatten() {
        place.0.iter().for_each(|x| take(x.to_bits()));
    }
    if let Some(tether) = &estimate.tether {
        for x in [tether.elevation, tether.azimuth, tether.length, tether.tension] {
            take(x.to_bits());
        }
    }
    let texts = out.events.iter().flat_map(|event| event.text.bytes());
    texts.for_each(|byte| take(byte.into()));
    hash
}
