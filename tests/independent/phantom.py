# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""One phantom from its seed and settings."""
from dataclasses import asdict

import numpy as np

from . import truth as physics
from .anatomy import draw_anatomy
from .contours import draw_drawing
from .field import Field
from .voxels import draw_labels, grid_of
from .write import settings_of, write_phantom


def draw_stiffness(seed):
    """kPa, log-uniform from 30 to 300."""
    return float(np.exp(np.random.default_rng([seed, 404]).uniform(np.log(30), np.log(300))))


def make_phantom(out, seed, stiffness_kpa=None, kind=None, load=None, size_mm=None, contours="exact",
                 spacing=(1.0, 1.0, 1.0), step=6.0):
    """Writes the phantom's folder and returns what truth.json holds. What is None is drawn from the seed, and the same
    seed has the same anatomy, load and stiffness whatever the contours and voxels are. step: edge of the lattice, mm."""
    stiffness_kpa = stiffness_kpa or draw_stiffness(seed)
    anatomy = draw_anatomy(seed, kind)
    truth = physics.solve_truth(anatomy, seed, stiffness_kpa, load, step, size_mm)
    field = Field(truth.solid, truth.displacement, anatomy.low, anatomy.high)
    grid, drawing = grid_of(anatomy, spacing), draw_drawing(seed, contours)
    reference, _ = draw_labels(anatomy, grid, drawing, np.random.default_rng([seed, 505]))
    target, error = draw_labels(anatomy, grid, drawing, np.random.default_rng([seed, 606]), field)
    told = {"generator": "independent", "seed": seed, "frame": "LPS, mm", "anatomy": anatomy.kind,
            "stiffness_kpa": {"prostate": stiffness_kpa, "background": physics.BACKGROUND_KPA},
            "poisson_ratio": {"prostate": physics.PROSTATE_RATIO, "background": physics.BACKGROUND_RATIO},
            "load": truth.load, "contours": asdict(drawing), "spacing_mm": [float(s) for s in spacing],
            "mesh": {"lattice_mm": step, "nodes": int(truth.solid.num_nodes), "tetrahedra": len(truth.regions),
                     "element": "curved tet10"}, "way_back_error_mm": error}
    settings = settings_of(anatomy, physics.BACKGROUND_KPA, physics.BACKGROUND_RATIO, physics.PROSTATE_RATIO)
    write_phantom(out, grid, reference, target, settings, told)
    return told
