"""How long the lab's drawings take in a real Chromium."""

import shutil
from math import pi, sin
from statistics import median

from playwright.sync_api import sync_playwright

from tests.web.drawings import K_TRACE, KICKS, SCORE, WHEEL, floor, open_page, plane, strips

FRAMES = 300
TARGET_MS = 2.0
SIZE = {"width": 900, "height": 600}
# Records of a minute at 100 Hz.
MINUTE = 6000
# The time of each frame as (ms to draw, ms until the pixels are there). One pixel read makes
# Chromium paint what it has only noted down so far.
MEASURE = """
    ([name, state, size, frames]) => {
        draw(name, state, size);
        const canvas = document.createElement("canvas");
        [canvas.width, canvas.height] = [size.width, size.height];
        const times = [];
        for (let n = 0; n < frames; n++) {
            const begin = performance.now();
            drawn.module.draw(canvas, drawn.state, drawn.theme);
            const noted = performance.now();
            canvas.getContext("2d").getImageData(0, 0, 1, 1);
            times.push([noted - begin, performance.now() - begin]);
            if (drawn.state.now_s) drawn.state.now_s += 0.016;
        }
        return times;
    }
"""


def drawings() -> None:
    """Each drawing's time at 900x600: what its own code takes, and with Chromium's painting."""
    chromium = shutil.which("chromium")
    if chromium is None:
        print("the lab's drawings: no Chromium here; get one by `apt-get install chromium`")
        return
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        page = open_page(browser)
        for name, state in _states().items():
            times = page.evaluate(MEASURE, [name.split()[0], state, SIZE, FRAMES])
            drawn, painted = (sorted(column) for column in zip(*times, strict=True))
            verdict = "PASS" if _p95(drawn) <= TARGET_MS else "FAIL"
            print(
                f"drawing '{name}': p95 {_p95(drawn):.1f} ms ({verdict}: at most {TARGET_MS} ms),"
                f" median {median(drawn):.1f} ms; with Chromium's own painting p95"
                f" {_p95(painted):.1f} ms, median {median(painted):.1f} ms",
                flush=True,
            )
        browser.close()


def _p95(times):
    return times[int(0.95 * len(times))]


def _states():
    """A kicked wheel, strips at 100 Hz and at the robot's own pace, 10 s of a plane, a path."""
    wave = [sin(number / 8) for number in range(MINUTE)]
    slow = [sin(number / 300) for number in range(MINUTE)]
    rows = {f"{side}_{name}": wave for side in ("left", "right") for name in ("x1", "x2", "torque")}
    rows |= {f"{side}_omega_rad_s": wave for side in ("left", "right")}
    short = {name: column[:270] for name, column in rows.items()}
    angles = [0.13 * number % (2 * pi) for number in range(1000)]
    return {
        "wheel": {**WHEEL, "kick": "phase", "seen1": -0.9, "seen2": 0.1},
        "strips of 60 s": {**strips(MINUTE, dt_s=[0.01] * MINUTE, **rows), "kicks": KICKS},
        "strips of 8 s": {**strips(270, 1 / 0.03, dt_s=[0.03] * 270, **short), "kicks": KICKS},
        "plane": plane(angles, wave[:1000], dashed=True, ghost={"x": 1.0, "y": 0.0}),
        "floor": floor([number / 600 for number in range(MINUTE)], slow, walls=2.0),
        "score": SCORE,
        "k_trace": K_TRACE,
        "basins": {"side": 64, "ends": "".join((n * "b").ljust(64, "f") for n in range(64))},
    }
