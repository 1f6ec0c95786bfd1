# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""python -m palpate.cohort dask on a scheduler and workers that are processes of their own, some of which are killed."""
import collections
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
import types

import pytest

distributed = pytest.importorskip("distributed", reason="Dask is not installed (pip install palpate[dask])")

from palpate.cohort.dask_engine import Engine, Task, asking_the_scheduler, run_shard, slots_of_first_workers  # noqa: E402
from palpate.cohort.errors import DEVICE_FAILED, STOPPED, CohortError  # noqa: E402
from tests.cli.test_cohort import assert_each_case_is_done_once, children_of, plan, rows_of, run, status, wait_until  # noqa: E402
from tests.cli.test_cohort_machines import broken  # noqa: E402
from tests.conftest import PROGRAM, run_palpate  # noqa: E402
from tests.dask_cluster import Cluster  # noqa: E402


@pytest.fixture(autouse=True)
def patient_limits(monkeypatch):
    """A busy machine is no hang."""
    monkeypatch.setattr("tests.cli.test_cohort.LIMITS", "[limits]\ntarget_seconds = 60\nattempts = 3\n")


@pytest.fixture
def cluster(tmp_path):
    found = Cluster(tmp_path)
    for _ in range(2):
        found.add_worker()
    yield found
    found.stop()


IMPATIENT = """
import sys
from palpate.cohort import __main__, dask_engine
dask_engine.{limit} = {seconds}
sys.exit(__main__.main())
"""


def impatient(limit, seconds):
    return "-c", IMPATIENT.format(limit=limit, seconds=seconds)


def engine(cohort, *more, start=("-m", "palpate.cohort"), stderr=subprocess.PIPE):
    return subprocess.Popen([sys.executable, *start, "dask", str(cohort), "--program", str(PROGRAM), *map(str, more)],
                            stdout=subprocess.PIPE, stderr=stderr, text=True)


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


def test_a_scheduler_that_does_not_answer_ends_the_engine(cluster, tmp_path):
    cohort = plan(tmp_path, patients=12, cases=3, seconds=0.2)
    process = engine(cohort, "--scheduler-file", cluster.file, start=impatient("SECONDS_FOR_AN_ANSWER", 5))
    wait_until(lambda: status(cohort)[1]["cases"]["done"] > 3, 120)
    cluster.scheduler.send_signal(signal.SIGSTOP)
    begin = time.monotonic()
    code, _, errors = end_of(process)
    assert code == 9 and "has not answered for 5 s" in errors and time.monotonic() - begin < 120, errors


def test_a_signal_stops_the_engine_and_what_it_started(cluster, tmp_path):
    cohort = plan(tmp_path, patients=4, cases=2, seconds=5)
    process = engine(cohort, "--scheduler-file", cluster.file)
    wait_until(lambda: status(cohort)[1]["in_work"] == 2, 120)
    process.send_signal(signal.SIGTERM)
    code, _, errors = end_of(process)
    assert code == 9 and "goes on" in errors
    wait_until(lambda: status(cohort)[1]["in_work"] == 0, 60)
    assert status(cohort)[1]["cases"]["waiting"] == 8


def test_an_engine_that_is_stopped_leaves_those_of_others_alone(cluster, tmp_path):
    (tmp_path / "stopped").mkdir(), (tmp_path / "other").mkdir()
    stopped = plan(tmp_path / "stopped", patients=1, cases=1, seconds=40)
    other = plan(tmp_path / "other", patients=1, cases=1, seconds=8)
    first = engine(stopped, "--scheduler-file", cluster.file)
    wait_until(lambda: status(stopped)[1]["in_work"] == 1, 120)
    second = engine(other, "--scheduler-file", cluster.file)
    wait_until(lambda: status(other)[1]["in_work"] == 1, 120)
    first.send_signal(signal.SIGTERM)
    assert end_of(first)[0] == 9
    wait_until(lambda: status(stopped)[1]["in_work"] == 0, 20)
    code, out, errors = end_of(second)
    assert code == 0 and "1 done" in out and "; 0 tasks were lost" in out, errors


def test_a_worker_whose_machine_is_broken_gets_no_more(cluster, tmp_path):
    cohort = plan(tmp_path, patients=40, cases=1, seconds=0.3)
    bad = cluster.add_worker(broken(tmp_path, signal.SIGILL))
    with cluster.client() as client:
        client.wait_for_workers(3, timeout=120)
    code, out, errors = end_of(engine(cohort, "--scheduler-file", cluster.file))
    assert code == 0 and "40 done" in out, errors
    assert errors.count("gets no more work") == 1 and "tiny phantom" in errors and bad.poll() is None
    assert "nor do other workers" not in errors
    # A patient and the phantom twice, of each of the six shards that were with the scheduler before anything was known.
    assert 3 <= (tmp_path / "count").stat().st_size <= 18
    assert_each_case_is_done_once(cohort, 40)


