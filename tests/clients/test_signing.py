"""A signed link: who holds the key flies, others may look, and a recording is nobody."""

import random
import socket
import time

from groundstation import MAV, NAN, GroundStation
from pymavlink import mavutil

KEY = random.Random(1).randbytes(32)
ARM = MAV.MAV_CMD_COMPONENT_ARM_DISARM


class Signer(GroundStation):
    """A ground station that signs, and keeps what it sends."""

    def __init__(self, port, key=KEY):
        self.key, self.sent = key, []
        super().__init__(port)

    def _beat(self, period):
        self.link.setup_signing(self.key, sign_outgoing=True, allow_unsigned_callback=lambda *_: True, link_id=1)
        send = self.link.write

        def write(datagram):
            self.sent.append(bytes(datagram))
            send(datagram)

        self.link.write = write
        super()._beat(period)


def stranger(vehicle, key):
    """At a port of its own, signing with another key or not at all."""
    address = f"udpout:127.0.0.1:{vehicle.vehicle_port}"
    link = mavutil.mavlink_connection(address, source_system=200, dialect="common")
    if key is not None:
        link.setup_signing(key, sign_outgoing=True, allow_unsigned_callback=lambda *_: True)
    return link


def result(link, system, command, *params):
    """Of one COMMAND_LONG, or None."""
    # What came while nobody read has filled the socket.
    while link.recv_match(blocking=False) is not None:
        pass
    link.mav.command_long_send(system, 1, command, 0, *params, *[0.0] * (7 - len(params)))
    end = time.monotonic() + 3
    while time.monotonic() < end:
        # Past the client's own check of signatures: the vehicle's are not the stranger's.
        ack = link.recv_match(type="COMMAND_ACK", blocking=True, timeout=0.5)
        if ack is not None and ack.command == command:
            return ack.result
    return None


def start(sitl, key_file, instance=None):
    vehicle = sitl("--speedup", "8", "--signing-key", key_file, instance=instance)
    station = Signer(vehicle.program_port)
    station.wait_armable()
    return vehicle, station


def end(vehicle, station):
    station.close()
    output, code = vehicle.end()
    assert code == 0, output
    return output


def test_who_holds_the_key_flies_and_others_are_denied(sitl, tmp_path):
    key_file = tmp_path / "key"
    key_file.write_bytes(KEY)
    vehicle, station = start(sitl, key_file)
    system = 1 + station.system_offset
    unsigned, wrong = stranger(vehicle, None), stranger(vehicle, bytes(32))
    for link in (unsigned, wrong):
        assert result(link, system, ARM, 1) == MAV.MAV_RESULT_DENIED
    # They may look.
    assert result(unsigned, system, MAV.MAV_CMD_REQUEST_MESSAGE, 148) == MAV.MAV_RESULT_ACCEPTED
    unsigned.mav.param_request_read_send(system, 1, b"VEH_MASS", -1)
    assert unsigned.recv_match(type="PARAM_VALUE", blocking=True, timeout=3).param_value == 1.5
    unsigned.mav.param_set_send(system, 1, b"VEH_MASS", 2.0, MAV.MAV_PARAM_TYPE_REAL32)

    station.arm()
    station.take_off(5.0)
    for link in (unsigned, wrong):
        assert result(link, system, MAV.MAV_CMD_DO_FLIGHTTERMINATION, 1) == MAV.MAV_RESULT_DENIED
    station.land()
    assert station.read_parameter("VEH_MASS") == 1.5
    assert "Landed, disarmed" in end(vehicle, station)


def test_a_recording_is_refused_after_a_restart(sitl, tmp_path):
    key_file = tmp_path / "key"
    key_file.write_text(KEY.hex())
    vehicle, station = start(sitl, key_file)
    station.sent.clear()
    station.arm()
    recorded = [one for one in station.sent if one[7:10] == (76).to_bytes(3, "little")]
    assert recorded
    assert station.command(ARM, 0) == MAV.MAV_RESULT_ACCEPTED
    station.wait_armed(False)
    end(vehicle, station)

    # The same system id: the recording is for that one.
    vehicle, station = start(sitl, key_file, vehicle.instance)
    replay(vehicle, recorded)
    station.wait_vehicle_seconds(3)
    armed = station.until(lambda _: True, ["HEARTBEAT"]).base_mode & MAV.MAV_MODE_FLAG_SAFETY_ARMED
    assert not armed, "armed by a recording"
    station.arm()
    assert station.command(ARM, 0) == MAV.MAV_RESULT_ACCEPTED
    assert end(vehicle, station).count("Armed") == 1


def replay(vehicle, datagrams):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as thief:
        for datagram in datagrams:
            thief.sendto(datagram, ("127.0.0.1", vehicle.vehicle_port))
