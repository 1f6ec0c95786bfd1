#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""R22: many processes may share the folder of compiled kernels; a damaged entry is made anew; where
there is no such folder, or nothing can be written, palpate goes on without it."""
import os
import pathlib
import random
import shutil
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent))
from tests.soak.figures import Figure, main, share  # noqa: E402
from tests.soak.runs import BIN, FILE_FAULTS, Scene, in_parallel, run  # noqa: E402

ADDED_MS = 20  # of a warm run


def solve(cache, **more):
    return run("opencl", "jacobi", 1, program=BIN / "solve_client", limit_s=120,
               environment={"PALPATE_CACHE_DIR": str(cache), **more})


def entries(cache):
    return sorted(path for path in cache.rglob("*") if path.is_file())


def at_once(scene, processes, builds):
    """Processes that begin together with an empty folder, over and over."""
    failures, total = [], 0
    per_run = 0
    while total < builds:
        cache = scene.fresh()
        finished = in_parallel(lambda _, cache=cache: solve(cache), range(processes), processes)
        per_run = len(entries(cache))
        total += per_run * processes
        failures += [str(one) for one in finished if one.code != 0]
    return share("R22", f"{processes} processes share a folder: builds", failures, total,
                 "all, 0 failures")


def damage(path, pattern):
    data = path.read_bytes()
    middle = len(data) // 2
    if pattern == "truncate":
        path.write_bytes(data[:middle])
    elif pattern == "zero":
        path.write_bytes(bytes(len(data)))
    elif pattern == "flip":
        path.write_bytes(data[:middle] + bytes([data[middle] ^ 16]) + data[middle + 1:])
    elif pattern == "empty":
        path.write_bytes(b"")
    elif pattern == "remove":
        path.unlink()
    else:
        path.write_bytes(random.Random(22).randbytes(len(data)))


def healed(warm, scene, pattern):
    """Why a folder of damaged entries does not heal; None if it does."""
    cache = scene.fresh() / "cache"
    shutil.copytree(warm, cache)
    for path in entries(cache):
        damage(path, pattern)
    for when in ("first", "second"):
        finished = solve(cache)
        if finished.code != 0:
            return f"{pattern}, {when} run after it: {finished}"
    good = {path.name: path.stat().st_size for path in entries(warm)}
    now = {path.name: path.stat().st_size for path in entries(cache)}
    return None if set(good) == set(now) and min(now.values()) > 0 else f"{pattern}: not made anew"


def damaged_pocl_cache(scene, pattern):
    """What PoCL keeps for itself: of a private folder nothing survives the process, so what another
    process damages at home does not matter."""
    home = scene.fresh()
    pocl = home / ".cache" / "pocl" / "kcache"
    for name in ("ABCDEF", "tempfile"):
        (pocl / name).mkdir(parents=True)
        (pocl / name / "parallel.bc").write_bytes(b"\0" * 1000)
    before = [path.read_bytes() for path in entries(pocl)]
    finished = solve(scene.fresh(), HOME=str(home), XDG_CACHE_HOME=str(home / ".cache"))
    fine = finished.code == 0 and [path.read_bytes() for path in entries(pocl)] == before
    return None if fine else f"{pattern}: {finished}"


def unusable_places(scene, warm):
    read_only = scene.fresh() / "cache"
    shutil.copytree(warm, read_only)
    os.chmod(read_only, 0o500)
    a_file = scene.fresh() / "file"
    a_file.write_text("no folder")
    full = scene.fresh()
    temp = scene.fresh()
    cases = {
        "read-only, warm": solve(read_only),
        "of the system": solve("/proc/palpate"),
        "a file": solve(a_file),
        "below a file": solve(a_file / "cache"),
        "missing": solve(scene.fresh() / "a" / "b"),
        "full": solve(full, LD_PRELOAD=str(FILE_FAULTS), PALPATE_FAULT_FOLDER=str(full),
                      PALPATE_FAULT_ACTION="ENOSPC", PALPATE_FAULT_AT="2"),
        "temporary folder missing": solve(warm, TMPDIR=str(temp / "gone")),
        "temporary folder read-only": solve(warm, TMPDIR="/proc"),
        "temporary folder missing, cold": solve(scene.fresh(), TMPDIR=str(temp / "gone")),
        "temporary folder full, cold": solve(
            scene.fresh(), TMPDIR=str(temp), LD_PRELOAD=str(FILE_FAULTS),
            PALPATE_FAULT_FOLDER=str(temp), PALPATE_FAULT_ACTION="ENOSPC", PALPATE_FAULT_AT="1"),
    }
    fine = {name: (0, 8) if name.startswith("temporary folder full") else (0,) for name in cases}
    failures = [f"{name}: {finished}" for name, finished in cases.items()
                if finished.code not in fine[name]]
    return share("R22", "folders that cannot be used", failures, len(cases), "goes on without")


def warm_start(scene, warm, times):
    """What the private folder of PoCL costs a warm run, against one that the user gives."""
    given = scene.fresh()
    solve(warm, POCL_CACHE_DIR=str(given))
    pairs = [(solve(warm).seconds, solve(warm, POCL_CACHE_DIR=str(given)).seconds)
             for _ in range(times)]
    own, other = zip(*pairs)
    added = 1000 * (min(own) - min(other))  # the rest is other work on this machine
    return Figure("R22", "cost of private folders, warm run", f"{added:.0f} ms",
                  f"<= {ADDED_MS} ms", added <= ADDED_MS)


def figures(long):
    with Scene() as scene:
        warm = scene.fresh()
        assert solve(warm).code == 0
        patterns = ("truncate", "zero", "flip", "empty", "remove", "garbage")
        mended = in_parallel(lambda pattern: healed(warm, scene, pattern), patterns)
        untouched = [damaged_pocl_cache(scene, "PoCL's own folder at home is garbage")]
        return [
            at_once(scene, 8, 1600 if long else 8),
            share("R22", "damaged entries", [text for text in mended if text], len(patterns),
                  "made anew"),
            share("R22", "damage in PoCL's shared folder", [text for text in untouched if text],
                  len(untouched), "not used"),
            unusable_places(scene, warm),
            warm_start(scene, warm, 21 if long else 7),
        ]


if __name__ == "__main__":
    main(figures)
