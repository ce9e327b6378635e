"""Many worlds at once for reinforcement learning."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from . import _native, task
from .env import _TENSION, TARGET, Observed
from .types import Scenario


class TetherVectorEnv(VectorEnv[Observed, npt.NDArray[np.float32], npt.NDArray[Any]]):
    """:class:`~tautline.TetherEnv` without firmware ``num_envs`` times, stepped by Rust on all cores.

    Observations (num_envs, 15 + rotors) float32, actions (num_envs, rotors) float32, rewards (num_envs,) float64; each
    world is the single environment's of its seed to the bit. An episode that ended begins anew at the next step, whose
    action for that world counts for nothing and whose reward is zero (``AutoresetMode.NEXT_STEP``).
    """

    metadata = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(
        self,
        num_envs: int,
        scenario: Scenario | None = None,
        *,
        target: tuple[float, float, float] = TARGET,
        action_ms: int = 10,
        episode_s: float = 20.0,
        threads: int = 0,
    ) -> None:
        """``threads``: 0 = one a core; the rest as the single environment's. Raises ``ValueError``."""
        self.num_envs = num_envs
        scenario = {} if scenario is None else scenario
        self._batch = _native.Batch(scenario, list(range(1, num_envs + 1)), threads)
        plant = _native.Plant(scenario, 1)
        self._target = task.to_world(*target)
        self._speed_max = plant.rotor_speed_max
        self._action_ms = action_ms
        self._length = max(1, round(episode_s * 1e3 / action_ms))
        self._steps = np.zeros(num_envs, np.int64)
        self._ended = np.zeros(num_envs, np.bool_)
        self._generators: list[np.random.Generator] = []
        box = gymnasium.spaces.Box
        self.single_action_space = box(-1.0, 1.0, (plant.rotors,), np.float32)
        self.single_observation_space = box(-np.inf, np.inf, (15 + plant.rotors,), np.float32)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)

    def reset(
        self,
        *,
        seed: int | list[int | None] | None = None,
        options: Mapping[str, Any] | None = None,
    ) -> tuple[Observed, dict[str, Any]]:
        """All episodes anew. ``seed``: world ``i`` is the single environment's of ``seed + i``, or of ``seed[i]``."""
        if isinstance(seed, int):
            seeds: list[int | None] = [seed + i for i in range(self.num_envs)]
        else:
            seeds = [None] * self.num_envs if seed is None else seed
        if len(seeds) != self.num_envs:
            raise ValueError(f"{len(seeds)} seeds for {self.num_envs} worlds")
        if seed is not None or not self._generators:
            self._generators = [gymnasium.utils.seeding.np_random(one)[0] for one in seeds]
        for index in range(self.num_envs):
            self._begin(index)
        return self._observe(self._batch.state()), {}

    def _begin(self, index: int) -> None:
        start = task.draw(self._generators[index], self._target)
        self._batch.reset(index, start.seed, start.position)
        self._steps[index] = 0
        self._ended[index] = False

    def step(
        self, actions: npt.NDArray[np.float32]
    ) -> tuple[Observed, npt.NDArray[Any], npt.NDArray[Any], npt.NDArray[Any], dict[str, Any]]:
        """``action_ms`` on: observations, rewards, terminated, truncated, information."""
        unit = np.clip(np.asarray(actions, np.float64), -1.0, 1.0)
        self._batch.step(np.ascontiguousarray((unit + 1.0) * 0.5), _TENSION, self._action_ms)
        self._steps += 1
        begins = self._ended.copy()
        for index in np.flatnonzero(begins):
            self._begin(int(index))
        state = self._batch.state()
        error = self._target - state[:, 0:3]
        crashed = task.crashed(error, state[:, 6:10], state[:, 15]) & ~begins
        rewards = np.where(begins, 0.0, task.reward(error, state[:, 10:13], crashed))
        truncated = (self._steps >= self._length) & ~crashed & ~begins
        self._ended = crashed | truncated
        return self._observe(state), rewards, crashed, truncated, {}

    def _observe(self, state: task.Array) -> Observed:
        return task.observe(state, self._target, self._speed_max)
