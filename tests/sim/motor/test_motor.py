"""The simulated motor against what is published about the real one, and against what no motor may do."""

from dataclasses import replace
from math import degrees, pi, radians

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim_motor.constants import COAST, GRAVITY, SUBSTEP_S, data, load, names
from sim_motor.motor import (
    ANGLE,
    CURRENT,
    GAP,
    SAMPLE_SUBSTEPS,
    SPEED,
    WHEEL_SPEED,
    advance_in_place,
    encoder,
    substep_at,
    substep_from,
)

ROBOTS = {name: load(name) for name in names()}
ARRAYS = {
    constants: (constants.tables(), constants.scalars())
    for robot in ROBOTS.values()
    for constants in (robot, robot.bare())
}
NOMINAL_V = 7.5


@pytest.fixture(params=names())
def robot(request):
    return ROBOTS[request.param]


def at_rest(gap=0.0, angle=0.0):
    return np.array([angle, angle, 0.0, 0.0, gap, 0.0])


def push(constants, state, substeps, duty, battery_v=NOMINAL_V, torque=0.0):
    """Advance a state in place and return it."""
    advance_in_place(
        state,
        substeps,
        duty,
        battery_v,
        torque,
        *(ARRAYS.get(constants) or (constants.tables(), constants.scalars())),
    )
    return state


def history(constants, state, substeps, duty, battery_v=NOMINAL_V):
    """The state after each substep."""
    return np.array([push(constants, state, 1, duty, battery_v).copy() for _ in range(substeps)])


def stored(constants, state):
    """Energy (J) of a wheel; the inductor's is scaled by Kt/Ke, as the torque constant of a motor with iron losses is below Ke."""
    coil = constants.inductance * constants.torque_constant / constants.emf_constant
    inertias = constants.motor_inertia, constants.wheel_inertia, coil
    return 0.5 * sum(
        weight * state[index] ** 2
        for weight, index in zip(inertias, (SPEED, WHEEL_SPEED, CURRENT), strict=True)
    )


@st.composite
def moving(draw, constants):
    """A state in motion: within the play, or touching and moving as one."""
    half = constants.backlash / 2
    speed, current = draw(st.floats(-20, 20)), draw(st.floats(-2, 2))
    gap = draw(st.sampled_from([-half, half]) | st.floats(-half, half))
    wheel_speed = draw(st.just(speed) | st.floats(-20, 20))
    return np.array([0.3, 0.3, speed, current, gap, wheel_speed])


# What is published about the motor.


@pytest.mark.parametrize(("name", "published"), [("pybricks", 929), ("nxt_unroller", 941)])
def test_turns_at_the_published_no_load_speed(name, published):
    state = push(ROBOTS[name].bare(), at_rest(), 3000, 100, 8.0)
    assert degrees(state[SPEED]) == pytest.approx(published, rel=0.05)


def test_reaches_63_percent_of_its_speed_in_70_to_105_ms(robot):
    speeds = history(robot.bare(), at_rest(), 2000, 100, 8.0)[:, SPEED]
    assert 70 <= np.interp(0.63 * speeds[-1], speeds[:500], np.arange(1, 501)) <= 105


@pytest.mark.parametrize(("duty", "shortest_s", "longest_s"), [(0, 0.25, 0.35), (COAST, 1.8, 2.4)])
def test_brakes_in_a_third_of_a_second_and_coasts_for_two(robot, duty, shortest_s, longest_s):
    state = at_rest()
    state[SPEED] = state[WHEEL_SPEED] = radians(900)
    speeds = history(robot.bare(), state, 4000, duty)[:, SPEED]
    assert shortest_s < np.argmax(speeds == 0.0) * SUBSTEP_S < longest_s


@pytest.mark.parametrize(("name", "stall"), [("pybricks", 0.383), ("nxt_unroller", 0.349)])
def test_holds_against_its_published_stall_torque(name, stall):
    """At 8 V, give or take its static friction."""
    motor = ROBOTS[name].bare()
    friction = motor.static
    beaten, winning = (
        push(motor, at_rest(), 3000, 100, 8.0, torque)[SPEED]
        for torque in (-stall - 1.1 * friction, -stall + 1.1 * friction)
    )
    assert beaten < 0 < winning
    assert push(motor, at_rest(), 3000, 100, 8.0, -stall)[SPEED] == 0.0


