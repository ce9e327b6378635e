"""Controllers and estimators in Python."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from pid import Altimeter, Pid

import tautline
from tautline import Observation

HOLD: dict[str, Any] = {
    "mission": [
        {"do": "arm"},
        {"do": "takeoff", "altitude": 5.0},
        {"do": "hold", "seconds": 15.0},
        {"do": "land"},
    ]
}


@pytest.mark.parametrize("feed", ["estimate", "truth"])
@pytest.mark.parametrize("kind", ["rates", "attitude"])
def test_a_plain_pid_flies_the_hold_and_ours_lands(kind: str, feed: Any) -> None:
    pid = Pid(kind)
    flight = tautline.fly(HOLD, controller=pid, feed=feed)
    assert flight.mission == ("done", None), flight.texts
    assert flight.verdict["lost"] is None
    assert 250 * 14 < pid.calls < 250 * 16
    assert 0.0 < flight.verdict["hold_horizontal_rms_m"] < 1.0
    status = flight.log["vehicle_status"]
    assert (status["nav_state"] == 14).any(), "Offboard"


def test_rotors_turn_as_the_controller_says() -> None:
    class Off:
        def control(self, t: float, seen: Observation) -> list[float]:
            return [0.0, 0.0, 0.0, 0.0]

    flight = tautline.fly(HOLD, controller=Off())
    assert flight.verdict["lost"] is not None, "it fell"
    truth = flight.log["vehicle_local_position_groundtruth"]
    assert truth["vz"].max() > 3.0


def test_a_hold_by_throttles_stays_up() -> None:
    class Throttles(Pid):
        """The rates of the PID by a rate loop and a mixer of its own."""

        def control(self, t: float, seen: Observation) -> Any:
            rates = super().control(t, seen)
            assert isinstance(rates, tautline.Rates)
            roll, pitch, yaw = np.array([0.016, 0.016, 0.029]) * 15.0 * (rates.rate - seen["rate"])
            arm, yaw_arm = 0.177, 0.0167
            x, y = np.array([1, -1, 1, -1]), np.array([1, -1, -1, 1])
            spin = np.array([1, 1, -1, -1])
            each = rates.thrust / 4 - y * roll / (4 * arm) + x * pitch / (4 * arm)
            thrust = np.clip(each + spin * yaw / (4 * yaw_arm), 0.1, 8.1)
            return (thrust / 8.1) ** (0.5 / 0.75)

    flight = tautline.fly(HOLD, controller=Throttles(), feed="truth", control_hz=1000)
    assert flight.verdict["hold_horizontal_rms_m"] < 1.0
    assert flight.verdict["hold_vertical_rms_m"] < 0.5


def test_a_controllers_error_ends_the_flight() -> None:
    class Broken:
        def control(self, t: float, seen: Observation) -> list[float]:
            raise ZeroDivisionError("own mistake")

    with pytest.raises(ZeroDivisionError, match="own mistake"):
        tautline.fly(HOLD, controller=Broken())

    class Short:
        def control(self, t: float, seen: Observation) -> list[float]:
            return [0.5]

    with pytest.raises(TypeError, match="4 throttles are expected"):
        tautline.fly(HOLD, controller=Short())


def test_an_estimator_beside_is_logged_and_scored_and_changes_nothing(
    short: dict[str, Any],
) -> None:
    alone = tautline.fly(short)
    beside = tautline.fly(short, estimator=Altimeter())
    assert beside.log.ulog == alone.log.ulog
    frame = beside.log["estimator_python"]
    assert {"timestamp", "position[2]", "tension", "note"} <= set(frame.columns)
    assert len(frame) == pytest.approx(beside.duration_s * 250, rel=0.01)
    figures = beside.estimator
    assert figures["velocity_rms_mps"] is None
    ours, own = figures["ours_position_rms_m"], figures["position_rms_m"]
    assert ours is not None and own is not None
    assert ours < 1.0 < own, "straight over the anchor is not where it flies"


def test_flights_are_compared_in_one_table(short: dict[str, Any]) -> None:
    table = tautline.compare(
        [
            tautline.fly(short),
            {"scenario": short, "controller": Pid()},
            {"scenario": short, "estimator": Altimeter(), "name": "beside"},
        ]
    )
    assert list(table.index) == ["ours", "Pid", "beside"]
    rms = table["hold_horizontal_rms_m"].tolist()
    assert rms[0] == rms[2] != rms[1]
    assert table["estimator.position_rms_m"].notna().tolist() == [False, False, True]


@pytest.mark.parametrize("hz", [0, 49, 300, 2000])
def test_a_rate_that_cannot_be_says_so(hz: int, short: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=f"{hz} Hz is no divisor of 1000"):
        tautline.fly(short, controller=Pid(), control_hz=hz)
