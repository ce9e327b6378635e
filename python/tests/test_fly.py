"""Whole flights."""

from __future__ import annotations

import json
import signal
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tautline

MISSION = "[[mission]]\ndo = 'arm'\n[[mission]]\ndo = 'takeoff'\naltitude = 3.0\n[[mission]]\ndo = 'land'\n"


def test_a_flight_gives_a_verdict_that_json_takes(short: dict[str, Any]) -> None:
    flight = tautline.fly(short)
    assert flight.mission == ("done", None)
    verdict = flight.verdict
    assert verdict["lost"] is None
    assert 0.0 < verdict["hold_horizontal_rms_m"] < 1.0
    assert 0.0 < verdict["touch_down_mps"] < 1.5
    assert json.loads(json.dumps(verdict)) == verdict
    assert set(verdict) == {
        "lost",
        "armed",
        "disarmed_at_s",
        "touch_down_mps",
        "touch_down_sideways_mps",
        "max_tilt_rad",
        "max_height_m",
        "distance_from_pad_m",
        "hold_horizontal_rms_m",
        "hold_vertical_rms_m",
        "estimate_error_rms_m",
        "tension_error_rms_n",
        "final_mode",
        "failures",
        "texts",
    }
    assert verdict["armed"] is False
    assert 10.0 < verdict["disarmed_at_s"] < flight.duration_s
    assert verdict["texts"] == [text for _, text in flight.texts]


def test_the_same_seed_gives_the_same_log_to_the_byte_and_another_seed_another(
    short: dict[str, Any],
) -> None:
    one, same, other = (tautline.fly(short, seed=seed) for seed in (3, 3, 4))
    assert one.log.ulog == same.log.ulog
    assert one.log.ulog != other.log.ulog


def test_a_log_has_data_frames_with_times_and_fields_by_their_names(short: dict[str, Any]) -> None:
    flight = tautline.fly(short)
    assert {"sensor_combined", "vehicle_attitude", "tether_state"} <= set(flight.log)
    truth = flight.log["vehicle_local_position_groundtruth"]
    assert truth["timestamp"].dtype == np.uint64
    assert (np.diff(truth["timestamp"].to_numpy().astype(np.int64)) > 0).all()
    assert truth["x"].dtype == np.float32
    highest = flight.verdict["max_height_m"]
    assert truth["z"].min() == pytest.approx(-highest, abs=0.1)
    attitude = flight.log["vehicle_attitude"]
    norm = sum(attitude[f"q[{i}]"].to_numpy() ** 2 for i in range(4))
    assert np.allclose(norm, 1.0, atol=1e-3)
    assert flight.log["tether_state"]["taut"].dtype == np.bool_
    with pytest.raises(KeyError):
        flight.log["no_such_topic"]


def test_file_text_and_mapping_are_the_same_scenario(tmp_path: Path) -> None:
    file = tmp_path / "s.toml"
    file.write_text(MISSION)
    steps = [{"do": "arm"}, {"do": "takeoff", "altitude": 3}, {"do": "land"}]
    logs = {tautline.fly(s).log.ulog for s in (file, str(file), MISSION, {"mission": steps})}
    assert len(logs) == 1


def test_parameters_come_from_a_mapping_or_a_file(tmp_path: Path) -> None:
    file = tmp_path / "mine.params"
    file.write_text("TET_TENSION,8.0\n")
    for params in ({"TET_TENSION": 8.0}, file, str(file)):
        assert tautline.Sim({}, params=params).param("TET_TENSION") == 8.0
    assert tautline.parameters({}, {"TET_TENSION": 8.0})["TET_TENSION"] == 8.0


def test_a_parameter_that_contradicts_the_vehicle_is_warned_of() -> None:
    with pytest.warns(UserWarning, match="VEH_MASS"):
        tautline.Sim({}, params={"VEH_MASS": 9.0})


@pytest.mark.parametrize(
    ("scenario", "params", "line"),
    [
        ("[vehicle]\nmass = -1.0", None, "vehicle.mass = -1 is outside 0.1 to 50"),
        ({"wind": {"sped": 3.0}}, None, "unknown field `sped`"),
        ({"mission": [{"do": "loop"}]}, None, "unknown variant `loop`"),
        ({"title": None}, None, "scenario"),
        ("nowhere.toml", None, "nowhere.toml"),
        ({}, {"TET_TENSIN": 8.0}, "no parameter TET_TENSIN"),
        ({}, {"TET_TENSION": float("nan")}, "not a whole or finite number"),
        ({}, "nowhere.params", "nowhere.params"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(scenario: Any, params: Any, line: str) -> None:
    with pytest.raises(ValueError, match=line) as caught:
        tautline.fly(scenario, params=params)
    assert "\n" not in str(caught.value)


def test_other_threads_run_while_it_flies() -> None:
    ticks = 0
    done = threading.Event()

    def count() -> None:
        nonlocal ticks
        while not done.is_set():
            time.sleep(0.002)
            ticks += 1

    thread = threading.Thread(target=count)
    thread.start()
    began = time.monotonic()
    tautline.Sim({}).step(100_000)
    took = time.monotonic() - began
    done.set()
    thread.join()
    assert ticks > 0.1 * took / 0.002, f"{ticks} ticks in {took} s"


def test_control_c_ends_a_flight() -> None:
    import _thread

    # Who starts tests in the background has the interrupt ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.2, _thread.interrupt_main)
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            tautline.Sim({}).step(10**9)
    finally:
        signal.signal(signal.SIGINT, before)


def test_a_flight_that_fails_says_why() -> None:
    fault = {"kind": "imu_frozen", "at": 0.0}
    flight = tautline.fly({"fault": [fault], "mission": [{"do": "arm"}]})
    state, why = flight.mission
    assert state == "failed" and why is not None and why.startswith("never armed"), why
