# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Tetrahedra that conform to the organs: a graded lattice, moved to each surface where it is near and cut where it is not."""
from dataclasses import dataclass

import numpy as np

from .anatomy import directions_of_sphere
from .cutting import cut_along

KUHN = [(0, 1, 3, 7), (0, 1, 5, 7), (0, 2, 3, 7), (0, 2, 6, 7), (0, 4, 5, 7), (0, 4, 6, 7)]  # bits of a corner: x, y, z


@dataclass
class Mesh:
    points: np.ndarray  # (N, 3) mm
    cells: np.ndarray  # (M, 4) of positive volume
    regions: np.ndarray  # (M,) label of the organ, 0 elsewhere


def volumes(points, cells):
    """(M,) signed volumes, mm^3."""
    a, b, c, d = (points[cells[:, k]] for k in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6


def graded_axis(low, high, fine_low, fine_high, step, growth=1.3, longest=1.8):
    """Coordinates from low to high, mm: equal steps between fine_low and fine_high, growing ones outside."""
    def outwards(length):
        steps = [step * min(growth ** (k + 1), longest) for k in range(100)]
        places = np.concatenate([[0.0], np.cumsum(steps)])
        count = int(np.argmin(np.abs(places - length))) or 1
        return places[1:count + 1] * (length / places[count])

    middle = np.linspace(fine_low, fine_high, int(np.ceil((fine_high - fine_low) / step)) + 1)
    return np.concatenate([fine_low - outwards(fine_low - low)[::-1], middle, fine_high + outwards(high - fine_high)])


def lattice(xs, ys, zs):
    """Points and tetrahedra of a box: six round the diagonal of every cell."""
    points = np.stack(np.meshgrid(xs, ys, zs, indexing="ij"), axis=-1).reshape(-1, 3)
    index = np.arange(len(points)).reshape(len(xs), len(ys), len(zs))
    shape = [n - 1 for n in index.shape]
    corner = [index[x:x + shape[0], y:y + shape[1], z:z + shape[2]].ravel()
              for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    return points, turned(points, np.concatenate([np.stack([corner[k] for k in tet], axis=1) for tet in KUHN]))


def turned(points, cells):
    """The same cells, all with positive volume."""
    cells = cells.copy()
    wrong = volumes(points, cells) < 0
    cells[np.ix_(wrong, [2, 3])] = cells[np.ix_(wrong, [3, 2])]
    return cells


def ends_of(organ, margin=6.0):
    """(3,) lowest and highest coordinates of an organ with a margin, mm."""
    skin = organ.surface(directions_of_sphere(500))
    return skin.min(axis=0) - margin, skin.max(axis=0) + margin


def mesh_anatomy(anatomy, step):
    """Mesh of the whole box, hollow organs and bones included. step: edge of the lattice about the prostate, mm; it is
    fine as far as the back of the rectum and half way up the bladder, too."""
    fine_low, fine_high = ends_of(anatomy["prostate"])
    bladder, rectum = ends_of(anatomy["bladder"]), ends_of(anatomy["rectum"])
    fine_high = np.maximum(fine_high, [fine_high[0], rectum[1][1] - 4, (bladder[0][2] + bladder[1][2]) / 2])
    points, cells = lattice(*(graded_axis(*ends, step) for ends in zip(anatomy.low, anatomy.high, fine_low, fine_high)))
    on = np.zeros((len(points), 0), bool)  # which surfaces a point lies on
    for organ in anatomy.organs:
        points, cells, on = cut_along(points, cells, on, organ.level)
    cells = turned(points, cells)
    regions = np.zeros(len(cells), int)
    for k in reversed(range(len(anatomy.organs))):
        organ = anatomy.organs[k]
        corners = np.where(on[:, k], 0.0, organ.level(points))[cells]
        corner = corners[np.arange(len(cells)), np.abs(corners).argmax(axis=1)]
        flat = np.abs(corners).max(axis=1) == 0  # all four on the surface: the middle decides
        corner[flat] = organ.level(points[cells[flat]].mean(axis=1))
        regions[corner < 0] = organ.label
    return Mesh(points, cells, regions)
