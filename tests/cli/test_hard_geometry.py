# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Segmentations that are readable but make no sense are refused with a code and what to do about
it; odd ones that make sense are accepted."""
import json

import nibabel
import numpy
import pytest

from tests.conftest import run_palpate
from tests.verdicts import verdict_that_follows

SIDE = 32
GLAND, BLADDER, BONE = 1, 2, 3
SETTINGS = """
[background]
stiffness_kpa = 10.0
[[organ]]
name = "gland"
label = 1
role = "tissue"
stiffness_kpa = "unknown"
[[organ]]
name = "bladder"
label = 2
role = "driven"
"""
FIXED_BONE = '[[organ]]\nname = "bone"\nlabel = 3\nrole = "fixed"\n'


def ball(scene, centre, radius, label):
    z, y, x = numpy.indices(scene.shape[::-1])
    distance = (x - centre[0]) ** 2 + (y - centre[1]) ** 2 + (z - centre[2]) ** 2
    scene[(distance <= radius ** 2).transpose(2, 1, 0)] = label
    return scene


def scene(shift=0.0, side=SIDE, squeeze=0):
    """A gland beside a bladder, which is larger by `squeeze`, all moved by `shift` voxels."""
    voxels = numpy.zeros((side,) * 3, numpy.uint8)
    ball(voxels, (12 + shift, 16, 16), 6, GLAND)
    return ball(voxels, (23 + shift, 16, 16), 5 + squeeze, BLADDER)


def only(*keep):
    voxels = scene()
    voxels[~numpy.isin(voxels, keep)] = 0
    return voxels


def with_one_voxel():
    voxels = only(BLADDER)
    voxels[12, 16, 16] = GLAND
    return voxels


def with_slab(thickness):
    voxels = only(BLADDER)
    voxels[12:12 + thickness, 8:24, 8:24] = GLAND
    return voxels


def with_line():
    voxels = only(BLADDER)
    voxels[4:15, 16, 16] = GLAND
    return voxels


def with_holes():
    voxels = scene()
    voxels[12, 16, 16] = voxels[10, 14, 16] = 0
    return voxels


def with_islands():
    voxels = scene()
    voxels[2:4, 2:4, 2:4] = GLAND
    voxels[28, 28, 28] = BLADDER
    return voxels


def shell():
    voxels = only(BLADDER)
    ball(voxels, (12, 16, 16), 6, GLAND)
    return ball(voxels, (12, 16, 16), 5.4, 0)


def checkerboard():
    voxels = only(BLADDER)
    x, y, z = numpy.indices(voxels.shape)
    voxels[(x < 18) & (x > 4) & ((x + y + z) % 2 == 0)] = GLAND
    return voxels


def at_the_border():
    """The gland is cut by the border of the image."""
    voxels = numpy.zeros((SIDE,) * 3, numpy.uint8)
    ball(voxels, (3, 16, 16), 6, GLAND)
    return ball(voxels, (15, 16, 16), 5, BLADDER)


def rotated(degrees):
    c, s = numpy.cos(numpy.radians(degrees)), numpy.sin(numpy.radians(degrees))
    return numpy.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])


def spaced(*mm):
    return numpy.diag([*mm, 1.0])


def moved(x):
    affine = numpy.eye(4)
    affine[0, 3] = x
    return affine


def save(path, voxels, affine=None):
    nibabel.save(nibabel.Nifti1Image(voxels, numpy.eye(4) if affine is None else affine), path)
    return path


@pytest.fixture
def recover(tmp_path):
    def run(reference, target, *more, settings=SETTINGS, affines=(None, None)):
        config = tmp_path / "organs.toml"
        config.write_text(settings)
        out = tmp_path / "out"
        finished = run_palpate(
            "recover", save(tmp_path / "reference.nii.gz", reference, affines[0]),
            save(tmp_path / "target.nii.gz", target, affines[1]), "--config", config, "--out", out,
            "--nodes", 1200, "--backend", "reference", "--quiet", *more)
        return finished, out

    return run


REFUSED = {
    "an empty reference": (only(), scene(), {}, 4, "empty"),
    "an empty target": (scene(), only(), {}, 4, "empty"),
    "an organ that is not in the reference": (only(BLADDER), scene(), {}, 4, "no voxel has label 1"),
    "an organ that is not in the target": (scene(), only(GLAND), {}, 4, "no voxel has label 2"),
    "an organ of one voxel": (with_one_voxel(), scene(), {}, 4, "at least 8"),
    "an organ of one voxel in the target": (scene(), with_one_voxel(), {}, 4, "at least 8"),
    "a line of voxels": (with_line(), with_line(), {}, 4, "edge length"),
    "a shell of less than a voxel": (shell(), shell(), {}, 4, "edge length"),
    "a checkerboard": (checkerboard(), checkerboard(), {}, 4, "edge length"),
    "no overlap": (scene(), scene(), dict(affines=(None, moved(500)), more=["--align", "none"]), 4, "overlap"),
    "no overlap of one organ": (
        scene(), ball(only(GLAND), (16, 27, 27), 3, BLADDER), dict(more=["--align", "none"]), 4, "overlap"),
    "organs that changed places": (
        scene(), numpy.choose(scene(), [0, BLADDER, GLAND]).astype(numpy.uint8),
        dict(more=["--align", "none"]), 4, "overlap"),
    "another unit in the target": (
        scene(), scene(), dict(affines=(None, spaced(10, 10, 10)), more=["--align", "none"]), 4, "overlap"),
    "a background label that is not there": (
        scene(), scene(), dict(settings=SETTINGS.replace("[background]", "[background]\nlabel = 9")), 4, "label 9"),
    "a label twice": (
        scene(), scene(), dict(settings=SETTINGS.replace("label = 2", "label = 1")), 2, "labels must differ"),
    "a fixed organ that is not there": (scene(), scene(), dict(settings=SETTINGS + FIXED_BONE), 4, "bone"),
    "nothing unknown moves and nothing is known": (
        scene(), scene(), dict(settings=SETTINGS.partition("[[organ]]")[1] + SETTINGS.partition("[[organ]]")[2]),
        2, "reference tissue"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_is_refused(name, recover):
    reference, target, how, code, word = REFUSED[name]

    finished, out = recover(reference, target, *how.get("more", []),
                            **{k: v for k, v in how.items() if k != "more"})

    assert finished.returncode == code, finished.stderr
    lines = finished.stderr.strip().splitlines()
    assert len(lines) == 1 and word in lines[0], finished.stderr
    assert ";" in lines[0] or ":" in lines[0]  # what to do, or what is allowed
    assert not out.exists()


ACCEPTED = {
    "touching the border": (at_the_border(), at_the_border(), {}),
    "holes": (with_holes(), scene(0, squeeze=1), {}),
    "islands": (with_islands(), scene(0, squeeze=1), {}),
    "islands in the target": (scene(), with_islands(), {}),
    "the same image twice": (scene(), scene(), {}),
    "fine voxels": (scene(), scene(0, squeeze=1), dict(affines=(spaced(.1, .1, .1),) * 2)),
    "coarse voxels": (scene(), scene(0, squeeze=1), dict(affines=(spaced(5, 5, 5),) * 2)),
    "flat voxels": (scene(), scene(0, squeeze=1), dict(affines=(spaced(1, 1, 4),) * 2)),
    "an oblique grid": (scene(), scene(0, squeeze=1), dict(affines=(rotated(30),) * 2)),
    "a left-handed grid": (scene(), scene(0, squeeze=1), dict(affines=(spaced(-1, 1, 1),) * 2)),
    "grids of two hands": (scene()[::-1].copy(), scene(0, squeeze=1),
                           dict(affines=(spaced(-1, 1, 1), moved(-SIDE + 1)))),
    "a target far away": (scene(), scene(0, squeeze=1), dict(affines=(None, moved(300)))),
    "a slab of one voxel": (with_slab(1), with_slab(1), {}),
    "two layers of voxels": (with_slab(2), with_slab(2), {}),
}


@pytest.mark.parametrize("name", ACCEPTED)
def test_is_accepted(name, recover):
    reference, target, how = ACCEPTED[name]

    finished, out = recover(reference, target, affines=how.get("affines", (None, None)))

    assert finished.returncode in (0, 7), finished.stderr
    result = json.loads((out / "result.json").read_text())
    gland = next(region for region in result["regions"] if region["name"] == "gland")
    assert gland["verdict"] == verdict_that_follows(gland)
    if name == "the same image twice":
        assert gland["verdict"] == "not identifiable"  # nothing moved, so nothing can be told
    is_thin = "slab" in name or "layers" in name
    assert any("nowhere three voxels thick" in warning for warning in result["warnings"]) == is_thin
    if name == "touching the border":
        assert any(surface["cut_by_image"] for surface in result["surfaces"])
