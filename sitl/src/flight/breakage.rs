//! What the scenario's faults do to the physical world.

use crate::plant::{Plant, V3};
use crate::scenario::{FaultFacts, FaultKind, Faults};
use tautline_firmware::signal::MAX_ROTORS;

/// What of the world was as it should be.
#[derive(Clone, Debug)]
pub struct Breakage {
    length_max: f64,
    mass: f64,
    /// How far the centre of mass has moved in the body, m.
    moved: V3,
    /// Throttle of each motor when it began to be stuck.
    stuck: [Option<f64>; MAX_ROTORS],
    is_whole: bool,
}

impl Breakage {
    /// Of a world that nothing has broken yet.
    #[must_use]
    pub fn new(plant: &Plant) -> Self {
        let winch = plant.model().tether.winch.as_ref();
        Self {
            length_max: winch.map_or(0.0, |winch| winch.length_max),
            mass: plant.model().body.mass,
            moved: V3::zeros(),
            stuck: [None; MAX_ROTORS],
            is_whole: true,
        }
    }

    /// Breaks and mends the world as the faults say at `time`, s, and what is asked of motors and winch with it.
    pub fn apply(
        &mut self,
        faults: &mut Faults,
        time: f64,
        plant: &mut Plant,
        throttle: &mut [f64; MAX_ROTORS],
        winch: &mut f64,
    ) {
        if faults.is_empty() && self.is_whole {
            return;
        }
        self.is_whole = faults.is_empty();
        let facts = FaultFacts {
            step: 0,
            height: plant.height_over_ground(),
            length: plant.tether.length(),
            tension: plant.tether.tension(),
        };
        faults.look(facts, time);
        self.motors(faults, time, plant, throttle);
        self.line(faults, time, plant, winch);
        self.load(faults, time, plant);
        let added = |kind| faults.added(kind, time);
        plant.force = faults.on_axes(FaultKind::Force, time);
        plant.force += V3::new(
            added(FaultKind::PushNorth),
            added(FaultKind::PushEast),
            added(FaultKind::PushDown),
        );
        plant.gust = faults.away(FaultKind::Gust, time);
        plant.gust += V3::new(
            added(FaultKind::WindNorth),
            added(FaultKind::WindEast),
            added(FaultKind::Downdraft),
        );
        plant.anchor.raised = added(FaultKind::GroundStep);
        plant.anchor.drive = faults.away(FaultKind::AnchorSpeed, time);
        plant.anchor.rock = faults.swinging(FaultKind::DeckRock, time);
        if let Some(charge) = faults.value(FaultKind::BatteryAt, time) {
            plant.battery.charge = plant.battery.charge.min(charge);
        }
        plant.battery.extra_resistance = added(FaultKind::BatteryResistance);
        plant.supply.is_lost = faults.is_active(FaultKind::SupplyLost, time);
    }

    fn motors(
        &mut self,
        faults: &Faults,
        time: f64,
        plant: &mut Plant,
        throttle: &mut [f64; MAX_ROTORS],
    ) {
        for (i, rotor) in plant.rotors.iter_mut().enumerate() {
            let share = |kind| faults.on_motor(kind, time, i).unwrap_or(1.0);
            rotor.strength = share(FaultKind::MotorThrust) * share(FaultKind::AllThrust);
        }
        for (i, (throttle, stuck)) in throttle.iter_mut().zip(&mut self.stuck).enumerate() {
            if faults.on_motor(FaultKind::MotorStop, time, i).is_some() {
                *throttle = 0.0;
            }
            *stuck =
                faults.on_motor(FaultKind::MotorStuck, time, i).map(|_| stuck.unwrap_or(*throttle));
            *throttle = stuck.unwrap_or(*throttle);
        }
    }

    fn load(&mut self, faults: &Faults, time: f64, plant: &mut Plant) {
        plant.model_mut().body.mass = self.mass + faults.added(FaultKind::Payload, time);
        let moved = faults.on_axes(FaultKind::CentreOfMass, time);
        if moved != self.moved {
            plant.move_centre(&(moved - self.moved));
            self.moved = moved;
        }
    }

    fn line(&self, faults: &Faults, time: f64, plant: &mut Plant, winch: &mut f64) {
        let broken_at = faults.value(FaultKind::TetherBroken, time);
        let tether = &mut plant.model_mut().tether;
        tether.is_broken = broken_at.is_some();
        tether.broken_at = broken_at.unwrap_or(tether.broken_at);
        if let Some(model) = &mut tether.winch {
            let most = faults.value(FaultKind::PayoutLimit, time).unwrap_or(self.length_max);
            model.length_max = self.length_max.min(most);
            let jams = faults.is_active(FaultKind::WinchJam, time).then_some(0.0);
            model.turns = jams.or(faults.value(FaultKind::WinchCreep, time));
        }
        if faults.is_active(FaultKind::BrakeFailed, time) {
            *winch = 0.0;
        }
        *winch = faults.value(FaultKind::WinchTension, time).unwrap_or(*winch);
        match faults.value(FaultKind::Snag, time) {
            Some(share) => plant.catch_line(share),
            None => plant.tether.release(),
        }
    }
}
