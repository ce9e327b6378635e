"""A quadrotor on a winch in MuJoCo, for `cargo sitl --physics`: PX4's simulator interface, or ArduPilot's JSON.

Mass, inertia, rotors, battery, drag and winch are the default scenario's. The tether is a spatial tendon that the winch
pulls with the tension that the vehicle asks for, as fast as its reel turns. MuJoCo's axes are North, West, up and
forward, left, up; what leaves is NED and FRD. See docs/physics.md.
"""

import argparse
import csv
import json
import math
import signal
import socket
import struct
import sys

import mujoco
import numpy as np
from pymavlink.dialects.v20 import common as mav

TICK = 1e-3
SUBSTEPS = 2
GRAVITY = 9.81

MASS, INERTIA = 1.5, (0.016, 0.016, 0.029)
ARM, THRUST, TORQUE_RATIO = 0.177, 1.55e-5, 0.0167
SPEED_MAX, NOMINAL_VOLTAGE, CURVE, ROTOR_LAG, EFFICIENCY = 723.0, 15.2, 0.75, 0.03, 0.65
DRAG_LINEAR, DRAG_QUADRATIC, RATE_DAMPING = np.array([0.18, 0.18, 0.06]), 0.012, 0.004
LEG, SPREAD, ATTACHMENT, START = 0.15, 0.15, 0.05, 0.8
WINCH_LAG, WINCH_FRICTION, FRICTION_SPEED, REEL_SPEED = 0.05, 0.3, 0.05, 4.0
LINE_STIFFNESS, LINE_DENSITY = 3000.0, 0.002
CELLS, RESISTANCE, CHARGE, CAPACITY, BASE_POWER = 4, 0.02, 0.95, 5.2, 4.0
RANGE_OFFSET = 0.03
HOME = (47.397742, 8.545594, 488.0)
EARTH = 6_371_000.0

# Front right, rear left, front left, rear right; its drag yaws the nose to the right if positive.
ROTORS = ((1, 1, 1), (-1, -1, 1), (1, -1, -1), (-1, 1, -1))
# From MuJoCo's axes to ours and back: world and body alike.
FLIP = np.array([1.0, -1.0, -1.0])
WINCH_CHANNEL = 15


