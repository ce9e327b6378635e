"""Tautline's simulator: the flight firmware for tethered multirotors flown against a simulated world.

>>> import tautline
>>> flight = tautline.fly({"mission": [{"do": "arm"}, {"do": "takeoff", "altitude": 3.0}, {"do": "land"}]})
>>> flight.verdict["lost"] is None
True

Axes: world NED with the origin at the anchor, body forward-right-down, quaternions ``[w, x, y, z]`` from body to
world. SI units and radians throughout.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._native import fault_kinds, parameters
from .compare import compare
from .flight import Flight, fly
from .log import Log
from .plant import Plant
from .sim import Sim
from .types import Attitude, Controller, Estimator, Observation, Rates, Sensors, Truth

if TYPE_CHECKING:
    from .env import TetherEnv
    from .vector import TetherVectorEnv

__all__ = [
    "Attitude",
    "Controller",
    "Estimator",
    "Flight",
    "Log",
    "Observation",
    "Plant",
    "Rates",
    "Sensors",
    "Sim",
    "TetherEnv",
    "TetherVectorEnv",
    "Truth",
    "compare",
    "fault_kinds",
    "fly",
    "parameters",
]


def __getattr__(name: str) -> Any:
    # Gymnasium is wanted by its two classes alone.
    if name == "TetherEnv":
        from .env import TetherEnv

        return TetherEnv
    if name == "TetherVectorEnv":
        from .vector import TetherVectorEnv

        return TetherVectorEnv
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