def test_workers_that_are_all_broken_end_the_engine(cluster, tmp_path):
    cohort = plan(tmp_path, patients=4, cases=1, seconds=0)
    for worker in cluster.workers:
        worker.kill()
    for _ in range(2):
        cluster.add_worker(broken(tmp_path, signal.SIGILL))
    code, _, errors = end_of(engine(cohort, "--scheduler-file", cluster.file, start=impatient("SECONDS_FOR_OTHER_WORKERS", 3)))
    assert code == 8 and "no worker is left whose machine works" in errors and "Traceback" not in errors, errors
    assert errors.count("waiting for workers whose machine works") == 1
    cases = status(cohort)[1]["cases"]
    assert cases["waiting"] == 4 and cases["done"] == cases["failed"] == 0


def tasks_that_are_kept(client):
    """Of every task with the scheduler, whether it is for some workers only."""
    def kept(dask_scheduler):
        return [bool(task.worker_restrictions) for task in dask_scheduler.tasks.values()]

    return client.run_on_scheduler(kept)


def test_work_kept_for_workers_that_have_gone_is_given_to_others(cluster, tmp_path):
    """First there is a broken one alone, then two that all tasks are kept for; these are killed, and another one comes."""
    cohort = plan(tmp_path, patients=24, cases=1, seconds=0.5)
    for worker in cluster.workers:
        worker.kill()
    cluster.add_worker(broken(tmp_path, signal.SIGILL))
    with open(tmp_path / "errors.txt", "w") as errors, cluster.client() as client:
        process = engine(cohort, "--scheduler-file", cluster.file, stderr=errors)
        wait_until(lambda: "gets no more work" in (tmp_path / "errors.txt").read_text(), 120)
        good = [cluster.add_worker() for _ in range(2)]
        wait_until(lambda: all(kept := tasks_that_are_kept(client)) and len(kept) == 4, 120)
    for worker in good:
        worker.kill()
    cluster.add_worker()
    code, out, _ = end_of(process)
    assert code == 0 and "24 done" in out, (tmp_path / "errors.txt").read_text()
    assert_each_case_is_done_once(cohort, 24)


def test_failed_cases_end_the_engine_with_their_code(tmp_path):
    cohort = plan(tmp_path, patients=1, cases=1, ids=("fail-4", "crash-1"), seconds=0)
    code, out, errors = end_of(engine(cohort, "--jobs", 1))
    assert code == 7 and "1 done, 0 not converged, 2 failed" in out, errors


@pytest.mark.parametrize("words, code, sentence", [
    (["--jobs", "0"], 2, "allowed are 1 and more"),
    (["--scheduler-file", "missing.json"], 2, "there is no such file"),
    (["--scheduler-file", "pairs.tsv"], 3, "there is no address of a scheduler in it"),
    (["--scheduler", "tcp://127.0.0.1:1"], 2, "no Dask scheduler answers"),
    (["--scheduler", "nowhere://127.0.0.1:1"], 2, "no Dask scheduler answers"),
    (["--program", "/no/palpate"], 2, "is not found"),
])
def test_mistakes(tmp_path, monkeypatch, words, code, sentence):
    cohort = plan(tmp_path, patients=1, cases=1, seconds=0)
    monkeypatch.chdir(tmp_path)
    found, _, errors = end_of(engine(cohort, *words))
    assert found == code and sentence in errors and "Traceback" not in errors, errors


def test_a_folder_without_a_plan(tmp_path):
    code, _, errors = end_of(engine(tmp_path))
    assert code == 3 and "there is no plan.json" in errors


class Client:
    """Of workers without processes, which change from look to look as `looks` has them (the last stay). A task ends at once where the
    fewest were, with code 8 on a broken one; on a slow one only after 20 looks."""
    status = "running"

    def __init__(self, *looks, broken=(), slow=()):
        self.looks, self.broken, self.slow, self.number, self.workers = looks, broken, slow, 0, ()
        self.handed_out = collections.Counter()

    def nthreads(self):
        self.workers = self.looks[min(self.number, len(self.looks) - 1)]
        self.number += 1
        assert self.number < 2000, "this never ends"
        return dict.fromkeys(self.workers, 1)

    def submit(self, *_, workers=None, **__):
        return Future(self, workers)


class Future:
    def __init__(self, client, allowed=None):
        self.client, self.allowed, self.worker, self.cancelled = client, allowed, None, False

    @property
    def status(self):
        if self.worker not in self.client.workers:
            able = [worker for worker in self.client.workers if self.allowed is None or worker in self.allowed]
            self.worker = min(able, key=lambda worker: self.client.handed_out[worker], default=None)
            self.client.handed_out[self.worker] += 1
        return "pending" if self.worker is None or self.worker in self.client.slow and self.client.number < 20 else "finished"

    def result(self, timeout):
        return (8 if self.worker in self.client.broken else 0), "", self.worker

    def cancel(self):
        self.cancelled = True


