#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""R23: a run that is killed at any moment leaves no file with a final name that is not whole, and the
same command run again completes, equal to a run that nobody disturbed."""
import pathlib
import random
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent))
from tests.soak.figures import main, share  # noqa: E402
from tests.soak.full_disk import count_of_calls, faults  # noqa: E402
from tests.soak.runs import PROGRAM, Scene, contents, in_parallel, run, spread  # noqa: E402


def why_wrong(words_for, work, whole):
    """What is wrong with the folder of a killed run, or with the run after it; None if nothing."""
    out = work / "out"
    names = {entry.name for entry in work.iterdir() if not entry.name.startswith(".")}
    if not names <= {"out"}:
        return f"left {names}"
    if out.exists():
        return None if contents(out) == whole else "the result is not that of an unbroken run"
    again = run(*words_for(out))
    if again.code not in (0, 7):
        return f"the run after it fails: {again}"
    if contents(out) != whole:
        return "the run after it gives another result"
    left = [entry.name for entry in work.iterdir() if entry.name != "out"]
    return f"the run after it leaves {left}" if left else None


def killed_at_call(scene, words_for, whole, action, at):
    work = scene.fresh()
    finished = run(*words_for(work / "out"), environment=faults(work, action, at))
    if finished.code != -9:
        return f"{action} at call {at}: it was not killed: {finished}"
    why = why_wrong(words_for, work, whole)
    return f"{action} at call {at}: {why}" if why else None


def killed_after(scene, words_for, whole, seconds):
    work = scene.fresh()
    process = subprocess.Popen([str(word) for word in (PROGRAM, *words_for(work / "out"))],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    time.sleep(seconds)
    process.kill()
    process.wait()
    why = why_wrong(words_for, work, whole)
    return f"after {seconds:.3f} s: {why}" if why else None


def disturbed(scene, name, words_for, at_calls, at_times):
    work = scene.fresh()
    begin = time.time()
    assert run(*words_for(work / "out")).code in (0, 7)
    lasts = time.time() - begin
    whole = contents(work / "out")
    total = count_of_calls(scene, words_for)
    cases = [(action, at) for action in ("kill", "half") for at in spread(1, total, at_calls)]
    failures = in_parallel(lambda case: killed_at_call(scene, words_for, whole, *case), cases)
    draw = random.Random(23)
    times = [draw.uniform(0, 1.2 * lasts) for _ in range(at_times)]
    failures += in_parallel(lambda seconds: killed_after(scene, words_for, whole, seconds), times)
    failures = [text for text in failures if text]
    return share("R23", f"{name}: killed at a call or a moment", failures, len(cases) + len(times),
                 "nothing partial, same result after")


def figures(long):
    with Scene() as scene:
        found = [disturbed(scene, "simulate", scene.simulate_words, 100 if long else 10,
                           100 if long else 6)]
        if long:
            found.append(disturbed(scene, "recover", scene.recover_words, 20, 20))
    return found


if __name__ == "__main__":
    main(figures)
