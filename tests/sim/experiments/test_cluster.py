"""Simulations spread over a Dask cluster of two worker processes.

The results stay the same even if a worker dies.
"""

import csv
import os
import signal
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from host.errors import NoLink, WrongUse
from host.experiments.robot import kick_map
from host.perform.run import perform
from host.runs.cluster import compute_on_cluster
from host.runs.contract import Setting

KICKS = 36 * 30


@pytest.fixture(scope="module", autouse=True)
def _copies():
    """Workers begin as copies of a process that has loaded Dask."""
    import dask

    with dask.config.set({"distributed.worker.multiprocessing-method": "forkserver"}):
        yield


@pytest.fixture(scope="module")
def cluster():
    """Two processes of one thread each."""
    from distributed import LocalCluster

    with LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0"
    ) as cluster:
        yield cluster


def test_a_cluster_gives_the_same_bits(cluster, tmp_path, monkeypatch):
    monkeypatch.setattr("host.figures.robot.kick_map.draw", lambda rows, findings: Figure())
    there = perform(
        "kick-map", kicks=KICKS, seed=3, out=tmp_path, scheduler=cluster.scheduler_address
    )
    setting = Setting(3, {"kicks": KICKS})
    cells = kick_map.cells(setting.options, batch=True)
    here = [{**cell, **row} for cell in cells for row in kick_map.simulate(cell, setting)]
    with Path(there["tables"][0]).open(encoding="utf-8", newline="") as table:
        assert list(csv.DictReader(table)) == [
            {name: str(value) for name, value in row.items()} for row in here
        ]
    assert there["numbers"] == kick_map.report(here, setting).numbers
    assert there["numbers"]["kicks"] > 0.9 * KICKS


def test_a_study_of_the_model_has_the_same_numbers_from_a_cluster(cluster, tmp_path, monkeypatch):
    monkeypatch.setattr("host.figures.theory.hopf.draw", lambda rows, findings: Figure())
    there = perform("hopf", out=tmp_path / "there", scheduler=cluster.scheduler_address)
    here = perform("hopf", out=tmp_path / "here")
    assert there["numbers"] == here["numbers"]
    for table, other in zip(there["tables"], here["tables"], strict=True):
        assert Path(table).read_bytes() == Path(other).read_bytes()


def test_a_sweep_has_the_same_table_from_a_cluster(cluster, tmp_path, monkeypatch):
    monkeypatch.setattr("host.figures.sweep.draw", lambda rows, findings: Figure())
    swept = {"tau": [0.25, 1.0], "f": [0.0, 0.5]}  # without friction there is no bifurcation
    there = perform("hopf", out=tmp_path / "there", scheduler=cluster.scheduler_address, **swept)
    here = perform("hopf", out=tmp_path / "here", **swept)
    assert [row["f"] for row in there["numbers"]["rows"] if row["failed"]] == [0.0, 0.0]
    table, other = Path(there["tables"][0]), Path(here["tables"][0])
    assert table.read_bytes() == other.read_bytes()


@pytest.fixture
def scramble():
    """A simulation that takes a while, which no compiler shortens.

    Defined in here, so that it travels to workers as it is.
    """

    def scramble(cell, setting):
        number = setting.seed_of(cell)
        for _ in range(100000):
            number = number * 6364136223846793005 % 2**64 + 1442695040888963407
        return [{"number": number}]

    return scramble


CELLS = [{"cell": number} for number in range(60)]
SETTING = Setting(5, {})


def scrambled(cell):
    """The same at once: with a factor a and a summand c, a^n x + c (a^n - 1) / (a - 1)."""
    factor, summand, modulus = 6364136223846793005, 1442695040888963407, 2**64
    power = pow(factor, 100000, (factor - 1) * modulus)
    number = power * SETTING.seed_of(cell) + summand * ((power - 1) // (factor - 1))
    return [{"number": (number - summand) % modulus + summand}]


def test_nothing_is_lost_with_a_worker_that_is_killed(cluster, scramble):
    results = compute_on_cluster(cluster.scheduler_address, scramble, CELLS, SETTING)
    done = [next(results)]
    victim = next(iter(cluster.workers.values())).pid
    os.kill(victim, signal.SIGKILL)
    done += results
    assert sorted(cell["cell"] for cell, _ in done) == list(range(60))
    assert all(rows == scrambled(cell) for cell, rows in done)
    assert victim not in {nanny.pid for nanny in cluster.workers.values()}


def test_a_result_that_is_lost_with_its_worker_may_take_long_to_compute_again(
    cluster, tmp_path, monkeypatch
):
    def simulate(cell, _):
        import time

        trace = tmp_path / f"{cell['cell']}"
        time.sleep(3 if trace.exists() else 0)
        trace.touch()
        return []

    cells = [{"cell": number} for number in range(4)]
    results = compute_on_cluster(cluster.scheduler_address, simulate, cells, SETTING)
    done = [next(results)]
    while any(task.state != "memory" for task in cluster.scheduler.tasks.values()):
        os.sched_yield()
    loaded = max(cluster.scheduler.workers.values(), key=lambda worker: len(worker.has_what))
    victim = next(n for n in cluster.workers.values() if n.worker_address == loaded.address)
    os.kill(victim.pid, signal.SIGKILL)
    monkeypatch.setattr("host.runs.cluster.ANSWER_S", 1.5)
    done += results
    assert sorted(cell["cell"] for cell, _ in done) == list(range(4))


def test_a_cluster_that_is_lost_in_the_middle_is_reported_in_words(scramble):
    from distributed import LocalCluster

    with LocalCluster(
        n_workers=1, threads_per_worker=1, processes=True, dashboard_address=":0"
    ) as brief:
        results = compute_on_cluster(brief.scheduler_address, scramble, CELLS, SETTING)
        next(results)
    with pytest.raises(NoLink, match="was lost"):
        list(results)


def test_a_missing_scheduler_is_reported_in_words(monkeypatch):
    monkeypatch.setattr("host.runs.cluster.ANSWER_S", 0.5)
    with pytest.raises(NoLink, match="no Dask scheduler answers"):
        next(compute_on_cluster("tcp://127.0.0.1:1", kick_map.simulate, [], Setting(1, {})))


def test_a_robot_is_not_spread(tmp_path):
    with pytest.raises(WrongUse, match="--scheduler"):
        perform(
            "kick-map", "tcp://127.0.0.1:1", kicks=36, out=tmp_path, scheduler="tcp://127.0.0.1:1"
        )
