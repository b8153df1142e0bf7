"""What the page says to do next, when a robot has refused a command."""

import pytest

from host.errors import NotDone

COPY_IT = "copy the token file here: kickctl robots add anna URI --token FILE"


@pytest.fixture
def stopped(visit, station):
    """A page whose robot stands, and a function that has the robot refuse the next commands."""
    visitor = visit()
    visitor.page.keyboard.press("Escape")
    visitor.until("r.status.remedy === 'start' && s.stop.anna === 'confirmed'")

    def refuse(message, hint):
        def do(*_args, **_more):
            raise NotDone(message, hint)

        station._carry_out = do

    return visitor, refuse


def set_k(visitor):
    visitor.page.fill("#param-k", "7")
    visitor.page.keyboard.press("Enter")


def test_only_a_hint_at_the_remedy_becomes_its_button(stopped):
    visitor, refuse = stopped
    refuse("the robot stands", "start it first: kickctl start")
    set_k(visitor)
    visitor.reads(".notice.note", "The robot stands. Press its Start.")
    refuse("this token does not fit", COPY_IT)
    set_k(visitor)
    visitor.reads(".notice.note", f"This token does not fit. C{COPY_IT[1:]}.")


@pytest.mark.parametrize("hint", [COPY_IT, "mend it, then: kickctl start"])
def test_who_has_pressed_start_is_not_told_to_press_start(stopped, hint):
    visitor, refuse = stopped
    refuse("it does not start", hint)
    visitor.page.click("#now .remedy")
    visitor.reads(".notice.note", f"It does not start. {hint[0].upper()}{hint[1:]}.")


@pytest.mark.usefixtures("other_program")
def test_who_may_not_drive_is_told_the_buttons_of_the_page(visit):
    visitor = visit()
    visitor.until("r.status.controller === 'bert' && !r.status.here")
    set_k(visitor)
    visitor.reads(".notice.note", "Take over from bert")
    said = visitor.page.inner_text(".notice.note p")
    assert said.endswith("Anyone may stop the robot: press STOP.")
    assert "--take-over" not in said
    assert "kickctl" not in said
    assert visitor.page.is_visible("#state >> text='Take over from bert'")
