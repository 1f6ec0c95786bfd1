#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""R18: objectives that are not finite at the first to the twentieth call, constants, steps and bounds:
the unit tests of both searches, counted."""
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent))
from tests.soak.figures import main, share  # noqa: E402
from tests.soak.runs import BIN, run  # noqa: E402


def figures(long):
    if not long:
        return []  # CI has them among the unit tests
    finished = run("--gtest_filter=Lbfgs.*:ModulusSearch.*", program=BIN / "inverse_test", limit_s=600)
    good = len(re.findall(r"\[       OK \]", finished.stdout))
    failed = re.findall(r"\[  FAILED  \] (\S+) \(", finished.stdout)
    if finished.code < 0:
        failed.append(str(finished))
    return [share("R18", "searches end in a finite best point or an error", failed,
                  good + len(failed))]


if __name__ == "__main__":
    main(figures)
