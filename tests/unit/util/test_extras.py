"""Libraries of extras: what their loading does."""

import signal
import sys

import pytest

from host.util.extras import need


@pytest.mark.parametrize("otherwise", ["raise ImportError('initialization failed')", "pass"])
def test_an_interrupt_while_a_library_loads_is_an_interrupt(tmp_path, monkeypatch, otherwise):
    """MuJoCo makes an ImportError of it, or loses it."""
    (tmp_path / "interrupted_library.py").write_text(
        "import signal\n"
        "try:\n"
        "    signal.raise_signal(signal.SIGINT)\n"
        "except KeyboardInterrupt:\n"
        f"    {otherwise}\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "interrupted_library", raising=False)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            need("interrupted_library", "bodies")
    finally:
        signal.signal(signal.SIGINT, before)
        sys.modules.pop("interrupted_library", None)
