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


def test_the_table_is_the_same_however_it_is_shared_out(file: Path, tmp_path: Path) -> None:
    many = campaign.run(file, tmp_path / "many", jobs=2, chunk=2)
    one = campaign.run(file, tmp_path / "one", jobs=1, chunk=5)
    assert many["flown"] == many["passed"] == 5
    assert many["content_sha256"] == one["content_sha256"]
    assert json.loads((tmp_path / "many" / "summary.json").read_text()) == many
    tables = [(tmp_path / name / "flights.parquet").read_bytes() for name in ("many", "one")]
    assert tables[0] == tables[1] and tables[0].startswith(b"PAR1")


def test_what_was_flown_is_not_flown_again(file: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    campaign.fly_part(str(file), str(out), 1, 3)
    journal = out / "parts" / "00001-of-00003" / "journal.jsonl"
    # What the journal says counts: here that one of its two flights failed.
    journal.write_text(journal.read_text().replace('"pass":true', '"pass":false', 1))
    summary = campaign.run(file, out, jobs=1, chunk=2)
    assert (summary["passed"], summary["flown"]) == (4, 5)
    file.write_text(file.read_text().replace("seeds = 5", "seeds = 6"))
    with pytest.raises(ValueError, match="00001-of-00003"):
        campaign.run(file, out, jobs=1, chunk=2)


def test_the_command_says_in_one_line_what_is_wrong(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert campaign.main(["nowhere.toml", "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err.splitlines()[0].startswith("error: ")
    limits = "\n[limits]\nhold_horizontal_rms_m = 1e-6\n"
    file.write_text(file.read_text().replace("seeds = 5", "seeds = 1") + limits)
    assert campaign.main([str(file), "--out", str(tmp_path / "out"), "--jobs", "1"]) == 1
    assert "0 of 1 flights passed" in capsys.readouterr().out