@pytest.fixture
def quick(monkeypatch):
    """For engines whose client is none."""
    monkeypatch.setattr("distributed.wait", lambda *_, **__: time.sleep(0.001))
    monkeypatch.setattr("palpate.cohort.dask_engine.SECONDS_BETWEEN_LOOKS", 0.001)
    monkeypatch.setattr("palpate.cohort.dask_engine.SECONDS_FOR_OTHER_WORKERS", 0.1)
    monkeypatch.setattr("palpate.cohort.dask_engine.status_of",
                        lambda *_: {"cases": {"done": 0, "not converged": 0, "failed": 0}})


def ran(client, shards):
    """The engine after all of them were run."""
    found = Engine(client, "palpate", "cohort", shards)
    found.run(lambda over: None)
    assert not found.waiting and not found.running
    return found


def status_of_end(client, shards):
    with pytest.raises(CohortError) as caught:
        ran(client, shards)
    return caught.value.status


A1, A2, A3, B1 = "tcp://a:1", "tcp://a:2", "tcp://a:3", "tcp://b:1"


def test_many_shards_lost_at_once_are_one_loss(quick, monkeypatch):
    ends = iter([(STOPPED, "", A1)] * 6)
    monkeypatch.setattr(Future, "result", lambda self, timeout: next(ends, (0, "", A1)))
    assert ran(Client((A1, A2, A3)), 8).lost == 6


def test_a_result_that_does_not_come_is_a_lost_shard(quick, monkeypatch):
    errors = iter([distributed.TimeoutError(), distributed.CancelledError(), OSError()])

    def result(self, timeout=None):
        assert timeout, "this may never end"
        if error := next(errors, None):
            raise error
        return 0, "", A1

    monkeypatch.setattr(Future, "result", result)
    assert ran(Client((A1,)), 5).lost == 3


def test_a_result_that_does_not_come_as_the_scheduler_is_gone(quick, monkeypatch):
    asked = []

    def result(self, timeout):
        asked.append(self)
        self.client.status = "connecting"
        raise distributed.CancelledError

    monkeypatch.setattr(Future, "result", result)
    assert status_of_end(Client((A1,)), 5) == STOPPED and len(asked) == 1


@pytest.mark.parametrize("call", ["nthreads", "submit"])
def test_whichever_call_sees_first_that_the_scheduler_is_gone(quick, monkeypatch, call):
    def gone(*_, **__):
        raise OSError("connection reset")

    monkeypatch.setattr(Client, call, gone)
    assert status_of_end(Client((A1,)), 3) == STOPPED


def test_of_errors_only_those_of_a_lost_scheduler_mean_run_again():
    closed = getattr(distributed.client, "ClosedClientError", OSError)
    for error in (OSError, distributed.comm.CommClosedError, distributed.CancelledError, distributed.TimeoutError, closed):
        with pytest.raises(CohortError, match="the scheduler is gone") as caught, asking_the_scheduler(Client(())):
            raise error
        assert caught.value.status == STOPPED
    with pytest.raises(pickle.PicklingError), asking_the_scheduler(Client(())):
        raise pickle.PicklingError
    with pytest.raises(CohortError), asking_the_scheduler(types.SimpleNamespace(status="closed")):
        raise RuntimeError("IOLoop is closed")


def test_waiting_ends_by_the_error_that_dask_has_for_it(quick, monkeypatch):
    """Before Python 3.11 it is not the builtin of that name."""
    class OldTimeoutError(Exception):
        pass

    def wait(*_, **__):
        raise OldTimeoutError

    monkeypatch.setattr("distributed.TimeoutError", OldTimeoutError)
    monkeypatch.setattr("distributed.wait", wait)
    ran(Client((A1,)), 5)


@pytest.mark.parametrize("looks", [[(A1,)], [(A1, B1), (A1, B1), (A1,)], [(A1, B1), (), (A1,)]])
def test_where_only_broken_workers_are_left_waiting_has_an_end(quick, capsys, looks):
    assert status_of_end(Client(*looks, broken=(A1,)), 40) == DEVICE_FAILED
    assert capsys.readouterr().err.count("waiting for workers whose machine works") == 1


@pytest.mark.parametrize("looks", [[(A1,)] * 8 + [(A1, B1)], [(A1, B1)] * 2 + [(A1,)] * 8 + [(A1, B1)]])
def test_workers_that_come_meanwhile_go_on(quick, capsys, looks):
    assert ran(Client(*looks, broken=(A1,)), 40).lost == 0
    assert capsys.readouterr().err.count("waiting for workers whose machine works") == 1


