# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""palpate export: what other programs read, and that CalculiX (Debian: calculix-ccx) finds our
displacement again."""
import json
import re
import shutil
import subprocess
import xml.etree.ElementTree as xml

import numpy
import pytest

from tests.conftest import recover_arguments, run_palpate
from tests.vtu import read_arrays

LARGEST_DIFFERENCE = 0.005  # of the largest displacement
LAWS = ("linear", "neo-hookean", "neo-hookean-reduced", "reduced-polynomial", "yeoh")
OF_CALCULIX = ("linear", "neo-hookean-reduced", "reduced-polynomial", "yeoh")
needs_calculix = pytest.mark.skipif(shutil.which("ccx") is None,
                                    reason="ccx is not installed (Debian package calculix-ccx)")


@pytest.fixture(scope="module")
def results(phantom, tmp_path_factory):
    """Result folders by law."""
    folder = tmp_path_factory.mktemp("export")
    for law in LAWS:
        finished = run_palpate(*recover_arguments(phantom, folder / law, "--material", law))
        assert finished.returncode == 0, finished.stderr
    return {law: folder / law for law in LAWS}


def exported(result, out, *more):
    finished = run_palpate("export", result, "--out", out, *more)
    assert finished.returncode == 0, finished.stderr
    return out


def calculix(deck, num_nodes):
    finished = subprocess.run(["ccx", "-i", deck.stem], cwd=deck.parent, capture_output=True,
                              text=True, timeout=300)
    assert finished.returncode == 0 and "Job finished" in finished.stdout, finished.stdout[-2000:]
    rows = re.findall(r"^\s+(\d+)((?:\s+[-+.\dE]+){3})\s*$", deck.with_suffix(".dat").read_text(), re.M)
    assert len(rows) == num_nodes
    moved = numpy.zeros((num_nodes, 3))
    for number, values in rows:
        moved[int(number) - 1] = [float(v) for v in values.split()]
    return moved


@needs_calculix
@pytest.mark.parametrize("law", OF_CALCULIX)
@pytest.mark.parametrize("walls", ["displacement", "force"])
def test_calculix_finds_our_displacement(results, tmp_path, walls, law):
    deck = exported(results[law], tmp_path / "model.inp", "--walls", walls)
    ours = read_arrays(results[law] / "mesh.vtu")["displacement"]
    theirs = calculix(deck, len(ours))
    difference = numpy.linalg.norm(ours - theirs, axis=1).max() / numpy.linalg.norm(ours, axis=1).max()
    print(f"{law}, {walls}: {difference:.2e} of the largest displacement")
    assert difference < LARGEST_DIFFERENCE


def test_the_febio_file_holds_the_model_in_megapascals(results, tmp_path):
    for law, name in (("linear", "isotropic elastic"), ("neo-hookean", "neo-Hookean")):
        root = xml.parse(exported(results[law], tmp_path / f"{law}.feb")).getroot()
        report = json.loads((results[law] / "result.json").read_text())
        arrays = read_arrays(results[law] / "mesh.vtu")
        assert root.attrib["version"] == "4.0"
        order = [part.tag for part in root]
        assert order == ["Module", "Control", "Material", "Mesh", "MeshDomains", "MeshData", "Boundary",
                         "LoadData", "Output"]
        solid = {r["name"]: r for r in report["regions"] if not r["hollow"]}
        materials = root.findall("Material/material")
        assert len(materials) == len(solid)
        for material in materials:
            region = solid[material.attrib["name"]]
            assert material.attrib["type"] == name
            assert float(material.find("E").text) == pytest.approx(region["most_probable_kpa"] / 1000)
            assert float(material.find("v").text) == pytest.approx(region["poisson_ratio"])
        nodes = numpy.array([[float(v) for v in n.text.split(",")] for n in root.findall("Mesh/Nodes/node")])
        numpy.testing.assert_allclose(nodes, arrays["Points"], atol=1e-5)
        assert len(root.findall("Mesh/Elements/elem")) == len(arrays["region"])
        sets = {s.attrib["name"]: [int(v) - 1 for v in s.text.split(",")]
                for s in root.findall("Mesh/NodeSet")}
        assert sets["fixed"] == numpy.flatnonzero(arrays["held"] == 1).tolist()
        assert sets["driven"] == numpy.flatnonzero(arrays["held"] == 2).tolist()
        wall = [float(n.text) for n in root.find("MeshData/NodeData[@name='wall_y']")]
        numpy.testing.assert_allclose(wall, arrays["displacement"][sets["driven"], 1], atol=1e-9)


def test_forces_in_the_febio_file_are_newtons(results, tmp_path):
    root = xml.parse(exported(results["linear"], tmp_path / "m.feb", "--walls", "force")).getroot()
    arrays = read_arrays(results["linear"] / "mesh.vtu")
    force = [[float(v) for v in n.text.split(",")] for n in root.find("MeshData/NodeData")]
    numpy.testing.assert_allclose(force, arrays["force"][arrays["held"] == 2] / 1000, atol=1e-9)
    assert root.find("Loads/nodal_load").attrib["type"] == "nodal_force"
    assert [bc.attrib["type"] for bc in root.findall("Boundary/bc")] == ["zero displacement"]


def gmsh_sections(text):
    return {name: body.strip().splitlines()
            for name, body in re.findall(r"^\$(\w+)\n(.*?)^\$End\1$", text, re.M | re.S)
            if name not in ("NodeData", "ElementData")}


def gmsh_mesh(lines, width):
    """Tags and rows of the blocks of a $Nodes or $Elements section, format 4.1."""
    num_blocks, count, low, high = map(int, lines[0].split())
    at, tags, rows, entities = 1, [], [], []
    for _ in range(num_blocks):
        dim, entity, kind, size = map(int, lines[at].split())
        block = [line.split() for line in lines[at + 1:at + 1 + size * (2 if width == 3 else 1)]]
        at += 1 + len(block)
        if width == 3:
            tags += [int(row[0]) for row in block[:size]]
            rows += [[float(v) for v in row] for row in block[size:]]
        else:
            assert kind == 4
            tags += [int(row[0]) for row in block]
            rows += [[int(v) for v in row[1:]] for row in block]
        entities += [entity] * size
        assert dim == 3
    assert at == len(lines) and len(tags) == count and (min(tags), max(tags)) == (low, high)
    order = numpy.argsort(tags)
    return numpy.array(rows)[order], numpy.array(entities)[order]


def test_the_gmsh_file_holds_the_mesh_and_its_fields(results, tmp_path):
    text = exported(results["linear"], tmp_path / "model.msh").read_text()
    arrays = read_arrays(results["linear"] / "mesh.vtu")
    sections = gmsh_sections(text)
    assert sections["MeshFormat"] == ["4.1 0 8"]
    nodes, _ = gmsh_mesh(sections["Nodes"], 3)
    elements, entities = gmsh_mesh(sections["Elements"], 4)
    numpy.testing.assert_allclose(nodes, arrays["Points"], atol=1e-5)
    numpy.testing.assert_array_equal(elements - 1, arrays["connectivity"].reshape(-1, 4))
    for label in numpy.unique(arrays["region"]):
        assert len(numpy.unique(entities[arrays["region"] == label])) == 1
    field = re.search(r'\$NodeData\n1\n"displacement"\n1\n0\n3\n0\n3\n(\d+)\n(.*?)\$EndNodeData', text,
                      re.S)
    rows = numpy.array([line.split() for line in field[2].splitlines()], float)
    assert int(field[1]) == len(nodes) == len(rows)
    numpy.testing.assert_allclose(rows[:, 1:], arrays["displacement"], atol=1e-6)


def test_vtk_reads_the_vtu(results, tmp_path):
    vtk = pytest.importorskip("vtk", reason="VTK's Python package (Debian: python3-vtk9)")
    from vtk.util.numpy_support import vtk_to_numpy
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(exported(results["linear"], tmp_path / "model.vtu")))
    reader.Update()
    grid = reader.GetOutput()
    arrays = read_arrays(results["linear"] / "mesh.vtu")
    numpy.testing.assert_array_equal(vtk_to_numpy(grid.GetPoints().GetData()), arrays["Points"])
    for name in ("displacement", "force", "held"):
        numpy.testing.assert_array_equal(vtk_to_numpy(grid.GetPointData().GetArray(name)), arrays[name])
    for name in ("region", "stiffness_kpa"):
        numpy.testing.assert_array_equal(vtk_to_numpy(grid.GetCellData().GetArray(name)), arrays[name])
    assert set(vtk_to_numpy(grid.GetCellData().GetArray("poisson_ratio"))) <= {0.35, 0.4}
    assert grid.GetFieldData().GetAbstractArray("SPACE").GetValue(0) == "LPS"


def test_what_cannot_be_exported_is_refused_in_a_sentence(results, tmp_path):
    out = exported(results["linear"], tmp_path / "model.msh")
    before = out.read_bytes()
    for arguments, code, words in (
            ([results["linear"], "--out", out], 10, "--overwrite"),
            ([results["linear"], "--out", tmp_path / "model.stl"], 2, ".feb"),
            ([results["neo-hookean"], "--out", tmp_path / "model.inp"], 2, "neo-hookean"),
            ([results["neo-hookean-reduced"], "--out", tmp_path / "model.feb"], 2, "FEBio has no law"),
            ([tmp_path, "--out", tmp_path / "a.feb"], 3, "result.json"),
            ([tmp_path / "absent", "--out", tmp_path / "a.feb"], 3, "not a folder"),
            ([results["linear"], "--out", tmp_path / "no" / "a.feb"], 10, "folder")):
        finished = run_palpate("export", *arguments)
        assert finished.returncode == code, finished.stderr
        assert words in finished.stderr and len(finished.stderr.splitlines()) == 1
    assert out.read_bytes() == before and [p.name for p in tmp_path.iterdir()] == ["model.msh"]
