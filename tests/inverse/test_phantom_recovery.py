# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Two phantoms of the study that scripts/phantom_study.py runs whole."""
import csv
import subprocess
import sys

from tests.conftest import PROGRAM, ROOT


def test_the_first_phantoms_are_recovered(tmp_path):
    finished = subprocess.run(
        [sys.executable, ROOT / "scripts/phantom_study.py", "--palpate", PROGRAM, "--only", "2",
         "--out", tmp_path], capture_output=True, text=True, timeout=1500)
    assert finished.returncode == 0, finished.stderr
    with open(tmp_path / "study.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2
    for row in rows:
        assert abs(float(row["error_percent"])) < 35
        assert float(row["landmark_mean_mm"]) < 0.5
        assert row["converged"] == "True"
