"""States for the lab's drawings as plain data, and the page that draws them."""

from math import cos, pi, sin
from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "host/lab/page"
ADDRESS = "http://drawings.test/"
DRAWINGS = ("wheel", "strips", "plane", "floor", "score", "basins", "k_trace")
# A state is plain data, in which lists of numbers stand for typed arrays. A drawing is kept as
# `drawn`, for questions about it.
SCRIPT = (
    f"const names = {list(DRAWINGS)};"
    """
    import { theme } from "/theme.js";
    const modules = {};
    for (const name of names) modules[name] = await import(`/draw/${name}.js`);
    const typed = (value) => {
        if (Array.isArray(value)) {
            return typeof value[0] === "number" ? Float64Array.from(value) : value.map(typed);
        }
        if (value === null || typeof value !== "object") return value;
        return Object.fromEntries(Object.entries(value).map(([key, part]) => [key, typed(part)]));
    };
    const read = () => {
        const { width, height } = drawn.canvas;
        return drawn.canvas.getContext("2d").getImageData(0, 0, width, height).data;
    };
    // The pixels, as [x, y], for which a function of their first byte's index holds. As text: that
    // many values would take playwright seconds.
    const where = (holds) => {
        const { width, height } = drawn.canvas;
        const found = [];
        for (let n = 0; n < width * height; n++) {
            if (holds(4 * n)) found.push([n % width, Math.floor(n / width)]);
        }
        return JSON.stringify(found);
    };
    // Draws, and returns a number that tells pictures apart.
    const look = () => {
        drawn.module.draw(drawn.canvas, drawn.state, drawn.theme);
        return new Uint32Array(read().buffer).reduce((sum, rgb) => Math.imul(sum, 31) + rgb | 0, 7);
    };
    window.draw = (name, state, { width, height, scale = 1, dark = false, projector = false }) => {
        const canvas = document.createElement("canvas");
        [canvas.width, canvas.height] = [width * scale, height * scale];
        canvas.getContext("2d", { alpha: false, willReadFrequently: true });
        const colours = theme({ dark, scale, height }, projector);
        window.drawn = { canvas, theme: colours, state: typed(state), module: modules[name] };
        return look();
    };
    window.again = look;
    window.pixel = (x, y) => {
        const at = [Math.floor(x * drawn.theme.scale), Math.floor(y * drawn.theme.scale)];
        const [r, g, b] = drawn.canvas.getContext("2d").getImageData(...at, 1, 1).data;
        return "#" + [r, g, b].map((part) => part.toString(16).padStart(2, "0")).join("");
    };
    window.places = (colour) => {
        const data = read();
        const [r, g, b] = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
        const far = (one, other) => Math.abs(one - other) > 20;
        return where((n) => !(far(data[n], r) || far(data[n + 1], g) || far(data[n + 2], b)));
    };
    window.changed = (before) => {
        const [data, old] = [read(), before];
        const far = (n) => Math.abs(data[n] - old[n]) > 8;
        return where((n) => far(n) || far(n + 1) || far(n + 2));
    };
    window.colourful = () => {
        const data = read();
        const spread = (...rgb) => Math.max(...rgb) - Math.min(...rgb);
        return where((n) => spread(data[n], data[n + 1], data[n + 2]) > 40);
    };
    window.drawnOnto = (name, before, after, size) => {
        draw(name, before, size);
        const old = read();
        draw(name, after, size);
        return changed(old);
    };
"""
)

WHEEL = {
    "phi_rad": 1.0,
    "x1": 0.3,
    "x2": -0.2,
    "target1": 0.5,
    "target2": -0.4,
    "seen1": cos(1.0),
    "seen2": sin(1.0),
    "force": 2.0,
    "torque": 0.96,
    "omega_rad_s": 12.0,
    "duty_pct": 82,
    "stall": 0.1,
    "kick": "",
    "title": "left wheel",
    "stale": False,
    "labels": {"forward": "forward", "duty": "duty", "turns": "turns/s"},
}


def strips(count=600, hertz=100.0, **columns):
    """Strips of `count` records with these columns."""
    return {
        "columns": {"t_s": [number / hertz for number in range(count)], **columns},
        "start": 0,
        "count": count,
        "now_s": (count - 1) / hertz,
        "seconds": (count - 1) / hertz,
        "tick_s": 0.03,
        "stall": 0.1,
        "kicks": [],
        "stale": False,
        "labels": {"left": "left", "right": "right", "stall": "too weak", "period": "period"},
    }


