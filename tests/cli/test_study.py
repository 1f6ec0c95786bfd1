# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Studies through the command line, on phantoms that are too coarse to be accurate."""
import csv
import json

import pytest

from tests.conftest import run_palpate

SMALL = ["--phantoms", 1, "--phantom-nodes", 4000, "--nodes", 2000, "--spacing", 2, 2, 2, "--quiet"]


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    out = tmp_path_factory.mktemp("study") / "coverage"
    finished = run_palpate("study", "coverage", "--out", out, *SMALL)
    assert finished.returncode == 0, finished.stderr
    return out, finished.stdout


def rows_of(folder):
    with open(folder / "study.csv", newline="") as file:
        return list(csv.DictReader(file))


def test_a_study_writes_rows_page_summary_and_pictures(study):
    out, text = study
    row, = rows_of(out)
    assert row["case"] == "seed-1" and 40 <= float(row["true_kpa"]) <= 350
    assert float(row["low_kpa"]) < float(row["found_kpa"]) < float(row["high_kpa"])
    assert float(row["landmark_mean_mm"]) < 1.5 and row["converged"] == "yes"
    page = (out / "study.html").read_text()
    assert "</html>" in page and "<script" not in page and "nan" not in page
    assert json.loads((out / "study.json").read_text())["summary"]["all: count"] == 1
    assert (out / "pictures" / "recovered.svg").read_text().startswith("<svg xmlns=")
    assert "median |error|" in text and "study.html" in text


def test_the_same_command_again_computes_nothing(study):
    out, text = study
    before = (out / "study.csv").read_bytes()
    finished = run_palpate("study", "coverage", "--out", out, *SMALL)
    assert finished.returncode == 0 and finished.stdout == text
    assert (out / "study.csv").read_bytes() == before


def test_other_settings_are_refused_by_name(study):
    out, _ = study
    finished = run_palpate("study", "coverage", "--out", out, *SMALL, "--first-seed", 5)
    assert finished.returncode == 10
    assert "first seed 1, but 5 was asked for" in finished.stderr and "--overwrite" in finished.stderr


def test_the_spheres_are_solved_within_one_percent(tmp_path):
    out = tmp_path / "spheres"
    finished = run_palpate("study", "sensitivity", "--out", out, "--quiet")
    assert finished.returncode == 0, finished.stderr
    rows = rows_of(out)
    assert len(rows) == 50
    assert max(abs(float(row["error_percent"])) for row in rows) < 1


def test_a_bulk_modulus_that_is_assumed_too_small_does_what_it_does_in_another_program(tmp_path):
    """The same set-up, solved and fitted by an independent program (quadrilaterals with a mean volume, Gauss-Newton)."""
    out = tmp_path / "kappa"
    finished = run_palpate("study", "aspiration-kappa", "--out", out, "--jobs", 2, "--quiet")
    assert finished.returncode == 0, finished.stderr
    rows = rows_of(out)
    found = {float(row["kappa_kpa"]): row for row in rows if row["true_kappa_kpa"] == "10000"}
    names, truth = ("mu_kpa", "gamma", "amplitude", "time_s"), (0.693, 12.0, 0.41, 4.7)
    for name, number in zip(names, truth):
        assert float(found[1e4][name]) == pytest.approx(number, rel=1e-3), name
    elsewhere = {1e3: (0.678, 12.8, 0.408, 4.57), 1e2: (0.546, 22.2, 0.424, 3.47)}
    for kappa, numbers in elsewhere.items():
        for name, true, number in zip(names, truth, numbers):  # how far it was moved, not where it is
            if (kappa, name) != (1e2, "amplitude"):
                assert float(found[kappa][name]) - true == pytest.approx(number - true, rel=0.3), (kappa, name)
    # Here the programs are not as near: palpate finds 0.432 (on its old cells or steps 0.431, 0.430, on both 0.428), the
    # other 0.422 to 0.426 on finer cells and steps; published is 0.44. Why is not known: between both.
    assert 0.424 < float(found[1e2]["amplitude"]) < 0.44
    usual, = (row for row in rows if row["true_kappa_kpa"] == "100000")
    for name, number in zip(names, truth):
        assert float(usual[name]) == pytest.approx(number, rel=0.01), name
    assert float(found[1e3]["rms_um"]) == pytest.approx(2.7, abs=0.5)
    page = (out / "study.html").read_text()
    assert "published, of a measurement" in page and "nan" not in page


def test_two_zones_get_a_verdict_each_and_a_still_phantom_is_called_unidentifiable(tmp_path):
    out = tmp_path / "zones"
    finished = run_palpate("study", "zones", "--out", out, *SMALL)
    assert finished.returncode == 0, finished.stderr
    rows = {row["kind"]: row for row in rows_of(out)}
    assert set(rows) == {"two-zones", "still", "rigid", "rigid-core"}
    assert rows["two-zones"]["transition_verdict"] in ("recovered", "weak")
    for zone in ("transition", "peripheral"):
        assert rows["still"][zone + "_verdict"] == "not identifiable"
        assert rows["still"][zone + "_holds_truth"] == "yes"
    assert rows["rigid"]["peripheral_verdict"] != "recovered"
    page = (out / "study.html").read_text()
    assert "Built to be unidentifiable" in page and "nan" not in page


def test_an_unknown_study_is_a_usage_error():
    finished = run_palpate("study", "astrology", "--out", "nowhere")
    assert finished.returncode == 2