def test_on_the_robot_runs_as_the_paper_says(robot):
    """R2 and R3."""
    speed = push(robot, at_rest(), 3000, 85)[WHEEL_SPEED]
    assert 1.8 < speed / (2 * pi) < 2.3
    assert 0.32 < speed * robot.wheel_radius < 0.39


def test_every_number_has_a_unit_and_a_source():
    for table in data().values():
        for value, unit, source in table.values():
            assert isinstance(value, (int, float))
            assert unit
            assert len(source) > 7


def test_an_unknown_motor_is_refused_with_the_known_ones():
    with pytest.raises(ValueError, match="pybricks, nxt_unroller"):
        load("nxt")


def test_the_body_decouples_into_the_wheels():
    """Half the mass at each wheel is a body whose radius of gyration is half its track."""
    mass, track, radius = (data()["robot"][key][0] for key in ("mass", "track", "wheel_radius"))
    left, right = 7.0, -2.0
    forward, turning = radius * (left + right) / 2, radius * (right - left) / track
    body = 0.5 * mass * forward**2 + 0.5 * mass * (track / 2) ** 2 * turning**2
    share = load().wheel_inertia - data()["robot"]["wheel_inertia"][0]
    assert 0.5 * share * (left**2 + right**2) == pytest.approx(body)


# The solution of its equations.


def test_a_substep_is_the_exact_solution(robot):
    """Against many small Runge-Kutta steps of the equations, through 20 ms of motion with the wheel pushed along."""
    duty, c = 60, robot
    inertia, friction = c.motor_inertia + c.wheel_inertia, c.kinetic + c.rolling
    ohms = c.resistance + 2 * c.source_resistance * (duty / 100) ** 2

    def rate(y):
        _, speed, current = y
        torque = c.torque_constant * current - c.viscous * speed - friction
        return np.array(
            [
                speed,
                torque / inertia,
                (NOMINAL_V * duty / 100 - c.emf_constant * speed - ohms * current) / c.inductance,
            ]
        )

    state = np.array([0.0, 0.0, 3.0, 0.4, c.backlash / 2, 3.0])
    y, h = np.array([0.0, 3.0, 0.4]), 1e-5
    for _ in range(2000):
        k1 = rate(y)
        k2 = rate(y + h / 2 * k1)
        k3 = rate(y + h / 2 * k2)
        y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(y + h * k3))
    push(robot, state, 20, duty)
    assert state[[ANGLE, SPEED, CURRENT]] == pytest.approx(y, abs=1e-9)


def test_without_friction_speed_goes_with_voltage(robot):
    ideal = replace(robot.bare(), kinetic=0.0, static=0.0)
    single, double = (push(ideal, at_rest(), 250, 40, volts)[SPEED] for volts in (4.0, 8.0))
    assert single > 1
    assert double == pytest.approx(2 * single, rel=1e-12)


def test_forward_and_backward_are_mirror_images(robot):
    duties = [40, -90, 0, 85, COAST, 12, -12, 5]
    there, back = at_rest(0.01, 0.2), at_rest(-0.01, -0.2)
    for duty in duties:
        push(robot, there, 77, duty)
        push(robot, back, 77, duty if duty == COAST else -duty)
    assert np.array_equal(there, -back)


def test_how_substeps_are_portioned_changes_no_bit(robot):
    duties = np.random.default_rng(5).integers(-100, COAST + 1, 60)
    whole, parts = at_rest(), at_rest()
    for duty in duties:
        push(robot, whole, 31, duty)
        for count in (1, 0, 7, 23):
            push(robot, parts, count, duty)
    assert np.array_equal(whole, parts)


# Friction.


