"""Worlds without firmware, and environments over them."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import tautline
from tautline.plant import STATE


def hover(plant: tautline.Plant) -> list[float]:
    """The throttle that lifts 1.5 kg and 6.5 N."""
    lift = (1.5 * 9.81 + 6.5) / 4 / 8.1
    return [lift ** (0.5 / 0.75)] * plant.rotors


def test_a_plant_falls_without_thrust_and_hovers_with_it() -> None:
    fall, stay = tautline.Plant({}), tautline.Plant({})
    for plant in (fall, stay):
        plant.hang([1.0, 0.0, -5.0])
    fall.step([0.0] * 4, 500)
    stay.step(hover(stay), 500)
    names = list(STATE)
    assert fall.state()[names.index("vz")] > 4.0
    assert abs(stay.state()[names.index("vz")]) < 1.0
    assert stay.truth()["rotor_speed"].tolist() == stay.state()[len(names) :].tolist()
    assert stay.time == 0.5


def test_a_plant_keeps_its_seed_and_refuses_what_is_no_number() -> None:
    def run(seed: int) -> list[float]:
        plant = tautline.Plant({"wind": {"speed": 4.0}}, seed)
        plant.hang([1.0, 0.0, -5.0])
        plant.step(hover(plant), 300)
        return [float(x) for x in plant.state()]

    assert run(1) == run(1)
    assert run(1) != run(2)
    with pytest.raises(ValueError, match="4 throttles are expected"):
        tautline.Plant({}).step([0.5])
    with pytest.raises(ValueError, match="not finite"):
        tautline.Plant({}).step([0.5, 0.5, 0.5, float("nan")])
    with pytest.raises(ValueError, match="the attitude is none"):
        tautline.Plant({}).set_motion([0, 0, 0], [0, 0, 0, 0], [0, 0, 0])


@pytest.mark.filterwarnings("ignore:.*Box observation space.*")
@pytest.mark.parametrize("firmware", [False, True])
def test_the_environment_passes_gymnasiums_checker(firmware: bool) -> None:
    check_env(tautline.TetherEnv(firmware=firmware), skip_render_check=True)


def test_an_agent_that_does_nothing_crashes_and_is_told() -> None:
    env = tautline.TetherEnv()
    env.reset(seed=1)
    for _ in range(500):
        seen, reward, terminated, truncated, _ = env.step(-np.ones(4, np.float32))
        assert seen.shape == (19,) and not truncated
        if terminated:
            break
    assert terminated and reward == -10.0


def test_an_episode_ends_in_time() -> None:
    env = tautline.TetherEnv(firmware=True, episode_s=1.0)
    env.reset(seed=1)
    ends = [env.step(np.zeros(3, np.float32))[3] for _ in range(10)]
    assert ends == [False] * 9 + [True]


def test_the_firmware_goes_where_the_agent_says() -> None:
    env = tautline.TetherEnv(firmware=True)
    env.reset(seed=1)
    point = np.array([0.394, 0.0, -0.5], np.float32)  # 60 degrees, 0, 6 m
    rewards = [float(env.step(point)[1]) for _ in range(200)]
    assert np.mean(rewards[-20:]) > 0.5 > rewards[0]


def test_many_worlds_are_the_single_ones_to_the_bit() -> None:
    count, steps = 5, 260
    rng = np.random.default_rng(1)
    actions = rng.uniform(-0.2, 0.4, (steps, count, 4)).astype(np.float32)
    actions[:, 0] = -1.0
    scenario = {"wind": {"speed": 3.0, "gusts": True}}
    many = tautline.TetherVectorEnv(count, scenario, episode_s=2.0)
    ones = [tautline.TetherEnv(scenario, episode_s=2.0) for _ in range(count)]
    seen, _ = many.reset(seed=7)
    for i, one in enumerate(ones):
        assert (one.reset(seed=7 + i)[0] == seen[i]).all()
    ended = [False] * count
    crashes = ends = 0
    for action in actions:
        seen, rewards, terminated, truncated, _ = many.step(action)
        for i, one in enumerate(ones):
            if ended[i]:
                assert (one.reset()[0] == seen[i]).all()
                assert rewards[i] == 0.0 and not terminated[i] and not truncated[i]
                ended[i] = False
                continue
            single, reward, crashed, is_over, _ = one.step(action[i])
            assert (single == seen[i]).all()
            assert (reward, crashed, is_over) == (rewards[i], terminated[i], truncated[i])
            ended[i] = crashed or is_over
            crashes, ends = crashes + crashed, ends + is_over
    assert crashes > 2, "some crashed and began anew"


def test_the_vector_environment_keeps_gymnasiums_api() -> None:
    env = tautline.TetherVectorEnv(3)
    assert isinstance(env, gymnasium.vector.VectorEnv)
    seen, info = env.reset(seed=1)
    assert env.observation_space.contains(seen) and info == {}
    seen, rewards, terminated, truncated, _ = env.step(env.action_space.sample())
    assert env.observation_space.contains(seen)
    assert rewards.shape == terminated.shape == truncated.shape == (3,)
    first = env.reset(seed=[4, 5, 6])[0]
    assert (env.reset(seed=4)[0] == first).all()
    with pytest.raises(ValueError, match="2 seeds for 3 worlds"):
        env.reset(seed=[1, 2])
