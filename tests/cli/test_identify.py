# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""palpate identify: examples, real curves, and a clear sentence for each mistake."""
import csv
import json

import numpy
import pytest

from tests.conftest import ROOT, run_palpate

EXAMPLES = ROOT / "examples/identify"


def identify(experiment, out, *more):
    finished = run_palpate("identify", experiment, "--out", out, "--quiet", *more)
    return finished, json.loads((out / "result.json").read_text()) if (out / "result.json").exists() else None


def values(result):
    return {part["path"]: part for part in result["parameters"]}


def test_the_strip_is_found_again_and_its_model_runs(tmp_path):
    finished, result = identify(EXAMPLES / "strip.toml", tmp_path / "out")
    assert finished.returncode == 0, finished.stderr
    found = values(result)
    truth = {"material[1].mu_kpa": 3.0, "material[1].gamma": 4.0,
             "material[1].relaxation[1].amplitude": 0.6, "material[1].relaxation[1].time_s": 2.5}
    for path, true in truth.items():
        low, high = found[path]["interval_95"]
        assert low < true < high, path
    assert found["material[1].relaxation[1].time_s"]["verdict"] == "recovered"
    assert result["converged"]
    assert (tmp_path / "out/report.html").exists()

    ran = run_palpate("simulate", tmp_path / "out/identified.toml", "--out", tmp_path / "again", "--quiet")
    assert ran.returncode == 0, ran.stderr
    with open(tmp_path / "out/fit.csv", newline="") as file:
        fitted = {float(row["time_s"]): float(row["predicted"]) for row in csv.DictReader(file)}
    with open(tmp_path / "again/reactions.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    end = float(rows[-1]["right grip_x_mn"])
    gain = found["data[1].gain"]["value"]
    assert fitted[10.0] == pytest.approx(gain * end, rel=1e-3)


def test_tension_needs_no_mesh(tmp_path):
    finished, result = identify(EXAMPLES / "tension.toml", tmp_path / "out")
    assert finished.returncode == 0, finished.stderr
    found = values(result)
    assert found["material[1].mu_kpa"]["interval_95"][0] < 0.7 < found["material[1].mu_kpa"]["interval_95"][1]
    assert found["material[1].gamma"]["interval_95"][0] < 12 < found["material[1].gamma"]["interval_95"][1]
    assert not (tmp_path / "out/identified.toml").exists()


def test_a_plan_uses_no_measured_value(tmp_path):
    text = (EXAMPLES / "tension.toml").read_text()
    answers = []
    for name, change in ("a", 0.0), ("b", 100.0):
        folder = tmp_path / name
        folder.mkdir()
        (folder / "tension.toml").write_text(text)
        lines = (EXAMPLES / "tension.csv").read_text().splitlines()[1:]  # the first is a comment
        moved = [lines[0]] + [f"{row.split(',')[0]},{float(row.split(',')[1]) + change}" for row in lines[1:]]
        (folder / "tension.csv").write_text("\n".join(moved) + "\n")
        finished, result = identify(folder / "tension.toml", folder / "out", "--plan")
        assert finished.returncode == 0, finished.stderr
        answers.append([part["interval_95"] for part in result["parameters"]])
    assert answers[0] == pytest.approx(numpy.array(answers[1]), rel=1e-9)


@pytest.mark.parametrize("method", ["simplex", "bobyqa"])
def test_baselines_find_the_same(tmp_path, method):
    _, best = identify(EXAMPLES / "tension.toml", tmp_path / "map")
    finished, result = identify(EXAMPLES / "tension.toml", tmp_path / method, "--method", method)
    assert finished.returncode == 0, finished.stderr
    for path, part in values(best).items():
        assert values(result)[path]["value"] == pytest.approx(part["value"], rel=0.02)


def test_starts_go_on_where_they_stopped(tmp_path):
    file = tmp_path / "starts.jsonl"
    first, result = identify(EXAMPLES / "tension.toml", tmp_path / "a", "--starts", 2, "--starts-file", file)
    assert first.returncode == 0, first.stderr
    kept = file.read_text()
    assert len(kept.splitlines()) == 3 and kept.startswith("# starts of ")
    second, more = identify(EXAMPLES / "tension.toml", tmp_path / "b", "--starts", 4, "--starts-file", file)
    assert second.returncode == 0, second.stderr
    assert file.read_text().startswith(kept) and len(file.read_text().splitlines()) == 5
    third, _ = identify(EXAMPLES / "tension.toml", tmp_path / "c", "--starts", 2, "--starts-file", file, "--plan")
    assert third.returncode == 2 and "another experiment" in third.stderr
    assert more["search"]["starts"] == 4 and more["search"]["minima"] >= 1


@pytest.mark.parametrize("change, code, words", [
    (("mu_kpa = \"unknown\"\ngamma = \"unknown\"", "mu_kpa = 1\ngamma = 2"), 2, "nothing is \"unknown\""),
    (("sd_kpa = 0.1", ""), 2, "sd_kpa"),
    (("sd_kpa = 0.1", "sd_kpa = -1"), 2, "greater than 0"),
    (("\"stress-stretch\"", "\"stress\""), 2, "allowed: \"force\""),
    (("tension.csv", "nowhere.csv"), 3, "nowhere.csv"),
    (("\"stress-stretch\"", "\"points\""), 2, "sd_mm"),
    (("mu_kpa = \"unknown\"", "mu_kpa = {unknown = true, start = -1}"), 2, "greater than 0"),
    (("mu_kpa = \"unknown\"", "mu_kpa = \"unknwon\""), 2, "mu_kpa"),
    (("sd_kpa = 0.1", "sd_kpa = {unknown = true, start = 0.1}"), 2, "has to be given"),
    (("[[data]]", "[[data]]\nname = \"tension\"\nkind = \"stress-stretch\"\nfile = \"tension.csv\"\nsd_kpa = 1\n"
      "[[data]]"), 2, "names must differ"),
])
def test_mistakes_get_a_sentence_and_a_code(tmp_path, change, code, words):
    text = (EXAMPLES / "tension.toml").read_text()
    assert change[0] in text
    (tmp_path / "tension.toml").write_text(text.replace(*change))
    (tmp_path / "tension.csv").write_text((EXAMPLES / "tension.csv").read_text())
    finished, _ = identify(tmp_path / "tension.toml", tmp_path / "out")
    assert finished.returncode == code, finished.stderr
    assert words in finished.stderr and len(finished.stderr.strip().splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_a_softer_start_than_any_equilibrium_is_no_end(tmp_path):
    """Where the model cannot be solved at its start another one is taken."""
    text = (EXAMPLES / "strip.toml").read_text()
    changed = text.replace('gamma = "unknown"', "gamma = {unknown = true, start = 4000, median = 5, sd_ln = 1.5}")
    assert changed != text
    (tmp_path / "strip.toml").write_text(changed)
    (tmp_path / "strip.csv").write_text((EXAMPLES / "strip.csv").read_text())
    finished, result = identify(tmp_path / "strip.toml", tmp_path / "out")
    assert finished.returncode == 0, finished.stderr
    low, high = values(result)["material[1].gamma"]["interval_95"]
    assert low < 4 < high < 10


def test_a_value_at_an_end_of_what_was_allowed_is_warned_of(tmp_path):
    text = (EXAMPLES / "tension.toml").read_text()
    (tmp_path / "tension.toml").write_text(
        text.replace('mu_kpa = "unknown"', "mu_kpa = {unknown = true, start = 0.25, median = 0.25, highest = 0.3}"))
    (tmp_path / "tension.csv").write_text((EXAMPLES / "tension.csv").read_text())
    finished, result = identify(tmp_path / "tension.toml", tmp_path / "out")
    assert values(result)["material[1].mu_kpa"]["stands_at_an_end"]
    assert "Warning: mu_kpa" in finished.stdout and "stands at an end" in (tmp_path / "out/report.html").read_text()


def test_values_that_the_file_would_not_allow_are_stepped_back_from(tmp_path):
    """A bulk modulus that nothing bounds is tried up to infinity: that ends no run."""
    text = (EXAMPLES / "tension.toml").read_text()
    (tmp_path / "tension.toml").write_text(
        text.replace("kappa_kpa = 1e5", "kappa_kpa = {unknown = true, start = 500, median = 500, sd_ln = 5}"))
    (tmp_path / "tension.csv").write_text((EXAMPLES / "tension.csv").read_text())
    finished, result = identify(tmp_path / "tension.toml", tmp_path / "out")
    assert finished.returncode == 0, finished.stderr
    assert values(result)["material[1].kappa_kpa"]["verdict"] == "not identifiable"


def test_times_that_are_missing_are_asked_for(tmp_path):
    (tmp_path / "strip.toml").write_text((EXAMPLES / "strip.toml").read_text())
    table = (EXAMPLES / "strip.csv").read_text()
    (tmp_path / "strip.csv").write_text(table.replace("time_s,", "time,"))
    finished, _ = identify(tmp_path / "strip.toml", tmp_path / "out")
    assert finished.returncode == 3 and "no column 'time_s'" in finished.stderr
    (tmp_path / "strip.csv").write_text("\ufeff" + table[table.index("time_s"):])  # a mark of UTF-8 first
    finished, result = identify(tmp_path / "strip.toml", tmp_path / "marked")
    assert finished.returncode == 0, finished.stderr
    assert 2.7 < values(result)["material[1].mu_kpa"]["value"] < 3.3
