"""What a link may do to a vehicle in flight: die, talk nonsense, ask for anything."""

import os
import random
import re
import socket
import struct
import time

from flightlog import LAND, FlightLog
from groundstation import HOLD, MAV, NAN, GroundStation


def airborne(sitl, *arguments):
    vehicle = sitl("--speedup", "8", *arguments)
    station = GroundStation(vehicle.program_port)
    station.wait_armable()
    station.arm()
    station.take_off(5.0)
    return vehicle, station


def test_a_killed_client_ends_in_a_landing_and_a_whole_log(sitl):
    vehicle, station = airborne(sitl, "--duration", "300", "--param", "FS_LINK_T=20")
    station.close()
    output, code = vehicle.wait(120)
    assert code == 0, output
    assert "Ground station lost" in output and "Landed, disarmed" in output
    log = FlightLog(vehicle.log())
    assert log.is_whole() and log.is_disarmed_at_end()
    assert LAND in log.modes()
    last = log.time("vehicle_attitude")[-1]
    assert last > 299.0, "the log ends early"


def frame(message_id, payload, extra_crc, corrupt=False, length=None):
    """A MAVLink 2 frame by hand, with its length or checksum wrong on demand."""
    from pymavlink.generator.mavcrc import x25crc

    size = len(payload) if length is None else length
    head = struct.pack("<BBBBBB", size, 0, 0, 0, 255, 190) + message_id.to_bytes(3, "little")
    crc = x25crc(head + payload)
    crc.accumulate(struct.pack("B", extra_crc))
    value = crc.crc ^ 0x5555 if corrupt else crc.crc
    return b"\xfd" + head + payload + struct.pack("<H", value)


def nonsense(seed=1):
    """10 MB of random bytes, then frames that are wrong in every way."""
    rng = random.Random(seed)
    for _ in range(7_200):
        yield rng.randbytes(1_400)
    long = struct.pack("<fffffffHBBB", 1, 0, 0, 0, 0, 0, 0, 400, 1, 1, 0)
    for _ in range(200):
        good = frame(76, long, 152)
        yield good[: rng.randrange(1, len(good))]
        yield frame(76, long, 152, corrupt=True)
        yield frame(76, long, 152, length=rng.randrange(256))
        # Sixteen bytes without a closing zero, known to nobody.
        yield frame(23, struct.pack("<fBB16sB", 1.0, 0, 0, b"A" * 16, 9), 168)
        # NaN set-points, by message and by command.
        yield frame(84, struct.pack("<I11fHBBB", 0, *[NAN] * 11, 0, 0, 0, 1), 143)
        yield frame(75, struct.pack("<ffffiifHBBBBB", NAN, NAN, NAN, NAN, 2**31 - 1, 2**31 - 1, 1e30, 192, 0, 0, 6, 0, 0), 158)
        yield frame(76, struct.pack("<fffffffHBBB", *[NAN] * 7, 400, 0, 0, 0), 152)
        yield frame(76, struct.pack("<fffffffHBBB", 1e30, -1e30, 1e30, 1e30, 0, 0, 0, 31010, 0, 0, 0), 152)
        yield frame(23, struct.pack("<fBB16sB", NAN, 0, 0, b"VEH_MASS\0\0\0\0\0\0\0\0", 9), 168)
        yield frame(69, struct.pack("<hhhhHB", 32767, -32768, 5000, 1, 0, 0), 243)


def test_garbage_in_flight_changes_nothing_and_is_counted(sitl):
    vehicle, station = airborne(sitl)
    stranger = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sent = 0
    for count, datagram in enumerate(nonsense()):
        stranger.sendto(datagram, ("127.0.0.1", vehicle.vehicle_port))
        sent += len(datagram)
        # Keep the receiver's buffer from dropping what it should have to digest. By the clock: messages
        # that wait in the station's own buffer would pace nothing.
        if count % 50 == 0:
            time.sleep(0.04)
    assert sent > 10_000_000
    stranger.close()
    station.wait_mode(HOLD)
    station.wait_vehicle_seconds(5.0)
    station.land()
    output, code = vehicle.end()
    station.close()
    assert code == 0, output
    assert "panicked" not in output
    # What did not happen is not told.
    count = {what: int(n) for n, what in re.findall(r"(\d+) (frames dropped|bytes dropped|refused)", output)}
    frames, lost, refused = (count.get(what, 0) for what in ("frames dropped", "bytes dropped", "refused"))
    print(f"{sent} bytes sent; {frames} frames and {lost} bytes dropped, {refused} refused")
    assert frames > 200 and lost > 5_000_000 and refused > 500
    assert FlightLog(vehicle.log()).is_whole()


def test_every_command_is_acknowledged_and_services_answer(sitl):
    vehicle = sitl("--speedup", "4")
    station = GroundStation(vehicle.program_port)
    assert station.command(12345) == MAV.MAV_RESULT_UNSUPPORTED
    assert station.command(MAV.MAV_CMD_REQUEST_MESSAGE, 148) == MAV.MAV_RESULT_ACCEPTED
    version = station.receive("AUTOPILOT_VERSION")
    assert version.flight_sw_version >= (1 << 24 | 4 << 16 | 1 << 8)
    assert station.command(MAV.MAV_CMD_SET_MESSAGE_INTERVAL, 85, 20_000) == MAV.MAV_RESULT_ACCEPTED
    assert station.command(MAV.MAV_CMD_GET_MESSAGE_INTERVAL, 85) == MAV.MAV_RESULT_ACCEPTED
    assert station.receive("MESSAGE_INTERVAL").interval_us == 20_000
    station.link.mav.mission_request_list_send(1 + station.system_offset, 1)
    assert station.receive("MISSION_COUNT").count == 0
    station.link.mav.file_transfer_protocol_send(0, 1 + station.system_offset, 1, bytes(251))
    assert station.receive("FILE_TRANSFER_PROTOCOL").payload[3] == 128
    for name in ["ODOMETRY", "ESTIMATOR_STATUS", "BATTERY_STATUS", "ATTITUDE_QUATERNION", "EXTENDED_SYS_STATE",
                 "HOME_POSITION", "GLOBAL_POSITION_INT", "WINCH_STATUS", "NAMED_VALUE_FLOAT", "LOCAL_POSITION_NED"]:
        station.receive(name)
    # Integers travel bytewise under the PX4 identity.
    raw = struct.pack("<f", station.read_parameter("SYS_AUTOSTART"))
    assert struct.unpack("<i", raw)[0] == 4001
    station.wait_text("Levelled")
    station.texts.clear()
    assert station.command(MAV.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == MAV.MAV_RESULT_ACCEPTED
    station.wait_text("Levelled")
    output, code = vehicle.end()
    station.close()
    assert code == 0 and os.path.exists(vehicle.log()), output


def test_only_the_vehicle_says_whether_it_is_armed(sitl):
    """Some clients, as DroneKit, believe every component of the system."""
    vehicle = sitl("--speedup", "4")
    station = GroundStation(vehicle.program_port)
    heard = {}
    while len(heard) < 2:
        beat = station.receive("HEARTBEAT")
        heard[beat.get_srcComponent()] = beat.base_mode & MAV.MAV_MODE_FLAG_SAFETY_ARMED
    station.close()
    vehicle.end()
    assert heard == {1: 0, 169: 0}
