# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Intervals hold on contours as people draw them, and do not with the noise taken for independent (contour_sd_mm = 0)."""
import concurrent.futures
import json
import math

import pytest

from tests.conftest import run_palpate

FAMILIES = {"filling": "matern32:0.5:7", "normal": "squared:0.5:9"}
SEEDS = range(61, 65)
STIFFNESS_KPA = [40, 80, 140, 220]
UNKNOWN = 'contour_sd_mm = "unknown"'


def make(folder, family, seed, kpa):
    out = folder / f"{family}-{seed}"
    made = run_palpate("phantom", "pelvis", "--seed", seed, "--stiffness-kpa", kpa, "--load", family, "--contours",
                       FAMILIES[family], "--nodes", 7000, "--spacing", 1.5, 1.5, 1.5, "--out", out, "--quiet",
                       environment={"OMP_NUM_THREADS": "1"})
    assert made.returncode == 0, made.stderr
    return out


def recovered(phantom, name, contours):
    """The prostate's modulus over the truth: its logarithm, and the logarithms of its interval's ends."""
    config = phantom / f"{name}.toml"
    text = (phantom / "organs.toml").read_text()
    assert text.count(UNKNOWN) == 1
    config.write_text(text.replace(UNKNOWN, contours))
    out = phantom / name
    ran = run_palpate("recover", phantom / "reference.nii.gz", phantom / "target.nii.gz", "--config", config, "--out",
                      out, "--nodes", 3000, "--fields", "none", "--quiet", environment={"OMP_NUM_THREADS": "1"})
    assert ran.returncode in (0, 7), ran.stderr
    region, = [r for r in json.loads((out / "result.json").read_text())["regions"] if r["name"] == "prostate"]
    truth, = [r for r in json.loads((phantom / "truth.json").read_text())["regions"] if r["name"] == "prostate"]
    return [math.log(kpa / truth["stiffness_kpa"]) for kpa in (region["stiffness_kpa"], *region["interval_kpa"])]


@pytest.fixture(scope="module")
def phantoms(tmp_path_factory):
    folder = tmp_path_factory.mktemp("coverage")
    wanted = [(family, seed, kpa) for family in FAMILIES for seed, kpa in zip(SEEDS, STIFFNESS_KPA)]
    with concurrent.futures.ThreadPoolExecutor(2) as two:
        return list(two.map(lambda one: make(folder, *one), wanted))


def all_recovered(phantoms, name, contours):
    with concurrent.futures.ThreadPoolExecutor(2) as two:
        return list(two.map(lambda phantom: recovered(phantom, name, contours), phantoms))


def num_holding(found):
    return sum(low <= 0 <= high for _, low, high in found)


def test_intervals_hold_on_drawn_contours(phantoms):
    found = all_recovered(phantoms, "found", UNKNOWN)
    print(found)
    assert num_holding(found) >= 7
    assert abs(sum(error for error, _, _ in found)) / len(found) < 0.6
    assert all(high - low > math.log(3) for _, low, high in found)


def test_independent_noise_is_confidently_wrong(phantoms):
    found = all_recovered(phantoms, "independent", "contour_sd_mm = 0")
    print(found)
    assert num_holding(found) <= 5
