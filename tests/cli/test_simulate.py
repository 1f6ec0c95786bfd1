# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""palpate simulate: closed forms, what is written, and a clear sentence for each mistake."""
import csv
import json
import math
import re

import numpy
import pytest

from tests.conftest import ROOT, run_palpate
from tests.vtu import read_arrays

E_KPA, NU = 10.0, 0.3
MU = E_KPA / (2 * (1 + NU))
LAMBDA = E_KPA * NU / ((1 + NU) * (1 - 2 * NU))

MATERIAL = f"""
[[material]]
law = "neo-hookean"
stiffness_kpa = {E_KPA}
poisson_ratio = {NU}
"""
BOX = "[mesh]\nbox = {size_mm = [4, 3, 5], divisions = [2, 2, 2]}\n"
SMOOTH_BOX = """
[[fix]]
name = "bottom"
where = {side = "z-min"}
components = "z"
[[fix]]
where = {side = "x-min"}
components = "x"
[[fix]]
where = {side = "y-min"}
components = "y"
"""
TOP = """
[[move]]
name = "top"
where = {side = "z-max"}
z_mm = 1.0
"""


def simulate(folder, text, *more):
    """Writes the model and runs it; the finished process and the result folder."""
    model = folder / "model.toml"
    model.write_text(text)
    out = folder / "out"
    return run_palpate("simulate", model, "--out", out, "--quiet", *more), out


def simulated(folder, text):
    finished, out = simulate(folder, text)
    assert finished.returncode == 0, finished.stderr
    return out


def rows_of(out):
    return [{name: float(value) for name, value in row.items()}
            for row in csv.DictReader((out / "reactions.csv").open())]


def root_of(function, low, high):
    """By bisection; the function rises through zero between the two."""
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if function(middle) < 0 else (low, middle)
    return (low + high) / 2


def neo_hookean(stretch, log_volume):
    """First Piola stress along a principal stretch of mu/2 (I1 - 3 - 2 ln J) + lambda/2 (ln J)^2."""
    return MU * (stretch - 1 / stretch) + LAMBDA * log_volume / stretch


def free_side(stretch, sides):
    """The stretch of `sides` equal free directions beside a given one."""
    return root_of(lambda t: neo_hookean(t, math.log(stretch * t**sides)), 0.2, 3)


def uniaxial(stretch):
    side = free_side(stretch, 2)
    return neo_hookean(stretch, math.log(stretch * side * side)), side


def test_a_stretched_box_follows_the_closed_form(tmp_path):
    out = simulated(tmp_path, BOX + MATERIAL + SMOOTH_BOX + TOP + "[newton]\nload_steps = 5\n")

    rows = rows_of(out)
    assert [row["load"] for row in rows] == pytest.approx([0, 0.2, 0.4, 0.6, 0.8, 1])
    for row in rows[1:]:
        stress, _ = uniaxial(1 + row["load"] / 5)
        assert row["top_z_mn"] == pytest.approx(12 * stress, rel=1e-8)
        assert row["bottom_z_mn"] == pytest.approx(-12 * stress, rel=1e-8)
    stress, side = uniaxial(1.2)
    state = read_arrays(out / "state_0005.vtu")
    assert state["displacement"][:, 0] == pytest.approx((side - 1) * state["Points"][:, 0], abs=1e-8)
    assert state["displacement"][:, 2] == pytest.approx(0.2 * state["Points"][:, 2], abs=1e-8)
    cauchy = stress / side**2
    assert state["cauchy_stress_kpa"][:, 2] == pytest.approx(cauchy, rel=1e-7)
    assert state["von_mises_kpa"] == pytest.approx(cauchy, rel=1e-6)
    assert state["volume_ratio"] == pytest.approx(1.2 * side**2, rel=1e-9)
    energy = MU / 2 * (1.44 + 2 * side**2 - 3 - 2 * math.log(1.2 * side**2))
    energy += LAMBDA / 2 * math.log(1.2 * side**2)**2
    assert state["energy_density_kpa"] == pytest.approx(energy, rel=1e-7)
    assert state["reaction"][:, 2].max() > 0