def model():
    feet = "".join(
        f'<geom type="sphere" size="0.01" pos="{x * SPREAD} {y * SPREAD} {0.01 - LEG}" mass="0"/>'
        for x in (1, -1)
        for y in (1, -1)
    )
    sites = "".join(f'<site name="rotor{i}" pos="{x * ARM} {-y * ARM} 0"/>' for i, (x, y, _) in enumerate(ROTORS))
    motors = "".join(
        f'<motor site="rotor{i}" gear="0 0 1 0 0 {-spin * TORQUE_RATIO}"/>' for i, (_, _, spin) in enumerate(ROTORS)
    )
    return mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <option timestep="{TICK / SUBSTEPS}" integrator="implicitfast" gravity="0 0 {-GRAVITY}"/>
      <default><geom friction="0.8 0.005 0.0001" solref="0.02 1"/></default>
      <worldbody>
        <geom type="plane" size="50 50 1"/>
        <site name="anchor" pos="0 0 0"/>
        <body name="vehicle" pos="{START} 0 {LEG}">
          <freejoint/>
          <inertial pos="0 0 0" mass="{MASS}" diaginertia="{INERTIA[0]} {INERTIA[1]} {INERTIA[2]}"/>
          {feet}{sites}
          <site name="imu"/><site name="attachment" pos="0 0 {-ATTACHMENT}"/>
        </body>
      </worldbody>
      <tendon><spatial name="line"><site site="anchor"/><site site="attachment"/></spatial></tendon>
      <actuator>{motors}<motor tendon="line" gear="-1"/></actuator>
      <sensor><accelerometer site="imu"/><gyro site="imu"/></sensor>
    </mujoco>""")


def open_circuit(charge):
    return CELLS * float(np.interp(charge, (0.0, 0.05, 0.2, 0.5, 0.8, 1.0), (3.2, 3.5, 3.7, 3.82, 4.0, 4.2)))


class Vehicle:
    """One millisecond at a time; everything that leaves it is NED, FRD and SI."""

    def __init__(self, path):
        self.model, self.ticks = model(), 0
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)
        self.speed = np.zeros(4)
        self.charge, self.current, self.voltage = CHARGE, 0.0, open_circuit(CHARGE)
        self.wanted, self.tension = 0.0, 0.0
        # Line outside the reel: it follows the vehicle no faster than the reel turns.
        self.length, self.line_speed = float(self.data.ten_length[0]), 0.0
        self.file = open(path, "w", newline="") if path else None
        self.rows = csv.writer(self.file) if self.file else None
        if self.rows:
            self.rows.writerow(["time_s", "north_m", "east_m", "down_m", "line_m", "tension_n"])
        self.record()

    def record(self):
        if self.rows and self.ticks % 10 == 0:
            values = [self.time, *self.position, self.length, self.tension]
            self.rows.writerow([f"{value:.5f}" for value in values])

    def step(self, throttle, winch):
        data = self.data
        top = SPEED_MAX * self.voltage / NOMINAL_VOLTAGE
        self.speed += (top * np.clip(throttle, 0.0, 1.0) ** CURVE - self.speed) * (1.0 - math.exp(-TICK / ROTOR_LAG))
        thrust = THRUST * self.speed**2
        self.drain(float(np.sum(thrust * TORQUE_RATIO * self.speed)) / EFFICIENCY + BASE_POWER)
        data.ctrl[:4] = thrust
        data.ctrl[4] = self.pull(winch)
        velocity = data.qvel[:3]
        # The rotation's columns are the body's axes.
        rotation = data.xmat[1].reshape(3, 3)
        air = rotation.T @ velocity
        drag = -DRAG_LINEAR * air - DRAG_QUADRATIC * np.linalg.norm(air) * air
        data.qfrc_applied[:3] = rotation @ drag
        # Half of the line's weight hangs on the vehicle.
        data.qfrc_applied[2] -= 0.5 * LINE_DENSITY * GRAVITY * self.length
        data.qfrc_applied[3:6] = -RATE_DAMPING * data.qvel[3:6]
        mujoco.mj_step(self.model, data, nstep=SUBSTEPS)
        self.ticks += 1
        self.record()

    def advance(self, ticks, throttle, winch):
        for _ in range(ticks):
            self.step(throttle, winch)

    def drain(self, power):
        self.current = power / self.voltage
        self.voltage = open_circuit(self.charge) - self.current * RESISTANCE
        self.charge -= self.current * TICK / (3600.0 * CAPACITY)

    def pull(self, winch):
        """Tension at the vehicle, N, of a winch that is asked for so much."""
        self.wanted += (winch - self.wanted) * TICK / WINCH_LAG
        distance = float(self.data.ten_length[0])
        before = self.length
        self.length += min(max(distance - self.length, -REEL_SPEED * TICK), REEL_SPEED * TICK)
        self.line_speed = (self.length - before) / TICK
        turning = self.line_speed / FRICTION_SPEED
        self.tension = max(self.wanted + WINCH_FRICTION * turning / math.hypot(1.0, turning), 0.0)
        stretch = distance - self.length
        if stretch < 0.0:
            self.tension = 0.0
            return 0.0
        height = float(self.data.qpos[2])
        return self.tension + LINE_STIFFNESS / self.length * stretch + 0.5 * LINE_DENSITY * GRAVITY * height

    @property
    def time(self):
        return self.ticks * TICK

    @property
    def position(self):
        return FLIP * self.data.qpos[:3]

    @property
    def velocity(self):
        return FLIP * self.data.qvel[:3]

    @property
    def quaternion(self):
        """Body to world, w first: half a turn about x on either side."""
        return self.data.qpos[3:7] * np.array([1.0, 1.0, -1.0, -1.0])

    @property
    def accel(self):
        return FLIP * self.data.sensordata[:3]

    @property
    def gyro(self):
        return FLIP * self.data.sensordata[3:6]

    @property
    def range(self):
        """Along the body's down axis to the flat ground."""
        down = float(self.data.xmat[1][8])
        return float(self.data.qpos[2]) / down - RANGE_OFFSET if down > 0.05 else math.inf

    def close(self):
        if self.file:
            self.file.close()


