# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""The generator's mesh and solver against closed forms and against palpate simulate on the same elements."""
import numpy as np
import pytest
from scipy.spatial import cKDTree

pytest.importorskip("skfem", reason="scikit-fem is not installed: scripts/python")

from tests.conftest import PROGRAM, run_palpate
from tests.independent.anatomy import KINDS, Organ, draw_anatomy
from tests.independent.cutting import cut_along
from tests.independent.elasticity import Solid, curved_mesh
from tests.independent.lattice import lattice, mesh_anatomy, volumes
from tests.independent.truth import build_solid, materials, nodes_of
from tests.vtu import read_arrays


def ball(radius):
    return Organ("ball", 1, "tissue", np.zeros(3), np.full(3, float(radius)), np.eye(3))


def hollow_sphere(step):
    """Cells between balls of 10 and 20 mm cut out of a lattice; the curved mesh."""
    axis = np.linspace(-23, 23, int(round(46 / step)) + 1)
    points, cells = lattice(axis, axis, axis)
    on = np.zeros((len(points), 0), bool)
    for radius in (10, 20):
        points, cells, on = cut_along(points, cells, on, ball(radius).level)
    away = np.linalg.norm(points[cells].mean(axis=1), axis=1)
    regions = np.digitize(away, [9.9, 20.0])  # no cell reaches through a sphere
    inner, outer = (np.abs(np.linalg.norm(points, axis=1) - radius) < 1e-6 for radius in (10, 20))
    lengths = np.linalg.norm(points[cells], axis=2)
    regions = np.where((lengths < 10 + 1e-6).all(axis=1), 0, np.where((lengths < 20 + 1e-6).all(axis=1), 1, 2))
    assert inner.any() and outer.any()
    mesh, regions = curved_mesh(points, cells, regions, {0: ball(10), 2: ball(20)})
    return mesh, regions


def test_patch_of_curved_cells_keeps_a_linear_field():
    anatomy = draw_anatomy(3, "touching")
    solid, regions = build_solid(anatomy, 10.0, 14.0)
    solid = Solid(solid.mesh, np.full(len(regions), 10.0), np.full(len(regions), 0.35))
    gradient = np.array([[0.02, 0.01, -0.03], [0.0, -0.01, 0.02], [0.01, 0.04, 0.03]])
    wanted = solid.nodes @ gradient.T + [1.0, 2.0, 3.0]
    held = (np.abs(solid.nodes - anatomy.low) < 1e-6).any(axis=1) | (np.abs(solid.nodes - anatomy.high) < 1e-6).any(axis=1)
    assert np.abs(solid.solve(held, wanted, tolerance=1e-11) - wanted).max() < 1e-6


def test_thick_sphere_under_radial_displacement():
    """Its inner wall moves out by 1 mm, its outer wall is held: u = A r + B / r^2 (Lame). Errors fall with the step."""
    errors = []
    for step in (6.0, 3.5):
        mesh, regions = hollow_sphere(step)
        shell = regions == 1
        solid = Solid(mesh, np.where(shell, 20.0, 0.0), np.full(len(regions), 0.4))
        nodes, inside = solid.nodes, nodes_of(solid, shell)
        away = np.linalg.norm(nodes, axis=1)
        b = 1.0 / (1 / 10 ** 2 - 10 / 20 ** 3)
        wanted = nodes * ((b / np.maximum(away, 1) ** 2 - b / 20 ** 3 * away) / np.maximum(away, 1))[:, None]
        held = inside & (nodes_of(solid, regions == 0) | nodes_of(solid, regions == 2))
        values = solid.solve(held, wanted, free=inside)
        errors.append(np.sqrt(((values - wanted)[inside] ** 2).sum(axis=1).mean()))
    assert errors[1] < 0.004  # mm, of 1
    assert errors[1] < errors[0] / 2.5


@pytest.mark.parametrize("kind", KINDS)
def test_cells_conform_to_the_organs(kind):
    anatomy = draw_anatomy(11, kind)
    mesh = mesh_anatomy(anatomy, 8.0)
    size = volumes(mesh.points, mesh.cells)
    assert size.min() > 0
    assert size.sum() == pytest.approx(np.prod(anatomy.high - anatomy.low))
    faces, count = np.unique(np.sort(mesh.cells[:, [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]].reshape(-1, 3)), axis=0,
                             return_counts=True)
    assert count.max() == 2
    border = mesh.points[faces[count == 1]]
    ends = np.concatenate([anatomy.low, anatomy.high])
    on_box = [(np.abs(border[:, :, k % 3] - ends[k]) < 1e-9).all(axis=1) for k in range(6)]
    assert np.any(on_box, axis=0).all()  # no gap inside


