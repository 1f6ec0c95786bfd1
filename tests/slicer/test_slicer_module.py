# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""palpate-slicer keeps the contract of 3D Slicer's command line modules."""
import json
import os
import subprocess
import time

import nibabel
import numpy as np
import pytest

from tests.conftest import PROGRAM
from tests.slicer import stub_host

MODULE = PROGRAM.parent / "palpate-slicer"
LISTS = {"tissue": "1", "driven": "2,3", "fixed": "4"}
OUTPUTS = {"deformation": "deformation.h5", "warpedLabels": "warped.nrrd", "model": "mesh.vtu",
           "report": "report.html", "resultFolder": "result"}


@pytest.fixture(scope="module")
def description():
    return stub_host.discover(MODULE)[0]


def inputs(phantom, folder, **more):
    values = {"reference": phantom / "reference.nii.gz", "target": phantom / "target.nii.gz",
              "nodes": 1500, "settings": phantom / "organs.toml"}
    return {**values, **{name: folder / file for name, file in OUTPUTS.items()}, **more}


@pytest.fixture(scope="module")
def finished(description, phantom, tmp_path_factory):
    """(run, folder of the outputs)"""
    folder = tmp_path_factory.mktemp("module")
    return stub_host.run(MODULE, description, inputs(phantom, folder), folder), folder


def test_the_description_comes_fast_and_alone():
    root, error, seconds = stub_host.discover(MODULE)
    assert root.tag == "executable" and error == "" and seconds < stub_host.DISCOVERY_LIMIT_S
    for required in ("category", "title", "description", "version", "documentation-url", "license",
                     "contributor"):
        assert root.findtext(required), required
    assert "@" not in root.findtext("version")


def test_the_description_beside_the_program_is_the_same():
    told = subprocess.run([MODULE, "--xml"], capture_output=True, text=True).stdout
    assert MODULE.with_suffix(".xml").read_text() == told


def test_every_parameter_is_one_a_host_knows(description):
    known = {"integer", "double", "boolean", "string", "integer-vector", "string-enumeration", "file",
             "directory", "image", "geometry", "transform"}
    names, flags, indices = [], [], []
    for kind, element in stub_host.parameters(description):
        assert kind in known
        for required in ("name", "label", "description"):
            assert element.findtext(required), (kind, required)
        name = element.findtext("name")
        assert name.isidentifier()
        names.append(name)
        flag, index = element.findtext("longflag"), element.findtext("index")
        is_output = element.findtext("channel") == "output"
        assert flag or index or is_output, f"{name} has no way onto the command line"
        flags += [flag] if flag else []
        indices += [int(index)] if index else []
        if kind == "string-enumeration":
            assert element.findtext("default") in [e.text for e in element.findall("element")]
    assert len(set(names)) == len(names) and len(set(flags)) == len(flags)
    assert sorted(indices) == list(range(len(indices)))


def test_a_run_succeeds_without_a_word_on_standard_error(finished):
    run, _ = finished
    assert run.exit_code == 0, run.error
    assert run.error == ""


def test_progress_begins_rises_and_ends_with_one(finished):
    run, _ = finished
    assert run.tags[0] == "filter-start" and run.tags[-1] == "filter-end"
    assert run.tags.count("filter-start") == run.tags.count("filter-end") == 1
    assert run.progress == sorted(run.progress)
    assert run.progress[0] >= 0 and run.progress[-1] == 1
    assert len(set(run.progress)) > 5
    assert "<" not in run.log


def test_progress_comes_while_the_module_works(description, phantom, tmp_path):
    command = stub_host.command_line(MODULE, description, inputs(phantom, tmp_path),
                                     tmp_path / "return.txt")
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        first = process.stdout.readline()
        assert first.startswith("<filter-start>") and process.poll() is None
        process.kill()


