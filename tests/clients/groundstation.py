"""A small ground station on pymavlink; times are the vehicle's."""

import math
import os
import threading
import time

os.environ["MAVLINK20"] = "1"

from pymavlink import mavutil  # noqa: E402

MAV = mavutil.mavlink
HOLD = (4 << 16) | (3 << 24)
LAND = (4 << 16) | (6 << 24)
TAKEOFF = (4 << 16) | (2 << 24)
USER_MOVE_TETHER = 31010
NAN = float("nan")
# Wall-clock seconds for one answer, and how often to ask.
PATIENCE = 3.0
ATTEMPTS = 5


class GroundStation:
    def __init__(self, port, heartbeat_period=0.05, dialect="common"):
        """At a UDP port, or at an address as pymavlink writes them."""
        address = f"udpin:127.0.0.1:{port}" if isinstance(port, int) else port
        self.link = mavutil.mavlink_connection(address, source_system=255, dialect=dialect, retries=30)
        self.texts = []
        self.alive = True
        self.lock = threading.Lock()
        first = self.link.wait_heartbeat(timeout=30)
        assert first is not None, "no heartbeat"
        self.heartbeat = first
        self.beat = threading.Thread(target=self._beat, args=(heartbeat_period,), daemon=True)
        self.beat.start()

    def _beat(self, period):
        while self.alive:
            with self.lock:
                self.link.mav.heartbeat_send(MAV.MAV_TYPE_GCS, MAV.MAV_AUTOPILOT_INVALID, 0, 0, 0)
            time.sleep(period)

    def close(self):
        """Gone, as a killed process is."""
        self.alive = False
        self.beat.join()
        self.link.close()

    def receive(self, *types, timeout=30.0):
        """The next message of one of these types."""
        message = self.listen(*types, timeout=timeout)
        assert message is not None, f"no {types} within {timeout} s; texts: {self.texts}"
        return message

    def listen(self, *types, timeout):
        """The next message of one of these types, or None."""
        end = time.monotonic() + timeout
        while (left := end - time.monotonic()) > 0:
            message = self.link.recv_match(blocking=True, timeout=min(left, 1.0))
            if message is None:
                continue
            if message.get_type() == "STATUSTEXT":
                self.texts.append(message.text)
            if message.get_type() in types:
                return message
        return None

    def ask(self, send, matches, kind, what):
        """Sends and waits for the answer, some times over: UDP may lose either, and the protocols say to repeat."""
        for attempt in range(ATTEMPTS):
            with self.lock:
                send(attempt)
            end = time.monotonic() + PATIENCE
            while (left := end - time.monotonic()) > 0:
                message = self.listen(kind, timeout=left)
                if message is not None and matches(message):
                    return message
        raise AssertionError(f"{what}: no answer to {ATTEMPTS} attempts; texts: {self.texts}")

    def command(self, command, *params):
        """Sends COMMAND_LONG and returns the result of its acknowledgement."""
        filled = list(params) + [0.0] * (7 - len(params))

        def send(attempt):
            self.link.mav.command_long_send(1 + self.system_offset, 1, command, attempt, *filled)

        return self.ask(send, lambda ack: ack.command == command, "COMMAND_ACK", f"command {command}").result

    @property
    def system_offset(self):
        return self.heartbeat.get_srcSystem() - 1

    def until(self, condition, types, timeout=60.0, what=""):
        """Receives until `condition(message)`."""
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            message = self.receive(*types, timeout=timeout)
            if condition(message):
                return message
        raise AssertionError(f"not within {timeout} s: {what}; texts: {self.texts}")

    def vehicle_time(self):
        return self.receive("LOCAL_POSITION_NED", "ATTITUDE").time_boot_ms * 1e-3

    def wait_vehicle_seconds(self, seconds, timeout=120.0):
        end = self.vehicle_time() + seconds
        self.until(lambda m: m.time_boot_ms * 1e-3 >= end, ["LOCAL_POSITION_NED"], timeout, "vehicle time")

    def wait_text(self, part, timeout=30.0):
        end = time.monotonic() + timeout
        while not any(part in text for text in self.texts):
            assert time.monotonic() < end, f"no text with {part!r}: {self.texts}"
            self.receive("STATUSTEXT", timeout=timeout)

    def wait_armable(self, timeout=60.0):
        bit = MAV.MAV_SYS_STATUS_PREARM_CHECK
        self.until(lambda m: m.onboard_control_sensors_health & bit, ["SYS_STATUS"], timeout, "armable")

    def until_beat(self, condition, timeout, what):
        """Of the autopilot: the winch has a heartbeat too."""
        own = MAV.MAV_COMP_ID_AUTOPILOT1
        self.until(lambda m: m.get_srcComponent() == own and condition(m), ["HEARTBEAT"], timeout, what)

    def wait_mode(self, custom_mode, timeout=120.0):
        self.until_beat(lambda m: m.custom_mode == custom_mode, timeout, f"mode {custom_mode:#x}")

    def wait_armed(self, armed, timeout=120.0):
        bit = MAV.MAV_MODE_FLAG_SAFETY_ARMED
        self.until_beat(lambda m: bool(m.base_mode & bit) == armed, timeout, f"armed {armed}")

    def parameters(self):
        """All parameters by name: the list, then one by one whatever of it was lost."""
        with self.lock:
            self.link.mav.param_request_list_send(1 + self.system_offset, 1)
        found = {}
        while (message := self.listen("PARAM_VALUE", timeout=PATIENCE)) is not None:
            found[message.param_index] = message
            if len(found) == message.param_count:
                break
        first = found.get(0) or self._read(b"", 0)
        for index in set(range(first.param_count)) - found.keys():
            found[index] = self._read(b"", index)
        return {message.param_id: message.param_value for message in found.values()}

    def set_parameter(self, name, value):
        def send(_):
            self.link.mav.param_set_send(1 + self.system_offset, 1, name.encode(), value, MAV.MAV_PARAM_TYPE_REAL32)

        return self.ask(send, lambda m: m.param_id == name, "PARAM_VALUE", name).param_value

    def read_parameter(self, name):
        return self._read(name.encode(), -1).param_value

    def _read(self, name, index):
        def send(_):
            self.link.mav.param_request_read_send(1 + self.system_offset, 1, name, index)

        def matches(message):
            return message.param_index == index if index >= 0 else message.param_id == name.decode()

        return self.ask(send, matches, "PARAM_VALUE", f"parameter {name or index}")

    def arm(self):
        assert self.command(MAV.MAV_CMD_COMPONENT_ARM_DISARM, 1) == MAV.MAV_RESULT_ACCEPTED, self.texts
        self.wait_armed(True)

    def take_off(self, altitude):
        result = self.command(MAV.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, NAN, NAN, NAN, altitude)
        assert result == MAV.MAV_RESULT_ACCEPTED, self.texts
        self.wait_mode(TAKEOFF)
        self.wait_mode(HOLD)

    def move_azimuth(self, azimuth):
        """Moves round the anchor; waits until there."""
        result = self.command(USER_MOVE_TETHER, NAN, math.degrees(azimuth), NAN, NAN)
        assert result == MAV.MAV_RESULT_ACCEPTED, self.texts
        self.until(
            lambda m: m.name == "tet_azim" and abs(m.value - math.degrees(azimuth)) < 3.0,
            ["NAMED_VALUE_FLOAT"], 120.0, "azimuth",
        )

    def land(self):
        assert self.command(MAV.MAV_CMD_NAV_LAND) == MAV.MAV_RESULT_ACCEPTED, self.texts
        self.wait_armed(False)


def holding(sitl, tmp_path, scenario, altitude, *options):
    """The vehicle of a scenario without its mission, taken off and holding: here the ground station flies."""
    bare = tmp_path / scenario.name
    bare.write_text(scenario.read_text().split("[[mission]]")[0])
    vehicle = sitl("--speedup", "8", "--scenario", bare, "--seed", "1", *options)
    station = GroundStation(vehicle.program_port)
    station.wait_armable()
    station.arm()
    station.take_off(altitude)
    station.wait_vehicle_seconds(3)
    return vehicle, station


def end(vehicle, station):
    """Back to the hold, down, and the simulator's last words."""
    assert station.command(MAV.MAV_CMD_DO_SET_MODE, 1, 4, 3) == MAV.MAV_RESULT_ACCEPTED
    station.wait_mode(HOLD)
    station.wait_vehicle_seconds(3)
    station.land()
    station.close()
    output, code = vehicle.end()
    assert code == 0, output
