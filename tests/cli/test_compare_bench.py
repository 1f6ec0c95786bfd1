# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""The table of ratios between benchmark files."""
import json
import subprocess
import sys

import pytest

from tests.conftest import ROOT


def run_compare(*arguments):
    return subprocess.run([sys.executable, str(ROOT / "scripts/compare_bench.py"),
                           *map(str, arguments)], capture_output=True, text=True, timeout=60)


def row(name, time, unit="ms", **more):
    return {"name": name, "run_name": name, "run_type": "iteration", "real_time": time,
            "time_unit": unit, **more}


def median_row(name, time, unit="ms"):
    return {**row(name, time, unit), "name": f"{name}_median", "run_type": "aggregate",
            "aggregate_name": "median"}


@pytest.fixture
def write(tmp_path):
    def write_file(name, *rows):
        path = tmp_path / name
        path.write_text(json.dumps({"context": {}, "benchmarks": rows}))
        return path
    return write_file


def ratios(finished):
    """Ratio by row name, from the printed table."""
    assert finished.returncode == 0, finished.stderr
    lines = [line.split() for line in finished.stdout.splitlines()[1:]]
    return {line[0]: float(line[-1]) for line in lines}


def test_ratio_is_old_time_over_new_time_in_any_unit(write):
    old = write("old.json", row("solve/a", 3.0, "ms"), row("solve/gone", 1.0))
    new = write("new.json", row("solve/a", 1500.0, "us"), row("solve/fresh", 1.0))

    assert ratios(run_compare(old, new)) == {"solve/a": 2.0}


def test_median_counts_where_a_row_was_repeated(write):
    old = write("old.json", row("a", 1.0), row("a", 9.0), row("a", 2.0), median_row("a", 2.0))
    only_repetitions = write("new.json", row("a", 4.0), row("a", 100.0), row("a", 1.0))

    assert ratios(run_compare(old, only_repetitions)) == {"a": 0.5}


def test_how_a_row_was_measured_is_not_part_of_its_name(write):
    old = write("old.json", row("solve/a/columns:16/iterations:1/manual_time", 6.0))
    new = write("new.json", row("solve/a/columns:16/manual_time", 2.0))

    assert ratios(run_compare(old, new)) == {"solve/a/columns:16": 3.0}


def test_rows_within_a_file_are_compared_with_their_own_reference(write):
    file = write("rows.json", row("solve/18k/gamg/columns:1", 8.0), row("solve/18k/ours/columns:1", 2.0),
                 row("solve/90k/gamg/columns:1", 50.0), row("solve/90k/ours/columns:1", 5.0),
                 row("solve/90k/ours/columns:16", 9.0))

    found = ratios(run_compare("--within", file, "--reference", "ga.*"))

    assert found == {"solve/18k/ours/columns:1": 4.0, "solve/90k/ours/columns:1": 10.0}


def test_filter_keeps_matching_rows_only(write):
    file = write("rows.json", row("solve/18k", 8.0), row("solve/90k", 2.0))

    assert ratios(run_compare(file, file, "--filter", "90k")) == {"solve/90k": 1.0}


def test_rows_with_an_error_do_not_count(write):
    old = write("old.json", row("a", 0.0, error_occurred=True, error_message="no device"),
                row("b", 1.0))
    new = write("new.json", row("a", 1.0), row("b", 1.0))

    assert ratios(run_compare(old, new)) == {"b": 1.0}


@pytest.mark.parametrize("content", ["not json", "[]", "{}", '{"benchmarks": [{"name": "a"}]}',
                                     '{"benchmarks": [7]}'])
def test_file_of_another_kind_is_refused_in_one_sentence(tmp_path, write, content):
    bad = tmp_path / "bad.json"
    bad.write_text(content)

    finished = run_compare(bad, write("good.json", row("a", 1.0)))

    assert finished.returncode == 2
    assert len(finished.stderr.splitlines()) == 1 and "bad.json" in finished.stderr


def test_what_cannot_be_compared_is_said_in_one_sentence(tmp_path, write):
    file = write("rows.json", row("a/x", 1.0), row("a/y", 1.0))
    for arguments in ([tmp_path / "missing.json", file], [file], [],
                      [file, write("other.json", row("b", 1.0))],
                      ["--within", file], ["--within", file, "--reference", "z"],
                      ["--within", file, "--reference", "("], ["--within", file, "--reference", "x|y"]):
        finished = run_compare(*arguments)

        assert finished.returncode == 2, arguments
        assert len(finished.stderr.splitlines()) == 1, finished.stderr
