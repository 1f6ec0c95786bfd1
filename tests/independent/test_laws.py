# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""The study of laws by films of other code: what is drawn, and how what came out is told."""
import json
import tomllib

import pytest

from tests.independent import films, laws


def test_six_seeds_have_every_law_with_one_and_two_terms():
    made = [films.draw_truth(seed) | laws.tissue_of(seed) for seed in range(901, 907)]
    assert made == [films.draw_truth(seed) | laws.tissue_of(seed) for seed in range(901, 907)]
    assert {laws.true_model(truth) for truth in made} == {(law, terms) for law in laws.LAWS for terms in (1, 2)}
    for truth in made:
        law = films.law_of(truth, 1.0)
        amplitude, time = law.terms()
        assert all(0.15 <= amplitude) and all(0.25 <= time)
        if len(time) == 2:
            assert 3 < time[1] / time[0] < 33
        # nominal stress is the slope of the energy along a bar that keeps its volume
        energy = {"veronda-westmann": lambda x: law.mu / law.gamma * (2.718281828459045 ** (law.gamma * x) - 1),
                  "reduced-polynomial": lambda x: truth["c1_kpa"] * x + truth["c2_kpa"] * x**2,
                  "neo-hookean-reduced": lambda x: law.mu * x}[truth["law"]]
        at = lambda stretch: energy(stretch**2 + 2 / stretch - 3)  # noqa: E731
        assert films.nominal_kpa(truth["mu_kpa"], truth["gamma"], 1.2, truth["law"]) == pytest.approx(
            (at(1.2 + 1e-5) - at(1.2 - 1e-5)) / 2e-5, rel=1e-6)


def folder_of(path, seed, evidence, chosen, value_parts=1.0, code=0):
    """What a study leaves of a film whose fit chose a model and found value_parts of each number of the true one."""
    truth = films.draw_truth(seed) | laws.tissue_of(seed)
    (path / "fit").mkdir(parents=True)
    (path / "film").mkdir()
    (path / "film/truth.json").write_text(json.dumps(truth))
    (path / "outcome.json").write_text(json.dumps({"seed": seed, "code": code, "message": "", "seconds": 3.0}))
    parameters = [{"path": name, "value": value_parts * true, "interval_95": [0.9 * true, None]}
                  for name, true in laws.numbers_of(truth).items()]
    name = "{}, {} relaxation term{}"
    models = [{"name": name.format(*model, "s" * (model[1] > 1)), "log_evidence": value} for model, value in
              evidence.items()] + [{"name": "neo-hookean-reduced, 1 relaxation term"}]
    (path / "fit/result.json").write_text(json.dumps(
        {"film": {"model": name.format(*chosen, "s" * (chosen[1] > 1)), "settings": f"laws = {json.dumps(laws.LAWS)}"},
         "models": models, "parameters": parameters}))
    return laws.read_film(path)


def test_table_counts_what_came_first(tmp_path):
    mine, other = "veronda-westmann", "reduced-polynomial"
    seed = 903  # Veronda-Westmann's, two terms
    right = folder_of(tmp_path / "a", seed, {(mine, 2): 30.0, (mine, 1): 20.0, (other, 2): 25.0}, (mine, 2), 1.02)
    fewer = folder_of(tmp_path / "b", seed, {(mine, 2): 30.0, (mine, 1): 29.5, (other, 2): 25.5}, (mine, 1))
    wrong = folder_of(tmp_path / "c", seed, {(mine, 2): 30.0, (other, 2): 31.5}, (other, 2), code=7)
    missed = folder_of(tmp_path / "d", seed, {(mine, 2): 30.0, (other, 2): 10.0}, (mine, 2), 0.8)
    (tmp_path / "e").mkdir()
    (tmp_path / "e/outcome.json").write_text(json.dumps({"seed": seed, "code": 4, "message": "no outline"}))
    none = laws.read_film(tmp_path / "e")
    assert [laws.lead(case) for case in (right, fewer, wrong, missed)] == [5, 4.5, -1.5, 20]
    text = "\n".join(laws.table([right, fewer, wrong, missed, none]))
    assert "5 films, 4 with a result, 3 with exit code 0" in text
    assert f"| {mine} | 3 of 5 | 3 of 5 | 2 of 5 | -1.5, 4.8 |" in text
    # of the fit that chose another model nothing is told; an end that is not there holds everything
    assert "| gamma | 2 of 2 | 11.0 % | -20 % |" in text
    assert laws.line_of(none) == "903: code 4: no outline"


def test_a_fit_that_was_told_the_law_is_no_evidence(tmp_path):
    folder_of(tmp_path / "a", 903, {("veronda-westmann", 2): 30.0}, ("veronda-westmann", 2))
    result = json.loads((tmp_path / "a/fit/result.json").read_text())
    result["film"]["settings"] = 'laws = ["veronda-westmann"]'
    (tmp_path / "a/fit/result.json").write_text(json.dumps(result))
    with pytest.raises(ValueError, match="not every law was asked for"):
        laws.read_film(tmp_path / "a")


def test_settings_name_every_law(tmp_path):
    (tmp_path / "aspiration.toml").write_text('[tissue]\nlaws = ["veronda-westmann"]\nrelaxation_terms = [1]\n')
    assert tomllib.loads(laws.settings_of(tmp_path, [1, 2])) == {
        "tissue": {"laws": list(laws.LAWS), "relaxation_terms": [1, 2]}}


def test_misses_are_told(tmp_path):
    case = folder_of(tmp_path / "f", 906, {("veronda-westmann", 1): 5.0}, ("veronda-westmann", 1))
    case["found"][1] = ("material[1].gamma", 8.0, 9.0, 8.5, 9.5)
    assert "MISSED material[1].gamma 9 [8.5, 9.5] (8)" in laws.line_of(case)
