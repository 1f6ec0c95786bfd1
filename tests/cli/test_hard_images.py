# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Damaged and misleading label volumes are refused with the right exit code and one sentence that
names the file; odd ones that are right are read."""
import gzip
import resource
import subprocess
import sys
import time

import pytest

from tests import hard_images
from tests.conftest import PROGRAM, run_palpate

# The organ has a label that no volume holds: a volume that is accepted is found out here, with the
# labels that were read, before anything takes time.
SETTINGS = """
[background]
[[organ]]
name = "gland"
label = 77
role = "tissue"
stiffness_kpa = "unknown"
"""


@pytest.fixture
def read(tmp_path):
    """Reads a volume through the command line."""
    settings = tmp_path / "organs.toml"
    settings.write_text(SETTINGS)

    def run(path):
        out = tmp_path / "out"
        finished = run_palpate("recover", path, path, "--config", settings, "--out", out,
                               "--backend", "reference", "--quiet")
        assert not out.exists()
        lines = finished.stderr.strip().splitlines()
        assert len(lines) == 1 and lines[0].startswith("palpate: "), finished.stderr
        return finished.returncode, lines[0]

    return run


@pytest.mark.parametrize("case", hard_images.refused(), ids=lambda case: case.name)
def test_is_refused(case, read, tmp_path):
    path = hard_images.write(case, tmp_path)

    code, sentence = read(path)

    assert code == case.code, sentence
    assert path.name in sentence and case.word in sentence, sentence


@pytest.mark.parametrize("case", hard_images.accepted(), ids=lambda case: case.name)
def test_is_accepted(case, read, tmp_path):
    code, sentence = read(hard_images.write(case, tmp_path))

    assert code == hard_images.UNUSABLE
    assert "no voxel has label 77 (labels present: 0, 1)" in sentence, sentence


def test_there_are_enough_cases():
    assert len(list(hard_images.refused())) >= 40


def compressed_zeros(header, count):
    """gzip of `header` and so many zeros, without holding them."""
    import zlib
    packer = zlib.compressobj(9, wbits=31)
    parts = [packer.compress(header)]
    piece = bytes(1 << 20)
    for _ in range(count >> 20):
        parts.append(packer.compress(piece))
    return b"".join(parts) + packer.flush()


@pytest.mark.parametrize("name, data, word", [
    ("a KiB that claims 2000^3 voxels",
     lambda: gzip.compress(hard_images.nifti(dim=(3, 2000, 2000, 2000, 1, 1, 1, 1))), "2^30"),
    ("a KiB that claims 1000^3 voxels",
     lambda: gzip.compress(hard_images.nifti(dim=(3, 1000, 1000, 1000, 1, 1, 1, 1))), "cut off"),
    ("2 GiB of zeros behind a small image",
     lambda: compressed_zeros(hard_images.nifti(), 1 << 31), "more data"),
    ("2 GiB of zeros in place of a header", lambda: compressed_zeros(b"", 1 << 31), "not a NIfTI"),
], ids=lambda value: value if isinstance(value, str) and " " in value else "")
def test_a_gzip_bomb_is_refused_without_being_unpacked(name, data, word, read, tmp_path):
    path = tmp_path / "bomb.nii.gz"
    path.write_bytes(data())
    settings = tmp_path / "organs.toml"
    before = time.monotonic()

    finished = subprocess.run(
        [sys.executable, "-c",
         "import resource, subprocess, sys\n"
         "done = subprocess.run(sys.argv[1:], capture_output=True, text=True)\n"
         "print(done.returncode, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss // 1024,"
         " done.stderr)",
         str(PROGRAM), "recover", str(path), str(path), "--config", str(settings), "--out",
         str(tmp_path / "out"), "--backend", "reference", "--quiet"],
        capture_output=True, text=True, timeout=60)

    code, mebibytes, sentence = finished.stdout.split(maxsplit=2)
    print(f"{name}: {time.monotonic() - before:.2f} s, {mebibytes} MiB")
    assert int(code) in (3, 4) and word in sentence, finished.stdout
    assert int(mebibytes) < 512
