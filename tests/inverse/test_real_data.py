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


def test_pelvis_mr_pair_has_several_answers_and_each_is_said(tmp_path):
    """From its usual start the search ends at a transition zone of a thousand kPa, from another at some 25."""
    config = tmp_path / "organs.toml"
    text = (ROOT / "examples/pelvis_mr/organs.toml").read_text()
    config.write_text(text.replace("contour_sd_mm = 0.5", "displacement_sd_mm = 5\ndisplacement_range_mm = 20"))
    report = recovered_mr_pair(config, tmp_path / "out")
    zone = next(region for region in report["regions"] if region["label"] == 2)
    assert zone["verdict"] == "not identifiable"
    assert "more than one answer" in zone["reason"]
    assert zone["other_answers_kpa"]


def test_pelvis_mr_pair_meets_its_target(tmp_path):
    """Where contours are trusted as far as they fit."""
    data = needed("pelvis_mr_pair_prostatex0001")
    config = tmp_path / "organs.toml"
    text = (ROOT / "examples/pelvis_mr/organs.toml").read_text()
    assert "contour_sd_mm = 0.5" in text
    config.write_text(text.replace("contour_sd_mm = 0.5", 'contour_sd_mm = "unknown"'))
    report = recovered_mr_pair(config, tmp_path / "out")
    surfaces = {surface["name"]: surface for surface in report["surfaces"]}
    for name in ("bladder", "rectum"):
        assert surfaces[name]["dice_after"] >= 0.97
        assert surfaces[name]["mean_distance_mm_after"] <= 0.5
    for name in ("transition zone", "peripheral zone"):
        assert surfaces[name]["mean_distance_mm_after"] <= 1.0

    warped = numpy.asarray(nibabel.load(tmp_path / "out/warped_labels.nii.gz").dataobj)
    target = numpy.asarray(nibabel.load(data / "deformed_labels.nii.gz").dataobj)
    ours, theirs = numpy.isin(warped, (2, 3)), numpy.isin(target, (2, 3))
    assert 2 * (ours & theirs).sum() / (ours.sum() + theirs.sum()) >= 0.94

    zones = [region for region in report["regions"] if region["label"] in (2, 3)]
    for zone in zones:
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
