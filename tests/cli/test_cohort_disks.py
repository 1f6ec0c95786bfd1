# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Cohorts on small file systems of their own that are full, have no inodes left, or are read-only."""
import contextlib
import hashlib
import os
import subprocess

import pytest

from tests.cli.test_cohort import plan, run, status

SIZE_MIB, INODES = 96, 600


@pytest.fixture
def small_disk(tmp_path):
    place = tmp_path / "disk"
    place.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={SIZE_MIB}m,nr_inodes={INODES}", "tmpfs", str(place)],
                             capture_output=True)
    if mounted.returncode != 0:
        pytest.skip("no file system can be mounted here: " + mounted.stderr.decode().strip())
    yield place
    subprocess.run(["umount", "-l", str(place)], check=True)


def started_cohort(place):
    """Of 30 cases of three patients, the first patient's done; and what their folders hold."""
    cohort = plan(place, patients=3, cases=10, seconds=0)
    finished = run(cohort, "--only", "p0")
    assert finished.returncode == 0, finished.stderr
    return cohort, contents(cohort)


def contents(cohort):
    return {str(file): hashlib.sha256(file.read_bytes()).hexdigest() for file in (cohort / "cases").glob("*/p0/*/*")}


def assert_stopped_in_order(cohort, finished, before):
    assert finished.returncode == 10, (finished.returncode, finished.stderr)
    counts = status(cohort)[1]
    assert counts["cases"]["failed"] == 0 and 10 <= counts["cases"]["done"] < 30 and counts["in_work"] == 0
    assert contents(cohort) == before and len(before) == 20
    assert not list((cohort / "failed").rglob("*.json"))


def assert_goes_on(cohort, before):
    assert run(cohort).returncode == 0 and status(cohort)[1]["cases"]["done"] == 30
    assert contents(cohort) == before and not list((cohort / "cases").rglob("*.unfinished-*"))


@pytest.mark.parametrize("free_mib", [0, 30])
def test_a_disk_that_is_full_stops_the_run_with_code_10(small_disk, free_mib):
    cohort, before = started_cohort(small_disk)
    filler = small_disk / "filler"
    free = os.statvfs(small_disk)
    with open(filler, "wb") as file, contextlib.suppress(OSError):
        for _ in range(free.f_bavail * free.f_frsize // 2**20 - free_mib + (free_mib == 0)):
            file.write(bytes(2**20))
            file.flush()
    finished = run(cohort)
    assert_stopped_in_order(cohort, finished, before)
    assert "disk is almost full" in finished.stderr
    filler.unlink()
    assert_goes_on(cohort, before)


@pytest.mark.parametrize("left", [0, 1, 2, 5, 30])
def test_a_disk_without_inodes_stops_the_run_with_code_10(small_disk, left):
    cohort, before = started_cohort(small_disk)
    fillers = small_disk / "fillers"
    fillers.mkdir()
    for number in range(os.statvfs(small_disk).f_favail - left):
        (fillers / str(number)).touch()
    finished = run(cohort)
    assert_stopped_in_order(cohort, finished, before)
    for file in fillers.iterdir():
        file.unlink()
    assert_goes_on(cohort, before)


def test_a_disk_that_is_read_only_stops_the_run_with_code_10(small_disk):
    cohort, before = started_cohort(small_disk)
    subprocess.run(["mount", "-o", "remount,ro", str(small_disk)], check=True)
    finished = run(cohort)
    assert_stopped_in_order(cohort, finished, before)
    assert status(cohort)[1]["cases"]["done"] == 10
    subprocess.run(["mount", "-o", "remount,rw", str(small_disk)], check=True)
    assert_goes_on(cohort, before)
