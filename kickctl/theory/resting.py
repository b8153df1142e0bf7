"""Where a wheel can rest, and above which k it begins to swing there."""

from __future__ import annotations

from host.theory.analysis import fixpoints as resting
from host.theory.analysis import hopf as swinging
from host.theory.analysis.fixpoints import Fixpoint
from host.theory.analysis.hopf import Hopf
from host.theory.model.wheel import Wheel
from kickctl.theory._values import need_smooth, need_wheel


def fixpoints(wheel: Wheel) -> list[Fixpoint]:
    """All fixpoints, in the order of their angles; the paper's are eight.

    >>> [point.kind for point in fixpoints(Wheel(k=1.4))][:2]
    ['stable focus', 'saddle']

    Args:
        wheel: The wheel, without dry friction: that would hold it at other angles, too.

    Returns:
        The fixpoints.

    Raises:
        WrongUse: The rods do not pull: the wheel can rest at any angle. Or it has dry friction.
    """
    wheel = need_wheel(wheel)
    need_smooth(wheel, "the fixpoints")
    return resting.fixpoints(wheel)


def hopf(wheel: Wheel) -> Hopf:
    """The Hopf bifurcation of the even fixpoints in k.

    >>> hopf(Wheel(tau=0.25))
    Hopf(k=1.58727677..., omega=3.06535941..., l1=-0.04873232...)

    Args:
        wheel: The wheel; its own k does not matter. With functions of the user the bifurcation of
            least k is found. Dry friction would hold it at rest for every k.

    Returns:
        The bifurcation.

    Raises:
        WrongUse: There is none: without friction every resting wheel is unstable, and with a = 0
            the rods do not pull; a single rod pulls a wheel out of its rest only with a above 2.
            Or the wheel has dry friction.
    """
    wheel = need_wheel(wheel)
    need_smooth(wheel, "Hopf bifurcations")
    return swinging.hopf(wheel)
