"""`kickctl lab` as a person starts and ends it."""

import json
import signal
import socket
import subprocess
import sys
import tempfile
from argparse import Namespace
from contextlib import ExitStack, contextmanager
from urllib.request import Request, urlopen

import pytest

from host.client.robot import connect
from host.commands._stations import robots_of
from host.lab.desk_robot import DeskRobot, child_options
from tests.fakes import eventful
from tests.lab.browser import browse
from tests.live import wait_until
from tests.sysfs.mount import ROOT


@contextmanager
def lab(*arguments):
    """The process of the verb, and what it says of itself."""
    with tempfile.TemporaryFile("w+") as errors:
        process = subprocess.Popen(
            [sys.executable, "-m", "host", "lab", "--no-open", "--port", "0", "--json", *arguments],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            stderr=errors,
            text=True,
        )
        try:
            line = process.stdout.readline()
            if not line:
                errors.seek(0)
                pytest.fail(f"the lab did not start: {errors.read()}")
            process.said = lambda: (errors.seek(0), errors.read())[1]
            yield process, json.loads(line)
        finally:
            process.kill()
            process.wait()
            process.stdout.close()


def started(info):
    """Start the first robot from a page; the page is closed, but nobody has noticed yet."""

    async def scenario(browser):
        tab = await browser.open(info["drive"])
        name = info["robots"][0]["name"]
        reply = await tab.ask("do", robot=name, command="start", arguments={})
        assert "result" in reply, reply

    browse(scenario)


def test_a_lab_that_is_killed_lets_no_robot_drive_on(desk, observer):
    with lab("--brick", desk.uri, "--token", desk.token) as (process, info):
        assert info["robots"] == [{"name": desk.uri, "uri": desk.uri, "unattended": "stop"}]
        with observer.recording() as log:
            started(info)
            process.kill()
            observer.wait(20.0, until=lambda: observer.status()["state"] == "stopped")
            observer.wait(0.1)
    assert "link_loss" in [event["event"] for event in log.events]


def test_of_two_robots_one_is_kicked_and_both_stop(desk):
    options = [*child_options("sim://?seed=2&idle=1"), "--token", desk.token]
    with DeskRobot(options) as other, ExitStack() as stack:
        names = [desk.uri, other.uri]
        info = stack.enter_context(lab("--brick", ",".join(names), "--token", desk.token))[1]
        watched = [stack.enter_context(connect(name, observe=True)) for name in names]
        logs = [stack.enter_context(robot.recording()) for robot in watched]

        async def scenario(browser):
            tab = await browser.open(info["drive"])
            assert [one["name"] for one in (await tab.latest("welcome"))["robots"]] == names
            for name in names:
                reply = await tab.ask("do", robot=name, command="start", arguments={})
                assert "result" in reply, reply
            kick = {"mode": "membrane", "ticks": 1}
            reply = await tab.ask("do", robot=other.uri, command="kick", arguments=kick)
            assert "result" in reply, reply
            await tab.send("stop", robot=None)
            await tab.until(lambda tab: stopped(tab) == set(names))

        browse(scenario)
        for robot, log, kicked in zip(watched, logs, (False, True), strict=True):
            assert robot.status()["state"] == "stopped"
            robot.wait(0.1)
            assert ("kick" in [event["event"] for event in log.events]) == kicked


def stopped(tab):
    """The robots that have stopped after a page's stop, as a page hears it."""
    states = {one["robot"]: one for one in tab.got if one["type"] == "state"}
    return {name for name, one in states.items() if one.get("stopped_by")}


def test_an_interrupt_stops_what_it_drives_and_is_no_error(desk, observer):
    with lab("--brick", desk.uri, "--token", desk.token) as (process, info):
        started(info)
        process.send_signal(signal.SIGINT)
        assert process.wait(60.0) == 0, process.said()
        assert "Traceback" not in process.said()
        assert observer.status()["state"] == "stopped"
        assert process.stdout.read() == ""


def test_an_interrupt_lets_a_robot_go_on_that_may(desk, observer):
    arguments = ("--brick", desk.uri, "--token", desk.token, "--unattended", "continue")
    with lab(*arguments) as (process, info):
        started(info)
        process.send_signal(signal.SIGTERM)
        assert process.wait(60.0) == 0, process.said()
        status = observer.status()
        assert (status["state"], status["controller"]) == ("running", None)


def test_without_a_robot_it_simulates_one_between_walls_with_a_hand():
    options = ("--seed", "3", "--set", "k=2.5", "--walls", "1.5", "--twin")
    with lab(*options) as (process, info):

        async def scenario(browser):
            tab = await browser.open(info["drive"])
            await tab.until(lambda tab: tab.records)
            return await tab.latest("welcome")

        welcome = browse(scenario)
        (robot,), (twin,) = welcome["robots"], welcome["twins"]
        assert (twin["robot"], twin["motor"], twin["why"]) == ("simulated", "pybricks", "")
        assert (robot["name"], robot["label"]) == ("simulated", "simulated")
        assert (robot["walls"], robot["hand"]) == (1.5, True)
        assert robot["events"][-1]["params"]["k"] == 2.5
        with connect(robot["uri"], observe=True) as observer:
            assert observer.hello["seed"] == 3
        process.send_signal(signal.SIGINT)
        assert process.wait(60.0) == 0, process.said()


