#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""R27: a process that solves and solves keeps its memory and its OpenCL objects constant."""
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent))
from tests.soak.figures import Figure, main  # noqa: E402
from tests.soak.runs import BIN, OPENCL_FAULTS, run  # noqa: E402

GROWTH = 0.01


def figures(long):
    times = 500 if long else 120
    found = []
    for backend, method in (("opencl", "jacobi"), ("opencl", "multigrid"), ("reference", "direct")):
        finished = run(backend, method, times, OPENCL_FAULTS, program=BIN / "solve_client",
                       limit_s=1800, environment={"OPENCL_LAYERS": str(OPENCL_FAULTS)})
        seen = re.findall(r"memory (\d+) objects (-?\d+)", finished.stdout)
        name = f"{times} solves, {backend}, {method}"
        if finished.code != 0 or len(seen) != 2:
            found.append(Figure("R27", name, "failed", "all solved", False, str(finished)))
            continue
        (memory, objects), (memory_after, objects_after) = [map(int, pair) for pair in seen]
        growth = memory_after / memory - 1
        found.append(Figure("R27", f"{name}: memory", f"{100 * growth:+.2f} %", "< 1 %",
                            growth < GROWTH))
        found.append(Figure("R27", f"{name}: OpenCL objects", f"{objects_after - objects:+d}", "0",
                            objects_after == objects and (objects > 0 or backend != "opencl")))
    return found


if __name__ == "__main__":
    main(figures)
