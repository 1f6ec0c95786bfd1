# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Films of sucked tissue with a known outline, made without any code of palpate: another outline, another texture,
other stains, bubbles and noise than those of `palpate study aspiration-contours`.

Lengths in pixels unless their names say otherwise, light in grey values of 255, rows from the top."""
import dataclasses

import numpy

SIDE, BASE_ROW, RIM_MM = 180, 150, 0.5
PIXEL_R_MM, PIXEL_Z_MM, HOLE_MM = 0.0629, 0.03175, 10.0
VISIBLE_ROWS = BASE_ROW - RIM_MM / PIXEL_Z_MM
FINE = 3  # samples a side of each pixel


@dataclasses.dataclass
class Kind:
    name: str
    noise: float = 3       # standard deviation
    blur: float = 1
    falloff: float = 0     # part of the light that is lost from the middle to the sides
    glares: int = 0
    bubbles: int = 0
    stains: int = 0


SUITE = [Kind("noise 3"), Kind("noise 8, falling light", noise=8, falloff=0.6), Kind("six glares", glares=6),
         Kind("three bubbles", bubbles=3), Kind("four stains", stains=4),
         Kind("all of it", noise=5, blur=1.5, falloff=0.4, glares=5, bubbles=2, stains=3)]


def heights_mm(num_frames):
    """Of the apex: 0.9 mm at rest, 1.6 mm more while suction lasts."""
    t = numpy.linspace(0, 1, num_frames)
    return 0.9 + 1.6 * numpy.sin(numpy.pi * t) ** 1.3


def edge_row(column, apex_mm, lean):
    """z = h cos(pi r / 2a)^1.6 (1 + lean r / a); below it the base."""
    s = ((numpy.asarray(column) + 0.5 - SIDE / 2) * PIXEL_R_MM) / (HOLE_MM / 2)
    inside = numpy.clip(numpy.cos(0.5 * numpy.pi * numpy.clip(s, -1, 1)), 0, None)
    return BASE_ROW - 0.5 - apex_mm * inside**1.6 * (1 + lean * s) / PIXEL_Z_MM


def smooth_noise(random, shape, length):
    field = numpy.fft.rfft2(random.standard_normal(shape))
    ky, kx = numpy.fft.fftfreq(shape[0])[:, None], numpy.fft.rfftfreq(shape[1])[None, :]
    field = numpy.fft.irfft2(field * numpy.exp(-2 * (numpy.pi * length) ** 2 * (kx**2 + ky**2)), shape)
    return field / field.std()


def blurred(image, sd):
    reach = int(4 * sd) + 1
    kernel = numpy.exp(-0.5 * (numpy.arange(-reach, reach + 1) / sd) ** 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        padded = numpy.pad(image, [(reach, reach) if a == axis else (0, 0) for a in (0, 1)], mode="edge")
        image = numpy.apply_along_axis(lambda line: numpy.convolve(line, kernel, "valid"), axis, padded)
    return image


def film(kind, seed, num_frames):
    """Yields (frame [rows, columns] uint8, true row of the outline at the middle of each column)."""
    random = numpy.random.default_rng([7919, seed])
    lean = random.uniform(-0.02, 0.02)
    texture = 12 * smooth_noise(random, (2 * SIDE, SIDE), 5)
    fine = (numpy.arange(FINE * SIDE) + 0.5) / FINE - 0.5
    x, y = numpy.meshgrid(fine, fine)
    apexes = heights_mm(num_frames)

    def spots(count, low, high):
        return [(random.uniform(45, 135), random.uniform(low, high), random.uniform(0, numpy.pi)) for _ in range(count)]
    glares, stains = spots(kind.glares, 3, 12), spots(kind.stains, 1, 5)
    bubbles = [(bx, edge_row(bx, random.choice(apexes), lean) - up, random.uniform(3, 7))
               for bx, up, _ in spots(kind.bubbles, 3, 11)]
    for apex in apexes:
        edge = edge_row(x, apex, lean)
        side = ((x - SIDE / 2) / (SIDE / 2)) ** 2
        light = 1 - kind.falloff * side
        behind = 24 + 5 * side + 0.03 * y
        for bx, by, radius in bubbles:
            away = numpy.hypot(x - bx, y - by)
            behind = numpy.where(numpy.abs(away - radius) < 0.7, 140, behind)
            behind = numpy.where(numpy.hypot(x - bx + radius / 3, y - by + radius / 3) < 0.8, 200, behind)
        shift = numpy.clip(numpy.round(y + apex / PIXEL_Z_MM).astype(int), 0, 2 * SIDE - 1)
        tissue = (130 + texture[shift, numpy.clip(numpy.round(x).astype(int), 0, SIDE - 1)]) * light
        for sx, deep, turn in stains:
            dx, dy = x - sx, y - (edge_row(sx, apex, lean) + deep)
            u, v = dx * numpy.cos(turn) + dy * numpy.sin(turn), dy * numpy.cos(turn) - dx * numpy.sin(turn)
            tissue *= 1 - 0.6 / (1 + numpy.exp(6 * (numpy.hypot(u / 8, v / 5) - 1)))
        for gx, deep, _ in glares:
            gy = edge_row(gx, apex, lean) + deep
            tissue += 200 * numpy.exp(-0.5 * ((x - gx) ** 2 / 9 + (y - gy) ** 2 / 4))
        image = numpy.where(y < edge, behind, numpy.minimum(tissue, 255))
        image = numpy.where(y > VISIBLE_ROWS, 65, image)
        image = image.reshape(SIDE, FINE, SIDE, FINE).mean(axis=(1, 3))
        image = blurred(image, kind.blur)
        image = image + kind.noise * random.standard_normal(image.shape)
        yield numpy.clip(numpy.round(image), 0, 255).astype(numpy.uint8), edge_row(numpy.arange(SIDE), apex, lean)
