# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Cuts tetrahedra along the zero of a function, so that no tetrahedron has both signs."""
import itertools

import numpy as np

EDGES = np.array(list(itertools.combinations(range(4), 2)))
NEAR = 0.28  # a point is moved to the surface if it crosses an edge within this part of its length
TOUCHING = 0.03  # a point that cannot be moved counts as on the surface within this part


def edges_of(cells):
    """(E, 2) edges, the smaller point first, each once."""
    return np.unique(np.sort(cells[:, EDGES].reshape(-1, 2), axis=1), axis=0)


def crossing(points, edges, function):
    """(E,) where the function vanishes along each edge, as a part of its length; its signs at the ends differ."""
    start, way = points[edges[:, 0]], points[edges[:, 1]] - points[edges[:, 0]]
    sign = np.sign(function(start))
    low, high = np.zeros(len(edges)), np.ones(len(edges))
    for _ in range(30):
        middle = (low + high) / 2
        same = np.sign(function(start + middle[:, None] * way)) == sign
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return (low + high) / 2


def move_near_points(points, cells, on, values, function):
    """Moves points to where edges cross the surface close by; on surfaces cut before only along edges that lie there.

    Returns new points and which of them lie on the surface now."""
    edges = edges_of(cells)
    edges = edges[values[edges[:, 0]] * values[edges[:, 1]] < 0]
    place = crossing(points, edges, function)
    ends = np.concatenate([edges, edges[:, ::-1]])  # from each end
    place = np.concatenate([place, 1 - place])
    stays = (on[ends[:, 0]] & ~on[ends[:, 1]]).any(axis=1)  # the edge leaves a surface that the point lies on
    length = np.linalg.norm(points[ends[:, 1]] - points[ends[:, 0]], axis=1)
    hit = np.zeros(len(points), bool)
    hit[ends[(place < TOUCHING) & stays, 0]] = True
    usable = (place < NEAR) & ~stays & ~hit[ends[:, 0]]
    ends, target, way = ends[usable], place[usable], (place * length)[usable]
    order = np.argsort(-way)  # the nearest is written last
    moved, moves = points.copy(), np.zeros(len(points), bool)
    moved[ends[order, 0]] = (points[ends[:, 0]] + target[:, None] * (points[ends[:, 1]] - points[ends[:, 0]]))[order]
    moves[ends[:, 0]] = True
    for _ in range(20):  # take back what squeezes a cell to less than a fifth
        before, after = (np.einsum("ij,ij->i", np.cross(p[cells[:, 1]] - p[cells[:, 0]], p[cells[:, 2]] - p[cells[:, 0]]),
                                   p[cells[:, 3]] - p[cells[:, 0]]) for p in (points, moved))
        bad = np.zeros(len(points), bool)
        bad[cells[after < 0.2 * before].ravel()] = True
        bad &= moves
        if not bad.any():
            break
        moved[bad], moves[bad] = points[bad], False
    return moved, hit | moves


def quad_diagonal(a, b, c, d):
    """Two triangles of the quadrilateral a b c d (in turn), split at its smallest number, as its other side splits it."""
    return [(a, b, c), (a, c, d)] if min(a, c) < min(b, d) else [(b, c, d), (b, d, a)]


def split_prism(a, b, c, d, e, f):
    """Three tetrahedra of the prism with triangles a b c and d e f; a-d, b-e, c-f are edges."""
    top = min(a, b, c, d, e, f)
    while top not in (a, d):
        a, b, c, d, e, f = b, c, a, e, f, d
    if top == d:
        a, b, c, d, e, f = d, e, f, a, b, c
    return [(a, d, e, f)] + [(a, *triangle) for triangle in quad_diagonal(b, c, f, e)]


def split_cell(negative, zero, positive, cut):
    """Tetrahedra of one cell; cut[(p, q)] is the point on the edge between a negative p and a positive q."""
    if len(negative) > len(positive):
        negative, positive = positive, negative
    if len(negative) == 2:
        (a, b), (c, d) = negative, positive
        return (split_prism(a, cut[a, c], cut[a, d], b, cut[b, c], cut[b, d])
                + split_prism(c, cut[a, c], cut[b, c], d, cut[a, d], cut[b, d]))
    a = negative[0]
    ring = [cut[a, p] for p in positive]
    if len(positive) == 3:
        return [(a, *ring)] + split_prism(*ring, *positive)
    if len(positive) == 2:
        (z,), (p, q) = zero, positive
        return [(a, *ring, z)] + [(z, *triangle) for triangle in quad_diagonal(ring[0], ring[1], q, p)]
    return [(a, ring[0], *zero), (ring[0], positive[0], *zero)]


def cut_along(points, cells, on, function):
    """New points, cells and on (with one more column) such that no cell reaches through the function's zero."""
    values = function(points)
    values[values == 0] = 1e-12
    points, hit = move_near_points(points, cells, on, values, function)
    values = function(points)
    values[hit] = 0.0
    edges = edges_of(cells)
    edges = edges[values[edges[:, 0]] * values[edges[:, 1]] < 0]
    way = points[edges[:, 1]] - points[edges[:, 0]]
    # A point that was taken back may lie closer than the bisection tells apart.
    fresh = points[edges[:, 0]] + np.clip(crossing(points, edges, function), 0.01, 0.99)[:, None] * way
    names = {}
    for k, (p, q) in enumerate(edges.tolist()):
        names[p, q] = names[q, p] = len(points) + k
    signs = np.sign(values)[cells]
    both = (signs.min(axis=1) < 0) & (signs.max(axis=1) > 0)
    pieces = []
    for cell, sign in zip(cells[both].tolist(), signs[both].tolist()):
        group = {s: [p for p, t in zip(cell, sign) if t == s] for s in (-1, 0, 1)}
        pieces += split_cell(group[-1], group[0], group[1], names)
    on = np.column_stack([on, hit])
    on = np.concatenate([on, np.column_stack([(on[edges[:, 0]] & on[edges[:, 1]])[:, :-1], np.ones(len(edges), bool)])])
    cells = np.concatenate([cells[~both], np.array(pieces, int).reshape(-1, 4)])
    points = np.concatenate([points, fresh])
    a, b, c, d = (points[cells[:, k]] for k in range(4))
    wrong = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) < 0
    cells[np.ix_(wrong, [2, 3])] = cells[np.ix_(wrong, [3, 2])]
    return points, cells, on
