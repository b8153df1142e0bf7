"""The branches of a stable manifold are separated, even where they wind around each other."""

from math import pi

import numpy as np

from host.figures.theory.manifold_sides import sides


def test_arms_of_two_spirals_keep_their_branch():
    # A spiral from the saddle at 45 degrees inwards, of the branch with positive speed; its mirror
    # image comes from the saddle at -45 degrees, and has its arms between those of the first.
    turns = np.linspace(0.01, 4 * pi, 900)
    reach = (1.0 - turns / (5 * pi)) * pi / 4
    branch = np.column_stack([reach * np.cos(turns), 0.6 * reach * np.sin(turns)])
    forward = sides(np.concatenate([branch, -branch]), 1.0)
    assert forward[: len(branch)].all()
    assert not forward[len(branch) :].any()
