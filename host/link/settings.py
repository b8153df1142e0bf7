"""Parameters as a person writes them, NAME=VALUE."""

from host.errors import WrongUse, quotable


def number_or_text(text: str) -> float | str:
    """A whole number or a decimal fraction as a number, anything else as the text that it is.

    Python also takes 1_0 for a number, and digits of other scripts.
    """
    if not text.isascii() or "_" in text or text != text.strip():
        return text
    for convert in (int, float):
        try:
            return convert(text)
        except ValueError:
            pass
    return text


def parse_setting(text: str) -> tuple[str, float | str]:
    """(name, value) of 'NAME=VALUE'. Raises WrongUse if it is not of this form."""
    name, equals, value = text.partition("=")
    if not (name and equals and value):
        raise WrongUse(f"'{quotable(text)}' sets nothing", "write it as in k=2.5")
    return name, number_or_text(value)
