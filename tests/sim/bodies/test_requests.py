"""Bodies that people ask for, and how impossible ones are refused."""

import pytest

from host.bodies.build import BodyRequest, build_body
from host.errors import WrongUse


def test_what_cannot_be_is_refused_in_words(tmp_path):
    broken = tmp_path / "broken.xml"
    broken.write_text("<mujoco><worldbody><geom type='plane' size='1 1'/></worldbody></mujoco>")
    torn = tmp_path / "torn.xml"
    torn.write_text("<mujoco><worldbody>")
    for request, reason in (
        (BodyRequest(scene="moon"), "no scene"),
        (BodyRequest(scene=str(broken)), "size"),
        (BodyRequest(scene=str(torn)), "XML"),
        (BodyRequest(scene=str(tmp_path / "none.xml")), "none.xml"),
        (BodyRequest(cars=0), "0 cars"),
        (BodyRequest(scene="flat", angle=0.2), "no slopes"),
        (BodyRequest(scene="slopes", angle=2.0), "slopes of"),
        (BodyRequest(bouncy=True), "'flat' has no walls; walls and octagon have"),
        (BodyRequest(torque=0.01, a=3.0), "no controller, so a does nothing"),
        (BodyRequest(torque=0.0, k=0.5), "no controller, so k does nothing"),
        (BodyRequest(torque=0.01, tau=0.05), "no controller, so tau does nothing"),
        (BodyRequest(k=float("nan")), "k cannot"),
        (BodyRequest(tau=0.0), "tau"),
        (BodyRequest(tau=0.0004), "tau cannot be 0.0004"),
        (BodyRequest(tau=0.001, timestep=0.002), "tau cannot be 0.001"),
        (BodyRequest(drag=-1.0), "drag"),
        (BodyRequest(preset="porsche"), "no preset"),
    ):
        with pytest.raises(WrongUse, match=reason):
            build_body(request)
