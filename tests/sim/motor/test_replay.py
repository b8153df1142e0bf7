"""Motors that obey logged duty cycles go where the logged ones went."""

import numpy as np

from robot.loop import Loop
from robot.record import unpack
from sim_motor.brick import SimBrick
from sim_motor.motor import ANGLE, encoder
from sim_motor.replay import replay

REST, RUN = 5, 60


def test_the_same_motor_from_the_same_state_reads_the_same_angles():
    brick = SimBrick(3)
    states = np.array([wheel.state for wheel in brick.motors])
    loop = Loop(brick.motors, brick.battery, brick.clock, 3)
    for tick in range(REST + RUN):
        if tick == REST:
            loop.start()
        brick.clock.wait(loop.deadline, lambda timeout_s: None)
        loop.tick()
    records = unpack(loop.blackbox.read(0, REST + RUN))
    duties = np.array([[r.left_duty_pct for r in records], [r.right_duty_pct for r in records]])
    motors = tuple(wheel.constants for wheel in brick.motors)
    times = np.array([record.t_s for record in records])
    ends, angles = replay(states, times, duties, times[-1], motors, np.full(2, 7.5))
    logged = np.degrees([[r.left_phi_rad for r in records], [r.right_phi_rad for r in records]])
    assert np.ptp(logged, axis=1).min() > 90
    assert np.array_equal(ends[:, ANGLE], angles[:, -1])
    for wheel, constants in enumerate(motors):
        # Without the angle one substep before, the sample may be one substep newer.
        read = [encoder(0, angle, angle, constants.encoder_counts) for angle in angles[wheel]]
        assert np.abs(read - logged[wheel]).max() <= 1.01
        assert read[:REST] == logged[wheel, :REST].round().tolist()
