"""Every call of MAVSDK ends: done, or refused with a name. None hangs, and none that the vehicle can answer times out."""

import asyncio
import tempfile
from enum import Enum

import pytest
from calls import DONE, first, last, outcomes
from conftest import Sitl
from mavsdk_grpc.action import OrbitYawBehavior, RelayCommand
from mavsdk_grpc.camera import Mode
from mavsdk_grpc.component_metadata import MetadataType
from mavsdk_grpc.failure import FailureType, FailureUnit
from mavsdk_grpc.gimbal import ControlMode, GimbalMode, SendMode
from mavsdk_grpc.mission import MissionItem, MissionPlan
from mavsdk_grpc.mission_raw import MissionItem as RawItem
from mavsdk_grpc.shell import Device
from mavsdk_grpc.tune import SongElement, TuneDescription
from test_mavsdk import connect

NAN = float("nan")
ITEM = MissionItem(
    47.39775, 8.5456, 5, 1, True, NAN, NAN, MissionItem.CameraAction.NONE, NAN, NAN, NAN, NAN, NAN,
    MissionItem.VehicleAction.NONE,
)
RAW = RawItem(0, 6, 16, 1, 1, 0, 0, 0, NAN, 473977500, 85456000, 5.0, 0)
SILENCE = "TIMEOUT"
SCRATCH = tempfile.TemporaryDirectory()
FETCHED = f"{SCRATCH.name}/."

STREAMS = """position home in_air landed_state armed attitude_quaternion attitude_euler attitude_angular_velocity_body
velocity_ned battery flight_mode health odometry position_velocity_ned imu scaled_imu heading altitude
actuator_output_status distance_sensor unix_epoch_time""".split()
RATES = """position home in_air landed_state attitude_quaternion attitude_euler velocity_ned battery
actuator_output_status odometry position_velocity_ned imu scaled_imu unix_epoch_time distance_sensor altitude
health""".split()
# What the vehicle has not, its sensors being what they are.
NO_RATES = "gps_info raw_gps actuator_control_target ground_truth raw_imu".split()


def label(argument):
    if isinstance(argument, Enum):
        return argument.name
    # Of a path on this machine its end, of an object its class.
    is_plain = isinstance(argument, int | float | str)
    return str(argument).strip().split("/")[-1] if is_plain else type(argument).__name__


def of(plugin, method, expected, *arguments, call=None):
    """A row: its name, the call, what it ends in."""
    name = " ".join([f"{plugin}.{method}", *map(label, arguments)])

    def run(drone):
        bound = getattr(getattr(drone, plugin), method)
        return (call or (lambda method, *given: method(*given)))(bound, *arguments)

    return name, run, expected


def stream(method, *arguments):
    return first(method(*arguments))


def whole(method, *arguments):
    return last(method(*arguments))


