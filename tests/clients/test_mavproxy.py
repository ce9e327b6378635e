"""MAVProxy, unmodified, in a terminal of its own: a flight by what a user types."""

import io
import os
import re
import sys
from pathlib import Path

import pexpect
import pytest
from conftest import Sitl

PROGRAM = Path(sys.executable).with_name("mavproxy.py")


class Typed:
    """MAVProxy at a port, and a user's fingers."""

    def __init__(self, port, folder):
        arguments = [str(PROGRAM), f"--master=udp:127.0.0.1:{port}", f"--state-basedir={folder}"]
        # The text is searched: no colours.
        environment = os.environ | {"TERM": "dumb", "HOME": str(folder)}
        self.terminal = pexpect.spawn(
            sys.executable, arguments, cwd=folder, env=environment, encoding="utf-8", dimensions=(200, 200)
        )
        self.shown = self.terminal.logfile_read = io.StringIO()

    def type(self, line, answer, timeout=10):
        self.terminal.sendline(line)
        self.expect(answer, timeout)

    def expect(self, text, timeout):
        self.terminal.expect(text, timeout=timeout)

    def close(self):
        self.terminal.close(force=True)


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    """What the terminal showed, and what the vehicle said."""
    folder = tmp_path_factory.mktemp("mavproxy")
    vehicle = Sitl(tmp_path_factory.mktemp("logs"), "--speedup", "4")
    user = Typed(vehicle.program_port, folder)
    try:
        user.expect(r"Received (\d+) parameters", 20)
        user.type("param show VEH_MASS", r"VEH_MASS\s+1\.5")
        user.type("param set TPC_P 1.25", "TPC_P")
        user.type("param show TPC_P", r"TPC_P\s+1\.25")
        user.type("long DO_SET_MODE 1 4 3", "DO_SET_MODE: ACCEPTED")
        user.type("arm throttle", "AP: Armed")
        user.type("takeoff 5", "NAV_TAKEOFF: ACCEPTED")
        user.expect("Take-off complete, holding", 40)
        user.type("long DO_SET_MODE 1 4 6", "DO_SET_MODE: ACCEPTED")
        user.expect("Landed, disarmed", 40)
        user.type("arm throttle", "AP: Armed")
        user.type("disarm", "AP: Disarmed")
    finally:
        user.close()
        output, code = vehicle.end()
        print(user.shown.getvalue(), output)
    assert code == 0, output
    return user.shown.getvalue(), output


def test_mavproxy_flies_by_what_is_typed(flight):
    shown, output = flight
    assert int(re.search(r"Received (\d+) parameters", shown).group(1)) > 100
    assert "LAND> Mode LAND" in shown
    assert "Landed, disarmed" in output


def test_mavproxy_has_its_parameters_by_ftp(flight):
    assert re.search(r"Received \d+ parameters \(ftp\)", flight[0])


def test_mavproxy_sees_no_fence_breached(flight):
    assert "fence breach" not in flight[0]
