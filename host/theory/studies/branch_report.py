"""What the branches come to: the merging by two methods, hysteresis, the constant-velocity formula, and the claims M5, M6 and M9."""

from __future__ import annotations

from typing import Any

import numpy as np

from host.runs.claims import Claim
from host.runs.contract import Findings, Row, Setting
from host.theory.analysis.hopf import estimate, hopf
from host.theory.model.turning import constant_velocity
from host.theory.model.wheel import Wheel, wheel_of
from host.theory.studies.registry import PAPER

# How many reduced maps make a period; mergings are extrapolated from so many cycles before the end
# of a branch.
_POWER, _LAST = {"FB": 2, "LLM": 4, "dry": 4}, 25
NEAR = 0.05
# Where the paper's portraits find a wheel forth and back, and rolling.
_SWINGS_K, _ROLLS_K = 1.65, 1.85
# Far above the onset of locomotion, where the constant-velocity formula is claimed.
FAR_K = 20.0


def of(rows: list[Row], part: str, kind: str, type_: str | None = None) -> list[Row]:
    """The rows of a part and a kind, and a type."""
    return [
        row
        for row in rows
        if row["part"] == part and row["kind"] == kind and type_ in (None, row.get("type"))
    ]


def extrapolated(rows: list[Row], part: str, merging: Row) -> float | None:
    """Where a branch would reach an infinite period: a second value of a merging.

    None if the branch does not go there.

    With T the time that a cycle takes by one saddle, the followed constant approaches its limit as
    exp(-lambda_u T) and exp(lambda_s T).
    """
    cycles = []
    for way in ("down", "up", None):
        branch = [row for row in of(rows, part, "cycle") if row.get("way") == way]
        if (
            branch
            and abs(branch[-1]["value"] / merging["value"] - 1) < 1e-2
            and branch[-1]["period"] == max(row["period"] for row in branch)
        ):
            cycles = branch[-_LAST:]
    if len(cycles) < _LAST:
        return None
    times = np.array([row["period"] for row in cycles]) / _POWER[part]
    values = np.array([row["value"] for row in cycles])
    (rising, _), (falling, _) = merging["eigenvalues"][:2]
    decays = [np.exp(-rate * (times - times[0])) for rate in (rising, -falling, 2 * rising)]
    solution = np.linalg.lstsq(
        np.column_stack([np.ones_like(times), *decays]), values - merging["value"], rcond=None
    )[0]
    return float(merging["value"] + solution[0])


def _special_points(rows: list[Row], along: str, wheel: Wheel) -> list[dict[str, Any]]:
    branches = {
        "fixpoints": "rest",
        "FB": "forth and back",
        "LLM": "rotation",
        "merging": "saddles",
        "dry": "rotation with dry friction",
    }
    kept = (
        "omega_mean",
        "multipliers",
        "reduced_multipliers",
        "period",
        "amplitude",
        "saddle_quantity",
        "eigenvalues",
        "l1",
    )
    return [
        {
            "type": row["type"],
            "k": row["value"] if along == "k" else wheel.k,
            along: row["value"],
            "branch": branches[row["part"]],
            **{name: row[name] for name in kept if row.get(name) is not None},
        }
        for row in rows
        if row["kind"] == "special"
    ]


def _deviations(rows: list[Row]) -> list[tuple[float, float]]:
    """(value, relative deviation of the formula) along the stable rotations, in the order of values."""
    stable = sorted(
        (row for row in of(rows, "LLM", "cycle") if row["stable"]),
        key=lambda row: float(row["value"]),
    )
    return [
        (row["value"], row["formula"] / row["omega_mean"] - 1)
        for row in stable
        if row["formula"] is not None
    ]


def _near(deviations: list[tuple[float, float]]) -> list[list[float]]:
    """The ranges in which the formula is within NEAR, their ends interpolated."""
    ranges: list[list[float]] = []
    inside = False
    for index, (value, off) in enumerate(deviations):
        if (abs(off) < NEAR) == inside:
            continue
        edge = value
        if index:
            before, was = deviations[index - 1]
            edge = before + (value - before) * (NEAR - abs(was)) / (abs(off) - abs(was))
        inside = not inside
        if inside:
            ranges.append([edge])
        else:
            ranges[-1].append(edge)
    if inside:
        ranges[-1].append(deviations[-1][0])
    return ranges


