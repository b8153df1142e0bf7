"""The tree of sim_motor.sysfs as a file system (FUSE) in real time.

`python -m sim_motor --sysfs MOUNTPOINT`. Only another process may use the mount: one that waits for
itself hangs for ever.
"""

import errno
import os
import sys
import time
from pathlib import Path
from typing import Any

from sim_motor.brick import SimBrick
from sim_motor.sysfs import Tree
from sim_motor.tacho import failure

ENDED_BY_SIGNAL = 8  # what libfuse's main function returns then
_WANTED = {os.O_RDONLY: os.R_OK, os.O_WRONLY: os.W_OK, os.O_RDWR: os.R_OK | os.W_OK}


class _Calls:
    """The calls that libfuse makes, one at a time; each first brings the tree up to the present."""

    use_ns = True

    def __init__(self, tree: Tree, mountpoint: str) -> None:
        self._tree = tree
        self._mountpoint = mountpoint
        self._epoch = time.monotonic()

    def _present(self) -> Tree:
        self._tree.run_to(time.monotonic() - self._epoch)
        return self._tree

    def init(self, path: str) -> None:
        print("READY", self._mountpoint, flush=True)

    def getattr(self, path: str, handle: int | None = None) -> dict[str, Any]:
        mode = self._present().mode(path)
        return {
            "st_mode": mode,
            "st_nlink": 1,
            "st_size": 4096,
            "st_uid": os.getuid(),
            "st_gid": os.getgid(),
        }

    def readdir(self, path: str, handle: int) -> list[str]:
        return [".", "..", *self._present().names(path)]

    def access(self, path: str, wanted: int) -> int:
        self._present().allow(path, wanted)
        return 0

    def open(self, path: str, flags: int) -> int:
        return self._present().open(path, _WANTED[flags & os.O_ACCMODE])

    def create(self, path: str, mode: int, flags: int) -> int:
        raise failure(errno.EACCES)

    def truncate(self, path: str, length: int, handle: int | None = None) -> int:
        return 0

    def read(self, path: str, size: int, offset: int, handle: int) -> bytes:
        return self._present().read(handle, size, offset)

    def write(self, path: str, data: bytes, offset: int, handle: int) -> int:
        self._present().write(handle, data)
        return len(data)

    def release(self, path: str, handle: int) -> int:
        self._tree.close(handle)
        return 0


def serve(mountpoint: str, brick: SimBrick) -> int:
    """Mount the brick's files and serve them, until somebody unmounts them or ends the process.

    Returns:
        The exit status.
    """
    try:
        import mfusepy
    except (ImportError, OSError) as error:
        return _give_up(
            f"the file tree needs mfusepy and libfuse3 ({error}): install both, for example by"
            " `pip install mfusepy` and `apt-get install fuse3`"
        )
    folder = Path(mountpoint)
    if not folder.is_dir() or folder.is_mount() or any(folder.iterdir()):
        return _give_up(
            f"{mountpoint} is no empty folder to mount on: make one, or unmount what is there:"
            f" fusermount3 -u {mountpoint}"
        )
    tree = Tree(brick)
    tree.run_to(brick.clock.now())
    # The kernel must ask each time: values, permissions and the files themselves change
    # by themselves.
    fresh = {"direct_io": True, "entry_timeout": 0, "attr_timeout": 0, "negative_timeout": 0}
    try:
        mfusepy.FUSE(
            _Calls(tree, mountpoint),
            mountpoint,
            foreground=True,
            nothreads=True,
            fsname="ev3",
            allow_other=os.getuid() == 0,
            **fresh,
        )
    except RuntimeError as error:
        if error.args == (ENDED_BY_SIGNAL,):
            return 0
        return _give_up(
            f"cannot mount on {mountpoint} (FUSE error {error}): it needs /dev/fuse, the package"
            " fuse3 and the right to mount"
        )
    return 0


def _give_up(message: str) -> int:
    print(message, file=sys.stderr)
    return 2
