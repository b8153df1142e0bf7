"""A class: the teacher shows the address, asks, and kicks; pupils answer before it."""


def test_a_class_answers_before_the_kick_and_is_counted_after_it(visit, lab, station):
    teacher, pupil = visit(), visit(lab.view_url, viewport={"width": 360, "height": 640})
    teacher.page.click("#class-switch")
    teacher.page.click("text=Show the address")
    teacher.page.wait_for_selector(".qr svg path[stroke]")
    teacher.reads(".address", lab.view_url)
    teacher.reads(".shown", "Only this computer")
    assert pupil.page.is_hidden("#class")
    assert pupil.page.is_hidden("#class-switch")

    teacher.page.click("#class >> text=Phase kick")
    pupil.reads(".question", "a phase kick, 4 ticks, of both wheels?")
    pupil.page.click("#answer-0")
    teacher.reads("#class", "1 of 1 page has answered")
    assert teacher.page.is_hidden(".bars")
    assert pupil.state()["poll"]["counts"] is None
    teacher.page.reload()  # for a second nobody drives; the class is still the teacher's
    teacher.page.click("text=Kick now")
    pupil.until("s.poll.state === 'locked'")
    pupil.reads(".bars", "1 of 1 say: reverse")
    pupil.page.wait_for_selector("#class .choices", state="hidden")
    station.step(2.5)
    teacher.reads("#class", "Left wheel reversed, right wheel reversed.")
    pupil.reads(".bars", "✓ right")
    pupil.reads("#class", "Your answer: reverse. Correct.")
    teacher.reads("#class", "the majority in 1 of 1 kick")
    teacher.page.click("text=End the question")
    pupil.page.wait_for_selector("#class", state="hidden")

    pupil.page.click("text=Ask to drive")  # a pupil who drives is asked no more, and asks nobody
    number = pupil.state()["page"]
    pupil.reads("#notices", f"You have asked to drive, as page {number}.")
    pupil.reads("#baton", f"This is page {number}.")
    teacher.page.click(f"text=Let page {number} drive")
    pupil.until("s.baton.you")
    assert pupil.page.is_hidden("#class-switch")
    teacher.page.click("#class-switch")
    teacher.page.click("#class >> text=Membrane kick")
    pupil.page.wait_for_selector("text=Kick now")
    assert pupil.page.is_hidden("#class .choices")
    assert pupil.page.is_hidden("text=End the question")
    assert teacher.page.is_hidden("text=Kick now")
    pupil.page.click("text=Kick now")
    teacher.until("s.poll.state === 'locked'")
