# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C and SIGTERM end every command within two seconds, with exit code 9 and one sentence, and
leave neither files nor processes behind. Timing is printed; it only fails with ample slack."""
import os
import pathlib
import signal
import subprocess
import time

import pytest

from tests.conftest import PROGRAM, ROOT, recover_arguments

SLACK_S = 20  # the aim is 2; a busy machine decides nothing here
MODEL = ROOT / "examples/simulate/pressed_by_ball.toml"


def hear_interrupts():
    """A job in the background of a script is born deaf to Ctrl-C, and so are its children."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


class Running:
    """A program in a session of its own, with temporary files of its own."""

    def __init__(self, arguments, folder, **environment):
        self.temporary = folder / "temporary"
        self.temporary.mkdir()
        self.process = subprocess.Popen(
            [str(PROGRAM), *map(str, arguments)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
            text=True, start_new_session=True, preexec_fn=hear_interrupts,
            env={**os.environ, "TMPDIR": str(self.temporary), **environment})

    def wait_for(self, word):
        """Until a line of progress holds the word."""
        for line in self.process.stderr:
            if word in line:
                return
        pytest.fail(f"'{word}' was never reported")

    def stop(self, *signals):
        """Sends them, waits for the end; the seconds that it took."""
        begin = time.monotonic()
        for one in signals:
            self.process.send_signal(one)
        try:
            self.text = self.process.communicate(timeout=120)[1]
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise
        return time.monotonic() - begin

    def in_memory(self):
        """PoCL's private folder, where the system has room for it in memory."""
        return list(pathlib.Path("/dev/shm").glob(f"palpate-*-{self.process.pid}-*"))

    def left_behind(self, *folders):
        """Temporary files, PoCL's among them, unfinished results and processes."""
        files = [str(path) for path in self.temporary.rglob("*")]
        files += map(str, self.in_memory())
        files += [str(path) for folder in folders for path in folder.rglob(".*")]
        processes = []
        for entry in pathlib.Path("/proc").iterdir():
            if entry.name.isdigit():
                try:
                    state = (entry / "stat").read_text().rpartition(")")[2].split()
                except OSError:
                    continue
                if int(state[3]) == self.process.pid and state[0] not in "ZX":
                    processes.append(entry.name)
        return files + processes


def assert_stopped(running, seconds, *folders):
    print(f"{seconds:.2f} s to stop")
    assert running.process.returncode == 9, running.text
    assert running.text.strip().splitlines()[-1].startswith("palpate: stopped by a signal"), running.text
    assert running.left_behind(*folders) == []
    assert seconds < SLACK_S


@pytest.fixture
def work(tmp_path):
    folder = tmp_path / "work"
    folder.mkdir()
    return folder


@pytest.mark.parametrize("stage", ["reading", "surfaces", "meshing", "condensing", "searching", "writing"])
def test_recover_stops_in_every_stage(stage, phantom, tmp_path, work):
    arguments = [a for a in recover_arguments(phantom, work / "new" / "out", "--save-reduced", work / "saved")
                 if a != "--quiet"]
    running = Running(arguments, tmp_path)
    running.wait_for(stage)

    seconds = running.stop(signal.SIGINT)

    if stage == "writing" and running.process.returncode in (0, 7):
        assert (work / "new" / "out" / "report.html").exists()  # it was done before it heard
        assert running.left_behind(work) == []
        return
    assert_stopped(running, seconds, work)
    if stage != "writing":
        assert not (work / "new").exists()


def test_recover_stops_while_a_child_reads(phantom, tmp_path, work):
    running = Running(recover_arguments(phantom, work / "out"), tmp_path)
    deadline = time.monotonic() + 20
    while time.monotonic() < deadline and not list(running.temporary.glob("*/palpate-*")):
        time.sleep(0.001)

    seconds = running.stop(signal.SIGTERM)

    assert_stopped(running, seconds, work)
    assert list(work.iterdir()) == []


def test_a_second_signal_ends_it_at_once(phantom, tmp_path, work):
    arguments = [a for a in recover_arguments(phantom, work / "out") if a != "--quiet"]
    running = Running(arguments, tmp_path)
    running.wait_for("condensing")

    seconds = running.stop(signal.SIGINT, signal.SIGINT)

    assert_stopped(running, seconds, work)


def test_a_second_signal_leaves_no_folder_of_pocl(phantom, tmp_path, work):
    running = Running(recover_arguments(phantom, work / "out", "--backend", "opencl"), tmp_path)
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline and not [*running.in_memory(), *running.temporary.glob("*/*pocl*")]:
        time.sleep(0.001)

    seconds = running.stop(signal.SIGINT, signal.SIGINT)

    assert_stopped(running, seconds, work)


def test_no_empty_folder_of_several_targets_is_left(phantom, tmp_path, work):
    target = phantom / "target.nii.gz"
    arguments = recover_arguments(phantom, work / "new" / "out", target)
    running = Running([a for a in arguments if a != "--quiet"], tmp_path)
    running.wait_for("writing")
    deadline = time.monotonic() + 20
    while time.monotonic() < deadline and not (work / "new" / "out").exists():
        time.sleep(0.001)

    seconds = running.stop(signal.SIGINT, signal.SIGINT)

    assert_stopped(running, seconds, work)
    assert not (work / "new").exists() or list((work / "new" / "out").iterdir())


HANGS_AT_EXIT = """
#include <unistd.h>
__attribute__((destructor)) static void hang(void) { for (;;) pause(); }
"""


def test_a_library_that_hangs_at_exit_is_ended_too(tmp_path):
    (tmp_path / "hang.c").write_text(HANGS_AT_EXIT)
    subprocess.run(["cc", "-shared", "-fPIC", "-o", tmp_path / "hang.so", tmp_path / "hang.c"], check=True)
    running = Running(["recover", "nowhere.nii", "nowhere.nii", "--config", "nowhere.toml", "--out",
                       tmp_path / "out"], tmp_path, LD_PRELOAD=str(tmp_path / "hang.so"))
    running.wait_for("palpate: ")

    seconds = running.stop(signal.SIGINT)

    print(f"{seconds:.2f} s to stop")
    assert running.process.returncode == 3  # as it said: the file cannot be read
    assert running.text == ""
    assert running.left_behind() == []
    assert seconds < SLACK_S


@pytest.mark.parametrize("command, stage, later_s", [
    (["phantom", "pelvis", "--spacing", 2, 2, 2, "--nodes", 8000], "mesh", 0),
    (["phantom", "pelvis", "--spacing", 2, 2, 2, "--nodes", 30000], "mesh", 2),
    (["simulate", MODEL], "solving", 0.5),
    (["study", "coverage", "--phantoms", 1, "--spacing", 2, 2, 2, "--nodes", 3000, "--phantom-nodes", 8000,
      "--jobs", 2], "0 of", 2),
])
def test_other_commands_stop(command, stage, later_s, tmp_path, work):
    running = Running([*command, "--out", work / "out"], tmp_path)
    running.wait_for(stage)
    time.sleep(later_s)

    seconds = running.stop(signal.SIGINT)

    if command[0] == "study":  # stops in good order and can be continued
        assert (work / "out/study.json").exists()
        assert running.process.returncode == 9, running.text
        assert running.left_behind(work) == []
        assert seconds < SLACK_S
        return
    assert_stopped(running, seconds, work)
    assert list(work.iterdir()) == []


def test_an_ignored_signal_stays_ignored(tmp_path):
    out = tmp_path / "out"
    script = f'trap "" INT; "{PROGRAM}" devices & child=$!; kill -INT $child; wait $child'
    finished = subprocess.run(["sh", "-c", script], capture_output=True, text=True, timeout=60)
    assert finished.returncode == 0, finished.stderr
    assert not out.exists()
