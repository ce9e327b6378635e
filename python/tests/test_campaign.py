"""Campaigns from Python."""

from __future__ import annotations

import json
from pathlib import Path

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
    assert many["pass"].all()
    read = [(tmp_path / name / "flights.jsonl").read_text() for name in ("many", "one")]
    assert read[0] == read[1] and len(one) == 5
    summary = json.loads((tmp_path / "many" / "summary.json").read_text())
    assert summary == {"flights": 5, "complete": 5, "passed": 5, "failed_seeds": []}


def test_the_command_says_in_one_line_what_is_wrong(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert campaign.main(["nowhere.toml", "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err.splitlines()[0].startswith("error: ")
    limits = "\n[limits]\nhold_horizontal_rms_m = 1e-6\n"
    file.write_text(file.read_text().replace("seeds = 5", "seeds = 1") + limits)
    assert campaign.main([str(file), "--out", str(tmp_path / "out"), "--jobs", "1"]) == 1
    assert "0 of 1 flights passed" in capsys.readouterr().out
