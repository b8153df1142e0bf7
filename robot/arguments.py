"""What the command line of a robot's program says.

Not by `argparse`, whose import takes a brick 1.2 s at each start.
"""

import sys
from collections import OrderedDict
from types import SimpleNamespace

from robot.words import say

WRONG_USE = 2
_KINDS = {int: "a whole number", float: "a number"}
_WIDTH, _INDENT = 80, "    "


class Arguments(object):
    """The options of a program: words such as --port, each with a value behind it.

    Args:
        description: What the program is, for its help text.
    """

    def __init__(self, description):
        self._description = description
        self._options = OrderedDict()

    def add(self, name, default, help, value="", read=str, choices=(), many=False):
        """Add an option.

        Args:
            name: Its name, without the dashes.
            default: Its value if the command line does not name it; a list if `many`.
            help: What it does.
            value: What stands for its value in the help text. Without it, the option takes no
                value: it is true if the command line names it.
            read: Makes its value of a text; str, int or float.
            choices: The values that it may have; empty if it may have others.
            many: Whether it may be repeated; then its value is the list of all.
        """
        self._options[name] = SimpleNamespace(
            default=default, help=help, value=value, read=read, choices=choices, many=many
        )

    def parse(self, words):
        """Read a command line. The program ends if it asks for help, or is wrong.

        Args:
            words: What stands behind the program's name.

        Returns:
            An object with the value of each option as an attribute.
        """
        found = {name: option.default for name, option in self._options.items()}
        words = iter(words)
        for word in words:
            if word in ("-h", "--help"):
                say(self._help(), sys.stdout)
                raise SystemExit(0)
            name, equals, text = word[2:].partition("=")
            option = self._options.get(name) if word.startswith("--") else None
            if option is None:
                self.error("there is no argument '{}'; --help names all".format(word))
            if not option.value:
                if equals:
                    self.error("--{} takes no value: leave out '={}'".format(name, text))
                found[name] = True
                continue
            if not equals:
                text = next(words, "--")
                if text.startswith("--"):
                    self.error("--{0} needs a value: --{0} {1}".format(name, option.value))
            value = self._read(name, option, text)
            found[name] = found[name] + [value] if option.many else value
        return SimpleNamespace(**found)

    def error(self, message):
        """End the program, since its command line is wrong.

        Args:
            message: What is wrong, and what to do.
        """
        say("robot: " + message, sys.stderr)
        raise SystemExit(WRONG_USE)

    def _read(self, name, option, text):
        try:
            value = option.read(text)
        except ValueError:
            self.error("--{} cannot be '{}': give {}".format(name, text, _KINDS[option.read]))
        if option.choices and value not in option.choices:
            self.error(
                "--{} cannot be '{}': it is one of {}".format(name, text, ", ".join(option.choices))
            )
        return value

    def _help(self):
        from textwrap import fill  # it takes a brick 0.3 s

        lines = ["robot [--OPTION VALUE ...]", "", fill(self._description, _WIDTH), ""]
        for name, option in self._options.items():
            text = option.help
            if option.default:
                text += " (default {})".format(option.default)
            lines += [
                "  --{} {}".format(name, option.value).rstrip(),
                fill(text, _WIDTH, initial_indent=_INDENT, subsequent_indent=_INDENT),
            ]
        return "\n".join(lines)
