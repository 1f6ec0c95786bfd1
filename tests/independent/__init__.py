# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Phantoms that palpate had no part in: own anatomies, own mesh, quadratic elements, wall motions and contour errors of
their own. They judge palpate's intervals from outside, so nothing here may import palpate and nothing in palpate may be
tuned to what comes out. README.md of this folder says how to run it.

Everywhere: lengths mm, stiffness kPa, forces mN, points float64 (N, 3) in the frame LPS (x left, y back, z up)."""
