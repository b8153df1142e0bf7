"""A robot in the same process, with no socket between: it is the robot that sockets reach."""

import pytest

from host.client.robot import Robot
from host.errors import RefusedByRobot
from host.link.direct import DirectLink
from host.link.sim import SimLink
from sim_motor.brick import SimBrick


def drive(link):
    """The records of a robot that is kicked, stopped, and started again."""
    with Robot(link, link.token) as robot, robot.recording() as log:
        robot.wait(2.0)
        robot.kick("phase", ticks=4)
        robot.wait(1.0)
        robot.set(k=2)
        robot.stop()
        robot.wait(0.5)
        robot.start()
        robot.wait(0.5)
    return log


def test_it_is_the_robot_that_sockets_reach():
    direct = drive(DirectLink("sim://", SimBrick(1, jitter=False)))
    through_sockets = drive(SimLink("sim://", SimBrick(1, jitter=False)))
    # Sockets take their time: a robot behind them is met, and does what it is told, ticks later.
    kick = direct.kicks()[0][1]["begin"]
    met = through_sockets.records[0].tick
    assert direct.records[met:kick] == through_sockets.records[: kick - met]
    kept = [[event["event"] for event in log.events] for log in (direct, through_sockets)]
    assert kept[0] == kept[1] == ["snapshot", "kick", "params", "stop", "start"]


def test_without_the_token_one_may_only_look_and_stop():
    link = DirectLink("sim://", SimBrick(1, jitter=False))
    with Robot(link, None) as robot:
        with pytest.raises(RefusedByRobot, match="token"):
            robot.kick("phase", ticks=4)
        robot.wait(0.5)
        robot.stop()
        assert robot.status()["state"] == "stopped"


def test_its_dead_man_works_though_no_link_can_break():
    link = DirectLink("sim://", SimBrick(1, jitter=False))
    robot = Robot(link, link.token)
    robot.set(link_loss="stop")
    link.open()  # whoever drove is gone, and says nothing more
    for _ in range(60):
        link.run_tick()
    assert link.loop.safety.state != 1