def test_a_held_strain_relaxes_exponentially(tmp_path):
    amplitude, tau, ramp = 0.8, 2.0, 1e-4
    times = [ramp, 0.5, 1.0, 2.0, 4.0, 8.0]
    text = BOX.replace("[mesh]", '[mesh]\nvolume = "pointwise"') + """
[[material]]
law = "linear"
stiffness_kpa = 10
poisson_ratio = 0.3
relaxation = [{amplitude = 0.8, time_s = 2.0}]
relaxation_of = "total"
""" + SMOOTH_BOX + TOP + f'column = "pull"\n[history]\ntime_s = {times}\npull = {[1] * 6}\n'
    rows = rows_of(simulated(tmp_path, text))

    long_term = 12 * 10 * 0.2
    for row in rows[1:]:
        since = row["time_s"] - ramp / 2
        expected = long_term * (1 + amplitude * math.exp(-since / tau))
        assert row["top_z_mn"] == pytest.approx(expected, rel=1e-6)


def test_by_default_the_volume_stays_elastic_while_the_rest_relaxes(tmp_path):
    amplitude, tau, shear, bulk = 0.8, 2.0, 10 / 2.6, 10 / 1.2
    text = BOX.replace("[mesh]", '[mesh]\nvolume = "pointwise"') + """
[[material]]
law = "linear"
stiffness_kpa = 10
poisson_ratio = 0.3
relaxation = [{amplitude = 0.8, time_s = 2.0}]
""" + SMOOTH_BOX + TOP + """column = "pull"
[history]
time_s = [1e-4, 8]
pull = [1, 1]
longest_step_s = 0.1
"""
    rows = rows_of(simulated(tmp_path, text))

    # E + (E0 - E) exp(-t / tau'): the shear modulus relaxes, the bulk modulus does not
    sudden = 9 * bulk * 1.8 * shear / (3 * bulk + 1.8 * shear)
    longer = tau * (3 * bulk + (1 + amplitude) * shear) / (3 * bulk + shear)
    for row in rows[1:]:
        expected = 12 * 0.2 * (10 + (sudden - 10) * math.exp(-row["time_s"] / longer))
        assert row["top_z_mn"] == pytest.approx(expected, rel=2e-4)


def test_loads_of_a_file_are_those_of_lists(tmp_path):
    (tmp_path / "loads.csv").write_text("# ramp and hold\ntime_s,pull\n0,0\n1,0.5\n3,1\n")
    body = BOX + MATERIAL.rstrip() + "\nrelaxation = [{amplitude = 1, time_s = 1}]\n" + SMOOTH_BOX
    pulled = body + TOP + 'column = "pull"\n[history]\n'
    (tmp_path / "a").mkdir()
    from_file = rows_of(simulated(tmp_path, pulled + 'file = "loads.csv"\nlongest_step_s = 1\n'))
    from_lists = rows_of(simulated(tmp_path / "a", pulled + "time_s = [1, 2, 3]\n"
                                   "pull = [0.5, 0.75, 1]\n"))

    assert from_file == from_lists
    assert len(from_file) == 4


@pytest.mark.parametrize("quadratic", ["false", "true"])
def test_plane_stress_is_thin(tmp_path, quadratic):
    mesh = f"""[mesh]
formulation = "plane-stress"
thickness_mm = 0.5
quadratic = {quadratic}
rectangle = {{size_mm = [6, 4], divisions = [3, 2], element = "tri3"}}
"""
    loads = """
[[fix]]
where = {side = "x-min"}
components = "x"
[[fix]]
where = {side = "y-min"}
components = "y"
[[move]]
name = "right"
where = {side = "x-max"}
x_mm = 1.2
"""
    out = simulated(tmp_path, mesh + MATERIAL + loads)

    stress, side = uniaxial(1.2)
    assert rows_of(out)[-1]["right_x_mn"] == pytest.approx(2 * stress, rel=1e-8)
    state = read_arrays(out / "state_0001.vtu")
    assert state["displacement"][:, 1].min() == pytest.approx(4 * (side - 1), rel=1e-6)
    assert state["volume_ratio"] == pytest.approx(1.2 * side**2, rel=1e-7)


