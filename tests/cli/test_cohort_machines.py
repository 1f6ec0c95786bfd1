# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Cohorts on a machine that is broken as a whole: every process of a case crashes there, and so does the tiny phantom that
a runner tries then. No case may be blamed for it."""
import contextlib
import json
import os
import signal

import pytest

from tests.cli.test_cohort import LIMITS, children_of, plan, run, started, status, wait_until
from tests.conftest import PROGRAM, run_palpate

PROCESS_FAULTS = PROGRAM.parent / "libpalpate_process_faults.so"
OPENCL_FAULTS = PROGRAM.parent / "libpalpate_opencl_faults.so"
BOTH = " patient trial "


def broken(folder, number, words=BOTH, at=1):
    """An environment in which these processes end with signal `number`, from the `at`-th on."""
    return {"LD_PRELOAD": str(PROCESS_FAULTS), "PALPATE_FAULT_WORDS": words, "PALPATE_FAULT_SIGNAL": str(int(number)),
            "PALPATE_FAULT_AT": str(at), "PALPATE_FAULT_COUNT": str(folder / "count")}


def run_in(environment, cohort, *more):
    return run_palpate("cohort", "run", cohort, "--progress", "json", *more, environment=environment)


def assert_nobody_is_blamed(cohort, finished, done):
    """The runner gave up with code 8 and one sentence; what is not done waits."""
    assert finished.returncode == 8, finished.stderr
    sentence, = [line for line in finished.stderr.splitlines() if "tiny phantom" in line]
    assert "stays waiting" in sentence
    counts = status(cohort)[1]
    assert counts["cases"]["failed"] == 0 and counts["cases"]["done"] == done and counts["cases"]["waiting"] > 0
    assert counts["in_work"] == 0 and not list((cohort / "failed").rglob("*.json"))
    return sentence


@pytest.mark.parametrize("number, words", [(signal.SIGILL, "signal 4"), (signal.SIGSEGV, "signal 11"), (0, "code 127")])
def test_a_machine_on_which_everything_crashes_blames_no_case(tmp_path, number, words):
    cohort = plan(tmp_path, patients=12, cases=3, seconds=0)
    sentence = assert_nobody_is_blamed(cohort, run_in(broken(tmp_path, number), cohort, "--jobs", 2), done=0)
    assert sentence.count(words) == 2  # of the trial, and of the first case
    # At most a process a slot, and the phantom twice.
    assert (tmp_path / "count").stat().st_size <= 4
    # Elsewhere they are first attempts, on the back end that was asked for.
    assert run(cohort).returncode == 0 and status(cohort)[1]["cases"]["done"] == 36


def test_a_machine_that_breaks_while_it_runs_keeps_what_it_did(tmp_path):
    cohort = plan(tmp_path, patients=12, cases=1, seconds=0)
    assert_nobody_is_blamed(cohort, run_in(broken(tmp_path, signal.SIGBUS, at=6), cohort), done=5)
    assert run(cohort).returncode == 0 and status(cohort)[1]["cases"]["done"] == 12


def test_two_machines_of_which_one_is_broken_do_everything(tmp_path):
    cohort = plan(tmp_path, patients=40, cases=1, seconds=0.2)
    good = started(cohort)
    wait_until(lambda: children_of(good.pid))
    bad = run_in(broken(tmp_path, signal.SIGILL), cohort)
    good.communicate(timeout=100)
    assert bad.returncode == 8 and good.returncode == 0
    assert status(cohort)[1]["cases"]["done"] == 40


def test_a_case_that_crashes_where_the_phantom_does_not_is_to_blame(tmp_path):
    cohort = plan(tmp_path, patients=2, cases=1, seconds=0)
    finished = run_in(broken(tmp_path, signal.SIGILL, words=" patient ", at=2), cohort)
    assert finished.returncode == 7, finished.stderr
    counts = status(cohort)[1]["cases"]
    assert counts["done"] == 1 and counts["failed"] == 1
    failure, = [json.loads(file.read_text()) for file in (cohort / "failed").rglob("*.json")]
    assert failure["attempts"] == 2 and "signal 4" in failure["sentence"]


def test_a_trial_that_fails_once_is_tried_again(tmp_path):
    """As after somebody's `kill -9`: the second one counts."""
    cohort = plan(tmp_path, ids=("crash-once",), seconds=0)
    driver = started(cohort)
    killed = []

    def kill_trial():
        for child in children_of(driver.pid) if driver.poll() is None else []:
            with contextlib.suppress(OSError):  # a patient's process that has ended meanwhile
                if b"trial" in open(f"/proc/{child}/cmdline", "rb").read().split(b"\0"):
                    os.kill(child, signal.SIGKILL)
                    killed.append(child)
        return killed

    wait_until(kill_trial, 100)
    driver.communicate(timeout=100)
    assert driver.returncode == 0 and status(cohort)[1]["cases"]["done"] == 1


def test_trials_that_are_ended_from_outside_say_nothing(tmp_path):
    """As when memory is short: the case counts as where there is no trial."""
    cohort = plan(tmp_path, ids=("crash", "good"), seconds=0)
    finished = run_in(broken(tmp_path, signal.SIGKILL, words=" trial "), cohort)
    assert finished.returncode == 7, finished.stderr
    counts = status(cohort)[1]["cases"]
    assert counts["done"] == 1 and counts["failed"] == 1
    assert (tmp_path / "count").stat().st_size >= 3


def test_kill_9_is_not_the_machine(tmp_path):
    """Nor is what the test of memory does: the phantom is not tried."""
    cohort = plan(tmp_path, patients=2, cases=1, seconds=0)
    finished = run_in(broken(tmp_path, signal.SIGKILL, at=2), cohort)
    assert finished.returncode == 7 and status(cohort)[1]["cases"]["failed"] == 1
    assert (tmp_path / "count").stat().st_size == 3  # no trial: two attempts of the second patient


@pytest.mark.parametrize("call", ["crash", "kernel"])
def test_a_device_that_fails_from_its_first_launch_on_blames_no_case(tmp_path, phantom, call):
    """A real recovery: the layer stands between palpate and the driver. A direct solver would go on without the device."""
    if not OPENCL_FAULTS.exists():
        pytest.skip("this build has no OpenCL back end")
    (tmp_path / "pairs.tsv").write_text("participant_id\treference\ttarget\n" + "".join(
        f"p{k}\t{phantom}/reference.nii.gz\t{phantom}/target.nii.gz\n" for k in range(2)))
    (tmp_path / "cohort.toml").write_text(LIMITS.replace("1.5", "100") + '[recover]\nbackend = "opencl"\nlinear_solver = "multigrid"\n'
                                          'nodes = 2500\n')
    cohort = tmp_path / "cohort"
    planned = run_palpate("cohort", "plan", tmp_path / "pairs.tsv", "--out", cohort, "--settings", phantom / "organs.toml",
                          "--config", tmp_path / "cohort.toml", "--quiet")
    assert planned.returncode == 0, planned.stderr
    faults = {"OPENCL_LAYERS": str(OPENCL_FAULTS), "PALPATE_FAULT_CALL": call, "PALPATE_FAULT_AT": "1"}
    assert_nobody_is_blamed(cohort, run_in(faults, cohort), done=0)
    assert run(cohort, "--only", "p0").returncode == 0 and status(cohort)[1]["cases"]["done"] == 1
