#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""R16: surfaces on which mesh libraries crash, hang or lie are refused, and random organs are meshed."""
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent))
from tests.soak.figures import Figure, main, share  # noqa: E402
from tests.soak.runs import BIN, in_parallel, run  # noqa: E402

LIMIT_S = 60
MIN_DIHEDRAL_DEG = 5
VOLUME_TOLERANCE = 0.05


def refused_surfaces():
    """The unit tests of finding 7: each surface ends in an error, within its limit."""
    finished = run("--gtest_filter=TetgenTorture.*", program=BIN / "mesher_test", limit_s=600)
    good = len(re.findall(r"\[       OK \]", finished.stdout))
    failed = re.findall(r"\[  FAILED  \] (\S+) \(", finished.stdout)
    if finished.code < 0:
        failed.append(f"the parent ended by signal {-finished.code}")
    return share("R16", "surfaces that crash TetGen", failed, good + len(failed), "refused")


def blobs(first, last):
    finished = run(first, last, program=BIN / "mesh_blobs", limit_s=LIMIT_S * (last - first + 1))
    lines = finished.stdout.splitlines()
    if finished.code != 0:
        lines.append(f"{first} crashed {finished}")
    return lines


def why_wrong(line):
    seed, outcome, *rest = line.split(maxsplit=2)
    if outcome != "meshed":
        return line
    _, inverted, dihedral, error, seconds = rest[0].split()
    fine = (int(inverted) == 0 and float(dihedral) >= MIN_DIHEDRAL_DEG
            and float(error) <= VOLUME_TOLERANCE and float(seconds) <= LIMIT_S)
    return None if fine else line


def figures(long):
    found = [refused_surfaces()] if long else []  # CI has it among the unit tests
    total = 200 if long else 15
    batches = [(first, min(first + 4, total)) for first in range(1, total + 1, 5)]
    lines = [line for batch in in_parallel(lambda ends: blobs(*ends), batches) for line in batch]
    crashes = [line for line in lines if " crashed " in line]
    found.append(Figure("R16", "crashes of the parent", str(len(crashes)), "0", not crashes,
                        "\n".join(crashes)))
    wrong = [text for text in map(why_wrong, lines) if text]
    # What is refused is told; what is accepted must be good.
    accepted = [text for text in wrong if " meshed " in text]
    found.append(Figure("R16", "accepted meshes that are not good", str(len(accepted)), "0",
                        not accepted, "\n".join(accepted)))
    found.append(share("R16", "random organs, meshed by some rung", wrong, total, ">= 99 %", 0.99))
    by_cgal = sum(" meshed CGAL " in line for line in lines)
    found[-1].measured += f" ({by_cgal} CGAL)"
    return found


if __name__ == "__main__":
    main(figures)
