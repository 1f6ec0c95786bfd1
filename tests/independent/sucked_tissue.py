# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Soft tissue sucked into a tube, solved without any code of palpate and on other elements: nine-node quadrilaterals
whose pressure is linear in each cell and free between cells (Q2/P1), where palpate has four nodes and a mean volume.

Sections through an axis: points are (r, z), the suction is above. Lengths mm, stresses kPa, forces mN, times s; forces
and volumes are those of the full turn. Symmetric tensors are rows (rr, zz, rz, tt), strains with 2 rz in place of rz.

What is solved (F deformation gradient, C = F^T F, I1 = tr C, I3 = det C, J = sqrt(I3), J1 = I1 I3^(-1/3), N normal):
    W = psi(J1 - 3) + kappa/2 (J - 1)^2,  psi(x) = mu/gamma (exp(gamma x) - 1), or mu x + mu gamma/2 x^2, or mu x    (1)
    S(t) = p J C^-1 + Se(t) + sum of h(t),  Se = 2 psi' dJ1/dC,  h(t) = amplitude int exp(-(t - s)/time) dSe/ds ds   (2)
    0 = int q (J - 1 - p/kappa) dV  for each q linear in a cell; p is eliminated cell by cell                      (3)
    int S : dE dV = 2 pi P int r (-z' dr + r' dz) ds + int k d n . dx dA                                           (4)
with P the suction on the deformed surface (r(s), z(s)), s from the axis outward, and d the depth in the rigid tube
(where the surface is in it, suction presses it on no less and no more: the tube gives that back).
Nothing rubs. Newton's method with the whole tangent; each matrix is factorised by SuperLU.

How far the outline of films 401, 402 and 403 of films.py moves, more than 0.5 mm above the rim, all frames, um:
                                            rms, three films      worst frame, rms      largest of all points
    cells of half the size (coarse=0.75)    0.06, 0.13, 0.37      0.59                  1.21
    time steps of half the length           0.00, 0.00, 0.02      0.05                  0.06
    half the tube's stiffness               0.05, 0.05, 0.36      0.63                  0.71
"""
import dataclasses

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

PAIRS = ((0, 0), (1, 1), (0, 1), (2, 2))
SOFT = 2e-4  # mm, see Body.contact
UNIT = np.array([1.0, 1.0, 0.0, 1.0])
GAUSS3, WEIGHT3 = np.polynomial.legendre.leggauss(3)
GAUSS4, WEIGHT4 = np.polynomial.legendre.leggauss(4)


class NoEquilibrium(Exception):
    """Newton's method found none."""


@dataclasses.dataclass(frozen=True)
class Law:
    """Long-term law (1) by its name, and terms of relaxation (2): the first, and others (amplitude, time)."""
    mu: float
    gamma: float
    kappa: float
    amplitude: float = 0.0
    time: float = 1.0
    more_terms: tuple = ()
    name: str = "veronda-westmann"

    def terms(self):
        """Amplitudes and times, [terms]."""
        return np.array([(self.amplitude, self.time), *self.more_terms]).T

    def slopes(self, x):
        """psi' and psi'' of (1)."""
        if self.name == "veronda-westmann":
            first = self.mu * np.exp(np.minimum(self.gamma * x, 200.0))
            return first, self.gamma * first
        bend = {"reduced-polynomial": self.mu * self.gamma, "neo-hookean-reduced": 0.0}[self.name]
        return self.mu + bend * x, np.full_like(x, bend)


@dataclasses.dataclass(frozen=True)
class Tube:
    """Rigid: hole, flat rim at z = 0, outer side; both edges are rounded alike. stiffness: kPa for each mm of depth."""
    hole_radius: float
    edge_radius: float
    outer_radius: float
    stiffness: float

    def depth(self, points):
        """Depth of points in the tube (below 0: outside), the way out, and one over the radius of its surface there."""
        r, z = points[..., 0], points[..., 1]
        a, b, e = self.hole_radius, self.outer_radius, self.edge_radius
        middle = np.where(r < 0.5 * (a + b), a + e, b - e)  # of the edge's circle, which is at z = e
        at_side = np.where(middle < 0.5 * (a + b), r < middle, r > middle)
        dr, dz = np.where(at_side, r - middle, 0.0), np.where(z < e, z - e, 0.0)
        corner = at_side & (z < e)
        away = np.where(corner, np.hypot(dr, dz), 1.0)
        flat = ~at_side
        out = np.stack([np.where(corner, dr / away, np.where(flat, 0.0, np.sign(middle - 0.5 * (a + b)))),
                        np.where(corner, dz / away, np.where(flat, -1.0, 0.0))], axis=-1)
        side = np.where(middle < 0.5 * (a + b), r - a, b - r)
        depth = np.where(corner, e - away, np.where(flat, z, side))
        return np.where(flat & (z > 2 * e), -1.0, depth), out, np.where(corner, 1 / away, 0.0)


