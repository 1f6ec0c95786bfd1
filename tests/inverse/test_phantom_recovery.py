# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Two phantoms of the coverage study, at full size."""
import csv
import subprocess

from tests.conftest import PROGRAM


def test_the_first_phantoms_are_recovered(tmp_path):
    out = tmp_path / "study"
    finished = subprocess.run([PROGRAM, "study", "coverage", "--phantoms", "2", "--out", out, "--quiet"],
                              capture_output=True, text=True, timeout=1500)
    assert finished.returncode == 0, finished.stderr
    with open(out / "study.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2
    for row in rows:
        assert abs(float(row["error_percent"])) < 35
        assert float(row["landmark_mean_mm"]) < 0.5
        assert row["converged"] == "yes"
