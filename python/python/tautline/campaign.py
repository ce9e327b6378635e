"""``python -m tautline.campaign FILE --out DIR``: one scenario over many seeds, on all cores or on a Ray cluster."""

from __future__ import annotations

import argparse
import os
import signal
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from . import _native

CHUNK = 8
"""Flights of a part: a second or so of one core."""
KEEP_LOGS = 10
"""Failed flights that are kept with their logs."""


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


def run(
    file: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    jobs: int | None = None,
    ray: bool = False,
    chunk: int = CHUNK,
    keep_logs: int = KEEP_LOGS,
) -> dict[str, Any]:
    """Flies a campaign file (``sitl/campaigns/*.toml``) into ``out``: ``flights.parquet``, one row a flight,
    ``summary.json``, and the first ``keep_logs`` failed flights with their logs. Returns the summary.

    The same table whatever ``jobs``, ``ray`` and ``chunk`` are: ``content_sha256`` in the summary shows it. What was
    interrupted goes on where it was, with the same ``chunk``. Raises ``ValueError`` with one line.
    """
    file, out = os.fspath(Path(file).resolve()), os.fspath(Path(out).resolve())
    count = max(1, -(-_native.campaign_size(file) // chunk))
    Path(out).mkdir(parents=True, exist_ok=True)
    processes = min(jobs or os.cpu_count() or 1, count)
    execute = on_ray if ray else on_cores(processes)
    folders = []
    for folder in execute(file, out, count):
        folders.append(folder)
        print(f"part {len(folders)} of {count} flown", file=sys.stderr)
    return _native.campaign_merge(file, sorted(folders), out, keep_logs, processes)


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
        summary = run(options.file, options.out, jobs=options.jobs, ray=options.ray)
    except (ValueError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(f"{summary['passed']} of {summary['flown']} flights passed: {options.out}")
    return 0 if summary["failed"] == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
