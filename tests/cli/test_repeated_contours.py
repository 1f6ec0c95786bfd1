# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""A second segmentation of the reference's image measures how far contours are off."""
import json

import pytest

from tests.conftest import run_palpate

SD_MM = 0.5


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """A pair, and the reference drawn once more: a target in which nothing moved."""
    folder = tmp_path_factory.mktemp("drawn")
    for name, more in (("pair", []), ("again", ["--load-factor", 0, "--target", 2])):
        made = run_palpate("phantom", "pelvis", "--seed", 5, "--contours", f"matern32:{SD_MM}:7", "--nodes", 8000,
                           "--spacing", 1.5, 1.5, 1.5, "--out", folder / name, "--quiet", *more)
        assert made.returncode == 0, made.stderr
    return folder / "pair", folder / "again" / "target.nii.gz"


def recover(pair, again, out, config=None):
    return run_palpate("recover", pair / "reference.nii.gz", pair / "target.nii.gz", "--config",
                       config or pair / "organs.toml", "--repeated-reference", again, "--out", out, "--nodes", 2500,
                       "--fields", "none", "--quiet")


def test_the_noise_is_measured_and_used(drawn, tmp_path):
    pair, again = drawn
    finished = recover(pair, again, tmp_path / "out")
    assert finished.returncode in (0, 7), finished.stderr
    contours = json.loads((tmp_path / "out" / "result.json").read_text())["contours"]
    assert contours["sd_mm"] == pytest.approx(SD_MM, rel=0.2) and contours["given"] is True


def test_two_targets_of_one_seed_have_one_reference(drawn):
    pair, again = drawn
    same = again.parent / "reference.nii.gz"
    assert same.read_bytes() == (pair / "reference.nii.gz").read_bytes()
    assert again.read_bytes() != (pair / "target.nii.gz").read_bytes()


def test_what_does_not_fit_is_told(drawn, phantom, tmp_path):
    pair, again = drawn
    config = tmp_path / "organs.toml"
    config.write_text((pair / "organs.toml").read_text().replace('contour_sd_mm = "unknown"', "contour_sd_mm = 0.3"))
    for repeated, settings, code, word in ((phantom / "target.nii.gz", None, 4, "different grids"),
                                           (pair / "reference.nii.gz", None, 4, "same labels"),
                                           (again, config, 2, "contour_sd_mm")):
        finished = recover(pair, repeated, tmp_path / "out", settings)
        assert finished.returncode == code and word in finished.stderr, finished.stderr
        assert not (tmp_path / "out").exists()
