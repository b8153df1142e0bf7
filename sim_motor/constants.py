"""A motor's constants, with their sources in motors.toml, and the tables that its model needs.

- The battery's sag is a resistance in the motor's circuit. A motor at duty d draws d i from the
  battery, and the other is taken to draw as much; so a wheel can be computed alone, exactly as long
  as both wheels work equally hard.
- The body's mass is taken to sit over the wheels, half at each (radius of gyration = half the
  track): then driving and turning decouple, and each wheel carries wheel inertia + mass/2 radius^2
  by itself.
"""

import tomllib
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from importlib.resources import files
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim_motor.own_motors import own_file, own_motor

Array = NDArray[np.float64]

SUBSTEPS_PER_S = 1000
SUBSTEP_S = 1.0 / SUBSTEPS_PER_S
COAST = 101  # in place of a duty cycle
GRAVITY = 9.81
# Computing the tables of this many motors at once fits into the cache of a processor's core.
_GROUP = 15
# With rows of entries that sum up to more than this, the series of an exponential loses its digits.
_LARGEST = 16.0


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

    def with_wheel(self, inertia: float) -> "Constants":
        """With a wheel of this moment of inertia (kg m2), and nothing else to carry."""
        return replace(self, wheel_inertia=inertia)

    def with_dither(self, dither_deg: float, seed: int = 0) -> "Constants":
        """With an encoder whose samples have random errors.

        Args:
            dither_deg: Their standard deviation, degrees.
            seed: Their random seed. In a batch, wheels that share a motor count up from it.
        """
        return replace(self, dither=dither_deg * pi / 180, dither_seed=seed)

    def varied(self, strength: float, friction: float) -> "Constants":
        """Another specimen: torque and friction by these factors.

        It starts to move at the same duty.
        """
        return replace(
            self,
            torque_constant=self.torque_constant * strength,
            kinetic=self.kinetic * friction,
            static=self.static * strength,
        )

    def specimens(self, count: int, rng: np.random.Generator) -> "tuple[Constants, ...]":
        """Specimens at random, within the published spread."""
        factors = rng.uniform(1 - self.spread, 1 + self.spread, (count, 2))
        return tuple(self.varied(*pair) for pair in factors.tolist())

    def scalars(self) -> Array:
        """What `advance` needs besides the tables."""
        share = self.wheel_inertia / (self.motor_inertia + self.wheel_inertia)
        half = self.backlash / 2
        return np.array(
            [
                self.torque_constant,
                self.viscous,
                self.kinetic,
                self.static,
                self.rolling,
                self.wheel_inertia,
                share,
                half,
            ]
        )

    def tables(self) -> Array:
        """Those of `tables`, (2, COAST + 1, 14)."""
        own: Array = tables([self])[0]
        return own


def tables(motors: Sequence[Constants]) -> Array:
    """Exact solutions of motors over one substep. Not to be changed: those of few are kept.

    Returns:
        Coefficients, (motors, alone or with wheel, |duty| in % or COAST, 14): new speed from speed,
        current, voltage, torque; new current from the same; turned angle from the same; and the new
        current of a locked motor from current and voltage.

    Raises:
        ValueError: A motor is too fast for the step.
    """
    groups = [tuple(motors[first : first + _GROUP]) for first in range(0, len(motors), _GROUP)]
    if len(groups) == 1:
        return _tables_of_few(groups[0])
    with ThreadPoolExecutor() as pool:  # numpy multiplies matrices on all cores
        return np.concatenate(list(pool.map(_tables, groups)))


@lru_cache(maxsize=8)
def _tables_of_few(motors: tuple[Constants, ...]) -> Array:
    return _tables(motors)


def _tables(motors: Sequence[Constants]) -> Array:
    duty = np.arange(COAST) / 100

    def each(name: str) -> Array:
        """A constant of all motors, (motors, 1, 1) to go with sides and duties."""
        return np.array([getattr(motor, name) for motor in motors])[:, None, None]

    ohms = each("resistance") + 2 * each("source_resistance") * duty**2
    own = each("motor_inertia")
    inertia = np.concatenate([own, own + each("wheel_inertia")], axis=1)
    # Of speed, current, angle and the constant voltage and torque.
    system = np.zeros((len(motors), 2, COAST + 1, 5, 5))
    system[..., 0, 0] = -each("viscous") / inertia
    system[..., 0, 4] = 1 / inertia
    system[..., 2, 0] = 1
    driven = system[:, :, :COAST]
    driven[..., 0, 1] = each("torque_constant") / inertia
    driven[..., 1, 0] = -each("emf_constant") / each("inductance")
    driven[..., 1, 1] = -ohms / each("inductance")
    driven[..., 1, 3] = 1 / each("inductance")
    solution = _exponential(system * SUBSTEP_S)[..., :3, :][..., (0, 1, 3, 4)]
    out = np.zeros((*system.shape[:3], 14))
    out[..., :12] = solution.reshape(*system.shape[:3], 12)
    out[:, :, :COAST, 12] = np.exp(-ohms / each("inductance") * SUBSTEP_S)
    out[:, :, :COAST, 13] = (1 - out[:, :, :COAST, 12]) / ohms
    return out


def _exponential(matrices: Array) -> Array:
    """exp of each matrix in a stack, by its series at a 256th of the size, squared eight times.

    Raises:
        ValueError: An entry is so large that the series would lose all digits, or is not finite.
    """
    small = matrices / 256
    if not np.abs(small).sum(axis=-1).max() <= _LARGEST:
        raise ValueError(
            "its speed or current would change much faster than in a simulated step of"
            f" {1000 * SUBSTEP_S:g} ms: inertia or inductance is too small, or resistance, friction"
            " or a torque constant too large"
        )
    term, out = small, np.eye(small.shape[-1]) + small
    order = 1
    while True:
        order += 1
        term = term @ small / order
        before, out = out, out + term
        # From the sixth power on every entry that can differ from 0 does, and terms only shrink.
        if order > 6 and np.array_equal(out, before):
            break
    for _ in range(8):
        out = out @ out
    return out


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
            constants.tables()
        except ValueError as error:
            raise ValueError(
                f"motor '{name}' in {own_file()} cannot be simulated: {error}; mend that file, or"
                " calibrate again"
            ) from error
    return constants