@settings(max_examples=40)
@given(
    gap=st.sampled_from([-1.0, 1.0]) | st.floats(-1, 1),
    name=st.sampled_from(names()),
    sign=st.sampled_from([1, -1]),
    angle=st.floats(-10, 10),
)
def test_duty_8_leaves_the_robots_wheel_where_it_is_and_9_moves_it(gap, name, sign, angle):
    """R5: M of 0.1 is 8.5 %, wherever in its play the wheel stands."""
    robot = ROBOTS[name]
    state = at_rest(gap * robot.backlash / 2, angle)
    before = state.copy()
    push(robot, state, 5000, 8 * sign)
    before[CURRENT] = state[CURRENT]
    assert np.array_equal(state, before)
    push(robot, state, 500, 9 * sign)
    assert sign * state[WHEEL_SPEED] > 0


def test_what_moves_keeps_moving_where_what_rests_stays(robot):
    """Static friction exceeds kinetic.

    Duty 7 does not start a wheel, but does not stop it either.
    """
    moving, resting = push(robot, at_rest(), 400, 20), at_rest()
    push(robot, moving, 5000, 7)
    push(robot, resting, 5000, 7)
    assert moving[WHEEL_SPEED] > 0.1
    assert resting[WHEEL_SPEED] == resting[SPEED] == 0.0


@pytest.mark.parametrize("duty", [0, 1, 2, COAST])
def test_a_stopped_wheel_is_exactly_still(robot, duty):
    state = push(robot, push(robot, at_rest(), 1000, 85), 6000, duty)
    still = state.copy()
    push(robot, state, 1000, duty)
    assert state[SPEED] == state[WHEEL_SPEED] == 0.0
    assert np.array_equal(state, still)


@given(data=st.data(), name=st.sampled_from(names()), duty=st.sampled_from([0, COAST]))
def test_friction_and_impacts_create_no_energy(data, name, duty):
    """Without a supply, the stored energy never grows, in no substep."""
    robot = ROBOTS[name]
    state = data.draw(moving(robot))
    energy = stored(robot, state)
    for _ in range(150):
        left = stored(robot, push(robot, state, 1, duty))
        assert left <= energy * (1 + 1e-12)
        energy = left


@given(
    data=st.data(),
    name=st.sampled_from(names()),
    duties=st.lists(st.integers(-100, 100), min_size=1, max_size=6),
)
def test_energy_comes_from_the_battery_only(data, name, duties):
    """What a driven motor stores is at most what the supply put in.

    (Kt/Ke) V times the charge, from the circuit's own balance.
    """
    robot = ROBOTS[name]
    state = data.draw(moving(robot))
    energy, supplied = stored(robot, state), 0.0
    for duty in duties:
        volts, ohms = (
            NOMINAL_V * duty / 100,
            robot.resistance + 2 * robot.source_resistance * (duty / 100) ** 2,
        )
        for _ in range(30):
            before = state.copy()
            push(robot, state, 1, duty)
            turned = state[ANGLE] - before[ANGLE]
            charge = (
                volts * SUBSTEP_S
                - robot.inductance * (state[CURRENT] - before[CURRENT])
                - robot.emf_constant * turned
            ) / ohms
            supplied += robot.torque_constant / robot.emf_constant * volts * charge
    # A microjoule for events within a substep, at which the charge is not exactly known.
    assert stored(robot, state) <= energy + supplied + 1e-6


# Backlash.


def test_after_a_reversal_the_encoder_moves_three_degrees_before_the_wheel(robot):
    state = push(robot, push(robot, at_rest(), 1000, 60), 3000, 0)
    push(robot, state, 300, 10)  # rest at the forward end of the play
    push(robot, state, 3000, 0)
    state[GAP] = robot.backlash / 2
    begin, wheel = state[ANGLE], state[ANGLE] - state[GAP]
    while state[WHEEL_SPEED] == 0.0:
        free = degrees(begin - state[ANGLE])
        assert state[ANGLE] - state[GAP] == pytest.approx(wheel, abs=1e-12)
        push(robot, state, 1, -30)
    assert 2.5 < free <= 3.0


