"""What :class:`~tautline.TetherEnv` and :class:`~tautline.TetherVectorEnv` are about, for any number of worlds at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .types import Vector

Array = npt.NDArray[np.float64]

TILT_MAX = 1.22
"""A vehicle that tilts more has crashed (70°), rad."""
REACH = 8.0
"""A vehicle farther from its point has crashed, m."""
CRASH = -10.0
"""Reward of a crash."""
SPREAD = 0.5
"""The start is drawn within this of the point along each axis, m."""
SEEDS = 2**31
"""Seeds of worlds are drawn below this."""


def to_world(elevation: float, azimuth: float, length: float) -> Vector:
    """(3,) NED, m, of a point on the line: rad, rad, m."""
    level = length * np.cos(elevation)
    return np.array([level * np.cos(azimuth), level * np.sin(azimuth), -length * np.sin(elevation)])


def tilt(attitude: Array) -> Array:
    """(n,) angle between body's and world's down axis, rad, of (n, 4) ``[w, x, y, z]``."""
    x, y = attitude[:, 1], attitude[:, 2]
    return np.asarray(np.arccos(np.clip(1.0 - 2.0 * (x * x + y * y), -1.0, 1.0)), np.float64)


def reward(error: Array, rate: Array, crashed: npt.NDArray[np.bool_]) -> Array:
    """(n,) of errors (n, 3), m, and body rates (n, 3), rad/s: 1 at rest at the point, less by the square of the distance
    in metres and a hundredth of the rates'; :data:`CRASH` for a crash."""
    far = np.exp(-np.sum(error * error, axis=1))
    turns = 0.01 * np.sum(rate * rate, axis=1)
    return np.asarray(np.where(crashed, CRASH, far - np.minimum(turns, 1.0)), np.float64)


def crashed(error: Array, attitude: Array, touching: Array) -> npt.NDArray[np.bool_]:
    """(n,) whether a vehicle touches the ground, tilts beyond :data:`TILT_MAX` or is beyond :data:`REACH`."""
    is_far = np.linalg.norm(error, axis=1) > REACH
    return np.asarray((touching > 0.5) | (tilt(attitude) > TILT_MAX) | is_far, np.bool_)


@dataclass(frozen=True)
class Start:
    """Where an episode begins."""

    seed: int
    position: Vector


def draw(rng: np.random.Generator, target: Vector) -> Start:
    """A world's seed and a place near the point."""
    seed = int(rng.integers(SEEDS))
    return Start(seed, target + rng.uniform(-SPREAD, SPREAD, 3))


def observe(state: Array, target: Vector, speed_max: float) -> npt.NDArray[np.float32]:
    """(n, 15 + rotors) of states (n, 19 + rotors): see :class:`~tautline.TetherEnv`."""
    error = target - state[:, 0:3]
    parts = [error, state[:, 3:13], state[:, 13:15], state[:, 19:] / speed_max]
    return np.concatenate(parts, axis=1).astype(np.float32)
