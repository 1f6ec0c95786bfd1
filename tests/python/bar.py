# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""A bar of two materials, clamped at both ends, for the tests of the Python package."""
import itertools

import numpy as np


def box(counts, size):
    """(nodes [n, 3] mm, elements [m, 4]) of a box of cubes, six tetrahedra each."""
    axes = [np.linspace(0, length, count + 1) for length, count in zip(size, counts)]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    strides = np.array([(counts[1] + 1) * (counts[2] + 1), counts[2] + 1, 1])
    elements = []
    for corner in itertools.product(*map(range, counts)):
        for order in itertools.permutations(range(3)):
            path = np.array(corner) @ strides + np.concatenate(
                [[0], np.cumsum(strides[list(order)])])
            is_odd = order in ((0, 2, 1), (1, 0, 2), (2, 1, 0))
            elements.append(path[[0, 2, 1, 3]] if is_odd else path)
    return nodes, np.array(elements, dtype=np.int32)


def two_material_bar():
    """Arguments of palpate.Solver."""
    nodes, elements = box((8, 3, 3), (40.0, 10.0, 10.0))
    middle = nodes[elements].mean(axis=1)[:, 0]
    ends = (nodes[:, 0] == 0) | (nodes[:, 0] == 40)
    return {"nodes": nodes, "elements": elements, "regions": (middle > 20).astype(np.int32),
            "stiffness_kpa": np.array([10.0, 40.0]), "poisson_ratio": np.array([0.3, 0.45]),
            "prescribed": np.repeat(ends[:, None], 3, axis=1)}
