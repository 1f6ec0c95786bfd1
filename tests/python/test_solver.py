# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""palpate.Solver: arrays in and out, operators of SciPy."""
import gc
import inspect
import threading
import weakref

import numpy as np
import pytest

palpate = pytest.importorskip("palpate", reason="the Python package is not installed: pip install .")

from tests.python.bar import box, two_material_bar  # noqa: E402


@pytest.fixture(scope="module", params=["direct", "multigrid"])
def solver(request):
    return palpate.Solver(**two_material_bar(), method=request.param)


def random_load(solver, columns=None, seed=1):
    shape = (solver.num_nodes, 3) if columns is None else (solver.num_nodes, 3, columns)
    return np.random.default_rng(seed).normal(size=shape) * 20


def test_a_stretched_bar_of_one_material_is_the_closed_form():
    nodes, elements = box((4, 2, 2), (20.0, 10.0, 10.0))
    prescribed = np.zeros((len(nodes), 3), dtype=bool)
    prescribed[:, 0] = (nodes[:, 0] == 0) | (nodes[:, 0] == 20)
    prescribed[:, 1] = nodes[:, 1] == 0
    prescribed[:, 2] = nodes[:, 2] == 0
    solver = palpate.Solver(nodes, elements, 25.0, 0.4, prescribed)
    load = np.zeros((len(nodes), 3))
    load[nodes[:, 0] == 20, 0] = 0.2
    displacement, reaction = solver.solve(load)
    strain = 0.01
    expected = nodes * np.array([strain, -0.4 * strain, -0.4 * strain])
    np.testing.assert_allclose(displacement, expected, atol=1e-6)
    assert reaction[nodes[:, 0] == 20, 0].sum() == pytest.approx(25.0 * strain * 100.0, rel=1e-6)


def test_columns_are_solved_together_as_they_are_alone(solver):
    loads = random_load(solver, columns=3)
    together, reactions = solver.solve(loads)
    for column in range(3):
        alone, reaction = solver.solve(loads[:, :, column])
        np.testing.assert_allclose(together[:, :, column], alone, atol=1e-6)
        np.testing.assert_allclose(reactions[:, :, column], reaction, atol=1e-4)


def test_a_solution_is_in_equilibrium_with_load_and_reaction(solver):
    load = random_load(solver)
    displacement, reaction = solver.solve(load)
    force = solver.apply(displacement)
    free = ~solver.prescribed
    np.testing.assert_allclose(force[free], load[free], atol=1e-5)
    np.testing.assert_allclose(force[~free], reaction[~free], atol=1e-5)
    np.testing.assert_allclose(displacement[~free], load[~free], rtol=1e-12)


def test_gradients_are_those_of_finite_differences():
    bar = two_material_bar()
    solver = palpate.Solver(**bar, method="direct")
    load, slope = random_load(solver), random_load(solver, seed=2)

    def value(load, stiffness):
        solver.set_stiffness(stiffness)
        return float(np.sum(slope * solver.solve(load)[0]))

    displacement, _ = solver.solve(load)
    by_load, by_stiffness = solver.gradient(displacement, slope)
    for region in range(2):
        step = np.eye(2)[region] * 1e-3
        difference = (value(load, bar["stiffness_kpa"] + step)
                      - value(load, bar["stiffness_kpa"] - step)) / 2e-3
        assert by_stiffness[region] == pytest.approx(difference, rel=1e-5)
    direction = random_load(solver, seed=3)
    stiffness = bar["stiffness_kpa"]
    difference = (value(load + 1e-3 * direction, stiffness)
                  - value(load - 1e-3 * direction, stiffness)) / 2e-3
    assert np.sum(by_load * direction) == pytest.approx(difference, rel=1e-6)


