# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""What scripts/coverage_families and scripts/joint_targets make of the rows of studies."""
import importlib.machinery
import importlib.util
import math
import pathlib
import sys

import pytest

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"


def script(name):
    loader = importlib.machinery.SourceFileLoader(name, str(SCRIPTS / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    sys.modules[name] = module
    loader.exec_module(module)
    return module


coverage, joint = script("coverage_families"), script("joint_targets")


def row(truth, told, low, high, verdict, **more):
    return {"truth_kpa": str(truth), "told_kpa": str(told), "low_kpa": str(low), "high_kpa": str(high), "verdict": verdict, **more}


def cells(line):
    return [cell.strip() for cell in line.strip("|").split("|")]


def test_intervals_of_what_is_not_told_are_counted_apart():
    rows = [row(100, 110, 80, 150, "recovered"), row(100, 40, 20, 80, "weak"), row(100, 100, 9.5, 1050, "not identifiable"),
            {"verdict": "no result: seed-4 failed: no mesh"}]
    found = cells(coverage.line_of("a list", rows))
    assert found[1].startswith("2 of 3 (") and found[1].endswith("1 without a result")
    assert found[2].startswith("1 of 2 (")
    assert found[8] == "1, 1, 1"
    assert found[4] == f"{math.log(100 / 40):.2f}"


def test_an_end_that_is_not_known_holds_whatever_is_there():
    assert coverage.phantom_of(row(500, 300, 200, "", "weak")).holds
    assert not coverage.phantom_of(row(100, 300, 200, "", "weak")).holds
    assert math.isnan(coverage.phantom_of(row(500, 300, 200, "", "weak")).width)


def test_phantoms_without_a_result_are_rows_and_end_no_list():
    said = "seed-80002 failed: no valid mesh could be made\n"
    found = list(coverage.failed_rows(range(80000, 80003), [{"seed": 80000}], said))
    assert [one["seed"] for one in found] == [80002]  # of 80001 nothing was said: it is tried again
    assert found[0]["verdict"].endswith("no valid mesh could be made")
    one = coverage.List("filling, exact", 80000, [])
    rows = {(10, one.name, 80000 + place): {} for place in (0, 1, 3)}
    assert coverage.num_done(one, 10, rows) == 2


def test_other_numerics_have_other_seeds_and_keep_old_rows(tmp_path, monkeypatch):
    assert {one.name for one in coverage.all_lists(10)} == {one.name for one in coverage.all_lists(11)}
    seeds = [{seed for one in coverage.all_lists(numerics) if one.python is python for seed in range(one.first_seed, one.first_seed + one.most)}
             for numerics in (10, 11) for python in (False, True)]
    assert not seeds[0] & seeds[2] and not seeds[1] & seeds[3]
    monkeypatch.setattr(coverage, "ROOT", tmp_path)
    monkeypatch.setattr(coverage, "LEDGER", tmp_path / "coverage.tsv")
    (tmp_path / "build").mkdir()
    one = coverage.all_lists(10)[0]
    coverage.add_to_ledger(10, "abc", one, [{"seed": 80000, **row(100, 110, 80, 150, "weak")}])
    coverage.add_to_ledger(11, "def", one, [{"seed": 90000, **row(100, 110, 80, 150, "weak")}])
    kept = coverage.read_ledger()
    assert set(kept) == {(10, one.name, 80000), (11, one.name, 90000)}
    assert kept[10, one.name, 80000]["program"] == "abc"


def test_a_program_that_does_not_say_its_numerics_is_refused():
    with pytest.raises(SystemExit, match="does not say its numerics"):
        coverage.numerics_of("/bin/true")
    with pytest.raises(SystemExit, match="cannot be started"):
        coverage.numerics_of("/no/palpate")


def target(low, high, told=60, note=""):
    return {"low_kpa": str(low), "high_kpa": str(high), "stiffness_kpa": str(told), "verdict": "weak", "note": note}


def test_four_equal_targets_tell_what_is_expected_of_them():
    """Reference and target are off alike: a single one has 2 s^2, four on one side 5/4 s^2, all on both sides 1/4 s^2."""
    prior, s = joint.PRIOR_SD, 0.3
    for name, variance in (("four on one side", 1.25 * s**2), ("two on either side", 0.25 * s**2)):
        def interval(v):
            sd = 1 / math.sqrt(1 / v + 1 / prior**2)
            return 60 * math.exp(-1.96 * sd), 60 * math.exp(1.96 * sd)
        found = joint.outcome_of(60, [target(*interval(2 * s**2))] * 4, target(*interval(variance), note="of 4 targets together"))
        assert found.holds and found.num_joined == 4 and found.num_telling == 4
        assert found.ratio == pytest.approx(joint.EXPECTED[name], rel=1e-6)


def test_targets_that_tell_nothing_count_as_nothing():
    nothing = target(60 * math.exp(-1.96 * 1.3), 60 * math.exp(1.96 * 1.3))  # wider than what is expected before
    assert joint.information(nothing) == 0
    assert joint.outcome_of(60, [nothing] * 4, target(30, 120)).ratio is None
    some = joint.outcome_of(60, [nothing] * 2 + [target(20, 180)] * 2, target(30, 120, note="of 3 targets together"))
    all_four = joint.outcome_of(60, [target(20, 180)] * 4, target(30, 120))
    assert some.ratio == pytest.approx(all_four.ratio / math.sqrt(2)) and some.num_telling == 2 and some.num_joined == 3
    assert "1 of 2 without a joint estimate" in joint.summary_of("four on one side", [all_four], 2)


def test_the_page_has_the_table_of_the_record():
    assert coverage.table_of(max(numerics for numerics, _, _ in coverage.read_ledger())) in coverage.PAGE.read_text(), \
        "docs/studies.md is not in step with docs/coverage.tsv: scripts/coverage_families table --write"
