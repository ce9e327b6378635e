"""``python -m tautline.bench``: how many steps a second many worlds make, ours and others', in one run.

``crazyflow`` and ``l2f`` are measured where they are installed. All hover; a step of ours is a millisecond (four steps of
physics with line, winch, ground, wind and battery), of the others one of their own steps, whose length stands beside.
Processor time of this process, one thread where the library lets itself be told.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version

import numpy as np

from . import _native

HOVER_N = 1.5 * 9.81 + 6.5
"""Weight of the default vehicle and its line's pull, N."""
ROTOR_N = 8.1
RESTART_MS = 500
"""Without a controller a hover tips over: it begins anew after so many ms."""


@dataclass(frozen=True)
class Result:
    """A measurement."""

    name: str
    worlds: int
    step_ms: float
    steps_per_cpu_s: float
    simulated_s_per_cpu_s: float
    steps_per_wall_s: float


def _measure(
    name: str, worlds: int, step_ms: float, seconds: float, run: Callable[[], int]
) -> Result:
    run()  # What is compiled or allocated at the first call is no part of it.
    steps, cpu, wall = 0, time.process_time(), time.perf_counter()
    while time.perf_counter() - wall < seconds:
        steps += run()
    used, passed = time.process_time() - cpu, time.perf_counter() - wall
    rate = steps / used
    return Result(name, worlds, step_ms, rate, rate * step_ms * 1e-3, steps / passed)


def ours(worlds: int, seconds: float, threads: int = 1) -> Result:
    """The plant of the default scenario on a straight line."""
    batch = _native.Batch({}, list(range(1, worlds + 1)), threads)
    throttle = np.full((worlds, 4), (HOVER_N / 4 / ROTOR_N) ** (0.5 / 0.75))

    def run() -> int:
        for index in range(worlds):
            batch.reset(index, index + 1, [2.0, 0.0, -20.0])
        batch.step(throttle, 6.5, RESTART_MS)
        return worlds * RESTART_MS

    return _measure("tautline", worlds, 1.0, seconds, run)


def crazyflow(worlds: int, seconds: float) -> Result:
    """Crazyflow's first-principles dynamics by Euler's rule at 1 kHz, fused calls, on the processor."""
    import jax
    from crazyflow.sim import Sim

    frequency, count = 1000, 100
    sim = Sim(n_worlds=worlds, n_drones=1, freq=frequency, device="cpu")
    sim.reset()
    command = np.zeros((worlds, 1, 4), np.float32)
    command[..., 3] = 0.3

    def run() -> int:
        sim.attitude_control(command)
        sim.step(count)
        jax.block_until_ready(sim.data.states.pos)
        return worlds * count

    return _measure("crazyflow", worlds, 1e3 / frequency, seconds, run)


def l2f(worlds: int, seconds: float) -> Result:
    """l2f's vector environment, as wide as its package has one up to ``worlds``; each step of its own length, 10 ms."""
    import l2f as library

    width = 1 << min(worlds.bit_length() - 1, 13)
    vector = getattr(library, f"vector{width}")
    device, rng = library.Device(), vector.VectorRng()
    environment, parameters = vector.VectorEnvironment(), vector.VectorParameters()
    state, following = vector.VectorState(), vector.VectorState()
    vector.initialize_rng(device, rng, 0)
    vector.initialize_environment(device, environment)
    vector.sample_initial_parameters(device, environment, parameters, rng)
    vector.sample_initial_state(device, environment, parameters, state, rng)
    action = np.zeros((width, 4), np.float32)
    steps_s = vector.step(device, environment, parameters, state, action, following, rng)

    def run() -> int:
        vector.step(device, environment, parameters, state, action, following, rng)
        state.assign(following)
        return width

    return _measure("l2f", width, float(steps_s[0]) * 1e3, seconds, run)


def main(arguments: list[str] | None = None) -> int:
    """The command."""
    parser = argparse.ArgumentParser(prog="python -m tautline.bench", description=__doc__)
    parser.add_argument("--worlds", metavar="N", type=int, default=1000)
    parser.add_argument("--seconds", metavar="S", type=float, default=3.0, help="for each")
    parser.add_argument(
        "--threads", metavar="N", type=int, default=1, help="of ours; 0: one a core"
    )
    parser.add_argument("--json", action="store_true", help="one object a line")
    options = parser.parse_args(arguments)
    # Read by XLA when it is first imported: the others' threads as well.
    os.environ.setdefault(
        "XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
    )
    results = [ours(options.worlds, options.seconds, options.threads)]
    for name, measure in (("crazyflow", crazyflow), ("l2f", l2f)):
        try:
            release = version(name)
        except PackageNotFoundError:
            print(f"{name} is not installed: pip install {name}", file=sys.stderr)
            continue
        try:
            result = measure(options.worlds, options.seconds)
        except Exception as error:  # Whatever another library's release does, ours is told.
            print(f"{name} {release}: {type(error).__name__}: {error}", file=sys.stderr)
            continue
        results.append(result)
    for result in results:
        if options.json:
            print(json.dumps(asdict(result)))
        else:
            print(
                f"{result.name:10} {result.worlds:6} worlds, step {result.step_ms:g} ms: "
                f"{result.steps_per_cpu_s / 1e6:.2f} M steps and {result.simulated_s_per_cpu_s:,.0f} simulated s "
                f"per s of processor time; {result.steps_per_wall_s / 1e6:.2f} M steps per s passed"
            )
    return 0


if __name__ == "__main__":
    sys.exit(main())
