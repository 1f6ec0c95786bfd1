# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""A planned cohort on the workers of a Dask scheduler.

A task is a shard of the plan, run by the program as anywhere else: `palpate cohort run COHORT --shard K/N`. What is done, and by
whom, is said by the cohort's folder alone; what Dask says of a task is only a reason to look there. Workers need the program and
the folder, not this package.
"""
from __future__ import annotations

import contextlib
import dataclasses
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import threading
import time
import urllib.parse
import uuid
from collections import deque

from .errors import DAMAGED_FILE, DEVICE_FAILED, NOT_CONVERGED, OUTPUT_FAILED, STOPPED, WRONG_OPTION, CohortError

SHARDS_PER_SLOT, WINDOW_PER_SLOT = 8, 2
MOST_TRIES_WITHOUT_PROGRESS = 5
SECONDS_BETWEEN_LOOKS = 1.0
SECONDS_FOR_A_RESULT, SECONDS_TO_STOP = 15.0, 10.0
SECONDS_FOR_AN_ANSWER = 300.0  # of a scheduler that is busy, or stopped, while its machine still answers
SECONDS_FOR_OTHER_WORKERS = 60.0  # to come, where all that are there are broken
BROKEN_WORKERS_OF_A_BROKEN_HOST = 2
CANNOT_START = (126, 127)  # of setpriv and of the loader: a library is missing there


def find_program(given: str | None) -> str:
    """The palpate that workers are to start. Raises CohortError where there is none."""
    found = shutil.which(given or os.environ.get("PALPATE", "palpate"))
    if found is None:
        raise CohortError(f"the program {given or 'palpate'} is not found; name it with --program", WRONG_OPTION)
    return os.path.abspath(found)


def status_of(program: str, cohort: str) -> dict:
    """What `palpate cohort status --json` counts, and its exit code as `code`. Raises CohortError with its sentence."""
    found = subprocess.run([program, "cohort", "status", cohort, "--json"], capture_output=True, text=True)
    if found.returncode not in (0, NOT_CONVERGED, STOPPED):
        raise CohortError(found.stderr.strip().removeprefix("palpate: "), found.returncode)
    return {**json.loads(found.stdout), "code": found.returncode}


def run_shard(program: str, cohort: str, number: int, count: int, engine: str) -> tuple[int, str, str]:
    """On a worker: (exit code, end of standard error, the worker's address). The program ends with the worker, however that ends; a
    worker keeps what it runs, and for which engine, as `palpate_processes`, so that `stop_on_worker` finds it. Sent by value: may use
    nothing of this module."""
    import shutil
    import subprocess

    from distributed import get_worker

    worker = get_worker()
    if shutil.which(program) is None:
        return 8, f"{program} is not found there, or may not be started", worker.address
    command = [program, "cohort", "run", cohort, "--shard", f"{number}/{count}", "--progress", "none", "--keep-going"]
    # It may not outlive the thread that started it, and its children not it: else a killed worker's cases go on unseen.
    if shutil.which("setpriv"):
        command = ["setpriv", "--pdeathsig", "TERM", *command]
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    worker.__dict__.setdefault("palpate_processes", {})[process] = engine
    try:
        errors = process.communicate()[1]
    finally:
        del worker.palpate_processes[process]
    return process.returncode, errors[-2000:], worker.address


def stop_on_worker(engine: str, dask_worker=None) -> None:
    """What runs there for this engine ends as at Ctrl-C: nothing is half written. Other engines may share the scheduler."""
    for process, owner in list(getattr(dask_worker, "palpate_processes", {}).items()):
        if owner == engine:
            process.terminate()


def scheduler_is_gone(error: BaseException) -> CohortError:
    return CohortError(f"the scheduler is gone ({type(error).__name__}); what is done stays: start it, and this command again", STOPPED)


@contextlib.contextmanager
def asking_the_scheduler(client):
    """Around a call that needs its answer: its end may be seen here first, as any of several errors. Raises CohortError then; an error
    of another kind is a defect, which the same command would only meet again, and stays as it is."""
    import distributed

    closed = getattr(distributed.client, "ClosedClientError", OSError)  # older versions have none
    try:
        yield
    except CohortError:
        raise
    except Exception as error:
        if client.status == "running" and not isinstance(error, (OSError, distributed.CancelledError, distributed.TimeoutError, closed)):
            raise
        raise scheduler_is_gone(error) from error


def answer_in_time(ask, seconds: float):
    """What `ask` returns or raises. Raises CohortError where it does neither in time: Dask itself has no limit for a scheduler that is
    there and does not answer."""
    found: dict = {}

    def call():
        try:
            found["answer"] = ask()
        except BaseException as error:
            found["error"] = error

    asking = threading.Thread(target=call, daemon=True)
    asking.start()
    asking.join(seconds)
    if asking.is_alive():
        raise CohortError(f"the scheduler has not answered for {seconds:.0f} s; what is done stays: see to it, and start this command again", STOPPED)
    if "error" in found:
        raise found["error"]
    return found["answer"]


def host_of(worker: str) -> str:
    return urllib.parse.urlsplit(worker).hostname or worker


class Workers:
    """Who is there, and whose machine works. Broken is a worker that ended a shard with code 8; and its whole host, as addresses name it,
    once two workers there have done so and no shard has ended well there since the first: not each process of such a machine need fail,
    and one that starts again on another port is known. A shard that ends well there gives the host back, not its broken workers."""

    def __init__(self):
        self.there: dict[str, int] = {}  # address -> slots
        self.broken: set[str] = set()
        self.failing: dict[str, set[str]] = {}  # host -> its broken workers since a shard ended well there
        self.why = ""  # of the last one

    def is_good(self, worker: str) -> bool:
        return worker not in self.broken and len(self.failing.get(host_of(worker), ())) < BROKEN_WORKERS_OF_A_BROKEN_HOST

    def good(self) -> dict[str, int]:
        return {worker: slots for worker, slots in self.there.items() if self.is_good(worker)}

    def works(self, worker: str) -> None:
        self.failing.pop(host_of(worker), None)

    def fails(self, worker: str, why: str) -> None:
        if worker in self.broken:
            return
        self.why, host = why, host_of(worker)
        self.broken.add(worker)
        print(f"palpate.cohort: {worker} gets no more work: {why}", file=sys.stderr)
        failing = self.failing.setdefault(host, set())
        failing.add(worker)
        if len(failing) == BROKEN_WORKERS_OF_A_BROKEN_HOST:
            print(f"palpate.cohort: nor do other workers of {host}, as nothing has worked there since", file=sys.stderr)


@dataclasses.dataclass
class Task:
    shard: int
    allowed: frozenset | None  # workers that may take it; None: all


class Engine:
    """Keeps a few shards more than there are slots with the scheduler, and gives back to it what a lost worker had. Broken workers
    get no more of them."""

    def __init__(self, client, program: str, cohort: str, shards: int):
        import cloudpickle

        cloudpickle.register_pickle_by_value(sys.modules[__name__])  # workers need not have this package
        self.client, self.program, self.cohort, self.count = client, program, cohort, shards
        self.id = uuid.uuid4().hex
        self.waiting = deque(range(1, shards + 1))
        self.running: dict = {}  # future -> Task
        self.workers, self.who, self.since = Workers(), "good", 0.0  # who is there, as the last look found it, and since when
        self.lost = self.tries_without_progress = 0
        self.over = -1  # cases, at the last loss

    def look_at_workers(self) -> None:
        """Where there is none to work it is said, once; waiting for one ends only where broken ones are there. Raises CohortError."""
        with asking_the_scheduler(self.client):
            self.workers.there = answer_in_time(self.client.nthreads, SECONDS_FOR_AN_ANSWER)
        who = "good" if self.workers.good() else "broken" if self.workers.there else "none"
        if who != self.who:
            self.who, self.since = who, time.monotonic()
            if who == "broken":
                print(f"palpate.cohort: waiting for workers whose machine works, for {SECONDS_FOR_OTHER_WORKERS:.0f} s", file=sys.stderr)
            elif who == "none":
                print("palpate.cohort: waiting for workers", file=sys.stderr)
        if who == "broken" and time.monotonic() - self.since > SECONDS_FOR_OTHER_WORKERS:
            raise CohortError(f"no worker is left whose machine works; the last: {self.workers.why}", DEVICE_FAILED)

    def slots(self) -> int:
        return sum(self.workers.good().values())

    def submit(self) -> None:
        good = self.workers.good()
        if self.workers.broken and not good:
            return  # until another one comes
        allowed = frozenset(good) if self.workers.broken else None
        while self.waiting and len(self.running) < max(1, WINDOW_PER_SLOT * sum(good.values())):
            shard = self.waiting.popleft()
            # Never taken for an earlier call of the same words. Dask gives what a dead worker had to others by itself, `allowed-failures`
            # times; `retries` are for tasks that raise, and those come back here.
            with asking_the_scheduler(self.client):
                future = self.client.submit(run_shard, self.program, self.cohort, shard, self.count, self.id, pure=False, retries=0,
                                            workers=sorted(allowed) if allowed else None)
            self.running[future] = Task(shard, allowed)

    def take_back_what_nobody_may_run(self) -> None:
        """The workers that a task was kept for have gone: the scheduler would hold it for ever. What a broken one has in work stays."""
        for future, task in list(self.running.items()):
            if future.status == "pending" and task.allowed is not None and task.allowed.isdisjoint(self.workers.there):
                del self.running[future]
                self.waiting.append(task.shard)
                with asking_the_scheduler(self.client):
                    future.cancel()

    def result_of(self, future) -> tuple[int, str, str]:
        """As of `run_shard`; of one that is lost with its worker as if it had been stopped: the folder knows what is done."""
        status = future.status
        if status not in ("finished", "error"):
            return STOPPED, f"its task is {status}", ""
        try:
            return future.result(timeout=SECONDS_FOR_A_RESULT)
        except Exception as error:
            if self.client.status != "running":
                raise scheduler_is_gone(error) from error
            return STOPPED, f"its task is {status}: {error!r}", ""

    def take(self, future) -> tuple[str, int] | None:
        """What became of a shard: why it counts as a try without progress, and as which code, or nothing. Raises CohortError where going
        on makes no sense."""
        shard = self.running.pop(future).shard
        code, errors, worker = self.result_of(future)
        why = errors.strip() or f"code {code}"
        if code in (0, NOT_CONVERGED):
            self.workers.works(worker)
            return None
        if code == OUTPUT_FAILED:
            raise CohortError(why, OUTPUT_FAILED)
        if code in CANNOT_START:
            code, why = DEVICE_FAILED, f"{self.program} does not start there: {why}"
        if code not in (STOPPED, DEVICE_FAILED) and 0 <= code < 128:
            raise CohortError(f"a worker's palpate ended with code {code}: {why}", code)
        self.waiting.append(shard)
        if code == DEVICE_FAILED:
            return self.leave_out(worker, why)
        self.lost += 1
        return why, STOPPED

    def leave_out(self, worker: str, why: str) -> tuple[str, int] | None:
        """A try without progress is only the one that leaves nobody to work: many may fail while good ones are at their first case."""
        was_good = self.workers.is_good(worker)
        self.workers.fails(worker, why)
        return (why, DEVICE_FAILED) if was_good and not self.workers.good() else None

    def give_up_without_progress(self, why: str, code: int) -> None:
        counts = status_of(self.program, self.cohort)["cases"]
        over = counts["done"] + counts["not converged"] + counts["failed"]
        self.tries_without_progress = self.tries_without_progress + 1 if over == self.over else 0
        self.over = over
        if self.tries_without_progress >= MOST_TRIES_WITHOUT_PROGRESS:
            raise CohortError(f"tasks were lost {MOST_TRIES_WITHOUT_PROGRESS} times and no case was done; the last: {why}", code)

    def wait(self) -> None:
        """For the end of a task, but not for long. Raises CohortError where the scheduler is gone."""
        import distributed

        with asking_the_scheduler(self.client):
            with contextlib.suppress(distributed.TimeoutError, distributed.CancelledError):  # `take` sees which
                if self.running:
                    distributed.wait(list(self.running), timeout=SECONDS_BETWEEN_LOOKS, return_when="FIRST_COMPLETED")
                else:
                    time.sleep(SECONDS_BETWEEN_LOOKS)
            if self.client.status != "running":
                raise ConnectionError(self.client.status)

    def run(self, tell) -> None:
        """Until every shard has been run to its end. `tell` gets the number of shards that are over."""
        while self.waiting or self.running:
            self.look_at_workers()
            self.take_back_what_nobody_may_run()
            self.submit()
            self.wait()
            tries = [found for future in [f for f in self.running if f.status != "pending"] if (found := self.take(future))]
            if tries:
                self.give_up_without_progress(*tries[-1])
            tell(self.count - len(self.waiting) - len(self.running))

    def stop(self) -> None:
        """Nothing of this call is left running on the workers; those without a scheduler end by themselves."""
        if self.client.status != "running":
            return
        asking = threading.Thread(target=self.ask_workers_to_stop, daemon=True)  # one that does not answer has no limit of time
        asking.start()
        asking.join(SECONDS_TO_STOP)

    def ask_workers_to_stop(self) -> None:
        with contextlib.suppress(Exception):
            self.client.cancel(list(self.running))
        with contextlib.suppress(Exception):
            self.client.run(stop_on_worker, self.id, on_error="ignore")


def check_scheduler_file(path: str) -> None:
    """Raises CohortError where no scheduler wrote it."""
    try:
        address = json.loads(pathlib.Path(path).read_text())["address"]
    except FileNotFoundError:
        raise CohortError(f"{path}: there is no such file; `dask scheduler --scheduler-file` writes it", WRONG_OPTION) from None
    except (OSError, ValueError, LookupError, TypeError):
        address = None
    if not isinstance(address, str):
        raise CohortError(f"{path}: there is no address of a scheduler in it; `dask scheduler --scheduler-file` writes it", DAMAGED_FILE)


def client_for(chosen):
    """Of the scheduler that was named, or of one with workers on this machine. Raises CohortError."""
    import distributed

    if chosen.scheduler_file:
        check_scheduler_file(chosen.scheduler_file)
    try:
        if chosen.scheduler_file:
            return distributed.Client(scheduler_file=chosen.scheduler_file, timeout=10)
        if chosen.scheduler:
            return distributed.Client(chosen.scheduler, timeout=10)
    except (OSError, ValueError, distributed.TimeoutError) as error:
        raise CohortError(f"no Dask scheduler answers ({error}); start it with `dask scheduler`", WRONG_OPTION) from error
    try:
        return distributed.Client(n_workers=chosen.jobs, threads_per_worker=1, dashboard_address=None)
    except (OSError, RuntimeError, distributed.TimeoutError) as error:
        raise CohortError(f"the workers of this machine do not start ({error}); again, or with fewer --jobs", DEVICE_FAILED) from error


def slots_of_first_workers(client, chosen) -> int:
    """Of all on this machine, or of those that a scheduler has, which are one at least."""
    import distributed

    with asking_the_scheduler(client):
        if not chosen.scheduler and not chosen.scheduler_file:
            with contextlib.suppress(distributed.TimeoutError):  # a busy machine: with those that are there
                client.wait_for_workers(chosen.jobs, timeout=60)
        found = answer_in_time(client.nthreads, SECONDS_FOR_AN_ANSWER)
        if not found:
            print("palpate.cohort: waiting for workers", file=sys.stderr)
        while not found:
            time.sleep(SECONDS_BETWEEN_LOOKS)
            found = answer_in_time(client.nthreads, SECONDS_FOR_AN_ANSWER)
        return sum(found.values())


def wanted_shards(cohort: pathlib.Path, slots: int) -> int:
    """Some for each slot, so that the last ones end together; never more than patients."""
    try:
        patients = json.loads((cohort / "plan.json").read_text())["patients"]
    except (OSError, ValueError, KeyError) as error:
        raise CohortError(f"{cohort}: there is no plan.json in it; make it with `palpate cohort plan`", DAMAGED_FILE) from error
    return max(1, min(patients, SHARDS_PER_SLOT * max(1, slots)))


def show(text: str) -> None:
    if sys.stderr.isatty():
        print(f"\r{text}\033[K", end="", file=sys.stderr, flush=True)


def run_on_dask(chosen) -> int:
    """chosen  cohort, scheduler_file, scheduler, jobs, program. Returns the exit code of `palpate cohort status`."""
    program = find_program(chosen.program)
    cohort = os.path.abspath(chosen.cohort)
    wanted_shards(pathlib.Path(cohort), 1)  # refuses what is no cohort, before anything is started
    status_of(program, cohort)
    begin = time.monotonic()

    def interrupted(number, frame):
        raise KeyboardInterrupt

    signal.signal(signal.SIGTERM, interrupted)
    with client_for(chosen) as client:
        engine = Engine(client, program, cohort, wanted_shards(pathlib.Path(cohort), slots_of_first_workers(client, chosen)))
        try:
            engine.run(lambda over: show(f"{over} of {engine.count} shards, {engine.slots()} slots, {time.monotonic() - begin:.0f} s"))
        except BaseException:
            engine.stop()
            raise
    counts = status_of(program, cohort)
    show("")
    cases = counts["cases"]
    print(f"{cases['done']} done, {cases['not converged']} not converged, {cases['failed']} failed, {cases['waiting']} waiting; "
          f"{engine.lost} tasks were lost and given back; {time.monotonic() - begin:.0f} s")
    return counts["code"]
