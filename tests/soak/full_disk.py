#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""R25: disks that are full, broken or read-only give code 10 and one sentence; what was there stays,
and nothing half-written is left."""
import pathlib
import resource
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent))
from tests.soak.figures import main, share  # noqa: E402
from tests.soak.runs import FILE_FAULTS, Scene, contents, in_parallel, run, spread  # noqa: E402


def faults(folder, action, at, report=None):
    return {"LD_PRELOAD": str(FILE_FAULTS), "PALPATE_FAULT_FOLDER": str(folder),
            "PALPATE_FAULT_ACTION": action, "PALPATE_FAULT_AT": str(at),
            **({"PALPATE_FAULT_REPORT": str(report)} if report else {})}


def count_of_calls(scene, words_for):
    work, report = scene.fresh(), scene.folder / "report"
    finished = run(*words_for(work / "out"), environment=faults(work, "none", 0, report))
    assert finished.code in (0, 7), finished
    return int(report.read_text().split()[1])


def why_wrong(finished, work, old, may_succeed):
    """What is wrong with a run into a folder with an older, equal result `old`, or None. A run that
    `may_succeed`, as something wrote again, must have brought all of it to disk."""
    names = {entry.name for entry in work.iterdir()}
    if contents(work / "old") != old:
        return "an earlier result changed"
    if finished.code in (0, 7):
        whole = may_succeed and names == {"old", "out"} and contents(work / "out") == old
        return None if whole else f"did not fail, left {names}"
    if finished.code != 10:
        return "the code is not 10"
    if not finished.says_one_sentence():
        return "it does not say one sentence"
    # A failed fsync of the folder comes after the result got its name: it may be there, then whole.
    if names == {"old", "out"} and set(contents(work / "out")) >= set(old) - {"out"}:
        return None
    return None if names == {"old"} else f"left {names}"


def injected(scene, words_for, first, action, numbers, may_succeed):
    """What goes wrong where `action` is done at these calls, beside the result in `first`."""
    old = contents(first / "out")

    def case(at):
        work = scene.fresh()
        subprocess.run(["cp", "-r", first / "out", work / "old"], check=True)
        finished = run(*words_for(work / "out"), environment=faults(work, action, at))
        why = why_wrong(finished, work, old, may_succeed)
        return f"{action} at call {at}: {why}; {finished}" if why else None
    return [text for text in in_parallel(case, numbers) if text]


def small_file_system(scene, words_for, kib):
    """Code 10 on a real file system that is full; None where none can be mounted."""
    place = scene.fresh()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={kib}k", "tmpfs", place],
                             capture_output=True, check=False).returncode == 0
    if not mounted:
        return None
    try:
        finished = run(*words_for(place / "out"))
        left = [entry.name for entry in place.iterdir()]
    finally:
        subprocess.run(["umount", place], check=True)
    fine = finished.code == 10 and finished.says_one_sentence() and not left
    return "" if fine else f"{kib} KiB: {finished}, left {left}"


def limited_file_size(scene, words_for, size):
    work = scene.fresh()

    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
    finished = run(*words_for(work / "out"), preexec_fn=limit)
    left = [entry.name for entry in work.iterdir()]
    fine = finished.code == 10 and finished.says_one_sentence() and not left
    return "" if fine else f"files of {size} bytes: {finished}, left {left}"


def fault_figures(scene, name, words_for, actions, numbers_of):
    first = scene.fresh()
    assert run(*words_for(first / "out")).code in (0, 7)
    numbers = numbers_of(count_of_calls(scene, words_for))
    for action in actions:
        # zlib, which compresses the volumes of a recovery, tries once more.
        may_succeed = action == "EINTR" or (action == "EIO" and name == "recover")
        failures = injected(scene, words_for, first, action, numbers, may_succeed)
        yield share("R25", f"{name}: {action} at a call that writes", failures, len(numbers),
                    "code 10, the rest untouched")


def figures(long):
    every = ("ENOSPC", "EDQUOT", "EIO", "EINTR")
    with Scene() as scene:
        found = list(fault_figures(
            scene, "simulate", scene.simulate_words, every,
            lambda total: sorted({*range(1, 20 if long else 4), *spread(1, total, 50 if long else 8)})))
        found += fault_figures(  # the last calls write the transforms, by libhdf5
            scene, "recover", scene.recover_words, every if long else ("ENOSPC", "EIO"),
            lambda total: sorted({*(spread(1, total, 24) if long else [total // 2]), total - 25, total - 15}))
        simulate = scene.simulate_words
        places = [small_file_system(scene, simulate, kib) for kib in (4, 16, 32)]
        tried = [text for text in places if text is not None]
        if tried:
            found.append(share("R25", "full file system", [text for text in tried if text],
                               len(tried), "code 10"))
        limits = [limited_file_size(scene, simulate, size) for size in (0, 100, 5000)]
        found.append(share("R25", "limit on the size of files", [text for text in limits if text],
                           len(limits), "code 10"))
        out = pathlib.Path("/proc/palpate-out")
        finished = run(*simulate(out))
        fine = finished.code == 10 and finished.says_one_sentence()
        found.append(share("R25", "a place that nobody may write", [] if fine else [str(finished)], 1,
                           "code 10"))
    return found


if __name__ == "__main__":
    main(figures)