def _coexistence(
    rows: list[Row], mergings: list[Row], k_hopf: float | None
) -> dict[str, Any] | None:
    """Where stable rotations coexist with stable swinging or resting wheels, for the first merging in k."""
    folds = {
        part: [row["value"] for row in of(rows, part, "special", "fold")] for part in ("FB", "LLM")
    }
    if not mergings or k_hopf is None or not of(rows, "LLM", "cycle"):
        return None
    least = min([*folds["LLM"], mergings[0]["value"]])
    most = max([k_hopf, *folds["FB"], mergings[0]["value"]])
    return {"from": least, "to": most} if most > least else None


def _turning(rows: list[Row]) -> list[dict[str, Any]]:
    turning = of(rows, "turning", "turning")
    found = []
    for k in dict.fromkeys(row["k"] for row in turning):
        points = [row for row in turning if row["k"] == k]
        names = ("x1", "x2")
        numeric = max(abs(row[name] - row[name + "_numeric"]) for row in points for name in names)
        amplitude = max(abs(row[name]) for row in points for name in names)
        rolls = points[0]["x1_rolling"] is not None
        own = (
            max(abs(row[name] - row[name + "_rolling"]) for row in points for name in names)
            / amplitude
            if rolls
            else None
        )
        found.append(
            {
                "k": k,
                "omega": points[0]["omega_mean"],
                "numeric_off_by": numeric,
                "rolling_wheel_off_by": own,
            }
        )
    return found


