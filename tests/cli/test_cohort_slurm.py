# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""engines/slurm.sh, as `palpate cohort plan` writes it, on a real Slurm that scripts/slurm_on_loopback starts and stops."""
import os
import subprocess

import pytest

from tests.cli.test_cohort import assert_each_case_is_done_once, journal_cases, plan, rows_of, run, status, wait_until
from tests.conftest import PROGRAM, ROOT, run_palpate

SHARDS = "[plan]\nshard_minutes = 1.7\n[limits]\ntarget_seconds = 30\n"


@pytest.fixture(scope="module")
def slurm():
    """Environment in which sbatch and its like reach a Slurm of this test, with four processors."""
    process = subprocess.Popen([str(ROOT / "scripts/slurm_on_loopback"), "sh", "-c", 'echo "$SLURM_CONF"; exec cat >/dev/null'],
                               stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               env={**os.environ, "SLURM_LOOPBACK_CPUS": "4"})
    conf = process.stdout.readline().strip()
    if not conf:
        reason = process.communicate(timeout=30)[1].strip()
        assert process.returncode == 77, reason  # anything else is a fault, not a machine that cannot
        pytest.skip(reason.splitlines()[-1])
    yield {**os.environ, "SLURM_CONF": conf, "PATH": f"{PROGRAM.parent}:{os.environ['PATH']}"}
    process.communicate(timeout=30)
    assert not os.path.exists(os.path.dirname(conf))  # nothing is left of it


def ask(slurm, *words, cwd=None):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, env=slurm, cwd=cwd, timeout=60)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def submit(slurm, cohort, *more):
    return ask(slurm, "sbatch", "--parsable", *more, "engines/slurm.sh", cwd=cohort)


def wait_for(slurm, job, seconds=180):
    """Until it has ended: a queue that is busy may show nothing of a job that runs."""
    def has_ended():
        if ask(slurm, "squeue", "--noheader", "--job", job):
            return False
        shown = ask(slurm, "scontrol", "--oneliner", "show", "job", job)
        return not any(f"JobState={state}" in shown for state in ("PENDING", "CONFIGURING", "RUNNING", "COMPLETING"))

    wait_until(has_ended, seconds)


def planned(folder, monkeypatch, patients, cases, seconds):
    monkeypatch.setattr("tests.cli.test_cohort.LIMITS", SHARDS)
    return plan(folder, patients=patients, cases=cases, seconds=seconds)


def tables_but_times(cohort):
    assert run_palpate("cohort", "collect", cohort).returncode == 0
    return [{k: v for k, v in row.items() if k not in ("seconds", "peak_memory_mb", "device", "host")}
            for row in rows_of(cohort / "pairs.tsv")]


def test_an_array_job_does_the_plan_as_one_machine_does(slurm, tmp_path, monkeypatch):
    folders = [tmp_path / name for name in ("slurm", "here")]
    for folder in folders:
        folder.mkdir()
    cohorts = [planned(folder, monkeypatch, 12, 3, 0.01) for folder in folders]
    assert "--array=1-5\n" in (cohorts[0] / "engines/slurm.sh").read_text()
    wait_for(slurm, submit(slurm, cohorts[0]))
    logs = "".join(log.read_text() for log in (cohorts[0] / "logs").glob("slurm-*.txt"))
    assert status(cohorts[0])[0] == 0, logs
    assert logs.count("cases done, 0 not converged, 0 failed") == 5
    noted = journal_cases(cohorts[0])
    assert len(noted) == len(set(noted)) == 36
    assert run(cohorts[1], "--jobs", 2).returncode == 0
    assert tables_but_times(cohorts[0]) == tables_but_times(cohorts[1])


def test_a_time_limit_stops_a_task_in_order_and_it_goes_on_when_requeued(slurm, tmp_path, monkeypatch):
    cohort = planned(tmp_path, monkeypatch, 1, 45, 1)
    # One minute is no more than the lead of the signal, which comes when Slurm looks at its limits: every half a minute.
    job = submit(slurm, cohort, "--time=1")
    wait_for(slurm, job)
    code, counts = status(cohort)
    assert code == 9 and counts["in_work"] == 0 and 0 < counts["cases"]["done"] < 45
    # A child that was stopped beside its driver may still be cleaning up.
    wait_until(lambda: not list((cohort / "cases").rglob("*.unfinished-*")), 20)
    shown = ask(slurm, "scontrol", "show", "job", job)
    assert "ExitCode=9:0" in shown
    done_before = counts["cases"]["done"]
    ask(slurm, "scontrol", "requeue", f"{job}_1")
    ask(slurm, "scontrol", "update", f"jobid={job}_1", "timelimit=10", "starttime=now+10")
    # Not at once: Slurm refuses to launch in the second in which the same job was ended ("already killed"). It
    # lets a requeued job wait for two minutes at times, whatever its start time says.
    wait_until(lambda: status(cohort)[1]["cases"]["done"] > done_before, 300)
    wait_until(lambda: status(cohort)[0] == 0, 180)
    noted = journal_cases(cohort)
    assert len(noted) == len(set(noted)) == 45


def test_a_cancelled_array_leaves_nothing_running_and_goes_on_when_submitted_again(slurm, tmp_path, monkeypatch):
    cohort = planned(tmp_path, monkeypatch, 12, 3, 1.5)
    first = submit(slurm, cohort, "--array=1-5%1")  # a task at a time: most cases are still to come
    wait_until(lambda: status(cohort)[1]["cases"]["done"] > 1, 120)
    ask(slurm, "scancel", first)
    wait_for(slurm, first)
    wait_until(lambda: status(cohort)[1]["in_work"] == 0, 120)
    assert status(cohort)[1]["cases"]["done"] < 36
    second = submit(slurm, cohort)
    wait_for(slurm, second)
    assert status(cohort)[0] == 0
    noted = journal_cases(cohort)
    assert len(noted) == len(set(noted)) == 36


def test_killed_drivers_are_made_up_for_by_the_same_file_again(slurm, tmp_path, monkeypatch):
    cohort = planned(tmp_path, monkeypatch, 12, 3, 0.1)
    first = submit(slurm, cohort)
    wait_until(lambda: status(cohort)[1]["in_work"] > 1, 120)
    drivers = subprocess.run(["pgrep", "-f", "cohort run . --shard"], capture_output=True, text=True).stdout.split()
    killed = 0
    for driver in drivers:
        if os.path.realpath(f"/proc/{driver}/cwd") == str(cohort):
            os.kill(int(driver), 9)
            killed += 1
    assert killed > 0
    wait_for(slurm, first)
    wait_for(slurm, submit(slurm, cohort))
    assert status(cohort)[0] == 0
    assert_each_case_is_done_once(cohort, 36)
