#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""R11: 10,000 damaged volumes of each format are read; the parent lives, each child that dies is an
error of reading."""
import os
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent))
from tests.soak.figures import Figure, main  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BIN = pathlib.Path(os.environ.get("PALPATE", ROOT / "build/release/bin/palpate")).parent
LINE = re.compile(r"^(\.\S+): (\d+) read, (\d+) refused, (\d+) killed their child; slowest (\S+) s, "
                  r"largest child (\d+) MiB", re.M)


def figures(long):
    if not long:
        return []  # mutation_test itself, 400 of each, is the short form
    finished = subprocess.run([BIN / "mutation_test"], capture_output=True, text=True, check=False,
                              env={**os.environ, "PALPATE_MUTATIONS": "10000"})
    found = []
    for ending, read, refused, died, slowest, mebibytes in LINE.findall(finished.stdout):
        what = f"{ending}: {read} read, {refused} refused, {died} children died"
        found.append(Figure("R11", what, f"{slowest} s, {mebibytes} MiB", "<= 5 s, 2 GiB",
                            float(slowest) <= 5 and int(mebibytes) <= 2048))
    found.append(Figure("R11", "the parent lives", f"code {finished.returncode}", "code 0",
                        finished.returncode == 0, finished.stdout[-3000:] if finished.returncode else ""))
    return found


if __name__ == "__main__":
    main(figures)
