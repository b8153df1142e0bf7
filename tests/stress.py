"""`make stress`: run the tests that need real time again and again while all cores are busy.

Ports, processes and file systems that work only on an idle machine show up here. Returns 1 if a run
fails.
"""

import os
import re
import subprocess
import sys
import time
from collections import Counter
from contextlib import ExitStack
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TESTS = ("tests/deploy", "tests/sysfs", "tests/cli/test_desk.py")
RUNS = int(os.environ.get("STRESS_RUNS", "20"))
# It ends with the process that started it, even if that one is killed.
BUSY = "import os\nparent = os.getppid()\nwhile os.getppid() == parent: sum(range(1000000))"


def run():
    """Run them as `make test` does: (whether all passed, their output)."""
    options = ("-q", "--color=no", "-n", "4", "--dist", "worksteal")
    command = [sys.executable, "-m", "pytest", *options, *TESTS, *sys.argv[1:]]
    done = subprocess.run(
        command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
    )
    return done.returncode == 0, done.stdout


def main():
    """Print a line for each run, and the output of those that fail. Returns the exit status."""
    failures, failed_runs = Counter(), 0
    with ExitStack() as stack:
        for _ in range(os.cpu_count()):
            loop = stack.enter_context(subprocess.Popen([sys.executable, "-c", BUSY]))
            stack.callback(loop.kill)
        print(f"{os.cpu_count()} busy loops, {RUNS} runs of {' '.join(TESTS)}", flush=True)
        for number in range(1, RUNS + 1):
            since = time.monotonic()
            passed, output = run()
            if not passed:
                failed_runs += 1
                failures.update(re.findall(r"^(?:FAILED|ERROR) (\S+)", output, re.MULTILINE))
                print(output)
            last = output.rstrip().splitlines()[-1]
            print(f"{number}/{RUNS}: {last} ({time.monotonic() - since:.0f} s)", flush=True)
    for test, times in failures.most_common():
        print(f"failed {times} times: {test}")
    print(f"{RUNS - failed_runs} of {RUNS} runs passed")
    return 1 if failed_runs else 0


if __name__ == "__main__":
    sys.exit(main())
