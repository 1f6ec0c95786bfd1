# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""The main job through the command line, on a small phantom: what it writes and that both back ends
and both meshers agree."""
import json

import nibabel
import numpy
import pytest

from tests.conftest import recover_arguments, run_palpate
from tests.vtu import read_arrays


def recovered(phantom, out, *more):
    finished = run_palpate(*recover_arguments(phantom, out, *more))
    assert finished.returncode == 0, finished.stderr
    return json.loads((out / "result.json").read_text())


def prostate(report):
    return next(region for region in report["regions"] if region["name"] == "prostate")


@pytest.fixture(scope="module")
def result(phantom, tmp_path_factory):
    out = tmp_path_factory.mktemp("recover") / "out"
    return out, recovered(phantom, out)


def test_every_file_is_there(result):
    out, _ = result
    names = {entry.name for entry in out.iterdir()}
    assert {"result.json", "mesh.vtu", "displacement.nii.gz", "warped_labels.nii.gz",
            "report.html", "displacement_inverse.nii.gz", "convergence.csv"} == names


def test_the_json_holds_what_programs_need(result):
    _, report = result
    for key in ("name", "label", "role", "stiffness_kpa", "interval_kpa", "verdict"):
        assert key in prostate(report)
    for key in ("name", "dice_before", "dice_after", "mean_distance_mm_before",
                "mean_distance_mm_after", "max_distance_mm_after", "hausdorff95_mm_before"):
        assert key in report["surfaces"][0]
    assert report["termination"]["converged"] is True
    assert report["mesh"]["nodes"] > 1000 and report["mesh"]["elements"] > 4000
    assert report["timings_s"]["total"] > 0
    assert report["device"] and report["settings"] and report["version"]


def test_the_surfaces_come_closer(result):
    _, report = result
    for surface in report["surfaces"]:
        assert surface["mean_distance_mm_after"] < 0.3 * surface["mean_distance_mm_before"]
        assert surface["dice_after"] > surface["dice_before"]
        assert surface["hausdorff95_mm_after"] < 0.5 * surface["hausdorff95_mm_before"]
        assert surface["mean_distance_mm_before"] < surface["hausdorff95_mm_before"]


def test_landmarks_are_told_before_and_after(phantom, tmp_path):
    rows = numpy.loadtxt(phantom / "landmarks.csv", delimiter=",", skiprows=1)[:50]
    files = [tmp_path / "reference.csv", tmp_path / "target.csv"]
    for file, points in zip(files, (rows[:, :3], rows[:, :3] + rows[:, 3:])):
        numpy.savetxt(file, points, delimiter=",", header="x,y,z", comments="")
    report = recovered(phantom, tmp_path / "out", "--landmarks", *files)
    errors = report["landmarks"]
    assert len(errors) == 50 and all(landmark["inside"] for landmark in errors)
    before, after = (numpy.mean([landmark[f"error_mm_{when}"] for landmark in errors])
                     for when in ("before", "after"))
    assert before > 2 and after < 0.25 * before
    assert any(sentence.startswith("50 landmarks") for sentence in report["summary"])


def test_strain_energy_is_half_the_work_of_the_forces(result):
    out, report = result
    mesh = read_arrays(out / "mesh.vtu")
    work_mj = 0.5 * (mesh["force"] * mesh["displacement"]).sum() / 1000
    meshed = [region for region in report["regions"] if not region["hollow"]]
    assert sum(r["strain_energy_mj"] for r in meshed) == pytest.approx(work_mj, rel=1e-3)
    for region in meshed:
        low, high = region["jacobian_range"]
        # Linear elasticity may turn an element of the thin tissue between two organs inside out.
        assert -0.5 < low < 1 < high < 3


def test_the_published_method_comes_close_without_an_interval(phantom, tmp_path):
    out = tmp_path / "out"
    finished = run_palpate(*recover_arguments(phantom, out, "--method", "nested-lbfgs",
                                               "--search-time", 15))
    assert finished.returncode in (0, 7), finished.stderr  # 7: time, or noise in its line search
    report = json.loads((out / "result.json").read_text())
    found = prostate(report)
    assert found["verdict"] == "not judged" and "nested-lbfgs" in found["reason"]
    assert found["interval_kpa"] == [None, None]
    for surface in report["surfaces"]:
        assert surface["mean_distance_mm_after"] < 0.3 * surface["mean_distance_mm_before"]


def test_the_displacement_is_a_vector_image_on_the_reference_grid(phantom, result):
    out, _ = result
    reference = nibabel.load(phantom / "reference.nii.gz")
    field = nibabel.load(out / "displacement.nii.gz")
    assert field.header["intent_code"] == 1007
    assert field.shape == (*reference.shape, 1, 3)
    numpy.testing.assert_allclose(field.affine, reference.affine, atol=1e-4)


def test_the_displacement_follows_the_landmarks(phantom, result):
    out, _ = result
    rows = numpy.loadtxt(phantom / "landmarks.csv", delimiter=",", skiprows=1)
    field = nibabel.load(out / "displacement.nii.gz")
    values = numpy.asarray(field.dataobj)[:, :, :, 0, :]
    index = nibabel.affines.apply_affine(numpy.linalg.inv(field.affine), rows[:, :3] * [-1, -1, 1])
    at = numpy.rint(index).astype(int)
    error = numpy.linalg.norm(values[at[:, 0], at[:, 1], at[:, 2]] - rows[:, 3:6], axis=1)
    moved = numpy.linalg.norm(rows[:, 3:6], axis=1)
    assert error.mean() < 0.5 < moved.mean()


def test_the_host_back_end_gives_the_same_modulus(phantom, result, tmp_path):
    _, report = result
    host = recovered(phantom, tmp_path / "out", "--backend", "reference")
    assert host["device"]["backend"] == "reference"
    assert prostate(host)["stiffness_kpa"] == pytest.approx(prostate(report)["stiffness_kpa"],
                                                            rel=1e-2)


def test_the_result_says_who_solved_and_why(result):
    out, report = result
    stages = report["linear_solver"]
    assert set(stages) == {"condensing", "solving"}
    assert stages["condensing"]["method"] == "direct"  # hundreds of columns for one factor
    assert stages["condensing"]["device"] == "host" and stages["condensing"]["library"]
    assert "columns" in stages["condensing"]["reason"]
    for stage in stages.values():
        assert stage["method"] in ("multigrid", "jacobi", "direct")
    assert stages["condensing"]["library"] in (out / "report.html").read_text()


@pytest.mark.parametrize("method", ["jacobi", "direct"])
def test_every_linear_solver_gives_the_same_modulus(phantom, result, tmp_path, method):
    _, report = result
    again = recovered(phantom, tmp_path / "out", "--linear-solver", method)
    assert {stage["method"] for stage in again["linear_solver"].values()} == {method}
    assert again["linear_solver"]["condensing"]["reason"].startswith("asked for")
    assert prostate(again)["stiffness_kpa"] == pytest.approx(prostate(report)["stiffness_kpa"],
                                                             rel=1e-2)


def test_a_ready_mesh_gives_the_same_modulus(phantom, result, tmp_path):
    out, report = result
    again = recovered(phantom, tmp_path / "out", "--mesh", out / "mesh.vtu")
    assert again["mesh"]["nodes"] == report["mesh"]["nodes"]
    assert prostate(again)["stiffness_kpa"] == pytest.approx(prostate(report)["stiffness_kpa"],
                                                             rel=2e-2)


def test_quadratic_elements_do_the_same(result, phantom, tmp_path):
    _, linear = result
    report = recovered(phantom, tmp_path / "out", "--element", "tet10")
    mesh = read_arrays(tmp_path / "out" / "mesh.vtu")
    assert (linear["mesh"]["element_type"], report["mesh"]["element_type"]) == ("tet4", "tet10")
    assert set(mesh["types"]) == {24}  # VTK_QUADRATIC_TETRA
    assert len(mesh["connectivity"]) == 10 * report["mesh"]["elements"]
    assert 0.6 < report["mesh"]["nodes"] / linear["mesh"]["nodes"] < 2
    for stage in ("condensing", "solving"):
        assert "tet10 elements: factorised on the host" in report["linear_solver"][stage]["reason"]
    truth, estimate = 60, prostate(report)["stiffness_kpa"]
    assert abs(numpy.log(estimate / truth)) < 0.5
    work_mj = 0.5 * (mesh["force"] * mesh["displacement"]).sum() / 1000
    energy_mj = sum(r["strain_energy_mj"] for r in report["regions"] if not r["hollow"])
    assert energy_mj == pytest.approx(work_mj, rel=1e-3)


def test_a_ready_mesh_of_quadratic_elements_is_taken_as_it_is(phantom, tmp_path):
    first = recovered(phantom, tmp_path / "first", "--element", "tet10")
    again = recovered(phantom, tmp_path / "again", "--mesh", tmp_path / "first" / "mesh.vtu")
    assert again["mesh"]["element_type"] == "tet10"
    assert again["mesh"]["elements"] == first["mesh"]["elements"]
    # Nodes come in another order, and closest points have kinks; the interval spans a factor of 2.
    assert prostate(again)["stiffness_kpa"] == pytest.approx(prostate(first)["stiffness_kpa"], rel=0.05)
