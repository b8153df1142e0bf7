"""Do the guided exercises of the lab as a pupil would, with 20 simulated robots: who passes?

`python -m tests.bench_lessons` takes about half a minute.
"""

from host.lab.lessons.checks import check
from host.lab.lessons.texts import lessons
from tests.lab.pupils import log_of

SEEDS = 20


def main():
    """Print how many robots pass each exercise, and what the others lack."""
    for lesson in lessons():
        passed, lacking = 0, []
        for seed in range(1, SEEDS + 1):
            wrong = [one.words for one in check(lesson["name"], log_of(lesson, seed)) if not one.ok]
            passed += not wrong
            lacking += [f"  seed {seed}: {words}" for words in wrong]
        print(f"{lesson['name']}: {passed} of {SEEDS} robots pass")
        print("\n".join(lacking), end="\n" if lacking else "")


if __name__ == "__main__":
    main()
