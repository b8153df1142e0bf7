"""The file of robots that this user knows by name: a table for each.

It holds a robot's address, and its token and the hardware id of its machine where it has them.
It belongs to the user, who may edit it. So a change keeps every other line as it is, comments too.
"""

from __future__ import annotations

import fcntl
import json
import os
import re
import tomllib
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from difflib import get_close_matches
from pathlib import Path
from typing import Any, NamedTuple

from host.errors import WrongUse, quotable
from robot.user_folders import config_folder

LONGEST_NAME = 40
# What a name may not be: it means all robots, or begins an address.
_TAKEN = ("all", "sim", "tcp", "ssh", "serial")
_NAME = re.compile(f"[A-Za-z0-9][A-Za-z0-9_-]{{0,{LONGEST_NAME - 1}}}")
_NAMES_ARE = (
    f"a name has letters (a to z), digits, - and _, at most {LONGEST_NAME} of them, and begins with"
    " a letter or a digit, as in anna or ev3-2"
)
_KEYS = ("address", "token", "hardware_id")
# A line of a table, around its value.
_LINE = r"(\s*{}\s*=\s*)(\"(?:[^\"\\]|\\.)*\"|'[^']*')"
_HEADER = re.compile(r"\s*\[")
_TABLE = re.compile(r"^(?=\s*\[)", re.MULTILINE)
_NEW_FILE = (
    "# The robots that kickctl knows by name. `kickctl robots --help` says how to change it.\n"
)


class Known(NamedTuple):
    """A robot that this computer knows how to reach.

    Attributes:
        name: Its name; its address if it has no name.
        address: Its address.
        token: The path of its own token file; None if it has none that is known.
        hardware_id: What its machine says of itself under any address; None if it is not known, or
            the robot has no name.
    """

    name: str
    address: str
    token: str | None = None
    hardware_id: str | None = None


def is_name(text: str) -> bool:
    """Whether a text may be the name of a robot."""
    return bool(_NAME.fullmatch(text)) and text.lower() not in _TAKEN


def is_hardware_id(value: object) -> bool:
    """Whether a value, which may come from anywhere, is a machine's hardware id."""
    return isinstance(value, str) and bool(re.fullmatch("[0-9a-f]{32}", value))


def need_name(text: str) -> str:
    """The text, if it may be the name of a robot. Raises WrongUse."""
    if is_name(text):
        return text
    why = ": the word means something else" if text.lower() in _TAKEN else ""
    raise WrongUse(f"a robot cannot be named '{quotable(text)}'{why}", _NAMES_ARE)


def file_path() -> Path | None:
    """Where the file is, or will be; None if this user has no home folder."""
    folder = config_folder()
    return Path(folder, "robots.toml") if folder else None


def token_path(name: str) -> Path | None:
    """Where the token of a robot lies unless its entry says otherwise; None without a home."""
    folder = config_folder()
    return Path(folder, "tokens", name) if folder else None


def read() -> dict[str, Known]:
    """The robots by their names, in the order of the file; none if there is no file.

    Raises:
        WrongUse: The file is spoiled.
    """
    path = file_path()
    entries = {} if path is None else _parse(path, _text(path))
    return {name: _known(name, entry) for name, entry in entries.items()}


def read_sound() -> tuple[dict[str, Known], WrongUse | None]:
    """The robots whose own tables are in order, and what is wrong with the file, if anything is."""
    try:
        return read(), None
    except WrongUse as error:
        entries: dict[str, dict[str, str]] = {}
        path = file_path()
        with suppress(WrongUse):  # if it is no text at all
            for table in _TABLE.split(_text(path) if path else ""):
                with suppress(WrongUse):
                    entries |= _parse(Path(), table)
        return {name: _known(name, entry) for name, entry in entries.items()}, error


def add(name: str, address: str, token: str | None = None, hardware_id: str | None = None) -> Known:
    """Add a robot; nothing happens if it is there just so, but for a new hardware id.

    Args:
        name: Its name, which nobody has yet.
        address: Its address.
        token: The path of its token file; None if it lies at `token_path`, or if there is none.
        hardware_id: That of its machine; None if it is not known.

    Raises:
        WrongUse: The name cannot be one, or another robot has it, or the file is spoiled.
    """
    need_name(name)
    entry = {"address": address} | ({} if token is None else {"token": token})
    whole = entry | ({} if hardware_id is None else {"hardware_id": hardware_id})

    def change(text: str, robots: dict[str, dict[str, str]]) -> str:
        if name in robots and _without_id(robots[name]) == entry:
            return (
                text if hardware_id is None else _set(text, robots, name, hardware_id=hardware_id)
            )
        same = _sounding_alike(name, robots)
        if same is not None:
            raise WrongUse(
                f"there is a robot '{same}' already, at {robots[same]['address']}",
                "choose another name, or type first: kickctl robots remove " + same,
            )
        robots[name] = whole
        lines = [f"{key} = {_quoted(value)}" for key, value in whole.items()]
        gap = "" if not text or text.endswith("\n\n") else "\n" if text.endswith("\n") else "\n\n"
        return "\n".join([f"{text or _NEW_FILE}{gap}[{name}]", *lines, ""])

    _change(change)
    return _known(name, whole)


