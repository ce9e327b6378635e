"""A Gymnasium environment: hold a point on the tether."""

from __future__ import annotations

from collections.abc import Mapping
from math import radians
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt

from . import _native, task
from .sim import Sim
from .types import Scenario, Vector

Observed = npt.NDArray[np.float32]

TARGET = (radians(60.0), 0.0, 6.0)
"""Elevation, rad, azimuth, rad, and length, m, of the point to hold."""
LOW = (0.35, -0.6, 4.0)
HIGH = (1.35, 0.6, 12.0)
"""Targets that the firmware may be given: elevation, rad, azimuth, rad, length, m."""
_TENSION = 6.5


class TetherEnv(gymnasium.Env[Observed, npt.NDArray[np.float32]]):
    """Hold a point on the tether.

    **Without firmware** (default) the agent turns the rotors of the plant. An action is (rotors,) float32 in [-1, 1],
    the throttle of each rotor from none to all; it lasts ``action_ms``. An observation is (15 + rotors,) float32:

    ====== ==============================================
    0-2    from the vehicle to the point, NED, m
    3-5    velocity, NED, m/s
    6-9    attitude, body to world, ``[w, x, y, z]``, w ≥ 0
    10-12  body rates, rad/s
    13     tension at the vehicle, N
    14     line outside, m
    15-    speed of each rotor over its greatest
    ====== ==============================================

    Every episode begins in the air, within 0.5 m of the point along each axis, at rest with the rotors standing.

    **With firmware** the agent says where to be. An action is (3,) float32 in [-1, 1]: elevation from 0.35 to 1.35 rad,
    azimuth from -0.6 to 0.6 rad, length from 4 to 12 m, as set-points in Offboard. An observation is (15,) float32, the
    first fifteen numbers above as the firmware estimates them. Every episode begins after a take-off to 5 m.

    **Reward** for each action: ``exp(-d²) - min(0.01 ω², 1)`` with the true distance ``d`` from the point, m, and the
    body rates ``ω``, rad/s; -10 for a crash. **Terminated** at a crash: the vehicle touches the ground, tilts more than
    70° or is more than 8 m from the point. **Truncated** after ``episode_s``.
    """

    metadata = {"render_modes": []}

    def __init__(
        self,
        scenario: Scenario | None = None,
        *,
        firmware: bool = False,
        target: tuple[float, float, float] = TARGET,
        action_ms: int | None = None,
        episode_s: float = 20.0,
    ) -> None:
        """``target``: elevation, rad, azimuth, rad, length, m. ``action_ms``: 10 without firmware, 100 with it.

        Raises ``ValueError`` with one line that names what is wrong.
        """
        self._scenario: Scenario = {} if scenario is None else scenario
        self._target = task.to_world(*target)
        self._action_ms = action_ms or (100 if firmware else 10)
        self._steps = max(1, round(episode_s * 1e3 / self._action_ms))
        self._step = 0
        self._firmware = firmware
        plant = _native.Plant(self._scenario, 1)
        self._plant = plant
        self._sim: Sim | None = None
        self._speed_max = plant.rotor_speed_max
        actions, width = (3, 15) if firmware else (plant.rotors, 15 + plant.rotors)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (actions,), np.float32)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (width,), np.float32)

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[Observed, dict[str, Any]]:
        """A new episode; everything random follows from ``seed``."""
        super().reset(seed=seed)
        start = task.draw(self.np_random, self._target)
        self._step = 0
        if self._firmware:
            self._sim = Sim(self._scenario, start.seed)
            self._sim.arm()
            self._sim.takeoff(5.0)
            self._sim.finish()
        else:
            self._plant = _native.Plant(self._scenario, start.seed)
            self._plant.hang(start.position)
        return self._observe(), {}

    def step(
        self, action: npt.NDArray[np.float32]
    ) -> tuple[Observed, float, bool, bool, dict[str, Any]]:
        """``action_ms`` on: observation, reward, terminated, truncated, information."""
        unit = np.clip(np.asarray(action, np.float64), -1.0, 1.0)
        if self._sim is not None:
            _follow(self._sim, unit, self._action_ms)
        else:
            self._plant.step((unit + 1.0) * 0.5, _TENSION, self._action_ms)
        self._step += 1
        state = self._truth()
        error = self._target - state[:, 0:3]
        crashed = task.crashed(error, state[:, 6:10], state[:, 15])
        reward = task.reward(error, state[:, 10:13], crashed)
        is_over = self._step >= self._steps and not crashed[0]
        return self._observe(), float(reward[0]), bool(crashed[0]), bool(is_over), {}

    def _truth(self) -> task.Array:
        if self._sim is None:
            return self._plant.state()[np.newaxis]
        truth = self._sim.truth()
        parts: list[Vector] = [
            truth["position"],
            truth["velocity"],
            truth["attitude"],
            truth["rate"],
        ]
        rest = [truth["tension"], truth["length"], float(truth["touching"])]
        return np.concatenate([*parts, np.array(rest)])[np.newaxis]

    def _observe(self) -> Observed:
        if self._sim is None:
            row: Observed = task.observe(self._truth(), self._target, self._speed_max)[0]
            return row
        seen = self._sim.observe()
        unknown = np.zeros(3)
        position, velocity = seen["position"], seen["velocity"]
        parts = [
            self._target - (unknown if position is None else position),
            unknown if velocity is None else velocity,
            seen["attitude"],
            seen["rate"],
            np.array([seen["tension"] or 0.0, seen["length"] or 0.0]),
        ]
        return np.concatenate(parts).astype(np.float32)


def _follow(sim: Sim, unit: Vector, ms: int) -> None:
    low, high = np.array(LOW), np.array(HIGH)
    elevation, azimuth, length = low + (unit + 1.0) * 0.5 * (high - low)
    place = task.to_world(elevation, azimuth, length)
    # A stream, as a program beside the vehicle sends it.
    for _ in range(0, ms, _STREAM_MS):
        sim.place(place, float(azimuth))
        sim.step(min(_STREAM_MS, ms))


_STREAM_MS = 50
