"""The theme of the lab's drawings: legible on light and dark ground, and from the last row."""

import pytest

from tests.web.drawings import open_page

# What is also read, besides the graphics that it colours. See the drawings.
READ = {"ink", "faint", "kick", "force", "target", "left1", "right1"}
MINUS, DASH = "\N{MINUS SIGN}", "\N{EN DASH}"
DECORATION = {"paper", "grid", "rim", "band"}


@pytest.fixture(scope="module")
def page(browser):
    """A page that has the drawings."""
    page = open_page(browser)
    page.evaluate("draw('floor', {}, { width: 100, height: 100 })")
    page.evaluate("async () => { window.themes = await import('/theme.js') }")
    yield page
    page.close()


def _theme(page, *, dark=False, scale=1, height=720, projector=False):
    make = "([media, projector]) => JSON.parse(JSON.stringify(themes.theme(media, projector)))"
    return page.evaluate(make, [{"dark": dark, "scale": scale, "height": height}, projector])


def _luminance(colour):
    """Relative luminance of #rrggbb, as WCAG 2.2 defines it."""
    parts = (int(colour[at : at + 2], 16) / 255 for at in (1, 3, 5))
    linear = [
        part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts
    ]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one, other):
    """The contrast ratio of two colours, 1 to 21."""
    dark, light = sorted([_luminance(one), _luminance(other)])
    return (light + 0.05) / (dark + 0.05)


def test_black_on_white_has_the_greatest_contrast():
    assert contrast("#000000", "#ffffff") == pytest.approx(21)
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.01)


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("palette", ["colours", "grey"])
def test_colours_stand_out_from_the_paper(page, dark, palette):
    colours = _theme(page, dark=dark)[palette]
    weak = {
        name: ratio
        for name, colour in colours.items()
        if name not in DECORATION
        and (ratio := contrast(colour, colours["paper"])) < (4.5 if name in READ else 3.0)
    }
    assert not weak
    assert set(colours) > READ | DECORATION


@pytest.mark.parametrize("dark", [False, True])
def test_marks_stand_out_from_the_wheel_that_they_lie_on(page, dark):
    colours = _theme(page, dark=dark)["colours"]
    for mark in ("ink", "actual", "memory", "force"):
        assert contrast(colours[mark], colours["rim"]) >= 3.0, mark


def test_both_grounds_have_the_same_names(page):
    assert set(_theme(page)["colours"]) == set(_theme(page, dark=True)["colours"])


@pytest.mark.parametrize("height", [720, 1080, 2160])
def test_a_projected_text_is_a_fortieth_of_the_screen(page, height):
    assert _theme(page, height=height, projector=True)["text"] >= height / 40
    assert 12 <= _theme(page, height=height)["text"] <= 16


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_ground_follows_the_system_unless_a_person_chooses(page, scheme):
    page.emulate_media(color_scheme=scheme)
    assert page.evaluate("themes.media(window).dark") == (scheme == "dark")
    assert page.evaluate("themes.media(window, 'dark').dark") is True
    assert page.evaluate("themes.media(window, 'light').dark") is False


@pytest.mark.parametrize(
    ("low", "high", "most", "expected"),
    [(-1, 1, 4, [-1, -0.5, 0, 0.5, 1]), (0, 8, 4, [0, 2, 4, 6, 8]), (1, 1, 4, [])],
)
def test_ticks_are_round_numbers(page, low, high, most, expected):
    ask = "([low, high, most]) => themes.theme({}, false).ticks(low, high, most)"
    assert page.evaluate(ask, [low, high, most]) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("value", "digits", "expected"),
    [(1.26, 1, "+1.3"), (-1.26, 1, MINUS + "1.3"), (-0.04, 1, "0.0"), (float("nan"), 1, DASH)],
)
def test_numbers_have_a_sign_unless_they_are_nothing(page, value, digits, expected):
    ask = "([value, digits]) => themes.theme({}, false).number(value, digits, true)"
    assert page.evaluate(ask, [value, digits]) == expected
