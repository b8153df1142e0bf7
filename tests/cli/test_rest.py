"""What the host says of wheels that rest although the robot runs."""

from host.commands._rest import explain_rest
from kickctl import connect

# With seed 2 the right wheel starts at 0 degrees, where no k gives it a torque; with seed 1 both
# wheels start where a large k turns them.
RESTS, TURNS = 2, 1


def lines_after(seed, **changes):
    """What is said of a robot that rested at k = 0, some time after a change of parameters."""
    with connect("sim://?k=0", seed=seed) as robot:
        robot.wait(3)
        robot.set(**changes)
        robot.wait(3)
        return explain_rest(robot, changes["k"])


def test_friction_holds_a_wheel_though_k_was_raised():
    first, *rest = lines_after(RESTS, k=8.0)
    assert first == "the right wheel rests, with a torque of |M| = 0.00"
    assert "up to |M| = 0.1, and a larger k alone does not free it" in rest[0]
    assert "kickctl drive forward" in rest[0]


def test_what_is_said_to_free_it_does_so():
    from host.kicking.primitives import drive
    from host.logs.log import Log

    with connect("sim://?k=0", seed=RESTS) as robot:
        robot.wait(3)
        robot.set(k=8.0)
        robot.wait(3)
        log = Log(robot.info())
        robot.add_tap(log)
        assert drive(robot, log, "forward")["reached"]
        assert explain_rest(robot, 8.0) == []


def test_a_small_k_is_named():
    *wheels, why = lines_after(RESTS, k=0.4)
    assert len(wheels) == 2
    assert "k = 0.4 is too small" in why
    assert "kickctl params set k=8" in why


def test_a_torque_that_should_turn_the_wheel_is_named():
    why = lines_after(TURNS, k=8.0, max_duty_pct=0.0)[-1]
    assert "Is it blocked" in why


def test_nothing_is_said_of_wheels_that_turn():
    assert lines_after(TURNS, k=8.0) == []
