"""TautBench: an estimator of one's own over recorded flights on a tether, against their truth (docs/tautbench.md)."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from . import _native
from .types import Estimator

_COLUMNS = {
    "position": ("north_m", "east_m", "down_m"),
    "position_sd": ("north_sigma_m", "east_sigma_m", "down_sigma_m"),
    "elevation": ("elevation_rad",),
    "azimuth": ("azimuth_rad",),
    "length": ("length_m",),
    "tension": ("tension_n",),
    "tension_sd": ("tension_sigma_n",),
    "attitude": ("q_w", "q_x", "q_y", "q_z"),
}
"""What is scored of an estimate, and its columns in a file of estimates."""


@dataclass(frozen=True)
class Score:
    """How far off an estimator was."""

    name: str
    cells: pd.DataFrame
    """A row for each cell: root mean squares over its flights with their 95 % intervals, as ``position_m.rms``,
    ``position_m.low_95``; m, rad, N."""
    flights: pd.DataFrame
    """A row for each flight: ``position_rms_m`` and so on; NaN where the estimator never said."""
    summary: dict[str, Any]
    """The object that ``cargo sitl tautbench score --json`` prints."""
    markdown: str
    """The tables that it prints otherwise."""


def score(
    make: Callable[..., Estimator],
    data: str | os.PathLike[str],
    name: str | None = None,
) -> Score:
    """Runs an estimator over every flight of the data set in the folder ``data`` and compares it with the truth.

    ``make`` is called anew for each flight, a class as a rule; where it takes an argument it gets what may be known of
    vehicle and line before: ``mass_kg``, ``has_winch``, ``line_length_m`` (``None`` on a winch),
    ``line_density_kgpm``. The estimator's ``update(t, sensors)`` is called a hundred times a second, from before the
    take-off. Of what it returns ``position`` (3,) NED from the anchor, m, ``elevation``, ``azimuth``, rad, ``length``, m,
    ``tension``, N, and ``attitude`` (4,) are scored, and with ``position_sd`` and ``tension_sd``, one standard deviation,
    how well it knows its errors. What is not known is left out, or ``None``.

    Raises ``ValueError`` with one line that names the flight and what is wrong.
    """
    bench = _native.TautBench(data)
    wants_about = bool(inspect.signature(make).parameters)
    errors = []
    for flight in bench.flights():
        estimator = make(flight["about"]) if wants_about else make()
        errors.append(_flight(bench, flight["name"], estimator))
    name = name or str(getattr(make, "__name__", type(make).__name__))
    whole = _native.tautbench_summary(name, errors)
    summary = whole["summary"]
    return Score(
        name=name,
        cells=pd.json_normalize(summary["cells"]).set_index("cell"),
        flights=pd.DataFrame(summary["flights"]).set_index("flight"),
        summary=summary,
        markdown=whole["markdown"],
    )


def _flight(bench: _native.TautBench, name: str, estimator: Estimator) -> str:
    times: list[float] = []
    said: list[dict[str, float]] = []
    keys: set[str] = set()
    for sensors in bench.readings(name):
        estimate = estimator.update(sensors["time"], sensors)
        keys.update(estimate)
        times.append(sensors["time"])
        said.append(_cells(name, estimate))
    # What is there but unknown all the time is silence; what is not there is not given.
    given = [column for key, columns in _COLUMNS.items() if key in keys for column in columns]
    rows = [[row.get(column) for column in given] for row in said]
    return bench.score(name, times, given, rows)


def _cells(flight: str, estimate: Mapping[str, Any]) -> dict[str, float]:
    cells: dict[str, float] = {}
    for key, columns in _COLUMNS.items():
        value = estimate.get(key)
        if value is None:
            continue
        numbers = np.ravel(np.asarray(value, float))
        if len(numbers) != len(columns):
            raise ValueError(f"{flight}: {key} has {len(numbers)} numbers, not {len(columns)}")
        cells.update(zip(columns, numbers.tolist(), strict=True))
    return cells