class Px4Server:
    """The simulator's side of PX4's interface, for one flight."""

    def __init__(self, vehicle, port, ticks):
        self.vehicle, self.out, self.ticks = vehicle, bytearray(), ticks
        self.mav = mav.MAVLink(self, srcSystem=1, srcComponent=200)
        self.reader = mav.MAVLink(None)
        self.listener = socket.create_server(("127.0.0.1", port))

    def write(self, data):
        self.out += data

    def due(self):
        """All that is due; HIL_SENSOR last, since the vehicle steps on it."""
        v, ticks = self.vehicle, self.vehicle.ticks
        us = ticks * 1000
        if ticks % 5 == 0:
            self.send_truth(us)
        if ticks % 10 == 0:
            centimetres = min(v.range * 100.0, 1200.0)
            down = mav.MAV_SENSOR_ROTATION_PITCH_270
            self.mav.distance_sensor_send(ticks, 10, 1200, round(max(centimetres, 0.0)), 0, 0, down, 0)
        if ticks % 20 == 0:
            self.mav.winch_status_send(us, v.length, v.line_speed, v.tension / GRAVITY, 0, 0, 0, 0)
        if ticks % 100 == 0:
            cells = [round(v.voltage * 1000)] + [65535] * 9
            self.mav.battery_status_send(0, 0, 0, 0, cells, round(v.current * 100), -1, -1, -1)
        altitude = HOME[2] - float(v.position[2])
        pressure = 1013.25 * (1.0 - 2.25577e-5 * altitude) ** 5.25588
        magnetic = (0.0, 0.0, 0.0)
        self.mav.hil_sensor_send(us, *v.accel, *v.gyro, *magnetic, pressure, 0.0, altitude, 24.0, 0x1E3F)
        data, self.out = self.out, bytearray()
        return data

    def send_truth(self, us):
        v = self.vehicle
        north, east, down = v.position
        latitude = HOME[0] + math.degrees(north / EARTH)
        longitude = HOME[1] + math.degrees(east / (EARTH * math.cos(math.radians(HOME[0]))))
        place = (round(latitude * 1e7), round(longitude * 1e7), round((HOME[2] - down) * 1000))
        speed = [round(x * 100) for x in v.velocity]
        milli_g = [round(x / GRAVITY * 1000) for x in v.accel]
        self.mav.hil_state_quaternion_send(us, list(v.quaternion), *v.gyro, *place, *speed, 0, 0, *milli_g)

    def run(self):
        peer, _ = self.listener.accept()
        peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        peer.sendall(self.due())
        while data := peer.recv(4096):
            for message in self.reader.parse_buffer(data) or []:
                if message.get_msgId() == mav.MAVLINK_MSG_ID_HIL_ACTUATOR_CONTROLS:
                    controls = message.controls
                    self.vehicle.advance(self.ticks, np.array(controls[:4]), 100.0 * controls[WINCH_CHANNEL])
                    peer.sendall(self.due())


class JsonServer:
    """ArduPilot's JSON backend, for one flight."""

    PACKET = struct.Struct("<HHI16H")
    MAGIC = 18458

    def __init__(self, vehicle, port, ticks):
        self.vehicle, self.ticks = vehicle, ticks
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", port))

    def line(self):
        v = self.vehicle
        state = {
            "timestamp": v.time,
            "imu": {"gyro": list(v.gyro), "accel_body": list(v.accel)},
            "position": list(v.position),
            "quaternion": list(v.quaternion),
            "velocity": list(v.velocity),
            "rng_1": min(v.range, 1e3),
            "battery": {"voltage": v.voltage, "current": v.current},
            "winch": {"length": v.length, "speed": v.line_speed, "tension": v.tension},
        }
        return ("\n" + json.dumps(state) + "\n").encode()

    def run(self):
        last, answer = None, b""
        while True:
            data, peer = self.socket.recvfrom(1024)
            if len(data) != self.PACKET.size:
                continue
            magic, _, count, *pulses = self.PACKET.unpack(data)
            if magic != self.MAGIC:
                continue
            # A packet that came twice is answered twice, but flown once.
            if count != last:
                if last is not None:
                    pulses = np.array(pulses)
                    winch = (pulses[WINCH_CHANNEL] - 1000.0) / 10.0
                    self.vehicle.advance(self.ticks, (pulses[:4] - 1000.0) / 1000.0, winch)
                last, answer = count, self.line()
            self.socket.sendto(answer, peer)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--port", type=int, help="4560, or 9002 with --json")
    parser.add_argument("--json", action="store_true", help="ArduPilot's JSON over UDP instead of PX4's interface over TCP")
    parser.add_argument("--rate", type=int, choices=(1000, 500, 250), default=1000, help="frames per simulated second")
    parser.add_argument("--csv", help="where the true path goes")
    options = parser.parse_args()
    vehicle = Vehicle(options.csv)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    server, port = (JsonServer, 9002) if options.json else (Px4Server, 4560)
    server = server(vehicle, options.port or port, 1000 // options.rate)
    print("ready", flush=True)
    try:
        server.run()
    except (KeyboardInterrupt, ConnectionError):
        pass
    finally:
        vehicle.close()


if __name__ == "__main__":
    main()