CALLS = [
    *[of("telemetry", name, DONE, call=stream) for name in STREAMS],
    *[of("telemetry", f"set_rate_{name}", DONE, 5.0) for name in RATES],
    *[of("telemetry", f"set_rate_{name}", "UNSUPPORTED", 5.0) for name in NO_RATES],
    of("telemetry", "get_gps_global_origin", DONE),
    *[of("info", name, DONE) for name in ["get_identification", "get_product", "get_version"]],
    of("param", "get_all_params", DONE),
    of("param", "get_param_float", DONE, "VEH_MASS"),
    of("param", "get_param_int", DONE, "FS_LINK_ACT"),
    of("param", "set_param_float", DONE, "TPC_P", 1.25),
    of("param", "set_param_int", DONE, "FS_LINK_ACT", 2),
    of("param", "get_param_float", "DOES_NOT_EXIST", "NOSUCH"),
    of("param", "set_param_float", "DOES_NOT_EXIST", "NOSUCH", 1.0),
    of("param", "set_param_float", "VALUE_OUT_OF_RANGE", "VEH_MASS", 1e9),
    of("param", "set_param_int", "VALUE_OUT_OF_RANGE", "FS_LINK_ACT", 9),
    of("param", "get_param_int", "WRONG_TYPE", "VEH_MASS"),
    of("param", "get_param_float", "WRONG_TYPE", "FS_LINK_ACT"),
    of("param", "set_param_int", "TYPE_MISMATCH", "VEH_MASS", 2),
    of("param", "set_param_float", "TYPE_MISMATCH", "FS_LINK_ACT", 2.0),
    of("param", "set_param_custom", "FAILED", "VEH_MASS", "x"),
    # MAVSDK knows no answer but a value.
    of("param", "get_param_custom", SILENCE, "VEH_MASS"),
    of("mission", "clear_mission", DONE),
    of("mission", "start_mission", "DENIED"),
    of("mission", "pause_mission", DONE),
    of("mission", "is_mission_finished", DONE),
    of("mission", "upload_mission", ("INT_MESSAGES_NOT_SUPPORTED", "UNSUPPORTED"), MissionPlan([ITEM])),
    # MAVSDK passes over the MISSION_ACK that refuses.
    of("mission", "set_current_mission_item", SILENCE, 0),
    of("mission_raw", "upload_mission", ("INT_MESSAGES_NOT_SUPPORTED", "UNSUPPORTED"), [RAW]),
    of("mission_raw", "clear_mission", DONE),
    of("mission_raw", "start_mission", "DENIED"),
    of("mission_raw", "set_current_mission_item", "INVALID_ARGUMENT", 0),
    of("mission", "download_mission", DONE),
    of("mission_raw", "download_mission", DONE),
    of("mission_raw", "download_geofence", DONE),
    of("mission_raw", "download_rallypoints", DONE),
    of("geofence", "download_geofence", DONE),
    of("geofence", "clear_geofence", DONE),
    of("shell", "send", DONE, "help\n", Device.SHELL),
    of("calibration", "calibrate_gyro", DONE, call=whole),
    of("calibration", "calibrate_level_horizon", DONE, call=whole),
    of("calibration", "calibrate_accelerometer", "UNSUPPORTED", call=whole),
    of("calibration", "calibrate_magnetometer", "UNSUPPORTED", call=whole),
    # Asked of component 154, which is not there.
    of("calibration", "calibrate_gimbal_accelerometer", SILENCE, call=whole),
    of("calibration", "cancel", DONE),
    of("tune", "play_tune", DONE, TuneDescription([SongElement.NOTE_A], 120)),
    of("failure", "inject", DONE, FailureUnit.SENSOR_DISTANCE_SENSOR, FailureType.OFF, 0),
    of("failure", "inject", DONE, FailureUnit.SENSOR_DISTANCE_SENSOR, FailureType.OK, 0),
    of("failure", "inject", "UNSUPPORTED", FailureUnit.SENSOR_GPS, FailureType.OFF, 0),
    of("log_files", "get_entries", DONE),
    of("ftp", "list_directory", DONE, "/"),
    of("ftp", "list_directory", "FILE_DOES_NOT_EXIST", "/nosuch"),
    of("ftp", "download", "FILE_DOES_NOT_EXIST", "/nosuch", FETCHED, False, call=whole),
    of("ftp", "download", "FILE_DOES_NOT_EXIST", "/nosuch", FETCHED, True, call=whole),
    of("ftp", "upload", "FILE_PROTECTED", __file__, "/", call=whole),
    of("ftp", "create_directory", "FILE_PROTECTED", "/x"),
    of("ftp", "remove_directory", "FILE_PROTECTED", "/log"),
    of("ftp", "remove_file", "FILE_PROTECTED", "/etc/extras/parameters.json"),
    of("ftp", "rename", "FILE_PROTECTED", "/a", "/b"),
    of("ftp", "are_files_identical", DONE, __file__, "/etc/extras/parameters.json"),
    of("winch", "status", DONE, call=stream),
    of("winch", "relax", DONE, 1),
    of("winch", "relative_length_control", DONE, 1, 0.5, 0.5),
    of("winch", "rate_control", DONE, 1, 0.2),
    *[of("winch", name, DONE, 1) for name in ["lock", "hold", "retract"]],
    *[of("winch", name, "UNSUPPORTED", 1) for name in ["deliver", "load_line", "abandon_line", "load_payload"]],
    of("action", "transition_to_fixedwing", "VTOL_TRANSITION_SUPPORT_UNKNOWN"),
    of("action", "transition_to_multicopter", "VTOL_TRANSITION_SUPPORT_UNKNOWN"),
    of("action", "get_takeoff_altitude", DONE),
    of("action", "set_takeoff_altitude", DONE, 5.0),
    of("action", "set_takeoff_altitude", "PARAMETER_ERROR", -5.0),
    of("action", "get_return_to_launch_altitude", DONE),
    of("action", "set_return_to_launch_altitude", "PARAMETER_ERROR", 5.0),
    of("action", "set_current_speed", "UNSUPPORTED", 1.0),
    # The answer is the origin that stays, and MAVSDK waits for the one that it sent.
    of("action", "set_gps_global_origin", SILENCE, 47.0, 8.0, 400.0),
    of("action", "set_home", ("UNSUPPORTED", "COMMAND_DENIED"), True, 0.0, 0.0, 0.0),
    of("action", "set_actuator", "UNSUPPORTED", 1, 0.5),
    of("action", "set_relay", "UNSUPPORTED", 1, RelayCommand.ON),
    of("action", "goto_location", "COMMAND_DENIED", 47.39, 8.54, 490.0, 0.0),
    of("action", "do_orbit", "UNSUPPORTED", 2.0, 1.0, OrbitYawBehavior.UNCONTROLLED, 47.39, 8.54, 490.0),
    of("offboard", "start", "NO_SETPOINT_SET"),
    of("offboard", "is_active", DONE),
    of("manual_control", "start_position_control", "INPUT_NOT_SET"),
    of("manual_control", "set_manual_control_input", DONE, 0.0, 0.0, 0.5, 0.0),
    of("component_metadata", "request_autopilot_component", DONE),
    of("component_metadata", "metadata_available", DONE, call=stream),
    of("component_metadata", "get_metadata", DONE, 1, MetadataType.PARAMETER),
    of("events", "get_health_and_arming_checks_report", "NOT_AVAILABLE"),
    of("gripper", "grab", "UNSUPPORTED", 1),
    of("follow_me", "start", "COMMAND_DENIED"),
    of("log_streaming", "start_log_streaming", "UNSUPPORTED"),
    of("log_streaming", "stop_log_streaming", "UNSUPPORTED"),
    # MAVSDK has no name for the refusal.
    of("transponder", "set_rate_transponder", "UNKNOWN", 1.0),
    of("gimbal", "set_angles", "INVALID_ARGUMENT", 1, 0.0, 0.0, 0.0, GimbalMode.YAW_FOLLOW, SendMode.ONCE),
    of("gimbal", "take_control", "INVALID_ARGUMENT", 1, ControlMode.PRIMARY),
    of("camera", "take_photo", "ACTION_UNSUPPORTED", 1),
    of("camera", "set_mode", "ACTION_UNSUPPORTED", 1, Mode.PHOTO),
    of("info", "get_speed_factor", DONE),
    *[of("action", name, DONE) for name in ["hold", "land", "return_to_launch", "disarm"]],
    # Last: it stays terminated until the reboot.
    of("action", "terminate", DONE),
    of("action", "reboot", DONE),
    of("action", "shutdown", "UNSUPPORTED"),
]
assert len({name for name, _, _ in CALLS}) == len(CALLS), "a name for each"

@pytest.fixture(scope="module")
def ended(tmp_path_factory):
    vehicle = Sitl(tmp_path_factory.mktemp("calls"), "--speedup", "4")

    async def run():
        return await outcomes(CALLS, await connect(vehicle.program_port))

    try:
        yield asyncio.run(asyncio.wait_for(run(), 120))
    finally:
        output, code = vehicle.end()
        print(output)
    assert code == 0


def row(name, _, expected):
    return pytest.param(name, expected, id=name)


@pytest.mark.parametrize("name, expected", [row(*entry) for entry in CALLS])
def test_a_call_ends(ended, name, expected):
    assert ended[name] in ([expected] if isinstance(expected, str) else expected)
