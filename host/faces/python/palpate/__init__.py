# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Computational palpation: the stiffness of organs from two segmentations.

Lengths in mm, stiffness in kPa, forces in mN, places in LPS patient space. Not a medical device.
"""
from . import _blas_kernels  # before the library that computes with them is loaded
from ._core import PalpateError
from ._core import version as _version
from . import applications
from .applications import Outcome, identify, run
from .aspiration import ContourTracker, Contours, Profile, contours
from .recovery import LabelVolume, Phantom, Result, phantom, recover
from .solver import Solver

__version__ = _version().split()[0]
__all__ = ["ContourTracker", "Contours", "LabelVolume", "Outcome", "PalpateError", "Phantom", "Profile", "Result",
           "Solver", "applications", "contours", "identify", "phantom", "recover", "run"]
