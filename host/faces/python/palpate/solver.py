# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Linear elasticity on tetrahedra: many load cases at once, and gradients through them."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Optional, Tuple

import numpy as np
import numpy.typing as npt

from . import _core

if TYPE_CHECKING:
    from scipy.sparse.linalg import LinearOperator

Doubles = npt.NDArray[np.float64]
Progress = Optional[Callable[[str, float, str], Optional[bool]]]


def solver_choice(method: str = "auto", backend: str = "", device: str = "",
                  precision: str = "single", relative_tolerance: float = 1e-8,
                  expected_columns: int = 1) -> _core.SolverChoice:
    """Who solves, and how well.

    method              "auto", "multigrid", "jacobi" or "direct"
    backend             "opencl", "kokkos" or "reference"; "" takes the first of this build
    device              "platform.device" or part of a name; "" takes the best
    precision           "single" or "double", of the device; results are refined to double either way
    relative_tolerance  of the residual
    expected_columns    right-hand sides per set of moduli, to choose the method by
    """
    if precision not in ("single", "double"):
        raise ValueError(f"precision is 'single' or 'double', not {precision!r}")
    choice = _core.SolverChoice()
    choice.method, choice.backend, choice.device = method, backend, device
    choice.use_double = precision == "double"
    choice.relative_tolerance = relative_tolerance
    choice.expected_columns = expected_columns
    return choice


def _numbers(values: npt.ArrayLike, what: str) -> npt.NDArray[np.int32]:
    """As 32-bit integers; refuses what they cannot hold."""
    given = np.asarray(values)
    with np.errstate(invalid="ignore"):
        numbers = np.ascontiguousarray(given, dtype=np.int32)
    if not np.array_equal(given, numbers):
        raise ValueError(f"{what} must be whole numbers below 2^31")
    return numbers


class Solver:
    """K(E) u = f on a mesh of linear tetrahedra with one material per region.

    nodes          [num_nodes, 3] mm
    elements       [num_elements, 4] node numbers from 0, positive volumes
    stiffness_kpa  Young's moduli [num_regions], or one number
    poisson_ratio  [num_regions], or one number
    prescribed     [num_nodes, 3] true where the displacement is given
    regions        [num_elements] from 0; default: one region
    progress       called with (stage, fraction, message); False cancels
    options        of `solver_choice`

    Arrays of 64-bit floats in C order are read where they are, others are converted first.
    """

    def __init__(self, nodes: npt.ArrayLike, elements: npt.ArrayLike, stiffness_kpa: npt.ArrayLike,
                 poisson_ratio: npt.ArrayLike, prescribed: npt.ArrayLike,
                 regions: Optional[npt.ArrayLike] = None, progress: Progress = None,
                 **options: Any) -> None:
        stiffness = np.atleast_1d(np.asarray(stiffness_kpa, dtype=np.float64))
        ratio = np.broadcast_to(np.asarray(poisson_ratio, dtype=np.float64), stiffness.shape)
        if regions is not None:
            regions = _numbers(regions, "regions")
        self._solver = _core.Solver(
            np.ascontiguousarray(nodes, dtype=np.float64),
            _numbers(elements, "elements"), regions,
            np.ascontiguousarray(stiffness), np.ascontiguousarray(ratio),
            np.ascontiguousarray(prescribed, dtype=np.uint8), solver_choice(**options), progress)
        self.prescribed: npt.NDArray[np.bool_] = np.asarray(prescribed, dtype=bool)

    @property
    def num_nodes(self) -> int:
        return self._solver.num_nodes

    @property
    def num_regions(self) -> int:
        return self._solver.num_regions

    @property
    def description(self) -> str:
        """Who solves and how, one line."""
        return self._solver.description

    def set_stiffness(self, stiffness_kpa: npt.ArrayLike) -> None:
        """New Young's moduli [num_regions] kPa for the same mesh."""
        self._solver.set_stiffness(
            np.ascontiguousarray(np.atleast_1d(stiffness_kpa), dtype=np.float64))

    def solve(self, load: npt.ArrayLike, require_convergence: bool = True
              ) -> Tuple[Doubles, Doubles]:
        """(displacement mm, reaction mN) for loads [num_nodes, 3] or [num_nodes, 3, columns]: forces
        in mN at free components, the given displacement in mm at prescribed ones.

        Raises PalpateError with status 7 if the tolerance was not reached; with
        `require_convergence=False` the best that was found is returned.
        """
        displacement, reaction, converged = self._solver.solve(
            np.ascontiguousarray(load, dtype=np.float64))
        if require_convergence and not converged:
            error = _core.PalpateError("the solver did not reach its tolerance")
            error.status = 7
            raise error
        return displacement, reaction

    def gradient(self, displacement: npt.ArrayLike, slope: npt.ArrayLike
                 ) -> Tuple[Doubles, Doubles]:
        """(dJ/dload, dJ/dstiffness_kpa) of a scalar J with dJ/d(displacement) = slope at a solution."""
        return self._solver.gradient(np.ascontiguousarray(displacement, dtype=np.float64),
                                     np.ascontiguousarray(slope, dtype=np.float64))

    def apply(self, displacement: npt.ArrayLike) -> Doubles:
        """K u, mN, without regard to what is prescribed."""
        return self._solver.apply(np.ascontiguousarray(displacement, dtype=np.float64))

    def linear_operator(self) -> LinearOperator:
        """K as a scipy.sparse.linalg.LinearOperator on flattened [num_nodes * 3] vectors."""
        return self._operator(self.apply)

    def inverse_operator(self) -> LinearOperator:
        """The solve with all prescribed displacements zero: nodal forces [num_nodes * 3] in,
        displacements out. Symmetric; zero rows and columns where displacements are prescribed."""
        free = ~self.prescribed[:, :, np.newaxis]
        return self._operator(lambda columns: self.solve(np.where(free, columns, 0.0))[0])

    def _operator(self, of_columns: Callable[[Doubles], Doubles]) -> LinearOperator:
        from scipy.sparse.linalg import LinearOperator

        size = 3 * self.num_nodes

        def matmat(x: Doubles) -> Doubles:
            return of_columns(x.reshape(self.num_nodes, 3, -1)).reshape(size, -1)

        def matvec(x: Doubles) -> Doubles:
            return matmat(x)[:, 0]

        return LinearOperator((size, size), matvec=matvec, matmat=matmat, rmatvec=matvec,
                              rmatmat=matmat, dtype=np.float64)
