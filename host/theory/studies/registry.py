"""Which studies of the analytic model there are, and what each can be asked for.

Light enough for `kickctl --help`.
"""

from __future__ import annotations

from host.runs.registry import Entry, Option

# The constants of a wheel, by the paper's letters.
A = Option("a", 4.0, 0.0, 100.0, "gain of the neurons, without unit")
TAU = Option("tau", 0.25, 1e-6, 1e3, "time constant of the membrane potentials, s")
K = Option("k", 1.85, 0.0, 1e4, "spring constant of the rods, without unit")
F = Option("f", 0.5, 0.0, 1e3, "friction of the wheel, s (its torque has no unit)")
I = Option("I", 0.05, 1e-9, 1e3, "moment of inertia of the wheel, s^2 (its torque has no unit)")  # noqa: E741
LETTERS = ("k", "tau", "a", "f", "I")
# Other wheels than the paper's.
RODS = Option("rods", 2, 1, 2, "number of rods that pull at the wheel, 2 or 1")
BOUNDED = Option(
    "bounded",
    None,
    1e-3,
    1e6,
    (
        "greatest torque M_max of the motor, without unit: M = M_max tanh(F_tan / M_max), with 1 as"
        " on the robot (default: no bound, M = F_tan)"
    ),
)
VARIANTS = (RODS, BOUNDED)
# The paper's constants, for which its claims are made.
PAPER = {option.name: option.default for option in (A, TAU, F, I, *VARIANTS)}
# The Poincare section (host.theory.analysis.sections).
ON = Option(
    "on",
    "phi",
    0.0,
    0.0,
    "the section; phi: sin(2 phi) = 0, the wheel passes a multiple of a quarter turn; omega: omega"
    " = 0, it turns round",
    ("phi", "omega"),
)
_MOST = " (default: 20 for k, 1.5 for tau, 4 times the wheel's value for others)"

