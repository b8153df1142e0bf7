"""A simulated robot in a process of its own, shown to viewers that know only the protocol."""

import asyncio
from contextlib import contextmanager

from mcap.reader import make_reader

from host.foxglove.server import Viewers
from host.foxglove.station import ShownStation
from host.lab.station import STOP
from host.link.robots_file import Known
from host.logs.log import Log
from host.logs.mcap_files import McapTap
from host.logs.messages import EVENTS, TICKS
from robot.record import KICK_NAMES, STATES, STRUCT, Record
from tests.foxglove.stations import driver_of
from tests.foxglove.viewer import viewer_of
from tests.live import Relay


@contextmanager
def shown(uri, token=None, **settings):
    """The server of one robot, and what it has said."""
    said = []
    station = ShownStation(Known("anna", uri, token), STOP, "real")
    station.start()
    try:
        with Viewers([station], say=said.append, **settings) as viewers:
            viewers.said = said
            yield viewers
    finally:
        station.end()


def play(viewers, scenario):
    """Run a scenario while the server looks about, as the command has it do."""

    async def look():
        while True:
            viewers.look()
            await asyncio.sleep(0.05)

    async def run():
        looking = asyncio.create_task(look())
        async with asyncio.timeout(100.0):
            await scenario()
        looking.cancel()

    asyncio.run(run())


def record_of(message):
    words = {"state": STATES, "kick": KICK_NAMES}
    return Record(
        **{name: words[name].index(value) if name in words else value
           for name, value in message.items()}
    )  # fmt: skip


def contents(path):
    """The messages of a log with their topics and ticks, and its channels with their schemas."""
    with path.open("rb") as file:
        reader = make_reader(file)
        messages = {
            (channel.topic, message.sequence, message.data)
            for _, channel, message in reader.iter_messages()
        }
        summary = reader.get_summary()
    schemas = summary.schemas
    channels = {
        (one.topic, one.message_encoding, schema.name, schema.encoding, schema.data.decode())
        for one in summary.channels.values()
        for schema in [schemas[one.schema_id]]
    }
    return messages, channels


def direction(ticks, side):
    turned = ticks[-1][f"{side}_phi_rad"] - ticks[-8][f"{side}_phi_rad"]
    return (turned > 0.3) - (turned < -0.3)


def test_viewers_get_what_a_log_holds_to_the_byte(desk, observer, tmp_path):
    path = tmp_path / "log.mcap"

    async def scenario():
        async with driver_of(viewers) as viewer:
            await viewer.subscribe(EVENTS)
            await viewer.until(lambda: viewer.of(TICKS))
            with McapTap(path, observer.info()) as tap:
                observer.add_tap(tap)
                await viewer.call("/start")
                await viewer.call("/kick", {"mode": "phase", "ticks": 4})
                last = (await viewer.call("/stop"))["tick"]
                await viewer.until(lambda: viewer.of(TICKS)[-1]["tick"] > last)
                observer.wait(100.0, until=lambda: observer.newest and observer.newest.tick > last)
                observer.remove_tap(tap)
        log = Log.load(path)
        ticks = range(log.records[0].tick + 1, last + 1)
        written, channels = contents(path)
        got = {
            (one.topic, one.json()["tick"], one.data)
            for one in viewer.messages
            if one.json()["tick"] in ticks and one.json().get("event") != "snapshot"
        }
        assert got == {one for one in written if one[1] in ticks}
        assert sorted(tick for topic, tick, _ in got if topic == TICKS) == list(ticks)
        assert {"start", "kick", "stop"} <= {one["event"] for one in viewer.of(EVENTS)}
        assert channels == {
            (topic, one["encoding"], one["schemaName"], one["schemaEncoding"], one["schema"])
            for topic, one in viewer.channels.items()
        }
        records = {record.tick: STRUCT.pack(*record) for record in log.records}
        for one in viewer.messages:
            if one.topic == TICKS and one.json()["tick"] in ticks:
                record = record_of(one.json())
                assert STRUCT.pack(*record) == records[record.tick]
                assert abs(one.time_ns * 1e-9 - log.info["clock_zero_s"] - record.t_s) < 1.0

    with shown(desk.uri, desk.token, control=True) as viewers:
        play(viewers, scenario)


def test_a_kick_of_a_viewer_reverses_the_robot_and_who_leaves_stops_it(desk, observer):
    async def scenario():
        async with driver_of(viewers) as viewer:
            await viewer.call("/start")

            def rolls():
                ticks = viewer.of(TICKS)
                return len(ticks) > 40 and direction(ticks, "left") and direction(ticks, "right")

            await viewer.until(rolls)
            before = [direction(viewer.of(TICKS), side) for side in ("left", "right")]
            await viewer.call("/kick", {"mode": "membrane"})
            await viewer.until(
                lambda: (
                    [direction(viewer.of(TICKS), side) for side in ("left", "right")]
                    == [-one for one in before]
                )
            )
        await asyncio.to_thread(
            observer.wait, 100.0, lambda: observer.status()["state"] == "stopped"
        )

    with shown(desk.uri, desk.token, control=True) as viewers:
        play(viewers, scenario)


def test_parameters_follow_whoever_sets_them(desk, observer):
    async def scenario():
        async with driver_of(viewers) as viewer:
            await viewer.send(op="subscribeParameterUpdates", parameterNames=["k"])
            await viewer.send(op="setParameters", parameters=[{"name": "k", "value": 7.5}])
            await viewer.until(lambda: viewer.params.get("k") == 7.5)
            assert observer.status()["params"]["k"] == 7.5
            await viewer.call("/set", {"k": 8})
            await viewer.until(lambda: viewer.params["k"] == 8.0)
            await viewer.send(op="setParameters", parameters=[{"name": "k", "value": 300}])
            await viewer.until(lambda: viewer.statuses)
            assert "it is a number from 0 to 100" in viewer.statuses[0]["message"]

    with shown(desk.uri, desk.token, control=True) as viewers:
        play(viewers, scenario)


def test_who_comes_late_hears_what_is_in_force(desk, observer):
    async def scenario():
        async with viewer_of(viewers.url) as first:
            await first.subscribe(TICKS)
            await first.until(lambda: len(first.messages) > 3)
            async with viewer_of(viewers.url) as viewer:
                await viewer.subscribe(EVENTS)
                await viewer.until(lambda: viewer.messages)
                (event,) = viewer.of(EVENTS)
                assert event["event"] == "snapshot"
                assert event["params"] == observer.status()["params"]

    with shown(desk.uri) as viewers:
        play(viewers, scenario)


def test_a_robot_that_is_lost_comes_back(desk):
    relay = Relay(int(desk.uri.rpartition(":")[2]))

    async def scenario():
        async with viewer_of(viewers.url) as viewer:
            await viewer.subscribe(TICKS)
            await viewer.until(lambda: viewer.messages)
            relay.cut(1.6)
            await viewer.until(lambda: viewer.statuses)
            assert viewer.statuses[0]["message"].startswith("anna is lost: the link to tcp://")
            count = len(viewer.messages)
            await viewer.until(lambda: len(viewer.messages) > count and len(viewer.statuses) > 1)
            assert viewers.said[-1] == "anna is back"
            ticks = [message["tick"] for message in viewer.of(TICKS)]
            assert ticks == list(range(ticks[0], ticks[0] + len(ticks)))  # from its black box

    try:
        with shown(relay.uri) as viewers:
            play(viewers, scenario)
    finally:
        relay.close()