def test_all_outputs_that_were_asked_for_are_there(finished, phantom):
    _, folder = finished
    for file in OUTPUTS.values():
        assert (folder / file).exists(), file
    alone, beside_fields = ((folder / name).read_text() for name in ("report.html", "result/report.html"))
    assert alone.split("<footer>")[0] == beside_fields.split("<footer>")[0]
    assert "displacement.nii.gz" in beside_fields and "displacement.nii.gz" not in alone
    moved = nibabel.load(folder / "result/warped_labels.nii.gz")
    target = nibabel.load(phantom / "target.nii.gz")
    assert set(np.unique(moved.dataobj)) == set(np.unique(target.dataobj))


def test_the_transform_carries_the_reference_onto_the_target(finished, phantom):
    """As a resampling transform it takes points of the target to points of the reference."""
    sitk = pytest.importorskip("SimpleITK", reason="SimpleITK is not installed: scripts/python")
    _, folder = finished
    transform = sitk.ReadTransform(str(folder / "deformation.h5"))
    field = sitk.ReadImage(str(folder / "result/displacement_inverse.nii.gz"), sitk.sitkVectorFloat64)
    same = sitk.DisplacementFieldTransform(field)
    moves = np.loadtxt(phantom / "landmarks.csv", delimiter=",", skiprows=1)[:50]
    errors = []
    for row in moves:
        back = transform.TransformPoint((row[:3] + row[3:]).tolist())
        assert back == same.TransformPoint((row[:3] + row[3:]).tolist())
        errors.append(np.linalg.norm(np.array(back) - row[:3]))
    assert np.mean(errors) < 0.25 * np.mean(np.linalg.norm(moves[:, 3:], axis=1))


def test_return_parameters_are_those_of_the_description(finished, description):
    run, folder = finished
    returned = [element.findtext("name") for _, element in stub_host.parameters(description)
                if element.findtext("channel") == "output" and not element.findtext("longflag")]
    assert sorted(run.returned) == sorted(returned)
    result = json.loads((folder / "result/result.json").read_text())
    (prostate,) = [r for r in result["regions"] if r["name"] == "prostate"]
    assert float(run.returned["stiffness"]) == pytest.approx(prostate["stiffness_kpa"], rel=1e-5)
    assert float(run.returned["stiffnessLow"]) == pytest.approx(prostate["interval_kpa"][0], rel=1e-5)
    assert run.returned["verdict"] == prostate["verdict"]
    assert "prostate" in run.returned["summary"]


def test_lists_of_labels_do_what_a_settings_file_does(finished, description, phantom, tmp_path):
    by_file, _ = finished
    values = inputs(phantom, tmp_path, settings="", **LISTS)
    run = stub_host.run(MODULE, description, values, tmp_path)
    assert run.exit_code == 0, run.error
    assert "tissue-1" in run.returned["summary"]
    assert float(run.returned["stiffness"]) == pytest.approx(float(by_file.returned["stiffness"]),
                                                             rel=0.25)


@pytest.mark.parametrize("change, code, words", [
    ({"reference": "missing.nii.gz"}, 3, "missing.nii.gz"),
    ({"settings": ""}, 2, "no organ"),
    ({"settings": "", "tissue": "1,x"}, 2, "--tissue"),
    ({"settings": "", "tissue": "77"}, 4, "77"),
    ({"nodes": 3}, 2, "--nodes"),
    ({"material": "jelly"}, 2, "jelly"),
    ({"deformation": "deformation.png"}, 2, ".h5"),
    ({"warpedLabels": "warped.png"}, 2, ".nrrd"),
    ({"device": "no such device"}, 8, "no such device"),
    ({"report": "/nowhere/report.html"}, 10, "/nowhere"),
])
def test_failures_are_told_on_standard_error_and_leave_no_output(description, phantom, tmp_path,
                                                                 change, code, words):
    run = stub_host.run(MODULE, description, {"reference": phantom / "reference.nii.gz",
                                              "target": phantom / "target.nii.gz",
                                              "nodes": 1500, "settings": phantom / "organs.toml",
                                              "model": tmp_path / "mesh.vtu", **change},
                        tmp_path, cwd=tmp_path)
    assert run.exit_code == code, run.error
    assert words in run.error and run.error.count("\n") == 1
    assert "filter-end" not in run.tags
    assert not (tmp_path / "return.txt").exists() and not (tmp_path / "mesh.vtu").exists()