def plane(x, y, **trace):
    """A plane of an angle and a number, with one trace."""
    return {
        "x": {
            "symbol": "φ",
            "unit": "rad",
            "minimum": 0.0,
            "maximum": 2 * pi,
            "pi": True,
            "wrap": True,
        },
        "y": {"symbol": "ω", "unit": "rad/s", "minimum": -1.0, "maximum": 1.0},
        "traces": [{"x": x, "y": y, "colour": "left1", "dashed": False, "name": "", **trace}],
        "start": 0,
        "count": len(x),
        "note": "a slice of four dimensions",
        "title": "",
        "stale": False,
    }


def floor(x_m, y_m, **more):
    """A path on the floor."""
    return {
        "x_m": x_m,
        "y_m": y_m,
        "heading_rad": [0.5] * len(x_m),
        "start": 0,
        "count": len(x_m),
        "walls": None,
        "track_m": 0.12,
        "view": {},
        "stale": False,
        "labels": {"start": "start"},
        **more,
    }


SCORE = {
    "wheels": [
        {
            "name": "left",
            "shares": {"reverses": 24, "continues": 6, "stops": 2},
            "outcome": "reverses",
        },
        {
            "name": "right",
            "shares": {"reverses": 0, "continues": 0, "stops": 32},
            "outcome": None,
        },
    ],
    "of": 32,
    "guess": "continues",
    "stale": False,
    "labels": {
        "reverses": "reverses",
        "continues": "continues",
        "stops": "stops",
        "outcome": "what it did",
        "guess": "your guess",
    },
}

K_TRACE = {
    "holds": [
        {
            "k": k,
            "up": up,
            "means": {
                side: {"omega_rad_s": speed, "torque": speed / 12} for side in ("left", "right")
            },
        }
        for k, up, speed in (
            (2.0, None, 10.0),
            (0.5, False, 3.0),
            (0.3, False, 0.0),
            (0.5, True, 0.0),
        )
    ],
    "labels": {"up": "raised", "down": "lowered", "left": "left", "right": "right"},
    "stale": False,
}
BASINS = {"side": 4, "ends": "ffbbffbbffbbrrnn", "stale": False}

WAVE = [sin(number / 8) for number in range(600)]
WITH_GAPS = [float("nan") if number % 50 < 5 else value for number, value in enumerate(WAVE)]
KICKS = [
    {"begin_s": 1.0, "end_s": 1.03, "name": "membrane"},
    {"begin_s": 5.9, "end_s": None, "name": "phase"},
]
# Each drawing in states that it has to draw without complaint.
STATES = {
    "wheel": [
        {},
        WHEEL,
        {**WHEEL, "kick": "phase", "seen1": -0.9, "seen2": 0.1, "stale": True},
        {"phi_rad": 0.5},
        {
            name: float("nan") if isinstance(value, (int, float)) else value
            for name, value in WHEEL.items()
        },
    ],
    "strips": [
        {},
        {"columns": {}, "count": 0, "kicks": None},
        {**strips(left_x1=WAVE, right_omega_rad_s=WITH_GAPS), "kicks": KICKS},
        {**strips(left_x1=[float("nan")] * 600), "stale": True},
    ],
    "plane": [
        {},
        plane([], []),
        plane(WAVE, WITH_GAPS, ghost={"x": 3.0, "y": 0.5}, dashed=True, name="left"),
        {**plane(WAVE, WAVE, jumped=[0.0, 1.0] * 300), "equal": True, "stale": True},
        plane(WAVE, [float("nan")] * 600),
    ],
    "floor": [
        {},
        floor([], []),
        {**floor(WAVE, WITH_GAPS, walls=2.0), "stale": True},
        {**floor([float("nan")], [float("nan")]), "view": None},
    ],
    "score": [
        {},
        SCORE,
        {**SCORE, "wheels": [{"name": "left", "shares": None, "outcome": None}], "stale": True},
        {**SCORE, "of": 0},
    ],
    "k_trace": [
        {},
        K_TRACE,
        {"holds": [{"k": 8.0, "up": None, "means": {"left": None, "right": None}}]},
        {**K_TRACE, "stale": True},
    ],
    "basins": [
        {},
        BASINS,
        {**BASINS, "ends": "nnnnnnnnnnnnnnnn"},
        {**BASINS, "stale": True},
    ],
}


def serve(route):
    """Answer a request of the page from the folder of the lab's page."""
    name = route.request.url.removeprefix(ADDRESS)
    if name:
        route.fulfill(body=(PAGE / name).read_text("utf-8"), content_type="text/javascript")
    else:
        route.fulfill(body="<!doctype html><title>drawings</title>", content_type="text/html")


def open_page(browser):
    """A page of the browser that has the drawings, and nothing else."""
    page = browser.new_page()
    page.route("**/*", serve)
    page.goto(ADDRESS)
    page.add_script_tag(content=SCRIPT, type="module")
    page.wait_for_function("() => Boolean(window.draw)")
    return page
