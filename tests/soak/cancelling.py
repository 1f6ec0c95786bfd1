#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C at random times over a whole `palpate recover`, and cancelling from the callback of the C
library at every call: how long until it is over, and what is left behind."""
import ctypes
import os
import pathlib
import random
import signal
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent))
from tests.soak.figures import Figure, main  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PROGRAM = pathlib.Path(os.environ.get("PALPATE", ROOT / "build/release/bin/palpate"))
LIBRARY = PROGRAM.parent.parent / "lib/libpalpate.so"
CANCELLED, STATUS_CANCELLED = 9, 11
LIMIT_S = 2.0
TIMES = 30
CALLS = 15
if "PALPATE_CANCEL_TIMES" in os.environ:
    TIMES = CALLS = int(os.environ["PALPATE_CANCEL_TIMES"])


def make_phantom(folder):
    made = folder / "phantom"
    subprocess.run([PROGRAM, "phantom", "pelvis", "--seed", "2", "--spacing", "2", "2", "2", "--out",
                    made, "--quiet"], check=True)
    return made


def arguments(phantom, out):
    return [str(word) for word in (
        PROGRAM, "recover", phantom / "reference.nii.gz", phantom / "target.nii.gz", "--config",
        phantom / "organs.toml", "--out", out, "--save-reduced", out.parent / "saved")]


def hear_interrupts():
    """A job in the background of a script is born deaf to Ctrl-C, and so are its children."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def interrupt(phantom, folder, after_s):
    """Seconds to stop, and a complaint; None if it was over before."""
    temporary, work = folder / "temporary", folder / "work"
    temporary.mkdir(parents=True)
    work.mkdir()
    process = subprocess.Popen(arguments(phantom, work / "out"), stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, text=True, start_new_session=True, preexec_fn=hear_interrupts,
                               env={**os.environ, "TMPDIR": str(temporary)})
    time.sleep(after_s)
    if process.poll() is not None:
        return None, ""
    begin = time.monotonic()
    process.send_signal(signal.SIGINT)
    text = process.communicate(timeout=120)[1]
    seconds = time.monotonic() - begin
    stage = ([""] + [line.split()[2] for line in text.splitlines() if line.startswith(" ")])[-1]
    left = [*temporary.iterdir(), *(path for path in work.rglob(".*"))]
    complaint = ""
    if process.returncode == -signal.SIGINT and after_s < 1 and not left:
        return seconds, "(before it began)"
    if process.returncode != CANCELLED and not (work / "out/report.html").exists():
        complaint = f"in {stage}: exit code {process.returncode}"
    if left:
        complaint = f"in {stage}: left {left}"
    return seconds, complaint or f"({stage})"


def interrupted_runs(folder, times):
    phantom = make_phantom(folder)
    (folder / "whole").mkdir()
    begin = time.monotonic()
    subprocess.run(arguments(phantom, folder / "whole/out"), capture_output=True, check=True)
    whole_s = time.monotonic() - begin
    order = random.Random(9)
    seconds, complaints = [], []
    for k in range(times):
        spent, complaint = interrupt(phantom, folder / str(k), order.uniform(0.05, whole_s))
        if spent is None:
            continue
        seconds.append((spent, complaint))
        if not complaint.startswith("("):
            complaints.append(complaint)
    slow = [f"{spent:.2f} s {where}" for spent, where in seconds if spent > LIMIT_S]
    spent = sorted(value for value, _ in seconds)
    what = f"Ctrl-C at {len(spent)} random times of a recovery of {whole_s:.0f} s"
    return phantom, [
        Figure("-", what, f"median {statistics.median(spent):.2f} s, worst {spent[-1]:.2f} s",
               f"<= {LIMIT_S:g} s", not slow, "\n".join(slow)),
        Figure("-", "of these with code 9 and nothing left behind",
               f"{len(spent) - len(complaints)} of {len(spent)}", "all", not complaints,
               "\n".join(complaints))]


Callback = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_double,
                            ctypes.c_char_p)


class RecoverOptions(ctypes.Structure):
    """palpate_recover_options of palpate.h; `made` checks the size."""
    _fields_ = [("struct_size", ctypes.c_size_t), ("settings_toml", ctypes.c_char_p),
                ("align", ctypes.c_char_p), ("mesh_program", ctypes.c_char_p),
                ("mesh", ctypes.c_char_p), ("num_nodes", ctypes.c_int32),
                ("material", ctypes.c_char_p), ("solver", ctypes.c_void_p), ("progress", Callback),
                ("progress_user", ctypes.c_void_p)]

    @classmethod
    def made(cls, library):
        options = cls()
        library.palpate_recover_options_init(ctypes.byref(options))
        assert options.struct_size == ctypes.sizeof(cls), "palpate.h has other options than this file"
        return options


class Recovery:
    """One recovery through the C library, cancelled at a call of its callback, or never."""

    def __init__(self, phantom, cancel_at):
        library = ctypes.CDLL(str(LIBRARY))
        options = RecoverOptions.made(library)
        options.settings_toml = (phantom / "organs.toml").read_bytes()
        options.mesh_program = str(PROGRAM.parent / "palpate-mesh").encode()
        self.calls, self.gaps, self.cancelled_at = 0, [], None
        self.cancel_at, self.last = cancel_at, (time.monotonic(), "start")
        callback = Callback(self.called)
        options.progress = callback
        result = ctypes.c_void_p()
        files = [str(phantom / name).encode() for name in ("reference.nii.gz", "target.nii.gz")]
        self.status = library.palpate_recover_files(*files, ctypes.byref(options), ctypes.byref(result))
        self.note("end")
        self.to_stop_s = time.monotonic() - self.cancelled_at if self.cancelled_at else None
        library.palpate_result_free(result)

    def note(self, stage):
        now = time.monotonic()
        self.gaps.append((now - self.last[0], f"after {self.last[1]}, before {stage}"))
        self.last = now, stage

    def called(self, _, stage, fraction, message):
        self.note(f"{stage.decode()} {message.decode()[:30] if message else ''}".strip())
        self.calls += 1
        if self.calls - 1 == self.cancel_at:
            self.cancelled_at = time.monotonic()
            return 1
        return 0


def library_figures(phantom, times):
    whole = Recovery(phantom, -1)
    gaps = sorted(whole.gaps, reverse=True)
    calls = range(0, whole.calls - 1, max(1, whole.calls // times))
    runs = [Recovery(phantom, call) for call in calls]
    wrong = [f"call {call}: status {run.status}" for call, run in zip(calls, runs)
             if run.cancelled_at and run.status != STATUS_CANCELLED]
    worst = max(run.to_stop_s for run in runs if run.cancelled_at)
    return [
        Figure("-", f"C library: longest pause between {whole.calls} calls of the callback",
               f"{gaps[0][0]:.2f} s", "<= 1 s", gaps[0][0] <= 1,
               "\n".join(f"{seconds:.2f} s {where}" for seconds, where in gaps[:8])),
        Figure("-", f"C library: cancelled at {len(runs)} calls, time to return",
               f"{worst:.2f} s", f"<= {LIMIT_S:g} s", worst <= LIMIT_S and not wrong, "\n".join(wrong))]


def figures(long):
    if not long:
        return []  # tests/cli/test_cancel.py is the short form
    with tempfile.TemporaryDirectory(prefix="palpate-soak-") as folder:
        phantom, found = interrupted_runs(pathlib.Path(folder), TIMES)
        return found + library_figures(phantom, CALLS)


if __name__ == "__main__":
    main(figures)
