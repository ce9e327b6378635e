//! Many worlds of one scenario, stepped together: those in free flight side by side in [`super::lanes`], the others one
//! by one. Each is the world that [`Plant::step`] would make of it, to the bit.

use super::lanes::{LANES, Lanes};
use super::{Plant, PlantModel, V3};
use pulp::{Arch, NullaryFnOnce};

/// Worlds of one model.
#[derive(Clone, Debug)]
pub struct PlantBatch {
    worlds: Vec<Plant>,
}

impl PlantBatch {
    /// Of worlds whose models are the same but for what was drawn.
    #[must_use]
    pub fn new(worlds: Vec<Plant>) -> Self {
        Self { worlds }
    }

    /// Each world.
    #[must_use]
    pub fn worlds(&self) -> &[Plant] {
        &self.worlds
    }

    /// Another world, of the same model, in the place of one; false: there is none.
    pub fn replace(&mut self, index: usize, world: Plant) -> bool {
        self.worlds.get_mut(index).map(|slot| *slot = world).is_some()
    }

    /// Parts that can be stepped at the same time, each of so many worlds, the last of fewer.
    pub fn parts(&mut self) -> (usize, Vec<PlantPart<'_>>) {
        let parts = self.worlds.chunks_mut(PART).map(|worlds| PlantPart { worlds }).collect();
        (PART, parts)
    }
}

/// Worlds of a part: a few blocks of lanes.
const PART: usize = 2 * LANES;

/// Some of a batch's worlds.
#[derive(Debug)]
pub struct PlantPart<'a> {
    worlds: &'a mut [Plant],
}

impl PlantPart<'_> {
    /// `ticks` ms with throttles, those of a world behind those of the world before, and the winches' tension, N.
    pub fn step(&mut self, throttle: &[f64], winch_tension: f64, ticks: u64) {
        let Some(rotors) = self.worlds.first().map(|world| world.rotors.len()) else { return };
        for (worlds, rows) in
            self.worlds.chunks_mut(LANES).zip(throttle.chunks(LANES * rotors.max(1)))
        {
            match rotors {
                4 => block(&mut Lanes::<4>::default(), worlds, rows, winch_tension, ticks),
                6 => block(&mut Lanes::<6>::default(), worlds, rows, winch_tension, ticks),
                8 => block(&mut Lanes::<8>::default(), worlds, rows, winch_tension, ticks),
                _ => one_by_one(worlds, rows, rotors, winch_tension, ticks),
            }
        }
    }
}

fn one_by_one(worlds: &mut [Plant], rows: &[f64], rotors: usize, tension: f64, ticks: u64) {
    for (world, row) in worlds.iter_mut().zip(rows.chunks(rotors.max(1))) {
        (0..ticks).for_each(|_| world.step(row, tension));
    }
}

/// A block's millisecond. A closure would not be built anew for each processor: the compiler may leave it apart.
struct Step<'a, const R: usize>(&'a mut Lanes<R>, &'a PlantModel);

impl<const R: usize> NullaryFnOnce for Step<'_, R> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.0.step(self.1);
    }
}

