"""robot.show() and log.show() in a real JupyterLab, as a person uses them."""

import json
import os
import socket
import subprocess
import sys
from contextlib import closing

import pytest

import kickctl
from robot.record import STATES
from tests.link.machines import TcpRobot
from tests.lint.sources import ROOT
from tests.live import wait_until

CELLS = (
    'from kickctl import connect\nrobot = connect("tcp://127.0.0.1:{port}", observe=True)',
    "robot.show()",
    "robot.wait(600)",
    """\
with connect("sim://?seed=1") as embedded:
    embedded.show()
    with embedded.recording() as log:
        embedded.wait(3)
        embedded.kick_and_watch("phase", ticks=4)""",
    "log.show()",
    """\
import threading
print("showing", [t.name for t in threading.enumerate()].count("kickctl notebook"), "robots")""",
)
ROBOT, BUSY, EMBEDDED, LOG, COUNT = 1, 2, 3, 4, 5
# What a page without a terminal says by itself.
HARMLESS = "Disabling terminals plugin"


class Notebook:
    """A notebook in a browser's JupyterLab.

    Attributes:
        page: The page, of playwright.
    """

    def __init__(self, browser, url):
        self.complaints = []
        self.page = browser.new_page(viewport={"width": 1280, "height": 1000})
        self.page.on("console", self._hear)
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.goto(url)
        self._until("window.jupyterapp?.shell.currentWidget?.sessionContext?.session?.kernel")
        self._until("window.jupyterapp.shell.currentWidget.content?.widgets.length > 1")

    def _hear(self, message):
        if message.type in ("error", "warning") and not message.text.startswith(HARMLESS):
            self.complaints.append(f"{message.text} {message.location['url']}")

    def _until(self, expression, **values):
        self.page.wait_for_function(expression, **values)

    def run(self, number):
        """Run a cell, and look at it."""
        self.page.evaluate(
            """number => {
                const notebook = jupyterapp.shell.currentWidget.content;
                notebook.deselectAll();
                notebook.activeCellIndex = number;
                jupyterapp.commands.execute("notebook:run-cell");
            }""",
            number,
        )

    def command(self, name):
        """Have JupyterLab do one of its commands."""
        self.page.evaluate("name => void jupyterapp.commands.execute(name)", name)

    def busy(self, number):
        """Whether a cell still runs, or waits to run."""
        prompt = f".jp-Cell >> nth={number} >> .jp-InputPrompt"
        return self.page.locator(prompt).inner_text() == "[*]:"

    def ended(self, number):
        """Wait until a cell has run."""
        self._until(
            "number => /\\d/.test(document.querySelectorAll('.jp-Cell')[number]"
            ".querySelector('.jp-InputPrompt').innerText)",
            arg=number,
        )

    def cell(self, number):
        """A cell's widget."""
        return self.page.locator(f".jp-Cell >> nth={number} >> .kickctl")

    def state(self, number):
        """What a cell's widget knows."""
        return self.cell(number).evaluate("root => root.kickctl()")

    def until(self, number, condition):
        """Wait until a condition on `s`, the state of a cell's widget, holds. Returns the state."""
        self._until(
            "number => { const root = document.querySelectorAll('.jp-Cell')[number]"
            ".querySelector('.kickctl'), s = root?.kickctl?.();"
            f" return s && ({condition}); }}",
            arg=number,
        )
        return self.state(number)

    def words(self, number):
        """What a cell has printed."""
        return self.page.locator(f".jp-Cell >> nth={number} >> .jp-OutputArea").inner_text()


@pytest.fixture(scope="module")
def robot():
    """A robot in real time."""
    robot = TcpRobot(tick_s=0.03)
    yield robot
    robot.close()