@pytest.mark.parametrize("volume", ["pointwise", "element-mean"])
def test_an_axisymmetric_cylinder_is_turned_all_the_way_round(tmp_path, volume):
    mesh = f"""[mesh]
formulation = "axisymmetric"
volume = "{volume}"
rectangle = {{size_mm = [3, 6], divisions = [3, 4]}}
"""
    loads = """
[[fix]]
where = {side = "y-min"}
components = "y"
[[move]]
name = "top"
where = {side = "y-max"}
y_mm = -0.9
"""
    out = simulated(tmp_path, mesh + MATERIAL + loads)

    stress, side = uniaxial(0.85)
    assert rows_of(out)[-1]["top_y_mn"] == pytest.approx(math.pi * 9 * stress, rel=1e-8)
    assert rows_of(out)[-1]["top_x_mn"] == 0
    state = read_arrays(out / "state_0001.vtu")
    assert state["displacement"][:, 0].max() == pytest.approx(3 * (side - 1), rel=1e-6)


def test_pressure_traction_and_force_push_alike(tmp_path):
    forces = []
    for name, load in {"pressure": "[[pressure]]\nkpa = 0.6", "force": "[[traction]]\nkpa = [0, 0, -0.6]"
                       }.items():
        (tmp_path / name).mkdir()
        out = simulated(tmp_path / name,
                        BOX + MATERIAL + SMOOTH_BOX + load + '\nwhere = {side = "z-max"}\n')
        forces.append(rows_of(out)[-1]["bottom_z_mn"])

    assert forces == pytest.approx([0.6 * 12, 0.6 * 12], rel=1e-9)


def test_a_rigid_plate_presses_as_a_moved_side_does(tmp_path):
    """A smooth plate on top: the force is that of the closed form, but for the depth it sinks in."""
    text = BOX + MATERIAL + SMOOTH_BOX + """
[[obstacle]]
name = "plate"
shape = "plane"
place_mm = [0, 0, 5]
direction = [0, 0, -1]
motion_mm = [0, 0, -0.5]
where = {side = "z-max"}
"""
    out = simulated(tmp_path, text)

    row = rows_of(out)[-1]
    state = json.loads((out / "simulation.json").read_text())["states"][-1]
    depth = state["depth_in_obstacle_mm"]["plate"]
    assert 0 < depth < 0.02
    stress, _ = uniaxial((4.5 + depth) / 5)
    assert row["plate_z_mn"] == pytest.approx(12 * stress, rel=1e-6)
    assert row["bottom_z_mn"] == pytest.approx(-row["plate_z_mn"], rel=1e-6)


def test_a_mesh_of_a_file_gives_the_answer_of_the_grid_it_holds(tmp_path):
    grid = simulated(tmp_path, BOX + MATERIAL + SMOOTH_BOX + TOP)
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "mesh.vtu").write_bytes((grid / "state_0000.vtu").read_bytes())
    material = MATERIAL.rstrip() + "\nregion = 1\n"
    again = simulated(tmp_path / "b", '[mesh]\nfile = "mesh.vtu"\n' + material + SMOOTH_BOX + TOP)

    assert rows_of(again)[-1]["top_z_mn"] == pytest.approx(rows_of(grid)[-1]["top_z_mn"], rel=1e-10)


def test_a_mesh_of_a_file_may_be_in_metres(tmp_path):
    (tmp_path / "mesh.vtk").write_text(
        "# vtk DataFile Version 3.0\nm\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n"
        "0 0 0 0.01 0 0 0 0.01 0 0 0 0.01\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n")
    out = simulated(tmp_path, '[mesh]\nfile = "mesh.vtk"\nunit = "m"\n' + MATERIAL +
                    '[[fix]]\nwhere = {side = "z-min"}\n'
                    '[[move]]\nwhere = {from_mm = [0, 0, 10]}\nz_mm = 1\n')

    assert read_arrays(out / "state_0001.vtu")["Points"].max() == 10


