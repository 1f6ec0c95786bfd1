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
import time
from collections import deque

from .errors import DAMAGED_FILE, DEVICE_FAILED, NOT_CONVERGED, OUTPUT_FAILED, STOPPED, WRONG_OPTION, CohortError

SHARDS_PER_SLOT, WINDOW_PER_SLOT = 8, 2
MOST_TRIES_WITHOUT_PROGRESS = 5
SECONDS_BETWEEN_LOOKS = 1.0


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


def run_shard(program: str, cohort: str, number: int, count: int) -> tuple[int, str, str]:
    """On a worker: (exit code, end of standard error, the worker's address). The program ends with the worker, however that ends; a worker keeps what
    it runs as `palpate_running`, so that `stop_on_worker` finds it. Sent by value: may use nothing of this module."""
    import shutil
    import subprocess

    from distributed import get_worker

    command = [program, "cohort", "run", cohort, "--shard", f"{number}/{count}", "--progress", "none", "--keep-going"]
    # It may not outlive the thread that started it, and its children not it: else a killed worker's cases go on unseen.
    if shutil.which("setpriv"):
        command = ["setpriv", "--pdeathsig", "TERM", *command]
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    worker = get_worker()
    worker.__dict__.setdefault("palpate_running", set()).add(process)
    try:
        errors = process.communicate()[1]
    finally:
        worker.palpate_running.discard(process)
    return process.returncode, errors[-2000:], worker.address


def stop_on_worker(dask_worker=None) -> None:
    """What runs there ends as at Ctrl-C: nothing is half written."""
    for process in list(getattr(dask_worker, "palpate_running", ())):
        process.terminate()


@contextlib.contextmanager
def asking_the_scheduler():
    """Around a call that needs its answer; its end may be seen here first, as any of several errors. Raises CohortError."""
    try:
        yield
    except Exception as error:
        raise CohortError(f"the scheduler is gone ({type(error).__name__}); what is done stays: start it, and this command again",
                          STOPPED) from error


@dataclasses.dataclass
class Task:
    shard: int
    allowed: frozenset | None  # workers that may take it; None: all


