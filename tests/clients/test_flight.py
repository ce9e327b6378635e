"""A scripted pymavlink flight over UDP, from discovery to disarmed."""

import math

import pytest
from flightlog import HOLD, LAND, TAKEOFF, FlightLog
from groundstation import MAV, GroundStation

# A ground station fast enough for this factor: its heartbeats stay well under the arming check's 3 s.
SPEEDUP = 8

SCENARIO = """
[wind]
speed = {wind}
gusts = {gusts}

[[fault]]
kind = "imu_frozen"
at = 4.0
duration = 10.0
"""


def fly(sitl, tmp_path, wind, seed):
    scenario = tmp_path / "scenario.toml"
    scenario.write_text(SCENARIO.format(wind=wind, gusts=str(wind > 0).lower()))
    vehicle = sitl("--speedup", SPEEDUP, "--scenario", scenario, "--seed", seed)
    station = GroundStation(vehicle.program_port)
    assert station.heartbeat.type == MAV.MAV_TYPE_QUADROTOR
    assert station.heartbeat.autopilot == MAV.MAV_AUTOPILOT_PX4

    while station.vehicle_time() < 5.0:
        pass
    result = station.command(MAV.MAV_CMD_COMPONENT_ARM_DISARM, 1)
    assert result == MAV.MAV_RESULT_TEMPORARILY_REJECTED
    station.wait_text("Arming denied: IMU")

    parameters = station.parameters()
    assert {"VEH_MASS", "TET_TENSION", "RATE_P", "SYS_AUTOSTART"} <= parameters.keys()
    assert station.set_parameter("RATE_P", 21.0) == pytest.approx(21.0)
    assert station.read_parameter("RATE_P") == pytest.approx(21.0)
    assert station.set_parameter("RATE_P", 1e9) == pytest.approx(21.0), "out of range must change nothing"

    station.wait_armable()
    station.arm()
    station.take_off(5.0)
    begin = station.vehicle_time()
    station.wait_vehicle_seconds(60.0)
    end = station.vehicle_time()
    station.move_azimuth(math.radians(20.0))
    station.land()

    output, code = vehicle.end()
    station.close()
    assert code == 0, output
    log = FlightLog(vehicle.log())
    assert log.is_whole() and log.is_disarmed_at_end()
    assert log.modes() == [HOLD, TAKEOFF, HOLD, LAND, HOLD]
    horizontal, vertical = log.hold_rms(begin, end)
    figures = {
        "horizontal": horizontal,
        "vertical": vertical,
        "touch_down": log.touch_down_speed(),
        "attitude_deg": log.attitude_rms_deg(),
    }
    print(f"wind {wind} m/s, seed {seed}: {figures}")
    return figures


def test_a_calm_flight_meets_every_bound(sitl, tmp_path):
    figures = fly(sitl, tmp_path, 0.0, 1)
    assert figures["horizontal"] <= 0.4
    assert figures["vertical"] <= 0.15
    assert figures["touch_down"] <= 0.7
    assert figures["attitude_deg"] <= 2.0


def test_a_flight_in_gusts_of_3_mps_stays_within_its_bound(sitl, tmp_path):
    figures = fly(sitl, tmp_path, 3.0, 1)
    assert figures["horizontal"] <= 1.5
    assert figures["touch_down"] <= 0.7
