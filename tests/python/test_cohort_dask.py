# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""python -m palpate.cohort dask on a scheduler and workers that are processes of their own, some of which are killed."""
import os
import signal
import subprocess
import sys
import time

import pytest

pytest.importorskip("distributed", reason="Dask is not installed (pip install palpate[dask])")

from palpate.cohort.dask_engine import Engine  # noqa: E402
from palpate.cohort.errors import STOPPED, CohortError  # noqa: E402
from tests.cli.test_cohort import assert_each_case_is_done_once, children_of, plan, rows_of, run, status, wait_until  # noqa: E402
from tests.cli.test_cohort_machines import broken  # noqa: E402
from tests.conftest import PROGRAM, run_palpate  # noqa: E402


@pytest.fixture(autouse=True)
def patient_limits(monkeypatch):
    """A busy machine is no hang."""
    monkeypatch.setattr("tests.cli.test_cohort.LIMITS", "[limits]\ntarget_seconds = 60\nattempts = 3\n")


class Cluster:
    """A scheduler and workers of one slot each, without the nanny that would start them again."""

    def __init__(self, folder):
        self.file, self.folder, self.workers = folder / "scheduler.json", folder, []
        self.scheduler = self.start("scheduler", "--scheduler-file", self.file, "--port", 0, "--host", "127.0.0.1", "--no-dashboard")
        wait_until(self.file.exists, 60)

    def start(self, *words, environment={}):
        return subprocess.Popen([sys.executable, "-m", "distributed.cli.dask_" + words[0], *map(str, words[1:])],
                                stdout=subprocess.DEVNULL, stderr=open(self.folder / "dask.txt", "a"), cwd=self.folder,
                                env={**os.environ, **environment})

    def add_worker(self, environment={}):
        self.workers.append(self.start("worker", "--scheduler-file", self.file, "--nthreads", 1, "--no-nanny", "--no-dashboard",
                                       "--local-directory", self.folder, "--death-timeout", 10, environment=environment))
        return self.workers[-1]

    def stop(self):
        for process in [*self.workers, self.scheduler]:
            process.kill()
            process.wait()


@pytest.fixture
def cluster(tmp_path):
    found = Cluster(tmp_path)
    for _ in range(2):
        found.add_worker()
    yield found
    found.stop()


