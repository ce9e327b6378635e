"""A simulator per test, on ports of its own."""

import itertools
import os
import re
import signal
import subprocess
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
# From 20: instance 10 would call programs on the ground stations' port, 14550.
INSTANCES = itertools.count(20)


def sitl_binary():
    """`TAUTLINE_SITL`, or the release build."""
    path = Path(os.environ.get("TAUTLINE_SITL", ROOT / "target" / "release" / "sitl"))
    if not path.exists():
        pytest.fail(f"{path} is missing: cargo build --release -p tautline-sitl")
    return path


class Sitl:
    """A running simulator."""

    def __init__(self, log_dir, *arguments, instance=None):
        self.instance = next(INSTANCES) if instance is None else instance
        self.log_dir = log_dir
        command = [sitl_binary(), "--instance", str(self.instance), "--log-dir", log_dir, *map(str, arguments)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.output = None

    @property
    def program_port(self):
        return 14540 + self.instance

    @property
    def vehicle_port(self):
        """Where a stranger can reach the vehicle."""
        return 14580 + self.instance

    def end(self, timeout=60):
        """Ctrl-C, as a user would; what it printed and its exit code."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        return self.wait(timeout)

    def wait(self, timeout):
        if self.output is None:
            self.output, _ = self.process.communicate(timeout=timeout)
        return self.output, self.process.returncode

    def log(self):
        """The path that it names when it ends."""
        named = re.search(r"^Log: (.*)$", self.output, re.M)
        assert named, self.output
        return Path(named.group(1))


@pytest.fixture
def sitl(tmp_path):
    running = []

    def start(*arguments, **options):
        running.append(Sitl(tmp_path, *arguments, **options))
        return running[-1]

    yield start
    for one in running:
        if one.process.poll() is None:
            one.process.kill()
            one.process.communicate()
    time.sleep(0.05)
