# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Cohorts on machines where something is wrong: cases that stop, eat memory or write without end, a whole plan that
cannot work, disks that fail at any call, clocks that are an hour off."""
import contextlib
import json
import os
import pathlib
import shutil
import subprocess

import pytest

from tests.cli.test_cohort import children_of, journal_cases, plan, rows_of, run, started, status
from tests.conftest import PROGRAM, run_palpate

FILE_FAULTS = PROGRAM.parent / "libpalpate_file_faults.so"
CLOCK_FAULTS = PROGRAM.parent / "libpalpate_clock_faults.so"
CALLS = [1, 3, 6, 9, 11, 14, 17, 20, 22]  # at which a disk fails; a runner makes 11, the process of a patient 22


def limit_memory(folder, megabytes):
    (folder / "cohort.toml").write_text(f"[limits]\ntarget_seconds = 20\nattempts = 2\nmemory_mb = {megabytes}\n")


def planned_again(folder, cohort):
    finished = run_palpate("cohort", "plan", folder / "pairs.tsv", "--out", cohort, "--settings", folder / "organs.toml",
                           "--config", folder / "cohort.toml", "--test-stub", 0.05, "--quiet", "--overwrite")
    assert finished.returncode == 0, finished.stderr


def results(cohort):
    """What `collect` tells of every case, less what differs between two runs."""
    assert run_palpate("cohort", "collect", cohort).returncode in (0, 7)
    return [{name: row[name] for name in ("participant_id", "case_id", "status", "region", "e_kpa", "key")}
            for row in rows_of(cohort / "pairs.tsv")]


def test_a_process_that_is_stopped_costs_its_pair_only(tmp_path):
    cohort = plan(tmp_path, patients=1, cases=2, ids=("stop-1",))
    assert run(cohort, "--jobs", 2).returncode == 7
    counts = status(cohort)[1]["cases"]
    assert counts["done"] == 2 and counts["failed"] == 1
    failure = json.loads(next((cohort / "failed").rglob("*stop-1.json")).read_text())
    assert failure["code"] == 9 and "longer than" in failure["sentence"]


def test_a_process_that_eats_memory_is_killed_at_its_limit(tmp_path):
    cohort = plan(tmp_path, patients=1, cases=2, ids=("memory-1",))
    limit_memory(tmp_path, 400)
    planned_again(tmp_path, cohort)
    largest = 0
    driver = started(cohort, "--jobs", "2")
    while driver.poll() is None:
        for child in children_of(driver.pid):
            with contextlib.suppress(OSError, ValueError, IndexError):
                pages = int(pathlib.Path(f"/proc/{child}/statm").read_text().split()[1])
                largest = max(largest, pages * os.sysconf("SC_PAGESIZE") / 1e6)
        with contextlib.suppress(subprocess.TimeoutExpired):
            driver.wait(0.05)
    driver.communicate()
    assert driver.returncode == 7 and largest < 2000
    assert status(cohort)[1]["cases"]["done"] == 2
    failure = json.loads(next((cohort / "failed").rglob("*memory-1.json")).read_text())
    assert "more than 400 MB of memory" in failure["sentence"] and failure["attempts"] == 2


def test_a_log_without_end_is_kept_short(tmp_path):
    cohort = plan(tmp_path, patients=1, cases=2, ids=("log-300",))
    driver = started(cohort, "--jobs", "2")
    largest = 0
    while driver.poll() is None:
        with contextlib.suppress(OSError, ValueError):
            pages = int(pathlib.Path(f"/proc/{driver.pid}/statm").read_text().split()[1])
            largest = max(largest, pages * os.sysconf("SC_PAGESIZE") / 1e6)
        with contextlib.suppress(subprocess.TimeoutExpired):
            driver.wait(0.05)
    driver.communicate()
    assert driver.returncode == 7 and status(cohort)[1]["cases"]["done"] == 2
    assert largest < 300
    assert sum(file.stat().st_size for file in (cohort / "logs").rglob("*")) < 1e6
    failure = json.loads(next((cohort / "failed").rglob("*log-300.json")).read_text())
    assert len(failure["log_tail"]) <= 16 * 1024


def test_a_plan_in_which_everything_fails_alike_is_not_tried_to_its_end(tmp_path):
    cohort = plan(tmp_path, ids=tuple(f"fail-4-{k:02}" for k in range(30)), seconds=0)
    finished = run(cohort, "--jobs", 2)
    assert finished.returncode == 9
    assert "20 cases failed alike and none worked" in finished.stderr and "the test stub was asked to" in finished.stderr
    counts = status(cohort)[1]["cases"]
    assert 20 <= counts["failed"] <= 22 and counts["failed"] + counts["waiting"] == 30
    assert run(cohort, "--keep-going").returncode == 7
    assert status(cohort)[1]["cases"]["failed"] == 30


def test_where_something_works_failures_are_only_told(tmp_path):
    cohort = plan(tmp_path, patients=1, cases=1, ids=tuple(f"fail-4-{k:02}" for k in range(25)), seconds=0)
    assert run(cohort).returncode == 7
    counts = status(cohort)[1]["cases"]
    assert counts["done"] == 1 and counts["failed"] == 25


@pytest.fixture(scope="module")
def unbroken(tmp_path_factory):
    """A planned cohort that nobody has run, and what a run without faults tells of it."""
    folder = tmp_path_factory.mktemp("unbroken")
    cohort = plan(folder, patients=2, cases=2, seconds=0)
    copy = folder / "copy"
    shutil.copytree(cohort, copy)
    assert run(copy).returncode == 0
    return cohort, results(copy)


def run_with_faults(cohort, action, at):
    faults = {"LD_PRELOAD": str(FILE_FAULTS), "PALPATE_FAULT_FOLDER": str(cohort), "PALPATE_FAULT_ACTION": action,
              "PALPATE_FAULT_AT": str(at)}
    return run_palpate("cohort", "run", cohort, "--progress", "json", environment=faults)


@pytest.mark.parametrize("action", ["kill", "half"])
def test_a_run_that_is_killed_at_any_call_goes_on_as_if_nothing_had_been(unbroken, tmp_path, action):
    planned, expected = unbroken
    ended = set()
    for at in CALLS:
        cohort = tmp_path / f"cohort-{at}"
        shutil.copytree(planned, cohort)
        ended.add(run_with_faults(cohort, action, at).returncode)
        # A case whose process was killed every time is a failure.
        assert run(cohort, "--retry-failed").returncode == 0
        assert results(cohort) == expected, at
        assert not list((cohort / "cases").rglob("*.unfinished-*")), at
        shutil.rmtree(cohort)
    assert len(ended) > 1


@pytest.mark.parametrize("action", ["ENOSPC", "EDQUOT"])
def test_a_full_disk_stops_the_run_and_loses_nothing(unbroken, tmp_path, action):
    planned, expected = unbroken
    codes = []
    for at in CALLS:
        cohort = tmp_path / f"cohort-{at}"
        shutil.copytree(planned, cohort)
        finished = run_with_faults(cohort, action, at)
        codes.append(finished.returncode)
        assert finished.returncode in (0, 10), (at, finished.stderr)
        assert not list(cohort.glob("failed/**/*.json")), at
        assert run(cohort).returncode == 0
        assert results(cohort) == expected, at
        shutil.rmtree(cohort)
    assert 10 in codes


def test_an_hour_off_changes_nothing(unbroken, tmp_path):
    planned, expected = unbroken
    cohort = tmp_path / "cohort"
    shutil.copytree(planned, cohort)
    both = []
    for offset in (-3600, 3600):
        both.append(subprocess.Popen(
            [str(PROGRAM), "cohort", "run", str(cohort), "--progress", "json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            env={**os.environ, "LD_PRELOAD": str(CLOCK_FAULTS), "PALPATE_CLOCK_OFFSET_S": str(offset)}))
    for one in both:
        one.communicate(timeout=60)
    assert [one.returncode for one in both] == [0, 0]
    assert results(cohort) == expected and len(journal_cases(cohort)) == 4
    counts = status(cohort)[1]
    assert counts["cases"]["done"] == 4 and counts["in_work"] == 0