def engine(cohort, *more):
    return subprocess.Popen([sys.executable, "-m", "palpate.cohort", "dask", str(cohort), "--program", str(PROGRAM), *map(str, more)],
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def end_of(process, seconds=240):
    out, errors = process.communicate(timeout=seconds)
    return process.returncode, out, errors


def tables_but_times(cohort):
    assert run_palpate("cohort", "collect", cohort).returncode == 0
    return [{k: v for k, v in row.items() if k not in ("seconds", "peak_memory_mb", "device", "host")}
            for row in rows_of(cohort / "pairs.tsv")]


def test_killed_workers_lose_nothing_and_their_cases_stop(cluster, tmp_path):
    (tmp_path / "dask").mkdir(), (tmp_path / "here").mkdir()
    cohort = plan(tmp_path / "dask", patients=16, cases=3, seconds=0.1)
    process = engine(cohort, "--scheduler-file", cluster.file)
    for kills in range(2):
        over = status(cohort)[1]["cases"]["done"]
        wait_until(lambda: status(cohort)[1]["cases"]["done"] > over + 3, 120)
        victim = cluster.workers[kills]
        drivers = children_of(victim.pid)
        victim.kill()
        wait_until(lambda: not any(os.path.exists(f"/proc/{driver}/exe") for driver in drivers), 4)
        cluster.add_worker()
    code, out, errors = end_of(process)
    assert code == 0, errors
    assert "48 done" in out
    assert_each_case_is_done_once(cohort, 48)
    other = plan(tmp_path / "here", patients=16, cases=3, seconds=0)
    run(other, "--jobs", 2)
    assert tables_but_times(cohort) == tables_but_times(other)


def test_without_its_scheduler_the_engine_ends_and_goes_on_with_another(cluster, tmp_path):
    cohort = plan(tmp_path, patients=12, cases=3, seconds=0.2)
    process = engine(cohort, "--scheduler-file", cluster.file)
    wait_until(lambda: status(cohort)[1]["cases"]["done"] > 3, 120)
    cluster.scheduler.kill()
    begin = time.monotonic()
    code, _, errors = end_of(process)
    assert code == 9 and "the scheduler is gone" in errors and time.monotonic() - begin < 120, errors
    code, out, errors = end_of(engine(cohort, "--jobs", 2))
    assert code == 0 and "36 done" in out, errors
    assert_each_case_is_done_once(cohort, 36)


class ClientOfNobody:
    """Does not know yet that its scheduler has gone."""
    status = "running"

    def nthreads(self):
        raise OSError("connection reset")


def test_whichever_call_sees_first_that_the_scheduler_is_gone():
    with pytest.raises(CohortError, match="the scheduler is gone") as caught:
        Engine(ClientOfNobody(), "palpate", "cohort", 3).run(print)
    assert caught.value.status == STOPPED


class ClientThatLoses(ClientOfNobody):
    """One worker that loses the first six shards at once, and works from then on."""

    def __init__(self):
        self.handed_out = 0

    def nthreads(self):
        return {"tcp://worker": 3}

    def submit(self, *_, **__):
        self.handed_out += 1
        return Future(self.handed_out <= 6)


class Future:
    def __init__(self, lost):
        self.status = "cancelled" if lost else "finished"

    def result(self):
        return 0, "", "tcp://worker"


def test_many_shards_lost_at_once_are_one_loss(monkeypatch):
    monkeypatch.setattr("distributed.wait", lambda *_, **__: None)
    monkeypatch.setattr("palpate.cohort.dask_engine.status_of",
                        lambda *_: {"cases": {"done": 0, "not converged": 0, "failed": 0}})
    lost = Engine(ClientThatLoses(), "palpate", "cohort", 8)
    lost.run(lambda over: None)
    assert lost.lost == 6 and not lost.waiting and not lost.running


def test_a_signal_stops_the_engine_and_what_it_started(cluster, tmp_path):
    cohort = plan(tmp_path, patients=4, cases=2, seconds=5)
    process = engine(cohort, "--scheduler-file", cluster.file)
    wait_until(lambda: status(cohort)[1]["in_work"] == 2, 120)
    process.send_signal(signal.SIGTERM)
    code, _, errors = end_of(process)
    assert code == 9 and "goes on" in errors
    wait_until(lambda: status(cohort)[1]["in_work"] == 0, 60)
    assert status(cohort)[1]["cases"]["waiting"] == 8


def test_a_worker_whose_machine_is_broken_gets_no_more(cluster, tmp_path):
    cohort = plan(tmp_path, patients=40, cases=1, seconds=0.1)
    bad = cluster.add_worker(broken(tmp_path, signal.SIGILL))
    code, out, errors = end_of(engine(cohort, "--scheduler-file", cluster.file))
    assert code == 0 and "40 done" in out, errors
    assert errors.count("gets no more work") == 1 and "tiny phantom" in errors and bad.poll() is None
    assert_each_case_is_done_once(cohort, 40)


def test_workers_that_are_all_broken_end_the_engine(cluster, tmp_path):
    cohort = plan(tmp_path, patients=4, cases=1, seconds=0)
    for worker in cluster.workers:
        worker.kill()
    for _ in range(2):
        cluster.add_worker(broken(tmp_path, signal.SIGILL))
    code, _, errors = end_of(engine(cohort, "--scheduler-file", cluster.file))
    assert code == 8 and "no worker is left whose machine works" in errors and "Traceback" not in errors, errors
    cases = status(cohort)[1]["cases"]
    assert cases["waiting"] == 4 and cases["done"] == cases["failed"] == 0


def test_work_kept_for_workers_that_have_gone_is_given_to_others(cluster, tmp_path):
    """After the broken one was left out, the two that tasks are kept for are killed and another one comes."""
    cohort = plan(tmp_path, patients=24, cases=1, seconds=0.5)
    cluster.add_worker(broken(tmp_path, signal.SIGILL))
    process = engine(cohort, "--scheduler-file", cluster.file)
    wait_until(lambda: status(cohort)[1]["cases"]["done"] > 6, 120)
    for worker in cluster.workers[:2]:
        worker.kill()
    cluster.add_worker()
    code, out, errors = end_of(process)
    assert code == 0 and "24 done" in out, errors
    assert_each_case_is_done_once(cohort, 24)


def test_failed_cases_end_the_engine_with_their_code(tmp_path):
    cohort = plan(tmp_path, patients=1, cases=1, ids=("fail-4", "crash-1"), seconds=0)
    code, out, errors = end_of(engine(cohort, "--jobs", 1))
    assert code == 7 and "1 done, 0 not converged, 2 failed" in out, errors


@pytest.mark.parametrize("words, code, sentence", [
    (["--jobs", "0"], 2, "allowed are 1 and more"),
    (["--scheduler-file", "missing.json"], 2, "there is no such file"),
    (["--scheduler", "tcp://127.0.0.1:1"], 2, "no Dask scheduler answers"),
    (["--program", "/no/palpate"], 2, "is not found"),
])
def test_mistakes(tmp_path, words, code, sentence):
    cohort = plan(tmp_path, patients=1, cases=1, seconds=0)
    found, _, errors = end_of(engine(cohort, *words))
    assert found == code and sentence in errors and "Traceback" not in errors, errors


def test_a_folder_without_a_plan(tmp_path):
    code, _, errors = end_of(engine(tmp_path))
    assert code == 3 and "there is no plan.json" in errors
