"""A taut link flown from a ground station: mode, moves, a refusal, and back."""

import math
from pathlib import Path

from flightlog import FlightLog
from groundstation import MAV, NAN, end, holding

TAUT_FORCE = (4 << 16) | (12 << 24)
MOVE_TAUT_FORCE = 31011
SCENARIO = Path(__file__).resolve().parents[2] / "sitl" / "scenarios" / "taut.toml"


def test_elevation_and_link_force_are_flown_by_commands(sitl, tmp_path):
    vehicle, station = holding(sitl, tmp_path, SCENARIO, 3.5)

    def move(*params):
        return station.command(MOVE_TAUT_FORCE, *params)

    assert move(NAN, 60, NAN, NAN) == MAV.MAV_RESULT_TEMPORARILY_REJECTED
    station.wait_text("Move refused: not in a taut-link mode")
    assert station.command(MAV.MAV_CMD_DO_SET_MODE, 1, 4, 12) == MAV.MAV_RESULT_ACCEPTED, station.texts
    station.wait_mode(TAUT_FORCE)
    assert move(45, 45, 6, -4, 0, 0, 1.5) == MAV.MAV_RESULT_DENIED
    station.wait_text("Move refused: a cable cannot push")
    assert move(45, 60, 6, 9, 0, 0, 5) == MAV.MAV_RESULT_ACCEPTED, station.texts
    station.wait_vehicle_seconds(10)
    station.until(lambda m: m.name == "tlk_force" and abs(m.value - 9) < 1.5, ["NAMED_VALUE_FLOAT"], 30.0, "force")
    end(vehicle, station)

    log = FlightLog(vehicle.log())
    time = log.time("estimator_taut")
    taut, truth = log.topics["estimator_taut"], log.topics["tether_state_groundtruth"]
    last = time[taut["active"] > 0][-1]
    true_time = log.time("tether_state_groundtruth")
    last_seconds = (true_time > last - 3) & (true_time < last)
    # Worst of twenty seeds is 2.1 degrees and 0.33 N rms; the estimate here is of one flight's end.
    assert abs(math.degrees(truth["elevation"][last_seconds].mean()) - 60) < 5
    assert abs(truth["tension"][last_seconds].mean() - 9) < 0.8
