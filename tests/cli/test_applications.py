# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Applications are reached by their table of options alone; two springs are the example."""
import json

import pytest

from tests.conftest import ROOT, run_palpate

SPRINGS = ["springs", "--force-mn", 10, "--joint-mm", 2, "--end-mm", 7, 7.05, 6.95, "--noise-mm", 0.05, "--quiet"]


def test_two_springs_are_found_with_their_intervals():
    finished = run_palpate(*SPRINGS)
    assert finished.returncode == 0, finished.stderr
    first, second = finished.stdout.splitlines()
    assert "first spring: 5.00 mN/mm" in first and "recovered" in first
    assert "second spring: 2.00 mN/mm" in second and "recovered" in second


def test_the_folder_holds_the_result_for_programs_and_for_people(tmp_path):
    finished = run_palpate(*SPRINGS, "--out", tmp_path / "result")
    assert finished.returncode == 0, finished.stderr
    result = json.loads((tmp_path / "result/result.json").read_text())
    low, high = result["first_mn_per_mm"]["interval"]
    assert low < result["first_mn_per_mm"]["value"] < high and result["converged"] is True
    page = (tmp_path / "result/report.html").read_text()
    assert "Two springs in series" in page and "recovered" in page and "force_mn" in page
    assert run_palpate(*SPRINGS, "--out", tmp_path / "result").returncode == 10
    assert run_palpate(*SPRINGS, "--out", tmp_path / "result", "--overwrite").returncode == 0


@pytest.mark.parametrize("words, sentence", [
    (["--end-mm", 7], "--force-mn"),
    (["--force-mn", -1, "--end-mm", 7],
     "--force-mn is -1; allowed: a number greater than 0 and at most 1000000 (mN)"),
    (["--force-mn", "ten", "--end-mm", 7], "--force-mn is ten; allowed"),
    (["--force-mn", 10, "--end-mm", 7, "--noise", 1], "--noise"),
])
def test_what_the_table_does_not_allow_is_a_usage_error(words, sentence):
    finished = run_palpate("springs", *words)
    assert finished.returncode == 2
    assert sentence in finished.stderr and len(finished.stderr.splitlines()) == 1


def test_the_documentation_is_what_the_program_describes():
    assert run_palpate("describe").stdout == (ROOT / "docs/applications.md").read_text()


def test_the_description_for_programs_holds_limits_and_defaults():
    (springs,) = json.loads(run_palpate("describe", "springs", "--as", "json").stdout)["applications"]
    options = {option["name"]: option for option in springs["options"]}
    assert options["noise_mm"]["default"] == 0.1 and options["noise_mm"]["unit"] == "mm"
    assert options["force_mn"]["required"] and options["force_mn"]["maximum"] == 1e6
    assert options["end_mm"]["least_values"] == 1 and options["end_mm"]["most_values"] is None
    assert run_palpate("describe", "--as", "boutiques").returncode == 2
    descriptor = json.loads(run_palpate("describe", "springs", "--as", "boutiques").stdout)
    assert descriptor["command-line"].startswith("palpate springs [FORCE_MN]")
    flags = {entry["id"]: entry["command-line-flag"] for entry in descriptor["inputs"]}
    assert flags["noise_mm"] == "--noise-mm"