def test_scipy_solves_with_the_operator_to_what_palpate_finds(solver):
    linalg = pytest.importorskip("scipy.sparse.linalg", reason="SciPy is not installed")
    load = np.where(solver.prescribed, 0.0, random_load(solver))
    free = (~solver.prescribed).ravel().astype(float)
    stiffness = solver.linear_operator()
    inverse = solver.inverse_operator()
    clamped = linalg.LinearOperator(stiffness.shape, dtype=float, matvec=lambda x: free * (
        stiffness @ (free * x)) + (1 - free) * x)
    steps = []
    tolerance = "rtol" if "rtol" in inspect.signature(linalg.cg).parameters else "tol"
    found, status = linalg.cg(clamped, load.ravel(), M=inverse, atol=0, **{tolerance: 1e-10},
                              callback=lambda x: steps.append(0))
    assert status == 0 and len(steps) <= 3  # the preconditioner is the inverse
    np.testing.assert_allclose(found, solver.solve(load)[0].ravel(), atol=1e-6)
    both = np.stack([load.ravel(), 2 * load.ravel()], axis=1)
    np.testing.assert_allclose(inverse @ both, np.stack([found, 2 * found], axis=1), atol=1e-6)


def test_arrays_are_read_where_they_are():
    """The core takes an array's own memory: what it cannot use as it is, it refuses."""
    solver = palpate.Solver(**two_material_bar(), method="direct")
    load = random_load(solver)
    with pytest.raises(TypeError):
        solver._solver.solve(load.astype(np.float32))
    with pytest.raises(TypeError):
        solver._solver.solve(np.asfortranarray(load))
    assert np.ascontiguousarray(load, dtype=np.float64) is load


def test_a_cancelled_solve_does_not_cancel_the_next():
    goes_on = [True]
    solver = palpate.Solver(**two_material_bar(), method="multigrid",
                            progress=lambda stage, fraction, message: goes_on[0])
    goes_on[0] = False
    with pytest.raises(palpate.PalpateError, match="cancelled") as error:
        solver.solve(random_load(solver, columns=8))
    assert error.value.status == 11
    goes_on[0] = True
    assert np.isfinite(solver.solve(random_load(solver, columns=8))[0]).all()


def test_threads_may_share_a_solver(solver):
    loads = [random_load(solver, seed=seed) for seed in range(8)]
    alone = [solver.solve(load)[0] for load in loads]
    found = [None] * len(loads)

    def work(k):
        found[k] = solver.solve(loads[k])[0]

    threads = [threading.Thread(target=work, args=(k,)) for k in range(len(loads))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for one, expected in zip(found, alone):
        np.testing.assert_allclose(one, expected, atol=1e-9)


@pytest.mark.parametrize("change, words", [
    ({"elements": np.array([[0, 1, 2, 100000]], dtype=np.int32), "regions": None}, "100000"),
    ({"poisson_ratio": 0.5}, "0.5"),
    ({"stiffness_kpa": [10.0, -1.0]}, "-1"),
    ({"prescribed": np.zeros((3, 3))}, "prescribed must be"),
    ({"method": "magic"}, "magic"),
    ({"device": "no such device"}, "no such device"),
])
def test_bad_arguments_are_told_in_a_sentence(change, words):
    with pytest.raises(palpate.PalpateError, match=words) as error:
        palpate.Solver(**{**two_material_bar(), **change})
    assert error.value.status in (2, 4, 8)


@pytest.mark.parametrize("spoil", [lambda x: x + 0.7, lambda x: x + 2 ** 32, lambda x: x * np.nan])
def test_elements_that_are_no_node_numbers_are_refused(spoil):
    bar = two_material_bar()
    with pytest.raises(ValueError, match="elements must be whole numbers"):
        palpate.Solver(**{**bar, "elements": spoil(bar["elements"].astype(np.int64))})


def test_a_gradient_of_what_is_not_finite_is_refused(solver):
    u = np.zeros((solver.num_nodes, 3))
    with pytest.raises(palpate.PalpateError, match="not a finite number"):
        solver.gradient(u * np.nan, u)


def test_a_solver_in_a_cycle_with_its_callback_is_collected():
    class Owner:
        def __init__(self):
            self.solver = palpate.Solver(**two_material_bar(), method="jacobi", progress=self.tell)

        def tell(self, stage, fraction, message):
            return True

    owner = Owner()
    gone = weakref.ref(owner)
    del owner
    gc.collect()
    assert gone() is None


def test_a_wrong_shape_of_the_load_is_told(solver):
    with pytest.raises(palpate.PalpateError, match="num_nodes, 3"):
        solver.solve(np.zeros((4, 3)))
