"""A motor's constants, with their sources in motors.toml.

- The battery's sag is a resistance in the motor's circuit. A motor at duty d draws d i from the
  battery, and the other is taken to draw as much; so a wheel can be computed alone, exactly as long
  as both wheels work equally hard.
- The body's mass is taken to sit over the wheels, half at each (radius of gyration = half the
  track): then driving and turning decouple, and each wheel carries wheel inertia + mass/2 radius^2
  by itself.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from math import pi
from typing import TYPE_CHECKING, Any

from sim_motor.exact_step import Circuit, Step, is_slow, rates, step_of
from sim_motor.own_motors import own_file, own_motor

if TYPE_CHECKING:
    import numpy as np

SUBSTEPS_PER_S = 1000
SUBSTEP_S = 1.0 / SUBSTEPS_PER_S
GRAVITY = 9.81


@dataclass(frozen=True)
class Constants:
    """One motor with its wheel and its share of the robot.

    SI units, torques and inertias at the output shaft.
    """

    torque_constant: float
    emf_constant: float
    resistance: float
    inductance: float
    motor_inertia: float
    viscous: float
    kinetic: float
    static: float
    wheel_inertia: float  # of the wheel and of half the body, which the wheel carries
    rolling: float
    backlash: float
    source_resistance: float
    battery_v: float
    latency_s: float
    encoder_counts: float
    dither: float  # of the encoder, rad
    wheel_radius: float
    spread: float
    dither_seed: int = 0

    def with_wheel(self, inertia: float) -> Constants:
        """With a wheel of this moment of inertia (kg m2), and nothing else to carry."""
        return replace(self, wheel_inertia=inertia)

    def with_dither(self, dither_deg: float, seed: int = 0) -> Constants:
        """With an encoder whose samples have random errors.

        Args:
            dither_deg: Their standard deviation, degrees.
            seed: Their random seed. In a batch, wheels that share a motor count up from it.
        """
        return replace(self, dither=dither_deg * pi / 180, dither_seed=seed)

    def varied(self, strength: float, friction: float) -> Constants:
        """Another specimen: torque and friction by these factors.

        It starts to move at the same duty.
        """
        return replace(
            self,
            torque_constant=self.torque_constant * strength,
            kinetic=self.kinetic * friction,
            static=self.static * strength,
        )

    def specimens(self, count: int, rng: np.random.Generator) -> tuple[Constants, ...]:
        """Specimens at random, within the published spread."""
        factors = rng.uniform(1 - self.spread, 1 + self.spread, (count, 2))
        return tuple(self.varied(*pair) for pair in factors.tolist())

    def scalars(self) -> tuple[float, ...]:
        """What `advance` needs besides the steps, in the order of sim_motor.motor."""
        share = self.wheel_inertia / (self.motor_inertia + self.wheel_inertia)
        return (
            self.torque_constant,
            self.viscous,
            self.kinetic,
            self.static,
            self.rolling,
            self.wheel_inertia,
            share,
            self.backlash / 2,
        )

    def circuit(self) -> Circuit:
        """What decides its steps; see sim_motor.exact_step."""
        return (
            self.resistance,
            self.source_resistance,
            self.inductance,
            self.torque_constant,
            self.emf_constant,
            self.viscous,
            self.motor_inertia,
            self.wheel_inertia,
        )

    def require_slow(self) -> None:
        """Raise ValueError if the motor is too fast for a substep."""
        # At full duty without a wheel everything changes fastest.
        if not is_slow(rates(0, 100, self.circuit()), SUBSTEP_S):
            raise ValueError(
                "its speed or current would change much faster than in a simulated step of"
                f" {1000 * SUBSTEP_S:g} ms: inertia or inductance is too small, or resistance,"
                " friction or a torque constant too large"
            )


class Steps(dict[tuple[int, int], Step]):
    """A motor's steps by (alone or with wheel, |duty| in % or COAST), each computed when needed.

    Args:
        constants: The motor's.

    Raises:
        ValueError: The motor is too fast for the step.
    """

    def __init__(self, constants: Constants) -> None:
        super().__init__()
        constants.require_slow()
        self._circuit = constants.circuit()

    def __missing__(self, key: tuple[int, int]) -> Step:
        self[key] = step = step_of(*key, self._circuit, SUBSTEP_S)
        return step


@cache
def data() -> dict[str, dict[str, list[Any]]]:
    """The data file: tables of name -> [value, unit, source]. Not to be changed."""
    return tomllib.loads((files("sim_motor") / "motors.toml").read_text())


def names() -> list[str]:
    """The published motors; the first is the default."""
    return [table for table in data() if table != "robot"]


def load(name: str = "pybricks") -> Constants:
    """A motor in the robot.

    Args:
        name: A published motor's, or that of one in the user's own file. What that says of the
            robot counts more than what is published.

    Raises:
        ValueError: There is no motor of this name, or the user's file is wrong. The message says
            what to do.
    """
    published = data()
    entry = published[name] if name in names() else own_motor(name, published)
    values = {key: float(row[0]) for key, row in {**published["robot"], **entry}.items()}
    share = values["mass"] / 2
    rolling = values["rolling_resistance"] * share * GRAVITY * values["wheel_radius"]
    start_v = values["break_away_duty"] / 100 * values["battery_voltage"]
    constants = Constants(
        torque_constant=values["torque_constant"],
        emf_constant=values["emf_constant"],
        resistance=values["resistance"],
        inductance=values["inductance"],
        motor_inertia=values["inertia"],
        viscous=values["viscous_friction"],
        kinetic=values["coulomb_friction"],
        static=values["torque_constant"] * start_v / values["resistance"] - rolling,
        wheel_inertia=values["wheel_inertia"] + share * values["wheel_radius"] ** 2,
        rolling=rolling,
        backlash=values["backlash"] * pi / 180,
        source_resistance=values["source_resistance"],
        battery_v=values["battery_voltage"],
        latency_s=values["latency"],
        encoder_counts=values["encoder_counts"],
        dither=values["encoder_dither"] * pi / 180,
        wheel_radius=values["wheel_radius"],
        spread=values["spread"],
    )
    if name not in names():
        try:
            constants.require_slow()
        except ValueError as error:
            raise ValueError(
                f"motor '{name}' in {own_file()} cannot be simulated: {error}; mend that file, or"
                " calibrate again"
            ) from error
    return constants
