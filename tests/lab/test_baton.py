"""How the baton goes from page to page, without sockets."""

from tests.lab.test_session import KICK


def test_the_driver_gives_the_baton_to_who_asks_and_the_teacher_takes_it_back(lab):
    teacher, pupil = lab.driver(), lab.viewer()
    teacher.send("ask", request=1)
    assert teacher.drives
    assert teacher.latest("baton")["why"] == ""  # that it drives is all there is to say
    assert "does not ask" in teacher.ask("give", page=2)["error"]["message"]
    pupil.send("ask", request=1)
    assert teacher.latest("baton")["asking"] == [2]
    assert "result" in teacher.ask("give", page=2)
    assert (teacher.drives, pupil.drives) == (False, True)
    pupil.send("do", request=2, **KICK)
    assert lab.anna.take()
    teacher.send("take", request=3)
    assert (teacher.drives, pupil.drives) == (True, False)
    assert "taken the baton from page 2" in pupil.latest("baton")["why"]


def test_who_has_the_drive_key_hands_on_a_baton_that_is_free_or_another_pages(lab):
    teacher, one, two = lab.driver(), lab.viewer(), lab.viewer()
    one.send("ask", request=1)
    two.send("ask", request=1)
    assert teacher.latest("baton")["asking"] == [2, 3]
    assert "drive key" in one.ask("give", page=2)["error"]["hint"]
    assert "result" in teacher.ask("give", page=2)
    assert one.drives
    assert "drive key" in two.ask("give", page=3)["error"]["hint"]
    assert "result" in teacher.ask("give", page=3)
    assert (one.drives, two.drives) == (False, True)
    assert two.latest("baton")["asking"] == []
