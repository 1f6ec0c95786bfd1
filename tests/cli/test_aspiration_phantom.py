# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""palpate phantom aspiration: what it makes is what `palpate aspirate` takes, and its truth is one."""
import csv
import json
import subprocess

import numpy
import pytest

from tests.conftest import PROGRAM, run_palpate


@pytest.fixture(scope="module")
def perfect(tmp_path_factory):
    folder = tmp_path_factory.mktemp("aspiration") / "phantom"
    finished = run_palpate("phantom", "aspiration", "--seed", 8, "--perfect", "--frames", "png", "--out", folder, "--quiet")
    assert finished.returncode == 0, finished.stderr
    return folder


def points(path):
    """{(time, column): (z, sd)} of what is seen."""
    with open(path, newline="") as table:
        return {(row["time_s"], round(float(row["r_mm"]) / 0.0629 + 89.5)): (float(row["z_mm"]), float(row["sd_mm"]))
                for row in csv.DictReader(table) if row["flag"] == "0"}


def test_outlines_of_a_perfect_film_are_those_of_its_truth(perfect, tmp_path):
    truth = json.loads((perfect / "truth.json").read_text())
    assert truth["is_perfect"] and 0.2 <= truth["mu_kpa"] <= 5 and 1 <= truth["gamma"] <= 25
    assert 0.1 <= truth["amplitude"] <= 1 and 0.5 <= truth["time_s"] <= 8
    assert truth["pixel_z_um"] == 31.75 and truth["delay_s"] == 0
    assert len(list((perfect / "frames").iterdir())) == truth["frames"] == 350
    finished = run_palpate("aspirate", "contours", perfect / "frames", "--config", perfect / "aspiration.toml", "--out",
                           tmp_path / "out", "--quiet")
    assert finished.returncode == 0, finished.stderr
    result = json.loads((tmp_path / "out/result.json").read_text())
    assert result["axis_column_px"] == pytest.approx(89.5, abs=0.1)
    assert result["travel_mm"] == pytest.approx(truth["travel_mm"], abs=0.01)
    found, true = points(tmp_path / "out/profiles.csv"), points(perfect / "profiles_true.csv")
    both = [key for key in true if key in found and abs(key[1] - 89.5) < 60]
    errors = numpy.array([found[key][0] - true[key][0] for key in both]) / 0.03175
    wide = [key for key in true if key in found and true[key][0] > 0.7]
    held = numpy.mean([abs(found[key][0] - true[key][0]) <= 1.96 * found[key][1] for key in wide])
    print(f"{len(both)} points: rms {errors.std():.3f} px, mean {errors.mean():.3f} px; of {len(wide)} {held:.2f} held")
    assert numpy.sqrt(numpy.mean(errors**2)) < 0.07
    assert held > 0.9


def test_the_truth_rises_with_suction_and_relaxes(perfect):
    with open(perfect / "pressure.csv", newline="") as table:
        readings = [(float(row["time_s"]), float(row["suction_mbar"])) for row in csv.DictReader(table)]
    times, mbar = map(numpy.array, zip(*readings))
    true = points(perfect / "profiles_true.csv")
    apex = {float(time): z for (time, column), (z, _) in true.items() if column == 89}
    at_rest = apex[0.0]
    begin = times[mbar > 0][0]
    assert all(abs(z - at_rest) < 1e-4 for time, z in apex.items() if time < begin - 0.05)
    held = times[mbar > mbar.max() - 0.1]
    rise = [z for time, z in sorted(apex.items()) if held[0] + 0.1 < time < held[-1] - 0.1]
    assert numpy.all(numpy.diff(rise) > -1e-5)  # under constant suction it creeps on
    after = [z for time, z in sorted(apex.items()) if time > times[mbar > 0][-1] + 0.1]
    assert numpy.all(numpy.diff(after) < 1e-5)
    assert after[0] > after[-1] >= at_rest - 1e-3


def test_a_film_becomes_tissue_in_one_step(perfect, tmp_path):
    settings = perfect / "coarse.toml"
    settings.write_text((perfect / "aspiration.toml").read_text() + "steps = 12\n")
    finished = run_palpate("aspirate", "run", perfect / "frames", "--pressure", perfect / "pressure.csv", "--config",
                           settings, "--out", tmp_path / "run", "--quiet")
    assert finished.returncode == 0, finished.stderr
    truth = json.loads((perfect / "truth.json").read_text())
    result = json.loads((tmp_path / "run/result.json").read_text())
    values = {one["path"].split(".")[-1]: one for one in result["parameters"]}
    for name, part in (("mu_kpa", 0.25), ("gamma", 0.25), ("amplitude", 0.5)):
        print(name, truth[name], values[name]["value"], values[name]["interval_95"])
        assert values[name]["value"] == pytest.approx(truth[name], rel=part), name
    assert result["contours"]["frames"] == truth["frames"]
    page = (tmp_path / "run/report.html").read_text()
    assert "Over the cycle" in page and "<h2>Frames</h2>" in page
    # the table is the one that the first step alone writes
    finished = run_palpate("aspirate", "contours", perfect / "frames", "--config", settings, "--out", tmp_path / "out",
                           "--quiet")
    assert (tmp_path / "run/profiles.csv").read_bytes() == (tmp_path / "out/profiles.csv").read_bytes()


@pytest.mark.parametrize("arguments, words", [
    (["aspiration", "--stiffness-kpa", "5"], "--stiffness-kpa"),
    (["pelvis", "--perfect"], "--perfect"),
])
def test_options_of_the_other_kind_are_refused(arguments, words, tmp_path):
    finished = subprocess.run([str(PROGRAM), "phantom", *arguments, "--out", str(tmp_path / "phantom")],
                              capture_output=True, text=True, timeout=100)
    assert finished.returncode == 2
    assert words in finished.stderr
    assert not (tmp_path / "phantom").exists()
