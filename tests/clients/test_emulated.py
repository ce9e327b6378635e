"""The F405 image's own UART driver, under QEMU, with pymavlink at the other end of the wire."""

import os
import signal
import socket
import subprocess

import pytest
from conftest import ROOT, sitl_binary
from groundstation import MAV, GroundStation
from test_signing import ARM, KEY, Signer, result

IMAGE = ROOT / "target" / "images" / "emulated-f405.elf"
SCENARIO = ROOT / "sitl" / "scenarios" / "fixed.toml"


@pytest.fixture
def board(request, tmp_path):
    """The emulated board's serial port; its clock starts when somebody connects. The parameter: a key in its flash."""
    assert IMAGE.exists(), f"{IMAGE} is missing: cargo xtask size"
    bare = tmp_path / "bare.toml"
    bare.write_text(SCENARIO.read_text().split("[[mission]]")[0])
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    command = [sitl_binary(), "emulate", "--image", IMAGE, "--scenario", bare, "--telemetry", str(port)]
    if key := getattr(request, "param", None):
        (tmp_path / "key").write_bytes(key)
        command += ["--signing-key", tmp_path / "key"]
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


@pytest.mark.parametrize("board", [KEY], indirect=True)
def test_a_board_with_a_key_hears_over_its_uart_who_signs(board):
    station = Signer(board)
    station.wait_armable()
    # One wire, so the stranger speaks in between.
    station.link.mav.signing.sign_outgoing = False
    assert result(station.link, 1, ARM, 1) == MAV.MAV_RESULT_DENIED
    station.link.mav.signing.sign_outgoing = True
    station.arm()
    station.command(ARM, 0)
    station.wait_armed(False)
    station.close()
