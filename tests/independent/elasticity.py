# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Linear elasticity on curved quadratic tetrahedra, with scikit-fem."""
import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg as sparse_linalg
from skfem import Basis, BilinearForm, ElementTetP2, MeshTet, MeshTet2

FACES = np.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]])


def curved_mesh(points, cells, regions, surfaces):
    """MeshTet2 of straight cells (M, 4) whose mid-side nodes lie on the surfaces between regions (M,).

    surfaces: {label: organ}. Returns the mesh and the regions in the order of its cells. A cell that bending would
    squeeze to less than half anywhere stays straight."""
    straight = MeshTet(points.T.copy(), cells.T.copy())
    mesh = MeshTet2.from_mesh(straight)
    where = mesh.doflocs.copy()
    two = straight.f2t[:, straight.f2t[1] >= 0]
    facets = straight.facets[:, straight.f2t[1] >= 0]
    ends = np.sort(straight.edges, axis=0)
    number = {edge: k for k, edge in enumerate(map(tuple, ends.T.tolist()))}
    first = straight.p.shape[1]
    for _ in range(4):  # in turns, so that edges on two surfaces meet both
        for label, organ in surfaces.items():
            between = facets[:, (regions[two] == label).sum(axis=0) == 1]
            pairs = np.sort(np.concatenate([between[[0, 1]], between[[0, 2]], between[[1, 2]]], axis=1), axis=0)
            nodes = first + np.array([number[pair] for pair in set(map(tuple, pairs.T.tolist()))], int)
            spot = where[:, nodes].T
            where[:, nodes] = (spot - organ.distance(spot)[:, None] * organ.normal(spot)).T
    basis = Basis(mesh, ElementTetP2(), intorder=4)
    dofs, plain = basis.element_dofs, mesh.doflocs.copy()
    volume = jacobian_determinant(plain, dofs, basis)
    for _ in range(20):
        bad = (jacobian_determinant(where, dofs, basis) < 0.5 * volume).any(axis=1)
        if not bad.any():
            break
        back = dofs[4:, bad].ravel()
        where[:, back] = plain[:, back]
    return MeshTet2(where, mesh.t), regions


def jacobian_determinant(places, dofs, basis):
    """(M, Q) absolute determinants of the map from the unit cell, from (3, N) node places."""
    slopes = shape_slopes(basis.X.T)  # (Q, 10, 3)
    return np.abs(np.linalg.det(np.einsum("iam,qaj->mqij", places[:, dofs], slopes)))


def shape_values(local):
    """(N, 10) quadratic shape functions at (N, 3) local coordinates, nodes in the order of ElementTetP2."""
    b = np.column_stack([1 - local.sum(axis=1), local])
    return np.column_stack([b * (2 * b - 1)] + [4 * b[:, i] * b[:, j] for i, j in MIDDLES])


def shape_slopes(local):
    """(N, 10, 3) their derivatives by the local coordinates."""
    b = np.column_stack([1 - local.sum(axis=1), local])
    db = np.array([[-1.0, -1, -1], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    corners = (4 * b - 1)[:, :, None] * db
    middles = np.stack([4 * (b[:, i, None] * db[j] + b[:, j, None] * db[i]) for i, j in MIDDLES], axis=1)
    return np.concatenate([corners, middles], axis=1)


MIDDLES = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]


def lame(stiffness, ratio):
    return stiffness * ratio / ((1 + ratio) * (1 - 2 * ratio)), stiffness / (2 * (1 + ratio))


class Solid:
    """Stiffness matrix and solutions; degrees of freedom are node * 3 + component."""

    def __init__(self, mesh, stiffness, ratio):
        """stiffness kPa and Poisson's ratio: (M,) each, stiffness 0 for cells that are not there."""
        self.mesh = mesh
        self.basis = Basis(mesh, ElementTetP2(), intorder=4)
        self.num_nodes = self.basis.N
        lam, mu = (value[:, None] for value in lame(np.asarray(stiffness, float), np.asarray(ratio, float)))
        blocks = [[None] * 3 for _ in range(3)]
        for i in range(3):
            for j in range(i, 3):
                @BilinearForm
                def part(u, v, _):
                    value = lam * v.grad[i] * u.grad[j] + mu * v.grad[j] * u.grad[i]
                    if i == j:
                        value = value + mu * sum(v.grad[k] * u.grad[k] for k in range(3))
                    return value
                blocks[i][j] = part.assemble(self.basis)
                blocks[j][i] = blocks[i][j].T
        order = np.arange(3 * self.num_nodes).reshape(3, -1).T.ravel()
        self.matrix = sparse.bmat(blocks, format="csr")[order][:, order].tocsr()

    @property
    def nodes(self):
        """(N, 3) places of corners and mid-side nodes."""
        return self.mesh.doflocs.T

    def solve(self, held, values, force=None, free=None, tolerance=1e-9):
        """(N, 3) displacement in mm. held: (N,) bool nodes with given values (N, 3); force (N, 3) mN;
        free: nodes that are looked for, default all others; the rest keeps its values."""
        free = ~held if free is None else free & ~held
        wanted = np.repeat(free, 3)
        result = np.where(held[:, None], values, 0.0).ravel()
        right = -(self.matrix @ result)[wanted]
        if force is not None:
            right += force.ravel()[wanted]
        inner = self.matrix[wanted][:, wanted]
        result[wanted] = conjugate_gradients(inner, right, self.prolongation(free), tolerance)
        return result.reshape(-1, 3)

    def is_corner(self):
        corner = np.zeros(self.num_nodes, bool)
        corner[self.basis.element_dofs[:4].ravel()] = True
        return corner

    def prolongation(self, free):
        """From free corners (linear elements) to free nodes, three components each."""
        dofs = self.basis.element_dofs
        rows, columns, parts = [np.flatnonzero(self.is_corner())] * 2 + [np.ones(self.is_corner().sum())]
        middle, ends = np.concatenate([dofs[4 + k] for k in range(6)]), [
            np.concatenate([dofs[pair[end]] for pair in MIDDLES]) for end in (0, 1)]
        middle, once = np.unique(middle, return_index=True)
        rows = np.concatenate([rows, middle, middle])
        columns = np.concatenate([columns, ends[0][once], ends[1][once]])
        parts = np.concatenate([parts, np.full(2 * len(middle), 0.5)])
        full = sparse.csr_matrix((parts, (rows, columns)), (self.num_nodes, self.num_nodes))
        return sparse.kron(full[free][:, free & self.is_corner()], sparse.identity(3), format="csr")


def conjugate_gradients(matrix, right, prolongation, tolerance, most=4000):
    """Solution of a symmetric positive system; preconditioner: its diagonal plus the linear elements, factorised."""
    coarse = (prolongation.T @ matrix @ prolongation).tocsc()
    factor = sparse_linalg.splu(coarse, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
                                options={"SymmetricMode": True})
    diagonal = matrix.diagonal()

    def precondition(r):
        return r / diagonal + prolongation @ factor.solve(prolongation.T @ r)

    x = np.zeros_like(right)
    residual = right.copy()
    way = direction = precondition(residual)
    energy = residual @ way
    goal = tolerance * np.linalg.norm(right)
    for _ in range(most):
        if np.linalg.norm(residual) <= goal:
            return x
        image = matrix @ direction
        step = energy / (direction @ image)
        x += step * direction
        residual -= step * image
        way = precondition(residual)
        energy, before = residual @ way, energy
        direction = way + energy / before * direction
    raise RuntimeError("the equations were not solved: the mesh has cells that are nearly flat")
