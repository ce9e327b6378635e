"""A tether angle flown from a ground station: mode, a move, a refusal, and the log."""

import math
from pathlib import Path

import numpy as np
from flightlog import FlightLog
from groundstation import MAV, NAN, USER_MOVE_TETHER, end, holding

TETHER_ANGLE = (4 << 16) | (14 << 24)
SCENARIO = Path(__file__).resolve().parents[2] / "sitl" / "scenarios" / "angle.toml"


def test_a_tether_angle_is_flown_by_commands(sitl, tmp_path):
    beside = ("--beside", "ekf3,ekf4,low-pass,error-state")
    vehicle, station = holding(sitl, tmp_path, SCENARIO, 4.2, *beside)
    assert station.command(MAV.MAV_CMD_DO_SET_MODE, 1, 4, 14) == MAV.MAV_RESULT_ACCEPTED, station.texts
    station.wait_mode(TETHER_ANGLE)
    assert station.command(USER_MOVE_TETHER, 60, NAN, NAN, 8) == MAV.MAV_RESULT_DENIED
    station.wait_text("Move refused: not an output of this mode")
    assert station.command(USER_MOVE_TETHER, 60, 10, NAN, NAN) == MAV.MAV_RESULT_ACCEPTED, station.texts
    station.wait_vehicle_seconds(12)
    north = math.degrees(math.atan(math.cos(math.radians(10)) / math.tan(math.radians(60))))
    station.until(
        lambda m: m.name == "tag_north" and abs(m.value - north) < 4, ["NAMED_VALUE_FLOAT"], 30.0, "tag_north"
    )
    end(vehicle, station)

    log = FlightLog(vehicle.log())
    time = log.time("estimator_tether_angle")
    angle, truth = log.topics["estimator_tether_angle"], log.topics["tether_state_groundtruth"]
    true_time = log.time("tether_state_groundtruth")
    true_elevation = np.interp(time, true_time, truth["elevation"])
    last_seconds = time > time[-1] - 5
    # 30 degrees from straight up, turned 10 degrees to the east: west is negative.
    west = -math.degrees(math.atan(math.sin(math.radians(10)) / math.tan(math.radians(60))))
    assert abs(math.degrees(angle["angle[0]"][last_seconds].mean()) - north) < 4
    assert abs(math.degrees(angle["angle[1]"][last_seconds].mean()) - west) < 4
    assert abs(math.degrees(true_elevation[last_seconds].mean()) - 60) < 4
    # The position estimators that run beside are in the same log.
    for name in ("ekf3", "ekf4_article", "low_pass", "error_state"):
        assert len(log.topics[f"estimator_{name}"]["timestamp"]) > 100, name
