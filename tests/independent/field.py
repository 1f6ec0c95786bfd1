# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Displacement at any point, and which point came to a given place."""
import numpy as np
from scipy.spatial import cKDTree

from .elasticity import shape_slopes, shape_values


class Field:
    """Quadratic displacement on a curved mesh; 0 outside the box."""

    def __init__(self, solid, displacement, low, high):
        self.places, self.displacement, self.dofs = solid.nodes, displacement, solid.basis.element_dofs
        self.low, self.high = low, high
        self.tree = cKDTree(self.places[self.dofs[:4]].mean(axis=0))
        self.neighbours = neighbours_of(solid.mesh)

    def local(self, cells, points, rounds=4):
        """(N, 3) local coordinates of points in given cells, by Newton's method from those of the straight cell."""
        nodes = self.places[self.dofs[:, cells]].transpose(1, 0, 2)  # (N, 10, 3)
        edges = (nodes[:, 1:4] - nodes[:, :1]).transpose(0, 2, 1)
        local = np.linalg.solve(edges, (points - nodes[:, 0])[:, :, None])[:, :, 0]
        near = (local > -0.5).all(axis=1) & (local.sum(axis=1) < 1.5)  # elsewhere the curved map means nothing
        for _ in range(rounds):
            spot = local[near]
            error = points[near] - np.einsum("na,nai->ni", shape_values(spot), nodes[near])
            slopes = np.einsum("naj,nai->nij", shape_slopes(spot), nodes[near])
            local[near] += np.linalg.solve(slopes, error[:, :, None])[:, :, 0]
        return local

    def locate(self, points, steps=40):
        """(N,) cells and (N, 3) local coordinates of points inside the box: walks from the nearest centre."""
        cells = self.tree.query(points)[1]
        local = self.local(cells, points)
        best, best_cells, best_local = worst_part(local), cells.copy(), local.copy()
        left = np.flatnonzero(best < -1e-9)
        for step in range(steps):
            if not len(left):
                break
            parts = np.column_stack([1 - local[left].sum(axis=1), local[left]])
            # In curved cells the walk may go in circles; then a random one of the faces that are passed.
            passed = np.where(parts < 0, parts, 0) * (1 if step < 8 else np.random.default_rng(step).random(parts.shape))
            onward = self.neighbours[cells[left], passed.argmin(axis=1)]
            cells[left] = np.where(onward >= 0, onward, cells[left])
            local[left] = self.local(cells[left], points[left])
            now = worst_part(local[left])
            better = left[now > best[left]]
            best[better], best_cells[better], best_local[better] = worst_part(local[better]), cells[better], local[better]
            left = left[now < -1e-9]
        return best_cells, best_local

    def __call__(self, points, gradient=False):
        """(N, 3) displacement in mm and, if asked for, (N, 3, 3) its gradient du_i/dX_j."""
        inside = ((points > self.low) & (points < self.high)).all(axis=1)
        result, slope = np.zeros((len(points), 3)), np.zeros((len(points), 3, 3))
        cells, local = self.locate(points[inside])
        nodes = self.dofs[:, cells].T
        moved = self.displacement[nodes]
        result[inside] = np.einsum("na,nai->ni", shape_values(local), moved)
        if not gradient:
            return result
        slopes = shape_slopes(local)
        to_space = np.linalg.inv(np.einsum("nai,naj->nij", self.places[nodes], slopes))
        slope[inside] = np.einsum("nai,naj,njk->nik", moved, slopes, to_space)
        return result, slope

    def origin(self, places, guess=None, rounds=25, tolerance=1e-3):
        """(N, 3) points X with X + u(X) = places, (N, 3, 3) the deformation gradient there, and (N,) what is left, mm."""
        best = places.copy() if guess is None else guess.copy()
        left, gradient = np.full(len(places), np.inf), np.tile(np.eye(3), (len(places), 1, 1))
        step, part = np.zeros_like(best), np.ones(len(places))  # Newton's step from the best point, and how much of it
        active = np.arange(len(places))
        for _ in range(rounds):
            tried = best[active] + part[active, None] * step[active]
            value, slope = self(tried, gradient=True)
            error = places[active] - tried - value
            size = np.linalg.norm(error, axis=1)
            good = size < left[active]
            part[active] = np.where(good, np.minimum(2 * part[active], 1), part[active] / 2)
            chosen, full = active[good], np.eye(3) + slope[good]
            best[chosen], left[chosen], gradient[chosen] = tried[good], size[good], full
            full = full.copy()
            full[np.linalg.det(full) < 0.05] = np.eye(3)
            move = np.linalg.solve(full, error[good][:, :, None])[:, :, 0]
            step[chosen] = move * np.minimum(1, 4.0 / np.maximum(np.linalg.norm(move, axis=1), 1e-9))[:, None]
            active = active[left[active] > tolerance]
            if not len(active):
                break
        return best, gradient, left


def worst_part(local):
    """(N,) smallest barycentric coordinate: negative outside the cell."""
    return np.minimum(1 - local.sum(axis=1), local.min(axis=1))


def neighbours_of(mesh):
    """(M, 4) the cell across the face opposite to each corner, -1 at the border."""
    faces = np.sort(mesh.t[[[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]], axis=1)  # (4, 3, M)
    count = mesh.t.shape[1]
    keys = faces.transpose(0, 2, 1).reshape(-1, 3)
    order = np.lexsort(keys.T)
    same = (keys[order][1:] == keys[order][:-1]).all(axis=1)
    one, two = order[:-1][same], order[1:][same]
    result = np.full(4 * count, -1)
    result[one], result[two] = two % count, one % count
    return result.reshape(4, count).T
