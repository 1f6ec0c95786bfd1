# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Real pairs: how well the target is met, and landmarks that the search never saw."""
import json

import nibabel
import numpy
import pytest

from tests.conftest import DATA, ROOT, run_palpate
from tests.verdicts import verdict_that_follows


def needed(folder):
    path = DATA / folder
    if not path.is_dir():
        pytest.skip(f"real data is missing: {path}; set PALPATE_DATA")
    return path


def recovered_mr_pair(config, out):
    data = needed("pelvis_mr_pair_prostatex0001")
    finished = run_palpate(
        "recover", data / "reference_labels.nii.gz", data / "deformed_labels.nii.gz", "--config", config,
        "--initial-transform", ROOT / "examples/pelvis_mr/align.tfm", "--out", out, "--quiet")
    assert finished.returncode == 0, finished.stderr
    return json.loads((out / "result.json").read_text())


def test_pelvis_mr_pair_tells_no_modulus_of_contours_that_are_half_a_millimetre_off(tmp_path):
    report = recovered_mr_pair(ROOT / "examples/pelvis_mr/organs.toml", tmp_path / "out")
    for surface in report["surfaces"]:
        assert surface["mean_distance_mm_after"] <= 0.8
    for zone in (region for region in report["regions"] if region["label"] in (2, 3)):
        assert zone["verdict"] == "not identifiable"
        assert zone["interval_kpa"][1] > 50 * zone["interval_kpa"][0]


def with_contours_as_they_fit(file, prior=""):
    """The example's settings, but contours are trusted as far as they fit; `file`, written."""
    text = (ROOT / "examples/pelvis_mr/organs.toml").read_text()
    assert "contour_sd_mm = 0.5" in text
    file.write_text(text.replace("contour_sd_mm = 0.5", 'contour_sd_mm = "unknown"\n' + prior))
    return file


@pytest.fixture(scope="module")
def trusted_mr_pair(tmp_path_factory):
    folder = tmp_path_factory.mktemp("mr_pair")
    return folder / "out", recovered_mr_pair(with_contours_as_they_fit(folder / "organs.toml"), folder / "out")


def zones_of(report):
    return [region for region in report["regions"] if region["label"] in (2, 3)]


def test_pelvis_mr_pair_has_the_same_answer_wherever_the_walls_start(trusted_mr_pair, tmp_path):
    """`[prior] displacement_*` is where the fit of the walls starts (method.md, 3.2): not a setting of the answer."""
    _, usual = trusted_mr_pair
    config = with_contours_as_they_fit(tmp_path / "organs.toml",
                                       "displacement_sd_mm = 5\ndisplacement_range_mm = 20\n")
    other = recovered_mr_pair(config, tmp_path / "out")
    for one, two in zip(zones_of(usual), zones_of(other), strict=True):
        assert two["stiffness_kpa"] == pytest.approx(one["stiffness_kpa"], rel=0.1)
        for zone in (one, two):
            # Another answer that a search from elsewhere found is said, and then no number is believed.
            if zone["other_answers_kpa"]:
                assert zone["verdict"] == "not identifiable" and "more than one answer" in zone["reason"]
            low, high = zone["interval_kpa"]
            assert low < one["stiffness_kpa"] < high and low < two["stiffness_kpa"] < high


def test_pelvis_mr_pair_meets_its_target(trusted_mr_pair):
    """Where contours are trusted as far as they fit."""
    data = needed("pelvis_mr_pair_prostatex0001")
    out, report = trusted_mr_pair
    surfaces = {surface["name"]: surface for surface in report["surfaces"]}
    for name in ("bladder", "rectum"):
        assert surfaces[name]["dice_after"] >= 0.97
        assert surfaces[name]["mean_distance_mm_after"] <= 0.5
    for name in ("transition zone", "peripheral zone"):
        assert surfaces[name]["mean_distance_mm_after"] <= 1.0

    warped = numpy.asarray(nibabel.load(out / "warped_labels.nii.gz").dataobj)
    target = numpy.asarray(nibabel.load(data / "deformed_labels.nii.gz").dataobj)
    ours, theirs = numpy.isin(warped, (2, 3)), numpy.isin(target, (2, 3))
    assert 2 * (ours & theirs).sum() / (ours.sum() + theirs.sum()) >= 0.94

    for zone in zones_of(report):
        low, high = zone["interval_kpa"]
        assert 0 < low < zone["stiffness_kpa"] < high
        assert zone["verdict"] == verdict_that_follows(zone)


def landmark_rms_mm(folder, rows):
    image = nibabel.load(folder / "displacement.nii.gz")
    field = numpy.asarray(image.dataobj)[:, :, :, 0, :]
    index = nibabel.affines.apply_affine(numpy.linalg.inv(image.affine), rows[:, 1:4] * [-1, -1, 1])
    low = numpy.clip(numpy.floor(index).astype(int), 0, numpy.array(field.shape[:3]) - 2)
    fraction = index - low
    moved = numpy.zeros((len(rows), 3))
    for corner in numpy.ndindex(2, 2, 2):
        weight = numpy.prod(numpy.where(corner, fraction, 1 - fraction), axis=1)
        at = low + corner
        moved += weight[:, None] * field[at[:, 0], at[:, 1], at[:, 2]]
    errors = rows[:, 1:4] + moved - rows[:, 4:7]
    return numpy.sqrt((errors ** 2).sum(axis=1).mean())


def test_lung_landmarks_come_closer_than_by_the_best_translation(tmp_path):
    data = needed("lung_ct_pair_elastix")
    finished = run_palpate(
        "recover", data / "baseline_lung_mask.mha", data / "followup_lung_mask.mha", "--config",
        ROOT / "examples/lung_ct/organs.toml", "--align", "centroid", "--out", tmp_path / "out",
        "--quiet")
    assert finished.returncode == 0, finished.stderr
    rows = numpy.genfromtxt(data / "landmarks.csv", delimiter=",", skip_header=2)
    assert len(rows) == 26
    assert landmark_rms_mm(tmp_path / "out", rows) < 4.8
