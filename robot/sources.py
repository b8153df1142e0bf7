"""A fingerprint of source files: it says which code computed a result, or is installed."""

import hashlib
import os

# Beside Python: tables of constants, and MuJoCo's scenes.
KINDS = (".py", ".toml", ".xml")


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
    digest = hashlib.sha256()
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
    return fingerprint(os.path.dirname(os.path.abspath(__file__)))


def _sources(folder):
    """(name, path) of every source file below a folder, in order.

    The name begins with the folder's own.
    """
    parent = os.path.dirname(os.path.abspath(folder))
    if os.path.isfile(folder):
        return [(os.path.basename(folder), folder)]
    paths = [
        os.path.join(place, name)
        for place, _, names in os.walk(os.path.abspath(folder))
        for name in names
        if name.endswith(KINDS)
    ]
    return sorted((os.path.relpath(path, parent).replace(os.sep, "/"), path) for path in paths)
