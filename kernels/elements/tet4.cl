// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Linear tetrahedron with nodes 0..3. The gradients of the shape functions are constant:
//   grad N_1 = (d2 x d3) / det,  grad N_2 = (d3 x d1) / det,  grad N_3 = (d1 x d2) / det,
//   grad N_0 = -(grad N_1 + grad N_2 + grad N_3),  det = d1 . (d2 x d3),  volume = det / 6
// with the edges d_a = p_a - p_0. An element keeps ELEMENT_REALS numbers:
// grad N_1, grad N_2, grad N_3 (1/mm) and the volume (mm^3).
#define NODES_PER_ELEMENT 4
#define EDGE_REALS 9
#define ELEMENT_REALS 10

typedef struct {
    real gradient[NODES_PER_ELEMENT][3];
    real volume;
} element_shape;

static inline element_shape load_element(global const real* geometry, size_t element) {
    global const real* g = geometry + ELEMENT_REALS * element;
    element_shape shape;
#pragma unroll
    for (int c = 0; c < 3; ++c) {
        shape.gradient[1][c] = g[c];
        shape.gradient[2][c] = g[3 + c];
        shape.gradient[3][c] = g[6 + c];
        shape.gradient[0][c] = -(g[c] + g[3 + c] + g[6 + c]);
    }
    shape.volume = g[9];
    return shape;
}

// Writes the numbers of one element from its edges d1, d2, d3 (mm).
static inline void store_element(global const real* edges, global real* geometry, size_t element) {
    wide d[3][3];
#pragma unroll
    for (int a = 0; a < 3; ++a)
#pragma unroll
        for (int c = 0; c < 3; ++c) d[a][c] = edges[EDGE_REALS * element + 3 * a + c];
    wide n[3][3];
    cross_wide(d[1], d[2], n[0]);
    cross_wide(d[2], d[0], n[1]);
    cross_wide(d[0], d[1], n[2]);
    const wide determinant = dot_wide(d[0], n[0]);
#pragma unroll
    for (int a = 0; a < 3; ++a)
#pragma unroll
        for (int c = 0; c < 3; ++c)
            geometry[ELEMENT_REALS * element + 3 * a + c] = (real)(n[a][c] / determinant);
    geometry[ELEMENT_REALS * element + 9] = (real)(determinant / (wide)6);
}

// The same from node positions [num_nodes, 3], mm about the middle of the mesh, in `real`.
static inline element_shape shape_of_nodes(global const real* positions, global const int* nodes) {
    real d[3][3];
    global const real* origin = positions + 3 * nodes[0];
#pragma unroll
    for (int a = 0; a < 3; ++a)
#pragma unroll
        for (int c = 0; c < 3; ++c) d[a][c] = positions[3 * nodes[a + 1] + c] - origin[c];
    element_shape shape;
#pragma unroll
    for (int a = 0; a < 3; ++a) {
        const real* u = d[(a + 1) % 3];
        const real* v = d[(a + 2) % 3];
        shape.gradient[a + 1][0] = u[1] * v[2] - u[2] * v[1];
        shape.gradient[a + 1][1] = u[2] * v[0] - u[0] * v[2];
        shape.gradient[a + 1][2] = u[0] * v[1] - u[1] * v[0];
    }
    const real determinant = d[0][0] * shape.gradient[1][0] + d[0][1] * shape.gradient[1][1] +
                             d[0][2] * shape.gradient[1][2];
    const real scale = 1 / determinant;
#pragma unroll
    for (int c = 0; c < 3; ++c) {
#pragma unroll
        for (int a = 1; a < NODES_PER_ELEMENT; ++a) shape.gradient[a][c] *= scale;
        shape.gradient[0][c] =
            -(shape.gradient[1][c] + shape.gradient[2][c] + shape.gradient[3][c]);
    }
    shape.volume = determinant / 6;
    return shape;
}
