"""Which robot may do the cells of a run."""

from unittest.mock import MagicMock

import pytest

from host.errors import NotDone
from host.link.robots_file import Known
from host.perform import robots
from host.runs.contract import Setting

BRICK = Known("tcp://ev3dev.local:5425", "tcp://ev3dev.local:5425")


@pytest.mark.parametrize("changed", ["hardware_id", "motor"])
def test_a_run_that_one_robot_began_does_not_go_on_with_another(tmp_path, monkeypatch, changed):
    """As at ev3dev.local, the address of every new brick."""
    robot = MagicMock(hello={"hardware_id": "0" * 32, "motor": "lego-ev3-l-motor"})
    robot.__enter__.return_value = robot
    monkeypatch.setattr(robots, "connect", lambda *_, **__: robot)

    def go_on():
        run = (MagicMock(), BRICK, Setting(1, {}), None, tmp_path / "logs", print)
        with robots.robots(*run) as work:
            assert work is not None

    go_on()
    go_on()
    before, robot.hello[changed] = robot.hello[changed], "another"
    robot.reset_mock()
    with pytest.raises(NotDone, match="another robot began this run"):
        go_on()
    assert not robot.stop.called
    robot.hello[changed] = before
    go_on()
