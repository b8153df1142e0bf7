"""The option --motor of the verbs that plan kicks."""

import argparse


def add_motor(parser: argparse.ArgumentParser) -> None:
    """Add --motor."""
    parser.add_argument(
        "--motor",
        metavar="NAME",
        help="plan with this entry of a motors file; by default with that of the motor which the"
        " robot says it has",
    )