def update(name: str, **values: str) -> None:
    """Change what the file says of a robot.

    Args:
        name: Its name.
        values: What is new: its address, token or hardware_id.

    Raises:
        WrongUse: There is no such robot, or the file is spoiled.
    """

    def change(text: str, robots: dict[str, dict[str, str]]) -> str:
        _need(name, robots)
        return _set(text, robots, name, **values)

    _change(change)


def _set(text: str, robots: dict[str, dict[str, str]], name: str, **values: str) -> str:
    """The file's text with other values in an entry, which is changed too."""
    robots[name] |= values
    lines = (text if text.endswith("\n") else text + "\n").splitlines(keepends=True)
    for key, value in values.items():
        start, end = _section(lines, name)
        for place in range(start, end):
            line = re.match(_LINE.format(key), lines[place])
            if line:
                lines[place] = line[1] + _quoted(value) + lines[place][line.end() :]
                break
        else:
            lines.insert(end, f"{key} = {_quoted(value)}\n")
    return "".join(lines)


def _quoted(value: str) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def _without_id(entry: dict[str, str]) -> dict[str, str]:
    return {key: value for key, value in entry.items() if key != "hardware_id"}


def free_name(text: str, taken: Iterable[str]) -> str:
    """A name like a text that may be any, with a number behind it if it is taken."""
    name = re.sub("[^A-Za-z0-9_-]", "-", text.removesuffix(".local"))[:LONGEST_NAME].strip("-_")
    name = name if is_name(name) else "robot"
    names = (name, *(f"{name[: LONGEST_NAME - 4]}-{number}" for number in range(2, 1000)))
    taken = list(taken)
    return next(one for one in names if _sounding_alike(one, taken) is None)


def _sounding_alike(name: str, others: Iterable[str]) -> str | None:
    """The name among others that people cannot tell from a name when they hear it."""
    return next((one for one in others if one.lower() == name.lower()), None)


def rename(old: str, new: str) -> None:
    """Give a robot another name; its token at `token_path` moves with it.

    Raises:
        WrongUse: There is no such robot, or the new name cannot be one or is taken.
    """
    need_name(new)
    token, after = _usual_token(old), token_path(new)

    def change(text: str, robots: dict[str, dict[str, str]]) -> str:
        _need(old, robots)
        same = _sounding_alike(new, (one for one in robots if one != old or old == new))
        if same is not None:
            raise WrongUse(f"there is a robot '{same}' already", "choose another name")
        if token is not None and after is not None and after.exists():
            raise WrongUse(f"{after} is there already", "delete it, or choose another name")
        renamed = {new if name == old else name: entry for name, entry in robots.items()}
        robots.clear()
        robots.update(renamed)
        lines = text.splitlines(keepends=True)
        start, _ = _section(lines, old)
        lines[start] = re.sub(r"\[.*?\]", f"[{new}]", lines[start], count=1)
        return "".join(lines)

    _change(change)
    if token is not None and after is not None:
        token.rename(after)


def remove(name: str) -> Path | None:
    """Forget a robot, and its token if that lies at `token_path`.

    Returns:
        The token file that was deleted; None if there was none.

    Raises:
        WrongUse: There is no such robot.
    """

    def change(text: str, robots: dict[str, dict[str, str]]) -> str:
        _need(name, robots)
        del robots[name]
        lines = text.splitlines(keepends=True)
        start, end = _section(lines, name)
        return "".join(lines[:start] + lines[end:])

    _change(change)
    token = _usual_token(name)
    if token is not None:
        token.unlink()
    return token


def _usual_token(name: str) -> Path | None:
    """The token file of a robot in the usual place; None if there is none."""
    token = token_path(name)
    return token if token is not None and token.is_file() else None


def _need(name: str, robots: dict[str, dict[str, str]]) -> None:
    if name not in robots:
        raise unknown(name, robots)