def findings(rows: list[Row], setting: Setting) -> Findings:
    """All of it. Special points in the order of the branches."""
    wheel, along = wheel_of(setting.options), setting.options["along"]
    mergings, hopfs = of(rows, "merging", "special"), of(rows, "fixpoints", "special")
    merge = mergings[0] if mergings else None
    second = {part: extrapolated(rows, part, merge) for part in ("FB", "LLM")} if merge else {}
    dry = _dry(rows)
    deviations = _deviations(rows)
    turning = _turning(rows)
    neutral = [row["tau"] for row in of(rows, "line", "neutral")]
    ends = [
        {
            "branch": row["part"],
            "way": row.get("way"),
            "end": row.get("why", row["type"]),
            along: row.get("value"),
        }
        for row in rows
        if row["kind"] == "end"
    ]
    checks = [row for row in rows if row["kind"] == "check"]
    located = [
        row["off_by"]
        for row in rows
        if row["kind"] == "special"
        and row["part"] in ("FB", "LLM", "dry")
        and row.get("off_by") is not None
    ]
    numbers = {
        "k_merge": merge["value"] if merge and along == "k" else None,
        "special_points": _special_points(rows, along, wheel),
        "along": along,
        "mergings": [row["value"] for row in mergings],
        "merging_by_extrapolation": second,
        "saddle_quantity": merge["saddle_quantity"] if merge else None,
        "saddle_quantity_vanishes_at_tau": neutral,
        "coexistence_with_rotations": (
            _coexistence(rows, mergings, hopfs[0]["value"] if hopfs else None)
            if along == "k"
            else None
        ),
        "period_doublings": (
            "none: multipliers of these symmetric cycles are squares; -1 of the reduced map would"
            " be a pitchfork"
        ),
        "formula_within_5_percent": _near(deviations),
        "formula_off_by": [
            {along: value, "relative": off}
            for value, off in deviations[:: max(1, len(deviations) // 12)]
        ],
        "dry": dry,
        "turning": turning,
        "ends": ends,
        "accuracy": {
            "hopf_closed_form_against_eigenvalues": max(
                (row["off_by"] for row in hopfs), default=None
            ),
            "merging_with_other_begin_and_shorter_steps": max(
                (row["off_by"] for row in mergings if row["off_by"] is not None), default=None
            ),
            "merging_against_extrapolated_branches": {
                part: abs(value / merge["value"] - 1)
                for part, value in second.items()
                if merge and value
            },
            "bifurcations_of_cycles_with_shorter_steps": max(located, default=None),
            "cycles_against_time_stepping_rad_per_s": max(
                (row["off_by"] for row in checks), default=None
            ),
            "product_of_multipliers": max(
                (row["off_by"] for row in rows if row["kind"] == "cycle"), default=None
            ),
        },
    }
    claims = (
        [_m5(rows, merge, hopfs[0], second, numbers)] if along == "k" and merge and hopfs else []
    )
    if along == "k" and deviations:
        far = setting.short_of(to=FAR_K)
        claims.append(_m6(deviations, turning, numbers, along, wheel).doubted(far))
    foreign = setting.elsewhere(**PAPER)
    return Findings([claim.doubted(foreign) for claim in (*claims, _m9(turning))], numbers)


def _dry(rows: list[Row]) -> dict[str, Any] | None:
    cycles = of(rows, "dry", "cycle")
    if not cycles:
        return None
    folds = of(rows, "dry", "special", "fold")
    met = of(rows, "dry", "special", "merging")
    return {
        "folds": [{"value": row["value"], "omega_mean": row["omega_mean"]} for row in folds],
        "merging": met[0]["value"] if met else None,
        "merging_by_extrapolation": extrapolated(rows, "dry", met[0]) if met else None,
        "least_omega_while_rolling": min(row["omega_min"] for row in cycles),
    }


def _m5(
    rows: list[Row],
    merge: Row,
    first: Row,
    second: dict[str, float | None],
    numbers: dict[str, Any],
) -> Claim:
    k_merge, k_hopf = merge["value"], first["value"]
    joined = all(value is not None and abs(value / k_merge - 1) < 1e-6 for value in second.values())
    amplitude = max((row["amplitude"] or 0.0 for row in of(rows, "FB", "cycle")), default=0.0)
    both = numbers["coexistence_with_rotations"]
    swings = k_hopf < _SWINGS_K < k_merge < _ROLLS_K
    paper = f"; k = {_SWINGS_K} swings, k = {_ROLLS_K} rolls, as in its portraits" if swings else ""
    hysteresis = (
        f"hysteresis from k = {both['from']:.9g} to {both['to']:.9g}" if both else "no hysteresis"
    )
    return Claim(
        "M5",
        "a supercritical Hopf bifurcation, whose four cycles merge with the saddles into a"
        " rotation",
        "amplitude of the cycle against k up to the merging; merging value located",
        k_merge,
        "k",
        None,
        first["l1"] < 0.0 and joined,
        f"cycles are born {'stable' if first['l1'] < 0 else 'unstable'} at k = {k_hopf:.9g} and"
        f" grow to {amplitude:.4f} rad (pi/4: 0.7854); they and the rotations reach k_merge ="
        f" {k_merge:.12g} from both sides; the connection is heteroclinic, a ring of four saddles"
        f" of saddle quantity {merge['saddle_quantity']:.3g}/s, {hysteresis}{paper}",
    )


def _m6(
    deviations: list[tuple[float, float]],
    turning: list[dict[str, Any]],
    numbers: dict[str, Any],
    along: str,
    wheel: Wheel,
) -> Claim:
    near = numbers["formula_within_5_percent"]
    value, last = deviations[-1]
    where = " and ".join(f"{begin:.4g} to {end:.4g}" for begin, end in near) or "nowhere"
    shown = ", ".join(
        f"{(constant_velocity(wheel._replace(k=entry['k'])) or 0.0) / entry['omega'] - 1:+.1%} at k"
        f" = {entry['k']:g}"
        for entry in turning
        if entry["rolling_wheel_off_by"] is not None
    )
    return Claim(
        "M6",
        "omega of locomotion follows the constant-velocity formula far above the onset",
        "omega = +- sqrt((a k tau - 2 f) / (2 f tau^2)), beside the numeric branch",
        last,
        "relative",
        None,
        any(end == value for _, end in near),
        f"at {along} = {value:g}, the end of the branch; within 5 % for {along} = {where}; {shown};"
        f" it begins at k = {hopf(wheel).k:.4g} x {estimate(wheel) / hopf(wheel).k:.2f}, as a"
        " rotation does not",
    )


def _m9(turning: list[dict[str, Any]]) -> Claim:
    worst = max(entry["numeric_off_by"] for entry in turning)
    own = ", ".join(
        f"{entry['rolling_wheel_off_by']:.1%} of the amplitude at k = {entry['k']:g}"
        for entry in turning
        if entry["rolling_wheel_off_by"] is not None
    )
    return Claim(
        "M9",
        "the membrane potentials of a constantly turning wheel are those of eq. x-t",
        "numeric against formula",
        worst,
        "1",
        None,
        worst < 1e-8,
        (
            f"greatest difference; a wheel that rolls by itself, at varying speed, is off by {own}"
            if own
            else "greatest difference"
        ),
    )
