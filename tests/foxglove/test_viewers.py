"""The server that viewers connect to, over real WebSockets, with robots that are made up."""

import asyncio

import pytest
from aiohttp import ClientSession, WSServerHandshakeError

from host.errors import NotDone, RefusedByRobot, WrongUse
from host.foxglove import control, server
from host.foxglove.server import Viewers
from host.lab.requests import MAX_BYTES
from host.logs.messages import EVENTS, TICKS, Message
from robot.params import Params
from tests.foxglove.stations import SERVICES, FakeStation, driver_of, shown
from tests.foxglove.viewer import viewer_of
from tests.live import wait_until

AGAIN = "kickctl keeps trying, 0.5 s after each failure"


@pytest.fixture
def station():
    return FakeStation()


def test_a_slow_viewer_loses_messages_of_its_own_only(station, monkeypatch):
    monkeypatch.setattr(server, "BACKLOG", 8)
    count, filling = 400, b"x" * 2**16

    async def scenario(viewers):
        async with viewer_of(viewers.url) as fast, viewer_of(viewers.url) as slow:
            for one in (fast, slow):
                await one.subscribe(TICKS)
                await one.refusal("/nothing")  # the subscription holds when the answer comes
            for tick in range(count):
                station.publish(Message(TICKS, tick, tick, filling))
                await fast.until(lambda sent=tick: len(fast.messages) > sent)
            assert [message.time_ns for message in fast.messages] == list(range(count))
            await slow.until(lambda: slow.messages and slow.messages[-1].time_ns == count - 1)
            got = [message.time_ns for message in slow.messages]
            assert len(got) < count
            assert got == sorted(set(got))

    shown(scenario, station)


def test_without_control_nobody_is_offered_anything(station):
    async def scenario(viewers):
        async with viewer_of(viewers.url) as viewer:
            assert viewers.key == ""
            assert viewer.info["capabilities"] == []
            await viewer.subscribe(TICKS)
            for service in ("/kick", "/stop", "/unlock"):
                assert "does not support services" in await viewer.refusal(service)
            await viewer.send(op="setParameters", parameters=[{"name": "k", "value": 2}])
            await viewer.until(lambda: viewer.statuses)
            assert "does not support parameters" in viewer.statuses[0]["message"]
            assert viewer.services == {}
        assert station.asked == []

    shown(scenario, station)


def test_who_has_no_key_may_only_look_and_stop(station):
    """Any web site may open this socket, and viewers can send no password with it."""

    async def scenario(viewers):
        site = "https://elsewhere.example"
        async with viewer_of(viewers.url, services=SERVICES, origin=site) as viewer:
            await viewer.subscribe(TICKS)
            for request in ({"key": ""}, {"key": viewers.key[:-1]}, {"key": 1}, {}, b"[]", b"\xff"):
                assert "Refused: " in await viewer.refusal("/unlock", request)
            async with driver_of(viewers):  # the key of one is no key for others
                for service in ("/kick", "/start", "/set", "/clear", "/take_over"):
                    assert "may only look" in await viewer.refusal(service, {"mode": "phase"})
            await viewer.send(op="setParameters", parameters=[{"name": "k", "value": 2}])
            await viewer.until(lambda: viewer.statuses)
            assert "may only look" in viewer.statuses[0]["message"]
            assert station.asked == []
            assert (await viewer.call("/stop"))["state"] == "stopped"
            assert station.asked == ["stop"]

    shown(scenario, station, control=True)


def test_a_command_reaches_the_robot_and_its_answer_the_viewer(station):
    async def scenario(viewers):
        async with driver_of(viewers) as viewer:
            assert await viewer.call("/kick", {"mode": "phase", "ticks": 4}) == {"tick": 7}
            assert await viewer.call("/set", {"k": 2}) == {"tick": 7}
            assert await viewer.call("/start") == {"tick": 7}
            (kick, *others) = station.asked
            assert kick[1].pop("id")
            assert kick == ("kick", {"mode": "phase", "ticks": 4})
            assert others == [("set", {"set": {"k": 2}}), ("start", {})]
            station.answer = RefusedByRobot("the robot refuses: no", "do this")
            assert await viewer.refusal("/start") == "Refused: the robot refuses: no; do this"
            station.asked.clear()
            for request in (b"[1]", b"{", b'{"k": 1e999}', b'{"k": NaN}', b" " * (MAX_BYTES + 1)):
                assert "a request " in await viewer.refusal("/set", request)
            assert "would drive on" in await viewer.refusal("/set", {"link_loss": "continue"})
            await viewer.unsubscribe()
            assert "must watch it" in await viewer.refusal("/start")
            assert station.asked == []

    shown(scenario, station, control=True)


def test_a_stop_waits_for_no_other_call(station):
    station.answer = None

    async def scenario(viewers):
        async with driver_of(viewers) as viewer:
            kicks = [await viewer.begin_call("/kick", {"mode": "phase"}) for _ in range(20)]
            await viewer.send(op="setParameters", parameters=[{"name": "k", "value": 2}])
            assert (await viewer.call("/stop"))["said"].startswith("motors stopped")
            assert "stop" in station.asked
            number = len(kicks) + 1
            await asyncio.to_thread(wait_until, lambda: len(station.waiting) == number, "they wait")
            for answer in station.waiting:
                answer({"tick": 9})
            for kick in kicks:
                assert await viewer.end_call(kick) == {"tick": 9}

    shown(scenario, station, control=True)


