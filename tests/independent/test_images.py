# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""The generator's label volumes: the way back, volumes, drawn contours, and that palpate reads them."""
import json

import nibabel
import numpy as np
import pytest

pytest.importorskip("skfem", reason="scikit-fem is not installed: scripts/python")

from tests.conftest import PROGRAM
from tests.independent.__main__ import main
from tests.independent.anatomy import Anatomy, directions_of_sphere, draw_anatomy
from tests.independent.contours import KERNELS, Drawing, draw_drawing, smooth_field
from tests.independent.field import Field
from tests.independent.lattice import ends_of
from tests.independent.loads import FAMILIES, MOTIONS, wall_motion
from tests.independent.phantom import make_phantom
from tests.independent.score import summary, wilson
from tests.independent.truth import SMALLEST_JACOBIAN, solve_truth
from tests.independent.voxels import draw_labels, grid_of

SEED = 6


@pytest.fixture(scope="module")
def case():
    """Anatomy, truth and field of a coarse phantom."""
    anatomy = draw_anatomy(SEED, "touching")
    truth = solve_truth(anatomy, SEED, 60.0, "normal", 10.0)
    return anatomy, truth, Field(truth.solid, truth.displacement, anatomy.low, anatomy.high)


def volume(organ):
    """mm^3 by the distances of its surface from its centre."""
    away = np.linalg.norm(organ.surface(directions_of_sphere(20000)) - organ.centre, axis=1)
    return 4 * np.pi / 3 * (away ** 3).mean()


def test_points_come_back(case):
    anatomy, _, field = case
    points = np.random.default_rng(1).uniform(anatomy.low, anatomy.high, (5000, 3))
    back, _, left = field.origin(points + field(points))
    assert np.quantile(left, 0.999) < 0.01
    assert np.quantile(np.linalg.norm(back - points, axis=1), 0.999) < 0.05


def test_field_is_the_solution_at_its_nodes(case):
    _, truth, field = case
    middle = truth.solid.nodes[::7]
    assert np.abs(field(middle) - truth.displacement[::7]).max() < 1e-4


def test_gradient_of_the_field(case):
    anatomy, _, field = case
    points = np.random.default_rng(2).uniform(anatomy.low, anatomy.high, (500, 3))
    gradient = field(points, gradient=True)[1]
    for k in range(3):
        step = 1e-5 * np.eye(3)[k]
        slope = (field(points + step) - field(points - step)) / 2e-5
        assert np.quantile(np.abs(slope - gradient[:, :, k]), 0.99) < 1e-4  # a few lie between two cells


def test_voxels_have_the_volume_of_the_organs():
    anatomy = draw_anatomy(SEED, "round")
    for spacing in ((1, 1, 1), (1, 1, 3)):
        labels, _ = draw_labels(anatomy, grid_of(anatomy, spacing), Drawing(), np.random.default_rng(0))
        for organ in anatomy.organs:
            assert (labels == organ.label).sum() * np.prod(spacing) == pytest.approx(volume(organ), rel=0.006), organ.name


def test_target_labels_lie_on_the_moved_surface(case):
    anatomy, _, field = case
    grid = grid_of(anatomy, (1.5, 1.5, 1.5))
    labels, error = draw_labels(anatomy, grid, Drawing(), np.random.default_rng(0), field)
    assert error < 0.1
    prostate = anatomy["prostate"]
    skin = prostate.surface(directions_of_sphere(4000))
    normals, moved = prostate.normal(skin), skin + field(skin)
    steps = np.arange(-2.95, 3, 0.1)
    inside = 0
    for step in steps:
        index = np.rint((moved + step * normals - grid.origin) / grid.spacing).astype(int)
        inside = inside + (labels[tuple(index.T)] == prostate.label)
    outside = inside * 0.1 - 3.0
    assert abs(outside.mean()) < 0.03
    assert outside.std() < 0.5  # that of a place within a voxel is 0.43