def unknown(name: str, robots: dict[str, Any]) -> WrongUse:
    """The error for a name that no robot has."""
    close = get_close_matches(name, robots, 1)
    known = f"there are {', '.join(robots)}" if robots else "none has a name yet"
    return WrongUse(
        f"there is no robot '{quotable(name)}'", f"did you mean {close[0]}?" if close else known
    )


def _change(change: Callable[[str, dict[str, dict[str, str]]], str]) -> None:
    """Change the file as a whole: nobody reads half of it, and of two changes none is lost.

    Args:
        change: Gets the text and the entries by name; returns the new text, and changes the entries
            to what the new text should say.
    """
    from host.util.whole_files import write_text

    path = file_path()
    if path is None:
        raise WrongUse(
            "this user has no home folder for the names of robots",
            "set HOME or XDG_CONFIG_HOME, or name the robot by its address",
        )
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    with _alone(path):
        text = _text(path)
        robots = _parse(path, text)
        changed = change(text, robots)
        if not _says(path, changed, robots):
            raise WrongUse(
                f"{path} is written in a form that kickctl can read, but not change",
                "edit it by hand: each robot is a table [NAME] with lines address = and token =",
            )
        write_text(path, changed)


def _says(path: Path, text: str, robots: dict[str, dict[str, str]]) -> bool:
    """Whether a text, which was changed by lines, says what it should."""
    try:
        return _parse(path, text) == robots
    except WrongUse:
        return False


@contextmanager
def _alone(path: Path) -> Iterator[None]:
    """Let one program at a time change the file. The lock ends with the program, too."""
    with path.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")  # Windows' editors begin with a mark
    except FileNotFoundError:
        return ""
    except UnicodeError as error:
        raise _spoiled(path, 0, f"it is no text: {error}") from error


def _parse(path: Path, text: str) -> dict[str, dict[str, str]]:
    """The entries by name. Raises WrongUse that names the line."""
    try:
        robots = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        at = re.search(r"line (\d+)", str(error))
        raise _spoiled(path, int(at[1]) if at else 0, str(error)) from error
    lines = text.splitlines()
    for name, entry in robots.items():
        why = _fault(name, entry)
        if why:
            raise _spoiled(path, _line_of(lines, name), why)
    return robots


def _fault(name: str, entry: object) -> str:
    """What is wrong with an entry; empty if nothing is."""
    if not is_name(name):
        return f"'{quotable(name)}' is no name of a robot; {_NAMES_ARE}"
    if not isinstance(entry, dict):
        return f"'{name}' stands outside of a robot's table, which begins with [NAME]"
    for key, value in entry.items():
        if key not in _KEYS:
            return f"{name} has an unknown '{quotable(key)}'; a robot has {', '.join(_KEYS)}"
        if not isinstance(value, str) or not value or not value.isprintable():
            return f"the {key} of {name} is no text in quotes"
    return "" if "address" in entry else f"{name} has no address"


def _spoiled(path: Path, line: int, why: str) -> WrongUse:
    place = f"{path}, line {line}" if line else str(path)
    return WrongUse(
        f"the file of robots cannot be used: {place}: {quotable(why)}",
        "mend that line, or delete the file and add the robots again: kickctl robots add NAME"
        " ADDRESS",
    )


def _line_of(lines: list[str], name: str) -> int:
    """The number of the line in which a name stands first, from 1 on; 0 if nobody can say."""
    return next((number for number, line in enumerate(lines, 1) if name in line), 0)


def _section(lines: list[str], name: str) -> tuple[int, int]:
    """From where to where an entry goes: its header, and the line behind its last value.

    Comments behind that belong to what follows. (0, 0) if the entry has another form.
    """
    header = re.compile(rf"\s*\[\s*[\"']?{re.escape(name)}[\"']?\s*\]")
    start = next((place for place, line in enumerate(lines) if header.match(line)), None)
    if start is None:
        return 0, 0
    end = start + 1
    for place in range(start + 1, len(lines)):
        if _HEADER.match(lines[place]):
            break
        if lines[place].strip() and not lines[place].lstrip().startswith("#"):
            end = place + 1
    return start, end


def _known(name: str, entry: dict[str, str]) -> Known:
    """A robot with the token file that its entry names, or that lies in the usual place."""
    if "token" in entry:
        # An absolute path stays as it is.
        own: Path | None = Path(config_folder(), os.path.expanduser(entry["token"]))  # noqa: PTH111
    else:
        own = _usual_token(name)
    token = None if own is None else str(own)
    return Known(name, entry["address"], token, entry.get("hardware_id"))
