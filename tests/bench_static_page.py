"""How fast the robot of a page without a server is, in the Python for browsers.

It needs node, and `make page` before it.
"""

import json
import shutil
import subprocess

from tests.lint.sources import ROOT

PYODIDE = ROOT / "build/pyodide/node_modules/pyodide/pyodide.mjs"
SOURCES = ROOT / "build/page/python.zip"
SECONDS = 60
# How long a step may keep a stop waiting (s).
MOST_S = 0.02
# Prints how long the start of the lab and then SECONDS of its robot take, in s.
COURSE = f"""
import json
import time
begin = time.perf_counter()
from host.lab.browser_lab import BrowserLab
heard = []
lab = BrowserLab(1, 0.0, heard.append)
started = time.perf_counter()
for step in range({SECONDS * 50}):
    lab.step(step / 50)
ran = time.perf_counter()
longest = 0.0
for number, name in enumerate(("spin-left", "stopped", "forward")):
    wanted = {{"robot": "simulated", "command": "primitive", "arguments": {{"name": name}}}}
    answer = f'"request": {{number}}, "result"'
    before = time.perf_counter()
    lab.receive(json.dumps({{"type": "do", "request": number, **wanted}}), step / 50)
    while not any(isinstance(one, str) and answer in one for one in heard):
        longest = max(longest, time.perf_counter() - before)
        heard.clear()
        step += 1
        before = time.perf_counter()
        lab.step(step / 50)
f"{{started - begin}} {{ran - started}} {{longest}}"
"""
IN_NODE = f"""
import {{ readFileSync }} from "fs";
const {{ loadPyodide }} = await import("file://{PYODIDE}");
const begin = performance.now();
const python = await loadPyodide();
python.unpackArchive(new Uint8Array(readFileSync("{SOURCES}")), "zip", {{ extractDir: "/lab" }});
python.runPython("import sys; sys.path.insert(0, '/lab')");
const loaded = (performance.now() - begin) / 1000;
console.log(loaded, python.runPython({json.dumps(COURSE, allow_nan=False)}));
"""


def page_without_a_server() -> None:
    """Print what a page waits for, and how many times faster than real time its robot is."""
    node = shutil.which("node")
    if node is None or not (PYODIDE.is_file() and SOURCES.is_file()):
        print("page without a server: needs node, and `make page` before it")
        return
    command = [node, "--input-type=module", "--eval", IN_NODE]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT)
    loaded_s, started_s, course_s, longest_s = map(float, done.stdout.split())
    print(
        f"page without a server: Pyodide loads in {loaded_s:.1f} s, the lab in {started_s:.1f} s;"
        f" its robot is {SECONDS / course_s:.0f} times faster than real time; while it is brought"
        f" into a primitive, a stop waits for at most {1000 * longest_s:.0f} ms"
        f" ({'PASS' if longest_s <= MOST_S else 'FAIL'}: {1000 * MOST_S:.0f} ms)"
    )


if __name__ == "__main__":
    page_without_a_server()