@pytest.fixture(scope="module")
def jupyter(robot, tmp_path_factory):
    """The address of a notebook in a JupyterLab of its own."""
    folder = tmp_path_factory.mktemp("jupyter")
    cells = [
        {
            "cell_type": "code",
            "id": f"cell-{n}",
            "metadata": {},
            "execution_count": None,
            "outputs": [],
            "source": source.replace("{port}", str(robot.port)),
        }
        for n, source in enumerate(CELLS)
    ]
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    notebook = {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4}
    (folder / "a.ipynb").write_text(json.dumps({**notebook, "nbformat_minor": 5}))
    with closing(socket.create_server(("127.0.0.1", 0))) as place:
        port = place.getsockname()[1]
    own = {f"JUPYTER_{name}_DIR": str(folder / name) for name in ("CONFIG", "DATA", "RUNTIME")}
    extensions = {"jupyter_server_terminals": False}
    options = {
        "ServerApp.port": port,
        "ServerApp.port_retries": 0,
        "ServerApp.root_dir": folder,
        "ServerApp.jpserver_extensions": extensions,
        "IdentityProvider.token": "secret",
        "LabApp.expose_app_in_browser": True,
        "LabApp.news_url": None,
    }
    said = (folder / "said").open("w+")
    server = subprocess.Popen(
        [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root"]
        + [f"--{name}={value}" for name, value in options.items()],
        cwd=folder,
        env={**os.environ, **own, "IPYTHONDIR": str(folder), "PYTHONPATH": str(ROOT)},
        stdout=said,
        stderr=subprocess.STDOUT,
    )

    def listens():
        assert server.poll() is None, (folder / "said").read_text()
        with socket.socket() as caller:
            return caller.connect_ex(("127.0.0.1", port)) == 0

    try:
        wait_until(listens, "JupyterLab listens", (folder / "said").read_text)
        yield f"http://127.0.0.1:{port}/lab/tree/a.ipynb?token=secret"
    finally:
        server.terminate()
        server.wait()
        said.close()


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
    before = notebook.until(ROBOT, "s.records > 3 && s.state === 'running'")
    after = notebook.until(ROBOT, f"s.shown_s > {before['shown_s']} + 0.2")
    assert after["wheels"]["left"]["phi_rad"] > before["wheels"]["left"]["phi_rad"]
    notebook.cell(ROBOT).locator(".stop").click()
    after = notebook.until(ROBOT, "s.state === 'stopped' && s.stop.startsWith('Motors stopped')")
    assert STATES[robot.loop.safety.state] == "stopped"
    assert notebook.busy(BUSY)
    assert (after["missed"], after["lost"]) == (0, False)
    notebook.command("kernelmenu:interrupt")
    notebook.ended(BUSY)


def test_escape_stops_only_where_the_focus_is_in_the_widget(notebook, robot):
    robot.loop.start()
    notebook.until(ROBOT, "s.state === 'running' && s.stop === ''")
    notebook.page.locator(".jp-Cell >> nth=0 >> .cm-content").click()
    notebook.page.keyboard.press("Escape")
    notebook.cell(ROBOT).locator(".stop").focus()
    assert notebook.state(ROBOT)["state"] == "running"
    assert notebook.state(ROBOT)["stop"] == ""
    notebook.page.keyboard.press("Escape")
    notebook.until(ROBOT, "s.state === 'stopped'")


def test_an_embedded_robots_seconds_are_shown_as_seconds_also_after_its_end(notebook):
    notebook.run(EMBEDDED)
    begin = notebook.until(EMBEDDED, "s.records > 100 && s.shown_s < s.record.t_s - 1")
    assert begin["wheels"]["left"]["torque"] > 0.5
    end = notebook.until(EMBEDDED, "s.shown_s === s.record.t_s")
    assert end["wheels"]["left"]["torque"] < -0.5
    assert end["lost"]
    assert "connection to the robot is closed" in notebook.cell(EMBEDDED).inner_text()


def test_a_logs_slider_shows_the_ticks_own_numbers(notebook):
    notebook.run(LOG)
    notebook.until(LOG, "s.frames > 2")
    with kickctl.connect("sim://?seed=1") as embedded, embedded.recording() as log:
        embedded.wait(3)
        embedded.kick_and_watch("phase", ticks=4)
    slider = notebook.cell(LOG).locator("input[type=range]")
    kicked = next(n for n, record in enumerate(log.records) if record.kick)
    slider.fill(str(kicked))
    state = notebook.until(LOG, f"s.place === {kicked} && s.wheels.left.kick === 'Phase'")
    assert state["ticks"] == pytest.approx(len(log), abs=3)  # asking for its state takes a tick
    slider.press("ArrowRight")  # not JupyterLab's own command
    notebook.until(LOG, f"s.place === {kicked + 1}")
    play = notebook.cell(LOG).locator("button.record")
    play.click()
    notebook.until(LOG, f"s.playing && s.place > {kicked + 3}")
    play.click()
    notebook.until(LOG, "!s.playing")


def test_a_cell_that_runs_again_leaves_nothing_behind(notebook):
    for _ in range(2):
        notebook.run(ROBOT)
        notebook.until(ROBOT, "s.records > 0")

    def shown():
        notebook.run(COUNT)
        notebook.ended(COUNT)
        return notebook.words(COUNT)

    # The one of this cell, and the embedded robot's.
    wait_until(lambda: shown().strip() == "showing 2 robots", "the others are forgotten", shown)
