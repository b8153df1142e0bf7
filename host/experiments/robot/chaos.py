"""The chaotic mode, k = 15 and tau = 1 s: whether wheels switch irregularly, and how long (R14).

A robot records the series. The other parts explain it, and only the simulated brick does them:

- series: angle, force and torque of a wheel, tick by tick.
- lives: how long many wheels switch until they roll steadily or rest, under one condition.
- twins: pairs of runs that differ by a small jump of one potential, and how far apart their
  potentials are afterwards.
- map: wheels on bodies, with one lag of the rods and one voltage of the battery. They are chaotic
  if they switch to the end and twins end up apart.
- speed: turns per second at k = 8, tau = 0.25 s. It shows whether R2 still holds under a condition.
- model: the paper's four equations of a wheel, driven by the unbounded force as in the paper, or by
  the bounded torque of the robot.
"""

from __future__ import annotations

from host.client.robot import Robot
from host.experiments import registry
from host.experiments.robot import chaos_pieces as pieces
from host.experiments.robot.chaos_numbers import (
    Numbers,
    Rate,
    explain,
    growth,
    in_words,
    plain,
    reasons,
    series_numbers,
    tally,
)
from host.experiments.robot.chaos_pieces import SEEN, UNSEEN
from host.experiments.robot.chaos_rows import (
    CellRows,
    ChaosCell,
    ChaosRow,
    Sample,
    lives_rows,
    series_of_wheels,
    twins_rows,
)
from host.experiments.robot.switching import CONDITIONS, OLDER, ORDINARY
from host.kicking.outcome import require_running
from host.logs.log import Log
from host.runs.answers import Answer, share
from host.runs.claim_sentences import SENTENCES
from host.runs.claims import Claim
from host.runs.contract import Findings, Options, Setting
from host.theory.analysis.series_exponents import of_noise
from host.util.intervals import standard_error, wilson
from robot.kicks import WHEELS
from robot.safety import RUNNING

# R14 holds if this share of the wheels switches to the end of a series at least this long.
SUSTAINED = 0.95
CLAIMED_MIN = 10.0
# The map: how much older the rods are, and voltages of the battery.
LAGS_S = (0.0, 0.0025, 0.004, 0.005, 0.006, 0.0075, 0.01, 0.015)
VOLTAGES_V = (6.5, 7.0, 7.5, 8.0, 9.0)


def cells(options: Options, *, batch: bool) -> list[ChaosCell]:
    """The series; for simulated bricks also the parts that explain it, or the preset's."""
    claimed = pieces.claimed_in(options)
    if not batch:
        return [{"part": "series", "condition": claimed}]
    if claimed != ORDINARY:
        return [
            {"part": "series", "condition": claimed},
            {"part": "lives", "condition": claimed},
            {"part": "twins", "condition": claimed, "jump": SEEN},
        ]
    work: list[ChaosCell] = []
    work += [{"part": "series", "condition": name} for name in pieces.SHOWN]
    work += [{"part": "lives", "condition": name} for name in CONDITIONS]
    work += [{"part": "speed", "condition": name} for name in CONDITIONS]
    work += [
        {"part": "twins", "condition": name, "jump": jump}
        for name in pieces.SHOWN
        for jump in (SEEN, UNSEEN)
    ]
    work += [
        {"part": "map", "rod_lag_s": lag_s, "battery_v": battery_v}
        for lag_s in LAGS_S
        for battery_v in VOLTAGES_V
    ]
    work += [{"part": "model", "wheel": "paper", "bounded": bounded} for bounded in (False, True)]
    work += [{"part": "model", "wheel": "robot", "bounded": bounded} for bounded in (False, True)]
    return work


def world(cell: ChaosCell) -> dict[str, str]:
    """The robot alone on the floor, with room to move about."""
    return {}


def simulate(cell: ChaosCell, setting: Setting) -> CellRows:
    """Do one cell."""
    if cell["part"] == "series":
        return pieces.series(cell, setting)
    if cell["part"] == "lives":
        return pieces.lives(cell, setting)
    if cell["part"] == "speed":
        return pieces.speed(cell, setting)
    if cell["part"] == "twins":
        return pieces.twins(cell, setting)
    if cell["part"] == "map":
        return pieces.map_wheels(cell, setting)
    return pieces.model_runs(cell, setting)