@pytest.mark.parametrize("kernel", KERNELS)
def test_contour_noise_has_its_kernel(kernel):
    """Standard deviation and correlation at distances across axes of different spacing."""
    random, length = np.random.default_rng(3), 6.0
    fields = [smooth_field(random, (64, 60, 30), (1, 1, 2), kernel, length) for _ in range(8)]
    assert np.sqrt(np.mean([f.var() + f.mean() ** 2 for f in fields])) == pytest.approx(1, abs=0.06)
    for step in (2, 6, 12):
        along_x = np.mean([(f[step:] * f[:-step]).mean() for f in fields])
        along_z = np.mean([(f[:, :, step // 2:] * f[:, :, :-(step // 2)]).mean() for f in fields])
        assert along_x == pytest.approx(KERNELS[kernel](step / length), abs=0.09)
        assert along_z == pytest.approx(KERNELS[kernel](step / length), abs=0.09)


@pytest.mark.parametrize("style", [*KERNELS, "slices"])
def test_drawn_contours_are_off_by_what_was_asked(style):
    """Measured from the labels: volume between shells of known distance."""
    sd, prostate = 0.8, draw_anatomy(SEED, "round")["prostate"]
    anatomy = Anatomy("alone", [prostate], *ends_of(prostate))
    grid = grid_of(anatomy, (1, 1, 1))
    exact, _ = draw_labels(anatomy, grid, Drawing(), np.random.default_rng(0))
    offs = []
    for k in range(6):
        drawn, _ = draw_labels(anatomy, grid, Drawing(style, sd, 6.0), np.random.default_rng(k))
        for organ in anatomy.organs:
            changed = np.count_nonzero((drawn == organ.label) != (exact == organ.label))
            skin = organ.surface(directions_of_sphere(8000)) - organ.centre
            away = np.linalg.norm(skin, axis=1)
            cosine = np.abs((skin * organ.normal(skin + organ.centre)).sum(axis=1)) / away
            offs.append(changed / (4 * np.pi * (away ** 2 / cosine).mean()))  # mean of |shift|, mm
    low = 0.6 if style == "slices" else 0.93  # at a pole the jitter in plane moves nothing
    assert low * sd < np.mean(offs) * np.sqrt(np.pi / 2) < 1.07 * sd


def test_contours_of_a_seed_are_the_same_and_drawn_within_bounds():
    assert draw_drawing(4, "drawn") == draw_drawing(4, "drawn")
    for seed in range(20):
        drawing = draw_drawing(seed, "drawn")
        assert 0.2 <= drawing.sd_mm <= 1 and 4 <= drawing.length_mm <= 12
    assert draw_drawing(1, "0.5").sd_mm == 0.5
    assert draw_drawing(1, "squared:0.3:9") == Drawing("squared", 0.3, 9.0)
    with pytest.raises(ValueError, match="none of"):
        draw_drawing(1, "cubic:0.3:9")


@pytest.mark.parametrize("family", MOTIONS)
def test_walls_move_by_the_size_asked(family):
    organ = draw_anatomy(SEED)["bladder"]
    skin = organ.surface(directions_of_sphere(2000))
    motion = wall_motion(family, organ, skin, np.random.default_rng(1), 6.0)
    assert np.linalg.norm(motion, axis=1).max() == pytest.approx(6.0)
    normal = (motion * organ.normal(skin)).sum(axis=1)
    if family in ("normal", "bump"):
        assert np.linalg.norm(motion, axis=1) == pytest.approx(np.abs(normal), abs=1e-9)
    if family == "slide":
        assert np.sqrt((normal ** 2).mean()) < 0.5 * np.sqrt((motion ** 2).sum(axis=1).mean())


@pytest.mark.parametrize("family", [f for f in FAMILIES if f != "normal"] + ["mixed"])
def test_no_family_folds_the_tissue(family):
    truth = solve_truth(draw_anatomy(SEED, "touching"), SEED, 60.0, family, 16.0)
    assert truth.load["smallest_jacobian"] >= SMALLEST_JACOBIAN
    assert truth.load["prostate_surface_motion_rms_mm"] > 0.2


def test_share_and_spread():
    assert wilson(8, 10) == pytest.approx((0.490, 0.943), abs=0.001)
    rows = [{"hold": True, "error": e, "sd": 0.1, "low": 1.0, "high": 1.5} for e in (-0.1, 0.1, 0.2, -0.2)]
    assert "4 of 4" in summary(rows)[0]
    assert "1.83" in summary(rows)[2]


def test_files_of_a_phantom(tmp_path):
    told = make_phantom(tmp_path / "case", SEED, 60.0, load="shift", contours="matern32:0.5:7", spacing=(2, 2, 4), step=16.0)
    assert told == json.loads((tmp_path / "case/truth.json").read_text())
    volumes = [nibabel.load(tmp_path / f"case/{name}.nii.gz") for name in ("reference", "target")]
    for image in volumes:
        assert nibabel.aff2axcodes(image.affine) == ("L", "P", "S")
        assert image.header.get_zooms() == (2.0, 2.0, 4.0)
        assert set(np.unique(np.asanyarray(image.dataobj))) == {0, 1, 2, 3, 4, 5}
    assert (np.asanyarray(volumes[0].dataobj) != np.asanyarray(volumes[1].dataobj)).any()


@pytest.mark.skipif(not PROGRAM.exists(), reason=f"the program is not built: {PROGRAM}")
def test_short_study_through_palpate(tmp_path, capsys):
    """For the commands, not for accuracy: two coarse phantoms."""
    arguments = ["study", "--short", "--contours", "0.5", "--palpate", str(PROGRAM), "--out", str(tmp_path / "study")]
    main(arguments)
    said = capsys.readouterr().out
    assert "intervals hold the truth" in said and "sd(error / claimed sd)" in said
    assert len((tmp_path / "study/cases.csv").read_text().splitlines()) == 3
    main(arguments)  # all cases are there
    assert capsys.readouterr().out == said
    with pytest.raises(SystemExit, match="other settings"):
        main([*arguments, "--load", "bump"])