@given(
    data=st.data(),
    name=st.sampled_from(names()),
    duties=st.lists(st.integers(-100, COAST), min_size=1, max_size=8),
)
def test_the_wheel_stays_within_its_play(data, name, duties):
    robot = ROBOTS[name]
    state = data.draw(moving(robot))
    for duty in duties:
        for _ in range(20):
            push(robot, state, 1, duty)
            assert abs(state[GAP]) <= robot.backlash / 2


def test_an_impact_keeps_momentum_and_is_plastic(robot):
    smooth = replace(robot, kinetic=0.0, static=0.0, rolling=0.0, viscous=0.0)
    state = np.array([0.0, 0.0, 5.0, 0.0, 0.02, 1.0])
    inertias = smooth.motor_inertia, smooth.wheel_inertia
    momentum = inertias[0] * state[SPEED] + inertias[1] * state[WHEEL_SPEED]
    centre = inertias[0] * state[ANGLE] + inertias[1] * (state[ANGLE] - state[GAP])
    push(smooth, state, 20, COAST)
    assert state[SPEED] == pytest.approx(state[WHEEL_SPEED])
    assert inertias[0] * state[SPEED] + inertias[1] * state[WHEEL_SPEED] == pytest.approx(momentum)
    moved = inertias[0] * state[ANGLE] + inertias[1] * (state[ANGLE] - state[GAP])
    assert moved - centre == pytest.approx(momentum * 20 * SUBSTEP_S)


def test_braking_parts_the_wheel_from_the_motor_and_brings_it_to_the_other_end(robot):
    state = push(robot, at_rest(), 1000, 85)
    assert state[GAP] == robot.backlash / 2
    gaps = history(robot, state, 100, 0)[:, GAP]
    assert np.any(np.abs(gaps) < robot.backlash / 2)
    assert gaps[-1] == -robot.backlash / 2


def test_a_load_holds_drives_and_stops_the_wheel(robot):
    """In coast a load must overcome the gearing's static friction.

    A torque above the motor's stops a running wheel and turns it back.
    """
    hold = robot.static + robot.rolling
    end = -robot.backlash / 2  # the wheel pushes the motor forward
    assert push(robot, at_rest(end), 1000, COAST, torque=0.95 * hold)[SPEED] == 0.0
    assert push(robot, at_rest(end), 1000, COAST, torque=1.05 * hold)[SPEED] > 0.0
    assert push(robot, push(robot, at_rest(), 1000, 50), 1000, 50, torque=-1.0)[WHEEL_SPEED] < 0


# Encoder and grid.


@pytest.mark.parametrize(
    ("angle_deg", "position"),
    [
        (0.0, 0),
        (0.49, 0),
        (0.99, 0),
        (1.01, 1),
        (-0.01, 0),
        (-0.49, 0),
        (-0.51, -1),
        (-1.01, -1),
        (-1.51, -2),
        (359.9, 359),
        (-720.2, -720),
    ],
)
def test_the_encoder_truncates_half_degrees_as_the_kernel_does(angle_deg, position):
    """720 counts, halved towards zero: the bin around zero is 1.5 degrees wide, all others one."""
    assert encoder(0, radians(angle_deg), 0.0, 720.0) == position


def test_the_encoder_is_sampled_every_other_millisecond():
    assert SAMPLE_SUBSTEPS * SUBSTEP_S == 0.002
    assert encoder(8, radians(50.1), radians(40.1), 720.0) == 50
    assert encoder(9, radians(50.1), radians(40.1), 720.0) == 40


@given(st.integers(0, 10**9))
def test_a_time_on_the_grid_is_its_own_substep(substep):
    for time_s in (
        substep / 1000,
        np.nextafter(substep / 1000, -1),
        np.nextafter(substep / 1000, 1e9),
    ):
        assert substep_at(time_s) == substep_from(time_s) == substep
    assert (
        substep_from((substep + 0.5) / 1000)
        == substep_at((substep + 0.5) / 1000) + 1
        == substep + 1
    )


def test_rolling_friction_is_the_wheels_share_of_the_weight(robot):
    table = data()["robot"]
    weight = table["mass"][0] / 2 * GRAVITY
    assert robot.rolling == pytest.approx(
        table["rolling_resistance"][0] * weight * table["wheel_radius"][0]
    )
