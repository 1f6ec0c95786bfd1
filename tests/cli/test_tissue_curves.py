# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""scripts/tissue_curves: measured relaxations and strips by `palpate identify`."""
import importlib.machinery
import importlib.util
import shutil
import subprocess
import sys

import numpy
import pytest

from tests.conftest import DATA, PROGRAM, ROOT

SCRIPT = ROOT / "scripts/tissue_curves"
CURVES = DATA / "tissue_curves"


def study(what, folder, *names):
    """The lines of the table over some of the curves, by name."""
    source = CURVES / {"relaxation": "meat_indentation_relaxation", "tension": "porcine_perineum_tension"}[what]
    if not source.is_dir():
        pytest.skip(f"real data is missing: {source}; set PALPATE_DATA")
    data = folder / "data" / source.name
    data.mkdir(parents=True)
    for name in names:
        shutil.copy(source / f"{name}.csv", data)
    finished = subprocess.run([sys.executable, SCRIPT, what, "--data", data.parent, "--out", folder / "out",
                               "--palpate", PROGRAM], capture_output=True, text=True)
    assert finished.returncode == 0, finished.stderr
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in finished.stdout.splitlines()[2:]]
    return {row[0]: row[1:] for row in rows}


def percent(cell):
    return float(cell.removesuffix(" %"))


def test_measured_relaxation_needs_more_than_one_exponential(tmp_path):
    for row in list(study("relaxation", tmp_path, "230407_FF1A", "230407_RDG1A").values())[:2]:
        one, two, three = map(percent, row[:3])
        assert one > 1 and two <= 0.5 and three <= 0.15
        assert row[3] == "3" and float(row[4]) > 5


def test_a_law_whose_numbers_run_to_nothing_has_a_result(tmp_path):
    """C2 of Yeoh's law is 0 there as far as the curve can tell."""
    rows = study("tension", tmp_path, "pig08_internal_anal_sphincter", "pig09_skin")
    neo_hookean, veronda_westmann, _, yeoh = map(percent, rows["pig09_skin"][:4])
    assert neo_hookean > 5 and veronda_westmann < 1 and yeoh < 1
    assert len(rows) == 3


def test_where_a_strip_is_no_longer_slack(tmp_path):
    loader = importlib.machinery.SourceFileLoader("tissue_curves", str(SCRIPT))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("tissue_curves", loader))
    loader.exec_module(module)
    stretch = numpy.linspace(1, 1.6, 601)
    stress = 50 * numpy.clip(stretch - 1.1, 0, None)
    (tmp_path / "curve.csv.in").write_text("stretch,nominal_stress_kPa\n" +
                                           "".join(f"{l},{s}\n" for l, s in zip(stretch, stress)))
    module.tension_experiment(tmp_path, tmp_path / "curve.csv.in", "yeoh", 1.25)
    first, largest = module.read_columns(tmp_path / "curve.csv", "stretch", "stress_kpa")
    # 1 % of what is reached 1.25 times beyond: s = 50 (1.25 l - 1.1) / 100, at l = 1.1 + s / 50
    slack = (1.1 - 0.011) / (1 - 0.0125)
    assert first[0] == 1 and largest[0] == pytest.approx(50 * (slack - 1.1), abs=0.06)
    assert first[-1] == pytest.approx(1.25, abs=0.01)