def test_where_there_are_no_workers_it_is_said_once(quick, capsys):
    ran(Client((A1,), *[()] * 200, (A2,)), 40)
    assert capsys.readouterr().err.count("waiting for workers") == 1


def test_the_host_of_two_broken_workers_gets_no_more(quick):
    client = Client((A1, A2, B1), (A1, A2, A3, B1), broken=(A1, A2, A3))
    ran(client, 40)
    assert client.handed_out[A3] == 0 and client.handed_out[B1] >= 30


def test_a_worker_that_comes_back_on_another_port_is_known(quick):
    client = Client((A1, B1), (A2, B1), (A3, B1), broken=(A1, A2, A3))
    ran(client, 40)
    assert client.handed_out[A3] == 0


def test_a_host_on_which_shards_end_well_is_not_left_out(quick):
    """As on one machine, of which all workers have the loopback address."""
    assert ran(Client((A1, A2, A3), broken=(A1, A2)), 40).workers.good() == {A3: 1}


def test_broken_workers_that_come_and_go_have_an_end(quick, monkeypatch):
    monkeypatch.setattr("palpate.cohort.dask_engine.SECONDS_FOR_OTHER_WORKERS", 1000)
    hosts = [f"tcp://host{k}:1" for k in range(100)]
    client = Client(*[(host,) for host in hosts], broken=hosts)
    assert status_of_end(client, 40) == DEVICE_FAILED and client.number < 20


def test_many_broken_workers_are_no_end_while_another_is_at_its_first_case(quick):
    hosts = [f"tcp://host{k}:1" for k in range(15)]
    assert ran(Client(*[(B1, *hosts[:k]) for k in range(15)], broken=hosts, slow=(B1,)), 100).workers.broken >= set(hosts[:10])


def test_a_worker_without_the_program_is_a_broken_one(monkeypatch, tmp_path):
    monkeypatch.setattr("distributed.get_worker", lambda: types.SimpleNamespace(address=A1))
    code, errors, worker = run_shard(str(tmp_path / "palpate"), "cohort", 1, 2, "id")
    assert (code, worker) == (DEVICE_FAILED, A1) and f"{tmp_path}/palpate is not found there" in errors


@pytest.mark.parametrize("code", [126, 127])
def test_a_worker_on_which_the_program_does_not_start_is_a_broken_one(quick, monkeypatch, code):
    monkeypatch.setattr(Future, "result", lambda self, timeout: (code if self.worker == A1 else 0, "", self.worker))
    found = ran(Client((A1, B1)), 4)
    assert found.workers.broken == {A1} and "does not start there" in found.workers.why


def test_a_scheduler_that_does_not_answer_before_there_are_workers(monkeypatch):
    monkeypatch.setattr("palpate.cohort.dask_engine.SECONDS_FOR_AN_ANSWER", 0.2)
    never = threading.Event()
    client = types.SimpleNamespace(status="running", nthreads=never.wait)
    with pytest.raises(CohortError, match="has not answered") as caught:
        slots_of_first_workers(client, types.SimpleNamespace(scheduler="tcp://a:1", scheduler_file=None, jobs=1))
    assert caught.value.status == STOPPED
    never.set()


def test_work_is_taken_back_from_workers_that_have_gone_only():
    client = Client(())
    found = Engine(client, "palpate", "cohort", 0)
    gone, left_out, free = (Future(client) for _ in range(3))
    found.running = {gone: Task(1, frozenset({A1, A2})), left_out: Task(2, frozenset({A1, B1})), free: Task(3, None)}
    found.workers.there = {B1: 4}
    found.workers.fails(B1, "of another shard there")
    found.take_back_what_nobody_may_run()
    assert list(found.running) == [left_out, free] and list(found.waiting) == [1]
    assert gone.cancelled and not left_out.cancelled and not free.cancelled


def test_a_stop_reaches_the_workers_and_has_an_end(monkeypatch):
    monkeypatch.setattr("palpate.cohort.dask_engine.SECONDS_TO_STOP", 0.2)
    asked, never = [], threading.Event()

    def run(function, engine, on_error):
        asked.append(engine)
        never.wait()

    client = types.SimpleNamespace(status="running", run=run)  # and no `cancel`
    found = Engine(client, "palpate", "cohort", 3)
    found.stop()
    assert asked == [found.id]
    never.set()


def test_workers_of_this_machine_that_are_late_are_not_waited_for():
    def wait_for_workers(number, timeout):
        raise distributed.TimeoutError

    client = types.SimpleNamespace(status="running", wait_for_workers=wait_for_workers, nthreads=lambda: {A1: 1, A2: 1})
    assert slots_of_first_workers(client, types.SimpleNamespace(scheduler=None, scheduler_file=None, jobs=3)) == 2
