"""The flying pendulum from a ground station, and a program that plays the motion capture."""

import math
import threading
import time
from pathlib import Path

import numpy as np
from flightlog import FlightLog
from groundstation import MAV, NAN, GroundStation, holding

PENDULUM = (4 << 16) | (15 << 24)
SCENARIO = Path(__file__).resolve().parents[2] / "sitl" / "scenarios" / "pendulum.toml"


def test_a_pendulum_is_balanced_by_commands(sitl, tmp_path):
    vehicle, station = holding(sitl, tmp_path, SCENARIO, 1.5)
    assert station.set_parameter("PND_BETA", 4.0) == 4.0
    station.wait_text("PND_BETA too large")
    assert station.command(MAV.MAV_CMD_DO_SET_MODE, 1, 4, 15) == MAV.MAV_RESULT_DENIED
    assert abs(station.set_parameter("PND_BETA", 0.2) - 0.2) < 1e-6
    station.wait_vehicle_seconds(2)
    assert station.command(MAV.MAV_CMD_DO_SET_MODE, 1, 4, 15) == MAV.MAV_RESULT_ACCEPTED, station.texts
    station.wait_mode(PENDULUM)
    station.wait_vehicle_seconds(15)
    station.close()
    output, code = vehicle.end()
    assert code == 0, output

    log = FlightLog(vehicle.log())
    time_s = log.time("estimator_pendulum")
    topic = log.topics["estimator_pendulum"]
    late = (topic["active"] > 0) & (time_s > time_s[-1] - 5)
    assert late.sum() > 100
    off = np.array([topic[f"load_position[{i}]"] - topic[f"load_setpoint[{i}]"] for i in range(3)])
    assert np.linalg.norm(off[:, late], axis=0).mean() < 0.05
    # Upright: the rod points up.
    assert np.degrees(np.arccos(-topic["rod[2]"][late])).max() < 15
    true_time = log.time("vehicle_local_position_groundtruth")
    for axis in "xyz":
        truth = np.interp(
            log.time("vehicle_local_position"), true_time, log.topics["vehicle_local_position_groundtruth"][axis]
        )
        error = log.topics["vehicle_local_position"][axis] - truth
        assert abs(error[-200:]).max() < 0.05, axis


class MotionCapture:
    """Says where a vehicle stands, as a motion-capture bridge does."""

    def __init__(self, station):
        self.station, self.running, self.say = station, True, None
        self.thread = threading.Thread(target=self._run, daemon=True)
        self.thread.start()

    def _run(self):
        while self.running:
            if self.say is not None:
                with self.station.lock:
                    self.say(self.station.link.mav, int(time.time() * 1e6))
            time.sleep(0.02)

    def stop(self):
        self.running = False
        self.thread.join()


def test_poses_and_a_rod_from_pymavlink_are_taken(sitl, tmp_path):
    bare = tmp_path / "capture.toml"
    bare.write_text(SCENARIO.read_text().split("[[mission]]")[0].replace("rate = 100.0", "rate = 0.0"))
    # The station is no companion of the vehicle: it must be named.
    vehicle = sitl("--speedup", "1", "--scenario", bare, "--seed", "1", "--param", "MAV_AID_SYS=255")
    station = GroundStation(vehicle.program_port)
    station.wait_armable()
    # Without motion capture nothing takes off.
    assert station.command(MAV.MAV_CMD_COMPONENT_ARM_DISARM, 1) == MAV.MAV_RESULT_ACCEPTED, station.texts
    result = station.command(MAV.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, NAN, NAN, NAN, 1.5)
    assert result == MAV.MAV_RESULT_TEMPORARILY_REJECTED
    station.wait_text("no position estimate")
    assert station.command(MAV.MAV_CMD_COMPONENT_ARM_DISARM, 0) == MAV.MAV_RESULT_ACCEPTED
    yaw = 0.5
    q = [math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)]
    nothing = [NAN] * 21
    capture = MotionCapture(station)

    def odometry(mav, usec):
        still = [0.0] * 6
        frame, child = MAV.MAV_FRAME_LOCAL_NED, MAV.MAV_FRAME_BODY_FRD
        mav.odometry_send(usec, frame, child, 1.0, 2.0, -0.5, q, *still, nothing, nothing)
        mav.debug_vect_send(b"rod", usec, 0.1, 0.0, -1.0)

    def vision(mav, usec):
        mav.vision_position_estimate_send(usec, -1.0, 0.5, -0.5, 0.0, 0.0, -yaw)

    def mocap(mav, usec):
        mav.att_pos_mocap_send(usec, q, 0.2, 0.4, -0.5)

    for say, place, heading in [(odometry, (1, 2), yaw), (vision, (-1, 0.5), -yaw), (mocap, (0.2, 0.4), yaw)]:
        capture.say = say
        there = lambda m: math.hypot(m.x - place[0], m.y - place[1]) < 0.02  # noqa: E731
        station.until(there, ["LOCAL_POSITION_NED"], 20.0, say.__name__)
        station.until(lambda m: abs(m.yaw - heading) < 0.03, ["ATTITUDE"], 20.0, f"heading by {say.__name__}")
        # Long enough for the log to have some of it: place and heading are taken over at once.
        station.wait_vehicle_seconds(1)
    capture.stop()
    station.close()
    output, code = vehicle.end()
    assert code == 0, output
    log = FlightLog(vehicle.log())
    rod = [log.topics["estimator_pendulum"][f"rod[{i}]"].mean() for i in range(3)]
    assert np.allclose(rod, np.array([0.1, 0.0, -1.0]) / math.hypot(0.1, 1.0), atol=0.01), rod