def trial(cell: ChaosCell, robot: Robot, log: Log, setting: Setting) -> list[Sample]:
    """Record both wheels of a robot from its start on."""
    robot.stop()
    robot.set(**pieces.chaotic(setting.options))
    first = robot.start()

    def stopped() -> bool:
        newest = robot.newest
        return newest is not None and newest.tick > first and newest.state != RUNNING

    robot.wait(60 * setting.options["minutes"], until=stopped)
    require_running(robot)
    records = [record for record in log.records if record.tick >= first and record.state == RUNNING]
    return [
        {
            "side": side,
            "t_s": record.t_s - records[0].t_s,
            "phi_rad": getattr(record, side + "_phi_rad"),
            "force": getattr(record, side + "_force"),
            "torque": getattr(record, side + "_torque"),
        }
        for side in WHEELS
        for record in records
    ]


def report(rows: list[ChaosRow], setting: Setting) -> Findings:
    """R14 for the brick as it is, with what was found under other conditions if that was tried."""
    series = {wheel: series_numbers(own) for wheel, own in series_of_wheels(rows).items()}
    claimed = pieces.claimed_in(setting.options)
    judged = [found for (condition, _), found in series.items() if condition == claimed]
    own = tally(lives_rows(rows, claimed) or judged)
    rates = [found["exponent"] for found in judged]
    chaotic = all(
        rate is not None and rate["interval"] is not None and rate["interval"][0] > of_noise()
        for rate in rates
    )
    rates_text = ", ".join(in_words(rate) for rate in rates)
    until = "for more than" if own["median_is_censored"] else "until"
    switching = (
        f"the share of wheels that switch to the end: {own['to_the_end']} of {own['wheels']}; half"
        f" of them switch {until} {own['median_until_s']:.1f} s"
    )
    exponents = f"Lyapunov exponent of the time series {rates_text}; of noise {of_noise():.2f}/s"
    notes = [switching, exponents]
    numbers: Numbers = {
        "parameters": {**pieces.chaotic(setting.options), "tick_s": setting.params().tick_s},
        "series": {f"{condition}, {side}": found for (condition, side), found in series.items()},
    }
    parted = twins_rows(rows).get((claimed, SEEN))
    if parted:
        notes.append(f"of twins {in_words(plain(growth(parted)))}")
    if lives_rows(rows, ORDINARY):
        explanations = explain(rows)
        numbers = {**numbers, **explanations}
        older = next(found for (condition, _), found in series.items() if condition == OLDER)
        notes += reasons(explanations, older["exponent"])
    claim = Claim(
        "R14",
        SENTENCES["R14"],
        "sustained irregular switching over 10 min; positive largest Lyapunov exponent estimate",
        own["to_the_end"] / own["wheels"],
        "1",
        wilson(own["to_the_end"], own["wheels"]),
        own["to_the_end"] >= SUSTAINED * own["wheels"] and chaotic,
        "; ".join(notes),
    )
    doubts = setting.elsewhere(**registry.claimed("chaos")), setting.short_of(minutes=CLAIMED_MIN)
    answers = [
        share("wheels that switch to the end", own["to_the_end"], own["wheels"]),
        share("wheels that roll in the end", own["roll"], own["wheels"]),
        share("wheels that rest in the end", own["rest"], own["wheels"]),
        Answer(f"half of them switch {until}", own["median_until_s"], None, "s"),
        *(
            _rate_answer(f"exponent of the series, {condition}, {side} wheel", found["exponent"])
            for (condition, side), found in series.items()
        ),
        *(
            _rate_answer(f"exponent of twins, {condition}, jump of {jump:g}", plain(growth(own)))
            for (condition, jump), own in twins_rows(rows).items()
        ),
    ]
    return Findings([claim.doubted(*doubts)], numbers, answers=answers)


def _rate_answer(name: str, rate: Rate | None) -> Answer:
    if rate is None:
        return Answer(name, None)
    error = standard_error(rate["interval"]) if rate["interval"] else None
    return Answer(name, rate["per_s"], error, "/s")
