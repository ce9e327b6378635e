"""QGroundControl's sequences as its sources have them: connect, set up, fly, analyse. Nothing is left unanswered."""

import json
import math
import struct

import pytest
from groundstation import HOLD, MAV, NAN
from qgc import AVAILABLE_MODES, HASH, LOG_LIST, MISSION, PARAMETERS, Qgc, crc32

ACCEPTED, DENIED = MAV.MAV_RESULT_ACCEPTED, MAV.MAV_RESULT_DENIED
REPOSITION = MAV.MAV_CMD_DO_REPOSITION
CALIBRATE = MAV.MAV_CMD_PREFLIGHT_CALIBRATION
# What its pages read and report if it is missing: summary, safety, sensors, power, radio, modes, airframe.
READ = """SYS_AUTOSTART SYS_AUTOCONFIG CAL_GYRO0_ID CAL_ACC0_ID CAL_MAG0_ID CAL_MAG1_ID CAL_MAG2_ID CAL_MAG0_ROT SYS_HAS_MAG
SENS_BOARD_ROT SENS_BOARD_X_OFF SENS_BOARD_Y_OFF SENS_BOARD_Z_OFF COM_RC_IN_MODE RC_MAP_ROLL RC_MAP_PITCH RC_MAP_YAW
RC_MAP_THROTTLE RC_MAP_FLAPS RC_MAP_AUX1 RC_MAP_AUX2 BAT1_SOURCE BAT1_V_CHARGED BAT1_V_EMPTY BAT1_N_CELLS
RTL_RETURN_ALT RTL_DESCEND_ALT RTL_LAND_DELAY COM_RC_LOSS_T COM_LOW_BAT_ACT NAV_RCL_ACT NAV_DLL_ACT COM_DL_LOSS_T
BAT_LOW_THR BAT_CRIT_THR GF_ACTION GF_MAX_HOR_DIST GF_MAX_VER_DIST COM_FLTMODE1 COM_FLTMODE6 COM_DISARM_LAND""".split()

# PX4's, which its menu offers: Offboard without a stream, Mission, Acro, and what there is.
MODES = {(6, 0): 1, (4, 4): 2, (5, 0): 2, (3, 0): 1, (2, 0): 1, (4, 3): 0}


@pytest.fixture
def qgc(sitl):
    vehicle = sitl("--speedup", "4")
    station = Qgc(vehicle.program_port)
    yield vehicle, station
    station.close()
    output, code = vehicle.end()
    print(output)
    assert code == 0, output


def listed(station):
    """PARAM_REQUEST_LIST: messages by name; none of them lost, for there is no loss here."""
    with station.lock:
        station.link.mav.param_request_list_send(station.system, 0)
    found = {}
    while (message := station.listen("PARAM_VALUE", timeout=PARAMETERS)) is not None:
        if message.param_index < message.param_count:
            found[message.param_id] = message
        if len(found) == message.param_count:
            return found
    raise AssertionError(f"{len(found)} parameters")


def test_it_connects(qgc):
    _, station = qgc
    version = station.message(148, "AUTOPILOT_VERSION")
    assert version.flight_sw_version >= (1 << 24 | 4 << 16 | 1 << 8)
    assert version.capabilities & MAV.MAV_PROTOCOL_CAPABILITY_FTP

    count = station.message(AVAILABLE_MODES, "AVAILABLE_MODES", 1).number_modes
    names = {station.message(AVAILABLE_MODES, "AVAILABLE_MODES", index).mode_name for index in range(1, count + 1)}
    assert len(names) == count > 5

    crc, uri = station.metadata()
    general = station.file(uri)
    assert crc32(0, general) == crc
    described = {one["type"]: one for one in json.loads(general)["metadataTypes"]}
    parameters = station.file(described[1]["uri"])
    assert crc32(0, parameters) == described[1]["fileCrc"]

    asked = lambda mav: mav.param_request_read_send(station.system, 1, b"_HASH_CHECK", -1)  # noqa: E731
    kept = station.once(asked, "PARAM_VALUE", HASH, lambda m: m.param_id == "_HASH_CHECK")
    found = listed(station)
    crc = 0
    for name in sorted(found):
        crc = crc32(crc32(crc, name.encode()), struct.pack("<f", found[name].param_value))
    assert struct.unpack("<I", struct.pack("<f", kept.param_value))[0] == crc
    assert {one["name"] for one in json.loads(parameters)["parameters"]} == found.keys()
    assert not [name for name in READ if name not in found]
    for name in ["SYS_AUTOSTART", "CAL_GYRO0_ID", "CAL_ACC0_ID"]:
        assert struct.unpack("<i", struct.pack("<f", found[name].param_value))[0] != 0

    for kind in range(3):
        asked = lambda mav: mav.mission_request_list_send(station.system, 1, kind)  # noqa: B023, E731
        count = station.once(asked, "MISSION_COUNT", MISSION, lambda m: m.mission_type == kind)  # noqa: B023
        assert count.count == 0
        with station.lock:
            station.link.mav.mission_ack_send(station.system, 1, 0, kind)


