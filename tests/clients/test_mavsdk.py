"""MAVSDK over gRPC, unmodified: whole flights, by its own calls and offboard."""

import asyncio
import itertools

from calls import first, last
from mavsdk_grpc import System
from mavsdk_grpc.offboard import Attitude, OffboardError, PositionNedYaw, VelocityNedYaw
from mavsdk_grpc.shell import Device

# A server of its own for each: the last one may not have freed its port yet.
SERVERS = itertools.count(50_060)


async def connect(port):
    drone = System(port=next(SERVERS))
    await drone.connect(system_address=f"udpin://0.0.0.0:{port}")
    await first(drone.core.connection_state(), lambda state: state.is_connected)
    health = await first(drone.telemetry.health(), lambda health: health.is_armable)
    assert health.is_local_position_ok
    return drone


async def mode(drone, name):
    await first(drone.telemetry.flight_mode(), lambda mode: str(mode) == name)


async def place(drone, condition=lambda place: True):
    return (await first(drone.telemetry.position_velocity_ned(), lambda item: condition(item.position))).position


async def take_off(drone):
    await drone.action.arm()
    await drone.action.takeoff()
    await mode(drone, "TAKEOFF")
    await mode(drone, "HOLD")


async def disarmed(drone):
    await first(drone.telemetry.armed(), lambda armed: not armed)


def flown(sitl, flight, code=0):
    """What a flight returns, and what the vehicle said."""
    vehicle = sitl("--speedup", "4")

    async def whole():
        return await flight(await connect(vehicle.program_port))

    try:
        result = asyncio.run(asyncio.wait_for(whole(), 90))
    finally:
        output, ended = vehicle.end()
        # Shown where the test fails: what the vehicle said.
        print(output)
    assert ended == code, output
    return result, output


def test_mavsdk_arms_takes_off_holds_and_lands(sitl):
    async def fly(drone):
        assert abs(await drone.param.get_param_float("VEH_MASS") - 1.5) < 1e-6
        assert await drone.param.get_param_int("SYS_AUTOSTART") == 4001
        await take_off(drone)
        at = await place(drone)
        await drone.action.hold()
        await drone.action.land()
        await disarmed(drone)
        return at

    at, output = flown(sitl, fly)
    assert abs(at.down_m + 5.0) < 0.3 and abs(at.north_m - 8.66) < 0.8, at
    assert "Landed, disarmed" in output


def test_mavsdk_flies_offboard_and_returns(sitl):
    async def fly(drone):
        await take_off(drone)
        offboard, before = drone.offboard, await place(drone)
        try:
            await offboard.start()
            raise AssertionError("started without a set-point")
        except OffboardError:
            pass
        east = before.east_m - 1.5
        await offboard.set_position_ned(PositionNedYaw(before.north_m, east, before.down_m, 0.0))
        await offboard.start()
        await mode(drone, "OFFBOARD")
        assert await offboard.is_active()
        # From the anchor, as the telemetry counts.
        await place(drone, lambda at: abs(at.east_m - east) < 0.3)
        await offboard.set_velocity_ned(VelocityNedYaw(0.0, 0.5, 0.0, 0.0))
        await place(drone, lambda at: at.east_m > east + 1.0)
        await offboard.set_attitude(Attitude(5.0, 0.0, 0.0, 0.6))
        await first(drone.telemetry.attitude_euler(), lambda at: abs(at.roll_deg - 5.0) < 1.5)
        await offboard.stop()
        await mode(drone, "HOLD")
        assert not await offboard.is_active()
        await drone.action.return_to_launch()
        await mode(drone, "RETURN_TO_LAUNCH")
        await disarmed(drone)

    _, output = flown(sitl, fly)
    assert "Landed, disarmed" in output


def test_mavsdk_terminates_in_the_air_at_once(sitl):
    async def fly(drone):
        await take_off(drone)
        await drone.action.terminate()
        await asyncio.wait_for(disarmed(drone), 2.0)

    # It falls, and the simulator says with what.
    _, output = flown(sitl, fly, code=1)
    assert "Flight terminated: motors stopped" in output


def test_mavsdk_reads_what_the_vehicle_keeps(sitl, tmp_path):
    async def fly(drone):
        parameters = await drone.param.get_all_params()
        names = {one.name for one in parameters.int_params + parameters.float_params}
        assert {"VEH_MASS", "SYS_AUTOSTART", "FS_LINK_ACT"} <= names

        [*_, entry] = await drone.log_files.get_entries()
        log = tmp_path / "fetched"
        await last(drone.log_files.download_log_file(entry, str(log)))
        assert log.stat().st_size == entry.size_bytes

        files = (await drone.ftp.list_directory("/etc/extras")).entries
        assert {one.name for one in files} == {"component_general.json", "parameters.json"}
        await last(drone.ftp.download("/etc/extras/parameters.json", str(tmp_path), True))
        assert "VEH_MASS" in (tmp_path / "parameters.json").read_text()

        shown = asyncio.ensure_future(first(drone.shell.receive(), lambda shown: "tether" in shown.data))
        await asyncio.sleep(0.2)
        await drone.shell.send("help\n", Device.SHELL)
        await asyncio.wait_for(shown, 5)
        return log.read_bytes()

    fetched, output = flown(sitl, fly)
    [whole] = tmp_path.glob("*.ulg")
    assert whole.read_bytes().startswith(fetched)


def test_mavsdk_has_the_rates_it_asks_for(sitl):
    async def fly(drone):
        await drone.telemetry.set_rate_odometry(50.0)

        async def count():
            seen = 0
            async for _ in drone.telemetry.odometry():
                seen += 1
                if seen == 100:
                    return

        # Of the vehicle's seconds: a quarter as many here.
        await asyncio.wait_for(count(), 2.0)

    flown(sitl, fly)


def test_mavsdk_works_the_winch(sitl):
    async def fly(drone):
        async def length(condition):
            return await first(drone.winch.status(), lambda status: condition(status.line_length_m))

        # On the ground: in the air a vehicle whose line is hauled about may come down by itself.
        before = (await length(lambda _: True)).line_length_m
        await drone.winch.lock(1)
        await first(drone.winch.status(), lambda status: status.status_flags.locked)
        await drone.winch.relative_length_control(1, 0.5, 0.5)
        await length(lambda now: now > before + 0.4)
        await drone.winch.rate_control(1, -0.2)
        await length(lambda now: now < before + 0.2)
        await drone.winch.retract(1)
        await drone.winch.relax(1)
        await drone.winch.rate_control(1, 0.0)

    flown(sitl, fly)
