# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Grey images under the outlines of the report: only if asked for, in the right place, and refused
with one sentence when they cannot be shown."""
import base64
import json
import re
import struct
import zlib

import nibabel
import numpy
import pytest

from tests import hard_images
from tests.conftest import recover_arguments, run_palpate
from tests.cli.test_errors import fails_cleanly, out  # noqa: F401, a fixture
from tests.cli.test_partial_targets import shapes, truth

BRIGHT = ("bladder", "rectum")


def label_of(phantom, organ):
    text = (phantom / "organs.toml").read_text()
    return int(re.search(rf'name = "{organ}"\s+label = (\d+)', text)[1])


def save(path, voxels, affine):
    image = nibabel.Nifti1Image(voxels, affine)
    image.header.set_xyzt_units("mm")
    nibabel.save(image, path)
    return path


def made_up_image(phantom, state, path):
    """Bladder and rectum bright in a grey slope, with every second voxel of the labels' grid along x;
    the target's on a left-handed grid."""
    labels = nibabel.load(phantom / f"{state}.nii.gz")
    voxels = numpy.asarray(labels.dataobj)[::2]
    slope = sum(numpy.indices(voxels.shape))
    affine = labels.affine @ numpy.diag([2, 1, 1, 1])
    bright = numpy.isin(voxels, [label_of(phantom, organ) for organ in BRIGHT])
    grey = (900 * bright + slope).astype(numpy.float32)
    if state == "target":
        affine[:, 3] += affine[:, 1] * (grey.shape[1] - 1)
        affine[:, 1] *= -1
        grey = grey[:, ::-1]
        assert numpy.linalg.det(affine) < 0
    return save(path, grey, affine)


@pytest.fixture(scope="module")
def images(phantom, tmp_path_factory):
    folder = tmp_path_factory.mktemp("images")
    return [made_up_image(phantom, state, folder / f"{state}_grey.nii.gz")
            for state in ("reference", "target")]


@pytest.fixture(scope="module")
def with_images(phantom, images, tmp_path_factory):
    folder = tmp_path_factory.mktemp("shown") / "out"
    finished = run_palpate(*recover_arguments(phantom, folder, "--reference-image", images[0],
                                               "--target-image", images[1]))
    assert finished.returncode == 0, finished.stderr
    return folder


def page_data(folder):
    page = (folder / "report.html").read_text()
    return json.loads(re.search(r'id="palpate-data">(.*?)</script>', page, re.S)[1])


