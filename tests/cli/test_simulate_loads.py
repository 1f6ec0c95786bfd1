# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""palpate simulate: obstacles with an end and pressures that follow, through the program."""
import json

import pytest

from tests.cli.test_simulate import BOX, MATERIAL, SMOOTH_BOX, rows_of, simulated, uniaxial
from tests.vtu import read_arrays


def test_a_punch_wider_than_the_body_presses_as_a_plate_does(tmp_path):
    forces = {}
    for shape, more in {"plane": "", "punch": "radius_mm = 30\nedge_radius_mm = 2\n",
                        "tube": "hole_radius_mm = 1e-3\nedge_radius_mm = 1e-3\nouter_radius_mm = 30\n"}.items():
        (tmp_path / shape).mkdir()
        out = simulated(tmp_path / shape, BOX + MATERIAL + SMOOTH_BOX + f"""
[[obstacle]]
name = "tool"
shape = "{shape}"
place_mm = [2.1, 1.6, 5]
direction = [0, 0, -1]
motion_mm = [0, 0, -0.5]
where = {{side = "z-max"}}
""" + more)
        forces[shape] = rows_of(out)[-1]["tool_z_mn"]
        record = json.loads((out / "simulation.json").read_text())["settings"]["obstacles"][0]
        assert record["shape"] == shape
        assert record["edge_radius_mm"] == {"plane": None, "punch": 2, "tube": 1e-3}[shape]
    assert forces["punch"] == pytest.approx(forces["plane"], rel=1e-12)
    assert forces["tube"] == pytest.approx(forces["plane"], rel=1e-12)


def test_a_following_pressure_acts_on_the_area_as_it_is(tmp_path):
    """A box that is pulled by suction gets thinner: nominal stress = kpa (sides' stretch)^2."""
    load = '[[pressure]]\nkpa = -3\nwhere = {side = "z-max"}\n'
    stretches = {}
    for name, more in {"follows": "follows = true\n", "stays": ""}.items():
        (tmp_path / name).mkdir()
        out = simulated(tmp_path / name, BOX + MATERIAL + SMOOTH_BOX + load + more)
        moved = read_arrays(out / "state_0001.vtu")["displacement"]
        stretches[name] = 1 + moved[:, 2].max() / 5, 1 + moved[:, 0].min() / 4
        record = json.loads((out / "simulation.json").read_text())["settings"]
        assert any(item["follows"] == (name == "follows") for item in record["forces"]
                   if item["kind"] == "pressure")
    for name, area in {"follows": stretches["follows"][1] ** 2, "stays": 1}.items():
        stretch, side = stretches[name]
        stress, expected_side = uniaxial(stretch)
        assert side == pytest.approx(expected_side, rel=1e-6)
        assert stress == pytest.approx(3 * area, rel=1e-6)
    assert stretches["follows"][0] < stretches["stays"][0]
