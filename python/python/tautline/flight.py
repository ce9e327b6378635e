"""A whole flight of a scenario at once."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import gcd
from typing import Any, Literal

import pandas as pd

from . import _native
from .log import Log
from .score import Beside
from .sim import apply
from .types import Controller, Estimator, Observation, Params, Scenario

Feed = Literal["estimate", "truth"]
"""What a controller sees: the firmware's estimates, or the truth in their place."""

_TOPIC = "estimator_python"


@dataclass(frozen=True)
class Flight:
    """What a flight left."""

    log: Log
    """Topics of its log by name, as data frames."""
    verdict: dict[str, Any]
    """How it was flown, from the truth."""
    mission: tuple[str, str | None]
    """``done``, ``failed`` or ``flying`` where the time was over, and why it failed."""
    texts: list[tuple[float, str]]
    """What the vehicle said: time, s, and text."""
    duration_s: float
    seed: int
    name: str
    estimator: dict[str, float | None] = field(default_factory=dict)
    """Figures of the estimator that ran beside, and of the firmware's own at the same moments (``ours_…``)."""


def fly(
    scenario: Scenario,
    seed: int = 1,
    params: Params = None,
    *,
    controller: Controller | None = None,
    estimator: Estimator | None = None,
    feed: Feed = "estimate",
    control_hz: int = 250,
    estimator_hz: int = 250,
    limit: float = 600.0,
    name: str | None = None,
) -> Flight:
    """Flies a scenario's mission to its end, as fast as the machine can; without one, the standard mission.

    ``scenario``: a TOML file's path, TOML text or a dict. Everything random follows from ``seed``. ``params``: parameters
    of the firmware by name, or a parameter file. ``limit``: at most so long, simulated s.

    ``controller`` flies the holds of the mission in place of the firmware's, ``control_hz`` times a second (50 to 1000, a
    divisor of 1000), on what ``feed`` says; the firmware takes off, moves
    and lands. ``estimator`` runs beside; its estimates are in the log as ``estimator_python``.

    Raises ``ValueError`` with one line that names what is wrong. Other threads run meanwhile, and Ctrl-C ends it.
    """
    sim = _native.Sim(
        scenario, seed, params, log=True, standard=True, returns=controller is not None
    )
    beside = Beside(estimator) if estimator is not None else None
    if controller is None and beside is None:
        sim.fly(limit)
    else:
        _fly(sim, controller, beside, feed, _period(control_hz), _period(estimator_hz), limit)
    log = Log(sim.finish_log())
    if beside is not None:
        log.add(_TOPIC, pd.DataFrame(beside.rows))
    return Flight(
        log=log,
        verdict=sim.verdict(),
        mission=sim.mission,
        texts=sim.texts(),
        duration_s=sim.time,
        seed=seed,
        name=name or (type(controller).__name__ if controller is not None else "ours"),
        estimator={} if beside is None else beside.figures(),
    )


def _period(hz: int) -> int:
    if not 50 <= hz <= 1000 or 1000 % hz != 0:
        raise ValueError(f"{hz} Hz is no divisor of 1000 from 50 to 1000")
    return 1000 // hz


def _fly(
    sim: _native.Sim,
    controller: Controller | None,
    beside: Beside | None,
    feed: Feed,
    control_ms: int,
    estimator_ms: int,
    limit: float,
) -> None:
    if feed not in ("estimate", "truth"):
        raise ValueError(f"feed = {feed!r} is neither 'estimate' nor 'truth'")
    wanted = [control_ms] * (controller is not None) + [estimator_ms] * (beside is not None)
    chunk = gcd(*wanted)
    is_by_hand, ms = False, 0
    if beside is not None:
        sim.sensors()
    while sim.time < limit and not sim.is_over():
        if controller is not None and ms % control_ms == 0:
            if sim.is_holding:
                observation = _observe(sim, feed)
                apply(sim, controller.control(observation["time"], observation))
                is_by_hand = True
            elif is_by_hand:
                sim.let_go()
                is_by_hand = False
        ms += chunk
        # By half a step early: times are whole milliseconds, and no rounding shall add one.
        sim.fly(min(limit, (ms - 0.5) * 1e-3))
        if beside is not None and ms % estimator_ms == 0:
            beside.update(sim)


def _observe(sim: _native.Sim, feed: Feed) -> Observation:
    observation = sim.observe()
    if feed == "truth":
        truth = sim.truth()
        for key in ("position", "velocity", "attitude", "rate", "elevation", "azimuth", "tension"):
            observation[key] = truth[key]
    return observation