def test_the_end_waits_for_no_answer(station, monkeypatch):
    monkeypatch.setattr(control, "PATIENCE_S", 1e6)
    station.answer = None
    ended = []

    async def scenario(viewers):
        ended.append(viewers._control)
        async with driver_of(viewers) as viewer:
            await viewer.begin_call("/start")
            await asyncio.to_thread(wait_until, lambda: station.waiting, "it waits")
            assert ended[0]._waiting

    shown(scenario, station, control=True)
    wait_until(lambda: not ended[0]._waiting, "nothing waits")


def test_parameters_are_those_in_force_and_a_refusal_is_said(station):
    async def scenario(viewers):
        async with driver_of(viewers) as viewer:
            await viewer.send(op="getParameters", parameterNames=[])
            await viewer.until(lambda: viewer.params)
            assert viewer.params == dict(Params().values())
            station.answer = RefusedByRobot("the robot refuses: k cannot be 300", "")
            await viewer.send(op="setParameters", parameters=[{"name": "k", "value": 300}])
            await viewer.until(lambda: viewer.statuses)
            assert station.asked == [("set", {"set": {"k": 300}})]
            (refusal,) = viewer.statuses
            number = (await viewer.call("/unlock", {"key": viewers.key}))["viewer"]
            assert refusal["message"] == (
                f"viewer {number}, who wants k = 300: the robot refuses: k cannot be 300"
            )
            assert viewers.said == []  # or a web site could fill the terminal

    shown(scenario, station, control=True)


def test_of_two_robots_each_has_topics_services_and_parameters_of_its_own(station):
    other = FakeStation("tcp://127.0.0.1:5425")
    prefix = "/tcp_127_0_0_1_5425"

    async def scenario(viewers):
        async with viewer_of(viewers.url, services=2 * SERVICES - 1) as viewer:
            topics = [one + topic for one in ("/anna", prefix) for topic in (TICKS, EVENTS)]
            assert sorted(viewer.channels) == sorted(topics)
            await viewer.call("/unlock", {"key": viewers.key})
            await viewer.subscribe(prefix + TICKS)
            assert await viewer.call(prefix + "/start") == {"tick": 7}
            assert "must watch it" in await viewer.refusal("/anna/start")
            name = prefix[1:] + ".k"
            wanted = [{"name": name, "value": 2}]
            await viewer.send(op="setParameters", parameters=wanted, id="1")
            await viewer.until(lambda: name in viewer.params)
            await viewer.send(op="setParameters", parameters=[{"name": "k", "value": 2}])
            await viewer.until(lambda: viewer.statuses)
            assert "no robot here has the parameter k" in viewer.statuses[0]["message"]
        assert (station.asked, other.asked) == ([], [("start", {}), ("set", {"set": {"k": 2}})])

    shown(scenario, station, other, control=True)


def test_robots_with_the_same_topics_are_refused():
    with pytest.raises(WrongUse, match="the same topics"):
        Viewers([FakeStation("tcp://a.b"), FakeStation("tcp://a:b")])


def test_a_robot_that_is_lost_and_comes_back_is_said_here_and_there(station):
    station.lost_s = 1.5

    async def scenario(viewers):
        async with viewer_of(viewers.url) as viewer:
            for words, until in (
                ([f"anna is not there yet: nothing comes from it. {AGAIN}"], 1),
                ([f"anna is not there yet: no answer. {AGAIN}"], 2),
            ):
                viewers.look()
                viewers.look()
                await viewer.until(lambda until=until: len(viewer.statuses) == until)
                assert viewers.said[until - 1 :] == words
                station.trouble = "no answer"
            station.lost_s = 0.0
            viewers.look()
            await viewer.until(lambda: len(viewer.statuses) == 3)
            assert viewer.statuses[2] == {"statusIds": ["anna"]}
            station.met.set()
            station.lost_s = 1.2
            viewers.look()
            assert viewers.said[2:] == ["anna is back", f"anna is lost: no answer. {AGAIN}"]

    shown(scenario, station)


def test_an_older_program_is_refused_and_that_is_said_once(station):
    async def scenario(viewers):
        for _ in range(3):
            async with ClientSession() as session:
                with pytest.raises(WSServerHandshakeError):
                    await session.ws_connect(viewers.url, protocols=["foxglove.websocket.v1"])
        await asyncio.to_thread(wait_until, lambda: viewers.said, "the refusal is said")
        async with viewer_of(viewers.url):
            (words,) = viewers.said
            assert "take a newer one" in words

    shown(scenario, station)


def test_a_port_that_is_taken_is_said_in_words(station):
    async def scenario(viewers):
        port = int(viewers.url.rpartition(":")[2])
        with pytest.raises(NotDone, match=f"port {port} is taken") as failed:
            Viewers([FakeStation()], port).__enter__()
        assert f"--port {port + 1}" in failed.value.hint
        with pytest.raises(WrongUse, match=r"at 192\.0\.2\.1: Cannot assign"):
            Viewers([FakeStation()], 0, "192.0.2.1").__enter__()

    shown(scenario, station)
