"""robot.show() and log.show() in a real JupyterLab, as a person uses them."""

import pytest

import kickctl
from robot.record import STATES
from tests.link.machines import TcpRobot
from tests.web.jupyter import Notebook, jupyter_lab

CELLS = (
    'from kickctl import connect\nrobot = connect("tcp://127.0.0.1:{port}", observe=True)',
    "robot.show()",
    'print("waits")\nrobot.wait(600)',
    """\
with connect("sim://?seed=1") as embedded:
    embedded.show()
    with embedded.recording() as log:
        embedded.wait(3)
        embedded.kick_and_watch("phase", ticks=4)""",
    "log.show()",
    """\
import threading, time
while (count := [t.name for t in threading.enumerate()].count("kickctl notebook")) > 2:
    time.sleep(0.1)
print("showing", count, "robots")""",
)
ROBOT, BUSY, EMBEDDED, LOG, COUNT = 1, 2, 3, 4, 5


@pytest.fixture(scope="module")
def program():
    """A robot in real time."""
    program = TcpRobot(tick_s=0.03)
    yield program
    program.close()


@pytest.fixture
def robot(program):
    """The same robot, and it runs."""
    if STATES[program.loop.safety.state] != "running":
        program.loop.start()
    return program


@pytest.fixture(scope="module")
def jupyter(program, tmp_path_factory):
    """The address of a notebook in a JupyterLab of its own."""
    cells = [source.replace("{port}", str(program.port)) for source in CELLS]
    with jupyter_lab(tmp_path_factory.mktemp("jupyter"), cells) as url:
        yield url


@pytest.fixture(scope="module")
def notebook(browser, jupyter):
    """The notebook, with its robot connected. It must not complain."""
    notebook = Notebook(browser, jupyter)
    notebook.run(0)
    notebook.ended(0)
    yield notebook
    assert notebook.complaints == []


def test_stop_stops_the_robot_at_once_while_python_is_busy(notebook, robot):
    notebook.run(ROBOT)
    notebook.run(BUSY)
    notebook.prints(BUSY, "waits")  # or the interrupt comes before the cell begins, and is lost
    before = notebook.until(ROBOT, "s.records > 3 && s.state === 'running'")
    after = notebook.until(ROBOT, f"s.shown_s > {before['shown_s']} + 0.2")
    assert after["wheels"]["left"]["phi_rad"] > before["wheels"]["left"]["phi_rad"]
    notebook.cell(ROBOT).locator(".stop").click()
    after = notebook.until(ROBOT, "s.state === 'stopped' && s.stop.startsWith('Motors stopped')")
    assert "stopped it from" not in notebook.cell(ROBOT).inner_text()  # it was this picture
    assert STATES[robot.loop.safety.state] == "stopped"
    assert notebook.busy(BUSY)
    assert (after["missed"], after["lost"]) == (0, False)
    notebook.command("kernelmenu:interrupt")
    notebook.ended(BUSY)


def test_escape_stops_it_only_where_the_focus_is_in_the_widget(notebook, robot):
    notebook.need(ROBOT)
    # The widget was there before this cell has run.
    notebook.run(BUSY)
    notebook.prints(BUSY, "waits")  # or the interrupt comes before the cell begins, and is lost
    notebook.until(ROBOT, "s.state === 'running' && s.stop === ''")
    notebook.page.locator(".jp-Cell >> nth=0 >> .cm-content").click()
    notebook.page.keyboard.press("Escape")
    assert notebook.state(ROBOT)["state"] == "running"
    assert notebook.state(ROBOT)["stop"] == ""
    # Sent to the button itself: JupyterLab moves the focus to a cell when it comes to it.
    escape = {"key": "Escape", "bubbles": True, "cancelable": True}
    notebook.cell(ROBOT).locator(".stop").dispatch_event("keydown", escape)
    notebook.until(ROBOT, "s.state === 'stopped'")
    assert STATES[robot.loop.safety.state] == "stopped"
    assert notebook.busy(BUSY)
    notebook.command("kernelmenu:interrupt")
    notebook.ended(BUSY)


def test_an_embedded_robots_seconds_are_shown_as_seconds_also_after_its_end(notebook):
    notebook.run(EMBEDDED)
    begin = notebook.until(EMBEDDED, "s.records > 100 && s.shown_s < s.record.t_s - 1")
    assert begin["wheels"]["left"]["torque"] > 0.5
    end = notebook.until(EMBEDDED, "s.shown_s === s.record.t_s")
    assert end["wheels"]["left"]["torque"] < -0.5
    assert end["lost"]
    assert "connection to the robot is closed" in notebook.cell(EMBEDDED).inner_text()


def test_a_logs_slider_shows_the_ticks_own_numbers(notebook):
    notebook.need(EMBEDDED)
    notebook.run(LOG)
    notebook.until(LOG, "s.ticks > 0")
    with kickctl.connect("sim://?seed=1") as embedded, embedded.recording() as log:
        embedded.wait(3)
        embedded.kick_and_watch("phase", ticks=4)
    slider = notebook.cell(LOG).locator("input[type=range]")
    kicked = next(n for n, record in enumerate(log.records) if record.kick)
    slider.fill(str(kicked))
    state = notebook.until(LOG, f"s.place === {kicked} && s.wheels.left.kick === 'Phase'")
    assert state["ticks"] == pytest.approx(len(log), abs=3)  # asking for its state takes a tick
    for key in ("d", "d", "ArrowRight"):  # JupyterLab would delete the cell
        slider.press(key)
    notebook.until(LOG, f"s.place === {kicked + 1}")
    play = notebook.cell(LOG).locator("button.record")
    play.click()
    notebook.until(LOG, f"s.playing && s.place > {kicked + 3}")
    play.click()
    notebook.until(LOG, "!s.playing")


def test_a_cell_that_runs_again_leaves_nothing_behind(notebook):
    notebook.need(EMBEDDED)
    for _ in range(2):
        notebook.run(ROBOT)
        notebook.until(ROBOT, "s.records > 0")

    notebook.run(COUNT)
    notebook.ended(COUNT)
    # The one of this cell, and the embedded robot's.
    assert notebook.words(COUNT).strip() == "showing 2 robots"
