# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Displacement fields of a result: which are written, how, and what export makes of them."""
import json

import nibabel
import numpy
import pytest

from tests.cli.test_warp import BACKWARD, FORWARD, TRANSFORMS, smooth_image, warp, write_points
from tests.conftest import recover_arguments, run_palpate

MOST_BYTES_PER_VOXEL = 4.5  # of a displacement field; 12 as plain single precision


@pytest.fixture(scope="module")
def quick(phantom, tmp_path_factory):
    """Result folders by what --fields said; the default is "one"."""
    folder = tmp_path_factory.mktemp("fields")
    for choice in ("none", "one", "all"):
        more = [] if choice == "one" else ["--fields", choice]
        finished = run_palpate(*recover_arguments(phantom, folder / choice, *more))
        assert finished.returncode == 0, finished.stderr
    return folder


def test_a_result_holds_the_fields_that_were_chosen(quick):
    named = {choice: {p.name for p in (quick / choice).iterdir()} for choice in ("none", "one", "all")}
    assert named["one"] - named["none"] == {FORWARD, BACKWARD}
    assert named["all"] - named["one"] == set(TRANSFORMS.values())
    for choice, names in named.items():
        fields = json.loads((quick / choice / "result.json").read_text())["fields"]
        told = {name for field in fields for name in (field["displacement_field"], field["itk_transform"])}
        assert told - {None} == names & {FORWARD, BACKWARD, *TRANSFORMS.values()}
        assert [field["step_mm"] for field in fields] == [None if choice == "none" else 1 / 128] * 2
        assert [field["itk_transform_resamples"] is None for field in fields] == [choice != "all"] * 2
        page = (quick / choice / "report.html").read_text()
        assert {name for name in (FORWARD, BACKWARD, *TRANSFORMS.values()) if name in page} == told - {None}


def test_fields_are_whole_steps_and_their_headers_say_so(quick):
    for name in (FORWARD, BACKWARD):
        image = nibabel.load(quick / "one" / name)
        assert b"rounded to 1/128 mm" in image.header["descrip"].item()
        values = numpy.asarray(image.dataobj)
        assert values.dtype == numpy.float32
        numpy.testing.assert_array_equal(values * 128, numpy.rint(values * 128))


def test_a_default_result_is_all_that_warping_needs(quick, phantom, tmp_path):
    image = smooth_image(phantom / "reference.nii.gz", tmp_path / "image.nii.gz")
    for choice in ("one", "all"):
        warp("image", quick / choice, image, "--out", tmp_path / f"{choice}.nii.gz")
        warp("labels", quick / choice, phantom / "target.nii.gz", "--inverse", "--out",
             tmp_path / f"{choice}_labels.nii.gz")
        warp("grid", quick / choice, "--out", tmp_path / f"{choice}.vtp")
    assert nibabel.load(tmp_path / "one.nii.gz").get_fdata().std() > 100
    assert min((tmp_path / f"{choice}.vtp").stat().st_size for choice in ("one", "all")) > 1000


def test_all_fields_are_those_of_one(quick):
    for name in (FORWARD, BACKWARD):
        one, all_ = (nibabel.load(quick / choice / name) for choice in ("one", "all"))
        numpy.testing.assert_array_equal(numpy.asarray(one.dataobj), numpy.asarray(all_.dataobj))
        numpy.testing.assert_array_equal(one.affine, all_.affine)


def test_fields_keep_to_their_budget(quick):
    voxels = numpy.prod(nibabel.load(quick / "all" / FORWARD).shape[:3])
    for name in (FORWARD, BACKWARD, *TRANSFORMS.values()):
        assert (quick / "all" / name).stat().st_size < MOST_BYTES_PER_VOXEL * voxels, name


def test_export_tells_the_sense_of_folders_only_and_rounding_of_other_numbers_only(quick, tmp_path):
    def told(*arguments):
        finished = run_palpate("export", *arguments, "--overwrite")
        assert finished.returncode == 0, finished.stderr
        return finished.stdout.strip().split(" displacements in ")[1]
    out = ["--out", tmp_path / "out.h5"]
    assert told(quick / "one", *out) == "mm, LPS, reference to target"
    assert told(quick / "one", *out, "--inverse") == "mm, LPS, target to reference"
    assert told(quick / "one" / BACKWARD, *out) == "mm, LPS"
    field = nibabel.load(quick / "one" / FORWARD)
    other = nibabel.Nifti1Image(numpy.asarray(field.dataobj) + numpy.float32(0.001), field.affine, field.header)
    nibabel.save(other, tmp_path / "other.nii.gz")
    assert told(tmp_path / "other.nii.gz", *out) == "mm, LPS, rounded to 1/128 mm"


