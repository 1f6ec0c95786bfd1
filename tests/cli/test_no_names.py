# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Names of patients that input files carry do not come out again: not in results, saved models,
temporary files or error sentences. The names of the files themselves appear on the terminal only."""
import base64
import binascii
import gzip
import re
import shutil
import zlib

import nibabel
import numpy
import pytest

from tests import hard_images
from tests.conftest import recover_arguments, run_palpate

NAMES = [f"Canary{k:02d}^Doe" for k in range(20)]
FILE_NAMES = NAMES[15:]  # these are in names of files, the others inside them
ERROR_WITH_NAMES = 3


def nifti_with_names(source, path):
    image = nibabel.load(source)
    volume = nibabel.Nifti1Image(numpy.asarray(image.dataobj), image.affine)
    volume.header.set_xyzt_units("mm")
    for field, name in zip(("descrip", "aux_file", "db_name", "intent_name"), NAMES):
        volume.header[field] = name.encode()
    for code, name in ((2, NAMES[4]), (4, NAMES[5]), (6, NAMES[6]), (0, NAMES[7])):
        volume.header.extensions.append(nibabel.nifti1.Nifti1Extension(code, name.encode()))
    nibabel.save(volume, path)


def array_and_grid(source):
    """The voxels, i fastest, and the LPS grid of a NIfTI file."""
    image = nibabel.load(source)
    affine = numpy.diag([-1, -1, 1, 1]) @ image.affine
    return numpy.asarray(image.dataobj).astype(numpy.uint8).tobytes(order="F"), image.shape, affine


def nrrd_with_names(source, path):
    voxels, shape, affine = array_and_grid(source)
    vector = lambda v: "(" + ",".join(repr(float(x)) for x in v) + ")"
    path.write_bytes(hard_images.nrrd(voxels, [
        ("sizes", " ".join(map(str, shape))),
        ("space directions", " ".join(vector(affine[:3, k]) for k in range(3))),
        ("space origin", vector(affine[:3, 3])), ("content", NAMES[8]), ("# scanned", NAMES[9]),
        (f"DICOM_0010_0010:={NAMES[10]}\nDICOM_0010_0020:={NAMES[11]}\nold min", 0)]))


def meta_with_names(source, path):
    voxels, shape, affine = array_and_grid(source)
    spacing = numpy.linalg.norm(affine[:3, :3], axis=0)
    numbers = lambda values: " ".join(repr(float(v)) for v in values)
    path.write_bytes(hard_images.meta(voxels, [
        ("DimSize", " ".join(map(str, shape))), ("ElementSpacing", numbers(spacing)),
        ("TransformMatrix", numbers((affine[:3, :3] / spacing).T.ravel())),
        ("Offset", numbers(affine[:3, 3])), ("PatientName", NAMES[12]), ("Comment", NAMES[13]),
        ("0010|0010", NAMES[14])]))


def unpacked(data):
    """The bytes, and all that can be inflated or decoded from them."""
    yield data
    if data[:2] == b"\x1f\x8b":
        yield gzip.decompress(data)
    for mark in re.finditer(rb"\x78[\x01\x5e\x9c\xda]", data):
        try:
            yield zlib.decompressobj().decompress(data[mark.start():], 1 << 24)
        except zlib.error:
            pass
    for text in re.findall(rb"[A-Za-z0-9+/]{24,}={0,2}", data):
        try:
            decoded = base64.b64decode(text[:len(text) // 4 * 4])
        except binascii.Error:
            continue
        yield decoded
        for mark in re.finditer(rb"\x78[\x01\x5e\x9c\xda]|\x1f\x8b\x08", decoded[:64]):
            try:
                yield zlib.decompressobj(47).decompress(decoded[mark.start():], 1 << 24)
            except zlib.error:
                pass


def names_in(data, names):
    found = set()
    for part in unpacked(data):
        found.update(name for name in names if name.split("^")[0].encode() in part)
    return found


@pytest.fixture(scope="module")
def files(phantom, tmp_path_factory):
    folder = tmp_path_factory.mktemp("named")
    reference = folder / f"{FILE_NAMES[0]}.nii.gz"
    nrrd, meta = folder / f"{FILE_NAMES[1]}.nrrd", folder / f"{FILE_NAMES[2]}.mha"
    nifti_with_names(phantom / "reference.nii.gz", reference)
    nrrd_with_names(phantom / "target.nii.gz", nrrd)
    meta_with_names(phantom / "target.nii.gz", meta)
    config = folder / f"{FILE_NAMES[3]}.toml"
    shutil.copy(phantom / "organs.toml", config)
    return reference, nrrd, meta, config


def test_the_names_are_in_the_input(files):
    found = [names_in(path.read_bytes(), NAMES[:15]) for path in files[:3]]
    assert set.union(*found) == set(NAMES[:15])


def test_no_name_comes_out_again(files, phantom, tmp_path):
    reference, nrrd, meta, config = files
    temporary, work = tmp_path / "temporary", tmp_path / "work"
    temporary.mkdir()
    work.mkdir()
    arguments = recover_arguments(phantom, work / "out", "--save-reduced", work / "saved.reduced",
                                  reference=reference, target=nrrd, config=config)
    arguments.insert(3, meta)
    arguments.remove("--quiet")
    arguments += ["--reference-image", reference, "--target-image", meta, "--target-image", nrrd]  # shown as they are

    finished = run_palpate(*arguments, environment={"TMPDIR": str(temporary)})

    assert finished.returncode in (0, 7), finished.stderr
    assert names_in((finished.stdout + finished.stderr).encode(), NAMES[:15]) == set()
    assert names_in(finished.stdout.encode(), NAMES) == set()
    outputs = [path for path in work.rglob("*") if path.is_file()]
    assert {"result.json", "report.html", "mesh.vtu", "displacement.nii.gz", "warped_labels.nii.gz",
            "targets.csv", "saved.reduced"} <= {path.name for path in outputs}
    leaks = {path.name: names_in(path.read_bytes(), NAMES) for path in outputs}
    assert {name: found for name, found in leaks.items() if found} == {}
    assert [path for path in work.rglob("*") if "Canary" in path.name] == []
    assert list(temporary.iterdir()) == []
    pages = [path.read_text() for path in work.rglob("report.html")]
    assert len(pages) == 2 and all("On the target image" in page for page in pages)


@pytest.mark.parametrize("ending", ["nii.gz", "nrrd", "mha"])
def test_no_name_from_inside_a_file_is_in_an_error(ending, files, phantom, tmp_path):
    whole = next(path for path in files if path.name.endswith(ending)).read_bytes()
    if ending == "nii.gz":
        whole = gzip.compress(gzip.decompress(whole)[:-5000])
    damaged = tmp_path / f"{FILE_NAMES[4]}.{ending}"
    damaged.write_bytes(whole if ending == "nii.gz" else whole[:-5000])

    finished = run_palpate(*recover_arguments(phantom, tmp_path / "out", target=damaged))

    assert finished.returncode == ERROR_WITH_NAMES
    assert names_in(finished.stderr.encode(), NAMES[:15]) == set()
    assert damaged.name in finished.stderr  # the file that the user gave is named on the terminal


def test_the_scan_sees_packed_names():
    name = NAMES[0].encode()
    for packed in (gzip.compress(name), b"abc" + zlib.compress(name * 9) + b"def",
                   b'"' + base64.b64encode(zlib.compress(name * 9)) + b'"', base64.b64encode(name * 9)):
        assert names_in(packed, NAMES) == {NAMES[0]}, packed
