# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""The true deformation of an anatomy: box and bones held, walls moved, everything else in equilibrium."""
from dataclasses import dataclass

import numpy as np

from .elasticity import Solid, curved_mesh
from .lattice import mesh_anatomy
from .loads import FAMILIES, organ_sign, wall_motion

BACKGROUND_KPA, BACKGROUND_RATIO, PROSTATE_RATIO = 10.0, 0.35, 0.40
SMALLEST_JACOBIAN = 0.15  # change of volume of a cell; loads that squeeze one further are scaled down


@dataclass
class Truth:
    solid: Solid
    regions: np.ndarray  # (M,)
    displacement: np.ndarray  # (N, 3) mm at solid.nodes
    load: dict


def nodes_of(solid, cells):
    """(N,) bool: nodes of the chosen cells (M,) bool."""
    chosen = np.zeros(solid.num_nodes, bool)
    chosen[solid.basis.element_dofs[:, cells].ravel()] = True
    return chosen


def smallest_jacobian(solid, displacement):
    """Smallest change of volume of any cell (mean of its points of integration; single points at the line where organs
    touch are singular), for scales 1, 0.95, ... of the displacement."""
    gradient = np.stack([solid.basis.interpolate(displacement[:, i]).grad for i in range(3)])  # (3, 3, M, Q)
    gradient = gradient.transpose(2, 3, 0, 1)
    scales = 0.95 ** np.arange(60)
    return scales, (np.linalg.det(np.eye(3) + s * gradient).mean(axis=1).min() for s in scales)


def build_solid(anatomy, stiffness_kpa, step):
    """Mesh and stiffness; hollow organs and bones are filled with tissue that only carries the map on."""
    mesh = mesh_anatomy(anatomy, step)
    curved, regions = curved_mesh(mesh.points, mesh.cells, mesh.regions, {o.label: o for o in anatomy.organs})
    return Solid(curved, *materials(regions, stiffness_kpa)), regions


def materials(regions, stiffness_kpa):
    """(M,) Young's moduli, kPa, and (M,) Poisson's ratios."""
    prostate = regions == 1
    return np.where(prostate, stiffness_kpa, BACKGROUND_KPA), np.where(prostate, PROSTATE_RATIO, BACKGROUND_RATIO)


def pressure_force(solid, cells):
    """(N, 3) forces, mN, of 1 kPa inside the chosen cells: the integral of the shape functions' gradients."""
    basis, force = solid.basis, np.zeros((solid.num_nodes, 3))
    for a in range(10):
        gradient = basis.basis[a][0].grad  # (3, M, Q)
        part = (gradient * basis.dx).sum(axis=2)[:, cells].T
        np.add.at(force, basis.element_dofs[a, cells], part)
    return force


def solve_truth(anatomy, seed, stiffness_kpa, family=None, step=6.0, size_mm=None):
    """The deformation of a seed. family: one of loads.FAMILIES or "mixed"; drawn if None, as size_mm (3 to 10) is."""
    random = np.random.default_rng([seed, 202])
    drawn, size = FAMILIES[random.integers(len(FAMILIES))], random.uniform(3, 10)
    family, size_mm = family or drawn, size_mm or size
    solid, regions = build_solid(anatomy, stiffness_kpa, step)
    nodes = solid.nodes
    organs = {o.label: o for o in anatomy.organs}
    fixed = (np.abs(nodes - anatomy.low) < 1e-6).any(axis=1) | (np.abs(nodes - anatomy.high) < 1e-6).any(axis=1)
    fixed |= nodes_of(solid, np.isin(regions, [k for k, o in organs.items() if o.role == "fixed"]))
    driven = [o for o in anatomy.organs if o.role == "driven"]
    hollow = np.isin(regions, [o.label for o in driven])
    tissue = nodes_of(solid, ~hollow)
    wall = tissue & nodes_of(solid, hollow)
    values, walls = np.zeros((solid.num_nodes, 3)), []
    if family == "pressure":
        force = np.zeros_like(values)
        for organ in driven:
            kpa = organ_sign(random) * random.uniform(0.3, 1)
            walls.append({"name": organ.name, "family": family, "relative_pressure": kpa})
            force += kpa * pressure_force(solid, regions == organ.label)
        moduli, ratios = materials(regions, stiffness_kpa)
        outside = Solid(solid.mesh, np.where(hollow, 0.0, moduli), ratios)
        values = outside.solve(fixed, values, force, free=tissue & ~fixed)
        values *= size_mm / np.linalg.norm(values[wall], axis=1).max()
    else:
        for organ in driven:
            at = wall & nodes_of(solid, regions == organ.label)
            own = family if family != "mixed" else FAMILIES[random.integers(len(FAMILIES) - 1)]
            share = random.uniform(0.6, 1)
            values[at] = wall_motion(own, organ, nodes[at], random, share * size_mm)
            walls.append({"name": organ.name, "family": own, "size_mm": share * size_mm})
    displacement = solid.solve(fixed | wall, values)
    for scale, jacobian in zip(*smallest_jacobian(solid, displacement)):
        if jacobian >= SMALLEST_JACOBIAN:
            break
    else:
        raise RuntimeError(f"the load of seed {seed} folds the tissue however small it is")
    displacement *= scale
    length = np.linalg.norm(displacement, axis=1)
    surface = nodes_of(solid, regions == 1) & nodes_of(solid, regions != 1)
    load = {"family": family, "size_mm": size_mm, "walls": walls, "scaled_by": float(scale),
            "smallest_jacobian": float(jacobian), "wall_motion_rms_mm": float(np.sqrt((length[wall] ** 2).mean())),
            "wall_motion_largest_mm": float(length[wall].max()),
            "prostate_surface_motion_rms_mm": float(np.sqrt((length[surface] ** 2).mean()))}
    return Truth(solid, regions, displacement, load)
