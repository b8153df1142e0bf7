"""The command lines of the robot's programs."""

import pytest

from robot.arguments import WRONG_USE, Arguments


@pytest.fixture
def arguments():
    arguments = Arguments("What the program is.")
    arguments.add("port", 5425, "where it listens", "PORT", int)
    arguments.add("tick", None, "control period", "S", float)
    arguments.add("left", "outB", "left motor", "PORT", choices=("outA", "outB"))
    arguments.add("set", [], "a parameter", "NAME=VALUE", many=True)
    arguments.add("idle", False, "motors off")
    return arguments


def test_what_is_not_named_has_its_default(arguments):
    found = vars(arguments.parse([]))
    assert found == {"port": 5425, "tick": None, "left": "outB", "set": [], "idle": False}


def test_what_is_named_has_its_value(arguments):
    words = ["--set", "k=8", "--port=0", "--idle", "--tick", "0.02", "--left", "outA", "--set=a=-1"]
    found = vars(arguments.parse(words))
    assert found == {
        "port": 0,
        "tick": 0.02,
        "left": "outA",
        "set": ["k=8", "a=-1"],
        "idle": True,
    }
    assert arguments.parse(["--port", "-1"]).port == -1
    assert arguments.parse([]).set == []


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["5425"], "there is no argument '5425'"),
        (["--por", "1"], "there is no argument '--por'"),
        (["-port", "1"], "there is no argument '-port'"),
        (["--port"], "--port needs a value: --port PORT"),
        (["--port", "--idle"], "--port needs a value: --port PORT"),
        (["--port", "x"], "--port cannot be 'x': give a whole number"),
        (["--port="], "--port cannot be '': give a whole number"),
        (["--tick", "0,02"], "--tick cannot be '0,02': give a number"),
        (["--left", "outC"], "--left cannot be 'outC': it is one of outA, outB"),
        (["--idle=yes"], "--idle takes no value: leave out '=yes'"),
    ],
)
def test_a_wrong_command_line_is_refused_in_words(arguments, capsys, words, reason):
    with pytest.raises(SystemExit) as ended:
        arguments.parse(words)
    assert ended.value.code == WRONG_USE
    out, err = capsys.readouterr()
    assert (out, len(err.splitlines())) == ("", 1)
    assert reason in err


@pytest.mark.parametrize("word", ["-h", "--help"])
def test_help_names_every_option_and_default(arguments, capsys, word):
    with pytest.raises(SystemExit) as ended:
        arguments.parse(["--idle", word])
    assert ended.value.code == 0
    text = capsys.readouterr()[0]
    assert "What the program is." in text
    for line in (
        "  --port PORT\n    where it listens (default 5425)\n",
        "  --tick S\n    control period\n",
        "  --left PORT\n    left motor (default outB)\n",
        "  --set NAME=VALUE\n    a parameter\n",
        "  --idle\n    motors off\n",
    ):
        assert line in text
