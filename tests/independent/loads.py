# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""How the walls of bladder and rectum move: formulas with a few drawn numbers, never a Gaussian process.

A motion takes (organ, places (N, 3) mm, random) and returns displacements (N, 3) of any size; wall_motion() scales
them. "pressure" is none of these: its wall moves as the tissue lets it (truth.py)."""
import numpy as np


def unit(random):
    vector = random.standard_normal(3)
    return vector / np.linalg.norm(vector)


def dilation(organ, places, random):
    """The organ grows as a whole, each half length by the same part."""
    return (places - organ.centre) * organ_sign(random)


def filling(organ, places, random):
    """The organ grows away from one point of its wall, more along some of its axes than along others."""
    base = organ.surface(unit(random)[None])[0]
    factors = random.uniform(0.3, 1.0, 3)
    return ((places - base) @ organ.turn * factors) @ organ.turn.T * organ_sign(random)


def bump(organ, places, random):
    """One place of the wall, drawn on the side of the prostate, comes out along the normals."""
    towards = -organ.centre / np.linalg.norm(organ.centre) + 0.7 * unit(random)
    top = organ.surface((towards / np.linalg.norm(towards))[None])[0]
    radius = random.uniform(14, 30)
    away = np.minimum(np.linalg.norm(places - top, axis=1) / radius, 1)
    return organ.normal(places) * (np.cos(np.pi / 2 * away) ** 2)[:, None]


def normal(organ, places, random):
    """Along the normals only, by a polynomial of second degree in the direction from the centre."""
    side = (places - organ.centre) @ organ.turn / organ.axes
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    tilt, bend = random.standard_normal(3), random.standard_normal((3, 3))
    size = organ_sign(random) + 0.4 * side @ tilt + 0.3 * np.einsum("ni,ij,nj->n", side, bend, side)
    return organ.normal(places) * size[:, None]


def slide(organ, places, random):
    """Mostly along the wall: a turn about an axis and a shift without its normal part; a little growth beside it."""
    spin, shift, normals = unit(random), unit(random), organ.normal(places)
    along = np.cross(spin, places - organ.centre) / organ.axes.mean() + shift
    along -= (along * normals).sum(axis=1, keepdims=True) * normals
    return along + 0.3 * normals


def shift(organ, places, random):
    """Moved and turned as a rigid body, with a wave along the normals left over."""
    wave = unit(random) * 2 * np.pi / random.uniform(35, 60)
    residual = np.sin((places - organ.centre) @ wave + random.uniform(0, 2 * np.pi))
    turn = np.cross(unit(random), places - organ.centre) * random.uniform(0.1, 0.5) / organ.axes.mean()
    return unit(random) + turn + random.uniform(0.2, 0.5) * residual[:, None] * organ.normal(places)


def organ_sign(random):
    """Organs fill more often than they empty."""
    return -1.0 if random.random() < 0.25 else 1.0


MOTIONS = {f.__name__: f for f in (dilation, filling, bump, normal, slide, shift)}
FAMILIES = (*MOTIONS, "pressure")


def wall_motion(family, organ, places, random, size_mm):
    """(N, 3) displacement of the wall; the point that moves most moves by size_mm."""
    motion = MOTIONS[family](organ, places, random)
    return motion * (size_mm / np.linalg.norm(motion, axis=1).max())
