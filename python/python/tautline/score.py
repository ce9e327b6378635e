"""An estimator beside the firmware's own, against the truth."""

from __future__ import annotations

from collections.abc import Mapping
from math import asin, sqrt
from typing import Any

import numpy as np

from . import _native
from .types import Estimator, Vector

_UNITS = {"position": "m", "velocity": "mps", "attitude": "rad", "tension": "n"}


class Beside:
    """Runs an estimator, keeps what it says and how far off it was in the air."""

    def __init__(self, estimator: Estimator) -> None:
        self._estimator = estimator
        self.rows: list[dict[str, float]] = []
        self._squares: dict[str, list[float]] = {}

    def update(self, sim: _native.Sim) -> None:
        """One call of the estimator."""
        sensors = sim.sensors()
        estimate = self._estimator.update(sensors["time"], sensors)
        row: dict[str, float] = {"timestamp": round(sensors["time"] * 1e6)}
        for key, value in estimate.items():
            row.update(_columns(key, value))
        self.rows.append(row)
        observation = sim.observe()
        truth: Mapping[str, Any] = sim.truth()
        if not observation["in_air"] or truth["touching"]:
            return
        ours: Mapping[str, Any] = observation
        for key in _UNITS:
            for name, source in ((key, estimate), (f"ours_{key}", ours)):
                if source.get(key) is not None:
                    error = _error(key, source[key], truth[key])
                    self._squares.setdefault(name, []).append(error * error)

    def figures(self) -> dict[str, float | None]:
        """Root mean squares; ``None``: it never said."""
        figures: dict[str, float | None] = {}
        for key, unit in _UNITS.items():
            for name in (key, f"ours_{key}"):
                squares = self._squares.get(name)
                figures[f"{name}_rms_{unit}"] = (
                    sqrt(sum(squares) / len(squares)) if squares else None
                )
        return figures


def _columns(key: str, value: Any) -> dict[str, float]:
    if value is None:
        return {}
    if np.ndim(value) == 0:
        return {key: float(value)}
    return {f"{key}[{i}]": float(x) for i, x in enumerate(np.ravel(value))}


def _error(key: str, value: Any, truth: Any) -> float:
    if key == "attitude":
        return _angle(np.asarray(value, float), np.asarray(truth, float))
    return float(np.linalg.norm(np.asarray(value, float) - np.asarray(truth, float)))


def _angle(a: Vector, b: Vector) -> float:
    # By the chord: an arc cosine loses small angles.
    a = a / np.linalg.norm(a)
    chord = min(float(np.linalg.norm(a - b)), float(np.linalg.norm(a + b)))
    return 4.0 * asin(min(chord / 2.0, 1.0))
