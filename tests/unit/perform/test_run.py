"""What is checked before a run begins, and while it goes on."""

from importlib.resources import files

import pytest

from host.errors import NotDone
from host.perform.run import perform


def test_no_run_begins_after_a_source_has_changed(tmp_path, monkeypatch):
    """As in a long `reproduce`: what it loads next would be kept as results of the old code."""
    monkeypatch.setattr("host.util.provenance._places", list)  # the sources are gone
    with pytest.raises(NotDone, match="have changed since"):
        perform("hopf", out=tmp_path)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("options", [{}, {"k": [7.0, 8.0]}])
def test_a_run_ends_when_its_motor_changes(tmp_path, monkeypatch, options):
    """As by `calibrate` in another terminal: no trial has another motor than the run's settings."""
    motors = tmp_path / "motors.toml"
    published = (files("sim_motor") / "motors.toml").read_text()
    text = published.split("[pybricks]")[1].split("\n[")[0]
    changed = text.replace("torque_constant = [0.2746", "torque_constant = [0.3")
    assert changed != text
    monkeypatch.setenv("KICK_MOTORS", str(motors))

    def trial(*_):
        motors.write_text("[mine]" + changed)
        return []

    monkeypatch.setattr("host.perform.robots._trial", trial)
    for damaged in (False, True):
        motors.write_text("[mine]" + text)
        changed = "" if damaged else changed
        with pytest.raises(NotDone, match="'mine' has changed") as error:
            perform(
                "timeline", "sim://?motor=mine", trials=2, out=tmp_path / str(damaged), **options
            )
        assert error.value.__notes__[-1].startswith("1 of ")
