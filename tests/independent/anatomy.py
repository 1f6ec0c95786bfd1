# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Organs as implicit functions: negative inside, 0 on the surface, about the distance in mm near it."""
from dataclasses import dataclass, field

import numpy as np

KINDS = ("round", "flat", "touching")
BORDER_MM = 16.0  # of tissue between the organs and the fixed faces of the box


@dataclass
class Organ:
    """A superquadric with waves on it, turned and placed."""
    name: str
    label: int
    role: str  # as in organs.toml
    centre: np.ndarray  # (3,) mm
    axes: np.ndarray  # (3,) half lengths, mm
    turn: np.ndarray  # (3, 3): columns are the organ's own axes
    exponent: float = 2.0  # 2 is an ellipsoid, more is boxier
    waves: np.ndarray = field(default_factory=lambda: np.zeros((0, 5)))  # amplitude, kx, ky, kz (1/mm), phase

    def own(self, points):
        """(N, 3) points in the organ's own axes, mm from its centre."""
        return (points - self.centre) @ self.turn

    def level(self, points):
        """(N,) values of the implicit function, scaled with the mean half length; its zero is the surface."""
        own = self.own(points)
        relative = (np.abs(own / self.axes) ** self.exponent).sum(axis=1) ** (1 / self.exponent)
        swell = np.ones(len(points))
        for amplitude, kx, ky, kz, phase in self.waves:
            swell += amplitude * np.sin(own @ np.array([kx, ky, kz]) + phase)
        return (relative / swell - 1.0) * self.axes.prod() ** (1 / 3)

    def slope(self, points, step=1e-3):
        """(N, 3) gradient of level() by central differences, 1/mm x mm."""
        shifts = step * np.eye(3)
        return np.stack([(self.level(points + s) - self.level(points - s)) / (2 * step) for s in shifts], axis=1)

    def distance(self, points):
        """(N,) signed distance to the surface, mm, right to first order: exact on the surface, good near it."""
        return self.level(points) / np.maximum(np.linalg.norm(self.slope(points), axis=1), 1e-9)

    def normal(self, points):
        """(N, 3) outward unit vectors."""
        slope = self.slope(points)
        return slope / np.maximum(np.linalg.norm(slope, axis=1, keepdims=True), 1e-12)

    def surface(self, directions):
        """(N, 3) points of the surface seen from the centre along (N, 3) unit vectors."""
        low, high = np.zeros(len(directions)), np.full(len(directions), 2.5 * self.axes.max())
        for _ in range(50):
            middle = (low + high) / 2
            inside = self.level(self.centre + middle[:, None] * directions) < 0
            low, high = np.where(inside, middle, low), np.where(inside, high, middle)
        return self.centre + low[:, None] * directions


@dataclass
class Anatomy:
    kind: str
    organs: list  # the first that contains a point owns it
    low: np.ndarray  # (3,) corners of the box of tissue, whose faces do not move, mm
    high: np.ndarray

    def __getitem__(self, name):
        return next(organ for organ in self.organs if organ.name == name)


def directions_of_sphere(count):
    """(count, 3) unit vectors, evenly spread (Fibonacci's spiral)."""
    index = np.arange(count) + 0.5
    z, angle = 1 - 2 * index / count, np.pi * (1 + 5 ** 0.5) * index
    ring = np.sqrt(1 - z * z)
    return np.stack([ring * np.cos(angle), ring * np.sin(angle), z], axis=1)


def gap(organ, other):
    """Smallest distance of the other organ's surface from this one, mm; negative where they overlap."""
    return organ.distance(other.surface(directions_of_sphere(600))).min()


def rotation(axis, degrees):
    """(3, 3) rotation about coordinate axis 0, 1 or 2."""
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    turn = np.eye(3)
    turn[i, i], turn[i, j], turn[j, i], turn[j, j] = c, -s, s, c
    return turn


