# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""palpate simulate with inertia."""
import json
import math

import pytest

from tests.cli.test_simulate import MODEL, rows_of, simulate, simulated


def test_a_bar_that_is_pulled_suddenly_swings_with_its_own_period(tmp_path):
    """A bar that is pulled suddenly gets twice its static elongation after half a period
    4 L sqrt(rho / E)."""
    density, modulus, length = 1000.0, 10.0, 20.0  # kg/m^3, kPa, mm
    period_s = 4 * length * 1e-3 * math.sqrt(density / (modulus * 1e3))
    times = [1e-6 * period_s] + [k / 40 * period_s for k in range(1, 41)]
    text = f"""
[mesh]
box = {{size_mm = [1, 1, {length}], divisions = [1, 1, 40]}}
[[material]]
law = "linear"
stiffness_kpa = {modulus}
poisson_ratio = 0
[[fix]]
name = "wall"
where = {{side = "z-min"}}
[[traction]]
where = {{side = "z-max"}}
kpa = [0, 0, 0.02]
column = "pull"
[history]
time_s = {times}
pull = {[1] * 41}
[dynamics]
density_kg_per_m3 = {density}
"""
    out = simulated(tmp_path, text)

    record = json.loads((out / "simulation.json").read_text())
    assert record["kind"] == "motion" and record["settings"]["dynamics"]["steps"] > 100
    lengths = [state["largest_displacement_mm"] for state in record["states"]]
    static = length * 0.02 / modulus
    assert max(lengths) == pytest.approx(2 * static, rel=0.05)
    assert record["states"][lengths.index(max(lengths))]["time"] == pytest.approx(period_s / 2, rel=0.06)
    assert lengths[-1] < 0.1 * static  # back where it was
    forces = [row["wall_z_mn"] for row in rows_of(out)]
    assert min(forces) == pytest.approx(-2 * 0.02, rel=0.2)  # the wave that is thrown back
    assert "Energies over time" in (out / "report.html").read_text()


def test_a_motion_needs_a_history(tmp_path):
    finished, _ = simulate(tmp_path, MODEL + "[dynamics]\n")
    assert finished.returncode == 2 and "[history]" in finished.stderr
