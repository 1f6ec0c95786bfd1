# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""How far a drawn contour lies outside the true one: smooth random fields on a grid, by filtering white noise."""
from dataclasses import dataclass

import numpy as np
from scipy import fft

KERNELS = {"exponential": lambda q: np.exp(-q),
           "matern32": lambda q: (1 + np.sqrt(3) * q) * np.exp(-np.sqrt(3) * q),
           "squared": lambda q: np.exp(-q * q / 2)}
STYLES = (*KERNELS, "slices")


@dataclass
class Drawing:
    """How both images were drawn. "slices" is a rater who draws slice by slice: each is shifted and waved by itself."""
    style: str = "exact"
    sd_mm: float = 0.0
    length_mm: float = 0.0


def draw_drawing(seed, wanted):
    """wanted: "exact", a standard deviation in mm (style and length are drawn), "drawn" (all are), or STYLE:SD:LENGTH."""
    random = np.random.default_rng([seed, 303])
    style, length, sd = STYLES[random.integers(len(STYLES))], random.uniform(4, 12), random.uniform(0.2, 1.0)
    if wanted == "exact":
        return Drawing()
    if wanted == "drawn":
        return Drawing(style, sd, length)
    if ":" in wanted:
        style, sd, length = wanted.split(":")
        if style not in STYLES:
            raise ValueError(f"contours: the style {style} is none of {', '.join(STYLES)}")
        return Drawing(style, float(sd), float(length))
    return Drawing(style, float(wanted), length)


def smooth_field(random, shape, spacing, kernel, length_mm, axes=(0, 1, 2)):
    """Field of the given shape with standard deviation 1; slices along an axis that is left out are independent.

    The periodic grid that it is cut from reaches four lengths further."""
    sizes = [fft.next_fast_len(n + int(np.ceil(4 * length_mm / h)), real=False) if k in axes else n
             for k, (n, h) in enumerate(zip(shape, spacing))]
    square = np.zeros([n if k in axes else 1 for k, n in enumerate(sizes)])
    for k in axes:
        away = np.minimum(np.arange(sizes[k]), sizes[k] - np.arange(sizes[k])) * spacing[k]
        square = square + (away ** 2).reshape([-1 if j == k else 1 for j in range(3)])
    power = fft.fftn(KERNELS[kernel](np.sqrt(square) / length_mm), axes=axes).real.clip(0)
    power /= power.mean(axis=axes, keepdims=True)  # standard deviation 1 though negative powers were cut
    white = fft.fftn(random.standard_normal(sizes), axes=axes)
    field = fft.ifftn(white * np.sqrt(power), axes=axes).real
    return field[tuple(slice(n) for n in shape)]


def contour_shift(drawing, random, shape, spacing, normals):
    """(shape) mm by which one organ's contour lies outside. normals: (shape + 3) of the true surface nearby."""
    if drawing.sd_mm == 0:
        return np.zeros(shape)
    if drawing.style != "slices":
        return drawing.sd_mm * smooth_field(random, shape, spacing, drawing.style, drawing.length_mm)
    waves = smooth_field(random, shape, spacing, "matern32", drawing.length_mm, axes=(0, 1))
    jitter = random.standard_normal((1, 1, shape[2], 2))
    inplane = normals[..., :2] / np.maximum(np.linalg.norm(normals[..., :2], axis=-1, keepdims=True), 1e-9)
    return drawing.sd_mm * np.sqrt(0.5) * (waves + (jitter * inplane).sum(axis=-1))
