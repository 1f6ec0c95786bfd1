# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""A target of surfaces and clouds of points instead of a label volume."""
import json

import nibabel
import numpy
import pytest

from tests.conftest import run_palpate

TRUE_KPA = 60
ORGANS = ("prostate", "bladder", "rectum")


def read_ply(path):
    """Vertices and triangles of the text files that the phantom writes."""
    head, body = path.read_text().split("end_header\n")
    count = int(head.split("element vertex ")[1].split()[0])
    lines = body.splitlines()
    vertices = numpy.array([line.split() for line in lines[:count]], float)
    triangles = numpy.array([line.split()[1:] for line in lines[count:]], int)
    return vertices, triangles


def write_ply(path, vertices, triangles):
    head = (f"ply\nformat ascii 1.0\nelement vertex {len(vertices)}\nproperty double x\n"
            f"property double y\nproperty double z\nelement face {len(triangles)}\n"
            "property list uchar int vertex_indices\nend_header\n")
    path.write_text(head + "".join("%.6f %.6f %.6f\n" % tuple(x) for x in vertices)
                    + "".join("3 %d %d %d\n" % tuple(t) for t in triangles))


def arguments(phantom, out, *more):
    return ["recover", phantom / "reference.nii.gz", "--config", phantom / "organs.toml", "--out", out,
            "--nodes", 2500, "--quiet", *more]


def shapes(option, files):
    return [word for organ, path in files.items() for word in (option, f"{organ}={path}")]


def truth(phantom, *organs):
    return {organ: phantom / f"target_{organ}.ply" for organ in organs or ORGANS}


def recovered(phantom, out, *more):
    finished = run_palpate(*arguments(phantom, out, *more))
    assert finished.returncode == 0, finished.stderr
    return json.loads((out / "result.json").read_text())


def named(report, kind, name):
    return next(entry for entry in report[kind] if entry["name"] == name)


def assert_near_truth(report, tolerance):
    found = named(report, "regions", "prostate")
    assert abs(found["stiffness_kpa"] / TRUE_KPA - 1) < tolerance, found
    low, high = found["interval_kpa"]
    assert low < TRUE_KPA < high


@pytest.fixture(scope="module")
def closed(phantom, tmp_path_factory):
    folder = tmp_path_factory.mktemp("closed")
    more = ("--save-reduced", folder / "saved")
    return folder, recovered(phantom, folder / "out", *shapes("--target-surface", truth(phantom)), *more)


@pytest.fixture(scope="module")
def half_prostate(phantom, tmp_path_factory):
    """The part of the prostate's surface in front of its centre, turned inside out."""
    vertices, triangles = read_ply(phantom / "target_prostate.ply")
    in_front = vertices[triangles].mean(axis=1)[:, 1] < vertices[:, 1].mean()
    path = tmp_path_factory.mktemp("half") / "half.ply"
    write_ply(path, vertices, triangles[in_front][:, ::-1])
    return path, vertices[:, 1].mean()


def test_exact_surfaces_of_all_organs_give_the_stiffness(closed):
    _, report = closed
    assert_near_truth(report, 0.15)
    for organ in ORGANS:
        surface = named(report, "surfaces", organ)
        assert surface["target"] == "surface" and surface["seen_share"] > 0.95
        assert surface["mean_distance_mm_after"] < 0.3 * surface["mean_distance_mm_before"]
    assert report["warnings"] == []
    assert report["alignment"]["method"] == "none"


def test_what_needs_target_labels_is_left_out(phantom, closed):
    folder, report = closed
    for surface in report["surfaces"]:
        assert surface["dice_before"] is None and surface["dice_after"] is None
    reference = nibabel.load(phantom / "reference.nii.gz")
    for name in ("warped_labels.nii.gz", "displacement.nii.gz"):
        image = nibabel.load(folder / "out" / name)
        assert image.shape[:3] == reference.shape
        numpy.testing.assert_allclose(image.affine, reference.affine, atol=1e-4)
    page = (folder / "out" / "report.html").read_text()
    assert "–" in page and "prostate: 100 % (surface)" in page


def test_half_a_surface_carries_data_on_its_half_only(phantom, half_prostate, tmp_path):
    half, _ = half_prostate
    files = {"prostate": half, **truth(phantom, "bladder", "rectum")}
    report = recovered(phantom, tmp_path / "out", *shapes("--target-surface", files))
    assert 0.35 < named(report, "surfaces", "prostate")["seen_share"] < 0.65
    assert named(report, "surfaces", "prostate")["mean_distance_mm_after"] < 0.5
    assert_near_truth(report, 0.35)


