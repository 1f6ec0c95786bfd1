# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""palpate warp: images, labels, points and grids carried both ways, as nibabel, VTK and SimpleITK
read the same files."""
import csv
import json

import nibabel
import numpy
import pytest

from tests.conftest import recover_arguments, run_palpate

FORWARD, BACKWARD = "displacement.nii.gz", "displacement_inverse.nii.gz"
TRANSFORMS = {"there": "from-target_to-reference_mode-image_xfm.h5",  # points: reference to target
              "back": "from-reference_to-target_mode-image_xfm.h5"}
SAME_MM = 1e-3  # what is promised between palpate and ITK


def turned(places, angle=0.35):
    """LPS points turned about an oblique axis and shifted: where the tilted scanner sees them."""
    axis = numpy.array([1.0, 2.0, -3.0]) / numpy.sqrt(14)
    cross = numpy.cross(numpy.eye(3), axis).T
    rotation = numpy.eye(3) + numpy.sin(angle) * cross + (1 - numpy.cos(angle)) * cross @ cross
    return places @ rotation.T + [17.0, -23.0, 41.0]


def tilted(volume, out):
    """The same voxels in a tilted frame with another origin."""
    image = nibabel.load(volume)
    flip = numpy.diag([-1.0, -1.0, 1.0, 1.0])
    lps = flip @ image.affine
    frame = numpy.eye(4)
    frame[:3, 3] = turned(numpy.zeros((1, 3)))[0]
    frame[:3, :3] = (turned(numpy.eye(3)) - frame[:3, 3]).T
    moved = nibabel.Nifti1Image(numpy.asarray(image.dataobj).astype(numpy.uint8), flip @ frame @ lps)
    moved.header.set_xyzt_units("mm")
    nibabel.save(moved, out)
    return out


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """A recovery of a phantom with thick slices in a tilted frame; its target is cropped, so that the
    two grids differ."""
    folder = tmp_path_factory.mktemp("warp")
    made = run_palpate("phantom", "pelvis", "--seed", 3, "--stiffness-kpa", 60, "--spacing", 2, 2.2,
                       3, "--nodes", 6000, "--out", folder / "phantom", "--quiet")
    assert made.returncode == 0, made.stderr
    reference = tilted(folder / "phantom/reference.nii.gz", folder / "reference.nii.gz")
    target = tilted(folder / "phantom/target.nii.gz", folder / "target_full.nii.gz")
    full = nibabel.load(target)
    cropped = full.slicer[2:-1, 1:-2, 1:]
    nibabel.save(cropped, folder / "target.nii.gz")
    out = folder / "out"
    finished = run_palpate(*recover_arguments(folder / "phantom", out, reference=reference,
                                              target=folder / "target.nii.gz"),
                           "--fields", "all")
    assert finished.returncode == 0, finished.stderr
    return folder


def warp(*arguments, code=0):
    finished = run_palpate("warp", *arguments)
    assert finished.returncode == code, finished.stderr + finished.stdout
    return finished


def field_of(scene, name):
    image = nibabel.load(scene / "out" / name)
    return image.affine, numpy.asarray(image.dataobj)[:, :, :, 0, :]


def points_inside(scene, name, count=1000, seed=4):
    """LPS points spread over the grid of a field."""
    affine, field = field_of(scene, name)
    index = numpy.random.default_rng(seed).uniform(0, 1, (count, 3)) * (numpy.array(field.shape[:3]) - 1)
    return nibabel.affines.apply_affine(affine, index) * [-1, -1, 1]


def write_points(path, points, header="x,y,z"):
    numpy.savetxt(path, points, delimiter=",", header=header, comments="", fmt="%.9f")
    return path


def read_points(path):
    rows = list(csv.DictReader(path.open()))
    return (numpy.array([[float(row[c]) for c in "xyz"] for row in rows]),
            numpy.array([int(row["inside"]) for row in rows]))


def warped_points(scene, tmp_path, points, *more):
    source = write_points(tmp_path / "points.csv", points)
    warp("points", scene / "out", source, "--out", tmp_path / "moved.csv", "--overwrite", *more)
    return read_points(tmp_path / "moved.csv")


def test_nibabel_sees_each_field_on_its_grid(scene):
    for name, grid in ((FORWARD, "reference.nii.gz"), (BACKWARD, "target.nii.gz")):
        affine, field = field_of(scene, name)
        image = nibabel.load(scene / grid)
        assert field.shape[:3] == image.shape
        assert numpy.abs(affine - image.affine).max() <= 1e-6 * numpy.abs(image.affine).max()
        assert nibabel.load(scene / "out" / name).header["intent_code"] == 1007


def test_the_json_says_which_field_is_which(scene):
    fields = json.loads((scene / "out/result.json").read_text())["fields"]
    assert [(f["points_from"], f["displacement_field"], f["itk_transform"]) for f in fields] == [
        ("reference", FORWARD, TRANSFORMS["there"]), ("target", BACKWARD, TRANSFORMS["back"])]
    for field in fields:
        assert (scene / "out" / field["itk_transform"]).stat().st_size > 1000


def test_points_go_there_and_come_back(scene, tmp_path):
    start = points_inside(scene, BACKWARD)
    back, inside_back = warped_points(scene, tmp_path, start, "--inverse")
    there, inside = warped_points(scene, tmp_path, back)
    both = (inside == 1) & (inside_back == 1)
    error = numpy.linalg.norm(there - start, axis=1)[both]
    moved = numpy.linalg.norm(back - start, axis=1)[both]
    print(f"inverse consistency: mean {error.mean():.4f} mm, 99 % {numpy.quantile(error, 0.99):.3f}, "
          f"largest {error.max():.3f}; moved {moved.mean():.2f}, {moved.max():.1f}")
    assert both.mean() > 0.9 and moved.max() > 3
    assert error.mean() < 0.02 and numpy.quantile(error, 0.99) < 0.2 and error.max() < 1.0


def test_the_landmarks_of_the_phantom_arrive_in_ras_as_in_lps(scene, tmp_path):
    rows = numpy.loadtxt(scene / "phantom/landmarks.csv", delimiter=",", skiprows=1)
    start, end = turned(rows[:, :3]), turned(rows[:, :3] + rows[:, 3:6])
    there, inside = warped_points(scene, tmp_path, start)
    ras, _ = warped_points(scene, tmp_path, start * [-1, -1, 1], "--ras")
    assert inside.all()
    assert numpy.linalg.norm(there - end, axis=1).mean() < 0.7 < numpy.linalg.norm(end - start, axis=1).mean()
    numpy.testing.assert_allclose(ras * [-1, -1, 1], there, atol=2e-6)


def test_points_outside_are_marked_and_told(scene, tmp_path):
    far = points_inside(scene, FORWARD, 3)
    far[1] += [500, 0, 0]
    source = write_points(tmp_path / "far.csv", far)
    finished = warp("points", scene / "out", source, "--out", tmp_path / "moved.csv")
    assert "1 of 3 points lie outside" in finished.stdout
    assert list(read_points(tmp_path / "moved.csv")[1]) == [1, 0, 1]


def test_the_labels_of_the_reference_become_the_warped_labels(scene, tmp_path):
    warp("labels", scene / "out", scene / "reference.nii.gz", "--out", tmp_path / "labels.nii.gz")
    ours = nibabel.load(tmp_path / "labels.nii.gz")
    theirs = nibabel.load(scene / "out/warped_labels.nii.gz")
    numpy.testing.assert_allclose(ours.affine, theirs.affine, atol=1e-4)
    a, b = numpy.asarray(ours.dataobj), numpy.asarray(theirs.dataobj)
    assert numpy.mean(a != b) < 2e-3  # the image's end, and labels that the settings do not name


def test_labels_come_back_to_the_reference(scene, tmp_path):
    warp("labels", scene / "out", scene / "target.nii.gz", "--inverse", "--interpolation", "nearest",
         "--out", tmp_path / "back.nrrd")
    warp("labels", scene / "out", scene / "target.nii.gz", "--inverse", "--out", tmp_path / "back.nii.gz")
    back = numpy.asarray(nibabel.load(tmp_path / "back.nii.gz").dataobj)
    reference = numpy.asarray(nibabel.load(scene / "reference.nii.gz").dataobj)
    assert back.shape == reference.shape
    for label in (1, 2, 3):
        both = numpy.sum((back == label) & (reference == label))
        assert 2 * both / (numpy.sum(back == label) + numpy.sum(reference == label)) > 0.93


def smooth_image(like, out, kind=numpy.int16):
    """A scalar image without symmetry on the grid of another, in whole numbers."""
    image = nibabel.load(like)
    i, j, k = numpy.indices(image.shape)
    values = 900 + 300 * numpy.sin(i / 7 + k / 5) + 200 * numpy.cos(j / 6) + 11 * i - 7 * k
    nibabel.save(nibabel.Nifti1Image(values.astype(kind), image.affine), out)
    return out


def test_only_the_grid_of_a_volume_to_be_like_counts(scene, tmp_path):
    image = smooth_image(scene / "reference.nii.gz", tmp_path / "image.nii.gz")
    like = nibabel.load(scene / "target.nii.gz")
    nothing = numpy.full(like.shape, numpy.nan, numpy.float32)
    odd = nibabel.Nifti1Image(nothing, like.affine)
    odd.set_qform(numpy.diag([1, 1, 1.1, 1]) @ like.affine, code=1)  # not its sform
    nibabel.save(odd, tmp_path / "like.nii.gz")
    finished = warp("image", scene / "out", image, "--like", tmp_path / "like.nii.gz", "--out",
                    tmp_path / "warped.nii.gz")
    assert nibabel.load(tmp_path / "warped.nii.gz").shape == like.shape
    assert "like.nii.gz: " in finished.stderr and "sform" in finished.stderr


def test_an_image_on_a_given_grid_is_sampled_where_its_points_come_from(scene, tmp_path):
    image = smooth_image(scene / "reference.nii.gz", tmp_path / "image.nii.gz")
    finished = warp("image", scene / "out", image, "--like", scene / "target_full.nii.gz", "--fill", -5,
                    "--interpolation", "cubic", "--out", tmp_path / "warped.nii.gz")
    warped = nibabel.load(tmp_path / "warped.nii.gz")
    full = nibabel.load(scene / "target_full.nii.gz")
    numpy.testing.assert_allclose(warped.affine, full.affine, atol=1e-4)
    assert warped.get_data_dtype() == numpy.float32
    assert "outside the displacement field" in finished.stdout
    at = numpy.array(numpy.unravel_index(
        numpy.random.default_rng(1).integers(0, numpy.prod(full.shape), 400), full.shape)).T
    places = nibabel.affines.apply_affine(full.affine, at) * [-1, -1, 1]
    back, _ = warped_points(scene, tmp_path, places, "--inverse")
    index = nibabel.affines.apply_affine(numpy.linalg.inv(nibabel.load(image).affine),
                                         back * [-1, -1, 1])
    i, j, k = index.T
    expected = 900 + 300 * numpy.sin(i / 7 + k / 5) + 200 * numpy.cos(j / 6) + 11 * i - 7 * k
    values = numpy.asarray(warped.dataobj)[tuple(at.T)]
    inner = numpy.all((index > 2) & (index < numpy.array(full.shape) - 3), axis=1)
    assert inner.sum() > 200
    assert numpy.abs(values - expected)[inner].max() < 3  # whole numbers and a spline
    beyond = numpy.any((index < -0.6) | (index > numpy.array(full.shape) - 0.4), axis=1)
    assert numpy.all(values[beyond] == -5)


def test_the_grid_opens_in_vtk(scene, tmp_path):
    vtk = pytest.importorskip("vtk", reason="VTK's Python package (Debian: python3-vtk9)")
    from vtk.util.numpy_support import vtk_to_numpy
    warp("grid", scene / "out", "--every-mm", 15, "--out", tmp_path / "grid.vtp")
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(tmp_path / "grid.vtp"))
    reader.Update()
    data = reader.GetOutput()
    assert data.GetNumberOfLines() > 30
    assert data.GetFieldData().GetAbstractArray("SPACE").GetValue(0) == "LPS"
    end = vtk_to_numpy(data.GetPoints().GetData())[::17]
    start = end - vtk_to_numpy(data.GetPointData().GetArray("displacement"))[::17]
    there, _ = warped_points(scene, tmp_path, start)
    numpy.testing.assert_allclose(there, end, atol=1e-5)


def test_simpleitk_moves_the_same_points(scene, tmp_path):
    sitk = pytest.importorskip("SimpleITK", reason="SimpleITK is not installed (PyPI: SimpleITK)")
    for name, transform, more in ((FORWARD, "there", []), (BACKWARD, "back", ["--inverse"])):
        points = points_inside(scene, name)
        ours, inside = warped_points(scene, tmp_path, points, *more)
        theirs = sitk.ReadTransform(str(scene / "out" / TRANSFORMS[transform]))
        moved = numpy.array([theirs.TransformPoint(p) for p in points.tolist()])
        error = numpy.linalg.norm(ours - moved, axis=1)
        print(f"{transform}: largest difference {error.max():.1e} mm of {len(points)} points")
        assert inside.all() and error.max() <= SAME_MM
        assert numpy.linalg.norm(ours - points, axis=1).max() > 3


def test_simpleitk_resamples_the_same_image(scene, tmp_path):
    sitk = pytest.importorskip("SimpleITK", reason="SimpleITK is not installed (PyPI: SimpleITK)")
    for source, grid, transform, more in (
            ("reference.nii.gz", "target.nii.gz", "back", []),
            ("target.nii.gz", "reference.nii.gz", "there", ["--inverse"])):
        image = smooth_image(scene / source, tmp_path / "image.nii.gz", numpy.float32)
        warp("image", scene / "out", image, *more, "--out", tmp_path / "warped.nii.gz", "--overwrite")
        ours = sitk.ReadImage(str(tmp_path / "warped.nii.gz"))
        theirs = sitk.Resample(sitk.ReadImage(str(image), sitk.sitkFloat32),
                               sitk.ReadImage(str(scene / grid)),
                               sitk.ReadTransform(str(scene / "out" / TRANSFORMS[transform])),
                               sitk.sitkLinear, 0.0, sitk.sitkFloat32)
        a, b = sitk.GetArrayFromImage(ours), sitk.GetArrayFromImage(theirs)
        assert a.shape == b.shape
        differ = numpy.abs(a - b) > 0.05  # of 1400, by 1e-3 mm in gradients of some 40 a voxel
        assert differ.mean() < 1e-3  # points within rounding of the input's end
        assert numpy.abs(a).mean() > 500


def test_a_transform_file_stands_for_a_result(scene, tmp_path):
    points = points_inside(scene, FORWARD, 50)
    source = write_points(tmp_path / "points.csv", points)
    warp("points", scene / "out" / TRANSFORMS["there"], source, "--out", tmp_path / "a.csv")
    warp("points", scene / "out" / FORWARD, source, "--out", tmp_path / "b.csv")
    ours, _ = warped_points(scene, tmp_path, points)
    for name in "ab":
        numpy.testing.assert_allclose(read_points(tmp_path / f"{name}.csv")[0], ours, atol=SAME_MM)


def altered_field(scene, out, shape=None, intent=1007):
    image = nibabel.load(scene / "out" / FORWARD)
    values = numpy.asarray(image.dataobj)
    changed = nibabel.Nifti1Image(values if shape is None else values.reshape(shape), image.affine)
    changed.header.set_intent(intent)
    changed.header.set_xyzt_units("mm")
    nibabel.save(changed, out)
    return out


def test_what_cannot_be_used_is_refused_in_a_sentence(scene, tmp_path):
    points = write_points(tmp_path / "points.csv", [[1, 2, 3]])
    shape = nibabel.load(scene / "out" / FORWARD).shape
    flat = altered_field(scene, tmp_path / "flat.nii.gz", (*shape[:3], 3))
    dispvect = altered_field(scene, tmp_path / "dispvect.nii.gz", intent=1006)
    series = tmp_path / "series.nii.gz"
    nibabel.save(nibabel.Nifti1Image(numpy.zeros((5, 5, 5, 4), numpy.float32), numpy.eye(4)), series)
    bad = write_points(tmp_path / "bad.csv", [[1, 2, numpy.nan]])
    out = ["--out", tmp_path / "out.csv"]
    for arguments, code, words in (
            (["points", flat, points, *out], 4, "five dimensions"),
            (["points", dispvect, points, *out], 4, "1006"),
            (["points", tmp_path, points, *out], 3, "displacement.nii.gz"),
            (["points", tmp_path / "absent.h5", points, *out], 3, "no such file"),
            (["points", scene / "out", bad, *out], 4, "line 2"),
            (["image", scene / "out", series, "--out", tmp_path / "o.nii.gz"], 4, "4 dimensions"),
            (["image", scene / "out", dispvect, "--out", tmp_path / "o.nii.gz"], 4, "1006"),
            (["image", scene / "out", scene / "target.nii.gz", "--out", tmp_path / "o.png"], 2, ".nii"),
            (["grid", scene / "out", "--out", tmp_path / "o.vtk"], 2, ".vtp"),
            (["points", scene / "out", points, "--out", points], 10, "--overwrite")):
        finished = warp(*arguments, code=code)
        assert words in finished.stderr and len(finished.stderr.splitlines()) == 1, finished.stderr
    assert points.read_text().startswith("x,y,z\n1.0")
    assert not [p for p in tmp_path.iterdir() if p.name.startswith((".", "o.", "out."))]
