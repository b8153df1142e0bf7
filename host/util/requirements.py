"""What kickctl's own metadata says that it needs, and which of that is missing here."""

from __future__ import annotations

from importlib import metadata

PACKAGE = "kickctl"


def extras() -> list[str]:
    """Names of the package's extras.

    Raises:
        metadata.PackageNotFoundError: kickctl is not installed, but run from its folder.
    """
    return metadata.metadata(PACKAGE).get_all("Provides-Extra") or []


def missing(extra: str = "") -> list[str]:
    """Requirements that are not installed, or not in a version that fits, in pip's notation.

    Args:
        extra: Look at the requirements of this extra; without it, at those that kickctl always has.

    Raises:
        metadata.PackageNotFoundError: kickctl is not installed, but run from its folder.
        ImportError: The library that reads requirements is missing itself.
    """
    always = set() if not extra else _unmet(PACKAGE, "", set())
    return sorted(_unmet(PACKAGE, extra, set()) - always)


def _unmet(package: str, extra: str, seen: set[tuple[str, str]]) -> set[str]:
    """The requirements of an installed package, and of what it requires, that are not met."""
    from packaging.requirements import Requirement

    seen.add((package, extra))
    unmet = set()
    for requirement in map(Requirement, metadata.requires(package) or ()):
        if requirement.marker and not requirement.marker.evaluate({"extra": extra}):
            continue
        name = f"{requirement.name}{requirement.specifier}"
        try:
            fits = requirement.specifier.contains(metadata.version(requirement.name), True)
        except metadata.PackageNotFoundError:
            fits = False
        if not fits:
            unmet.add(name)
            continue
        for wanted in ("", *requirement.extras):
            if (requirement.name, wanted) not in seen:
                unmet |= _unmet(requirement.name, wanted, seen)
    return unmet
