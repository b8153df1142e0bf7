"""The folders in which a user's own files belong."""

import os


def config_folder():
    """The folder for settings.

    Returns:
        The path of kickctl's folder in $XDG_CONFIG_HOME or ~/.config; empty if this user has no
        home folder, as in some containers.
    """
    return _folder("XDG_CONFIG_HOME", ".config")


def cache_folder():
    """The folder for files that spare work, and that may be deleted.

    Returns:
        The path of kickctl's folder in $XDG_CACHE_HOME or ~/.cache; empty if this user has no home
        folder.
    """
    return _folder("XDG_CACHE_HOME", ".cache")


def _folder(variable, name):
    # Without a home folder "~" stays, and a folder of that name must not appear.
    place = _expand(os.environ.get(variable) or "")
    if not os.path.isabs(place):
        place = os.path.join(_expand("~"), name)
    return os.path.join(place, "kickctl") if os.path.isabs(place) else ""


def _expand(path):
    try:
        return os.path.expanduser(path)
    except KeyError:  # Python 3.5 says so of a user that the system does not know
        return path
