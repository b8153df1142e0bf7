"""Logs for programs and notebooks: all that host.logs.log has, and a way to look at them."""

from __future__ import annotations

from math import inf

from host.logs import log as logs
from host.util.arguments import need_seconds
from host.util.extras import need


class Log(logs.Log):  # noqa: D101 - the doc of that one is the promise
    __doc__ = logs.Log.__doc__

    def show(self, from_s: float = 0.0, to_s: float = inf) -> None:
        """Show the log in a notebook: wheels, phase plane and strips, with a slider and a player.

        They are drawn from the log's own records. It takes the extra `notebook`.

        Args:
            from_s: From when (s since the log's first record).
            to_s: Until when (s), by default to its end.

        Raises:
            WrongUse: This is no notebook, anywidget is not installed, or this part of the log has
                no tick or more than 20,000.
        """
        need("anywidget", "notebook")
        from host.lab.tape import Cut
        from host.lab.widgets import show_log

        show_log(self, Cut(need_seconds("from_s", from_s), need_seconds("to_s", to_s)))
