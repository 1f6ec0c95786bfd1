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
    """What is wrong with a run into a folder with an older result `old`, or None."""
    names = {entry.name for entry in work.iterdir()}
    if contents(work / "old") != old:
        return "an earlier result changed"
    if finished.code in (0, 7):
        return None if may_succeed and names == {"old", "out"} else f"did not fail, left {names}"
    if finished.code != 10:
        return "the code is not 10"
    if not finished.says_one_sentence():
        return "it does not say one sentence"
    # A failed fsync of the folder comes after the result got its name: it may be there, then whole.
    if names == {"old", "out"} and set(contents(work / "out")) >= set(old) - {"out"}:
        return None
    return None if names == {"old"} else f"left {names}"


def injected(scene, words_for, action, numbers):
    first = scene.fresh()
    assert run(*words_for(first / "old")).code in (0, 7)
    old = contents(first / "old")

    def case(at):
        work = scene.fresh()
        subprocess.run(["cp", "-r", first / "old", work / "old"], check=True)
        finished = run(*words_for(work / "out"), environment=faults(work, action, at))
        why = why_wrong(finished, work, old, action == "EINTR")
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


def figures(long):
    with Scene() as scene:
        jobs = {"simulate": scene.simulate_words}
        if long:
            jobs["recover"] = scene.recover_words
        found = []
        for name, words_for in jobs.items():
            total = count_of_calls(scene, words_for)
            for action in ("ENOSPC", "EDQUOT", "EIO", "EINTR"):
                count = 50 if long and name == "simulate" else 12 if long else 8
                numbers = sorted(set(range(1, 4 if not long else 20)) | set(spread(1, total, count)))
                failures = injected(scene, words_for, action, numbers)
                found.append(share("R25", f"{name}: {action} at a call that writes", failures,
                                   len(numbers), "code 10, the rest untouched"))
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
