# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Several targets of one reference, and the reduced model saved for later ones."""
import csv
import re
import json
import shutil

import pytest

from tests.conftest import recover_arguments, run_palpate, with_unknown_ratio


def prostate_kpa(folder):
    report = json.loads((folder / "result.json").read_text())
    return next(r for r in report["regions"] if r["name"] == "prostate")["stiffness_kpa"]


def load_arguments(phantom, out, saved, *more, target=None):
    return ["recover", phantom / "reference.nii.gz", target or phantom / "target.nii.gz", "--config",
            phantom / "organs.toml", "--out", out, "--load-reduced", saved, *more]


@pytest.fixture(scope="module")
def two(phantom, tmp_path_factory):
    """The phantom's target, and the reference itself as a target: nothing moved."""
    folder = tmp_path_factory.mktemp("targets")
    shutil.copy(phantom / "reference.nii.gz", folder / "still.nii.gz")
    arguments = recover_arguments(phantom, folder / "out", "--save-reduced", folder / "saved.reduced",
                                  "--keep-file-names")
    arguments.insert(3, folder / "still.nii.gz")
    return folder, run_palpate(*arguments)


def test_every_target_gets_its_folder_and_its_lines(two):
    folder, finished = two
    assert finished.returncode in (0, 7), finished.stderr
    assert {entry.name for entry in (folder / "out").iterdir()} == {"target", "still", "targets.csv",
                                                                "targets.html"}
    with open(folder / "out" / "targets.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["target"] for row in rows] == ["target", "still"]
    assert float(rows[0]["stiffness_kpa"]) == pytest.approx(prostate_kpa(folder / "out" / "target"))
    assert float(rows[0]["low_kpa"]) < float(rows[0]["stiffness_kpa"]) < float(rows[0]["high_kpa"])
    assert rows[1]["verdict"] == "not identifiable"  # the reference again: nothing moved
    for word in ("Target", "prostate", "still", rows[0]["verdict"], "targets.csv"):
        assert word in finished.stdout


@pytest.fixture(scope="module")
def several(tmp_path_factory):
    """Two targets of one reference, the second twice, and the reference itself; the contours as people draw them."""
    folder = tmp_path_factory.mktemp("several")
    made = []
    for number in (1, 2):
        finished = run_palpate("phantom", "pelvis", "--seed", 2, "--stiffness-kpa", 60, "--spacing", 2, 2, 2, "--nodes",
                               8000, "--contours", "matern32:0.5:6", "--target", number, "--out",
                               folder / f"phantom{number}", "--quiet")
        assert finished.returncode == 0, finished.stderr
        made.append(folder / f"phantom{number}")
    first, second = made
    arguments = recover_arguments(first, folder / "out", "--fields", "none")
    for more in (shutil.copy(first / "reference.nii.gz", folder / "still.nii.gz"),
                 shutil.copy(second / "target.nii.gz", folder / "again.nii.gz"), second / "target.nii.gz"):
        arguments.insert(3, more)
    return folder, run_palpate(*arguments)


def test_what_all_targets_tell_is_the_last_line(several):
    folder, finished = several
    assert finished.returncode in (0, 7), finished.stderr
    with open(folder / "out" / "targets.csv", newline="") as file:
        *alone, joint = csv.DictReader(file)
    assert float(joint["low_kpa"]) < 60 < float(joint["high_kpa"])
    assert float(joint["low_kpa"]) < float(joint["stiffness_kpa"]) < float(joint["high_kpa"])
    assert joint["verdict"] and joint["region"] == "prostate"
    assert len(alone) == 4 and joint["target"] == "joint"


def test_what_tells_nothing_of_its_own_is_left_out_of_the_joint_estimate(several):
    _, finished = several
    assert "joint: of 2 targets together" in finished.stdout
    assert "target-3 has the labels of target 2" in finished.stdout
    assert "target-4 has the labels of the reference" in finished.stdout


def test_the_page_of_all_targets_shows_the_joint_estimate_and_links_to_every_report(several):
    folder, _ = several
    page = (folder / "out" / "targets.html").read_text()
    with open(folder / "out" / "targets.csv", newline="") as file:
        *alone, joint = csv.DictReader(file)
    if joint["verdict"] == "not identifiable":
        assert "<h1>prostate: not identifiable</h1>" in page
    else:
        headline = re.search(r"<h1>prostate: ([\d.]+) kPa \(95 % interval ([\d.]+) to ([\d.]+) kPa\)</h1>", page)
        shown = [float(joint[name]) for name in ("stiffness_kpa", "low_kpa", "high_kpa")]
        assert [float(text) for text in headline.groups()] == pytest.approx(shown, rel=0.01)
    for row in alone:
        assert f"<a href='{row['target']}/report.html'>" in page
        assert (folder / "out" / row["target"] / "report.html").exists()
    assert "<script" not in page and "://" not in page


def test_one_target_that_tells_something_has_no_joint_line(two):
    folder, _ = two
    assert "joint" not in (folder / "out" / "targets.csv").read_text()


def test_targets_that_did_not_converge_are_left_out(several, tmp_path):
    folder, _ = several
    first, second = folder / "phantom1", folder / "phantom2"
    arguments = recover_arguments(first, tmp_path / "out", "--fields", "none", "--max-iterations", 1)
    arguments.insert(3, second / "target.nii.gz")
    finished = run_palpate(*arguments)
    assert finished.returncode == 7, finished.stderr
    assert "joint" not in finished.stdout


def test_a_plan_tells_that_both_sides_tell_more(phantom):
    finished = run_palpate("recover", phantom / "reference.nii.gz", "--config", phantom / "organs.toml", "--plan",
                           "--plan-motion", 4, "--plan-contours", 0.2, "--nodes", 2500, "--quiet")
    assert finished.returncode == 0, finished.stderr
    lines = [line for line in finished.stdout.splitlines() if line.startswith("prostate")]
    assert len(lines) == 3
    for line in lines:
        one, two, four, both, both_of_four = (float(word) for word in line.split(" x ")[1:])
        assert one > two > four > both_of_four > 1 and two > both > both_of_four


def test_a_plan_of_more_motion_and_better_contours_expects_more(phantom):
    factors = []
    for more in (["--plan-motion", 1.5, "--plan-contours", 0.2], ["--plan-motion", 6, "--plan-contours", 0.2],
                 ["--plan-motion", 6, "--plan-contours", 0.05]):
        finished = run_palpate("recover", phantom / "reference.nii.gz", "--config", phantom / "organs.toml", "--plan",
                               "--nodes", 2500, "--quiet", *more)
        assert finished.returncode == 0, finished.stderr
        line = next(line for line in finished.stdout.splitlines() if line.startswith("prostate"))
        factors.append(float(line.split(" x ")[1]))
    assert factors[0] > factors[1] > factors[2]


@pytest.mark.parametrize("more, word", [(["--plan-motion", 3], "--plan"), ([], "--out is required")])
def test_what_belongs_to_a_plan_or_does_not_is_told(phantom, more, word):
    finished = run_palpate("recover", phantom / "reference.nii.gz", phantom / "target.nii.gz", "--config",
                           phantom / "organs.toml", *more)
    assert finished.returncode == 2 and word in finished.stderr, finished.stderr


def test_a_plan_of_hardly_any_motion_tells_that_targets_would_tell_nothing(phantom):
    finished = run_palpate("recover", phantom / "reference.nii.gz", "--config", phantom / "organs.toml", "--plan",
                           "--plan-motion", 0.1, "--nodes", 2500, "--quiet")
    assert finished.returncode == 0, finished.stderr
    lines = [line for line in finished.stdout.splitlines() if line.startswith("prostate")]
    assert len(lines) == 3 and all("nothing" in line for line in lines)


@pytest.mark.parametrize("more", [["--out", "plan"], ["--load-reduced", "saved.reduced"], ["--method", "nested-lbfgs"],
                                  ["--repeated-reference", "again.nii.gz"]])
def test_a_plan_refuses_what_it_makes_no_use_of(phantom, tmp_path, more):
    finished = run_palpate("recover", phantom / "reference.nii.gz", "--config", phantom / "organs.toml", "--plan", *more)
    assert finished.returncode == 2 and more[0] in finished.stderr, finished.stderr
    assert len(finished.stderr.strip().splitlines()) == 1


def test_a_plan_takes_no_unknown_ratio(phantom, tmp_path):
    finished = run_palpate("recover", phantom / "reference.nii.gz", "--config", with_unknown_ratio(phantom, tmp_path),
                           "--plan")
    assert finished.returncode == 4 and "Poisson" in finished.stderr, finished.stderr


def test_a_plan_takes_no_target(phantom):
    finished = run_palpate("recover", phantom / "reference.nii.gz", phantom / "target.nii.gz", "--config",
                           phantom / "organs.toml", "--plan")
    assert finished.returncode == 2 and "reference alone" in finished.stderr, finished.stderr


def test_a_saved_reduced_model_gives_the_same_modulus_without_meshing(phantom, two, tmp_path):
    folder, _ = two
    finished = run_palpate(*load_arguments(phantom, tmp_path / "out", folder / "saved.reduced"))
    assert finished.returncode == 0, finished.stderr
    assert prostate_kpa(tmp_path / "out") == prostate_kpa(folder / "out" / "target")
    report = json.loads((tmp_path / "out" / "result.json").read_text())
    assert "loading" in report["timings_s"] and "loading" in finished.stderr
    assert not {"surfaces", "meshing", "condensing", "compressing"} & set(report["timings_s"])
    assert report["linear_solver"]["condensing"]["reason"].endswith("saved reduced model")


def test_a_wrong_saved_reduced_model_is_refused(phantom, two, tmp_path):
    folder, _ = two
    config = tmp_path / "organs.toml"
    text = (phantom / "organs.toml").read_text()
    config.write_text(text.replace("stiffness_sd_ln = 1.2", "stiffness_sd_ln = 0.5"))
    damaged = tmp_path / "damaged.reduced"
    damaged.write_bytes((folder / "saved.reduced").read_bytes()[:-100])
    out = tmp_path / "out"
    for saved, more, code, word in (
            (damaged, [], 3, "damaged"),
            (phantom / "organs.toml", [], 3, "no saved reduced model"),
            (folder / "saved.reduced", ["--nodes", 3000], 2, "--nodes")):
        finished = run_palpate(*load_arguments(phantom, out, saved, "--quiet", *more))
        assert finished.returncode == code, finished.stderr
        assert word in finished.stderr and len(finished.stderr.strip().splitlines()) == 1
    arguments = load_arguments(phantom, out, folder / "saved.reduced", "--quiet")
    arguments[4] = config
    finished = run_palpate(*arguments)
    assert finished.returncode == 4 and "stiffness_sd_ln = 0.5" in finished.stderr, finished.stderr
    assert not out.exists()


def test_a_wrong_target_stops_before_anything_is_written(phantom, tmp_path):
    arguments = recover_arguments(phantom, tmp_path / "out", "--save-reduced", tmp_path / "saved")
    arguments.insert(3, "nowhere.nii.gz")
    finished = run_palpate(*arguments)
    assert finished.returncode == 3 and "nowhere.nii.gz" in finished.stderr
    assert list(tmp_path.iterdir()) == []
