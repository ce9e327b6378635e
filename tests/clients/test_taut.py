"""A taut link flown from a ground station: mode, moves, a refusal, and back."""

import math
from pathlib import Path

from flightlog import FlightLog
from groundstation import HOLD, MAV, NAN, GroundStation

TAUT_FORCE = (4 << 16) | (12 << 24)
MOVE_TAUT_FORCE = 31011
SCENARIO = Path(__file__).resolve().parents[2] / "sitl" / "scenarios" / "taut.toml"


def test_elevation_and_link_force_are_flown_by_commands(sitl, tmp_path):
    # The vehicle of the scenario without its mission: here the ground station flies.
    scenario = tmp_path / "taut.toml"
    scenario.write_text(SCENARIO.read_text().split("[[mission]]")[0])
    vehicle = sitl("--speedup", "8", "--scenario", scenario, "--seed", "1")
    station = GroundStation(vehicle.program_port)
    station.wait_armable()
    station.arm()
    station.take_off(3.5)
    station.wait_vehicle_seconds(3)

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
    assert station.command(MAV.MAV_CMD_DO_SET_MODE, 1, 4, 3) == MAV.MAV_RESULT_ACCEPTED
    station.wait_mode(HOLD)
    station.wait_vehicle_seconds(3)
    station.land()
    station.close()
    output, code = vehicle.end()
    assert code == 0, output

    log = FlightLog(vehicle.log())
    time = log.time("estimator_taut")
    taut, truth = log.topics["estimator_taut"], log.topics["tether_state_groundtruth"]
    last = time[taut["active"] > 0][-1]
    true_time = log.time("tether_state_groundtruth")
    end = (true_time > last - 3) & (true_time < last)
    # Worst of twenty seeds is 2.1 degrees and 0.33 N rms; the estimate here is of one flight's end.
    assert abs(math.degrees(truth["elevation"][end].mean()) - 60) < 5
    assert abs(truth["tension"][end].mean() - 9) < 0.8