def outer(a, b):
    return a[..., :, None] * b[..., None, :]


def inverse(c):
    """C^-1, and det C."""
    plane = c[..., 0] * c[..., 1] - c[..., 2] ** 2
    made = np.stack([c[..., 1] / plane, c[..., 0] / plane, -c[..., 2] / plane, 1 / c[..., 3]], axis=-1)
    return made, plane * c[..., 3]


def both_ways(ci):
    """(A (.) A)_ijkl = (A_ik A_jl + A_il A_jk) / 2 of A = C^-1, as 4 x 4."""
    full = np.zeros((*ci.shape[:-1], 3, 3))
    full[..., 0, 0], full[..., 1, 1], full[..., 2, 2] = ci[..., 0], ci[..., 1], ci[..., 3]
    full[..., 0, 1] = full[..., 1, 0] = ci[..., 2]
    made = np.empty((*ci.shape[:-1], 4, 4))
    for m, (i, j) in enumerate(PAIRS):
        for n, (k, l) in enumerate(PAIRS):
            made[..., m, n] = 0.5 * (full[..., i, k] * full[..., j, l] + full[..., i, l] * full[..., j, k])
    return made


def isochoric(law, c, ci, i3, product):
    """Se of (2) and dSe/dE; product is both_ways(ci)."""
    i1, scale = c[..., 0] + c[..., 1] + c[..., 3], i3 ** (-1 / 3)
    first, second = law.slopes(i1 * scale - 3)
    slope = scale[..., None] * (UNIT - i1[..., None] / 3 * ci)                       # G = dJ1/dC
    # dG/dC = I3^(-1/3) (-(I x C^-1 + C^-1 x I)/3 + I1/9 C^-1 x C^-1 + I1/3 C^-1 (.) C^-1)
    mixed = outer(np.broadcast_to(UNIT, ci.shape), ci)
    bend = scale[..., None, None] * (-(mixed + np.swapaxes(mixed, -1, -2)) / 3
                                     + i1[..., None, None] * (outer(ci, ci) / 9 + product / 3))
    # dSe/dE = 2 dSe/dC = 4 psi'' G x G + 4 psi' dG/dC
    return (2 * first[..., None] * slope,
            4 * (second[..., None, None] * outer(slope, slope) + first[..., None, None] * bend))


def line_shapes(s):
    """Values and slopes [points, nodes] at -1, 0, 1 of the parabolas that are 1 at one of these nodes."""
    s = np.asarray(s)
    return (np.stack([s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2], axis=-1),
            np.stack([s - 0.5, -2 * s, s + 0.5], axis=-1))


