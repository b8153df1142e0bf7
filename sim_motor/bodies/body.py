"""A car or a train that runs.

MuJoCo steps the bodies. Between two steps the controllers of all wheels step and set their motors.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from math import pi
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from robot.controller import target_position
from robot.kicks import Kick, apply_kick
from sim_motor.bodies.drive import Wheels, drive
from sim_motor.bodies.model import SIDES, car_name
from sim_motor.bodies.presets import Preset
from sim_motor.mathematics import with_mathematics

Array = NDArray[np.float64]

# How often the state is written down, as in the program of 2019.
RECORD_S = 0.005
OF_A_WHEEL = ("phi_rad", "omega_rad_s", "x", "target", "torque_nm")
OF_A_CAR = ("x_m", "y_m", "z_m", "roll_rad", "pitch_rad", "yaw_rad")
# What MuJoCo's next step depends on.
_PHYSICS = mujoco.mjtState.mjSTATE_INTEGRATION
_target_position: Any = with_mathematics(target_position, {"exp": np.exp})


class Unstable(Exception):
    """The simulation cannot be followed any more. What was simulated until then is kept."""


class Body:
    """Cars in a scene, with their controllers.

    Attributes:
        wheels: The names of the wheels: car0_left, car0_right, car1_left and so on.

    Args:
        model: Compiled from `sim_motor.bodies.model.compose`.
        preset: The cars' numbers.
        seed: Random seed of the phases.
        phases: Of the wheels at the start, rad, (wheels,), with potentials 0, as in the authors'
            programs; random if None.
        torque: If given, the torque of each wheel, N m, all the time, instead of the controllers'.
        record_s: How often to write the state down, s.
        keep: How many of the last written states `rows` has; None for all.

    Raises:
        ValueError: No body can have these numbers, or the steps could not follow it.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        preset: Preset,
        *,
        seed: int = 1,
        phases: Array | None = None,
        torque: float | None = None,
        record_s: float = RECORD_S,
        keep: int | None = None,
    ) -> None:
        _check(preset, float(model.opt.timestep), phases)
        self.model, self.data, self.torque = model, mujoco.MjData(model), torque
        # A simulation that cannot be followed must not restart by itself.
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        self.cars = sum(model.body(number).name.endswith("_car") for number in range(model.nbody))
        self.wheels = tuple(car_name(car) + side for car in range(self.cars) for side in SIDES)
        self.joints = tuple(
            car_name(car) + name for name in ("yaw", "pitch") for car in range(1, self.cars)
        )
        self.neurons = Wheels(len(self.wheels), preset.a, preset.tau, preset.k, preset.wheel_radius)
        self.step, self._every = 0, max(1, round(record_s / float(model.opt.timestep)))
        self._angles = np.array([model.joint(name).qposadr[0] for name in self.wheels])
        self._speeds = np.array([model.joint(name).dofadr[0] for name in self.wheels])
        self._bends = np.array(
            [model.joint(name).qposadr[0] for name in self.joints], dtype=np.int64
        )
        self._bodies = np.array([model.body(car_name(car) + "car").id for car in range(self.cars)])
        self._drags = np.full(self.cars, preset.body_drag)
        self._kicks: list[Kick] = []
        self._notes: deque[Array] = deque(maxlen=keep)
        begin = (
            np.random.default_rng(seed).uniform(0.0, 2 * pi, len(self.wheels))
            if phases is None
            else phases
        )
        self.data.qpos[self._angles] = begin
        mujoco.mj_forward(model, self.data)
        self._note()

    @property
    def time_s(self) -> float:
        """Simulated time."""
        return self.step * float(self.model.opt.timestep)

    @property
    def omega(self) -> Array:
        """How fast the wheels turn (rad/s), (wheels,)."""
        return np.asarray(self.data.qvel[self._speeds])

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of what `rows` has, with their units."""
        wheels = (f"{wheel}_{quantity}" for quantity in OF_A_WHEEL for wheel in self.wheels)
        cars = (f"{car_name(car)}{quantity}" for car in range(self.cars) for quantity in OF_A_CAR)
        return ("t_s", *wheels, *(f"{joint}_joint_rad" for joint in self.joints), *cars)

    @property
    def rows(self) -> Array:
        """The state every record_s, (times, columns): as many of the last as are kept."""
        widths = (1, *(len(self.wheels),) * 4, len(self.joints), 3 * self.cars, 4 * self.cars)
        steps, phi, omega, x, torque, bends, places, turns = np.split(
            np.array(self._notes), np.cumsum(widths)[:-1], axis=1
        )
        count = len(steps)
        poses = np.concatenate(
            [
                places.reshape(count, self.cars, 3),
                _angles_of(turns.reshape(count, self.cars, 4)),
            ],
            axis=2,
        ).reshape(count, -1)
        target = _target_position(x, self.neurons.a)
        times_s = steps * float(self.model.opt.timestep)
        return np.concatenate([times_s, phi, omega, x, target, torque, bends, poses], axis=1)

    @property
    def record_s(self) -> float:
        """Time between two rows."""
        return self._every * float(self.model.opt.timestep)

    @property
    def state(self) -> dict[str, Any]:
        """What decides how it goes on, as plain data; kicks that have not begun are missing."""
        physics = np.empty(mujoco.mj_stateSize(self.model, _PHYSICS))
        mujoco.mj_getState(self.model, self.data, physics, _PHYSICS)
        return {
            "step": self.step,
            "physics": physics.tolist(),
            "floats": self.neurons.floats.tolist(),
            "whole": self.neurons.whole.tolist(),
        }

    def resume(self, state: dict[str, Any]) -> None:
        """Go on, to the bit, from the `state` of a body with the same model.

        `rows` begins there.
        """
        self.step = state["step"]
        mujoco.mj_setState(self.model, self.data, np.array(state["physics"]), _PHYSICS)
        self.neurons.floats[:], self.neurons.whole[:] = state["floats"], state["whole"]
        self._notes.clear()
        self._note()

    def kick(self, kick: Kick) -> None:
        """Begin a kick at its `begin`, in steps, on the wheels whose names it has.

        A wheel has one quenched kick at a time; the next takes its place.

        Raises:
            ValueError: The step is over, or there is no wheel of a name.
        """
        unknown = [name for name in kick.wheels if name not in self.wheels]
        if unknown or kick.begin < self.step:
            raise ValueError(
                f"there is no wheel {', '.join(unknown)}"
                if unknown
                else f"step {kick.begin} is over"
            )
        self._kicks.append(kick)
        self._kicks.sort(key=lambda one: one.begin)

    def run(self, seconds: float, watch: Callable[[float], None] = lambda time_s: None) -> None:
        """Go on for some seconds.

        Args:
            seconds: For how long.
            watch: Called with the time, s, at each record.

        Raises:
            Unstable: See there.
        """
        model, data, own = self.model, self.data, self.neurons
        end, dt_s = self.step + round(seconds / model.opt.timestep), model.opt.timestep
        # Views of memory that stays the same.
        qpos, ctrl, pull, velocity, warnings = (
            data.qpos,
            data.ctrl,
            data.xfrc_applied,
            data.sensordata,
            data.warning,
        )
        while self.step < end:
            while self._kicks and self._kicks[0].begin <= self.step:
                self._begin(self._kicks.pop(0))
            until = min(end, self._next_record(), self._kicks[0].begin if self._kicks else end)
            for step in range(self.step, until):
                mujoco.mj_step1(model, data)
                finite = drive(
                    step,
                    dt_s,
                    own.floats,
                    own.whole,
                    self._angles,
                    qpos,
                    ctrl,
                    self._drags,
                    self._bodies,
                    velocity,
                    pull,
                )
                if not finite:
                    until = step
                    break
                if self.torque is not None:
                    ctrl[:] = self.torque
                mujoco.mj_step2(model, data)
            self.step = until
            sound = finite and np.isfinite(qpos).all()
            if not sound or any(warnings[bad].number for bad in _BAD):
                raise Unstable(
                    f"the simulation cannot be followed beyond {self.time_s:g} s: forces or speeds"
                    " grew without bounds"
                )
            if self.step % self._every == 0:
                self._note()
                watch(self.time_s)

    def _next_record(self) -> int:
        return (self.step // self._every + 1) * self._every

    def _begin(self, kick: Kick) -> None:
        own = self.neurons
        for name in kick.wheels:
            wheel = self.wheels.index(name)
            numbers = kick.numbers(wheel % len(SIDES))
            if kick.pulse:
                _, *own.whole[:, wheel], own.value[wheel], _ = numbers
            else:
                own.x1[wheel], own.x2[wheel], *_ = apply_kick(
                    numbers, kick.begin, own.x1[wheel], own.x2[wheel], 0.0, 0.0, 0.0
                )

    def _note(self) -> None:
        data = self.data
        mujoco.mj_kinematics(self.model, data)
        # No more than `rows` needs: a long run notes millions.
        note = (
            [self.step],
            data.qpos[self._angles],
            data.qvel[self._speeds],
            self.neurons.x1,
            data.ctrl,
            data.qpos[self._bends],
            data.xpos[self._bodies].ravel(),
            data.xquat[self._bodies].ravel(),
        )
        self._notes.append(np.concatenate(note))


# MuJoCo would write its warnings into a file of the present folder; `run` looks for them itself.
mujoco.set_mju_user_warning(lambda words: None)
_BAD = (
    mujoco.mjtWarning.mjWARN_BADQPOS,
    mujoco.mjtWarning.mjWARN_BADQVEL,
    mujoco.mjtWarning.mjWARN_BADQACC,
    mujoco.mjtWarning.mjWARN_BADCTRL,
)


def _check(preset: Preset, step_s: float, phases: Any) -> None:
    """Raise ValueError of numbers with which the steps could not be followed."""
    preset.checked()
    if preset.tau < step_s:
        raise ValueError(
            f"tau cannot be {preset.tau!r}: the neurons take steps of {step_s:g} s, and would jump"
            f" to and fro, farther each time; give {step_s:g} s or more"
        )
    if phases is not None and not np.isfinite(phases).all():
        raise ValueError("the wheels' angles at the start are not all finite numbers")


def _angles_of(turns: Array) -> Array:
    """Roll, pitch and yaw (rad), (..., 3), of unit quaternions (..., 4), the real part first.

    They turn a body by yaw about z, then by pitch about its y, then by roll about its x.
    """
    w, x, y, z = np.moveaxis(turns, -1, 0)
    roll, yaw = (
        np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
        np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
    )
    return np.stack([roll, np.arcsin(np.clip(2 * (w * y - z * x), -1.0, 1.0)), yaw], axis=-1)
