"""What is checked before a run begins."""

import pytest

from host.errors import NotDone
from host.perform.run import perform


def test_no_run_begins_after_a_source_has_changed(tmp_path, monkeypatch):
    """As in a long `reproduce`: what it loads next would be kept as results of the old code."""
    monkeypatch.setattr("host.util.provenance.fingerprint", lambda *_: "of changed sources")
    with pytest.raises(NotDone, match="have changed since"):
        perform("hopf", out=tmp_path)
    assert not list(tmp_path.iterdir())
