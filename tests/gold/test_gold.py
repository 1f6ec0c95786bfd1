# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
import json
import pathlib

import pytest

from tests.gold import cases

GOLD = pathlib.Path(__file__).parent / "gold.json"


def recorded():
    return json.loads(GOLD.read_text())


@pytest.mark.parametrize("case", cases.CASES)
def test_the_result_is_as_recorded(case, tmp_path):
    if cases.missing_data(case):
        pytest.skip(f"real data is missing: {cases.missing_data(case)}; set PALPATE_DATA")
    assert cases.differences(cases.CASES[case](tmp_path), recorded()[case]) == []


def test_a_modulus_that_moved_by_a_fifth_of_its_deviation_is_told():
    gold = recorded()["phantom_usual"]
    value, tolerance = gold["prostate.stiffness_kpa"]
    moved = {**gold, "prostate.stiffness_kpa": [value + 1.34 * tolerance, tolerance]}
    assert len(cases.differences(moved, gold)) == 1
    assert cases.differences(gold, gold) == []
