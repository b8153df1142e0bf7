"""What a substep of constant voltage and torque does to a motor, exactly.

Between events a motor is linear: dy/dt = A y + B u, with y = (speed, current, angle) and
u = (volts, torque). After a time t, y is exp(A t) y plus the integral of exp(A s) B u from 0 to t.
Both are the upper rows of one exponential, that of the matrix (A B; 0 0) t.

It is computed by additions, multiplications and divisions alone. These round alike everywhere, so
the numbers have the same bits in plain Python, compiled, and on every machine.
"""

COAST = 101  # in place of a duty cycle

# A motor: ohms of its circuit and of the battery, H, N m/A, V s/rad, viscous friction in N m s/rad,
# moment of inertia of the motor and of its wheel, kg m2. The battery's sag counts twice, as the
# other motor is taken to draw as much.
Circuit = tuple[float, float, float, float, float, float, float, float]
# The upper rows of such a matrix, without the column of the angle, on which nothing depends: speed,
# current and angle, each from speed, current, volts and torque.
Rows = tuple[float, ...]
# The same, and the new current of a locked motor from current and volts.
Step = tuple[float, ...]

# The series is summed at a 256th of the time, and the result squared eight times.
_PARTS, _SQUARINGS = 256, 8
# With rows that sum up to more than this at that time, the series loses its digits.
_LARGEST = 16.0
# From the sixth power on every entry that can differ from 0 does, and terms only shrink.
_LEAST_ORDER, _MOST_ORDER = 6, 200


def rates(wheel: int, duty: int, circuit: Circuit) -> Rows:
    """How fast speed, current and angle change, from speed, current, volts and torque.

    Args:
        wheel: 1 if the motor moves its wheel, 0 if it turns alone, within the play.
        duty: Its |duty|, %, or COAST. An open circuit leaves the current as it is.
        circuit: The motor.
    """
    ohms, source_ohms, inductance, torque_constant, emf_constant, viscous, own, of_wheel = circuit
    inertia = own + wheel * of_wheel
    drag, gain = -viscous / inertia, 1.0 / inertia
    if duty == COAST:
        return drag, 0.0, 0.0, gain, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0
    share = duty / 100
    push, back = torque_constant / inertia, -emf_constant / inductance
    loss = -(ohms + 2.0 * source_ohms * share * share) / inductance
    return drag, push, 0.0, gain, back, loss, 1.0 / inductance, 0.0, 1.0, 0.0, 0.0, 0.0


def is_slow(rows: Rows, time_s: float) -> bool:
    """Whether `step_of` can compute the solution: nothing changes by too much in the time."""
    rates_of = _scaled(rows, time_s / _PARTS)
    speed, current = sum(map(abs, rates_of[:4])), sum(map(abs, rates_of[4:8]))
    return speed <= _LARGEST and current <= _LARGEST  # False for NaN, too


def step_of(wheel: int, duty: int, circuit: Circuit, time_s: float) -> Step:
    """The solution after some time.

    Args:
        wheel: As in `rates`.
        duty: As in `rates`.
        circuit: As in `rates`; slow enough for the time.
        time_s: The time, s.

    Returns:
        New speed, new current and turned angle, each from speed, current, volts and torque; and the
        new current of a locked motor from current and volts.
    """
    small = _scaled(rates(wheel, duty, circuit), time_s / _PARTS)
    before, term = small, small
    a, b, c, d, e, f, g, h, i, j, k, m = small
    now: Rows = (1.0 + a, b, c, d, e, 1.0 + f, g, h, i, j, k, m)
    order = 1
    while order < _MOST_ORDER and (order <= _LEAST_ORDER or now != before):
        order += 1
        term = _scaled(_product(term, small), 1.0 / order)
        before, now = now, _sum(now, term)
    for _ in range(_SQUARINGS):
        now = _squared(now)
    return (*now, *_locked_step(small[5], small[6]))


def _locked_step(loss: float, gain: float) -> tuple[float, float]:
    """The new current of a locked motor from current and volts; zeros for an open circuit."""
    if loss == 0.0:
        return 0.0, 0.0
    now, before, term, order = 1.0 + loss, loss, loss, 1
    while order < _MOST_ORDER and now != before:
        order += 1
        term *= loss / order
        before, now = now, now + term
    for _ in range(_SQUARINGS):
        now *= now
    return now, gain / loss * (now - 1.0)


def _scaled(rows: Rows, factor: float) -> Rows:
    a, b, c, d, e, f, g, h, i, j, k, m = rows
    return (
        a * factor,
        b * factor,
        c * factor,
        d * factor,
        e * factor,
        f * factor,
        g * factor,
        h * factor,
        i * factor,
        j * factor,
        k * factor,
        m * factor,
    )


def _sum(left: Rows, right: Rows) -> Rows:
    a, b, c, d, e, f, g, h, i, j, k, m = left
    n, o, p, q, r, s, t, u, v, w, x, y = right
    return a + n, b + o, c + p, d + q, e + r, f + s, g + t, h + u, i + v, j + w, k + x, m + y


def _product(left: Rows, right: Rows) -> Rows:
    """The product of two matrices whose rows of the inputs are zero."""
    a, b, _, _, c, d, _, _, e, f, _, _ = left
    n, o, p, q, r, s, t, u, _, _, _, _ = right
    return (
        a * n + b * r,
        a * o + b * s,
        a * p + b * t,
        a * q + b * u,
        c * n + d * r,
        c * o + d * s,
        c * p + d * t,
        c * q + d * u,
        e * n + f * r,
        e * o + f * s,
        e * p + f * t,
        e * q + f * u,
    )


def _squared(rows: Rows) -> Rows:
    """The square of a solution: inputs, and the angle before, stay as they are."""
    _, _, c, d, _, _, g, h, i, j, k, m = rows
    n, o, p, q, r, s, t, u, v, w, x, y = _product(rows, rows)
    return n, o, p + c, q + d, r, s, t + g, u + h, v + i, w + j, x + 2.0 * k, y + 2.0 * m
