# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Differentiable solves for PyTorch and JAX."""
import numpy as np
import pytest

palpate = pytest.importorskip("palpate", reason="the Python package is not installed: pip install .")

from tests.python.bar import two_material_bar  # noqa: E402


@pytest.fixture(scope="module")
def solver():
    return palpate.Solver(**two_material_bar(), method="direct", relative_tolerance=1e-12)


@pytest.fixture(scope="module")
def load(solver):
    return np.random.default_rng(1).normal(size=(solver.num_nodes, 3)) * 20


def test_torch_checks_the_gradients_itself(solver, load):
    torch = pytest.importorskip("torch", reason="PyTorch is not installed")
    from palpate.torch import solve

    scales = torch.tensor([1.0, -0.5], dtype=torch.float64, requires_grad=True)
    stiffness = torch.tensor([10.0, 40.0], dtype=torch.float64, requires_grad=True)

    def functional(scales, stiffness):
        loads = torch.from_numpy(load)[:, :, None] * scales
        return (solve(solver, loads, stiffness) ** 2).mean(dim=(0, 1))

    assert torch.autograd.gradcheck(functional, (scales, stiffness), eps=1e-4, atol=1e-6, rtol=1e-4)


def test_torch_finds_moduli_by_descent(solver, load):
    torch = pytest.importorskip("torch", reason="PyTorch is not installed")
    from palpate.torch import solve

    forces = torch.from_numpy(np.where(solver.prescribed, 0.0, load))
    truth = solve(solver, forces, torch.tensor([12.0, 30.0], dtype=torch.float64))
    logarithm = torch.log(torch.tensor([20.0, 20.0], dtype=torch.float64)).requires_grad_()
    optimiser = torch.optim.LBFGS([logarithm], max_iter=40, line_search_fn="strong_wolfe",
                                  tolerance_grad=1e-12, tolerance_change=1e-14)

    def misfit():
        optimiser.zero_grad()
        value = ((solve(solver, forces, logarithm.exp()) - truth) ** 2).sum()
        value.backward()
        return value

    optimiser.step(misfit)
    np.testing.assert_allclose(logarithm.detach().exp().numpy(), [12.0, 30.0], rtol=1e-3)


def test_torch_keeps_the_type_and_the_moduli_of_each_solve(solver, load):
    torch = pytest.importorskip("torch", reason="PyTorch is not installed")
    from palpate.torch import solve

    soft = torch.tensor([10.0, 40.0], requires_grad=True)
    displacement = solve(solver, torch.from_numpy(load).float(), soft)
    assert displacement.dtype == torch.float32
    solve(solver, torch.from_numpy(load), torch.tensor([500.0, 500.0]))  # before going backward
    displacement.sum().backward()
    again = torch.tensor([10.0, 40.0], dtype=torch.float64, requires_grad=True)
    solve(solver, torch.from_numpy(load), again).sum().backward()
    np.testing.assert_allclose(soft.grad, again.grad, rtol=1e-3)


def test_jax_gradients_are_those_of_finite_differences_also_under_jit(solver, load):
    jax = pytest.importorskip("jax", reason="JAX is not installed")
    jax.config.update("jax_enable_x64", True)
    from palpate.jax import solve

    def functional(load, stiffness):
        return (solve(solver, load, stiffness) ** 2).sum()

    stiffness = jax.numpy.array([10.0, 40.0])
    by_load, by_stiffness = jax.jit(jax.grad(functional, argnums=(0, 1)))(load, stiffness)
    for region in range(2):
        step = np.eye(2)[region] * 1e-3
        difference = (functional(load, stiffness + step)
                      - functional(load, stiffness - step)) / 2e-3
        assert by_stiffness[region] == pytest.approx(float(difference), rel=1e-5)
    direction = np.random.default_rng(2).normal(size=load.shape)
    difference = (functional(load + 1e-3 * direction, stiffness)
                  - functional(load - 1e-3 * direction, stiffness)) / 2e-3
    assert float((by_load * direction).sum()) == pytest.approx(float(difference), rel=1e-5)
