"""``python -m tautline.campaign FILE --out DIR``: one scenario over many seeds, on all cores or on a Ray cluster."""

from __future__ import annotations

import argparse
import json
import os
import signal
import sys
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import pandas as pd

from . import _native

CHUNK = 8
"""Flights of a part: a second or so of one core."""


def fly_part(file: str, out: str, index: int, count: int) -> str:
    """Flies one part into its folder; the folder."""
    folder = Path(out) / "parts" / f"{index:05}-of-{count:05}"
    _native.campaign_shard(file, folder, index, count)
    return str(folder)


def on_cores(jobs: int) -> Callable[[str, str, int], Iterator[str]]:
    """Parts on so many processes of this machine."""

    def run(file: str, out: str, count: int) -> Iterator[str]:
        # A process that is forked from one with threads may stand still.
        context = get_context("spawn")
        with ProcessPoolExecutor(jobs, mp_context=context, initializer=_ignore_interrupt) as pool:
            parts = [pool.submit(fly_part, file, out, i, count) for i in range(1, count + 1)]
            for part in as_completed(parts):
                yield part.result()

    return run


def _ignore_interrupt() -> None:
    # The parent ends the pool.
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def on_ray(file: str, out: str, count: int) -> Iterator[str]:
    """Parts as tasks of the Ray cluster that ``RAY_ADDRESS`` names, or of one that is started on this machine.

    The folder has to be one that every node sees.
    """
    try:
        import ray
    except ImportError:
        raise ValueError("--ray wants Ray: pip install 'tautline[ray]'") from None
    ray.init(log_to_driver=False, include_dashboard=False)
    try:
        task = ray.remote(fly_part)
        left = [task.remote(file, out, index, count) for index in range(1, count + 1)]
        while left:
            ready, left = ray.wait(left)
            yield from ray.get(ready)
    finally:
        ray.shutdown()


def merge(
    folders: Iterable[str | os.PathLike[str]], out: str | os.PathLike[str]
) -> tuple[dict[str, Any], pd.DataFrame]:
    """Joins parts into ``flights.parquet`` and ``summary.json`` in ``out``; the summary, and the rows by index.

    Raises ``ValueError`` with one line: parts of different campaigns, flights that are missing.
    """
    joined = json.loads(_native.campaign_merge([os.fspath(f) for f in folders], os.fspath(out)))
    return joined["summary"], pd.DataFrame(joined["rows"])


def run(
    file: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    jobs: int | None = None,
    ray: bool = False,
    chunk: int = CHUNK,
) -> pd.DataFrame:
    """Flies a campaign file (``sitl/campaigns/*.toml``) and leaves ``flights.parquet`` and ``summary.json`` in ``out``.

    The same rows, and the same hash of them in the summary, whatever ``jobs``, ``ray`` and ``chunk`` are, and as
    ``cargo sitl campaign`` has them. What an interrupted run has flown with the same ``chunk`` is not flown again. Returns
    the rows. Raises ``ValueError`` with one line.
    """
    file, out = os.fspath(Path(file).resolve()), os.fspath(Path(out).resolve())
    size = _native.campaign_size(file)
    count = max(1, -(-size // chunk))
    Path(out).mkdir(parents=True, exist_ok=True)
    execute = on_ray if ray else on_cores(min(jobs or os.cpu_count() or 1, count))
    folders = []
    for folder in execute(file, out, count):
        folders.append(folder)
        print(f"part {len(folders)} of {count} flown", file=sys.stderr)
    _, rows = merge(sorted(folders), out)
    return rows


def main(arguments: list[str] | None = None) -> int:
    """The command; 2 for a bad option or file, 1 when a flight failed."""
    parser = argparse.ArgumentParser(
        prog="python -m tautline.campaign",
        description=__doc__,
        epilog="Example: python -m tautline.campaign sitl/campaigns/gusts-3.toml --out out --jobs 2",
    )
    parser.add_argument("file", metavar="FILE", help="scenario, seeds, limits")
    parser.add_argument("--out", metavar="DIR", required=True, help="where the rows go")
    parser.add_argument("--jobs", metavar="N", type=int, help="processes; one a core when absent")
    parser.add_argument("--ray", action="store_true", help="on a Ray cluster")
    options = parser.parse_args(arguments)
    if options.jobs is not None and options.jobs < 1:
        parser.error("--jobs is at least 1")
    try:
        rows = run(options.file, options.out, jobs=options.jobs, ray=options.ray)
    except (ValueError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    passed = int(rows["pass"].sum())
    print(f"{passed} of {len(rows)} flights passed: {options.out}")
    return 0 if passed == len(rows) else 1


if __name__ == "__main__":
    sys.exit(main())
