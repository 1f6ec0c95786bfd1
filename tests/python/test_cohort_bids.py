# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""The face of a cohort as a BIDS App, with cases that compute nothing."""
import csv
import json
import pathlib
import re
import shutil
import subprocess
import sys

import pytest

pytest.importorskip("pandas", reason="pandas is not installed (pip install palpate[cohort])")
pytest.importorskip("statsmodels", reason="statsmodels is not installed (pip install palpate[cohort])")

from palpate.cohort import bids  # noqa: E402
from tests.cli.test_cohort import SETTINGS, write_volume  # noqa: E402
from tests.conftest import PROGRAM  # noqa: E402

VOLUME = "anat/{}_dseg.nii"


@pytest.fixture
def data_set(tmp_path):
    """Two participants with three and two sessions, one with one."""
    number = 1
    for subject, sessions in (("01", 3), ("02", 2), ("03", 1)):
        for session in range(1, sessions + 1):
            path = tmp_path / f"bids/sub-{subject}/ses-{session:02}" / VOLUME.format(f"sub-{subject}_ses-{session:02}")
            path.parent.mkdir(parents=True)
            write_volume(path, number)
            number += 1
    (tmp_path / "organs.toml").write_text(SETTINGS)
    return tmp_path


def call(folder, level, *more):
    return bids.main([str(folder / "bids"), str(folder / "out"), level, "--program", str(PROGRAM), *more])


def first_level(data_set, *more):
    return call(data_set, "participant", "--settings", str(data_set / "organs.toml"), "--pattern", "*_dseg.nii", "--test-stub", "0", *more)


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file, delimiter="\t"))


def test_participants_one_by_one_then_the_group_without_images(data_set, capfd):
    assert first_level(data_set, "--participant_label", "sub-02") == 0
    assert "sub-03 has 1 sessions" in capfd.readouterr().err
    done = list((data_set / "out/cohort/cases").rglob("case.json"))
    assert [path.parts[-3] for path in done] == ["02"]
    assert first_level(data_set, "--participant_label", "01", "--n_cpus", "2") == 0
    shutil.rmtree(data_set / "bids")
    assert call(data_set, "group") == 0 and call(data_set, "group") == 0
    rows = rows_of(data_set / "out/cohort/pairs.tsv")
    assert [(row["participant_id"], row["session_id"], row["status"]) for row in rows] == [
        ("01", "02", "done"), ("01", "03", "done"), ("02", "02", "done")]
    assert (data_set / "out/report/index.html").exists() and (data_set / "out/cohort/gallery.html").exists()


def test_the_reference_session_can_be_named(data_set):
    assert first_level(data_set, "--reference-session", "02") == 0
    assert {row["session_id"] for row in rows_of(data_set / "out/pairs.tsv")} == {"01", "03"}


def test_the_descriptor_has_every_option():
    descriptor = json.loads((pathlib.Path(bids.__file__).parent / "palpate-bids.boutiques.json").read_text())
    flags = {entry["command-line-flag"] for entry in descriptor["inputs"] if "command-line-flag" in entry}
    told = subprocess.run([sys.executable, "-m", "palpate.cohort.bids", "--help"], capture_output=True, text=True).stdout
    assert flags == set(re.findall(r"(?<=[ \[])--[a-z_-]+", told)) - {"--help", "--program"}
    keys = [entry["value-key"] for entry in descriptor["inputs"]]
    assert " ".join(["palpate-bids", *keys]) == descriptor["command-line"]


def test_wrong_input_is_one_sentence(data_set, capfd):
    assert call(data_set, "participant") == 2 and "--settings" in capfd.readouterr().err
    assert first_level(data_set, "--participant_label", "09") == 2 and "no such participant" in capfd.readouterr().err
    second = data_set / "bids/sub-01/ses-01/anat/other_dseg.nii"
    write_volume(second, 99)
    assert first_level(data_set) == 2 and "several label volumes" in capfd.readouterr().err
    shutil.rmtree(data_set / "bids/sub-01")
    shutil.rmtree(data_set / "bids/sub-02")
    assert first_level(data_set) == 4 and "two sessions" in capfd.readouterr().err
