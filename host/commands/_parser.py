"""The parser of the command line: what is wrong is said by the verb that was typed."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from typing import Any, NoReturn

from host.errors import WrongUse
from host.util.numbers import Number

# Options whose values may begin with a minus sign and still be no plain numbers.
_SIGNED = ("--shift", "--value", "--delta", "--window")


class Help(argparse.HelpFormatter):
    """Says of each number from where to where it may go."""

    def _get_help_string(self, action: argparse.Action) -> str | None:
        words = super()._get_help_string(action)
        span = action.type.span() if isinstance(action.type, Number) else ""
        return f"{words}; {span}" if span else words


class RawHelp(Help, argparse.RawDescriptionHelpFormatter):
    """The same, with descriptions as they are written."""


class Parser(argparse.ArgumentParser):
    """Raises WrongUse for a wrong command line, so that it is answered like every other error.

    The namespace that it returns has `command`: what was typed up to the last verb or name. Its
    help ends with the note of the command, see host.commands._help_notes.
    """

    def __init__(self, *, formatter_class: Any = Help, **more: Any) -> None:
        super().__init__(formatter_class=formatter_class, **more)

    def format_help(self) -> str:
        """The help, and the note."""
        from host.commands._help_notes import note_of

        return super().format_help() + note_of(self.prog)

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse, and refuse what this parser does not know: only it can say what it does know."""
        options, unknown = super().parse_known_args(args, namespace)
        if unknown:
            self._refuse(unknown[0])
        if not hasattr(options, "command"):
            options.command = self.prog
        return options, unknown

    def error(self, message: str) -> NoReturn:
        """Raise WrongUse, in words that begin with the option's name."""
        message = message.removeprefix("argument ").replace(": cannot be ", " cannot be ", 1)
        raise WrongUse(message, f"see {self.prog} --help")

    def _get_values(self, action: argparse.Action, arg_strings: list[str]) -> Any:
        """Refuse `--option=--`, which argparse takes for an option with no value."""
        if action.option_strings and arg_strings == ["--"]:
            self.error(f"{'/'.join(action.option_strings)} cannot be '--'")
        return super()._get_values(action, arg_strings)

    def _match_argument(self, action: argparse.Action, arg_strings_pattern: str) -> int:
        """Name the values of an option that takes several, where argparse only counts them."""
        try:
            return super()._match_argument(action, arg_strings_pattern)
        except argparse.ArgumentError:
            if not isinstance(action.metavar, tuple) or not action.option_strings:
                raise
            option, names = action.option_strings[0], action.metavar
            self.error(
                f"{option} needs {' and '.join(names)} right behind it: {option} {' '.join(names)}"
            )

    def _refuse(self, word: str) -> NoReturn:
        known = [option for option in self._option_string_actions if option.startswith("--")]
        name = word.partition("=")[0]
        kind = "option" if word.startswith("-") else "place for"
        raise WrongUse(
            f"`{self.prog}` has no {kind} '{name}'",
            f"{_guess(name, known)}see {self.prog} --help",
        )

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Refuse a word that is none of an argument's choices."""
        if action.choices is None or value in action.choices:
            return
        choices = [str(choice) for choice in action.choices]
        what = str(action.metavar or "/".join(action.option_strings) or action.dest)
        raise WrongUse(
            f"{what}: invalid choice '{value}'",
            f"{_guess(str(value), choices)}choose from {', '.join(choices)}",
        )


def _guess(word: str, known: Iterable[str]) -> str:
    words = list(known)
    begun = [one for one in words if one.startswith(word)]
    close = begun if len(begun) == 1 else get_close_matches(word, words, 1)
    return f"did you mean {close[0]}? " if close else ""


def join_negative(arguments: Sequence[str]) -> list[str]:
    """Write '--shift -3pi/4' as '--shift=-3pi/4': argparse takes a negative angle for an option."""
    joined: list[str] = []
    for argument in arguments:
        if (
            joined
            and joined[-1] in _SIGNED
            and argument[:1] == "-"
            and argument[1:2] not in ("-", "")
        ):
            joined[-1] += "=" + argument
        else:
            joined.append(argument)
    return joined