def test_export_takes_endings_in_any_case(quick, tmp_path):
    for name in ("THERE.H5", "AGAIN.NII.GZ"):
        finished = run_palpate("export", quick / "one", "--out", tmp_path / name)
        assert finished.returncode == 0, finished.stderr
    assert (tmp_path / "AGAIN.NII.GZ").read_bytes()[:2] == b"\x1f\x8b"
    finished = run_palpate("export", tmp_path / "THERE.H5", "--out", tmp_path / "again.nii.gz")
    assert finished.returncode == 0, finished.stderr


def test_export_of_a_field_replaces_nothing_unasked(quick, tmp_path):
    out = tmp_path / "there.h5"
    out.write_text("mine")
    finished = run_palpate("export", quick / "one", "--out", out)
    assert finished.returncode == 10 and "--overwrite" in finished.stderr
    assert out.read_text() == "mine"
    finished = run_palpate("export", quick / "one", "--out", out, "--overwrite")
    assert finished.returncode == 0 and out.stat().st_size > 1000, finished.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["there.h5"]


def test_a_field_has_no_walls(quick, tmp_path):
    finished = run_palpate("export", quick / "one", "--walls", "force", "--out", tmp_path / "there.h5")
    assert finished.returncode == 2 and not list(tmp_path.iterdir())
    assert "--walls" in finished.stderr and len(finished.stderr.splitlines()) == 1


def test_export_into_a_missing_folder_is_refused_in_one_sentence(quick, tmp_path):
    for name in ("there.h5", "there.nii.gz", "model.msh"):
        finished = run_palpate("export", quick / "one", "--out", tmp_path / "no" / name)
        assert finished.returncode == 10
        assert finished.stderr == (f"palpate: cannot write '{tmp_path}/no/{name}': there is no folder "
                                   f"'{tmp_path}/no'; make it first\n")


def test_export_gives_the_other_format_with_the_same_numbers(quick, tmp_path):
    for name, way, more in ((FORWARD, "there", []), (BACKWARD, "back", ["--inverse"])):
        transform, image = tmp_path / f"{way}.h5", tmp_path / f"{way}.nii.gz"
        for source, out in ((quick / "one", transform), (quick / "all", image)):
            finished = run_palpate("export", source, "--out", out, *more)
            assert finished.returncode == 0, finished.stderr
        finished = run_palpate("export", transform, "--out", tmp_path / f"{way}_again.nii.gz")
        assert finished.returncode == 0, finished.stderr
        written = numpy.asarray(nibabel.load(quick / "one" / name).dataobj)
        for other in (image, tmp_path / f"{way}_again.nii.gz"):
            again = nibabel.load(other)
            numpy.testing.assert_array_equal(numpy.asarray(again.dataobj), written)
            numpy.testing.assert_allclose(again.affine, nibabel.load(quick / "one" / name).affine, atol=1e-4)


def test_itk_reads_the_exported_transform_as_the_field_that_nibabel_reads(quick, tmp_path):
    sitk = pytest.importorskip("SimpleITK", reason="SimpleITK is not installed (PyPI: SimpleITK)")
    finished = run_palpate("export", quick / "one", "--out", tmp_path / "there.h5")
    assert finished.returncode == 0, finished.stderr
    transform = sitk.DisplacementFieldTransform(sitk.ReadTransform(str(tmp_path / "there.h5")))
    ours = sitk.GetArrayFromImage(transform.GetDisplacementField())
    theirs = sitk.GetArrayFromImage(sitk.ReadImage(str(quick / "one" / FORWARD)))
    nibabels = numpy.asarray(nibabel.load(quick / "one" / FORWARD).dataobj)[:, :, :, 0, :]
    numpy.testing.assert_array_equal(ours, theirs)
    numpy.testing.assert_array_equal(theirs, nibabels.transpose(2, 1, 0, 3))


def test_a_result_without_fields_says_what_to_do(quick, tmp_path):
    points = write_points(tmp_path / "points.csv", [[1, 2, 3]])
    for arguments in (["warp", "points", quick / "none", points, "--out", tmp_path / "o.csv"],
                      ["warp", "grid", quick / "none", "--out", tmp_path / "o.vtp"],
                      ["export", quick / "none", "--out", tmp_path / "o.h5"],
                      ["export", quick / "none", "--inverse", "--out", tmp_path / "o.nii.gz"]):
        finished = run_palpate(*arguments)
        assert finished.returncode == 3
        assert "without --fields none" in finished.stderr and len(finished.stderr.splitlines()) == 1
    finished = run_palpate("export", quick / "none", "--out", tmp_path / "model.msh")
    assert finished.returncode == 0, finished.stderr
    finished = run_palpate("export", quick / "one", "--inverse", "--out", tmp_path / "b.msh")
    assert finished.returncode == 2 and "--inverse" in finished.stderr
    assert {p.name for p in tmp_path.iterdir()} == {"points.csv", "model.msh"}
