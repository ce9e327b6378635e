"""A flight a millisecond at a time."""

from __future__ import annotations

import numpy as np
import pytest

import tautline


def flying(height: float = 3.0) -> tautline.Sim:
    sim = tautline.Sim({})
    sim.arm()
    sim.takeoff(height)
    sim.finish()
    return sim


def test_commands_are_flown_one_after_the_other() -> None:
    sim = flying()
    assert sim.observe()["mode"] == "Tether Hold"
    assert sim.observe()["armed"]
    sim.move(azimuth=0.3)
    sim.hold(2.0)
    sim.finish()
    assert abs(sim.truth()["azimuth"] - 0.3) < 0.1
    sim.land()
    sim.finish()
    assert not sim.observe()["armed"]
    assert sim.truth()["touching"]
    assert sim.verdict["lost"] is None


def test_the_scenarios_mission_flies_until_the_first_command_takes_its_place() -> None:
    scenario = {"mission": [{"do": "arm"}, {"do": "takeoff", "altitude": 4.0}]}
    sim = tautline.Sim(scenario)
    sim.step(20_000)
    assert sim.truth()["height"] > 3.0
    sim = tautline.Sim(scenario)
    sim.hold(15.0)
    sim.step(20_000)
    assert sim.truth()["height"] < 0.5
    assert sim.mission[0] == "failed", "nobody armed it"


def test_an_operator_who_is_done_keeps_the_link() -> None:
    sim = flying()
    sim.step(30_000)
    assert sim.observe()["mode"] == "Tether Hold"
    assert not [text for _, text in sim.texts if "ink" in text]


def test_what_is_observed_is_near_the_truth() -> None:
    sim = flying(5.0)
    sim.step(5_000)
    seen, truth = sim.observe(), sim.truth()
    assert seen["position"] is not None
    assert np.linalg.norm(seen["position"] - truth["position"]) < 0.7
    assert abs(np.dot(seen["attitude"], truth["attitude"])) > 0.999
    assert seen["tension"] == pytest.approx(truth["tension"], abs=2.0)
    assert truth["rotor_speed"].shape == seen["throttle"].shape == (4,)
    assert seen["time"] == pytest.approx(sim.time)


def test_the_same_seed_and_commands_give_the_same_world() -> None:
    one, same = (flying().truth()["position"] for _ in range(2))
    assert (one == same).all()


def test_a_fault_that_is_injected_acts_and_ends() -> None:
    sim = flying()
    at_rest = sim.truth()["position"]
    sim.inject("push_east", 4.0, duration=1.0)
    sim.step(500)
    assert sim.faults == ["push_east"]
    assert sim.truth()["velocity"][1] > 0.3
    sim.step(10_000)
    assert sim.faults == []
    assert np.linalg.norm(sim.truth()["position"] - at_rest) < 1.0
    sim.inject("tether_broken")
    sim.step(100)
    assert sim.truth()["tension"] == 0.0
    sim.heal("tether_broken")
    assert sim.faults == []


def test_a_fault_that_cannot_be_says_so() -> None:
    sim = tautline.Sim({})
    with pytest.raises(
        ValueError, match="unknown variant `push_west`, expected one of `imu_frozen`"
    ):
        sim.inject("push_west", 1.0)
    with pytest.raises(ValueError, match="is outside -1000 to 1000"):
        sim.inject("push_east", 1e9)
    assert {"push_east", "imu_frozen"} <= {kind for kind, _, _ in tautline.fault_kinds()}


def test_a_parameter_is_set_by_the_link_and_its_range_is_kept() -> None:
    sim = tautline.Sim({})
    sim.step(100)
    sim.set_param("TET_TENSION", 7.5)
    sim.set_param("EST_KIND", 0)
    sim.step(10)
    assert sim.param("TET_TENSION") == 7.5
    assert sim.param("EST_KIND") == 0.0
    with pytest.raises(ValueError, match="TET_TENSION = 1000000000 is outside"):
        sim.set_param("TET_TENSION", 1e9)
    with pytest.raises(ValueError, match="no parameter NONE"):
        sim.param("NONE")


def test_a_command_that_cannot_be_leaves_the_mission_alone() -> None:
    sim = tautline.Sim({"mission": [{"do": "arm"}, {"do": "takeoff", "altitude": 4.0}]})
    with pytest.raises(ValueError, match="mission.0..altitude = 1000 is outside"):
        sim.takeoff(1000.0)
    sim.step(20_000)
    assert sim.truth()["height"] > 3.0


def test_what_fails_is_raised_by_finish() -> None:
    sim = tautline.Sim({})
    sim.takeoff(3.0)
    with pytest.raises(RuntimeError, match="never armed: Take-off refused"):
        sim.finish()


def test_places_are_followed_in_offboard() -> None:
    sim = flying(5.0)
    start = sim.truth()["position"]
    for _ in range(200):
        sim.place(start + [0.0, 1.0, 0.0], 0.0)
        sim.step(50)
    assert sim.observe()["mode"] == "Offboard"
    assert sim.truth()["position"][1] - start[1] > 0.6


def test_a_log_is_kept_where_it_is_asked_for() -> None:
    sim = tautline.Sim({}, log=True)
    sim.step(1000)
    assert "sensor_combined" in sim.finish_log()
    with pytest.raises(RuntimeError, match="no log is kept"):
        sim.finish_log()
