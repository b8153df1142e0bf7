"""A fingerprint of source files: it says which code computed a result, or is installed."""

import os

from robot.bare import sha256

# Beside Python: tables of constants, and MuJoCo's scenes.
KINDS = (".py", ".toml", ".xml")
_FOLDER = os.path.dirname(os.path.abspath(__file__))
_KEPT = os.path.join(_FOLDER, "__pycache__", "fingerprint")


def fingerprint(*folders):
    """The fingerprint of all sources below some folders or in some files.

    Args:
        folders: Paths of folders and files. Where they lie on this machine does not matter: a
            checkout and an installed package with the same files have the same fingerprint.

    Returns:
        The first 16 hexadecimal digits of a SHA-256.

    Raises:
        OSError: A file cannot be read.
    """
    digest = sha256()
    for folder in folders:
        for name, path in _sources(folder):
            with open(path, "rb") as file:
                content = file.read()
            digest.update("{}\0{}\0".format(name, len(content)).encode("utf-8"))
            digest.update(content)
    return digest.hexdigest()[:16]


def of_robot():
    """The fingerprint of the robot's program, which is the folder of this file.

    Returns:
        16 hexadecimal digits, the same on the robot and on a host that has the same release.

    Raises:
        OSError: A file cannot be read.
    """
    try:
        with open(_KEPT, "r", encoding="ascii") as file:
            kept, state = file.read().split("\n", 1)
        if state == times(_FOLDER):
            return kept
    except (OSError, ValueError):
        pass
    return fingerprint(_FOLDER)


def keep():
    """Keep the fingerprint of the robot's program: it takes a brick 0.7 s at each start.

    It holds, as Python's own byte code, until the size or the time of a source changes.

    Raises:
        OSError: A file cannot be read or written.
    """
    os.makedirs(os.path.dirname(_KEPT), exist_ok=True)
    with open(_KEPT, "w", encoding="ascii") as file:
        file.write("{}\n{}".format(fingerprint(_FOLDER), times(_FOLDER)))


def times(*folders):
    """Name, size and time of change of all sources below some folders or in some files.

    While they are the same, so is the fingerprint; and they take a fifth of its time.

    Args:
        folders: Paths of folders and files, as for `fingerprint`.

    Returns:
        A line for each source.

    Raises:
        OSError: A file cannot be read.
    """
    files = [(name, os.stat(path)) for folder in folders for name, path in _sources(folder)]
    return "\n".join("{} {} {}".format(name, it.st_size, it.st_mtime_ns) for name, it in files)


def _sources(folder):
    """(name, path) of every source file below a folder, in order.

    The name begins with the folder's own. Hidden files are no sources, for nothing can import them:
    an editor's lock, which may lead nowhere, or an older copy of a source.
    """
    folder = os.path.abspath(folder)
    above = len(os.path.join(os.path.dirname(folder), ""))
    if os.path.isfile(folder):
        return [(folder[above:], folder)]
    paths = [
        os.path.join(place, name)
        for place, _, names in os.walk(folder)
        for name in names
        if name.endswith(KINDS)
    ]
    named = sorted((path[above:].replace(os.sep, "/"), path) for path in paths)
    return [(name, path) for name, path in named if "/." not in name]
