"""The files below /sys/class that a brick's kernel shows: two motors, the battery, the lights.

The motors' physics is behind them. The caller says what time it is, so the same tree runs in
virtual time and, by sim_motor.mount, in real time. Lines written to the file .faults make things
fail; reading it lists the faults.
"""

import errno
import heapq
import itertools
import stat
from collections.abc import Callable
from dataclasses import dataclass, field
from posixpath import dirname

from sim_motor.brick import SimBrick
from sim_motor.tacho import BOTH, READ, Attribute, TachoMotor, failure, no_store, whole_number
from sim_motor.wheel_motor import SimMotor

PORTS = ("outB", "outC")
SAMPLE_S = 0.002
# If nobody looked for longer, only this much of the time is sampled.
REMEMBERED_S = 1.0
# How long the kernel takes to notice that a motor is gone, and that one is there; then udev, until
# the group may write its files.
UNREGISTER_S = 0.1
REGISTER_S = 0.39
PERMISSIONS_S = 0.3

BATTERY = "/power_supply/lego-ev3-battery"
LIGHTS = tuple(
    f"/leds/led{side}:{colour}:brick-status" for side in (0, 1) for colour in ("red", "green")
)
FAULTS = """\
unplug PORT            pull the cable out of outB or outC
replug PORT [SECONDS]  put it back; its files appear, and are writable SECONDS later (default 0.3)
eio PORT [TIMES]       the next access to the motor's files, or the next TIMES, fail with EIO
battery VOLTS          another open-circuit voltage"""


@dataclass
class Device:
    """A folder of files.

    Attributes:
        writable: Whether the group may write them by now.
        errors: How many more accesses fail with EIO.
    """

    attributes: dict[str, Attribute]
    present: bool = True
    writable: bool = True
    errors: int = 0

    def check(self) -> None:
        """Raises OSError if the device makes an access fail."""
        if not self.present:
            raise failure(errno.ENODEV)
        if self.errors:
            self.errors -= 1
            raise failure(errno.EIO)


@dataclass
class Port:
    """A socket for a motor, the motor on its cable, and what the kernel knows of it."""

    motor: SimMotor
    folder: str = ""
    tacho: TachoMotor | None = None


@dataclass
class Handle:
    """An open file, and the text that it showed when it was last read from its beginning."""

    device: Device
    attribute: Attribute
    shown: bytes = b""


@dataclass(order=True)
class _Event:
    time: float
    order: int
    action: Callable[[], None] = field(compare=False)


