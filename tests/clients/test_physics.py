"""The firmware in MuJoCo's physics, by PX4's simulator interface and by ArduPilot's JSON (docs/physics.md)."""

import csv
import json
import socket
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from flightlog import FlightLog
from groundstation import GroundStation
from pymavlink.dialects.v20 import common as mav

TRUTH = "vehicle_local_position_groundtruth"
# Measured: 0.04 m by either interface.
APART = 0.15

# Both worlds alike: without what is drawn by a seed. The inertial sensor keeps its white noise, since one that says the
# same twice counts as frozen.
SCENARIO = """
[vehicle]
common_thrust_error = 0.0
rotor_thrust_error = 0.0
[tether]
winch_error = 0.0
winch_ripple = 0.0
[sensors]
gyro_bias = 0.0
accel_bias = 0.0
gyro_drift = 0.0
accel_drift = 0.0
warm_up = 0.0
vibration = 0.0
range_noise = 0.0
pressure_noise = 0.0
pressure_drift = 0.0
length_noise = 0.0
range_lost_bytes = 0
"""
MISSION = """
[[mission]]
do = "arm"
[[mission]]
do = "takeoff"
altitude = 5.0
[[mission]]
do = "hold"
seconds = 10.0
[[mission]]
do = "land"
"""


@pytest.fixture
def mujoco_vehicle():
    """Starts the MuJoCo vehicle on a free port."""
    running = []

    def start(kind, path, *arguments):
        with socket.socket(type=socket.SOCK_DGRAM if kind == "json" else socket.SOCK_STREAM) as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        script = Path(__file__).with_name("mujoco_vehicle.py")
        command = [sys.executable, script, "--port", str(port), "--csv", path, *arguments]
        command += ["--json"] if kind == "json" else []
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        running.append(process)
        assert process.stdout.readline() == "ready\n"
        return process, f"{kind}:127.0.0.1:{port}"

    yield start
    for process in running:
        process.kill()
        process.communicate()


def scenario(tmp_path, text):
    path = tmp_path / "scenario.toml"
    path.write_text(text)
    return path


def true_path(log):
    times = log.time(TRUTH)
    return times - times[0], np.column_stack([log.topics[TRUTH][axis] for axis in "xyz"])


def apart(times, path, other_times, other):
    """Largest distance at the same times, m."""
    together = times[times <= other_times[-1]]
    there = np.column_stack([np.interp(together, other_times, other[:, axis]) for axis in range(3)])
    return float(np.max(np.linalg.norm(path[: len(together)] - there, axis=1)))


def test_flights_in_mujoco_go_where_our_own_plant_goes(sitl, mujoco_vehicle, tmp_path):
    flight = ("--headless", "--scenario", scenario(tmp_path, SCENARIO + MISSION))
    own = sitl(*flight)
    output, code = own.wait(60)
    assert code == 0, output
    own_times, own_path = true_path(FlightLog(own.log()))

    # Both at once: most of their time goes by in Python.
    flights = {}
    for kind in ("px4", "json"):
        server, address = mujoco_vehicle(kind, tmp_path / f"{kind}.csv")
        flights[kind] = (server, sitl(*flight, "--physics", address))
    for kind, (server, vehicle) in flights.items():
        output, code = vehicle.wait(120)
        assert code == 0, output
        assert "Landed, disarmed" in output
        log = FlightLog(vehicle.log())
        assert log.is_whole() and log.is_disarmed_at_end()

        server.terminate()
        server.wait(10)
        with open(tmp_path / f"{kind}.csv") as file:
            rows = np.array([[float(x) for x in row] for row in list(csv.reader(file))[1:]])
        times, path = rows[:, 0], rows[:, 1:4]
        assert 4.9 < -path[:, 2].min() < 5.8
        distance = apart(own_times, own_path, times, path)
        print(f"{kind}: at most {distance:.3f} m from our own plant's path in {times[-1]:.0f} s")
        assert distance <= APART
        # What the log calls the truth has come through the interface: whole centimetres in one of them.
        assert apart(*true_path(log), times, path) < 0.02


def test_a_ground_station_reaches_a_vehicle_in_physics_at_250_hz(sitl, mujoco_vehicle, tmp_path):
    _, address = mujoco_vehicle("px4", tmp_path / "path.csv", "--rate", "250")
    vehicle = sitl("--physics", address, "--duration", 60, "--scenario", scenario(tmp_path, SCENARIO))
    station = GroundStation(vehicle.program_port)
    station.wait_armable()
    station.arm()
    station.close()
    output, code = vehicle.end()
    assert code == 0, output
    assert "Armed" in output


def bad_json(line):
    """A JSON physics that answers with this line."""
    server = socket.socket(type=socket.SOCK_DGRAM)
    server.bind(("127.0.0.1", 0))

    def serve():
        _, peer = server.recvfrom(1024)
        server.sendto(line.encode(), peer)

    threading.Thread(target=serve, daemon=True).start()
    return f"json:{server.getsockname()[1]}"


def bad_px4(rate):
    """A simulator of PX4 that measures this rate once and hangs up at the next answer."""
    server = socket.create_server(("127.0.0.1", 0))

    def serve():
        peer, _ = server.accept()
        link = mav.MAVLink(peer.makefile("wb", buffering=0))
        link.hil_sensor_send(0, 0, 0, -9.81, rate, 0, 0, 0, 0, 0, 1013.25, 0, 0, 20, 0x1FFF)
        answered = False
        while not answered and (data := peer.recv(4096)):
            answered = any(m.get_msgId() == mav.MAVLINK_MSG_ID_HIL_ACTUATOR_CONTROLS for m in link.parse_buffer(data) or [])
        peer.close()

    threading.Thread(target=serve, daemon=True).start()
    return f"px4:127.0.0.1:{server.getsockname()[1]}"


STATE = {
    "timestamp": 1.0,
    "imu": {"gyro": [0, 0, 0], "accel_body": [0, 0, -9.81]},
    "position": [0, 0, 0],
    "attitude": [0, 0, 0],
    "velocity": [0, 0, 0],
}


@pytest.mark.parametrize(
    ("begin", "argument", "complaint"),
    [
        (bad_json, '{"timestamp": 1.0', "bad JSON"),
        (bad_json, json.dumps(STATE | {"velocity": [float("nan"), 0, 0]}), "bad JSON"),
        (bad_json, json.dumps(STATE), "no new frame for 5 s"),
        (bad_px4, float("nan"), "angular rate is NaN"),
        (bad_px4, 0.0, "closed the connection"),
    ],
)
def test_physics_that_fails_ends_in_one_line(sitl, begin, argument, complaint):
    vehicle = sitl("--headless", "--physics", begin(argument))
    output, code = vehicle.wait(20)
    errors = [line for line in output.splitlines() if line.startswith("error: ")]
    assert code == 1 and len(errors) == 1 and complaint in errors[0], output
    assert "panicked" not in output
