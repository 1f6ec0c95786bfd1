#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Devices that fail. R19: every OpenCL call that fails ends a run with code 8 and one sentence, or does
not matter; nothing leaks, hangs or is half-written. R20: a bit that flips on the device never gives a
wrong result without a word. R21: a kernel that hangs ends with the time limit."""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent))
from tests.soak.figures import Figure, main, share  # noqa: E402
from tests.soak.runs import BIN, OPENCL_FAULTS, Scene, in_parallel, run, spread  # noqa: E402

CALLS = {"buffer": -4, "kernel": -5, "build": -11, "source": -6, "read": -36, "write": -5}
MULTIGRID = ("--linear-solver", "multigrid")  # small scenes are otherwise solved on the host
LIMIT_S = 30
SAME_MM = 1e-4  # R6, of single precision: relative


def faults(call, at, report, cache, **more):
    return {"OPENCL_LAYERS": str(OPENCL_FAULTS), "PALPATE_FAULT_CALL": call,
            "PALPATE_FAULT_AT": str(at), "PALPATE_FAULT_REPORT": str(report),
            "PALPATE_CACHE_DIR": str(cache), **more}


def why_wrong(finished, report, expected_codes=(8,)):
    """What is wrong with a run in which a call of the device may have failed; None if nothing."""
    if not report.exists():
        return "it ended without running its exit handlers"
    words = report.read_text().split()
    fired, left = words[3] == "1", int(words[5])
    if left != 0:
        return f"{left} buffers are left"
    if finished.seconds > LIMIT_S + 60:
        return "it hung"
    if not fired:
        return None if finished.code in (0, 7) else "it failed without a fault"
    if finished.code in expected_codes:
        return None if finished.says_one_sentence() else "it does not say one sentence"
    return "same" if finished.code in (0, 7) else "the code is not 8"


def moduli(out):
    report = json.loads((out / "result.json").read_text())
    return [region["stiffness_kpa"] for region in report["regions"] if region["stiffness_kpa"]]


def agrees(found, expected, tolerance):
    return len(found) == len(expected) and all(
        abs(a - b) <= tolerance * abs(b) for a, b in zip(found, expected))


def faulty_client(scene, call, numbers, cache):
    """The same through the C interface."""
    whole = run("opencl", "jacobi", 1, program=BIN / "solve_client").stdout.split()[3]

    def case(at):
        report = scene.fresh() / "report"
        finished = run("opencl", "jacobi", 1, program=BIN / "solve_client", limit_s=LIMIT_S,
                       environment=faults(call, at, report, cache))
        why = why_wrong(finished, report)
        if why == "same":
            got = float(finished.stdout.split()[3])
            why = None if abs(got - float(whole)) <= SAME_MM * float(whole) else "another result"
        return f"{call} {at}: {why}; {finished}" if why else None
    return [text for text in in_parallel(case, numbers) if text]


def faulty_recovery(scene, call, numbers, expected):
    def case(at):
        work = scene.fresh()
        cache = scene.fresh() if call in ("build", "source") else scene.folder / "cache"
        report = work / "report"
        finished = run(*scene.recover_words(work / "out", *MULTIGRID), limit_s=LIMIT_S + 90,
                       environment=faults(call, at, report, cache))
        why = why_wrong(finished, report)
        if why == "same":
            why = None if agrees(moduli(work / "out"), expected, 1e-3) else "another result"
        elif not why and finished.code not in (0, 7):
            left = {entry.name for entry in work.iterdir()} - {"report"}
            why = f"left {left}" if left else None
        return f"{call} {at}: {why}; {finished}" if why else None
    return [text for text in in_parallel(case, numbers) if text]


def flipped_bits(scene, expected, seeds):
    """R20: either the moduli are right or the run says that something is wrong."""
    report = scene.fresh() / "report"
    finished = run(*scene.recover_words(scene.fresh() / "out", *MULTIGRID),
                   environment=faults("flip", 0, report, scene.folder / "cache"))
    assert finished.code in (0, 7), finished
    launches = int(report.read_text().split()[1])

    def case(seed):
        work = scene.fresh()
        at = 1 + seed * 7919 % launches
        finished = run(*scene.recover_words(work / "out", *MULTIGRID),
                       environment=faults("flip", at, work / "report", scene.folder / "cache",
                                          PALPATE_FAULT_SEED=str(seed)))
        if finished.code == 0 and agrees(moduli(work / "out"), expected, 0.01):
            return "harmless", None
        if finished.code == 0:
            return "silent", f"seed {seed}, launch {at}: {moduli(work / 'out')}, not {expected}"
        if finished.code < 0:  # an index that points nowhere: a device that is the host crashes
            return "crashed", None
        return "told", None if finished.code in (6, 7, 8) else f"seed {seed}: {finished}"
    results = in_parallel(case, range(1, seeds + 1))
    failures = [text for _, text in results if text]
    figure = share("R20", "bit flipped on the device: right or told", failures, seeds, ">= 99 %",
                   0.99)
    count = {kind: sum(kind == other for other, _ in results) for kind in ("told", "crashed")}
    figure.measured += f" ({count['told']} told, {count['crashed']} crashed)"
    return figure


def hanging_kernel(scene, limit_s, patience_s):
    work = scene.fresh()
    finished = run(*scene.recover_words(work / "out", *MULTIGRID, "--time-limit", limit_s),
                   environment=faults("hang", 40, work / "report", scene.folder / "cache"))
    fine = (finished.code == 9 and finished.seconds < limit_s + patience_s and finished.says_one_sentence()
            and not (work / "out").exists())
    return Figure("R21", "kernel that hangs, time limit", f"{finished.seconds - limit_s:+.1f} s",
                  "code 9 within +2 s", fine, "" if fine else str(finished))


def figures(long):
    with Scene() as scene:
        cache = scene.folder / "cache"
        whole = scene.fresh() / "out"
        finished = run(*scene.recover_words(whole, *MULTIGRID),
                       environment={"PALPATE_CACHE_DIR": str(cache)})
        assert finished.code in (0, 7), finished
        expected = moduli(whole)
        run("opencl", "jacobi", 1, program=BIN / "solve_client",
            environment={"PALPATE_CACHE_DIR": str(cache)})
        found = []
        for call, status in CALLS.items():
            is_built = call in ("build", "source")
            numbers = range(1, 61) if long else [2] if is_built else spread(1, 60, 3)
            failures = []
            for part in numbers if is_built else [None]:
                store = scene.fresh() if part else cache
                failures += faulty_client(scene, call, [part] if part else numbers, store)
            found.append(share("R19", f"C: {call} gives {status}", failures, len(numbers),
                               "code 8 or the same"))
        for call, status in CALLS.items():
            numbers = range(1, 61) if long else [2, 40]
            if call in ("read", "kernel") or long:
                failures = faulty_recovery(scene, call, numbers, expected)
                found.append(share("R19", f"recover: {call} gives {status}", failures, len(numbers),
                                   "code 8 or the same"))
        found.append(flipped_bits(scene, expected, 100 if long else 2))
        found.append(hanging_kernel(scene, 5, 3 if long else 30))
    return found


if __name__ == "__main__":
    main(figures)
