"""One flight, advanced a millisecond at a time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from . import _native
from .log import Log
from .types import Attitude, Command, Observation, Params, Rates, Scenario, Sensors, Truth, Vector


class Sim:
    """The firmware in its simulated world; the same seed gives the same flight to the bit.

    The scenario's mission is flown as the time goes on; the first command (:meth:`arm`, :meth:`takeoff`, :meth:`hold`,
    :meth:`move`, :meth:`land`, :meth:`ask`) takes its place. Commands queue up, each is flown when the one before is
    done, and go the way that a ground station's go: by MAVLink.

    >>> sim = Sim({})
    >>> sim.arm(); sim.takeoff(3.0); sim.finish()
    >>> 2.5 < sim.truth()["height"] < 3.5
    True
    """

    def __init__(
        self, scenario: Scenario, seed: int = 1, params: Params = None, *, log: bool = False
    ) -> None:
        """``log``: keep a log for :meth:`finish_log`.

        Raises ``ValueError`` with one line that names what is wrong with scenario or parameters.
        """
        self._native = _native.Sim(scenario, seed, params, log=log)
        self._is_taken = False
        self._texts: list[tuple[float, str]] = []

    @property
    def time(self) -> float:
        """s since the first step."""
        return self._native.time

    def step(self, n: int = 1) -> None:
        """``n`` milliseconds on. Other threads run meanwhile, and Ctrl-C ends it."""
        self._native.step(n)

    def finish(self, limit: float = 600.0) -> None:
        """On until everything asked for is done, or for ``limit`` s.

        Raises ``RuntimeError`` when a command failed or the time is over.
        """
        self._native.finish(self.time + limit)
        state, why = self._native.mission
        if state != "done":
            raise RuntimeError(why or f"not done after {limit} s")

    @property
    def mission(self) -> tuple[str, str | None]:
        """``flying``, ``done`` or ``failed``, and why it failed."""
        return self._native.mission

    def observe(self) -> Observation:
        """What the firmware knows and does."""
        return self._native.observe()

    def truth(self) -> Truth:
        """What is so."""
        return self._native.truth()

    def sensors(self) -> Sensors:
        """What the sensors said since the last call; the first call only begins."""
        return self._native.sensors()

    @property
    def texts(self) -> list[tuple[float, str]]:
        """What the vehicle said: time, s, and text."""
        self._texts.extend(self._native.texts())
        return list(self._texts)

    @property
    def verdict(self) -> dict[str, Any]:
        """How it was flown so far, from the truth."""
        return self._native.verdict()

    def inject(
        self,
        kind: str,
        value: float | None = None,
        duration: float | None = None,
        *,
        ramp: float | None = None,
        axis: str | None = None,
        rotor: int | None = None,
        from_: float | None = None,
        period: float | None = None,
    ) -> None:
        """Breaks something from now on: ``kind`` as in a scenario's ``[[fault]]`` (:func:`tautline.fault_kinds`).

        ``value`` in the kind's unit, 0 when absent; ``duration`` s, to the end when absent; ``ramp`` s up to the whole
        value; ``axis`` ``x``, ``y`` or ``z``; ``rotor`` from 1; ``from_`` rad from North; ``period`` s. Raises
        ``ValueError``.
        """
        keys = {
            "value": None if value is None else float(value),
            "duration": None if duration is None else float(duration),
            "ramp": ramp,
            "axis": axis,
            "rotor": rotor,
            "from": from_,
            "period": period,
        }
        given = {name: key for name, key in keys.items() if key is not None}
        self._native.inject({"kind": kind, **given})

    def heal(self, kind: str) -> None:
        """Ends every fault of a kind."""
        self._native.heal(kind)

    @property
    def faults(self) -> list[str]:
        """Kinds of the faults that are active now."""
        return self._native.faults

    def ask(self, do: str, **keys: object) -> None:
        """A step of a mission as a scenario's ``[[mission]]`` spells it: ``ask("takeoff", altitude=5.0)``."""
        self._native.ask({"do": do, **keys}, not self._is_taken)
        self._is_taken = True

    def arm(self) -> None:
        """Waits until the vehicle can be armed, and arms it."""
        self.ask("arm")

    def takeoff(self, altitude: float) -> None:
        """To ``altitude`` m over the anchor."""
        self.ask("takeoff", altitude=float(altitude))

    def hold(self, seconds: float) -> None:
        """Stays there; errors are measured."""
        self.ask("hold", seconds=float(seconds))

    def move(
        self,
        elevation: float | None = None,
        azimuth: float | None = None,
        length: float | None = None,
        tension: float | None = None,
    ) -> None:
        """To another place of the line, rad, m and N; what is absent stays."""
        keys = {"elevation": elevation, "azimuth": azimuth, "length": length, "tension": tension}
        self.ask("move", **{name: float(x) for name, x in keys.items() if x is not None})

    def land(self) -> None:
        """Lands and waits until disarmed."""
        self.ask("land")

    def param(self, name: str) -> float:
        """A parameter of the firmware. Raises ``ValueError``: there is none of this name."""
        return self._native.param(name)

    def set_param(self, name: str, value: float) -> None:
        """By MAVLink, as a ground station does; it holds within a few steps. Raises ``ValueError``."""
        self._native.set_param(name, value)

    def place(self, position: Sequence[float] | Vector, yaw: float) -> None:
        """A set-point in Offboard: (3,) from the anchor, NED, m, and heading, rad. Half a second of silence ends it."""
        self._native.set_place(position, yaw)

    def command(self, command: Command) -> None:
        """Flies by hand from the next step on: :class:`~tautline.Rates` or :class:`~tautline.Attitude` in Offboard, or
        a throttle for each rotor past the firmware. See :meth:`let_go`."""
        apply(self._native, command)

    def let_go(self) -> None:
        """The firmware flies by itself again, in the mode that it is in."""
        self._native.let_go()

    def finish_log(self) -> Log:
        """Ends the log. Raises ``RuntimeError`` where none is kept."""
        return Log(self._native.finish_log())


def apply(sim: _native.Sim, command: Command) -> None:
    """Hands a controller's command on."""
    if isinstance(command, Rates):
        sim.set_rates(command.rate, command.thrust)
    elif isinstance(command, Attitude):
        sim.set_attitude(command.attitude, command.thrust)
    else:
        sim.set_throttle(command)