class Tree:
    """All files and who has them open. The brick's clock must be virtual and without jitter.

    `run_to` is the only way time passes.
    """

    def __init__(self, brick: SimBrick) -> None:
        self._brick = brick
        self._samples = 0
        self._events: list[_Event] = []
        self._numbers = itertools.count(1)
        self._motors_seen = itertools.count()
        self._ports = {name: Port(motor) for name, motor in zip(PORTS, brick.motors, strict=True)}
        self._handles: dict[int, Handle] = {}
        self._devices = {
            "": Device({".faults": Attribute(BOTH, lambda: FAULTS, self._inject)}),
            BATTERY: Device(self._battery()),
        }
        self._devices |= {name: Device(_light()) for name in LIGHTS}
        for name in PORTS:
            self._register(name)

    def run_to(self, now: float) -> None:
        """Let time pass until `now` (s since the brick was made)."""
        clock = self._brick.clock
        self._samples = max(self._samples, int((now - REMEMBERED_S) / SAMPLE_S))
        while (self._samples + 1) * SAMPLE_S <= now:
            self._samples += 1
            clock.wait(self._samples * SAMPLE_S, _nobody)
            for port in self._ports.values():
                if port.tacho is not None:
                    port.tacho.sample(clock.now())
            while self._events and self._events[0].time <= clock.now():
                heapq.heappop(self._events).action()
        clock.wait(now, _nobody)

    def mode(self, path: str) -> int:
        """Type and permissions of a file or folder. Raises OSError."""
        if path in self._folders:
            return stat.S_IFDIR | 0o755
        device, attribute = self._find(path)
        return stat.S_IFREG | (attribute.mode if device.writable else attribute.mode & ~0o020)

    def names(self, path: str) -> list[str]:
        """What a folder contains. Raises OSError."""
        if path not in self._folders:
            raise failure(errno.ENOENT)
        return sorted(self._folders[path])

    def allow(self, path: str, wanted: int) -> None:
        """Raises OSError unless the group may do all of what is wanted (os.R_OK, os.W_OK).

        It does so for every user: on the brick the robot's user is not root.
        """
        if wanted & ~(self.mode(path) >> 3 & 7):
            raise failure(errno.EACCES)

    def open(self, path: str, wanted: int) -> int:
        """A handle to a file, for what is wanted (os.R_OK, os.W_OK). Raises OSError."""
        self.allow(path, wanted)
        number = next(self._numbers)
        self._handles[number] = Handle(*self._find(path))
        return number

    def close(self, handle: int) -> None:
        """Give a handle back."""
        del self._handles[handle]

    def read(self, handle: int, size: int, offset: int) -> bytes:
        """A piece of the text. A read from its beginning makes the text again.

        Raises OSError.
        """
        opened = self._handles[handle]
        if offset == 0:
            opened.device.check()
            opened.shown = (opened.attribute.show() + "\n").encode()
        return opened.shown[offset : offset + size]

    def write(self, handle: int, data: bytes) -> None:
        """Each write is a value of its own, wherever in the file it goes. Raises OSError."""
        opened = self._handles[handle]
        opened.device.check()
        opened.attribute.store(data.decode("ascii", "replace"))

    def _index(self) -> None:
        """Find files and folders by path again, as a device came or went."""
        self._files = {
            f"{folder}/{name}": (device, attribute)
            for folder, device in self._devices.items()
            for name, attribute in device.attributes.items()
        }
        self._folders: dict[str, set[str]] = {"/": set(), "/tacho-motor": set()}
        for path in [*self._files, "/tacho-motor"]:
            inner = path
            while inner != "/":
                self._folders.setdefault(dirname(inner), set()).add(inner.rpartition("/")[2])
                inner = dirname(inner)

    def _find(self, path: str) -> tuple[Device, Attribute]:
        if path not in self._files:
            raise failure(errno.EISDIR if path in self._folders else errno.ENOENT)
        return self._files[path]

    def _battery(self) -> dict[str, Attribute]:
        shows: dict[str, Callable[[], str]] = {
            "voltage_now": lambda: str(round(self._brick.battery.voltage_v() * 1e6)),
            "current_now": lambda: str(
                round(sum(motor.draw_a() for motor in self._brick.motors) * 1e6)
            ),
            # Wrong by a factor of ten, as on the brick.
            "voltage_max_design": lambda: "84000000",
            "voltage_min_design": lambda: "60000000",
            "technology": lambda: "Li-ion",
            "type": lambda: "Battery",
            "scope": lambda: "System",
        }
        return {name: Attribute(READ, show, no_store) for name, show in shows.items()}

    def _register(self, name: str) -> Device:
        port = self._ports[name]
        port.tacho = TachoMotor(port.motor, name, self._brick.clock.now())
        port.folder = f"/tacho-motor/motor{next(self._motors_seen)}"
        self._devices[port.folder] = Device(port.tacho.attributes)
        self._index()
        return self._devices[port.folder]

    def _unregister(self, name: str) -> None:
        port = self._ports[name]
        if port.tacho is not None:
            self._devices.pop(port.folder).present = False
            port.tacho = None
            self._index()

    def _inject(self, line: str) -> None:
        """Carry out a line of FAULTS. Raises OSError (EINVAL)."""
        fault, target, extra = (*line.split(), "", "", "")[:3]
        actions: dict[str, Callable[[str, str], None]] = {
            "unplug": self._unplug,
            "replug": self._replug,
            "eio": self._disturb,
            "battery": lambda volts, _: self._brick.set_battery(float(volts)),
        }
        try:
            actions[fault](target, extra)
        except (KeyError, ValueError):
            raise failure(errno.EINVAL) from None

    def _later(self, seconds: float, action: Callable[[], None]) -> None:
        heapq.heappush(
            self._events, _Event(self._brick.clock.now() + seconds, next(self._numbers), action)
        )

    def _unplug(self, name: str, _: str) -> None:
        tacho = self._ports[name].tacho
        if tacho is not None:
            tacho.disconnect()
            self._later(UNREGISTER_S, lambda: self._unregister(name))

    def _replug(self, name: str, seconds: str) -> None:
        permissions_s = float(seconds or PERMISSIONS_S)

        def appear() -> None:
            self._unregister(name)
            device = self._register(name)
            device.writable = False
            self._later(permissions_s, lambda: setattr(device, "writable", True))

        if name not in self._ports:
            raise ValueError(name)
        self._later(REGISTER_S, appear)

    def _disturb(self, name: str, times: str) -> None:
        self._devices[self._ports[name].folder].errors = whole_number(times or "1", 0, 2**31 - 1)


def _nobody(timeout_s: float) -> None:
    """There are no links to serve."""


def _light() -> dict[str, Attribute]:
    settings = {"brightness": 0}

    def store(text: str) -> None:
        settings["brightness"] = min(255, whole_number(text, 0, 2**31 - 1))

    return {
        "brightness": Attribute(BOTH, lambda: str(settings["brightness"]), store),
        "max_brightness": Attribute(READ, lambda: "255", no_store),
    }
