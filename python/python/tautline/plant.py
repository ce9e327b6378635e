"""The physical world without the firmware."""

from __future__ import annotations

from collections.abc import Sequence

from . import _native
from .types import Scenario, Truth, Vector

STATE = (
    *("x", "y", "z", "vx", "vy", "vz", "qw", "qx", "qy", "qz", "p", "q", "r"),
    *("tension", "length", "touching", "wind_x", "wind_y", "wind_z"),
)
"""Names of a state's first numbers: m, m/s, quaternion, rad/s, N, m, 0 or 1, m/s; the rotors' speeds, rad/s, follow."""


class Plant:
    """Vehicle, rotors, line, winch, ground, wind and battery of a scenario: throttles in, state out.

    >>> plant = Plant({})
    >>> plant.hang([2.0, 0.0, -5.0])
    >>> plant.step([0.6] * plant.rotors, 100)
    >>> plant.state().shape
    (23,)
    """

    def __init__(self, scenario: Scenario, seed: int = 1) -> None:
        """On the ground at the scenario's start. Raises ``ValueError``."""
        self._native = _native.Plant(scenario, seed)

    @property
    def time(self) -> float:
        """s."""
        return self._native.time

    @property
    def rotors(self) -> int:
        """How many."""
        return self._native.rotors

    def step(self, throttle: Sequence[float] | Vector, n: int = 1, *, tension: float = 6.5) -> None:
        """``n`` milliseconds, each four steps of physics: ``throttle`` (rotors,) 0..1, ``tension`` asked of the winch, N.
        Raises ``ValueError``."""
        self._native.step(throttle, tension, n)

    def hang(self, position: Sequence[float] | Vector) -> None:
        """Puts it in the air, (3,) NED, m, its line straight; motion and attitude stay."""
        self._native.hang(position)

    def set_motion(
        self,
        velocity: Sequence[float] | Vector,
        attitude: Sequence[float] | Vector,
        rate: Sequence[float] | Vector,
    ) -> None:
        """(3,) NED, m/s; (4,) ``[w, x, y, z]``; (3,) body axes, rad/s. Raises ``ValueError``."""
        self._native.set_motion(velocity, attitude, rate)

    def state(self) -> Vector:
        """(19 + rotors,): see :data:`STATE`."""
        return self._native.state()

    def truth(self) -> Truth:
        """The same and more by name."""
        return self._native.truth()