def test_simulated_robots_without_a_name_are_told_apart():
    def names(brick):
        return [one.name for one in robots_of(Namespace(brick=brick, seed=None))]

    assert names("sim://?seed=1") == ["simulated"]
    assert names("sim://?seed=1,tcp://a,sim://?seed=2") == ["simulated-1", "tcp://a", "simulated-2"]


def test_a_robot_that_is_away_is_said_and_the_page_is_there():
    with lab("--brick", "tcp://127.0.0.1:1") as (process, info):
        wait_until(lambda: "is not there yet" in process.said(), "it says that the robot is away")

        async def scenario(browser):
            tab = await browser.open(info["view"])
            return await tab.latest("state")

        assert browse(scenario)["link"] == "lost"


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        (("--port", "{taken}"), 1, "is taken"),
        (("--brick", "tcp://127.0.0.1:1", "--walls", "2"), 2, "--walls is for the simulated"),
        (("--brick", "tcp://127.0.0.1:1", "--seed", "2"), 2, "--seed is only for"),
        (("--brick", "sim://?dither=1"), 2, "has no option 'dither'"),
        (("--host", "192.0.2.1", "--port", "0"), 2, "cannot listen at 192.0.2.1"),
        (("--class", "--host", "192.0.2.1"), 2, "not allowed with argument"),
        (("--host", "::"), 2, "give one IP address of this computer"),
        (("--host", "lab.example"), 2, "give one IP address of this computer"),
        (("--set", "k=-1"), 2, "k cannot be"),
        (("--from", "1"), 2, "--from cuts a log, and there is none"),
        (("--force",), 2, "--force replaces a file, and none is written"),
        (("--replay", "none.mcap"), 2, "none.mcap cannot be read"),
        (("--replay", "x.mcap", "--brick", "sim://"), 2, "`lab --replay` reaches none"),
        (("--replay", "x.mcap", "--walls", "2"), 2, "--walls is for robots"),
        (("--replay", "x.mcap", "--from", "2", "--to", "1"), 2, "--from 2 is later than --to 1"),
        (("--twin", "none"), 2, "name one of these: --twin NAME"),
        (("--export", "x.txt", "x.mcap"), 2, "has another ending than .html"),
        (("--export", "x.mcap", "x.html"), 2, "kickctl lab --export x.html x.mcap"),
        (("--export", "x.html", "--force", "x.mcap"), 2, "needs FILE.html and LOG right behind it"),
        (("--export", "no/x.html", "x.mcap"), 2, "there is no folder no"),
        (("--export", "x.html", "x.mcap", "--host", "::1"), 2, "--export writes a file"),
    ],
)
def test_what_cannot_be_is_said_in_words(kickctl, arguments, status, words):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        arguments = [word.replace("{taken}", port) for word in arguments]
        done, out, err = kickctl("lab", "--no-open", "--json", *arguments)
    assert done == json.loads(out)["error"]["status"] == status
    assert words in err


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    return eventful().log().save(tmp_path_factory.mktemp("logs") / "eventful.mcap")


def test_an_export_says_its_size_and_replaces_no_file(kickctl, log):
    status, out, err = kickctl(
        "lab", "--export", "a.html", str(log), "--to", "3", "--twin", "--json"
    )
    told = json.loads(out)
    page = kickctl.folder / "a.html"
    assert (status, err) == (0, "")
    assert (told["file"], told["bytes"]) == ("a.html", page.stat().st_size)
    assert (told["ticks"], told["reproduced"], told["lost"]) == (92, True, 0)
    assert told["twin"]["motor"] == "pybricks"
    assert page.read_text(encoding="utf-8").startswith("<!doctype html>")
    status, _, err = kickctl("lab", "--export", "b.html", str(log), "--twin", "none")
    assert status == 2
    assert "--twin NAME" in err
    status, _, err = kickctl("lab", "--export", "a.html", str(log))
    assert status == 2
    assert "a.html exists already" in err
    status, out, _ = kickctl("lab", "--export", "a.html", str(log), "--force")
    assert status == 0
    assert out.startswith("486 ticks in a.html, 0.")


def test_of_one_tick_nothing_false_is_said(kickctl):
    assert kickctl("record", "0.001", "--out", "one.mcap")[0] == 0
    words = "no tick of one.mcap can be compared with the robot's program"
    assert words in kickctl("log", "replay", "one.mcap")[2]
    status, out, err = kickctl("lab", "--export", "one.html", "one.mcap")
    assert status == 0
    assert out.startswith("1 tick in one.html, ")
    assert err.startswith(words)
    assert "is not what the robot's program computes" not in err


def test_a_replay_is_served_until_it_is_ended(log):
    with lab("--replay", str(log)) as (process, info):
        place, _, key = info["replay"].partition("#view=")
        address = place.replace("replay.html?log=", "replays/")
        request = Request(address, headers={"Authorization": f"Bearer {key}"})  # noqa: S310
        with urlopen(request) as answer:  # noqa: S310
            tape = json.load(answer)
        assert (tape["name"], tape["ticks"]) == ("eventful.mcap", info["ticks"])
        assert info["exact"]
        process.send_signal(signal.SIGINT)
        assert process.wait() == 0
        assert process.said() == ""
