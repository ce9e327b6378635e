"""An estimator of one's own over the sample of TautBench."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tautline import tautbench
from tautline.types import Sensors

SAMPLE = Path(__file__).parent.parent.parent / "sitl" / "tautbench" / "sample"


class OnTheLine:
    """North of the anchor, by the altimeter on a line of known or measured length."""

    def __init__(self, about: Mapping[str, Any]) -> None:
        self.length: float | None = about["line_length_m"]
        self.height = 0.0

    def update(self, t: float, sensors: Sensors) -> Mapping[str, Any]:
        self.length = sensors["length"] or self.length
        self.height = sensors["altitude"] if sensors["altitude"] is not None else self.height
        if self.length is None:
            return {}
        level = np.sqrt(max(self.length**2 - self.height**2, 0.0))
        return {"position": [level, 0.0, -self.height], "position_sd": [0.5, 0.5, 0.1]}


def test_an_estimator_is_made_for_each_flight_and_scored_over_all() -> None:
    score = tautbench.score(OnTheLine, data=SAMPLE)
    assert score.name == "OnTheLine"
    assert list(score.flights.index) == [
        "sample-winch-5mps-1",
        "sample-fixed-calm-1",
        "sample-fixed-3mps-1",
    ]
    assert (score.flights["position_rms_m"] < 1.5).all()
    assert score.flights["tension_rms_n"].isna().all(), "it says nothing of the tension"
    assert (score.flights["position_consistency"] > 0.0).all()
    assert score.cells["elevation_rad.rms"].loc["sample-fixed-calm"] < 0.06
    assert "| OnTheLine | 3 |" in score.markdown


def test_a_function_without_arguments_makes_one_too_and_unknown_is_silent() -> None:
    class Mute:
        def update(self, t: float, sensors: Sensors) -> Mapping[str, Any]:
            return {"tension": 6.0 if t > 30.0 else None}

    score = tautbench.score(lambda: Mute(), data=SAMPLE, name="mute")
    assert score.name == "mute"
    assert bool(score.flights.loc["sample-fixed-calm-1", "lost"]), "silent all the time"


@pytest.mark.parametrize(
    ("estimate", "what"),
    [
        ({"position": [1.0, 2.0]}, "sample-winch-5mps-1: position has 2 numbers, not 3"),
        ({"position": [1.0, np.nan, 0.0]}, "east_m = NaN is not finite"),
        ({"velocity": [0.0, 0.0, 0.0]}, "nothing to score"),
        ({"attitude": [1.0, 1.0, 0.0, 0.0]}, "have the length"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(estimate: dict[str, Any], what: str) -> None:
    class Wrong:
        def update(self, t: float, sensors: Sensors) -> Mapping[str, Any]:
            return estimate

    with pytest.raises(ValueError, match=r"sample-winch-5mps-1") as error:
        tautbench.score(Wrong, data=SAMPLE)
    assert what in str(error.value) and "\n" not in str(error.value)


def test_a_folder_without_data_is_named() -> None:
    with pytest.raises(ValueError, match=r"nowhere/manifest\.json"):
        tautbench.score(OnTheLine, data="nowhere")
