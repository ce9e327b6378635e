"""MAVSDK, unmodified: connect, parameters, arm, take off, hold, land."""

import asyncio

from mavsdk_grpc import System


async def first(stream, condition=lambda item: True):
    async for item in stream:
        if condition(item):
            return item


async def fly(port):
    drone = System()
    await drone.connect(system_address=f"udpin://0.0.0.0:{port}")
    await first(drone.core.connection_state(), lambda state: state.is_connected)
    health = await first(drone.telemetry.health(), lambda health: health.is_armable)
    assert health.is_local_position_ok
    assert abs(await drone.param.get_param_float("VEH_MASS") - 1.5) < 1e-6
    assert await drone.param.get_param_int("SYS_AUTOSTART") == 4001
    await drone.action.arm()
    await drone.action.takeoff()
    await first(drone.telemetry.flight_mode(), lambda mode: str(mode) == "TAKEOFF")
    await first(drone.telemetry.flight_mode(), lambda mode: str(mode) == "HOLD")
    place = (await first(drone.telemetry.position_velocity_ned())).position
    await drone.action.land()
    await first(drone.telemetry.armed(), lambda armed: not armed)
    return place


def test_mavsdk_arms_takes_off_holds_and_lands(sitl):
    vehicle = sitl("--speedup", "4")
    try:
        place = asyncio.run(asyncio.wait_for(fly(vehicle.program_port), 90))
    finally:
        output, code = vehicle.end()
        # Shown where the test fails: what the vehicle said.
        print(output)
    assert code == 0, output
    assert abs(place.down_m + 5.0) < 0.3 and abs(place.north_m - 8.66) < 0.8, place
    assert "Landed, disarmed" in output
