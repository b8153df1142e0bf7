"""The lab's page calculates nothing of the model, and asks for nothing from elsewhere."""

import re
from pathlib import Path

import pytest

from robot.params import TABLE
from tests.lint.sources import ROOT

PAGE = ROOT / "host/lab/page"
SCRIPTS = sorted(str(path.relative_to(ROOT)) for path in PAGE.rglob("*.js"))
DRAWINGS = [script for script in SCRIPTS if "/draw/" in script]
# It gets the page's own modules as texts, for where no server has them.
LOADER = "host/lab/page/from_texts.js"

# A parameter's name with a number that is given to it, as `tau_s: 0.3`. Short names are other
# things, too, unless the number is the parameter's own.
_NAMED = "|".join(name for name in TABLE if len(name) > 1)
_SHORT = "|".join(f"{name}\\s*[:=]\\s*{TABLE[name].default:g}\\b" for name in ("a", "k"))
MODEL = re.compile(
    r"\btanh\b|\bexp\b|\bexpm1\b|\bsinh\b|\bcosh\b|\bMath\.E\b|\btau\b|\bsigmoid\b|\beuler\b"
    r"|3\s*\*\s*(?:Math\.)?PI\s*/\s*4|0?\.75\s*\*\s*(?:Math\.)?PI|\b2\.356"
    r"|\+=\s*dt\w*\s*\*|\bdt_s\s*\*"
    rf"|\b(?:{_NAMED})\b['\"]?\s*[:=]\s*-?\.?\d|\b(?:{_SHORT})",
    re.IGNORECASE,
)
ELSEWHERE = re.compile(r"(?:https?:|wss?:|['\"`])//(?!\$\{location\.host\})[\w$]")
IMPORTS = re.compile(r"\b(?:import|from)\s*\(?\s*(['\"`])(.*?)\1|\bimport\s*\(\s*[^'\"`\s]")
# A drawing is a function of its state alone.
LIVELY = re.compile(
    r"\b(?:setTimeout|setInterval|requestAnimationFrame|Date|performance|fetch|document|window"
    r"|localStorage|sessionStorage)\b|Math\.random"
)


def _code(text):
    """The code without its comments."""
    return re.sub(r"/\*.*?\*/|(?<![:'\"`])//[^\n]*", "", text, flags=re.DOTALL)


def _found(pattern, script):
    return [match.group() for match in pattern.finditer(_code((ROOT / script).read_text("utf-8")))]


def test_there_are_drawings():
    assert {Path(script).stem for script in DRAWINGS} >= {"wheel", "strips", "plane", "floor"}


@pytest.mark.parametrize("script", SCRIPTS)
def test_no_equation_of_the_model(script):
    assert not _found(MODEL, script)


@pytest.mark.parametrize("script", SCRIPTS)
def test_no_address_of_another_host(script):
    assert not _found(ELSEWHERE, script)


@pytest.mark.parametrize("script", [script for script in SCRIPTS if script != LOADER])
def test_imports_are_the_pages_own(script):
    text = _code((ROOT / script).read_text("utf-8"))
    assert all((match.group(2) or "").startswith("./") for match in IMPORTS.finditer(text))


@pytest.mark.parametrize("script", [*DRAWINGS, "host/lab/page/theme.js"])
def test_a_drawing_imports_nothing_and_does_nothing_by_itself(script):
    assert not _found(IMPORTS, script)
    if script in DRAWINGS:
        assert not _found(LIVELY, script)


@pytest.mark.parametrize("script", SCRIPTS)
def test_no_script_is_too_long_to_read(script):
    lines = (ROOT / script).read_text("utf-8").splitlines()
    assert len(lines) <= 300
    assert max(map(len, lines)) <= 100


@pytest.mark.parametrize(
    "source",
    [
        "const m = Math.tanh(f);",
        "const y = 1 / (1 + Math.exp(-a * x));",
        "const { exp } = Math;",
        "x += dt * (seen - x) / tau;",
        "const shift = 3 * Math.PI / 4;",
        "const defaults = { tau_s: 0.25 };",
        "const defaults = { k: 8 };",
        'const defaults = { "max_duty_pct": 85 };',
    ],
)
def test_an_equation_is_found(source):
    assert MODEL.search(_code(source))


@pytest.mark.parametrize(
    "source",
    [
        'import x from "https://example.org/x.js";',
        "fetch('//example.org/a')",
        "new WebSocket(`ws://example.org/messages`)",
    ],
)
def test_another_host_is_found(source):
    assert ELSEWHERE.search(_code(source))


@pytest.mark.parametrize(
    "source",
    [
        "new WebSocket(`ws://${location.host}/messages`)",
        "const half = size / 2; // a comment",
        'const unit = "rad/s";',
    ],
)
def test_the_pages_own_host_is_no_other(source):
    assert not ELSEWHERE.search(_code(source))
