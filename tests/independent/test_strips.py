# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Strips and films have one law in this folder and in palpate."""
import math

import numpy as np
import pytest

from tests.conftest import PROGRAM
from tests.independent import films, strips


def test_a_strip_of_this_folder_s_law_is_that_law(tmp_path):
    stretch = np.linspace(1, 1.3, 400)
    curve = tmp_path / "strip.csv"
    curve.write_text("stretch,nominal_stress_kPa\n" +
                     "".join(f"{l},{films.nominal_kpa(3, 4, l)}\n" for l in stretch))
    mu, gamma, strip_stretch, stress = strips.law_of_strip(curve, PROGRAM, tmp_path / "out")
    # What counts as slack is cut off: 1 % of the largest stress, and with it a little of the stiffness at rest.
    assert films.nominal_kpa(mu, gamma, 1.2) == pytest.approx(np.interp(1.2, strip_stretch, stress), rel=0.02)
    assert mu == pytest.approx(3, rel=0.1) and gamma == pytest.approx(4, rel=0.1)


def test_what_a_film_leaves_open_goes_along_what_it_knows():
    result = {"parameters": [{"path": "data[1].r_scale"},
                             {"path": "material[1].mu_kpa", "value": 2.0, "interval_95": [1.9, 2.1], "verdict": "recovered"},
                             {"path": "material[1].gamma", "value": 9.0, "interval_95": [8.0, 10.1], "verdict": "recovered"}],
              "combinations": {"correlation": [[1, 0.2, 0.3], [0.2, 1, -0.9], [0.3, -0.9, 1]]}}
    draws, centre = strips.law_of_film(result)
    assert np.exp(centre) == pytest.approx([2, 9])
    assert draws.std(axis=0) == pytest.approx([math.log(2.1 / 1.9) / 3.92, math.log(10.1 / 8) / 3.92], rel=0.05)
    assert np.corrcoef(draws.T)[0, 1] == pytest.approx(-0.9, abs=0.02)

    result["parameters"][2]["verdict"] = "not identifiable"
    with pytest.raises(ValueError, match="not identifiable"):
        strips.law_of_film(result)
