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


def test_two_zones_have_one_answer_from_three_places_and_coarse_meshes_are_named(tmp_path):
    folder = tmp_path / "phantom"
    made = run_palpate("phantom", "pelvis", "--seed", 4, "--zone-stiffness-kpa", 60, 180, "--load", "large",
                       "--nodes", 15000, "--out", folder, "--quiet")
    assert made.returncode == 0, made.stderr

    def recovered(nodes):
        out = tmp_path / str(nodes)
        finished = run_palpate("recover", folder / "reference.nii.gz", folder / "target.nii.gz", "--config",
                               folder / "organs.toml", "--nodes", nodes, "--out", out, "--quiet")
        assert finished.returncode == 0, finished.stderr
        return json.loads((out / "result.json").read_text()), "The mesh is coarse" in finished.stdout + finished.stderr

    result, is_coarse = recovered(4000)
    assert not is_coarse
    regions = {region["name"]: region for region in result["regions"]}
    for name, kpa in ("transition_zone", 60), ("peripheral_zone", 180):
        low, high = regions[name]["interval_kpa"]
        assert low < kpa < high
        assert regions[name]["other_answers_kpa"] == []
    result, is_coarse = recovered(1500)
    assert is_coarse
    assert any("The mesh is coarse" in warning for warning in result["warnings"])
