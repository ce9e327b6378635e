"""MAVSDK 4, which speaks by a library of its own instead of a server: a flight, and the calls that matter."""

import asyncio
import importlib
import os
import subprocess
import sys
from pathlib import Path

from calls import DONE, first, last, outcome
from mavsdk.asyncio.mavsdk import Configuration, Mavsdk
from mavsdk.component_type import ComponentType
from mavsdk.plugins.offboard.offboard import PositionNedYaw, VelocityNedYaw


PLUGINS = "telemetry action param offboard winch ftp info log_files shell calibration".split()


def plugin(name, system):
    module = importlib.import_module(f"mavsdk.asyncio.plugins.{name}.{name}")
    of_class = "".join(part.capitalize() for part in name.split("_")) + "Async"
    return getattr(module, of_class)(system)


async def fly(port, folder):
    configuration = Configuration.create_with_component_type(ComponentType.GROUND_STATION)
    sdk = Mavsdk(configuration)
    await sdk.add_any_connection(f"udpin://0.0.0.0:{port}")
    system = await sdk.first_autopilot(timeout_s=10.0)
    assert system is not None
    of = {name: plugin(name, system) for name in PLUGINS}
    await first(of["telemetry"].subscribe_health(), lambda health: health.is_armable)
    await on_the_ground(of, folder)
    await in_the_air(of)
    # It may crash where it is taken down (4.1.0, in the FTP plugin's end): leave without.
    print("flown", flush=True)
    os._exit(0)


async def on_the_ground(of, folder):
    param, ftp, winch = of["param"], of["ftp"], of["winch"]
    expected = {
        "version": (of["info"].get_version(), DONE),
        "all parameters": (param.get_all_params(), DONE),
        "a parameter": (param.get_param_float("VEH_MASS"), DONE),
        "an unknown one": (param.get_param_float("NOSUCH"), "DOES_NOT_EXIST"),
        "too much": (param.set_param_float("VEH_MASS", 1e9), "VALUE_OUT_OF_RANGE"),
        "the wrong type": (param.get_param_int("VEH_MASS"), "WRONG_TYPE"),
        "a folder": (ftp.list_directory("/log"), DONE),
        "a file": (last(ftp.download("/etc/extras/parameters.json", str(folder), True)), DONE),
        "no file": (last(ftp.download("/nosuch", str(folder), True)), "FILE_DOES_NOT_EXIST"),
        "logs": (of["log_files"].get_entries(), DONE),
        "gyro": (last(of["calibration"].calibrate_gyro()), DONE),
        "accelerometer": (last(of["calibration"].calibrate_accelerometer()), "UNSUPPORTED"),
        "winch": (first(winch.subscribe_status()), DONE),
        "winch's rate": (winch.rate_control(1, 0.2), DONE),
        # Zero gives the drum back to the tension.
        "winch's end": (winch.rate_control(1, 0.0), DONE),
        "winch's load": (winch.load_payload(1), "UNSUPPORTED"),
        "shell": (of["shell"].send("help\n", 0), DONE),
        "offboard without a set-point": (of["offboard"].start(), "NO_SETPOINT_SET"),
        "shutdown": (of["action"].shutdown(), "UNSUPPORTED"),
    }
    found = {name: await outcome(call) for name, (call, _) in expected.items()}
    assert found == {name: result for name, (_, result) in expected.items()}
    assert "VEH_MASS" in (folder / "parameters.json").read_text()


async def in_the_air(of):
    telemetry, action, offboard = of["telemetry"], of["action"], of["offboard"]

    async def mode(name):
        await first(telemetry.subscribe_flight_mode(), lambda mode: mode.name == name)

    async def place(condition=lambda place: True):
        stream = telemetry.subscribe_position_velocity_ned()
        return (await first(stream, lambda item: condition(item.position))).position

    await first(telemetry.subscribe_health(), lambda health: health.is_armable)
    await action.arm()
    await action.takeoff()
    await mode("TAKEOFF")
    await mode("HOLD")
    at = await place()
    assert abs(at.down_m + 5.0) < 0.3
    await action.hold()
    east = at.east_m - 1.0
    await offboard.set_position_ned(PositionNedYaw(at.north_m, east, at.down_m, 0.0))
    await offboard.start()
    await place(lambda at: abs(at.east_m - east) < 0.3)
    await offboard.set_velocity_ned(VelocityNedYaw(0.0, 0.5, 0.0, 0.0))
    await place(lambda at: at.east_m > east + 0.7)
    await offboard.stop()
    await mode("HOLD")
    await action.land()
    await first(telemetry.subscribe_armed(), lambda armed: not armed)


def test_mavsdk_4_flies_and_reads(sitl, tmp_path):
    folder = tmp_path / "fetched"
    folder.mkdir()
    vehicle = sitl("--speedup", "4")
    # In a process of its own: what a library does to its process is not the test's end.
    command = [sys.executable, __file__, str(vehicle.program_port), str(folder)]
    try:
        flown = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=55)
    finally:
        output, code = vehicle.end()
        print(output)
    assert flown.returncode == 0 and "flown" in flown.stdout, flown.stdout
    assert code == 0, output
    assert "Landed, disarmed" in output


if __name__ == "__main__":
    asyncio.run(fly(int(sys.argv[1]), Path(sys.argv[2])))
