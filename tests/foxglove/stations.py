"""A robot that is made up, for servers and viewers that are real."""

import asyncio
import threading
from contextlib import asynccontextmanager

from host.client.stop import Stopped
from host.foxglove.server import Viewers
from host.lab.station import STOP
from host.logs.messages import TICKS
from robot.params import Params
from tests.foxglove.viewer import viewer_of

SERVICES = 7


class FakeStation:
    """A station that notes what it is asked for.

    answer: what commands are answered with at once; None keeps them waiting, in `waiting`.
    """

    def __init__(self, name="anna", rule=STOP):
        self.name = name
        self.rule = rule
        self.trouble = ""
        self.met = threading.Event()
        self.lost_s = 0.0
        self.again_s = 0.5
        self.asked = []
        self.answer = {"tick": 7}
        self.waiting = []

    def state(self):
        return {"link": "lost" if self.lost_s else "up", "since_s": self.lost_s}

    def params(self):
        return dict(Params().values())

    def do(self, command, arguments, answer):
        self.asked.append((command, arguments))
        if self.answer is None:
            self.waiting.append(answer)
        else:
            answer(self.answer)

    def stop(self):
        self.asked.append("stop")

    def stop_now(self):
        return Stopped(5, "stopped", "")

    def attend(self):
        self.asked.append("attend")

    def abandon(self):
        self.asked.append("abandon")


def shown(scenario, *stations, **settings):
    """Run a scenario with the server of some robots; `said` is what it has said."""
    said = []
    with Viewers(stations, say=said.append, **settings) as viewers:
        viewers.said = said

        async def run():
            async with asyncio.timeout(100.0):
                await scenario(viewers)

        asyncio.run(run())


@asynccontextmanager
async def driver_of(viewers):
    """A viewer that may drive the robot, and watches it."""
    async with viewer_of(viewers.url, services=SERVICES) as viewer:
        await viewer.call("/unlock", {"key": viewers.key})
        await viewer.subscribe(TICKS)
        await viewer.refusal("/nothing")  # the subscription holds when the answer comes
        yield viewer