def draw_waves(random, count, amplitude, shortest, longest):
    """(count, 5) waves of given wave lengths in mm; amplitudes share the given one."""
    vectors = random.standard_normal((count, 3))
    vectors *= (2 * np.pi / random.uniform(shortest, longest, count) / np.linalg.norm(vectors, axis=1))[:, None]
    return np.column_stack([random.uniform(0.3, 1, count) * amplitude / count, vectors, random.uniform(0, 2 * np.pi, count)])


def approach(fixed, moving, direction, wanted):
    """Moves an organ along a ray from the fixed one's centre until the gap between them is the wanted one."""
    low, high = 0.0, fixed.axes.max() + moving.axes.max() + 20.0
    for _ in range(24):
        middle = (low + high) / 2
        moving.centre = fixed.centre + middle * direction
        low, high = (middle, high) if gap(fixed, moving) < wanted else (low, middle)
    return moving


def try_anatomy(random, kind):
    flat = 0.72 if kind == "flat" else 1.0
    prostate = Organ("prostate", 1, "tissue", np.zeros(3),
                     np.array([random.uniform(20, 27), random.uniform(17.5, 22) * flat, random.uniform(18, 24)]),
                     rotation(0, random.uniform(-20, 20)) @ rotation(2, random.uniform(-6, 6)),
                     random.uniform(1.9, 2.8), draw_waves(random, 4, 0.16, 28, 60))
    bladder = Organ("bladder", 2, "driven", np.zeros(3),
                    np.array([random.uniform(24, 36), random.uniform(19, 30), random.uniform(15, 26) * flat]),
                    rotation(0, random.uniform(-25, 25)) @ rotation(1, random.uniform(-8, 8)),
                    random.uniform(2.0, 2.8), draw_waves(random, 4, 0.16, 35, 80))
    rectum = Organ("rectum", 3, "driven", np.zeros(3),
                   np.array([random.uniform(11, 17), random.uniform(9, 14) * flat, random.uniform(30, 42)]),
                   rotation(0, random.uniform(-5, 25)) @ rotation(1, random.uniform(-8, 8)),
                   random.uniform(2.0, 2.8), draw_waves(random, 4, 0.2, 22, 50))
    bones = [Organ(f"bone_{side}", 4 + k, "fixed", np.zeros(3),
                   np.array([random.uniform(8, 12), random.uniform(14, 22), random.uniform(16, 26)]),
                   rotation(2, sign * random.uniform(0, 25)), random.uniform(2, 3), draw_waves(random, 3, 0.15, 25, 50))
             for k, (side, sign) in enumerate([("left", 1), ("right", -1)])]

    def wanted():
        return random.uniform(-4, -2) if kind == "touching" else random.uniform(1.5, 4.5)

    def towards(vector, spread=0.12):
        vector = np.array(vector) + spread * random.standard_normal(3)
        return vector / np.linalg.norm(vector)

    approach(prostate, bladder, towards([0, -0.45, 1]), wanted())
    approach(prostate, rectum, towards([0, 1, -0.05], 0.06), wanted())
    for bone, sign in zip(bones, (1, -1)):
        approach(prostate, bone, towards([sign, -0.25, -0.1]), random.uniform(10, 18))
    return [prostate, bladder, rectum, *bones]


def draw_anatomy(seed, kind=None):
    """The anatomy of a seed; the kind is drawn too unless it is given."""
    random = np.random.default_rng([seed, 101])
    drawn = KINDS[random.integers(len(KINDS))]
    kind = kind or drawn
    for _ in range(200):
        organs = try_anatomy(random, kind)
        others = [(a, b) for k, a in enumerate(organs) for b in organs[k + 1:] if a.name != "prostate"]
        if all(gap(a, b) > 4 for a, b in others):
            break
    else:
        raise RuntimeError(f"no anatomy of kind {kind} found for seed {seed}")
    skin = np.concatenate([organ.surface(directions_of_sphere(2000)) for organ in organs])
    low, high = skin.min(axis=0) - BORDER_MM, skin.max(axis=0) + BORDER_MM
    return Anatomy(kind, organs, np.floor(low), np.ceil(high))
