"""How the robot writes names and times for people, and prints its words."""

import select
from io import UnsupportedOperation


def person(name):
    """A host's name in a sentence: quoted, since a host may call itself anything.

    Args:
        name: What the host calls itself; may be empty.

    Returns:
        The words.
    """
    return "'{}'".format(name) if name.strip() else "somebody without a name"


def duration(seconds):
    """A duration as people say it.

    Args:
        seconds: The duration, s.

    Returns:
        Its two largest units, as in '12 s', '2 min 10 s' and '1 h 5 min'.
    """
    whole = int(max(0.0, seconds))
    if whole < 60:
        return "{} s".format(whole)
    if whole < 3600:
        return "{} min {} s".format(whole // 60, whole % 60)
    return "{} h {} min".format(whole // 3600, whole // 60 % 60)


def say(text, stream):
    """Print a line, if it can be printed.

    A full card, a closed terminal or a letter that it does not know must not end the program, and
    a terminal that ^S has stopped must not hold it up: what that does not take is lost.

    Args:
        text: The line.
        stream: sys.stdout or sys.stderr; None if the program has none.
    """
    if stream is None:
        return
    encoding = stream.encoding or "ascii"
    try:
        if not _takes(stream):
            return
        print(text.encode(encoding, "backslashreplace").decode(encoding), file=stream, flush=True)
    except (OSError, ValueError):
        pass


def _takes(stream):
    """Whether a stream takes something now. Raises OSError or ValueError if it is closed."""
    try:
        number = stream.fileno()
    except UnsupportedOperation:  # it is in memory
        return True
    poll = select.poll()
    poll.register(number, select.POLLOUT)
    return bool(poll.poll(0))
