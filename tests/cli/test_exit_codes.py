# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Every documented exit code is reached, with one sentence."""
import re
import resource
import signal
import subprocess

import numpy
import pytest

from tests.conftest import PROGRAM, ROOT, recover_arguments, run_palpate

SHEET = """<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>
<Piece NumberOfPoints="{points_count}" NumberOfCells="{cells_count}">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">{points}</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">{tets}</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">{offsets}</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">{types}</DataArray></Cells>
<CellData><DataArray type="Int32" Name="region" format="ascii">{regions}</DataArray></CellData>
</Piece></UnstructuredGrid></VTKFile>"""

SIX_TETS = [(0, 1, 3, 7), (0, 3, 2, 7), (0, 2, 6, 7), (0, 6, 4, 7), (0, 4, 5, 7), (0, 5, 1, 7)]


def block_of_tets(first, count, size, origin):
    """Nodes and tetrahedra of a cube of `count`^3 cells."""
    n = count + 1
    nodes = [tuple(origin + size * v) for v in
             (numpy.array((i, j, k)) for k in range(n) for j in range(n) for i in range(n))]
    tets = []
    for k in range(count):
        for j in range(count):
            for i in range(count):
                corner = [first + (i + (c & 1)) + n * ((j + (c >> 1 & 1)) + n * (k + (c >> 2)))
                          for c in range(8)]
                tets += [tuple(corner[c] for c in tet) for tet in SIX_TETS]
    return nodes, tets


def vtu(nodes, tets, regions):
    text = lambda rows: " ".join(str(value) for row in rows for value in row)
    return SHEET.format(points_count=len(nodes), cells_count=len(tets), points=text(nodes),
                        tets=text(tets), offsets=" ".join(str(4 * (k + 1)) for k in range(len(tets))),
                        types="10 " * len(tets), regions=" ".join(map(str, regions)))


def simulation(tmp_path, text):
    model = tmp_path / "model.toml"
    model.write_text(text)
    return ["simulate", model, "--out", tmp_path / "out", "--quiet"]


def ok(phantom, tmp_path):
    return run_palpate("devices"), None


def internal(phantom, tmp_path):
    """A process without file handles cannot start the mesher: nobody's mistake."""
    few = lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (9, 9))
    arguments = recover_arguments(phantom, tmp_path / "out", "--backend", "reference")
    return subprocess.run([str(PROGRAM), *map(str, arguments)], capture_output=True, text=True,
                          timeout=300, preexec_fn=few), "open files"


def usage(phantom, tmp_path):
    return run_palpate("devices", "--bogus"), "--bogus"


def unreadable(phantom, tmp_path):
    return run_palpate(*recover_arguments(phantom, tmp_path / "out", target="nowhere.nii")), "nowhere.nii"


def unusable(phantom, tmp_path):
    config = tmp_path / "organs.toml"
    config.write_text((phantom / "organs.toml").read_text().replace("label = 1\n", "label = 99\n"))
    return run_palpate(*recover_arguments(phantom, tmp_path / "out", config=config)), "99"


def meshing(phantom, tmp_path):
    return run_palpate(*recover_arguments(phantom, tmp_path / "out"),
                       environment={"PALPATE_MESH": "/nowhere/palpate-mesh"}), "palpate-mesh"


def solving(phantom, tmp_path):
    """A piece of tissue that hangs on nothing has no equilibrium."""
    nodes, tets = block_of_tets(0, 4, 0.25, numpy.zeros(3))
    more, island = block_of_tets(len(nodes), 1, 0.2, numpy.array((0, 0, 3.0)))
    mesh = tmp_path / "two_pieces.vtu"
    mesh.write_text(vtu(nodes + more, tets + island, [1] * (len(tets) + len(island))))
    return run_palpate(*simulation(tmp_path, f"""
[mesh]
file = "{mesh}"
[[material]]
law = "linear"
stiffness_kpa = 10
poisson_ratio = 0.4
[[fix]]
name = "table"
where = {{side = "z-min"}}
[[force]]
name = "push"
where = {{side = "z-max"}}
total_mn = [1, 0, 0]
""")), ""


def not_converged(phantom, tmp_path):
    arguments = recover_arguments(phantom, tmp_path / "out", "--max-iterations", 1)
    return run_palpate(*arguments), None


def device(phantom, tmp_path):
    return run_palpate(*recover_arguments(phantom, tmp_path / "out", "--device", "9.9")), "9.9"


def time_limit(phantom, tmp_path):
    """The mesher sleeps."""
    program = tmp_path / "palpate-mesh"
    program.write_text("#!/bin/sh\nexec sleep 60\n")
    program.chmod(0o755)
    arguments = recover_arguments(phantom, tmp_path / "out", "--mesh-time-limit", 1)
    return run_palpate(*arguments, environment={"PALPATE_MESH": str(program)}), "longer than 1 s"


def cancelled(phantom, tmp_path):
    arguments = [str(a) for a in recover_arguments(phantom, tmp_path / "out") if a != "--quiet"]
    process = subprocess.Popen([str(PROGRAM), *arguments], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    process.stderr.readline()
    process.send_signal(signal.SIGINT)
    out, text = process.communicate(timeout=60)
    return subprocess.CompletedProcess(arguments, process.returncode, out,
                                       text.strip().splitlines()[-1]), "stopped by a signal"


def output(phantom, tmp_path):
    taken = tmp_path / "taken"
    taken.write_text("mine")
    return run_palpate(*recover_arguments(phantom, taken / "out")), "taken"


TABLE = [(0, ok), (1, internal), (2, usage), (3, unreadable), (4, unusable), (5, meshing),
         (6, solving), (7, not_converged), (8, device), (9, time_limit), (9, cancelled), (10, output)]


@pytest.mark.parametrize("code, reach", TABLE, ids=lambda value: getattr(value, "__name__", value))
def test_is_reached(code, reach, phantom, tmp_path):
    finished, word = reach(phantom, tmp_path)

    assert finished.returncode == code, finished.stderr
    if word is not None:
        lines = finished.stderr.strip().splitlines()
        assert len(lines) == 1 and lines[0].startswith("palpate: ") and word in lines[0], finished.stderr
        assert not (tmp_path / "out").exists()


def test_the_table_is_what_is_documented():
    documented = set(map(int, re.findall(r"^\| (\d+) \|", (ROOT / "docs/errors.md").read_text(), re.M)))
    assert documented == set(range(11)) == {code for code, _ in TABLE}
    assert all(f"{code} " in run_palpate("--help").stdout for code in documented)
