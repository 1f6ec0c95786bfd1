// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// What the loops of large deformation need of one element of any type; the twin of
// solver/model/solid_element.hpp. An element's geometry is, for each of its points,
//   gradient [NODES_PER_ELEMENT, 3] 1/mm, volume mm^3, and where HAS_HOOP hoop [NODES_PER_ELEMENT]
//   H = sum_a u_a (outer) gradient_a + (sum_a u_a,x hoop_a) e_z (outer) e_z
// Defines: NODES_PER_ELEMENT, POINTS_PER_ELEMENT, HAS_HOOP 1 in axisymmetry.
#if !defined(NODES_PER_ELEMENT) || !defined(POINTS_PER_ELEMENT) || !defined(HAS_HOOP)
#error "NODES_PER_ELEMENT, POINTS_PER_ELEMENT and HAS_HOOP must be defined"
#endif
#define REALS_PER_POINT ((3 + HAS_HOOP) * NODES_PER_ELEMENT + 1)
#define VOLUME_AT (3 * NODES_PER_ELEMENT)
#define HOOP_AT (3 * NODES_PER_ELEMENT + 1)

static inline global const real* point_of(global const real* points, size_t element, int q) {
    return points + (element * POINTS_PER_ELEMENT + q) * REALS_PER_POINT;
}

// H of the state u [3 num_nodes]. Gradients add up to zero, so the element's own translation is
// taken off first: in fp32 it would cost digits.
static inline void state_gradient(global const int* nodes, global const real* point,
                                  global const real* u, real* h) {
    for (int i = 0; i < 9; ++i) h[i] = 0;
    global const real* origin = u + 3 * nodes[0];
    for (int a = 1; a < NODES_PER_ELEMENT; ++a) {
        global const real* here = u + 3 * nodes[a];
        for (int i = 0; i < 3; ++i) {
            const real difference = here[i] - origin[i];
            for (int j = 0; j < 3; ++j) h[3 * i + j] += difference * point[3 * a + j];
        }
    }
#if HAS_HOOP
    for (int a = 0; a < NODES_PER_ELEMENT; ++a) h[8] += u[3 * nodes[a]] * point[HOOP_AT + a];
#endif
}

// The same for directions x [3 num_nodes, num_columns], COLUMN_WIDTH columns from `column`.
static inline tensor3 direction_gradient(global const int* nodes, global const real* point,
                                         global const real* x, size_t num_columns, size_t column) {
    tensor3 h;
    for (int i = 0; i < 9; ++i) h.m[i] = (columns)(0);
    for (int a = 0; a < NODES_PER_ELEMENT; ++a)
        for (int i = 0; i < 3; ++i) {
            const columns value =
                LOAD_COLUMNS(x + (size_t)(3 * nodes[a] + i) * num_columns + column);
            for (int j = 0; j < 3; ++j) h.m[3 * i + j] += value * point[3 * a + j];
#if HAS_HOOP
            if (i == 0) h.m[8] += value * point[HOOP_AT + a];
#endif
        }
    return h;
}

static inline law_state state_at(const material_law* law, global const int* nodes,
                                 global const real* point, global const real* u) {
    real h[9];
    state_gradient(nodes, point, u, h);
    return state_of_law(law, h);
}

// Component i of the force of the stress p on node a, times the point's volume.
static inline real force_on(const real* p, global const real* point, int a, int i) {
    real force =
        p[3 * i] * point[3 * a] + p[3 * i + 1] * point[3 * a + 1] + p[3 * i + 2] * point[3 * a + 2];
#if HAS_HOOP
    if (i == 0) force += p[8] * point[HOOP_AT + a];
#endif
    return force * point[VOLUME_AT];
}
