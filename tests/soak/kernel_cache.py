#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""R22: many processes may share the folder of compiled kernels; a damaged entry is made anew; where
there is no such folder, or nothing can be written, palpate goes on without it."""
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
    while total < builds:
        cache = scene.fresh()
        finished = in_parallel(lambda _, cache=cache: solve(cache), range(processes), processes)
        per_run = len(entries(cache))
        assert per_run > 0, f"nothing was kept: {finished[0]}"
        total += per_run * processes
        failures += [str(one) for one in finished if one.code != 0]
    return share("R22", f"{processes} processes share a folder: builds", failures, total,
                 "all, 0 failures")


def notes(cache):
    """The entries that hold no program, but which stiffness product was measured to be the fastest."""
    return [path for path in entries(cache) if path.stat().st_size < 4096]


def settled(scene):
    """A folder with a note and just those programs that a run with this note needs. The first run built
    more, to measure them; measured again, another product may win and need others."""
    cache = scene.fresh()
    assert solve(cache).code == 0
    for path in set(entries(cache)) - set(notes(cache)):
        path.unlink()
    assert len(entries(cache)) == 1 and solve(cache).code == 0 and len(entries(cache)) > 1
    return cache


def damaged(data, pattern):
    """What the damage leaves of an entry; None: nothing."""
    middle = len(data) // 2
    return {"truncate": data[:middle],
            "zero": bytes(len(data)),
            "flip": data[:middle] + bytes([data[middle] ^ 16]) + data[middle + 1:],
            "empty": b"",
            "garbage": random.Random(22).randbytes(len(data)),
            "remove": None}[pattern]


def healed(warm, scene, pattern, chosen):
    """Why a folder where the entries that `chosen` gives are damaged does not heal; None if it does."""
    cache = scene.fresh() / "cache"
    shutil.copytree(warm, cache)
    left = {path: damaged(path.read_bytes(), pattern) for path in chosen(cache)}
    for path, data in left.items():
        path.unlink() if data is None else path.write_bytes(data)
    for when in ("first", "second"):
        finished = solve(cache)
        if finished.code != 0:
            return f"{pattern}, {when} run after it: {finished}"
    ill = [path.name for path, data in left.items() if not path.exists() or path.read_bytes() == data]
    return f"{pattern}: not made anew: {', '.join(ill)}" if ill else None


def damaged_entries(scene):
    warm = settled(scene)
    kinds = {"programs": lambda cache: sorted(set(entries(cache)) - set(notes(cache))), "note": notes}
    cases = [(pattern, chosen) for pattern in ("truncate", "zero", "flip", "empty", "remove", "garbage")
             for chosen in kinds.values()]
    failures = in_parallel(lambda case: healed(warm, scene, *case), cases)
    return share("R22", "damaged entries", [text for text in failures if text], len(cases), "made anew")


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


class Namespace:
    """A file system of its own for one program: permissions do not stop root, mounts do. Where the
    system does not allow that, `works` is false."""

    def __init__(self):
        choices = (["--mount"], ["--mount", "--map-root-user"])
        working = [words for words in choices
                   if run(*words, "mount", "-t", "tmpfs", "tmpfs", "/dev/shm", program="unshare").code == 0]
        self.works, self._words = bool(working), (working or [[]])[0]

    def solve(self, mounts, cache, **more):
        """As `solve`, after these commands of `mount`."""
        commands = "".join(f"mount {words} && " for words in mounts)
        return run(*self._words, "sh", "-c", f'{commands} exec "$0" opencl jacobi 1', BIN / "solve_client",
                   program="unshare", limit_s=120, environment={"PALPATE_CACHE_DIR": str(cache), **more})


def is_solved(finished):
    return None if finished.code == 0 else str(finished)


def places_for_kernels(scene):
    """What is wrong with runs that cannot keep kernels, by name."""
    a_file, full = scene.fresh() / "file", scene.fresh()
    a_file.write_text("no folder")
    return {
        "of the system": is_solved(solve("/proc/palpate")),
        "a file": is_solved(solve(a_file)),
        "below a file": is_solved(solve(a_file / "cache")),
        "full": is_solved(solve(full, LD_PRELOAD=str(FILE_FAULTS), PALPATE_FAULT_FOLDER=str(full),
                                PALPATE_FAULT_ACTION="ENOSPC", PALPATE_FAULT_AT="2")),
    }


def falls_back(namespace, warm, mounts, expected, action="none", **more):
    """What is wrong with a run that writes nothing (all its kernels are there) but the private folder
    of PoCL, which should come to lie in `expected`; with `action`, that is full, too, and PoCL may
    give up (code 8)."""
    report = warm.parent / "report"
    report.unlink(missing_ok=True)
    finished = namespace.solve(mounts, warm, LD_PRELOAD=str(FILE_FAULTS),
                               PALPATE_FAULT_FOLDER=str(expected), PALPATE_FAULT_ACTION=action,
                               PALPATE_FAULT_AT="1" if action != "none" else "0",
                               PALPATE_FAULT_REPORT=str(report), **more)
    if not report.exists():
        return f"nothing was written to {expected}: {finished}"
    fine = finished.code in ((0,) if action == "none" else (0, 8))
    return None if fine else str(finished)


def places_for_pocl(scene, warm):
    """The same where file systems can be hidden from a program: none where they cannot."""
    namespace = Namespace()
    if not namespace.works:
        return {}
    place, sealed = scene.fresh(), scene.fresh()
    hidden = "-t tmpfs -o {} tmpfs /dev/shm"
    read_only = [hidden.format("ro")]
    seal = [f"--bind {warm} {sealed}", f"-o remount,bind,ro {sealed}"]
    return {
        "read-only, warm": is_solved(namespace.solve(seal, sealed)),
        "/dev/shm read-only": falls_back(namespace, warm, read_only, place, TMPDIR=str(place)),
        "/dev/shm without code": falls_back(namespace, warm, [hidden.format("noexec")], place,
                                            TMPDIR=str(place)),
        "/dev/shm small": falls_back(namespace, warm, [hidden.format("size=1m")], place,
                                     TMPDIR=str(place)),
        "and TMPDIR missing": falls_back(namespace, warm, read_only, "/tmp",
                                         TMPDIR=str(place / "gone")),
        "and TMPDIR of the system": falls_back(namespace, warm, read_only, "/tmp", TMPDIR="/proc"),
        "and TMPDIR full": falls_back(namespace, warm, read_only, place, "ENOSPC", TMPDIR=str(place)),
    }


def unusable_places(scene, warm):
    found = {**places_for_kernels(scene), **places_for_pocl(scene, warm)}
    failures = [f"{name}: {why}" for name, why in found.items() if why]
    return share("R22", "folders that cannot be used", failures, len(found), "goes on without")


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
        untouched = [damaged_pocl_cache(scene, "PoCL's own folder at home is garbage")]
        found = [
            at_once(scene, 8, 1600 if long else 8),
            damaged_entries(scene),
            share("R22", "damage in PoCL's shared folder", [text for text in untouched if text],
                  len(untouched), "not used"),
            unusable_places(scene, warm),
        ]
        if long:  # on a busy machine times say nothing
            found.append(warm_start(scene, warm, 21))
        return found


if __name__ == "__main__":
    main(figures)
