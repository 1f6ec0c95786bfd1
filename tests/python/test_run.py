# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""palpate.run: applications by name, whose keywords come from their tables of options."""
import inspect
import json
import pathlib

import numpy as np
import pytest

from tests.cli.test_simulate import BOX, MATERIAL, SMOOTH_BOX, TOP
from tests.conftest import ROOT

palpate = pytest.importorskip("palpate", reason="the Python package is not installed: pip install .")


def test_two_springs_are_found():
    outcome = palpate.run("springs", force_mn=10, joint_mm=[2.0], end_mm=np.array([7.0, 7.05, 6.95]),
                          noise_mm=0.05)
    assert outcome.converged and outcome.status == 0
    assert outcome["first_mn_per_mm"]["value"] == pytest.approx(5, rel=0.01)
    assert outcome["second_mn_per_mm"]["value"] == pytest.approx(2, rel=0.01)
    assert outcome["second_mn_per_mm"]["verdict"] == "recovered"


def test_the_function_of_an_application_does_the_same_and_says_what_it_takes():
    springs = palpate.applications.springs
    options = dict(force_mn=10, joint_mm=2, end_mm=7)
    assert springs(**options) == palpate.run("springs", **options)
    parameters = inspect.signature(springs).parameters
    assert parameters["noise_mm"].default == 0.1
    assert parameters["force_mn"].default is inspect.Parameter.empty
    assert "Standard deviation of each measurement" in springs.__doc__ and "(mN)" in springs.__doc__


def test_results_can_be_written(tmp_path):
    palpate.run("springs", force_mn=10, end_mm=7, out=pathlib.Path(tmp_path) / 'a "folder"')
    assert (tmp_path / 'a "folder"' / "result.json").exists()


def test_an_error_names_options_as_python_does(tmp_path):
    options = dict(force_mn=10, end_mm=7, out=tmp_path / "out")
    palpate.run("springs", **options)
    with pytest.raises(palpate.PalpateError, match="exists already.* with out, or add overwrite"):
        palpate.run("springs", **options)
    assert palpate.run("springs", overwrite=True, **options).converged


@pytest.mark.parametrize("options, sentence", [
    (dict(force_mn=-1, end_mm=7), "force_mn"),
    (dict(force=10, end_mm=7), "known keys: force_mn"),
    (dict(force_mn=10), "end_mm is required"),
    (dict(force_mn=float("nan"), end_mm=7), "force_mn"),
])
def test_what_the_table_does_not_allow_is_refused(options, sentence):
    with pytest.raises(palpate.PalpateError, match=sentence) as caught:
        palpate.run("springs", **options)
    assert caught.value.status == 2


def test_an_unknown_application_and_a_strange_value_are_refused():
    with pytest.raises(palpate.PalpateError, match="there are .*springs"):
        palpate.run("spring")
    with pytest.raises(TypeError, match="an option is"):
        palpate.run("springs", force_mn={})


def test_tissue_is_identified_from_python(tmp_path):
    outcome = palpate.run("identify", experiment=ROOT / "examples/identify/tension.toml", out=tmp_path / "out")
    found = {part["path"]: part for part in outcome["parameters"]}
    low, high = found["material[1].gamma"]["interval_95"]
    assert outcome.converged and low < 12 < high
    assert (tmp_path / "out/report.html").exists() and (tmp_path / "out/fit.csv").exists()


def test_progress_cancels():
    told = []

    def stop(stage, fraction, message):
        told.append(stage)
        return False

    with pytest.raises(palpate.PalpateError) as caught:
        palpate.run("springs", progress=stop, force_mn=10, end_mm=7)
    assert caught.value.status == 11 and told == ["searching"]


@pytest.fixture(scope="module")
def pelvis(tmp_path_factory):
    """A coarse phantom of two targets, made by name."""
    folders = [tmp_path_factory.mktemp("made") / name for name in ("one", "two")]
    for target, folder in enumerate(folders, start=1):
        made = palpate.run("phantom", kind="pelvis", seed=2, stiffness_kpa=60, spacing=[2, 2, 2], nodes=8000,
                           target=target, load_factor=1 if target == 1 else -1, out=folder)
        assert made.status == 0 and made["seed"] == 2 and made["peak_displacement_mm"] > 1
    return folders


def states(pelvis):
    return dict(reference=pelvis[0] / "reference.nii.gz", config=pelvis[0] / "organs.toml", nodes=2500)


def test_a_recovery_by_name_returns_what_its_folder_holds(pelvis, tmp_path):
    outcome = palpate.run("recover", target=pelvis[0] / "target.nii.gz", out=tmp_path / "result",
                          landmarks_ras=False, fields="none", **states(pelvis))
    written = json.loads((tmp_path / "result/result.json").read_text())
    assert outcome == written and outcome.converged
    prostate = next(region for region in outcome["regions"] if region["unknown"])
    assert prostate["interval_kpa"][0] < 60 < prostate["interval_kpa"][1]


def test_several_targets_by_name_tell_what_they_tell_together(pelvis, tmp_path):
    outcome = palpate.run("recover", target=[one / "target.nii.gz" for one in pelvis], out=tmp_path / "result",
                          **states(pelvis))
    assert [target["name"] for target in outcome["targets"]] == ["target-1", "target-2", "joint"]
    assert outcome["targets"][2]["regions"][0]["stiffness_kpa"] > 0
    assert (tmp_path / "result/targets.html").exists()


def test_a_plan_by_name_writes_nothing(pelvis, tmp_path):
    outcome = palpate.run("recover", plan=True, plan_motion=4, **states(pelvis))
    factors = [interval["factor_95"] for interval in outcome["regions"][0]["intervals"]]
    assert outcome["motion_mm"] == 4 and factors == sorted(factors, reverse=True)
    with pytest.raises(palpate.PalpateError, match="out is required"):
        palpate.run("recover", target=pelvis[0] / "target.nii.gz", **states(pelvis))


def test_a_simulation_by_name(tmp_path):
    model = tmp_path / "model.toml"
    model.write_text(BOX + MATERIAL + SMOOTH_BOX + TOP)
    outcome = palpate.run("simulate", model=model, out=tmp_path / "result")
    assert outcome == json.loads((tmp_path / "result/simulation.json").read_text())
