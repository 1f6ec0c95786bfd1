# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Tissue at large deformation through the command line, on small phantoms."""
import json

import pytest

from tests.conftest import recover_arguments, run_palpate, with_unknown_ratio
from tests.verdicts import verdict_that_follows


def made(folder, *more):
    finished = run_palpate("phantom", "pelvis", "--seed", 1, "--stiffness-kpa", 60, "--spacing", 2, 2,
                           2, "--nodes", 8000, "--out", folder, "--quiet", *more)
    assert finished.returncode == 0, finished.stderr
    return folder


def recovered(phantom, out, *more):
    finished = run_palpate(*recover_arguments(phantom, out, *more))
    assert finished.returncode == 0, finished.stderr
    report = json.loads((out / "result.json").read_text())
    return report, next(r for r in report["regions"] if r["name"] == "prostate"), finished.stdout


def test_large_deformation_is_recovered_with_its_own_law(tmp_path):
    phantom = made(tmp_path / "phantom", "--material", "neo-hookean")
    assert json.loads((phantom / "truth.json").read_text())["material"] == "neo-hookean"

    report, prostate, text = recovered(phantom, tmp_path / "out", "--material", "neo-hookean")
    linear, stiffness, _ = recovered(phantom, tmp_path / "linear")

    # A mesh this coarse is too stiff; linear elasticity is off by a factor the other way.
    assert 50 < prostate["stiffness_kpa"] < 100 and prostate["verdict"] == verdict_that_follows(prostate)
    assert prostate["verdict"] != "not identifiable"
    assert prostate["stiffness_kpa"] > 1.2 * stiffness["stiffness_kpa"]
    assert report["material"] == "neo-hookean" and linear["material"] == "linear"
    assert "rounds of linearisation" in report["termination"]["reason"]
    assert "neo-hookean, at large deformation" in text
    page = (tmp_path / "out" / "report.html").read_text()
    assert "All tissue was taken to be neo-hookean" in page
    assert "Newton" in report["linear_solver"]["solving"]["reason"]
    for surface in report["surfaces"]:
        assert surface["mean_distance_mm_after"] < 0.3 * surface["mean_distance_mm_before"]


@pytest.mark.parametrize("law", ["veronda-westmann", "yeoh"])
def test_tissue_that_stiffens_is_recovered_with_its_own_law(tmp_path, law):
    phantom = made(tmp_path / "phantom", "--material", law)

    report, prostate, _ = recovered(phantom, tmp_path / "out", "--material", law)
    _, linear, _ = recovered(phantom, tmp_path / "linear")

    low, high = prostate["interval_kpa"]
    assert low < 60 < high < 3 * low and report["material"] == law
    # Linear elasticity takes it for softer than it is at rest.
    assert linear["stiffness_kpa"] < prostate["stiffness_kpa"] < 80
    assert report["termination"]["converged"]


def test_small_deformation_is_that_of_linear_elasticity(tmp_path):
    phantom = made(tmp_path / "phantom", "--load-factor", 0.15)

    _, neo_hookean, _ = recovered(phantom, tmp_path / "out", "--material", "neo-hookean")
    _, linear, _ = recovered(phantom, tmp_path / "linear")

    # So little motion leaves a modulus open by a factor of two either way.
    assert neo_hookean["stiffness_kpa"] == pytest.approx(linear["stiffness_kpa"], rel=0.3)
    assert neo_hookean["verdict"] == linear["verdict"] == "weak"


def test_a_reduced_model_and_several_targets_serve_both_laws(phantom, tmp_path):
    saved = tmp_path / "reference.reduced"
    _, first, _ = recovered(phantom, tmp_path / "saving", "--save-reduced", saved)
    arguments = recover_arguments(phantom, tmp_path / "out", "--material", "neo-hookean",
                                  "--load-reduced", saved)
    arguments = [a for k, a in enumerate(arguments) if a != "--nodes" and arguments[k - 1] != "--nodes"]
    arguments.insert(3, phantom / "target.nii.gz")

    finished = run_palpate(*arguments)

    assert finished.returncode == 0, finished.stderr
    folders = sorted(f for f in (tmp_path / "out").iterdir() if f.is_dir())
    assert len(folders) == 2
    for folder in folders:
        assert json.loads((folder / "result.json").read_text())["material"] == "neo-hookean"


@pytest.mark.parametrize("option", ["nested", "ratio"])
def test_what_does_not_go_with_the_law_is_refused(phantom, tmp_path, option):
    more = ["--material", "neo-hookean"]
    config = None
    if option == "nested":
        more += ["--method", "nested-lbfgs"]
    else:
        config = with_unknown_ratio(phantom, tmp_path)

    finished = run_palpate(*recover_arguments(phantom, tmp_path / "out", *more, config=config))

    assert finished.returncode == 2
    assert "does not go with --material neo-hookean" in finished.stderr
    assert len(finished.stderr.strip().splitlines()) == 1
