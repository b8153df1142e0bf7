"""What ended a command, in words: what happened, why, and what to do next."""

from __future__ import annotations

import errno

from host.errors import Interrupted, KickctlError, NotDone, WrongUse
from host.util.installation import install_command

_FULL = "is the disk full? Make room, or choose another place"
_NOT_ALLOWED = "choose a place that you may read and write"
_NOT_THERE = "is every folder of that name there?"
_REMEDIES = {
    errno.ENOSPC: _FULL,
    errno.EDQUOT: _FULL,
    errno.EACCES: _NOT_ALLOWED,
    errno.EPERM: _NOT_ALLOWED,
    errno.EROFS: _NOT_ALLOWED,
    errno.ENOENT: _NOT_THERE,
    errno.ENOTDIR: _NOT_THERE,
    errno.EISDIR: "name a file, not a folder",
    errno.EFBIG: "files may not grow that long here: see `ulimit -f`",
    errno.EIO: "is the disk or the terminal gone?",
    errno.ENAMETOOLONG: "choose a shorter name",
    errno.EBADF: "let it lead to a terminal or a file; /dev/null drops what nobody needs",
    errno.EMFILE: "too many files are open: see `ulimit -n`",
}


def in_words(error: BaseException) -> KickctlError | None:
    """The words for what ended a command.

    Args:
        error: What was raised. Its notes, if it has any, say what was kept; see `mark_kept` too.

    Returns:
        What happened, as a KickctlError; None for what only a mistake in this program can raise.
    """
    failure = _failure(error)
    notes = getattr(error, "__notes__", [])
    if failure is not None:
        failure.kept = getattr(error, "kept", "")
    if isinstance(error, KickctlError):
        notes = [note for note in notes if note != error.hint]  # see KickctlError
    if failure is not None and notes:
        failure.hint = "\n  ".join([*filter(None, [failure.hint]), *notes])
    return failure


def _failure(error: BaseException) -> KickctlError | None:
    match error:
        case KickctlError():
            return error
        case KeyboardInterrupt():
            failure: KickctlError = Interrupted("interrupted")
        case OSError():
            failure = NotDone(os_words(error), _REMEDIES.get(error.errno or 0, ""))
        case UnicodeError():
            failure = WrongUse(
                f"there are letters that cannot be used here: {error}", "write it in plain letters"
            )
        case Exception() if _comes_of_interrupt(error):
            failure = Interrupted("interrupted")
        case ImportError():
            failure = NotDone(
                f"a library is missing or cannot be loaded: {error}",
                f"install it: {install_command()}",
            )
        case MemoryError():
            failure = NotDone("this computer does not have enough memory", "ask for less at a time")
        case _:
            return None
    return failure


def _comes_of_interrupt(error: BaseException | None) -> bool:
    """Whether a library has made another error of an interrupt, as some do as they are loaded."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__
    return error is not None


def os_words(error: OSError) -> str:
    """What the operating system has refused, and where."""
    reason = error.strerror or str(error)
    if error.filename is None:
        return f"the operating system refuses: {reason}"
    return f"{error.filename} cannot be written or read: {reason}"
