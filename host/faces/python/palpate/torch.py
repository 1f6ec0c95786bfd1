# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""A differentiable solve for PyTorch: backward is one adjoint solve on palpate's device."""
from __future__ import annotations

from typing import Any

import torch

from .solver import Solver


class _Solve(torch.autograd.Function):
    @staticmethod
    def forward(context: Any, solver: Solver, load: torch.Tensor,
                stiffness_kpa: torch.Tensor) -> torch.Tensor:
        solver.set_stiffness(stiffness_kpa.detach().cpu().numpy())
        displacement = torch.from_numpy(solver.solve(load.detach().cpu().numpy())[0])
        context.solver = solver
        context.save_for_backward(displacement, stiffness_kpa)
        return displacement.clone().to(load)

    @staticmethod
    @torch.autograd.function.once_differentiable
    def backward(context: Any, slope: torch.Tensor) -> Any:
        displacement, stiffness_kpa = context.saved_tensors
        # Another solve may have changed the moduli since.
        context.solver.set_stiffness(stiffness_kpa.detach().cpu().numpy())
        by_load, by_stiffness = context.solver.gradient(displacement.numpy(),
                                                        slope.detach().cpu().numpy())
        return (None, torch.from_numpy(by_load).to(slope),
                torch.from_numpy(by_stiffness).to(stiffness_kpa))


def solve(solver: Solver, load: torch.Tensor, stiffness_kpa: torch.Tensor) -> torch.Tensor:
    """Displacements [num_nodes, 3(, columns)] mm for a load and moduli [num_regions] kPa,
    differentiable once by both.

    solver  palpate.Solver; its moduli are set to `stiffness_kpa`
    load    mN at free components, mm at prescribed ones
    """
    return _Solve.apply(solver, load, stiffness_kpa)
