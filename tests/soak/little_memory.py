#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""R26: with too little memory a run ends with code 3, 5 or 8 and a sentence; never by a signal."""
import pathlib
import resource
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent))
from tests.soak.figures import Figure, main, share  # noqa: E402
from tests.soak.runs import Scene, in_parallel, run  # noqa: E402

MIB = 1 << 20
FIRST_MIB = 200
CODES = (0, 3, 5, 7, 8)


def limited(scene, words_for, mib):
    work = scene.fresh()

    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (mib * MIB, mib * MIB))
    finished = run(*words_for(work / "out"), preexec_fn=limit, limit_s=180)
    left = {entry.name for entry in work.iterdir()} - {"out"}
    fine = finished.code in CODES and (finished.code in (0, 7) or finished.says_one_sentence())
    return finished.code, None if fine and not left else f"{mib} MiB: {finished}, left {left}"


def figures(long):
    steps = [round(FIRST_MIB * 1.12 ** k) for k in range(20)]  # to 1.7 GiB
    with Scene() as scene:
        scene.phantom()
        jobs = {
            "recover": scene.recover_words,
            "recover, multigrid": lambda out: scene.recover_words(out, "--linear-solver",
                                                                  "multigrid"),
            "simulate": scene.simulate_words,
        }
        found = []
        for name, words_for in jobs.items():
            if name == "recover" and not long:
                continue
            chosen = steps if long else steps[::6]
            results = in_parallel(
                lambda mib, words_for=words_for: limited(scene, words_for, mib), chosen)
            failures = [text for _, text in results if text]
            found.append(share("R26", f"{name}: address space from 200 MiB up", failures,
                               len(chosen), "code 3, 5, 8 or good"))
            signals = sum(code < 0 for code, _ in results)
            found.append(Figure("R26", f"{name}: ended by a signal", str(signals), "0",
                                signals == 0))
    return found


if __name__ == "__main__":
    main(figures)
