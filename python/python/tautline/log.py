"""A flight's log as data frames."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import pandas as pd

from . import _native


class Log(Mapping[str, pd.DataFrame]):
    """Topics of a ULog by name, each a DataFrame that is made when it is asked for.

    Columns: ``timestamp`` in µs, then the topic's fields by their ULog names, elements of arrays as ``q[0]``, nested
    fields as ``pose.x``, each with its own type. The second instance of a topic is ``name.1``.
    """

    def __init__(self, ulog: bytes) -> None:
        self.ulog = ulog
        """The log itself, as a file holds it."""
        self._tables: dict[str, tuple[bytes, int, list[tuple[str, str, int]]]] | None = None
        self._frames: dict[str, pd.DataFrame] = {}

    def _read(self) -> dict[str, tuple[bytes, int, list[tuple[str, str, int]]]]:
        if self._tables is None:
            self._tables = _native.tables(self.ulog)
        return self._tables

    def __getitem__(self, topic: str) -> pd.DataFrame:
        if topic not in self._frames:
            self._frames[topic] = _frame(*self._read()[topic])
        return self._frames[topic]

    def __iter__(self) -> Iterator[str]:
        return iter(self._read())

    def __len__(self) -> int:
        return len(self._read())

    def __repr__(self) -> str:
        return f"Log({', '.join(self)})"

    def add(self, topic: str, frame: pd.DataFrame) -> None:
        """Puts a topic beside the ULog's, as of an estimator that ran beside."""
        self._read()[topic] = (b"", 0, [])
        self._frames[topic] = frame


def _frame(rows: bytes, width: int, columns: list[tuple[str, str, int]]) -> pd.DataFrame:
    layout = np.dtype(
        {
            "names": [name for name, _, _ in columns],
            "formats": [kind for _, kind, _ in columns],
            "offsets": [offset for _, _, offset in columns],
            "itemsize": width,
        }
    )
    table = np.frombuffer(rows, dtype=layout)
    return pd.DataFrame({name: np.ascontiguousarray(table[name]) for name, _, _ in columns})