class Engine:
    """Keeps a few shards more than there are slots with the scheduler, and gives back to it what a lost worker had. A worker
    whose machine does not work (code 8) gets no more of them."""

    def __init__(self, client, program: str, cohort: str, shards: int):
        import cloudpickle

        cloudpickle.register_pickle_by_value(sys.modules[__name__])  # workers need not have this package
        self.client, self.program, self.cohort, self.count = client, program, cohort, shards
        self.waiting = deque(range(1, shards + 1))
        self.running: dict = {}  # future -> Task
        self.broken: set[str] = set()  # addresses of workers
        self.lost = self.tries_without_progress = 0
        self.over = -1  # cases, at the last loss

    def good_workers(self) -> dict[str, int]:
        """Slots of those that nothing is known against."""
        with asking_the_scheduler():
            slots_of = self.client.nthreads()
        return {worker: slots for worker, slots in slots_of.items() if worker not in self.broken}

    def slots(self) -> int:
        return sum(self.good_workers().values())

    def submit(self) -> None:
        good = self.good_workers()
        if self.broken and not good:
            return  # until another one comes
        allowed = frozenset(good) if self.broken else None
        while self.waiting and len(self.running) < max(1, WINDOW_PER_SLOT * sum(good.values())):
            shard = self.waiting.popleft()
            # Never taken for an earlier call of the same words; a lost worker is our business, not the scheduler's.
            with asking_the_scheduler():
                future = self.client.submit(run_shard, self.program, self.cohort, shard, self.count, pure=False, retries=0,
                                            workers=sorted(allowed) if allowed else None)
            self.running[future] = Task(shard, allowed)

    def take_back_what_nobody_may_run(self) -> None:
        """The workers that a task was kept for have gone: the scheduler would hold it for ever."""
        there = self.good_workers()
        for future, task in list(self.running.items()):
            if future.status == "pending" and task.allowed is not None and not task.allowed & there.keys():
                del self.running[future]
                future.cancel()
                self.waiting.append(task.shard)

    def take(self, future) -> str:
        """What became of a shard: why it was lost, or nothing. Raises CohortError where going on makes no sense."""
        shard = self.running.pop(future).shard
        if future.status == "finished":
            code, errors, worker = future.result()
            if code in (0, NOT_CONVERGED):
                return ""
            if code == OUTPUT_FAILED:
                raise CohortError(errors.strip(), OUTPUT_FAILED)
            if code == DEVICE_FAILED:
                self.waiting.append(shard)
                self.leave_out(worker, errors.strip())
                return ""
            if code != STOPPED and code >= 0 and code < 128:
                raise CohortError(f"a worker's palpate ended with code {code}: {errors.strip()}", code)
            why = errors.strip() or f"code {code}"
        else:  # killed with its worker, or cancelled: the folder knows what is done
            why = f"its task is {future.status}"
        self.lost += 1
        self.waiting.append(shard)
        return why

    def leave_out(self, worker: str, why: str) -> None:
        """No more shards for a worker whose machine failed; raises CohortError where it was the last."""
        if worker not in self.broken:
            self.broken.add(worker)
            print(f"palpate.cohort: {worker} gets no more work: {why}", file=sys.stderr)
        if not self.good_workers():
            raise CohortError(f"no worker is left whose machine works; the last: {why}", DEVICE_FAILED)

    def give_up_without_progress(self, why: str) -> None:
        counts = status_of(self.program, self.cohort)["cases"]
        over = counts["done"] + counts["not converged"] + counts["failed"]
        self.tries_without_progress = self.tries_without_progress + 1 if over == self.over else 0
        self.over = over
        if self.tries_without_progress >= MOST_TRIES_WITHOUT_PROGRESS:
            raise CohortError(f"tasks were lost {MOST_TRIES_WITHOUT_PROGRESS} times and no case was done; the last: {why}",
                              STOPPED)

    def run(self, tell) -> None:
        """Until every shard has been run to its end. `tell` gets the number of shards that are over."""
        from concurrent.futures import CancelledError

        from distributed import wait

        while self.waiting or self.running:
            self.submit()
            with contextlib.suppress(TimeoutError, CancelledError):  # `take` sees which
                if self.running:
                    wait(list(self.running), timeout=SECONDS_BETWEEN_LOOKS, return_when="FIRST_COMPLETED")
                else:
                    time.sleep(SECONDS_BETWEEN_LOOKS)
            with asking_the_scheduler():
                if self.client.status != "running":
                    raise ConnectionError(self.client.status)
            lost = [why for future in [f for f in self.running if f.status != "pending"] if (why := self.take(future))]
            if lost:
                self.give_up_without_progress(lost[-1])
            self.take_back_what_nobody_may_run()
            tell(self.count - len(self.waiting) - len(self.running))

    def stop(self) -> None:
        """Nothing of this call is left running on the workers; those without a scheduler end by themselves."""
        if self.client.status != "running":
            return
        with contextlib.suppress(Exception):
            self.client.cancel(list(self.running))
            self.client.run(stop_on_worker, on_error="ignore")


@contextlib.contextmanager
def connected(chosen):
    """A client of the scheduler that was named, or of workers of this machine."""
    import distributed

    try:
        if chosen.scheduler_file:
            if not pathlib.Path(chosen.scheduler_file).is_file():
                raise CohortError(f"{chosen.scheduler_file}: there is no such file; `dask scheduler --scheduler-file` writes it",
                                  WRONG_OPTION)
            client = distributed.Client(scheduler_file=chosen.scheduler_file, timeout=10)
        elif chosen.scheduler:
            client = distributed.Client(chosen.scheduler, timeout=10)
        else:
            client = distributed.Client(n_workers=chosen.jobs, threads_per_worker=1, dashboard_address=None)
    except OSError as error:
        raise CohortError(f"no Dask scheduler answers ({error}); start it with `dask scheduler`", WRONG_OPTION) from error
    with client:
        yield client


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
    with connected(chosen) as client:
        if not chosen.scheduler and not chosen.scheduler_file:
            client.wait_for_workers(chosen.jobs, timeout=60)
        with asking_the_scheduler():
            if not client.nthreads():
                print("palpate.cohort: waiting for workers", file=sys.stderr)
                client.wait_for_workers(1)
            slots = sum(client.nthreads().values())
        engine = Engine(client, program, cohort, wanted_shards(pathlib.Path(cohort), slots))
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
