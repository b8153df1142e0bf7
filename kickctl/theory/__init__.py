"""The paper's model of one wheel, for programs and notebooks.

    from kickctl.theory import Wheel, hopf, trajectory

    wheel = Wheel(k=8, tau=0.25, f=0.5, I=0.05)
    print(hopf(wheel).k)                    # above this k a resting wheel begins to swing
    path = trajectory(wheel, t=20)          # arrays: path.t, path.x1, path.x2, path.phi, path.omega

Each function takes a Wheel and returns arrays and numbers; nothing is written to disk. Angles are
in rad, times in s, speeds in rad/s. `run_experiment("branch", k=8)` of `kickctl` runs a whole study
with its figure instead, and keeps its tables. docs/notebook.md has examples.

The names in `__all__` are the public API. Each is loaded when it is first used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kickctl._lazy import load

if TYPE_CHECKING:
    from host.theory.analysis.fixpoints import Fixpoint
    from host.theory.analysis.hopf import Hopf
    from host.theory.model.wheel import Wheel
    from kickctl.theory.branching import Branch, Branches, SpecialPoint, branch
    from kickctl.theory.maps import (
        Basins,
        Kicks,
        PhaseDiagram,
        basins,
        kicks,
        phase_diagram,
    )
    from kickctl.theory.motion import Lyapunov, Trajectory, lyapunov, trajectory
    from kickctl.theory.resting import fixpoints, hopf

__all__ = (
    "Wheel",
    "trajectory",
    "Trajectory",
    "fixpoints",
    "Fixpoint",
    "hopf",
    "Hopf",
    "branch",
    "Branches",
    "Branch",
    "SpecialPoint",
    "phase_diagram",
    "PhaseDiagram",
    "lyapunov",
    "Lyapunov",
    "basins",
    "Basins",
    "kicks",
    "Kicks",
)

_PLACES = {
    "Wheel": "host.theory.model.wheel",
    **dict.fromkeys(("trajectory", "Trajectory", "lyapunov", "Lyapunov"), "kickctl.theory.motion"),
    **dict.fromkeys(("fixpoints", "hopf"), "kickctl.theory.resting"),
    "Fixpoint": "host.theory.analysis.fixpoints",
    "Hopf": "host.theory.analysis.hopf",
    **dict.fromkeys(("branch", "Branches", "Branch", "SpecialPoint"), "kickctl.theory.branching"),
    **dict.fromkeys(
        ("phase_diagram", "PhaseDiagram", "basins", "Basins", "kicks", "Kicks"),
        "kickctl.theory.maps",
    ),
}


def __getattr__(name: str) -> object:
    globals()[name] = value = load("kickctl.theory", name, __all__, _PLACES.get(name))
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
