"""Every public name has an example in its docstring, and the examples show what they say."""

import doctest
import functools

import pytest

import kickctl
from kickctl import theory

PUBLIC = {name: getattr(module, name) for module in (kickctl, theory) for name in module.__all__}
# Three names show the same branches, which take seconds.
NAMES = {**PUBLIC, "branch": functools.cache(theory.branch)}
SHOWN_AS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


@pytest.mark.parametrize(
    "names", [kickctl.__all__, theory.__all__], ids=["kickctl", "kickctl.theory"]
)
def test_every_public_name_has_an_example_that_runs(names):
    runner = doctest.DocTestRunner(verbose=False, optionflags=SHOWN_AS)
    finder = doctest.DocTestFinder(recurse=False, exclude_empty=False)
    without = []
    for name in names:
        (found,) = finder.find(PUBLIC[name], name, module=False, globs=NAMES)
        without += [] if found.examples else [name]
        runner.run(found)
    assert without == []
    assert runner.summarize(verbose=False).failed == 0
