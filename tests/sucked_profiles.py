# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Profiles of sucked tissue that `palpate simulate` makes, as tables for `palpate aspirate fit`."""
import numpy

from tests.conftest import run_palpate
from tests.vtu import read_arrays

HOLE_MM, EDGE_MM, CAP_MM = 5.0, 0.2, 1.0
CYCLE_S, CYCLE_MBAR = [0, 0.2, 3.7, 6.7, 9.7, 12], [0, 0, 60, 60, 0, 0]

MODEL = """[mesh]
formulation = "axisymmetric"
volume = "element-mean"
[mesh.graded]
width_mm = 20
depth_mm = 20
edge_mm = 5.2
surface_x_mm = {x}
surface_y_mm = {y}
[[material]]
law = "veronda-westmann"
mu_kpa = {mu}
gamma = {gamma}
kappa_kpa = 8000
relaxation = [{relaxation}]
[[fix]]
where = {{side = "y-min"}}
[[fix]]
where = {{side = "x-max"}}
components = "x"
[[obstacle]]
name = "tube"
shape = "tube"
place_mm = [0, 0]
direction = [0, -1]
hole_radius_mm = 5
edge_radius_mm = 0.2
outer_radius_mm = 10
stiffness_kpa_per_mm = 8000
where = {{point_array = "surface"}}
[[pressure]]
where = {{point_array = "surface", to_mm = [5.2001, 100]}}
kpa = -6
follows = true
column = "share"
[history]
time_s = {times}
share = {shares}
"""


def make(folder, step_s, *, mu=0.7, gamma=10, terms=((0.4, 3),), sd_mm=0.003, seed=1, rate_hz=10):
    """Writes profiles.csv and pressure.csv of a cycle of 12 s; film and readings have one clock.

    terms: amplitude and time, s, of each relaxation term.
    """
    x = numpy.linspace(0, HOLE_MM + EDGE_MM, 27)
    y = CAP_MM * numpy.clip(1 - (x / HOLE_MM) ** 2, 0, None) ** 1.25
    away = numpy.clip(HOLE_MM + EDGE_MM - x, 0, EDGE_MM)
    edge = EDGE_MM - numpy.sqrt(EDGE_MM**2 - away**2)
    y = numpy.where(x > HOLE_MM, numpy.minimum(y, edge), y)
    begin = 0.2
    # shorter steps behind each kink of the cycle
    times = numpy.append(numpy.arange(begin + step_s, CYCLE_S[-1], step_s), CYCLE_S[2:])
    for kink in CYCLE_S[1:-1]:
        times = numpy.append(times, kink + step_s * numpy.array([0.1, 0.25, 0.5]))
    times = numpy.unique(numpy.round(times, 6))
    shares = numpy.interp(times, CYCLE_S, CYCLE_MBAR) / max(CYCLE_MBAR)
    words = lambda values: "[" + ", ".join(f"{value:.6g}" for value in values) + "]"
    (folder / "truth.toml").write_text(MODEL.format(
        x=words(x), y=words(y), mu=mu, gamma=gamma, times=words(times - begin),
        shares=words(shares),
        relaxation=", ".join(f"{{amplitude = {amplitude}, time_s = {tau}}}" for amplitude, tau in terms)))
    finished = run_palpate("simulate", folder / "truth.toml", "--out", folder / "truth", "--quiet")
    assert finished.returncode == 0, finished.stderr
    columns = numpy.arange(-79, 80) * 0.0629
    films = []
    for state in sorted((folder / "truth").glob("state_*.vtu")):  # the first is at rest
        arrays = read_arrays(state)
        points = next(array for name, array in arrays.items() if name.lower() == "points")
        rest, places = points, points + arrays["displacement"]
        num_surface = int(numpy.argmax(numpy.diff(rest[:, 0]) < 0)) + 1
        films.append(numpy.interp(numpy.abs(columns), places[:num_surface, 0], places[:num_surface, 1]))
    films, solved = numpy.array(films), numpy.append(begin, times)
    random = numpy.random.default_rng(seed)
    rows = ["time_s,r_mm,z_mm,sd_mm,flag"]
    for time in numpy.arange(0, CYCLE_S[-1] + 1e-9, 1 / rate_hz):
        for k, r in enumerate(columns):
            z = numpy.interp(time, solved, films[:, k])
            if z < 0.5:
                rows.append(f"{time:.4f},{r:.4f},0.25,0.14,2")
            else:
                rows.append(f"{time:.4f},{r:.4f},{z + random.normal(0, sd_mm):.5f},{sd_mm},0")
    (folder / "profiles.csv").write_text("\n".join(rows) + "\n")
    (folder / "pressure.csv").write_text(
        "time_s,suction_mbar\n" + "".join(f"{time},{mbar}\n" for time, mbar in zip(CYCLE_S, CYCLE_MBAR)))
    return folder
