"""A train of cars as a Gymnasium environment. Its wheels drive it, and an agent can only kick them.

Importing this registers it: gymnasium.make("sim_motor.bodies.environment:kickctl/Train-v0", ...),
from kickctl[gym].
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import gymnasium
import mujoco
import numpy as np
from numpy.typing import NDArray

from robot.kick_requests import parse
from robot.kicks import MAX_TICKS, MEMBRANE, PHASE, POSITION
from robot.params import Params
from sim_motor.bodies.body import OF_A_CAR, Body, Unstable
from sim_motor.bodies.measures import STILL_RAD_S
from sim_motor.bodies.model import car_name, compose
from sim_motor.bodies.presets import NAMES
from sim_motor.bodies.presets import preset as preset_of
from sim_motor.bodies.running_summary import RunningSummary

Info = dict[str, Any]
Observation = NDArray[np.float32]
Action = NDArray[np.int64]

ID = "kickctl/Train-v0"
# What an agent can do to a wheel: nothing, or one of the paper's kicks. A phase shift takes the
# sign that reverses this wheel.
KICKS = (None, MEMBRANE, POSITION, PHASE)
# Observed speeds are parts of these (rad/s), which a body on its wheels does not reach.
WHEEL_RAD_S, JOINT_RAD_S = 200.0, 50.0
PICTURE = (640, 480)
STEP_S = 0.001
_LONGEST_S = {"decision_s": 60.0, "kick_s": MAX_TICKS * STEP_S, "time_s": 1e6}
# How far (m) the camera is away, and how much more for each car of the train.
_NEAR_M, _FURTHER_M = 0.7, 0.25


class Train(gymnasium.Env[Observation, Action]):
    """A train, or with cars=1 a car, in a scene.

    The names of presets and scenes are those of `compose`.

    Action: (wheels,), for each wheel a number of KICKS. Every decision_s (s) one may begin; a
    quenched one lasts kick_s (s), and takes the place of one that still acts on the wheel.
    Observation: proprioception, each in [-1, 1]: of the wheels sin and cos of the angle, omega /
    WHEEL_RAD_S, membrane potential; of the joints angle / its range, rate / JOINT_RAD_S; wheels and
    joints in the order of Body. Info: time_s, cars (for each, head first, x m, y m, yaw rad),
    direction (1 forward, -1 backward, 0 at rest), kicks (how many so far), summary (of `measures`,
    from the state at each decision so far), ended (why, if it is terminated). reward: what an info
    is worth.

    Terminated if a car fell over or the simulation cannot be followed; truncated after time_s.
    Options of reset: scene, and phases (rad), (wheels,), of the wheels at the start; all other
    chance is the seed's.

    Raises ValueError if there is no preset, scene or time as given. To draw where there is no
    display, set MUJOCO_GL to egl or osmesa before mujoco is imported.
    """

    # As gymnasium has it.
    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012

    def __init__(
        self,
        *,
        preset: str = "paper",
        scene: str = "flat",
        cars: int = 5,
        decision_s: float = 0.1,
        kick_s: float = 0.1,
        time_s: float = 60.0,
        reward: Callable[[Info], float] = lambda info: 0.0,
        render_mode: str | None = None,
    ) -> None:
        if preset not in NAMES:
            raise ValueError(f"there is no preset '{preset}'; there are {', '.join(NAMES)}")
        for name, value in (("decision_s", decision_s), ("kick_s", kick_s), ("time_s", time_s)):
            if not STEP_S <= value <= _LONGEST_S[name]:
                raise ValueError(
                    f"{name} cannot be {value!r}: give seconds from {STEP_S:g} to"
                    f" {_LONGEST_S[name]:g}"
                )
        self.metadata = {**self.metadata, "render_fps": max(1, round(1 / decision_s))}
        self.render_mode, self._reward = render_mode, reward
        self._preset, self._scene, self._cars = preset_of(preset), scene, cars
        self._decision_s, self._kick_s, self._time_s = decision_s, kick_s, time_s
        self._renderer: mujoco.Renderer | None = None
        self._begin(scene, 0, None)
        self.action_space: gymnasium.Space[Action] = gymnasium.spaces.MultiDiscrete(
            [len(KICKS)] * len(self._body.wheels)
        )
        self.observation_space: gymnasium.Space[Observation] = gymnasium.spaces.Box(
            -1.0, 1.0, self._observe().shape, np.float32
        )

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, Info]:
        super().reset(seed=seed)
        options = options or {}
        unknown = set(options) - {"scene", "phases"}
        if unknown:
            raise ValueError(
                f"reset has no option {', '.join(sorted(unknown))}; it has scene and phases"
            )
        self.close()
        self._begin(
            options.get("scene", self._scene),
            int(self.np_random.integers(2**31)),
            options.get("phases"),
        )
        return self._observe(), self._info("")

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, Info]:
        if not self.action_space.contains(action):
            raise ValueError(
                f"no such action: {action!r}; it has {len(self._body.wheels)} whole numbers from 0"
                f" to {len(KICKS) - 1}"
            )
        body, ended, ticks = self._body, "", round(self._kick_s / STEP_S)
        for wheel, omega, choice in zip(body.wheels, body.omega, action, strict=True):
            mode = KICKS[choice]
            if mode is not None:
                request = {"id": wheel, "mode": mode} | (
                    {} if mode == MEMBRANE else {"ticks": ticks}
                )
                kick = parse(request, (int(np.sign(omega)),) * 2, Params(), body.step)
                kick.wheels = (wheel,)
                body.kick(kick)
                self._kicks += 1
        try:
            body.run(self._decision_s, lambda time_s: self._summary.add(body.rows[-1:]))
        except Unstable as error:
            ended = str(error)
        info = self._info(ended)
        return (
            self._observe(),
            self._reward(info),
            bool(info["ended"]),
            body.time_s > self._time_s - STEP_S / 2,
            info,
        )

    def render(self) -> Any:
        """What it looks like now, (height, width, 3), if the render mode is rgb_array.

        Raises:
            RuntimeError: Nothing here can draw.
        """
        if self.render_mode is None:
            return None
        if self._renderer is None:
            try:
                self._renderer = mujoco.Renderer(self._body.model, PICTURE[1], PICTURE[0])
            except (
                Exception
            ) as error:  # what is wrong with a system's OpenGL comes as any kind of exception
                hint = "install kickctl[bodies], set MUJOCO_GL to egl or osmesa, and start again"
                raise RuntimeError(f"no picture can be made here ({error}): {hint}") from error
        camera = mujoco.MjvCamera()
        camera.type, camera.trackbodyid = (
            mujoco.mjtCamera.mjCAMERA_TRACKING,
            self._body.model.body(car_name(self._cars // 2) + "car").id,
        )
        camera.azimuth, camera.elevation, camera.distance = (
            125.0,
            -28.0,
            _NEAR_M + _FURTHER_M * self._cars,
        )
        self._renderer.update_scene(self._body.data, camera)
        return self._renderer.render()

    def close(self) -> None:
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    def _begin(self, scene: str, seed: int, phases: Any) -> None:
        model = compose(self._preset, scene, self._cars, seed=seed, timestep=STEP_S).compile()
        if phases is not None and np.shape(phases) != (2 * self._cars,):
            raise ValueError(f"phases need {2 * self._cars} angles, one for each wheel")
        # An episode may be long: it must not take more memory with each decision.
        self._body = Body(
            model, self._preset, seed=seed, phases=phases, record_s=self._decision_s, keep=1
        )
        columns = self._body.columns
        self._omegas = [name.endswith("_omega_rad_s") for name in columns]
        self._summary = RunningSummary(columns)
        self._summary.add(self._body.rows[-1:])
        self._kicks = 0

    def _observe(self) -> Observation:
        body = self._body
        bends, rates = (
            np.array(
                [getattr(body.data.joint(name), what)[0] for name in body.joints], dtype=np.float64
            )
            for what in ("qpos", "qvel")
        )
        phi = np.nan_to_num([body.data.joint(name).qpos[0] for name in body.wheels])
        parts = (
            np.sin(phi),
            np.cos(phi),
            body.omega / WHEEL_RAD_S,
            body.neurons.x1,
            bends / self._preset.joint_range,
            rates / JOINT_RAD_S,
        )
        return np.asarray(
            np.clip(np.nan_to_num(np.concatenate(parts)), -1.0, 1.0), dtype=np.float32
        )

    def _info(self, ended: str) -> Info:
        row, summary = self._body.rows[-1], self._summary.summary()
        poses = row[-self._cars * len(OF_A_CAR) :].reshape(self._cars, -1)
        omega = float(row[self._omegas].mean())
        return {
            "time_s": self._body.time_s,
            "cars": poses[:, [OF_A_CAR.index(name) for name in ("x_m", "y_m", "yaw_rad")]],
            "direction": int(np.sign(omega)) if abs(omega) > STILL_RAD_S else 0,
            "kicks": self._kicks,
            "summary": summary,
            "ended": ended or ("a car fell over" if summary["flipped"] else ""),
        }


gymnasium.register(ID, "sim_motor.bodies.environment:Train")
