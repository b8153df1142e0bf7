"""A JupyterLab of its own, and a notebook in it as a person uses it."""

import json
import os
import socket
import subprocess
import sys
import time
from contextlib import closing, contextmanager

from playwright import sync_api

from tests.lint.sources import ROOT

# Nothing takes so long; it is only so that what never happens ends.
PATIENCE_MS = 150_000


class Notebook:
    """A notebook in a browser's JupyterLab.

    Attributes:
        page: The page, of playwright.
        complaints: What it has said of errors.
    """

    def __init__(self, browser, url):
        self.complaints = []
        self._ran = set()
        self.page = browser.new_page(viewport={"width": 1280, "height": 1000})
        self.page.set_default_timeout(PATIENCE_MS)
        self.page.on("console", self._hear)
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.goto(url)
        self._until("window.jupyterapp?.shell.currentWidget?.sessionContext?.session?.kernel")
        self._until("window.jupyterapp.shell.currentWidget.content?.widgets.length > 1")

    def _hear(self, message):
        if message.type == "error":  # JupyterLab warns of much, such as of slow computers
            self.complaints.append(f"{message.text} {message.location['url']}")

    def _until(self, expression, **values):
        try:
            self.page.wait_for_function(expression, **values)
        except sync_api.TimeoutError as error:
            raise AssertionError(f"{expression}: {self._seen()}") from error

    def _seen(self):
        """What each cell shows, for a failure."""
        return self.page.evaluate(
            """() => ({
                kernel: window.jupyterapp?.shell.currentWidget?.sessionContext
                    ?.kernelDisplayStatus,
                cells: [...document.querySelectorAll(".jp-Cell")].map((cell) => ({
                    prompt: cell.querySelector(".jp-InputPrompt")?.innerText,
                    words: cell.querySelector(".jp-OutputArea")?.innerText,
                    known: cell.querySelector(".kickctl")?.kickctl?.(),
                })),
            })"""
        )

    def need(self, *numbers):
        """Run those cells that have not run yet, one after the other."""
        for number in numbers:
            if number not in self._ran:
                self.run(number)
                self.ended(number)

    def run(self, number):
        """Run a cell, and look at it."""
        self._ran.add(number)
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

    def prints(self, number, words):
        """Wait until a cell runs and has printed some words."""
        self._until(
            "([number, words]) => {"
            " const part = (name) =>"
            " document.querySelectorAll('.jp-Cell')[number].querySelector(name).innerText;"
            " return part('.jp-InputPrompt') === '[*]:'"
            " && part('.jp-OutputArea').includes(words); }",
            arg=[number, words],
        )

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


@contextmanager
def jupyter_lab(folder, sources):
    """Serve a notebook with these cells, until the end of the block.

    Args:
        folder: An empty one.
        sources: What stands in the cells.

    Yields:
        The address of the notebook.
    """
    cells = [
        {
            "cell_type": "code",
            "id": f"cell-{number}",
            "metadata": {},
            "execution_count": None,
            "outputs": [],
            "source": source,
        }
        for number, source in enumerate(sources)
    ]
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    notebook = {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4}
    settings = folder / "CONFIG/lab/user-settings/@jupyterlab/apputils-extension"
    settings.mkdir(parents=True)
    # Or it asks whether it may.
    (settings / "notification.jupyterlab-settings").write_text('{"fetchNews": "false"}')
    (folder / "a.ipynb").write_text(json.dumps({**notebook, "nbformat_minor": 5}))
    with closing(socket.create_server(("127.0.0.1", 0))) as place:
        port = place.getsockname()[1]
    own = {f"JUPYTER_{name}_DIR": str(folder / name) for name in ("CONFIG", "DATA", "RUNTIME")}
    options = {
        "ServerApp.port": port,
        "ServerApp.port_retries": 0,
        "ServerApp.root_dir": folder,
        "ServerApp.jpserver_extensions": {"jupyter_server_terminals": False},
        "IdentityProvider.token": "secret",
        "LabApp.expose_app_in_browser": True,
    }
    said = folder / "said"
    with said.open("w") as output:
        server = subprocess.Popen(
            [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root"]
            + [f"--{name}={value}" for name, value in options.items()],
            cwd=folder,
            env={**os.environ, **own, "IPYTHONDIR": str(folder), "PYTHONPATH": str(ROOT)},
            stdout=output,
            stderr=subprocess.STDOUT,
        )
    try:
        while not _listens(port):
            assert server.poll() is None, said.read_text()
            time.sleep(0.05)
        yield f"http://127.0.0.1:{port}/lab/tree/a.ipynb?token=secret"
    finally:
        server.terminate()
        try:
            server.wait(20.0)
        except subprocess.TimeoutExpired:  # it waits for a kernel, which ends after it
            server.kill()
            server.wait()


def _listens(port):
    with socket.socket() as caller:
        return caller.connect_ex(("127.0.0.1", port)) == 0