def seen(station, kind="GLOBAL_POSITION_INT"):
    return station.receive(kind, timeout=2)


def reached(station, condition, what, kind="GLOBAL_POSITION_INT"):
    station.until(condition, [kind], 20, what)


def test_it_flies(qgc):
    _, station = qgc
    station.wait_armable()
    seen(station, "HOME_POSITION")
    start = seen(station).alt / 1000
    # Its slider: above the sea, and the pitch that says so; armed after it is accepted.
    take_off = (MAV.MAV_CMD_NAV_TAKEOFF, -1, 0, 0, NAN, NAN, NAN, start + 5)
    assert station.order(*take_off) == ACCEPTED, station.texts
    assert station.order(MAV.MAV_CMD_COMPONENT_ARM_DISARM, 1) == ACCEPTED, station.texts
    reached(station, lambda m: m.alt / 1000 > start + 4.7, "take-off's height")
    station.wait_mode(HOLD)

    assert station.order(REPOSITION, -1, 1, 0, NAN, NAN, NAN, NAN) == ACCEPTED, "pause"
    assert station.order(REPOSITION, -1, 1, 0, NAN, NAN, NAN, start + 6) == ACCEPTED, "change altitude"
    reached(station, lambda m: abs(m.alt / 1000 - start - 6) < 0.2, "the altitude")
    assert station.order(REPOSITION, -1, 1, 0, math.radians(30), NAN, NAN, NAN) == ACCEPTED, "change heading"
    reached(station, lambda m: abs(m.yaw - math.radians(30)) < 0.1, "the heading", "ATTITUDE")
    place = seen(station)
    goto = (REPOSITION, (-1, 1, 0, NAN), place.lat, place.lon + 260, place.alt / 1000)
    assert station.order_at(*goto) == ACCEPTED, station.texts
    reached(station, lambda m: m.lon - place.lon > 200, "two metres to the east")
    beyond = (REPOSITION, (-1, 1, 0, NAN), place.lat + 30_000, place.lon, place.alt / 1000)
    station.texts.clear()
    assert station.order_at(*beyond) == DENIED
    station.wait_text("", timeout=2)

    # Its menu of modes, by what AVAILABLE_MODES and PX4's list have in it.
    found = {mode: station.order(MAV.MAV_CMD_DO_SET_MODE, 1, *mode) for mode in MODES}
    assert found == MODES, station.texts
    station.wait_mode(HOLD)
    for command in [MAV.MAV_CMD_DO_ORBIT, MAV.MAV_CMD_DO_CHANGE_SPEED, MAV.MAV_CMD_DO_SET_ROI_LOCATION]:
        assert station.order(command, 1) == MAV.MAV_RESULT_UNSUPPORTED
    assert station.order(MAV.MAV_CMD_DO_SET_MODE, 1, 4, 6) == ACCEPTED
    station.wait_armed(False)
    station.wait_text("Landed, disarmed")


def test_it_analyses_and_calibrates(qgc):
    vehicle, station = qgc
    station.wait_armable()
    asked = lambda mav: mav.log_request_list_send(station.system, 1, 0, 0xFFFF)  # noqa: E731
    entry = station.once(asked, "LOG_ENTRY", LOG_LIST)
    assert entry.num_logs == 1 and entry.size > 0
    [path] = vehicle.log_dir.glob("*.ulg")
    fetched = station.log(entry)
    assert fetched == path.read_bytes()[: entry.size]

    line = list(b"help\n".ljust(70, b"\0"))
    console = station.once(
        lambda mav: mav.serial_control_send(10, 2 | 4, 0, 0, 5, line), "SERIAL_CONTROL", 2.0, lambda m: m.count > 0
    )
    assert console.flags & 1, "a reply"

    station.texts.clear()
    assert station.order(CALIBRATE, 1) == ACCEPTED
    station.wait_text("[cal] calibration started: 2 gyro", timeout=5)
    station.wait_text("[cal] calibration done: gyro", timeout=10)
    station.texts.clear()
    assert station.order(CALIBRATE, 0, 0, 0, 0, 2) == ACCEPTED
    station.wait_text("[cal] calibration done: level", timeout=10)
    assert station.order(CALIBRATE, 0, 0, 0, 0, 1) == MAV.MAV_RESULT_UNSUPPORTED, "accelerometer"
    assert station.order(MAV.MAV_CMD_PREFLIGHT_STORAGE, 1) == ACCEPTED
    station.texts.clear()
    assert station.order(MAV.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == ACCEPTED
    station.wait_text("Levelled", timeout=10)