def test_the_folder_holds_a_series_a_page_and_a_record(tmp_path):
    out = simulated(tmp_path, 'title = "Pull"\n' + BOX + MATERIAL + SMOOTH_BOX + TOP +
                    "[newton]\nload_steps = 2\n")

    assert sorted(entry.name for entry in out.iterdir()) == [
        "reactions.csv", "report.html", "simulation.json", "simulation.pvd", "state_0000.vtu",
        "state_0001.vtu", "state_0002.vtu"]
    series = re.findall(r'timestep="([^"]+)".*file="([^"]+)"', (out / "simulation.pvd").read_text())
    assert series == [("0", "state_0000.vtu"), ("0.5", "state_0001.vtu"), ("1", "state_0002.vtu")]
    record = json.loads((out / "simulation.json").read_text())
    assert record["converged"] is True and record["title"] == "Pull"
    assert record["settings"]["materials"][0]["stiffness_kpa"] == E_KPA
    assert record["settings"]["newton"]["relative_tolerance"] == 1e-9
    assert [step["converged"] for step in record["steps"]] == [True, True]
    assert record["steps"][0]["newton"][-1]["relative_residual"] <= 1e-9
    assert str(tmp_path) not in (out / "simulation.json").read_text()
    page = (out / "report.html").read_text()
    assert "<h1>Pull</h1>" in page and page.count("<svg") == 7 and "surface-viewer" in page and "://" not in page


@pytest.mark.parametrize("backend", ["auto", "reference", "opencl"])
def test_the_result_says_who_solved_and_gives_the_same_forces(tmp_path, backend):
    text = BOX.replace("[2, 2, 2]", "[14, 14, 14]") + MATERIAL + SMOOTH_BOX + TOP
    if backend == "opencl" and "opencl" not in run_palpate("devices").stdout.lower():
        pytest.skip("this machine has no OpenCL device")

    finished, out = simulate(tmp_path, text, "--backend", backend)

    assert finished.returncode == 0, finished.stderr
    record = json.loads((out / "simulation.json").read_text())
    solver, loops = record["linear_solver"], record["element_loops"]
    if backend == "reference":
        assert solver["method"] == "direct" and loops["device"] == "host"
    if backend == "opencl":
        assert solver["method"] == "multigrid" and solver["backend"] == loops["backend"] == "opencl"
    assert solver["reason"] and loops["reason"]
    stress, _ = uniaxial(1.2)
    assert record["states"][-1]["force_mn"]["top"][2] == pytest.approx(12 * stress, rel=1e-6)


def test_a_back_end_that_is_not_there_is_a_mistake(tmp_path):
    text = BOX + MATERIAL + SMOOTH_BOX + TOP
    finished, out = simulate(tmp_path, text, "--backend", "opencl", "--device", "no such device")

    assert finished.returncode == 8 and "no such device" in finished.stderr
    assert not out.exists()


def test_the_same_model_gives_the_same_numbers(tmp_path):
    texts = []
    for name in "ab":
        (tmp_path / name).mkdir()
        out = simulated(tmp_path / name, BOX + MATERIAL + SMOOTH_BOX + TOP)
        texts.append([(out / file).read_bytes() for file in ("reactions.csv", "state_0001.vtu")])
    assert texts[0] == texts[1]


def test_what_does_not_converge_is_written_flagged_and_has_its_exit_code(tmp_path):
    text = BOX + MATERIAL + SMOOTH_BOX + TOP.replace("1.0", "-6.0") + "[newton]\nload_steps = 3\n"
    finished, out = simulate(tmp_path, text)

    assert finished.returncode == 7, finished.stderr
    assert "NOT converge" in finished.stdout
    record = json.loads((out / "simulation.json").read_text())
    assert record["converged"] is False and "NOT converge" in record["message"]
    reached = rows_of(out)[-1]["load"]
    assert 1 / 3 <= reached < 5 / 6
    last = read_arrays(out / record["states"][-1]["file"])
    assert last["displacement"][:, 2].min() == pytest.approx(-6 * reached, rel=1e-9)
    assert numpy.isfinite(last["cauchy_stress_kpa"]).all()
    assert "Not converged." in (out / "report.html").read_text()


