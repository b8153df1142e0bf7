"""robot/ keeps the rules of the loop, and the rules catch what they are there for."""

import pytest

from tests.lint.loop_rules import violations
from tests.lint.sources import ROOT, modules

BROKEN = {
    "import in a function": "def serve(self):\n    import json",
    "import from in a method": "class A:\n    def serve(self):\n        from serial import Serial",
    "import in a nested function": "def a():\n    def b():\n        import json",
    "platform": "import platform",
    "subprocess": "from subprocess import run",
    "popen": "import os\nos.popen('uname -p')",
    "system": "import os\nos.system('true')",
    "fork": "import os\nos.fork()",
    "print": "print('\u00e9')",
    "print in a method": "def say(text):\n    print(text)",
    "standard error": "import sys\nsys.stderr.write('\u00e9')",
    "open by the locale": "open('a')",
    "open to read by the locale": "open('a', 'r')",
    "letters that this Python knows": "def f(name): return name.isprintable()",
}
SOUND = {
    "import at the top": "import json\nfrom os import path",
    "open with an encoding": "open('a', 'r', encoding='ascii')",
    "open for bytes": "open('a', 'rb')",
    "another's write": "def f(file): file.write('a')",
}


@pytest.mark.parametrize("source", BROKEN.values(), ids=BROKEN)
def test_the_rules_catch(source: str) -> None:
    assert violations("robot/any.py", source)


@pytest.mark.parametrize("source", SOUND.values(), ids=SOUND)
def test_the_rules_let_pass(source: str) -> None:
    assert violations("robot/any.py", source) == []


@pytest.mark.parametrize(
    ("path", "source"),
    [
        ("robot/serial_line.py", "class A:\n    def __init__(self):\n        import serial"),
        ("robot/words.py", "def say(text):\n    print(text)"),
        ("robot/watchdog.py", "import os\nos.fork()"),
    ],
)
def test_what_happens_before_the_loop_may_be_where_it_is(path: str, source: str) -> None:
    assert violations(path, source) == []
    assert violations("robot/session.py", source)


@pytest.mark.parametrize("module", modules("robot"), ids=str)
def test_the_robot_keeps_them(module: str) -> None:
    assert violations(module, (ROOT / module).read_text(encoding="utf-8")) == []
