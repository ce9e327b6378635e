"""What goes between the simulator and whoever flies in it."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypedDict, Union

import numpy as np
import numpy.typing as npt

Vector = npt.NDArray[np.float64]
"""A one-dimensional array of float64."""

Scenario = Union[str, "os.PathLike[str]", Mapping[str, Any]]
"""A TOML file's path, TOML text, or a dict of the same keys (docs/scenarios.md)."""

Params = Union[Mapping[str, float], str, "os.PathLike[str]", None]
"""Parameters of the firmware by name, or the path of a parameter file."""


class Observation(TypedDict):
    """What the firmware knows and does; ``None``: it does not know."""

    time: float
    """s since the first step."""
    mode: str
    """Flight mode, as ``Tether Hold``."""
    armed: bool
    armable: bool
    in_air: bool
    attitude: Vector
    """(4,) body to world, ``[w, x, y, z]``."""
    rate: Vector
    """(3,) body axes, rad/s."""
    position: Vector | None
    """(3,) from the anchor, NED, m."""
    velocity: Vector | None
    """(3,) NED, m/s."""
    height: float
    """m over the anchor."""
    climb: float
    """m/s, up."""
    elevation: float | None
    """rad."""
    azimuth: float | None
    """rad from North."""
    length: float | None
    """Distance from the anchor, m."""
    tension: float | None
    """At the vehicle, N."""
    taut: bool | None
    reference_position: Vector | None
    """(3,) where to be, NED, m; of a hold that is flown by hand, where it was to be when it was taken over."""
    reference_velocity: Vector | None
    """(3,) NED, m/s."""
    reference_yaw: float | None
    """rad from North."""
    throttle: Vector
    """(rotors,) what the firmware asks of the rotors, 0..1."""
    winch_tension: float
    """N, asked of the winch."""


class Truth(TypedDict):
    """What is so."""

    time: float
    """s."""
    position: Vector
    """(3,) centre of mass from the anchor, NED, m."""
    velocity: Vector
    """(3,) NED, m/s."""
    attitude: Vector
    """(4,) body to world, ``[w, x, y, z]``."""
    rate: Vector
    """(3,) body axes, rad/s."""
    specific_force: Vector
    """(3,) body axes, m/s²."""
    height: float
    """Over the ground, m."""
    touching: bool
    elevation: float
    """rad."""
    azimuth: float
    """rad from North."""
    length: float
    """Line outside, m."""
    tension: float
    """At the vehicle, N."""
    station_tension: float
    """At the ground, N."""
    pull: Vector
    """(3,) of the line on the vehicle, NED, N."""
    anchor: Vector
    """(3,) NED, m."""
    wind: Vector
    """(3,) velocity of the air, NED, m/s."""
    rotor_speed: Vector
    """(rotors,) rad/s."""
    thrust: float
    """Of all rotors, N."""
    battery_voltage: float
    """V."""
    battery_charge: float
    """0..1."""


class Sensors(TypedDict):
    """What the sensors said since the last call; ``None``: nothing, or not fitted."""

    time: float
    """s."""
    accel: Vector | None
    """(3,) mean specific force, body axes, m/s²."""
    gyro: Vector | None
    """(3,) mean angular rate, body axes, rad/s; its bias is in it."""
    altitude: float | None
    """m over the anchor: rangefinder, or barometer beyond its range."""
    length: float | None
    """Line outside by the winch's encoder, m."""
    thrust: float
    """Of all rotors by the motor model, N."""
    velocity: Vector | None
    """(3,) over the ground by optical flow, body axes, m/s."""
    line_direction: Vector | None
    """(3,) from the vehicle down the line, body axes."""
    line_tension: float | None
    """By the load cell at the vehicle, N."""
    station_tension: float | None
    """At the ground, N."""
    station_direction: Vector | None
    """(3,) from the station up the line, NED."""
    magnetic: Vector | None
    """(3,) body axes, µT."""
    winch_tension: float
    """Asked of the winch, where there is one, N."""
    battery_voltage: float | None
    """V."""


@dataclass(frozen=True)
class Rates:
    """Body rates and thrust, flown by the firmware's rate loop in Offboard."""

    rate: Sequence[float] | Vector
    """(3,) rad/s, limited to ``ATC_RATE_MAX`` and, about the down axis, ``ATC_YAWRATE_MAX``."""
    thrust: float
    """N, limited to ``TPC_THR_MAX``."""


@dataclass(frozen=True)
class Attitude:
    """Attitude and thrust, flown by the firmware's attitude loop in Offboard."""

    attitude: Sequence[float] | Vector
    """(4,) body to world, ``[w, x, y, z]``."""
    thrust: float
    """N, limited to ``TPC_THR_MAX``."""


Command = Rates | Attitude | Sequence[float] | Vector
"""What a controller asks for: rates, an attitude, or the throttle of each rotor, 0..1."""


class Controller(Protocol):
    """Flies the holds of a mission in place of the firmware's own controller."""

    def control(self, t: float, observation: Observation) -> Command:
        """What to do at ``t`` s until the next call."""
        ...


class Estimator(Protocol):
    """Runs beside the firmware's own estimator; nothing flies on it."""

    def update(self, t: float, sensors: Sensors) -> Mapping[str, Any]:
        """The estimate at ``t`` s: any of ``position`` (3,) NED m, ``velocity`` (3,) NED m/s, ``attitude`` (4,)
        ``[w, x, y, z]``, ``tension`` N. Other numbers are logged."""
        ...