def test_an_output_that_fails_leaves_older_ones_as_they_were(description, phantom, tmp_path):
    (tmp_path / "full").mkdir()
    older = tmp_path / OUTPUTS["deformation"]
    older.write_text("of an earlier run")
    faults = {"LD_PRELOAD": str(PROGRAM.parent / "libpalpate_file_faults.so"),
              "PALPATE_FAULT_FOLDER": str(tmp_path / "full"), "PALPATE_FAULT_ACTION": "ENOSPC",
              "PALPATE_FAULT_AT": "2"}
    values = inputs(phantom, tmp_path, report=tmp_path / "full/report.html")
    run = stub_host.run(MODULE, description, values, tmp_path, env={**os.environ, **faults})
    assert run.exit_code == 10 and "report.html" in run.error
    assert older.read_text() == "of an earlier run"
    left = {name for name in os.listdir(tmp_path) if not name.startswith(".")}
    assert left == {"full", older.name}
    assert not os.listdir(tmp_path / "full")


def test_a_killed_module_leaves_no_output_behind(description, phantom, tmp_path):
    command = stub_host.command_line(MODULE, description, inputs(phantom, tmp_path),
                                     tmp_path / "return.txt")
    for delay in (0.3, 1.0, 2.0):
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(delay)
        was_running = process.poll() is None
        process.kill()
        process.wait()
        assert was_running
        assert not [name for name in os.listdir(tmp_path) if not name.startswith(".")]


def test_a_module_that_is_told_to_stop_says_so_and_leaves_no_output(description, phantom, tmp_path):
    command = stub_host.command_line(MODULE, description, inputs(phantom, tmp_path),
                                     tmp_path / "return.txt")
    with subprocess.Popen(command, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE) as process:
        while "<filter-progress>" not in process.stdout.readline():
            assert process.poll() is None
        process.terminate()
        _, error = process.communicate(timeout=60)
    assert process.returncode == 9
    assert error.startswith("palpate-slicer: stopped") and error.count("\n") == 1
    assert not [name for name in os.listdir(tmp_path) if not name.startswith(".")]


def test_parameters_go_to_json_and_back(finished, description, phantom, tmp_path):
    stored = tmp_path / "parameters.json"
    values = inputs(phantom, tmp_path, device="no such device")
    command = stub_host.command_line(MODULE, description, values, tmp_path / "return.txt")
    subprocess.run([*command, "--serialize", stored], capture_output=True)
    parameters = json.loads(stored.read_text())["Parameters"]
    assert parameters["Method"]["nodes"] == 1500
    assert parameters["Organs"]["settings"].endswith("organs.toml")
    assert parameters["Organs"]["freeBorder"] is False
    again = subprocess.run([MODULE, "--deserialize", stored, "--echo", "--device", "other"],
                           capture_output=True, text=True)
    assert "nodes: 1500" in again.stdout and "device: other" in again.stdout
    assert again.returncode == 8 and "other" in again.stderr


def test_parameters_of_another_program_are_read(phantom, tmp_path):
    stored = tmp_path / "parameters.json"
    stored.write_text(json.dumps({"Parameters": {
        "Segmentations": {"reference": str(phantom / "reference.nii.gz"), "target": "missing.nrrd"},
        "Organs": {"tissue": [1], "driven": [2, 3], "surroundings": 12.5, "freeBorder": True}}}))
    told = subprocess.run([MODULE, "--deserialize", stored, "--echo"], capture_output=True, text=True)
    for line in ("tissue: 1", "driven: 2,3", "surroundings: 12.5", "freeBorder: true"):
        assert line in told.stdout
    assert told.returncode == 3 and "missing.nrrd" in told.stderr


@pytest.mark.parametrize("flag, words", [("--help", "USAGE"), ("--version", "palpate-slicer 0")])
def test_every_module_has(flag, words):
    told = subprocess.run([MODULE, flag], capture_output=True, text=True)
    assert told.returncode == 0 and words in told.stdout and told.stderr == ""
