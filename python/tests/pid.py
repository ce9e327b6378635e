"""A plain PID hold, and a filter that believes the altimeter: what somebody may bring along."""

from __future__ import annotations

from typing import Any

import numpy as np

from tautline import Attitude, Observation, Rates, Sensors

MASS = 1.5
GRAVITY = np.array([0.0, 0.0, 9.81])
DT = 1 / 250


def down_axis(attitude: Any) -> Any:
    """(3,) the body's down axis in the world, of ``[w, x, y, z]``."""
    w, x, y, z = attitude
    return np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])


def to_body(attitude: Any, vector: Any) -> Any:
    """(3,) a vector of the world in body axes."""
    w, u = attitude[0], -np.asarray(attitude[1:])
    return vector + 2 * w * np.cross(u, vector) + 2 * np.cross(u, np.cross(u, vector))


class Pid:
    """Position to force to body rates."""

    def __init__(self, kind: str = "rates") -> None:
        self.kind = kind
        self.integral = np.zeros(3)
        self.calls = 0

    def force(self, seen: Observation) -> Any:
        """Thrust wanted, world axes, N."""
        position, velocity = seen["position"], seen["velocity"]
        reference, tension = seen["reference_position"], seen["tension"]
        assert position is not None and velocity is not None
        assert reference is not None and tension is not None
        error = reference - position
        self.integral = np.clip(self.integral + 0.5 * error * DT, -2.0, 2.0)
        accel = np.clip(1.5 * error - 2.2 * velocity + self.integral, -3.0, 3.0)
        pull = -tension * position / np.linalg.norm(position)
        return MASS * (accel - GRAVITY) - pull

    def control(self, t: float, seen: Observation) -> Rates | Attitude:
        """What the vehicle is asked."""
        self.calls += 1
        force = self.force(seen)
        thrust = float(np.linalg.norm(force))
        down = -force / thrust
        if self.kind == "attitude":
            half = np.array([1.0 + down[2], -down[1], down[0], 0.0])
            return Attitude(half / np.linalg.norm(half), thrust)
        turn = to_body(seen["attitude"], np.cross(down_axis(seen["attitude"]), down))
        rate = 7.0 * turn
        rate[2] = 0.0
        return Rates(rate, thrust)


class Altimeter:
    """Height alone, as the altimeter shows it, straight over the anchor."""

    def __init__(self) -> None:
        self.height = 0.0

    def update(self, t: float, sensors: Sensors) -> dict[str, Any]:
        """The estimate."""
        if sensors["altitude"] is not None:
            self.height = sensors["altitude"]
        return {"position": [0.0, 0.0, -self.height], "tension": 6.5, "note": 1.0}
