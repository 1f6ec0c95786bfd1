#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Devices that fail. R19: every OpenCL call that fails ends a run with code 8 and one sentence, or does
not matter; nothing leaks, hangs or is half-written. R20: a bit that flips on the device never gives a
wrong result without a word. R21: a kernel that hangs ends with the time limit."""
import dataclasses
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
MOST_CALLS = 60  # of a kind that are made to fail, one by one
LEAST_STRUCK = 0.9  # calls differ a little from run to run: the fastest product is measured


def faults(call, at, report, cache, **more):
    return {"OPENCL_LAYERS": str(OPENCL_FAULTS), "PALPATE_FAULT_CALL": call,
            "PALPATE_FAULT_AT": str(at), "PALPATE_FAULT_REPORT": str(report),
            "PALPATE_CACHE_DIR": str(cache), **more}


@dataclasses.dataclass
class Report:
    """What the layer wrote when the process ended."""
    calls: int  # of this kind
    struck: bool
    buffers_left: int

    @staticmethod
    def read(path):
        if not path.exists():
            return None
        words = path.read_text().split()
        return Report(int(words[1]), words[3] == "1", int(words[5]))


def why_wrong(finished, report):
    """What is wrong with a run in which a call of the device may have failed; "same" if its result
    must be that of a whole run; None if nothing."""
    if report is None:
        return "it ended without running its exit handlers"
    if report.buffers_left != 0:
        return f"{report.buffers_left} buffers are left"
    if finished.seconds > LIMIT_S + 60:
        return "it hung"
    if not report.struck:
        return None if finished.code in (0, 7) else "it failed without a fault"
    if finished.code == 8:
        return None if finished.says_one_sentence() else "it does not say one sentence"
    return "same" if finished.code in (0, 7) else "the code is not 8"


def moduli(out):
    report = json.loads((out / "result.json").read_text())
    return [region["stiffness_kpa"] for region in report["regions"] if region["stiffness_kpa"]]


def agrees(found, expected, tolerance):
    return len(found) == len(expected) and all(
        abs(a - b) <= tolerance * abs(b) for a, b in zip(found, expected))


def swept(name, call, one_run, long):
    """The figure of a fault in the first, ... 60th call of a kind, as far as there are so many.
    `one_run(at)` gives (report, what is wrong); 0 strikes nothing and counts the calls."""
    untouched, why = one_run(0)
    assert untouched and untouched.calls > 0, f"{name}, no fault, {call}: {why or 'no such call'}"
    count = untouched.calls
    last = min(count, MOST_CALLS)
    numbers = range(1, last + 1) if long else spread(1, last, 3)
    results = in_parallel(lambda at: (at, *one_run(at)), numbers)
    failures = [f"{call} {at}: {why}" for at, _, why in results if why]
    struck = sum(report is not None and report.struck for _, report, _ in results)
    if struck < LEAST_STRUCK * len(results):
        failures.append(f"only {struck} of {len(results)} runs were struck")
    figure = share("R19", f"{name}: {call} gives {CALLS[call]}", failures, len(results),
                   "code 8 or the same")
    figure.measured += f", {struck} struck"
    print(figure.what, figure.measured, file=sys.stderr, flush=True)
    return figure


def faulty_client(scene, call, long):
    """Through the C interface."""
    whole = float(run("opencl", "jacobi", 1, program=BIN / "solve_client").stdout.split()[3])

    def one_run(at):
        path = scene.fresh() / "report"
        finished = run("opencl", "jacobi", 1, program=BIN / "solve_client", limit_s=LIMIT_S,
                       environment=faults(call, at, path, cache_for(scene, call)))
        report = Report.read(path)
        why = why_wrong(finished, report)
        if why == "same":
            got = float(finished.stdout.split()[3])
            why = None if abs(got - whole) <= SAME_MM * whole else "another result"
        return report, f"{why}; {finished}" if why else None
    return swept("C", call, one_run, long)


def cache_for(scene, call):
    """Compiled kernels; none where it is the compiling that fails."""
    return scene.fresh() if call in ("build", "source") else scene.folder / "cache"


def faulty_recovery(scene, call, expected, long):
    def one_run(at):
        work = scene.fresh()
        finished = run(*scene.recover_words(work / "out", *MULTIGRID), limit_s=LIMIT_S + 270,
                       environment=faults(call, at, work / "report", cache_for(scene, call)))
        report = Report.read(work / "report")
        why = why_wrong(finished, report)
        if why == "same":
            why = None if agrees(moduli(work / "out"), expected, 1e-3) else "another result"
        elif not why and finished.code not in (0, 7):
            left = {entry.name for entry in work.iterdir()} - {"report"}
            why = f"left {left}" if left else None
        return report, f"{why}; {finished}" if why else None
    return swept("recover", call, one_run, long)


def flipped_bits(scene, expected, seeds):
    """R20: either the moduli are right or the run says that something is wrong; a device that is the host
    may also crash, where an index points nowhere."""
    report = scene.fresh() / "report"
    finished = run(*scene.recover_words(scene.fresh() / "out", *MULTIGRID),
                   environment=faults("flip", 0, report, scene.folder / "cache"))
    assert finished.code in (0, 7), finished
    launches = Report.read(report).calls

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
        if finished.code < 0:
            return "crashed", f"seed {seed}: signal {-finished.code}"
        return "told", None if finished.code in (6, 7, 8) else f"seed {seed}: {finished}"
    results = in_parallel(case, range(1, seeds + 1))
    wrong = [text for kind, text in results if text and kind != "crashed"]
    crashed = [text for kind, text in results if kind == "crashed"]
    told = sum(kind == "told" for kind, _ in results)
    return Figure("R20", f"{seeds} bits flipped on the device: wrong and not told",
                  f"{len(wrong)} ({told} told, {len(crashed)} crashed)", "<= 1 %",
                  len(wrong) <= 0.01 * seeds, "\n".join(wrong + crashed))


def hanging_kernel(scene, limit_s, long):
    """On a busy machine times say nothing: they are judged in the long form."""
    work = scene.fresh()
    finished = run(*scene.recover_words(work / "out", *MULTIGRID, "--time-limit", limit_s),
                   environment=faults("hang", 40, work / "report", scene.folder / "cache"))
    late = finished.seconds - limit_s
    fine = (finished.code == 9 and finished.says_one_sentence() and not (work / "out").exists()
            and (late <= 2 or not long))
    return Figure("R21", "kernel that hangs, time limit", f"{late:+.1f} s",
                  "code 9 within +2 s" if long else "code 9", fine, "" if fine else str(finished))


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
        found = [faulty_client(scene, call, long) for call in CALLS]
        found += [faulty_recovery(scene, call, expected, long)
                  for call in (CALLS if long else ("read", "kernel"))]
        found.append(flipped_bits(scene, expected, 100 if long else 2))
        found.append(hanging_kernel(scene, 5, long))
    return found


if __name__ == "__main__":
    main(figures)
