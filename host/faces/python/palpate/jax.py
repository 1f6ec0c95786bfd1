# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""A differentiable solve for JAX: backward is one adjoint solve on palpate's device."""
from __future__ import annotations

from functools import partial
from typing import Any, Tuple

import jax
import jax.numpy as jnp
import numpy as np

from .solver import Solver


def _solved(solver: Solver, load: Any, stiffness_kpa: Any) -> Any:
    solver.set_stiffness(np.asarray(stiffness_kpa, dtype=np.float64))
    return solver.solve(np.asarray(load, dtype=np.float64))[0].astype(load.dtype)


def _gradient(solver: Solver, displacement: Any, slope: Any, stiffness_kpa: Any) -> Tuple[Any, Any]:
    # Another solve may have changed the moduli since.
    solver.set_stiffness(np.asarray(stiffness_kpa, dtype=np.float64))
    by_load, by_stiffness = solver.gradient(np.asarray(displacement, dtype=np.float64),
                                            np.asarray(slope, dtype=np.float64))
    return by_load.astype(slope.dtype), by_stiffness.astype(stiffness_kpa.dtype)


def _like(array: Any) -> Any:
    return jax.ShapeDtypeStruct(array.shape, array.dtype)


@partial(jax.custom_vjp, nondiff_argnums=(0,))
def solve(solver: Solver, load: Any, stiffness_kpa: Any) -> Any:
    """Displacements [num_nodes, 3(, columns)] mm for a load and moduli [num_regions] kPa,
    differentiable once by both, also under jit.

    solver  palpate.Solver; its moduli are set to `stiffness_kpa`
    load    mN at free components, mm at prescribed ones
    """
    return jax.pure_callback(partial(_solved, solver), _like(load), load, stiffness_kpa)


def _forward(solver: Solver, load: Any, stiffness_kpa: Any) -> Any:
    stiffness_kpa = jnp.asarray(stiffness_kpa)
    displacement = solve(solver, load, stiffness_kpa)
    return displacement, (displacement, stiffness_kpa)


def _backward(solver: Solver, kept: Any, slope: Any) -> Any:
    displacement, stiffness_kpa = kept
    return jax.pure_callback(partial(_gradient, solver), (_like(slope), _like(stiffness_kpa)),
                             displacement, slope, stiffness_kpa)


solve.defvjp(_forward, _backward)
