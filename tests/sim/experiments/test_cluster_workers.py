"""Dask workers that are not there, lack something, or would compute other numbers."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest
from distributed import LocalCluster

from host.errors import NoLink, NotDone
from host.experiments.robot import kick_map, reliability, switching, wall
from host.runs import cluster
from host.runs.contract import Setting

ROOT = Path(__file__).parents[3]
CELLS = [{"cell": number} for number in range(40)]
SETTING = Setting(5, {})
PATIENCE_S = cluster.FIRST_WORKER_S + cluster.LOOK_S


@pytest.fixture(scope="module")
def address():
    """A scheduler without workers."""
    with LocalCluster(n_workers=0, dashboard_address=":0") as scheduler:
        yield scheduler.scheduler_address


@pytest.fixture(autouse=True)
def _patience(monkeypatch):
    """On a busy machine a worker takes longer to start than anybody would wait for it."""
    monkeypatch.setattr(cluster, "FIRST_WORKER_S", 100.0)


@contextmanager
def worker(address, **environment):
    """A worker process, with these variables in its environment."""
    command = [sys.executable, "-m", "distributed.cli.dask_worker", address]
    options = ["--nthreads", "1", "--no-nanny", "--no-dashboard"]
    process = subprocess.Popen(
        [*command, *options], env={**os.environ, **environment}, stderr=subprocess.DEVNULL
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()


@pytest.fixture
def count():
    """A simulation that says where it was computed, and with which motor."""

    def count(cell, setting):
        import os
        import time

        time.sleep(0.05)
        return [{"process": os.getpid(), "torque": setting.constants.torque_constant}]

    return count


def test_no_worker_is_said_and_not_waited_for(address, count, monkeypatch):
    assert PATIENCE_S < 10.0
    monkeypatch.setattr(cluster, "FIRST_WORKER_S", 0.5)
    monkeypatch.setattr(cluster, "LOOK_S", 0.1)
    with pytest.raises(NoLink, match="has no worker") as failure:
        list(cluster.compute_on_cluster(address, count, CELLS, SETTING))
    assert f"dask worker {address}" in failure.value.hint


def test_a_worker_without_kickctl_is_said_and_survives(address, tmp_path):
    blocker = tmp_path / "host" / "__init__.py"
    blocker.parent.mkdir()
    blocker.write_text("raise ModuleNotFoundError(\"No module named 'host'\", name='host')")
    with (
        worker(address, PYTHONPATH=str(tmp_path)) as process,
        pytest.raises(NotDone, match="lacks a package: No module named 'host'"),
    ):
        try:
            list(cluster.compute_on_cluster(address, kick_map.simulate, CELLS, SETTING))
        finally:
            assert process.poll() is None


def test_a_worker_of_other_sources_computes_nothing(address, count, tmp_path):
    for package in ("host", "kickctl", "robot", "sim_motor"):
        shutil.copytree(ROOT / package, tmp_path / package)
    with (tmp_path / "sim_motor" / "motors.toml").open("a") as file:
        file.write("# another version")
    with (
        worker(address, PYTHONPATH=str(tmp_path)),
        pytest.raises(NotDone, match=r"would compute other numbers .* sources \w+ instead of"),
    ):
        list(cluster.compute_on_cluster(address, count, CELLS, SETTING))


def test_a_package_of_another_version_is_named(monkeypatch):
    ours = cluster.computing()
    assert cluster.compare(ours) == ""
    assert cluster.compare({**ours, "mujoco-core": ""}) == ""
    for name in ("numpy", "mujoco-core"):
        assert cluster.compare({**ours, name: "1.0"}) == f"{name} {ours[name]} instead of 1.0"
    monkeypatch.setattr("host.util.provenance._places", list)  # the sources are gone
    assert "have changed" in cluster.compare(ours)


def test_the_motor_is_that_of_this_computer(address, count, tmp_path, monkeypatch):
    own = own_motor(tmp_path / "motors.toml", 0.5)
    monkeypatch.setenv("KICK_MOTORS", str(own))
    other = own_motor(tmp_path / "others.toml", 0.6)
    setting = Setting(5, {}, motor="mine")
    with worker(address, KICK_MOTORS=str(other)) as process:
        results = list(cluster.compute_on_cluster(address, count, CELLS[:3], setting))
    assert [rows for _, rows in results] == [[{"process": process.pid, "torque": 0.5}]] * 3


def own_motor(path, torque_constant):
    """A file with the published motor under another name, and with this torque constant."""
    lines = (ROOT / "sim_motor" / "motors.toml").read_text().split("[pybricks]")[1].split("\n[")[0]
    entries = [
        f"torque_constant = [{torque_constant}, 'N m/A', 'test']"
        if line.startswith("torque_constant")
        else line
        for line in lines.splitlines()
    ]
    path.write_text("\n".join(["[mine]", *entries]))
    return path


def test_experiments_take_the_motor_from_the_setting(tmp_path, monkeypatch):
    own = own_motor(tmp_path / "motors.toml", 0.5)
    monkeypatch.setenv("KICK_MOTORS", str(own))
    setting = Setting(1, {"kicks": 36, "trials": 1, "bounces": 1, "k": 2.0}, motor="mine")
    own.unlink()
    assert switching.Condition().constants(setting).torque_constant == 0.5
    for experiment in (kick_map, reliability, wall):
        cell = experiment.cells(setting.options, batch=True)[0]
        assert experiment.simulate(cell, setting) != []


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr(cluster, "NEXT_WORKER_S", 0.5)
    monkeypatch.setattr(cluster, "LOOK_S", 0.1)


@pytest.mark.usefixtures("impatient")
def test_a_worker_that_is_lost_for_good_is_said(address, count):
    with worker(address) as process:
        results = cluster.compute_on_cluster(address, count, CELLS, SETTING)
        next(results)
        process.kill()
        with pytest.raises(NoLink, match="has no worker"):
            list(results)


# Each of the 39 other results would be waited for.
@pytest.mark.timeout(60)
@pytest.mark.usefixtures("impatient")
def test_a_worker_that_is_lost_with_all_results_is_said_at_once(address, tmp_path, monkeypatch):
    last = tmp_path / "last"

    def mark(cell, setting):
        if cell == CELLS[-1]:
            last.touch()
        return [{}]

    with worker(address) as process:
        results = cluster.compute_on_cluster(address, mark, CELLS, SETTING)
        next(results)
        while not last.exists():
            time.sleep(0.01)
        process.kill()
        monkeypatch.setattr(cluster, "ANSWER_S", 2.0)
        with pytest.raises(NoLink, match="has no worker"):
            list(results)


def test_a_scheduler_that_falls_silent_is_said(count, monkeypatch):
    command = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--no-dashboard"]
    options = ["--host", "127.0.0.1", "--port", "0"]
    with subprocess.Popen([*command, *options], stderr=subprocess.PIPE, text=True) as scheduler:
        try:
            words = (
                re.search(r"Scheduler at: +(tcp://[\d.:]+)", line) for line in scheduler.stderr
            )
            address = next(filter(None, words)).group(1)
            with worker(address):
                results = cluster.compute_on_cluster(address, count, CELLS, SETTING)
                next(results)
                monkeypatch.setattr(cluster, "ANSWER_S", 0.5)
                scheduler.send_signal(signal.SIGSTOP)

                with pytest.raises(NoLink, match="does not answer"):
                    list(results)
        finally:
            scheduler.kill()