TABLE = {
    "fixpoints": Entry(
        "the eight fixpoints: eigenvalues, stability, and the 16 resting states of two wheels",
        (A, TAU, K._replace(default=1.4), F, I, *VARIANTS),
        ("M1", "M2"),
    ),
    "hopf": Entry(
        "the exact Hopf line in (k, tau), whether limit cycles are born stable there, and the"
        " paper's estimate beside it",
        (A, TAU, F, I, *VARIANTS),
        ("M3",),
    ),
    "branch": Entry(
        "fixpoints, limit cycles and rotations followed in a parameter, stable and unstable, with"
        " their bifurcations",
        (
            A,
            TAU,
            K._replace(
                default=None,
                doc=(
                    "spring constant of the rods, without unit, if another constant is followed"
                    " (default 1.85)"
                ),
            ),
            F,
            I,
            Option("along", "k", 0.0, 0.0, "the constant that is followed", LETTERS),
            Option(
                "to",
                None,
                1e-6,
                1e4,
                (
                    "where to end, in the unit of the constant (default: 20 for k, twelve times its"
                    " value for others)"
                ),
            ),
            Option(
                "dry",
                0.1,
                0.0,
                10.0,
                "dry friction of the motor, for a branch of its own, in units of the rods' force",
            ),
            *VARIANTS,
        ),
        ("M5", "M6", "M9"),
    ),
    "portrait": Entry(
        "portraits in (phi, omega/2pi): fixpoints, manifolds of the saddles, limit cycles,"
        " trajectories. Stable manifolds are shown, and trajectories start, in the slice of states"
        " whose potentials are those of a wheel that has always turned at its present speed",
        (
            A,
            TAU,
            K._replace(
                default=None,
                doc=(
                    "spring constant of the rods, without unit (default: the paper's 1.4, 1.65 and"
                    " 1.85)"
                ),
            ),
            F,
            I,
            *VARIANTS,
        ),
        ("M4",),
    ),
    "phase-diagram": Entry(
        "std and mean of omega over (k, tau), with the phases and the lines between them; k swept"
        " up and down",
        (
            A,
            F,
            I,
            Option("points", 200, 2, 4000, "number of points on each axis"),
            Option("k_to", 20.0, 1e-3, 1e4, "greatest k, without unit; the least is 0"),
            Option("tau_to", 1.5, 1e-3, 1e3, "greatest tau, s; the least is 0"),
            Option(
                "start",
                "sweep",
                0.0,
                0.0,
                "states to begin with; sweep: those at the neighbouring k, up and down",
                ("sweep", "rest", "roll"),
            ),
            Option("transient", 100.0, 0.0, 1e5, "how long to wait before measuring, s"),
            Option("seconds", 100.0, 1.0, 1e5, "how long to measure, s"),
            *VARIANTS,
        ),
        ("M7",),
    ),
    "lines": Entry(
        "two-parameter diagram: Hopf and merging lines, folds, pitchforks and Neimark-Sacker lines"
        " in the plane of two constants, with their special points; period doublings and the other"
        " lines of attracting cycles in windows; and the crisis of chaos, with its uncertainty."
        " Takes two to three minutes. The axes begin at a hundredth of their greatest values",
        (
            A,
            TAU,
            K,
            F,
            I,
            Option("x", "k", 0.0, 0.0, "the constant on the axis x", LETTERS),
            Option("y", "tau", 0.0, 0.0, "the constant on the axis y", LETTERS),
            Option("x_to", None, 1e-6, 1e4, "greatest x, in the unit of its constant" + _MOST),
            Option("y_to", None, 1e-6, 1e4, "greatest y, in the unit of its constant" + _MOST),
            *VARIANTS,
        ),
    ),
    "lyapunov": Entry(
        "the four Lyapunov exponents at a point, with errors, and what they say: at rest, regular,"
        " chaotic or hyperchaotic",
        (
            A,
            TAU._replace(default=1.0),
            K._replace(default=15.0),
            F,
            I,
            Option(
                "seconds",
                250.0,
                50.0,
                1e6,
                "how long to follow each of 64 wheels, s; beyond 250 s, more wheels",
            ),
            *VARIANTS,
        ),
        ("M8",),
    ),
    "lyapunov-line": Entry(
        "the route to chaos along k: attractors with their largest exponents, where rolling ends,"
        " chaotic transients and the crisis",
        (
            A,
            TAU._replace(default=1.0),
            F,
            I,
            Option("k_to", 20.0, 1e-3, 1e4, "greatest k, without unit; the least is 0"),
            *VARIANTS,
        ),
    ),
    "lyapunov-plane": Entry(
        "attractors and the largest exponent over (k, tau), from random states and from rolling",
        (
            A,
            F,
            I,
            Option("k_to", 20.0, 1e-3, 1e4, "greatest k, without unit; the least is 0"),
            Option("tau_to", 1.5, 1e-3, 1e3, "greatest tau, s; the least is 0"),
            *VARIANTS,
        ),
    ),
    "section": Entry(
        "Poincare section and first-return map of a wheel, up to the symmetries, and its power"
        " spectrum beside its cycle's frequency. Takes about 15 s",
        (
            A,
            TAU._replace(default=1.0),
            K._replace(default=15.0),
            F,
            I,
            ON,
            Option(
                "seconds",
                300.0,
                10.0,
                1e4,
                "how long to follow each of eight wheels after it has settled, s",
            ),
            *VARIANTS,
        ),
    ),
    "orbit": Entry(
        "orbit diagram over a constant, up and down: points on a Poincare section, windows by"
        " their period, and where attractors coexist. Takes about a minute",
        (
            A,
            TAU._replace(default=1.0),
            K._replace(default=15.0),
            F,
            I,
            ON,
            Option("over", "k", 0.0, 0.0, "the constant that is varied", LETTERS),
            Option(
                "from",
                None,
                1e-9,
                1e4,
                "least value, in the unit of the constant (default: a twentieth of the greatest)",
            ),
            Option(
                "to",
                None,
                1e-9,
                1e4,
                (
                    "greatest value, in the unit of the constant (default: 20 for k, four times its"
                    " value for others)"
                ),
            ),
            Option("values", 240, 2, 4000, "number of values of the constant"),
            *VARIANTS,
        ),
    ),
    "basins": Entry(
        "basins of attraction in (phi, omega), and of kicks: which kick at which phase of the cycle"
        " leads where. Starts are in the slice x1 = cos phi, x2 = sin phi, the potentials of rest;"
        " wheels that are kicked roll on their cycle",
        (
            A,
            TAU,
            K._replace(default=8.0),
            F,
            I,
            Option("points", 240, 16, 4000, "number of points on each axis"),
            *VARIANTS,
        ),
    ),
    "edge": Entry(
        "the least push of the potentials or the speed that reverses a rolling wheel, over phase"
        " and direction, and the edge state between rolling forward and backward. Where small k"
        " folds the edge many times, reaches of the other basin that are thinner than the steps of"
        " the search, a sixtieth of the push, may be missed",
        (A, TAU, K._replace(default=8.0), F, I, *VARIANTS),
    ),
    "escape": Entry(
        "how long noise takes to drive a wheel from its attractor: mean times with standard errors"
        " (95 % intervals in the figure and in summary.json) for six strengths of noise, and"
        " Arrhenius's law. Takes about half a minute",
        (
            A,
            TAU,
            K._replace(default=1.4),
            F,
            I,
            Option(
                "noise",
                0.1,
                0.0,
                1e3,
                "greatest white noise of the torque, D_M, in sqrt(s), as torques have no unit",
            ),
            Option(
                "angle_noise",
                0.0,
                0.0,
                1e3,
                "greatest white noise of the angle, D_phi, rad/sqrt(s)",
            ),
            Option(
                "start",
                "rest",
                0.0,
                0.0,
                "the attractor; rest: that of a wheel that is pushed a little; roll: rolling",
                ("rest", "roll"),
            ),
            Option("wheels", 256, 8, 100_000, "number of wheels for each strength"),
            Option("seconds", 1000.0, 1.0, 1e6, "how long to follow a wheel at most, s"),
            *VARIANTS,
        ),
    ),
    "tick": Entry(
        "what the length of a tick and the motor's latency do to the lines: the sampled wheel as"
        " a map",
        (
            A,
            TAU,
            F,
            I,
            Option("tick", 0.03, 1e-5, 1.0, "length of a tick, s"),
            Option(
                "latency",
                0.0,
                0.0,
                1.0,
                "how long after the start of its tick a torque acts, s; at most a tick",
            ),
            *VARIANTS,
        ),
    ),
}
