/* SPDX-FileCopyrightText: The palpate developers
 * SPDX-License-Identifier: Apache-2.0 */
/* Solves and differentiates on a cube of tetrahedra through the C interface, as often as asked, and
 * prints what a test of faults or leaks wants to know.
 *   solve_client BACKEND METHOD TIMES [FAULT LIBRARY]
 * "status <n>" of the first failure (0 if none), "largest <mm>", and after half of the times and at
 * the end "memory <resident KiB> objects <OpenCL references, if the fault library counts them>".
 * Exit code: the status. */
#define _DEFAULT_SOURCE
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "palpate.h"

enum {
    cells = 6,
    side = cells + 1,
    num_nodes = side * side * side,
    num_elements = 6 * cells * cells * cells,
    columns = 4
};
static double nodes[3 * num_nodes];
static int32_t elements[4 * num_elements];
static uint8_t prescribed[3 * num_nodes];
static double load[columns * 3 * num_nodes], u[columns * 3 * num_nodes];
static double slope[columns * 3 * num_nodes], by_load[columns * 3 * num_nodes];
static double stiffness[1] = {10}, ratio[1] = {0.4}, by_stiffness[1];

static int node_at(int i, int j, int k) { return (k * side + j) * side + i; }

/* Each cell is six tetrahedra round its long diagonal. */
static void make_elements(void) {
    static const int paths[6][3] = {{1, 3, 7}, {3, 2, 7}, {2, 6, 7}, {6, 4, 7}, {4, 5, 7}, {5, 1, 7}};
    int32_t *next = elements;
    for (int k = 0; k < cells; ++k)
        for (int j = 0; j < cells; ++j)
            for (int i = 0; i < cells; ++i)
                for (int t = 0; t < 6; ++t) {
                    *next++ = node_at(i, j, k);
                    for (int c = 0; c < 3; ++c) {
                        const int corner = paths[t][c];
                        *next++ = node_at(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2));
                    }
                }
}

static palpate_model cube(void) {
    palpate_model model;
    palpate_model_init(&model);
    for (int n = 0; n < num_nodes; ++n) {
        nodes[3 * n] = n % side;
        nodes[3 * n + 1] = n / side % side;
        nodes[3 * n + 2] = n / side / side;
        const int is_held = nodes[3 * n + 2] == 0;
        for (int i = 0; i < 3; ++i) prescribed[3 * n + i] = is_held;
        for (int c = 0; c < columns; ++c) {
            load[columns * (3 * n + 2) + c] = is_held ? 0 : 0.01 * (c + 1);
            slope[columns * (3 * n + 2) + c] = 1;
        }
    }
    make_elements();
    model.num_nodes = num_nodes;
    model.nodes = nodes;
    model.num_elements = num_elements;
    model.elements = elements;
    model.num_regions = 1;
    model.stiffness_kpa = stiffness;
    model.poisson_ratio = ratio;
    model.prescribed = prescribed;
    return model;
}

static palpate_status solve(const palpate_model *model, const palpate_solver_options *options) {
    palpate_solver *solver = NULL;
    palpate_status status = palpate_solver_create(model, options, &solver);
    if (status == PALPATE_OK) status = palpate_solver_solve(solver, load, columns, u, NULL);
    if (status == PALPATE_OK)
        status = palpate_solver_gradient(solver, u, slope, columns, by_load, by_stiffness);
    palpate_solver_free(solver);
    return status;
}

static void report(const char *library) {
    long pages = 0, resident = 0, objects = -1;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file && fscanf(file, "%ld %ld", &pages, &resident) != 2) resident = 0;
    if (file) fclose(file);
    void *faults = library ? dlopen(library, RTLD_NOW) : NULL;
    if (faults) {
        void *found = dlsym(faults, "palpate_live_objects");
        long (*count)(void);
        memcpy(&count, &found, sizeof count);
        if (found) objects = count();
        dlclose(faults);
    }
    printf("memory %ld objects %ld\n", resident * (sysconf(_SC_PAGESIZE) / 1024), objects);
}

int main(int argc, char **argv) {
    if (argc < 4) return 2;
    palpate_model model = cube();
    palpate_solver_options options;
    palpate_solver_options_init(&options);
    options.backend = argv[1];
    options.method = argv[2];
    const int times = atoi(argv[3]);
    palpate_status status = PALPATE_OK;
    for (int k = 0; k < times && status == PALPATE_OK; ++k) {
        status = solve(&model, &options);
        if (k + 1 == times / 2) report(argc > 4 ? argv[4] : NULL);
    }
    double largest = 0;
    for (int i = 0; i < columns * 3 * num_nodes; ++i) largest = fmax(largest, fabs(u[i]));
    printf("status %d\nlargest %.12g\n", (int)status, largest);
    report(argc > 4 ? argv[4] : NULL);
    if (status != PALPATE_OK) fprintf(stderr, "palpate: %s\n", palpate_last_error());
    return (int)status;
}
