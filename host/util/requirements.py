"""What kickctl's own metadata says that it needs, and which of that is missing here."""

from __future__ import annotations

from importlib import metadata
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from packaging.requirements import Requirement

PACKAGE = "kickctl"


def extras() -> list[str]:
    """Names of the package's extras.

    Raises:
        metadata.PackageNotFoundError: kickctl is not installed, but run from its folder.
    """
    return metadata.metadata(PACKAGE).get_all("Provides-Extra") or []


def missing() -> dict[str, list[str]]:
    """Requirements that are not installed, or not in a version that fits, in pip's notation.

    Returns:
        Those that kickctl always has, by "", and what each extra adds to them, by its name.

    Raises:
        metadata.PackageNotFoundError: kickctl is not installed, but run from its folder.
        ImportError: The library that reads requirements is missing itself.
    """
    packages = _Packages()
    always = _unmet(PACKAGE, "", packages, set())
    more = {extra: _unmet(PACKAGE, extra, packages, set()) - always for extra in extras()}
    return {name: sorted(unmet) for name, unmet in {"": always, **more}.items()}


class _Packages(dict[str, tuple[str, list["Requirement"]]]):
    """Version and requirements of packages by name. Each is read once, which takes some ms."""

    def __missing__(self, name: str) -> tuple[str, list[Requirement]]:
        from packaging.requirements import Requirement

        found = metadata.distribution(name)
        self[name] = found.version, [Requirement(text) for text in found.requires or ()]
        return self[name]


def _unmet(package: str, extra: str, packages: _Packages, seen: set[tuple[str, str]]) -> set[str]:
    """The requirements of an installed package, and of what it requires, that are not met."""
    seen.add((package, extra))
    unmet = set()
    for requirement in packages[package][1]:
        if requirement.marker and not requirement.marker.evaluate({"extra": extra}):
            continue
        try:
            fits = requirement.specifier.contains(packages[requirement.name][0], True)
        except metadata.PackageNotFoundError:
            fits = False
        if not fits:
            unmet.add(f"{requirement.name}{requirement.specifier}")
            continue
        for wanted in ("", *requirement.extras):
            if (requirement.name, wanted) not in seen:
                unmet |= _unmet(requirement.name, wanted, packages, seen)
    return unmet