/// A block of lanes, with the widest instructions that this processor has.
fn block<const R: usize>(
    lanes: &mut Lanes<R>,
    worlds: &mut [Plant],
    rows: &[f64],
    winch_tension: f64,
    ticks: u64,
) {
    let arch = Arch::new();
    for _ in 0..ticks {
        let mut winds = [V3::zeros(); LANES];
        let mut flies = [false; LANES];
        let each = worlds.iter_mut().zip(rows.chunks(R)).zip(winds.iter_mut().zip(&mut flies));
        for (i, ((world, row), (wind, flies))) in each.enumerate() {
            *wind = world.begin_tick(row, winch_tension);
            *flies = lanes.load(i, world, wind);
        }
        if let Some(model) = worlds.first().map(|world| &world.model)
            && flies.contains(&true)
        {
            arch.dispatch(Step(lanes, model));
        }
        for (i, (world, (wind, flies))) in
            worlds.iter_mut().zip(winds.into_iter().zip(flies)).enumerate()
        {
            let stored = if flies { lanes.store(i, world) } else { None };
            let force = stored.unwrap_or_else(|| world.substeps(wind));
            world.end_tick(force);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::{PlantModel, generator, uniform};
    use crate::scenario::{Scenario, VehicleSection};

    fn scenario(edit: impl FnOnce(&mut Scenario)) -> Scenario {
        let mut scenario = Scenario::default();
        edit(&mut scenario);
        scenario
    }

    /// Worlds some of which stand on the ground, hang low, hang high, fly and tumble, or are at the end of their line.
    fn worlds(scenario: &Scenario, count: u64) -> Vec<Plant> {
        let (distance, heading) = scenario.start();
        let world = |seed: u64| {
            let mut rng = generator(seed, 77);
            let mut world = Plant::new(PlantModel::new(scenario, 0.4), distance, heading, seed);
            let mut random = |scale: f64| V3::from_fn(|_, _| scale * uniform(&mut rng));
            match seed % 5 {
                0 => return world,
                1 => world.hang(V3::new(2.0, 0.0, -1.6) + random(0.3)),
                2 => world.hang(V3::new(1.0, 2.0, -8.0) + random(1.0)),
                3 => {
                    world.hang(V3::new(3.0, 1.0, -20.0) + random(1.0));
                    world.body.velocity = random(6.0);
                    world.body.rate = random(40.0);
                }
                _ => world.hang(V3::new(30.0, 0.0, -51.9) + random(0.2)),
            }
            world
        };
        (1..=count).map(world).collect()
    }

    fn state(plant: &Plant) -> Vec<f64> {
        let b = &plant.body;
        let vectors = [b.position, b.velocity, b.rate, plant.specific_force, plant.tether.pull()];
        let mut all: Vec<f64> = vectors.iter().flat_map(|v| v.iter().copied()).collect();
        all.extend(b.attitude.coords.iter());
        all.extend(plant.rotors.iter().map(|rotor| rotor.speed));
        all.extend([plant.tether.tension(), plant.tether.station_tension()]);
        all.extend([plant.tether.length(), plant.tether.twist, plant.battery.voltage()]);
        all.push(f64::from(u8::from(plant.ground.is_touching())));
        all
    }

    fn fly(scenario: &Scenario) {
        let count = 2 * PART + 7;
        let mut ones = worlds(scenario, count as u64);
        let mut many = PlantBatch::new(ones.clone());
        let rotors = ones[0].rotors.len();
        let mut rng = generator(1, 78);
        for _ in 0..150 {
            let throttle: Vec<f64> =
                (0..count * rotors).map(|_| 0.55 + 0.4 * uniform(&mut rng)).collect();
            let (size, parts) = many.parts();
            for (mut part, rows) in parts.into_iter().zip(throttle.chunks(size * rotors)) {
                part.step(rows, 6.5, 7);
            }
            for (i, one) in ones.iter_mut().enumerate() {
                (0..7).for_each(|_| one.step(&throttle[i * rotors..][..rotors], 6.5));
                assert_eq!(state(one), state(&many.worlds()[i]), "world {i}");
            }
        }
    }

    #[test]
    fn every_world_of_a_batch_is_the_one_that_the_plant_makes_to_the_last_bit() {
        fly(&scenario(|s| s.wind.speed = 4.0));
        fly(&scenario(|s| {
            s.wind.speed = 4.0;
            s.wind.gusts = true;
        }));
        fly(&scenario(|s| s.wind.shear = 0.2));
        fly(&scenario(|s| s.tether.kind = crate::scenario::TetherKind::Fixed));
        fly(&Scenario::parse("[vehicle]\npreset = \"hexa-6\"", "s").unwrap());
        let three = VehicleSection {
            rotors: Scenario::parse("[vehicle]\npreset = \"octo-9\"", "s").unwrap().vehicle.rotors,
            ..VehicleSection::default()
        };
        fly(&scenario(|s| s.vehicle = three));
    }

    #[test]
    fn free_flight_goes_side_by_side() {
        let scenario = Scenario::default();
        let mut world = worlds(&scenario, 2).pop().unwrap();
        let mut lanes = Lanes::<4>::default();
        let wind = world.begin_tick(&[0.7; 4], 6.5);
        assert!(lanes.load(0, &world, &wind));
        lanes.step(&world.model);
        assert!(lanes.store(0, &mut world).is_some());
        let mut standing = worlds(&scenario, 5).pop().unwrap();
        let wind = standing.begin_tick(&[0.7; 4], 6.5);
        assert!(!lanes.load(0, &standing, &wind), "it stands on the ground");
    }
}