MODEL = BOX + MATERIAL + SMOOTH_BOX + TOP
MISTAKES = {
    "not TOML": (MODEL + "[mesh\n", 3, ["model.toml, line", "not valid TOML"]),
    "a misspelt table": (MODEL.replace("[[move]]", "[[mov]]"), 2, ["'mov'", "'move'"]),
    "a misspelt key": (MODEL.replace("z_mm", "z_mn"), 2, ["line 23", "[[move]]", "'z_mn'", "'z_mm'"]),
    "an unknown law": (MODEL.replace('"neo-hookean"', '"jelly"'), 2, ["line 5", "jelly", "linear"]),
    "a parameter out of range": (MODEL.replace("= 0.3", "= 0.6"), 2,
                                 ["line 7", "'poisson_ratio' is 0.6", "below 0.5"]),
    "a missing parameter": (MODEL.replace("poisson_ratio", "# poisson_ratio"), 2,
                            ["'poisson_ratio' is missing", "Poisson's ratio"]),
    "a selection of nothing": (MODEL.replace('side = "z-max"', "from_mm = [9, 9, 9]"), 2,
                               ["line 22", "no node", "(4, 3, 5)"]),
    "a point array that is not there": (MODEL.replace('side = "z-max"', 'point_array = "wall"'), 2,
                                        ["'point_array'", "wall"]),
    "two contradicting supports": (MODEL.replace('side = "z-max"', 'side = "z-min"'), 2,
                                   ["'bottom'", "component z"]),
    "a column without history": (MODEL + 'column = "pull"\n', 2, ["'column'", "[history]"]),
    "a missing mesh": (MODEL.replace(BOX, '[mesh]\nfile = "no.vtu"\n'), 3, ["no.vtu", "no such file"]),
    "a damaged mesh": (MODEL.replace(BOX, '[mesh]\nfile = "model.vtu"\n'), 3, ["model.vtu"]),
    "a rim narrower than its edges": (MODEL + """
[[obstacle]]
shape = "tube"
place_mm = [0, 0, 6]
direction = [0, 0, -1]
hole_radius_mm = 1
edge_radius_mm = 0.3
outer_radius_mm = 1.5
""", 2, ["line 31", "'outer_radius_mm' is 1.5", "1.6 mm", "rim is narrower"]),
    "no supports that are known": (MODEL.replace("x-min", "left"), 2, ["'side'", "left", "x-min"]),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_one_sentence_that_names_it_and_leaves_nothing_behind(tmp_path, mistake):
    text, code, words = MISTAKES[mistake]
    (tmp_path / "model.vtu").write_text("<VTKFile>")
    finished, out = simulate(tmp_path, text)

    assert finished.returncode == code, finished.stderr
    lines = finished.stderr.strip().splitlines()
    assert len(lines) == 1 and lines[0].startswith("palpate: "), finished.stderr
    for word in words:
        assert word in lines[0], lines[0]
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["model.toml", "model.vtu"]


def test_a_missing_model_is_named(tmp_path):
    finished = run_palpate("simulate", tmp_path / "nowhere.toml", "--out", tmp_path / "out")
    assert finished.returncode == 3 and "nowhere.toml" in finished.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_body_that_nothing_holds_is_reported(tmp_path):
    finished, out = simulate(tmp_path, BOX + MATERIAL +
                             '[[force]]\nwhere = {side = "z-max"}\ntotal_mn = [0, 0, 5]\n')
    assert finished.returncode == 7, finished.stderr
    assert (out / "state_0000.vtu").exists() and not (out / "state_0001.vtu").exists()


def test_an_existing_folder_is_kept_unless_it_is_a_result_to_overwrite(tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "mine.txt").write_text("keep")
    for more in ([], ["--overwrite"]):
        finished, out = simulate(tmp_path, MODEL, *more)
        assert finished.returncode == 10 and str(out) in finished.stderr
        assert [entry.name for entry in out.iterdir()] == ["mine.txt"]
    (tmp_path / "out" / "mine.txt").unlink()
    (tmp_path / "out").rmdir()
    assert simulate(tmp_path, MODEL)[0].returncode == 0
    assert simulate(tmp_path, MODEL)[0].returncode == 10
    assert simulate(tmp_path, MODEL, "--overwrite")[0].returncode == 0


@pytest.mark.parametrize("example", sorted((ROOT / "examples" / "simulate").glob("*.toml")),
                         ids=lambda path: path.stem)
def test_every_example_runs_as_it_is(tmp_path, example):
    finished = run_palpate("simulate", example, "--out", tmp_path / "out", "--quiet")
    assert finished.returncode == 0, finished.stderr
    assert "equilibrium" in finished.stdout