def write_vtk(path, nodes, cells, regions, moved):
    """Legacy VTK of quadratic tetrahedra (10, M) with the point array "wall"."""
    with open(path, "w") as file:
        file.write(f"# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {len(nodes)} double\n")
        np.savetxt(file, nodes, fmt="%.17g")
        file.write(f"CELLS {len(regions)} {11 * len(regions)}\n")
        np.savetxt(file, np.column_stack([np.full(len(regions), 10), cells.T]), fmt="%d")
        file.write(f"CELL_TYPES {len(regions)}\n" + "24\n" * len(regions))
        file.write(f"CELL_DATA {len(regions)}\nSCALARS region int 1\nLOOKUP_TABLE default\n")
        np.savetxt(file, regions + 1, fmt="%d")
        file.write(f"POINT_DATA {len(nodes)}\nSCALARS wall int 1\nLOOKUP_TABLE default\n")
        np.savetxt(file, moved, fmt="%d")


@pytest.mark.skipif(not PROGRAM.exists(), reason=f"the program is not built: {PROGRAM}")
@pytest.mark.parametrize("bent, tolerance", [(False, 1e-5), (True, 4e-3)])  # the two integrate bent cells at other points
def test_palpate_simulate_finds_the_same_displacement(tmp_path, bent, tolerance):
    """Same quadratic elements, bladder and rectum moved by 2 mm as rigid bodies, box and bones held."""
    anatomy = draw_anatomy(3, "touching")
    mesh = mesh_anatomy(anatomy, 14.0)
    organs = {organ.label: organ for organ in anatomy.organs} if bent else {}
    curved, regions = curved_mesh(mesh.points, mesh.cells, mesh.regions, organs)
    solid = Solid(curved, *materials(regions, 80.0))
    tissue = regions <= 1
    used, cells = np.unique(solid.basis.element_dofs[:, tissue], return_inverse=True)
    cells = cells.reshape(10, -1)
    nodes, wall = solid.nodes, nodes_of(solid, tissue)
    on_box = (np.abs(nodes - anatomy.low) < 1e-6).any(axis=1) | (np.abs(nodes - anatomy.high) < 1e-6).any(axis=1)
    marks = np.zeros(len(nodes), int)
    marks[on_box | nodes_of(solid, regions >= 4)] = 1
    marks[nodes_of(solid, regions == 2)], marks[nodes_of(solid, regions == 3)] = 2, 3
    moves = {2: [0.5, 1.0, -2.0], 3: [0.3, -1.5, 0.2]}
    values = np.zeros_like(nodes)
    for mark, move in moves.items():
        values[marks == mark] = move
    mine = solid.solve(marks > 0, values, free=wall)[used]
    write_vtk(tmp_path / "mesh.vtk", nodes[used], cells, regions[tissue], marks[used])
    text = ['[mesh]', 'file = "mesh.vtk"']
    for region, stiffness, ratio in ((1, 10.0, 0.35), (2, 80.0, 0.40)):
        text += ['[[material]]', f'region = {region}', 'law = "linear"', f'stiffness_kpa = {stiffness}', f'poisson_ratio = {ratio}']
    text += ['[[fix]]', 'where = {point_array = "wall", value = 1}']
    for mark, (x, y, z) in moves.items():
        text += ['[[move]]', f'where = {{point_array = "wall", value = {mark}}}', f'x_mm = {x}', f'y_mm = {y}', f'z_mm = {z}']
    (tmp_path / "model.toml").write_text("\n".join(text) + "\n")
    run = run_palpate("simulate", tmp_path / "model.toml", "--out", tmp_path / "run", "--quiet")
    assert run.returncode == 0, run.stderr
    theirs = read_arrays(sorted((tmp_path / "run").glob("state_*.vtu"))[-1])
    away, order = cKDTree(theirs["Points"]).query(nodes[used])  # the program numbers nodes in its own way
    assert away.max() < 1e-9
    assert np.abs(theirs["displacement"][order] - mine).max() < tolerance
