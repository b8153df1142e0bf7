"""What a figure says about its run: in its corner, and in the data about its file.

The corner has the parameters that the run really had: those that it swept or varied are on an axis
or beside a curve, and not here.
"""

from __future__ import annotations

from collections.abc import Mapping
from shlex import join
from typing import Any, NamedTuple

from host.link.addresses import SIM, sim_options
from host.runs.presets import OPTION, ORDINARY
from host.runs.registry import Entry
from host.runs.robot_options import options_of
from robot import __version__

# The words of each parameter, by its name as an option.
_WORDS = {
    "a": "a = {}",
    "tau": "τ = {} s",
    "k": "k = {}",
    "f": "f = {} s",
    "I": "I = {} s²",
    "rods": "rods: {}",
    "bounded": "M_max = {}",
    "tick": "tick {} s",
    "latency": "latency {} s",
    "rod_lag_s": "rods {} s older",
    "dry": "dry friction {}",
    "noise": "D_M = {} √s",
    "angle_noise": "D_φ = {} rad/√s",
}
# What is not worth a word, as all runs have it unless somebody changes it.
_ORDINARY = {"rods": 2, "rod_lag_s": 0.0, "angle_noise": 0.0, "latency": 0.0}
# The names of command, parameters, release and date in files of each format; a PNG has no date.
_METADATA = {
    "png": ("Title", "Description", "Software", ""),
    "svg": ("Title", "Description", "Creator", "Date"),
    "pdf": ("Title", "Subject", "Creator", "CreationDate"),
}


class Caption(NamedTuple):
    """What a figure says about its run.

    Attributes:
        parameters: For the corner, in words.
        command: The command that draws the same figure.
    """

    parameters: str
    command: str

    def metadata(self, ending: str) -> dict[str, str | None]:
        """The data about a file of this format, without dates: the same drawing is the same file.

        Args:
            ending: The format, such as png.
        """
        release = f"kickctl {__version__}"
        title, words, maker, date = _METADATA[ending]
        return {
            **({title: self.command, words: self.parameters} if self.command else {}),
            maker: release,
            **({date: None} if date else {}),
        }


def in_words(parameters: Mapping[str, Any]) -> str:
    """Parameters for a figure's corner.

    Args:
        parameters: By the names of options, as numbers or words; None for one that varies. What is
            no parameter of a wheel or robot is left out.
    """
    return "   ".join(
        words.format(value if isinstance(value := parameters[name], str) else f"{value:g}")
        for name, words in _WORDS.items()
        if parameters.get(name) is not None and parameters[name] != _ORDINARY.get(name)
    )


def of_run(
    verb: str,
    entry: Entry,
    settings: Mapping[str, Any],
    parameters: Mapping[str, Any],
    panel: str | None = None,
) -> Caption:
    """The caption of a run.

    Args:
        verb: Of the command: experiment or theory.
        entry: The options that the run could have.
        settings: As in the run's settings.json.
        parameters: As `in_words` takes them.
        panel: The one panel that is drawn; None for all.
    """
    options, uri = settings["options"], settings.get("brick")
    words = [in_words(parameters), f"seed {settings['seed']}"]
    if options.get(OPTION.name, ORDINARY) != ORDINARY:
        words.append(f"preset {options[OPTION.name]}")
    if uri is not None:
        simulated = sim_options(uri)
        words += (
            [f"robot {uri}"]
            if simulated is None
            else [f"{name} {value}" for name, value in simulated.items() if name != "seed"]
        )
    command = _command(verb, entry, settings)
    if panel is not None:
        command += ["--panel", panel]
    return Caption("   ".join(filter(None, words)), join(command))


def of_log(params: Mapping[str, Any], info: Mapping[str, Any], command: str) -> Caption:
    """The caption of a robot's log.

    Args:
        params: The robot's parameters that stayed the same, by its names for them.
        info: What was run, as the log has it.
        command: The command that draws the same figure, or the figure's title.
    """
    words = [in_words({**params, **options_of(params)})]
    if info.get("seed") is not None:
        words.append(f"seed {info['seed']}")
    if "brick" in info:
        words.append(f"robot {info['brick']}")
    return Caption("   ".join(filter(None, words)), command)


def _command(verb: str, entry: Entry, settings: Mapping[str, Any]) -> list[str]:
    words = ["kickctl", verb, settings["experiment"]]
    for option in entry.options:
        value = settings["options"][option.name]
        if value != option.default:
            values = value if isinstance(value, list) else [value]
            words += [f"--{option.name.replace('_', '-')}", ",".join(map(str, values))]
    words += ["--seed", str(settings["seed"])]
    if settings.get("brick", SIM) != SIM:
        words += ["--brick", settings["brick"]]
    return words
