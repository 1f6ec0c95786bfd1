# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Phantoms of usual voxels."""
import csv
import json
import subprocess

from tests.conftest import PROGRAM, run_palpate, with_unknown_ratio


def test_the_first_phantoms_are_recovered(tmp_path):
    out = tmp_path / "study"
    finished = subprocess.run([PROGRAM, "study", "coverage", "--phantoms", "2", "--phantom-nodes", "15000",
                               "--nodes", "4000", "--out", out, "--quiet"], capture_output=True, text=True, timeout=1500)
    assert finished.returncode == 0, finished.stderr
    with open(out / "study.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2
    for row in rows:
        assert abs(float(row["error_percent"])) < 35
        assert float(row["landmark_mean_mm"]) < 0.5
        assert row["converged"] == "yes"


def test_a_poisson_ratio_that_the_load_shows_is_found(tmp_path):
    truth = 0.30  # assumed without a search: 0.40
    folder, out = tmp_path / "phantom", tmp_path / "out"
    made = run_palpate("phantom", "pelvis", "--seed", 26, "--stiffness-kpa", 160, "--poisson-ratio",
                       truth, "--nodes", 15000, "--out", folder, "--quiet")
    assert made.returncode == 0, made.stderr
    config = with_unknown_ratio(folder, tmp_path)
    finished = run_palpate("recover", folder / "reference.nii.gz", folder / "target.nii.gz",
                           "--config", config, "--nodes", 3500, "--out", out, "--quiet")
    assert finished.returncode == 0, finished.stderr
    assert "Poisson's ratio" in finished.stdout
    regions = json.loads((out / "result.json").read_text())["regions"]
    found = next(region for region in regions if region["name"] == "prostate")
    low, high = found["searched_poisson_ratio"]["interval"]
    assert abs(found["poisson_ratio"] - truth) < 0.06
    assert low < truth < high < 0.40
    assert found["interval_kpa"][0] < 160 < found["interval_kpa"][1]
