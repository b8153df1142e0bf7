"""The report of a reproduction: one HTML file with the claims and the figures inside."""

from __future__ import annotations

import base64
import errno
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from host.runs.claims import FAILS, HOLDS, UNDECIDED, Claim
from host.runs.presets import ABOUT
from host.util.whole_files import write_text

_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 75rem; margin: 2rem auto; }
body { padding: 0 1rem; color: #222; }
table { border-collapse: collapse; width: 100%; }
th, td { text-align: left; vertical-align: top; }
th, td { padding: 0.4rem 0.8rem 0.4rem 0; border-bottom: 1px solid #ccc; }
.holds { color: #00694d; font-weight: bold; }
.fails { color: #b04000; font-weight: bold; }
.undecided { color: #666; }
img { max-width: 100%; }
dt { font-weight: bold; }
"""

_TITLE = "Kick control: the paper's claims, measured"
# The style of each verdict.
_CLASSES = {HOLDS: "holds", FAILS: "fails", UNDECIDED: "undecided"}


def write(
    path: Path,
    claims: Sequence[Claim],
    at_preset: Mapping[str, Claim],
    summaries: Sequence[dict[str, Any]],
    skipped: dict[str, str],
) -> Path:
    """Write the report.

    Args:
        path: The file to write.
        claims: The claims that were measured.
        at_preset: Some of them once more, by their ids, in the setting `paper`.
        summaries: The summaries of experiments and studies, as host.perform.run returns them.
        skipped: Why a claim was not measured, by its id.

    Returns:
        The path.

    Raises:
        FileExistsError: There is another file of this name, which is no report.
        OSError: The report cannot be written.
    """
    if path.is_file() and _TITLE.encode() not in path.read_bytes()[:500]:
        raise FileExistsError(
            errno.EEXIST, "it is there already, and no report of kickctl", str(path)
        )
    first = summaries[0] if summaries else {"seed": "none", "version": ""}
    robots = sorted({summary["brick"] for summary in summaries if "brick" in summary})
    facts = {
        "robot": ", ".join(robots) or "none",
        "seed": first["seed"],
        "kickctl": first["version"],
    }
    body = "".join(
        f"<dt>{escape(name)}</dt><dd>{escape(str(value))}</dd>" for name, value in facts.items()
    )
    parts = [
        (
            '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
            f"<title>{_TITLE}</title>\n"
        ),
        (f"<style>{_STYLE}</style>\n</head>\n<body>\n<h1>{_TITLE}</h1>\n"),
        (
            "<p>Claims of S&aacute;ndor et al., <i>Kick control: using the attracting states"
            " arising within the sensorimotor loop of"
        ),
        " self-organized robots as motor primitives</i>, Front. Neurorobot. 12:40 (2018).",
        " Intervals hold with a confidence of 95&nbsp;%.</p>\n",
        f"<dl>{body}</dl>\n{_table(claims, at_preset, skipped)}",
        *(_experiment(summary) for summary in summaries),
        "</body>\n</html>\n",
    ]
    write_text(path, "".join(parts))
    return path


def _table(claims: Sequence[Claim], at_preset: Mapping[str, Claim], skipped: dict[str, str]) -> str:
    rows = [
        _row(
            escape(claim.id),
            escape(claim.claim),
            escape(claim.paper),
            _measured(claim),
            _measured(at_preset[claim.id]) if claim.id in at_preset else "",
            escape(claim.note),
        )
        for claim in claims
    ]
    rows += [
        _row(escape(number), "", "", "not measured", "", escape(reason))
        for number, reason in skipped.items()
    ]
    names = ("", "claim", "asked for", "measured", "in the setting 'paper'", "note")
    head = "".join(f"<th>{name}</th>" for name in names)
    about = f"<p>{escape(ABOUT)}</p>\n" if at_preset else ""
    return f"<table>\n<tr>{head}</tr>\n{''.join(rows)}</table>\n{about}"


def _measured(claim: Claim) -> str:
    """The number and the verdict, as HTML."""
    return (
        f'{escape(claim.number())} <span class="{_CLASSES[claim.verdict]}">{claim.verdict}</span>'
    )


def _row(*cells: str) -> str:
    """A row of the table, from HTML."""
    return "<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>\n"


def _experiment(summary: dict[str, Any]) -> str:
    name = escape(summary["experiment"])
    options = ", ".join(f"{key} {value}" for key, value in summary["options"].items())
    spoiled = f"; {len(summary['spoiled'])} tries did not count" if summary["spoiled"] else ""
    return (
        f"<h2>{name}</h2>\n<p>{summary['trials']} rows ({escape(options)}){spoiled}; table, logs"
        " and summary in"
        f" <code>{escape(summary['folder'])}</code></p>\n"
        f"{_figure(name, summary)}\n"
    )


def _figure(name: str, summary: dict[str, Any]) -> str:
    if not summary["figures"]:
        return f"<p>{escape(summary['unwritten']['figure'])}</p>"
    picture = base64.b64encode(Path(summary["figures"][0]).read_bytes()).decode()
    return f'<img alt="figure of {name}" src="data:image/png;base64,{picture}">'
