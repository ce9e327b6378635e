"""Flights beside each other."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import pandas as pd

from .flight import Flight, fly


def compare(flights: Iterable[Flight | Mapping[str, Any]]) -> pd.DataFrame:
    """One table: a row for each flight by its name, a column for each figure of verdict and estimator.

    A flight is one that was flown, or the arguments of :func:`tautline.fly` for one that is to be. Lists are left out.
    """
    rows, names = [], []
    for one in flights:
        flight = one if isinstance(one, Flight) else fly(**one)
        names.append(flight.name)
        figures = {"seed": flight.seed, "mission": flight.mission[0], **_flat(flight.verdict)}
        figures.update({f"estimator.{name}": x for name, x in flight.estimator.items()})
        rows.append(figures)
    return pd.DataFrame(rows, index=pd.Index(names, name="flight"))


def _flat(values: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for name, value in values.items():
        if isinstance(value, Mapping):
            flat.update(_flat(value, f"{prefix}{name}."))
        elif not isinstance(value, list):
            flat[prefix + name] = value
    return flat
