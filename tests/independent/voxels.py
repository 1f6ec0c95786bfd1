# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Label volumes of an anatomy at rest and deformed, drawn exactly or as people draw."""
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import map_coordinates

from .contours import contour_shift

COARSE_MM = 4.0  # lattice on which the way back is found first


@dataclass
class Grid:
    """Voxel centres are origin + index * spacing, mm, axes along x, y, z."""
    origin: np.ndarray
    spacing: np.ndarray
    shape: tuple

    def centres(self, index):
        return self.origin + np.asarray(index) * self.spacing


def grid_of(anatomy, spacing):
    """The grid whose voxels fill the box."""
    spacing = np.asarray(spacing, float)
    shape = np.ceil((anatomy.high - anatomy.low) / spacing - 1e-9).astype(int)
    return Grid((anatomy.low + anatomy.high - (shape - 1) * spacing) / 2, spacing, tuple(int(n) for n in shape))


def first_guess(field, grid):
    """(voxels, 3) about where each voxel's tissue came from: exact on a coarse lattice, linear between."""
    ends = grid.centres(np.array(grid.shape) - 1)
    counts = np.ceil((ends - grid.origin) / COARSE_MM).astype(int) + 1
    axes = [np.linspace(a, b, n) for a, b, n in zip(grid.origin, ends, counts)]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    shift = (field.origin(places.reshape(-1, 3))[0] - places.reshape(-1, 3)).reshape(places.shape)
    index = np.stack(np.meshgrid(*(np.arange(n) * (m - 1) / max(n - 1, 1) for n, m in zip(grid.shape, counts)),
                                 indexing="ij")).reshape(3, -1)
    centres = grid.centres(np.indices(grid.shape).reshape(3, -1).T)
    return centres + np.stack([map_coordinates(shift[..., k], index, order=1) for k in range(3)], axis=1)


def draw_labels(anatomy, grid, drawing, random, field=None):
    """uint8 labels (shape); field: the deformation, None for the anatomy at rest. Also the largest error of the way
    back near a surface, mm."""
    centres = grid.centres(np.indices(grid.shape).reshape(3, -1).T)
    points = centres.copy() if field is None else first_guess(field, grid)
    band = 4 * drawing.sd_mm + 2.5  # mm from a surface within which a voxel may change its label
    levels = [organ.level(points) for organ in anatomy.organs]
    near = np.flatnonzero(np.min([np.abs(level) / 1.5 for level in levels], axis=0) < band)
    error, back = 0.0, None
    if field is not None:
        points[near], gradient, left = field.origin(centres[near], points[near])
        back = np.linalg.inv(gradient)
        error = float(np.quantile(left, 0.9999))
    labels = np.zeros(len(points), np.uint8)
    for organ, level in zip(reversed(anatomy.organs), reversed(levels)):
        slope = organ.slope(points[near])
        if back is not None:
            slope = np.einsum("ni,nij->nj", slope, back)  # of the level in the deformed state
        size = np.maximum(np.linalg.norm(slope, axis=1), 1e-9)
        level[near] = organ.level(points[near]) / size
        level[near] -= shift_near(drawing, random, grid, near, slope / size[:, None])
        labels[level < 0] = organ.label
    return labels.reshape(grid.shape), error


def shift_near(drawing, random, grid, near, normals):
    """(len(near),) mm by which the contour lies outside at the voxels near it."""
    if drawing.sd_mm == 0:
        return np.zeros(len(near))
    full = np.zeros((int(np.prod(grid.shape)), 3), np.float32)
    full[near] = normals
    return contour_shift(drawing, random, grid.shape, grid.spacing, full.reshape(*grid.shape, 3)).ravel()[near]
