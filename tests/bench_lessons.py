"""Do the guided exercises of the lab as a pupil would, with 20 seeds: who passes, who is found out?

`python -m tests.bench_lessons` takes about half a minute. Besides the honest robot or model wheel
two that cheat are checked: one has another tau than it says, the other swaps kicks or runs.
"""

from host.lab.lessons.texts import lessons
from tests.lab.pupils import (
    RUN,
    failed,
    log_of,
    runs_of,
    runs_with_another_tau,
    with_another_tau,
    with_swapped_kicks,
    with_swapped_runs,
)

SEEDS = 20
# With its motors off a robot needs no tau; two different kicks are given in one exercise only.
NO_TAU, KICKS = "trace", "jump"


def main():
    """Print how many pass each exercise, what the others lack, and how many cheats are found."""
    for lesson in lessons():
        passed, lacking, found = 0, [], {}
        for seed in range(1, SEEDS + 1):
            work = runs_of(lesson, seed) if lesson["name"] in RUN else log_of(lesson, seed)
            wrong = failed(lesson, work)
            passed += not wrong
            lacking += [f"  seed {seed}: {words}" for words in wrong]
            for cheat, its_work in cheats(lesson, work, seed):
                found[cheat] = found.get(cheat, 0) + bool(failed(lesson, its_work))
        said = "".join(f"; {cheat}: {count} found out" for cheat, count in found.items())
        print(f"{lesson['name']}: {passed} of {SEEDS} pass{said}")
        print("\n".join(lacking), end="\n" if lacking else "")


def cheats(lesson, work, seed):
    """What cheats of an exercise are called, and what they leave behind."""
    name = lesson["name"]
    if name in RUN:
        yield "another tau", runs_with_another_tau(lesson, seed)
        yield "swapped runs", with_swapped_runs(work)
    elif name != NO_TAU:
        yield "another tau", with_another_tau(work)
    if name == KICKS:
        yield "swapped kicks", with_swapped_kicks(work)


if __name__ == "__main__":
    main()
