"""Campaigns from Python."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import pytest

from tautline import campaign

SCENARIO = """
[[mission]]
do = "arm"
[[mission]]
do = "takeoff"
altitude = 3.0
[[mission]]
do = "hold"
seconds = 2.0
[[mission]]
do = "land"
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """Five seeds of a short flight."""
    (tmp_path / "s.toml").write_text(SCENARIO)
    path = tmp_path / "c.toml"
    path.write_text('title = "Short"\nscenario = "s.toml"\nseeds = 5\n')
    return path


def test_the_rows_are_the_same_however_they_are_shared_out(file: Path, tmp_path: Path) -> None:
    many = campaign.run(file, tmp_path / "many", jobs=2, chunk=2)
    one = campaign.run(file, tmp_path / "one", jobs=1, chunk=5)
    assert many["seed"].tolist() == [1, 2, 3, 4, 5]
    assert many["pass"].all() and len(one) == 5
    pd.testing.assert_frame_equal(many, one)
    summaries = [
        json.loads((tmp_path / name / "summary.json").read_text()) for name in ("many", "one")
    ]
    assert summaries[0] == summaries[1] and summaries[0]["passed"] == 5
    assert (tmp_path / "many" / "flights.parquet").exists()


def test_what_was_flown_before_an_interruption_is_not_flown_again(
    file: Path, tmp_path: Path
) -> None:
    whole = campaign.run(file, tmp_path / "whole", jobs=1, chunk=2)
    part = tmp_path / "again"
    campaign.fly_part(str(file), str(part), 1, 3)
    before = (part / "parts" / "00001-of-00003" / "journal.jsonl").stat().st_mtime_ns
    again = campaign.run(file, part, jobs=1, chunk=2)
    after = (part / "parts" / "00001-of-00003" / "journal.jsonl").stat().st_mtime_ns
    assert before == after
    pd.testing.assert_frame_equal(whole, again)


def test_the_command_says_in_one_line_what_is_wrong(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert campaign.main(["nowhere.toml", "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err.splitlines()[0].startswith("error: ")
    limits = "\n[limits]\nhold_horizontal_rms_m = 1e-6\n"
    file.write_text(file.read_text().replace("seeds = 5", "seeds = 1") + limits)
    assert campaign.main([str(file), "--out", str(tmp_path / "out"), "--jobs", "1"]) == 1
    assert "0 of 1 flights passed" in capsys.readouterr().out