@pytest.fixture(scope="module")
def clouds(phantom, tmp_path_factory):
    """Noisy points of the prostate's front half and of both walls, with a few strays; RAS."""
    folder = tmp_path_factory.mktemp("clouds")
    random = numpy.random.default_rng(5)
    files = {}
    for organ in ORGANS:
        vertices, triangles = read_ply(phantom / f"target_{organ}.ply")
        corners = vertices[triangles]
        area = numpy.linalg.norm(numpy.cross(corners[:, 1] - corners[:, 0],
                                             corners[:, 2] - corners[:, 0]), axis=1)
        chosen = corners[random.choice(len(corners), 4000, p=area / area.sum())]
        weights = random.dirichlet((1, 1, 1), 4000)
        points = (weights[:, :, None] * chosen).sum(axis=1) + random.normal(0, 0.3, (4000, 3))
        if organ == "prostate":
            points = points[points[:, 1] < vertices[:, 1].mean()]
        strays = vertices.mean(axis=0) + random.uniform(-60, 60, (10, 3))
        files[organ] = folder / f"{organ}.csv"
        numpy.savetxt(files[organ], numpy.vstack([points, strays]) * [-1, -1, 1], delimiter=",",
                      header="x,y,z", comments="")
    return files


def test_clouds_of_points_give_the_stiffness(phantom, clouds, tmp_path):
    report = recovered(phantom, tmp_path / "out", *shapes("--target-points", clouds),
                       "--target-frame", "ras", "--target-noise", 0.3)
    assert_near_truth(report, 0.25)
    assert 0.35 < named(report, "surfaces", "prostate")["seen_share"] < 0.65
    for organ in ORGANS:
        surface = named(report, "surfaces", organ)
        assert surface["target"] == "points"
        assert surface["mean_distance_mm_after"] < 0.3 * surface["mean_distance_mm_before"]


def test_an_organ_that_is_not_given_moves_freely_and_that_is_said(phantom, closed, tmp_path):
    folder, _ = closed
    out = tmp_path / "out"
    command = arguments(phantom, out, *shapes("--target-surface", truth(phantom, "prostate", "rectum")),
                        "--load-reduced", folder / "saved")
    del command[command.index("--nodes"):command.index("--nodes") + 2]
    finished = run_palpate(*command)
    assert finished.returncode == 0, finished.stderr
    report = json.loads((out / "result.json").read_text())
    bladder = named(report, "surfaces", "bladder")
    assert bladder["target"] == "none" and bladder["seen_share"] == 0
    assert bladder["mean_distance_mm_after"] is None
    assert len(report["warnings"]) == 1 and "bladder" in report["warnings"][0]
    low, high = named(report, "regions", "prostate")["interval_kpa"]
    assert low < TRUE_KPA < high
    assert report["warnings"][0] in finished.stdout


def test_mistakes_are_named_in_one_line(phantom, tmp_path):
    ply = phantom / "target_prostate.ply"
    points, _ = read_ply(ply)
    metres, far = tmp_path / "metres.csv", tmp_path / "far.csv"
    turned, few = tmp_path / "turned.csv", tmp_path / "few.csv"
    numpy.savetxt(metres, points / 1000, delimiter=",")
    numpy.savetxt(far, points + [900, 0, 0], delimiter=",")
    numpy.savetxt(few, points[:7], delimiter=",")
    numpy.savetxt(turned, (points - points.mean(axis=0)) * 0.001 + points.mean(axis=0), delimiter=",")
    surface, cloud = "--target-surface", "--target-points"
    volume = phantom / "target.nii.gz"
    for code, words, more in (
            (2, ["needs a target", surface], []),
            (2, ["not both", volume.name], [volume, surface, f"prostate={ply}"]),
            (2, ["ORGAN=FILE", "prostate.ply"], [surface, "prostate.ply"]),
            (2, ["'spleen'", "'bladder'"], [surface, f"spleen={ply}"]),
            (2, ["'bone_left'", "fixed"], [surface, f"bone_left={ply}"]),
            (2, ["two targets"], [surface, f"prostate={ply}", cloud, f"prostate={ply}"]),
            (2, ["--align"], [surface, f"prostate={ply}", "--align", "centroid"]),
            (2, ["nested-lbfgs"], [surface, f"prostate={ply}", "--method", "nested-lbfgs"]),
            (2, ["--target-frame"], [surface, f"prostate={ply}", "--target-frame", "xyz"]),
            (3, ["nowhere.ply"], [surface, "prostate=nowhere.ply"]),
            (3, [".csv, .txt"], [cloud, f"prostate={volume}"]),
            (4, ["at least 8"], [cloud, f"prostate={few}"]),
            (4, ["metres", "metres.csv"], [cloud, f"prostate={metres}"]),
            (4, ["mm away", "prostate"], [cloud, f"prostate={far}"]),
            (4, ["mm large"], [cloud, f"prostate={turned}"])):
        out = tmp_path / "out"
        finished = run_palpate(*arguments(phantom, out, *more))
        lines = finished.stderr.strip().splitlines()
        assert finished.returncode == code, (more, finished.stderr)
        assert len(lines) == 1 and all(word in lines[0] for word in words), lines
        assert not out.exists()
