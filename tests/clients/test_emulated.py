"""The F405 image's own UART driver, under QEMU, with pymavlink at the other end of the wire."""

import os
import signal
import socket
import subprocess

import pytest
from conftest import ROOT, sitl_binary
from groundstation import GroundStation

IMAGE = ROOT / "target" / "images" / "emulated-f405.elf"
SCENARIO = ROOT / "sitl" / "scenarios" / "fixed.toml"


@pytest.fixture
def board(tmp_path):
    """The emulated board's serial port; its clock starts when somebody connects."""
    assert IMAGE.exists(), f"{IMAGE} is missing: cargo xtask size"
    bare = tmp_path / "bare.toml"
    bare.write_text(SCENARIO.read_text().split("[[mission]]")[0])
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    command = [sitl_binary(), "emulate", "--image", IMAGE, "--scenario", bare, "--telemetry", str(port)]
    process = subprocess.Popen(
        [*command, "--duration", "150", "--out", tmp_path / "emulated"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
    yield f"tcp:127.0.0.1:{port}"
    # The emulator too: it may still wait for somebody to connect.
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()


def test_a_parameter_and_a_flight_over_the_images_uart(board):
    station = GroundStation(board)
    station.wait_armable()
    assert abs(station.set_parameter("TPC_P", 1.25) - 1.25) < 1e-6
    station.arm()
    station.take_off(2.0)
    station.until(lambda m: abs(-m.z - 2.0) < 0.3, ["LOCAL_POSITION_NED"], 20.0, "2 m up")
    station.land()
    station.close()