def grey_pixels(png):
    """Rows of an 8-bit grey PNG file."""
    at, chunks = 8, []
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at:at + 8])
        chunks.append((kind, png[at + 8:at + 8 + length]))
        at += 12 + length
    width, height, *depth_and_colour = struct.unpack(">IIBB", dict(chunks)[b"IHDR"][:10])
    assert depth_and_colour == [8, 0]
    data = numpy.frombuffer(zlib.decompress(b"".join(d for k, d in chunks if k == b"IDAT")), numpy.uint8)
    data = data.reshape(height, width + 1).astype(int)
    rows = numpy.zeros((height + 1, width + 1), int)  # with a row and a column of zeros before
    for y, (kind, *line) in enumerate(data, 1):
        for x, value in enumerate(line, 1):
            left, up, corner = rows[y, x - 1], rows[y - 1, x], rows[y - 1, x - 1]
            nearest = min((abs(up - corner), 0, left), (abs(left - corner), 1, up),
                          (abs(left + up - 2 * corner), 2, corner))[2]
            rows[y, x] = (value + (0, left, up, (left + up) // 2, nearest)[kind]) & 255
    return rows[1:, 1:]


def volume_of(picture):
    """Grey values, [k, j, i]."""
    columns, rows, slices = picture["size"]
    pixels = grey_pixels(base64.b64decode(picture["png"]))
    tiles = picture["tiles_per_row"]
    return numpy.array([pixels[k // tiles * rows:][:rows, k % tiles * columns:][:, :columns]
                        for k in range(slices)])


def labels_of(volumes, layer):
    data, values, at = base64.b64decode(volumes[layer]), [], 0
    while at < len(data):
        value, length, shift = data[at], 0, 0
        at += 1
        while True:
            byte = data[at]
            length += (byte & 127) << shift
            shift, at = shift + 7, at + 1
            if byte < 128:
                break
        values.append(numpy.full(length, value))
    return numpy.concatenate(values).reshape(volumes["size"][::-1])


@pytest.mark.parametrize("which", ["reference", "target"])
def test_organs_are_bright_exactly_where_their_outlines_lie(which, with_images):
    data = page_data(with_images)
    volumes = data["volumes"]
    names = [organ["name"] for organ in volumes["organs"]]
    inside = numpy.isin(labels_of(volumes, which), [1 + names.index(organ) for organ in BRIGHT])
    grey = volume_of(data["pictures"][which])
    place = [((numpy.arange(n) + 0.5) / n * m).astype(int) for n, m in zip(inside.shape, grey.shape)]
    bright = grey[numpy.ix_(*place)] > 128
    assert 2 * (bright & inside).sum() / (bright.sum() + inside.sum()) > 0.93


def test_the_page_tells_what_is_seen_and_stays_small(with_images):
    page = (with_images / "report.html").read_text()
    assert "On the target image" in page and "On the reference image" in page
    assert len(page) < 4_500_000
    assert "reference_grey" not in page and "target_grey" not in page
    assert json.loads((with_images / "result.json").read_text())["warnings"] == []


def test_partial_targets_have_an_image_of_the_reference(phantom, images, tmp_path):
    finished = run_palpate(
        "recover", phantom / "reference.nii.gz", "--config", phantom / "organs.toml", "--out",
        tmp_path / "out", "--nodes", 2500, "--quiet", "--reference-image", images[0],
        *shapes("--target-surface", truth(phantom)))
    assert finished.returncode == 0, finished.stderr
    assert list(page_data(tmp_path / "out")["pictures"]) == ["reference"]


def test_an_image_that_shows_half_of_the_organs_is_told(phantom, images, tmp_path):
    image = nibabel.load(images[1])
    half = numpy.asarray(image.dataobj)[:, :, :image.shape[2] // 2]
    path = save(tmp_path / "half.nii.gz", half, image.affine)
    finished = run_palpate(*recover_arguments(phantom, tmp_path / "out", "--target-image", path))
    assert finished.returncode == 0, finished.stderr
    (warning,) = json.loads((tmp_path / "out" / "result.json").read_text())["warnings"]
    assert warning.startswith("Image of the target: It shows only ")


def test_an_image_that_shows_next_to_nothing_is_told_so(phantom, tmp_path):
    labels = nibabel.load(phantom / "target.nii.gz")
    is_organ = numpy.asarray(labels.dataobj) == label_of(phantom, "prostate")
    i, j, k = numpy.argwhere(is_organ)[0]
    affine = labels.affine.copy()
    affine[:3, 3] = (labels.affine @ [i - 1, j, k, 1])[:3]
    corner = save(tmp_path / "corner.nii.gz", numpy.arange(8, dtype=numpy.float32).reshape(2, 2, 2), affine)
    finished = run_palpate(*recover_arguments(phantom, tmp_path / "out", "--target-image", corner))
    assert finished.returncode == 0, finished.stderr
    (warning,) = json.loads((tmp_path / "out" / "result.json").read_text())["warnings"]
    assert warning == "Image of the target: It shows less than 1 % of the organs' voxels."


def moved(image, by, path):
    affine = image.affine.copy()
    affine[:3, 3] += by
    return save(path, numpy.asarray(image.dataobj), affine)


@pytest.mark.parametrize("option", ["--reference-image", "--target-image"])
def test_an_image_of_another_place_is_refused(option, phantom, images, tmp_path, out):  # noqa: F811
    elsewhere = moved(nibabel.load(images[0]), 400, tmp_path / "elsewhere.nii.gz")
    finished = run_palpate(*recover_arguments(phantom, out, option, elsewhere))
    fails_cleanly(finished, out, 4, "elsewhere.nii.gz", "no voxel of the organs",
                  option.split("-")[2] + "'s")


def test_a_missing_image_is_named(phantom, out):  # noqa: F811
    finished = run_palpate(*recover_arguments(phantom, out, "--target-image", "nowhere.nii.gz"))
    fails_cleanly(finished, out, 3, "nowhere.nii.gz", "no such file")


def test_there_is_an_image_for_each_target_or_for_none(phantom, images, out):  # noqa: F811
    twice = ["--target-image", images[0], "--target-image", images[1]]
    finished = run_palpate(*recover_arguments(phantom, out, *twice))
    fails_cleanly(finished, out, 2, "--target-image", "2 times for 1 target;")
    several = recover_arguments(phantom, out, "--target-image", images[1])
    several.insert(3, phantom / "target.nii.gz")
    fails_cleanly(run_palpate(*several), out, 2, "1 time for 2 targets;")


def test_a_target_image_is_one_file_and_what_follows_is_a_target(phantom, images, out):  # noqa: F811
    arguments = recover_arguments(phantom, out)
    arguments[1:3] = ["--target-image", images[1], *arguments[1:3]]
    arguments.append("nowhere.nii.gz")
    fails_cleanly(run_palpate(*arguments), out, 2, "1 time for 2 targets;")
    arguments += ["--target-image", images[1]]
    fails_cleanly(run_palpate(*arguments), out, 3, "nowhere.nii.gz", "no such file")


@pytest.mark.parametrize("option", ["--reference-image", "--target-image"])
def test_an_empty_name_is_refused(option, phantom, out):  # noqa: F811
    finished = run_palpate(*recover_arguments(phantom, out, option, ""))
    fails_cleanly(finished, out, 3, f"{option} names no file")


def test_each_of_several_targets_shows_its_own_image(phantom, images, tmp_path):
    dark = nibabel.load(images[1])
    dark = save(tmp_path / "dark.nii.gz", numpy.full(dark.shape, 7, numpy.float32), dark.affine)
    arguments = recover_arguments(phantom, tmp_path / "out", "--target-image", images[1],
                                  "--target-image", dark)
    arguments.insert(3, phantom / "target.nii.gz")
    finished = run_palpate(*arguments)
    assert finished.returncode == 0, finished.stderr
    folders = [tmp_path / "out" / f"target-{k}" for k in (1, 2)]
    assert [volume_of(page_data(folder)["pictures"]["target"]).max() > 0 for folder in folders] == [True, False]
    warnings = [json.loads((folder / "result.json").read_text())["warnings"] for folder in folders]
    assert warnings == [[], ["Image of the target: Every voxel of it is 7, so it is black in the report."]]


def test_a_partial_target_has_no_image(phantom, images, out):  # noqa: F811
    finished = run_palpate("recover", phantom / "reference.nii.gz", "--config",
                           phantom / "organs.toml", "--out", out, "--quiet", "--target-image",
                           images[1], *shapes("--target-surface", truth(phantom)))
    fails_cleanly(finished, out, 2, "--target-image", "--reference-image")


@pytest.mark.parametrize("name, data, word", [
    ("series.nrrd", hard_images.nrrd(hard_images.labels() * 2, [
        ("dimension", 4), ("sizes", "12 12 12 2"), ("kinds", "domain domain domain list"),
        ("space directions", "(1,0,0) (0,1,0) (0,0,1) none")]), "dimensions"),
    ("series.mha", hard_images.meta(hard_images.labels() * 2,
                                    [("NDims", 4), ("DimSize", "12 12 12 2")]), "dimensions"),
    ("colour.mha", hard_images.meta(hard_images.labels() * 3, [("ElementNumberOfChannels", 3)]),
     "several numbers"),
    ("hole.nii", hard_images.nifti(struct.pack("<1728f", *[1.0] * 1727, float("nan")), datatype=16,
                                   bitpix=32), "its number 1727 is not a finite number"),
    ("hole.mha", hard_images.meta(struct.pack("<1728f", *[1.0] * 1727, float("nan")),
                                  [("ElementType", "MET_FLOAT")]),
     "its number 1727 is not a finite number"),
    ("large.nii", hard_images.nifti(struct.pack("<1728d", *[1e300] * 1728), datatype=64, bitpix=64),
     "its number 0 is not a finite number, or too large"),
], ids=lambda value: value if isinstance(value, str) else "")
def test_an_image_that_is_no_grey_volume_is_refused(name, data, word, phantom, tmp_path, out):  # noqa: F811
    path = tmp_path / name
    path.write_bytes(data)
    finished = run_palpate(*recover_arguments(phantom, out, "--reference-image", path))
    fails_cleanly(finished, out, 4, name, word)