class Body:
    """Nodes on a grid [across, down, 2] (odd numbers of them, cells of 3 x 3 nodes), row 0 the surface. held: which
    components of which nodes stay [across, down, 2]; pressed: last node across of the surface that is sucked.
    """

    def __init__(self, grid, held, pressed, tube=None):
        across, down = grid.shape[:2]
        self.nodes, self.tube, self.num_across = grid.reshape(-1, 2), tube, across
        number = np.arange(across * down).reshape(across, down)
        self.cells = np.stack([number[i:across - 2 + i:2, j:down - 2 + j:2] for i in range(3) for j in range(3)],
                              axis=-1).reshape(-1, 9)
        self.surface = number[:, 0]
        self.edges = np.stack([self.surface[i:across - 2 + i:2] for i in range(3)], axis=-1)
        self.sucked = self.edges[:pressed // 2]
        self.free = np.flatnonzero(~held.ravel())
        self._measure_cells()
        value, self.edge_slope = line_shapes(GAUSS4)
        self.edge_value = value
        tangent = np.einsum("qa,eai->eqi", self.edge_slope, self.nodes[self.edges])
        radius = np.einsum("qa,ea->eq", value, self.nodes[self.edges, 0])
        self.edge_area = 2 * np.pi * radius * np.hypot(tangent[..., 0], tangent[..., 1]) * WEIGHT4
        self._number_entries()

    def _measure_cells(self):
        s, t = (a.ravel() for a in np.meshgrid(GAUSS3, GAUSS3, indexing="ij"))
        (ns, ds), (nt, dt) = line_shapes(s), line_shapes(t)
        value = (ns[:, :, None] * nt[:, None, :]).reshape(9, 9)
        local = np.stack([(ds[:, :, None] * nt[:, None, :]).reshape(9, 9),
                          (ns[:, :, None] * dt[:, None, :]).reshape(9, 9)], axis=-1)
        x = self.nodes[self.cells]
        jacobian = np.einsum("qak,eai->eqik", local, x)
        self.gradient = np.einsum("qak,eqki->eqai", local, np.linalg.inv(jacobian))  # dN/dX
        place = np.einsum("qa,eai->eqi", value, x)
        self.hoop = value[None] / place[..., 0, None]                                # N / R
        self.volume = 2 * np.pi * place[..., 0] * np.abs(np.linalg.det(jacobian)) * np.outer(WEIGHT3, WEIGHT3).ravel()
        # 1, R, Z about the cell's middle, made orthonormal in each cell: then the matrix of p with p is one
        away = place - place.mean(axis=1)[:, None]
        linear = np.concatenate([np.ones_like(away[..., :1]), away / np.abs(away).max(axis=1, keepdims=True)], axis=-1)
        mass = np.einsum("eq,eqi,eqj->eij", self.volume, linear, linear)
        self.linear = np.einsum("eqi,eji->eqj", linear, np.linalg.inv(np.linalg.cholesky(mass)))

    def _number_entries(self):
        def dofs(nodes):
            return (2 * nodes[:, :, None] + np.arange(2)).reshape(len(nodes), -1)
        self.dofs, self.edge_dofs, self.sucked_dofs = dofs(self.cells), dofs(self.edges), dofs(self.sucked)
        place = np.full(2 * len(self.nodes), -1)
        place[self.free] = np.arange(len(self.free))
        rows, columns = [], []
        for table in (self.dofs, self.edge_dofs, self.sucked_dofs):
            rows.append(np.repeat(place[table], table.shape[1], axis=1).ravel())
            columns.append(np.tile(place[table], (1, table.shape[1])).ravel())
        rows, columns = np.concatenate(rows), np.concatenate(columns)
        self.kept = (rows >= 0) & (columns >= 0)
        codes = columns[self.kept].astype(np.int64) * len(self.free) + rows[self.kept]
        codes, self.entry = np.unique(codes, return_inverse=True)
        self.row = (codes % len(self.free)).astype(np.int32)
        self.start = np.searchsorted(codes // len(self.free), np.arange(len(self.free) + 1)).astype(np.int32)

    def matrix(self, blocks):
        values = np.concatenate([block.ravel() for block in blocks])[self.kept]
        data = np.bincount(self.entry, weights=values, minlength=len(self.row))
        return csc_matrix((data, self.row, self.start), shape=(len(self.free),) * 2)

    def strains(self, u):
        """F [cells, points, 3 x 3 without what is zero: 2 x 2, and tt], C."""
        ue = u[self.cells]
        f = np.einsum("eai,eqaj->eqij", ue, self.gradient) + np.eye(2)
        ft = 1 + np.einsum("eqa,ea->eq", self.hoop, ue[..., 0])
        c = np.stack([f[..., 0, 0] ** 2 + f[..., 1, 0] ** 2, f[..., 0, 1] ** 2 + f[..., 1, 1] ** 2,
                      f[..., 0, 0] * f[..., 0, 1] + f[..., 1, 0] * f[..., 1, 1], ft**2], axis=-1)
        return f, ft, c

    def contact(self, u):
        """Forces and stiffness of the tube on the surface's edges, by cell edge; the deepest depth."""
        tube, shapes = self.tube, self.edge_value
        depth, out, bend = tube.depth(np.einsum("qa,eai->eqi", shapes, (self.nodes + u)[self.edges]))
        # k d n; d grows as a parabola to SOFT and as a line beyond, or Newton's method turns points on and off for ever
        push = np.where(depth < SOFT, np.maximum(depth, 0.0) ** 2 / (2 * SOFT), depth - SOFT / 2)
        rate = np.clip(depth / SOFT, 0.0, 1.0)
        weight = tube.stiffness * self.edge_area
        force = np.einsum("eq,eqi,qa->eai", weight * push, out, shapes)
        nn = outer(out, out)
        slope = rate[..., None, None] * nn - (push * bend)[..., None, None] * (np.eye(2) - nn)
        stiff = np.einsum("eq,eqij,qa,qb->eaibj", weight, slope, shapes, shapes)
        return force.reshape(len(force), 6), stiff.reshape(-1, 6, 6), depth.max()

    def suction(self, u, kpa):
        """Forces of (4) on the sucked edges and their slope by u."""
        x, n, d = (self.nodes + u)[self.sucked], self.edge_value, self.edge_slope
        r = np.einsum("qa,ea->eq", n, x[..., 0])
        dr, dz = (np.einsum("qa,ea->eq", d, x[..., i]) for i in range(2))
        w = 2 * np.pi * kpa * WEIGHT4
        force = np.stack([np.einsum("eq,qa->ea", -w * r * dz, n), np.einsum("eq,qa->ea", w * r * dr, n)], axis=-1)
        slope = np.zeros((len(x), 3, 2, 3, 2))
        slope[:, :, 0, :, 0] = np.einsum("eq,qa,qb->eab", -w * dz, n, n)
        slope[:, :, 0, :, 1] = np.einsum("eq,qa,qb->eab", -w * r, n, d)
        slope[:, :, 1, :, 0] = np.einsum("eq,qa,qb->eab", w * dr, n, n) + np.einsum("eq,qa,qb->eab", w * r, n, d)
        return force.reshape(len(x), 6), slope.reshape(-1, 6, 6)


class State:
    """Displacements u [nodes, 2], pressures p [cells, 3], and what relaxation remembers at the points: h of each term
    and Se."""

    def __init__(self, body):
        points = body.volume.shape
        self.u, self.p = np.zeros_like(body.nodes), np.zeros((points[0], 3))
        self.h, self.se = np.zeros((1, *points, 4)), np.zeros((*points, 4))
        self.time, self.kpa = 0.0, 0.0


def assemble(body, law, state, u, p, kpa, step):
    """Unbalanced forces at the free components with p eliminated, tangent, how p follows, and h, Se at the end of the
    step. Se is linear in time within a step: h1 = exp(-dt/time) h0 + amplitude (1 - exp(-dt/time)) time/dt (Se1 - Se0).
    """
    f, ft, c = body.strains(u)
    ratio = (f[..., 0, 0] * f[..., 1, 1] - f[..., 0, 1] * f[..., 1, 0]) * ft
    if ratio.min() < 0.05:
        raise NoEquilibrium("a cell is crushed")
    ci, i3 = inverse(c)
    product = both_ways(ci)
    se, tangent = isochoric(law, c, ci, i3, product)
    amplitude, time = law.terms()[..., None, None, None]
    fade = np.exp(-step / time)
    gain = amplitude * (1 - fade) * time / step
    h = fade * state.h + gain * (se - state.se)
    pressure = np.einsum("eqi,ei->eq", body.linear, p)
    press, through = (pressure * ratio)[..., None, None], ratio[..., None] * ci      # p J; dJ/dE = J C^-1
    stress = se + h.sum(axis=0) + pressure[..., None] * through
    tangent = (1 + gain.sum()) * tangent + press * (outer(ci, ci) - 2 * product)

    g, w = body.gradient, body.volume
    b = np.empty((*w.shape, 4, 9, 2))                                                # dE = B du
    b[..., 0, :, :] = g[..., 0, None] * f[..., None, :, 0]
    b[..., 1, :, :] = g[..., 1, None] * f[..., None, :, 1]
    b[..., 2, :, :] = g[..., 1, None] * f[..., None, :, 0] + g[..., 0, None] * f[..., None, :, 1]
    b[..., 3, :, 0], b[..., 3, :, 1] = body.hoop * ft[..., None], 0.0
    cells = len(w)
    b = b.reshape(cells, 9, 4, 18)
    force = np.matmul((w[..., None] * stress).reshape(cells, 1, 36), b.reshape(cells, 36, 18))[:, 0]
    scaled = np.matmul(w[..., None, None] * tangent, b).reshape(cells, 36, 18)
    stiff = np.matmul(b.reshape(cells, 36, 18).transpose(0, 2, 1), scaled)
    plane = stress[..., [0, 2, 2, 1]].reshape(*w.shape, 2, 2)
    turned = np.matmul(w[..., None, None] * g, plane)                                # [cells, points, 9, 2]
    flat = g.transpose(0, 2, 1, 3).reshape(cells, 9, 18)
    both = np.matmul(turned.transpose(0, 2, 1, 3).reshape(cells, 9, 18), flat.transpose(0, 2, 1))
    hoop = np.matmul(body.hoop.transpose(0, 2, 1) * (w * stress[..., 3])[:, None, :], body.hoop)
    stiff[:, 0::2, 0::2] += both + hoop
    stiff[:, 1::2, 1::2] += both
    # p: 0 = m - p/kappa with m = int q (J - 1), dm = A^T du; p = kappa (m + A^T du)
    a = np.matmul(b.reshape(cells, 36, 18).transpose(0, 2, 1),
                  (w[..., None, None] * outer(through, body.linear)).reshape(cells, 36, 3))
    m = np.einsum("eq,eq,eqi->ei", w, ratio - 1, body.linear)
    lack = law.kappa * m - p
    force = force + np.einsum("eki,ei->ek", a, lack)
    stiff += law.kappa * np.matmul(a, a.transpose(0, 2, 1))

    unbalanced = np.bincount(body.dofs.ravel(), weights=force.ravel(), minlength=2 * len(u))
    pull, slope = body.suction(u, kpa)
    blocks = [stiff, np.zeros((len(body.edges), 6, 6)), -slope]
    unbalanced -= np.bincount(body.sucked_dofs.ravel(), weights=pull.ravel(), minlength=2 * len(u))
    if body.tube:
        push, blocks[1], _ = body.contact(u)
        unbalanced -= np.bincount(body.edge_dofs.ravel(), weights=push.ravel(), minlength=2 * len(u))
    return (unbalanced[body.free], body.matrix(blocks),
            lambda du: lack + law.kappa * np.einsum("eki,ek->ei", a, du), h, se)


def newton(body, law, state, time, kpa, guess=None, tolerance=1e-8, most=25):
    """The state at a later time under a suction. guess: (u, p) to begin with. tolerance: mm of the last change."""
    step = time - state.time
    u, p = (state.u.copy(), state.p.copy()) if guess is None else guess
    r, matrix, follow, h, se = assemble(body, law, state, u, p, kpa, step)
    for _ in range(most):
        du = np.zeros(2 * len(u))
        factor = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01, options={"SymmetricMode": True})
        du[body.free] = -factor.solve(r)
        dp = follow(du[body.dofs])
        du = du.reshape(-1, 2)
        size, part = np.abs(du).max(), 1.0
        if not np.isfinite(size):
            raise NoEquilibrium("no step")
        while True:
            try:
                r1, matrix, follow, h, se = assemble(body, law, state, u + part * du, p + part * dp, kpa, step)
                if size < 0.02 or np.linalg.norm(r1) < 2 * np.linalg.norm(r) or part < 0.3:
                    break
            except NoEquilibrium:
                pass
            part *= 0.5
            if part < 1 / 64:
                raise NoEquilibrium("no step is short enough")
        u, p, r = u + part * du, p + part * dp, r1
        if part == 1.0 and size < tolerance:
            made = State(body)
            made.u, made.p, made.h, made.se, made.time, made.kpa = u, p, h, se, time, kpa
            return made
    raise NoEquilibrium(f"the last of {most} steps is {size:.2g} mm at {time:.3f} s, {kpa:.4g} kPa")


def advance(body, law, state, time, kpa, before=None, deep=0):
    """newton() from the motion of the last step; in halves, up to 1/64, where that fails."""
    guess = None
    if before is not None and state.time > before.time and deep == 0:
        part = (time - state.time) / (state.time - before.time)
        guess = state.u + part * (state.u - before.u), state.p + part * (state.p - before.p)
    for start in ([guess, None] if guess else [None]):
        try:
            return newton(body, law, state, time, kpa, start)
        except NoEquilibrium:
            if start is None and deep == 6:
                raise
    half = advance(body, law, state, 0.5 * (state.time + time), 0.5 * (state.kpa + kpa), None, deep + 1)
    return advance(body, law, half, time, kpa, None, deep + 1)


def run(body, law, times, suction_kpa, watch=None):
    """The surface [times, nodes, 2] under suction that is linear in time between times (the first: at rest)."""
    before, state = None, State(body)
    state.time = times[0]
    surface = [body.nodes[body.surface]]
    for time, kpa in zip(times[1:], suction_kpa[1:]):
        before, state = state, advance(body, law, state, time, kpa, before)
        surface.append((body.nodes + state.u)[body.surface])
        if watch:
            watch(state)
    return np.array(surface), state


def graded(first, last, length):
    """Ends of parts of a length, sizes geometric from about `first` to about `last`."""
    count = max(1, int(np.ceil(length * np.log(last / first) / (last - first)))) if abs(last - first) > 1e-9 else max(
        1, int(np.ceil(length / first)))
    sizes = np.geomspace(first, last, count) if count > 1 else np.ones(1)
    return np.concatenate([[0], np.cumsum(sizes)]) * (length / sizes.sum())


def halved(ends):
    """The same with the middle of each part."""
    return np.sort(np.concatenate([ends, 0.5 * (ends[1:] + ends[:-1])]))


@dataclasses.dataclass(frozen=True)
class Section:
    """A block under a tube. cap: height over x = r/r_t in [0, 1], 1 at the axis and 0 at the end; lifts off the tube's
    edge where the cap's slope is that of the edge, so that the surface at rest has no kink and touches nothing harder
    than with zero depth. coarse: 1.5 is the mesh of films, 0.75 has cells of half the size. side: "held", or "sliding"
    up and down; the bottom is held."""
    cap_mm: float
    cap: callable
    width_mm: float = 22.0
    depth_mm: float = 18.0
    coarse: float = 1.5
    side: str = "held"

    def lift_off(self, tube):
        """Angle of the edge's circle from its lowest point to where the surface leaves it."""
        a, e, angle, small = tube.hole_radius, tube.edge_radius, 0.4, 1e-5
        for _ in range(100):
            slope = (self.cap(np.array(1 - small)) - self.cap(np.array(1.0))) / small
            angle = np.arctan((self.cap_mm - e * (1 - np.cos(angle))) * float(slope) / (a + e - e * np.sin(angle)))
        return angle

    def top(self, r, tube):
        a, e, angle = tube.hole_radius, tube.edge_radius, self.lift_off(tube)
        end, up = a + e - e * np.sin(angle), e * (1 - np.cos(angle))
        circle = e - np.sqrt(np.maximum(e * e - np.clip(a + e - r, 0, e * 0.999) ** 2, 0))
        return np.where(r < end, up + (self.cap_mm - up) * self.cap(np.minimum(r / end, 1.0)), circle)

    def body(self, tube, edge_cells=2.0, finest=0.1, growth=1.35):
        a, e, b, k = tube.hole_radius, tube.edge_radius, tube.outer_radius, self.coarse
        end = a + e - e * np.sin(self.lift_off(tube))
        near = max(a + e - end, 0.04) / edge_cells * k
        parts = [end - graded(near, 0.7 * k, end)[::-1], end + graded(near, near, a + e - end),
                 a + e + graded(near, 0.35 * k, 1.2), a + e + 1.2 + graded(0.45 * k, 1.0 * k, b - e - a - e - 1.2),
                 b - e + graded(0.35 * k, 0.35 * k, e), b + graded(0.6 * k, 3.0 * k, self.width_mm - b)]
        across = halved(np.unique(np.round(np.concatenate(parts), 12)))
        deepest = min(finest * k + (growth - 1) * self.depth_mm, 3.0 * k)
        down = halved(graded(finest * k, deepest, self.depth_mm)) / self.depth_mm
        r, t = np.meshgrid(across, down, indexing="ij")
        grid = np.stack([r, self.top(across, tube)[:, None] * (1 - t) ** 2 - self.depth_mm * t], axis=-1)
        held = np.zeros(grid.shape, bool)
        held[:, -1], held[0, :, 0], held[-1, :, 0], held[-1, :, 1] = True, True, True, self.side == "held"
        return Body(grid, held, int(np.argmin(np.abs(across - (a + e + 1.2)))), tube)


def heights(surface, r):
    """z of surfaces [times, nodes, 2] at places r, by their parabolas; nan beyond where they go back."""
    value, _ = line_shapes(np.linspace(-1, 1, 13)[:-1])
    edges = np.stack([surface[:, i:surface.shape[1] - 2 + i:2] for i in range(3)], axis=-2)
    fine = np.einsum("qa,teai->teqi", value, edges).reshape(len(surface), -1, 2)
    made = np.empty((len(surface), len(r)))
    for one, line in zip(made, fine):
        back = np.flatnonzero(np.diff(line[:, 0]) <= 0)
        last = back[0] + 1 if len(back) else len(line)
        one[:] = np.interp(r, line[:last, 0], line[:last, 1], right=np.nan)
    return made
