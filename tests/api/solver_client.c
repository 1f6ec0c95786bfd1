/* SPDX-FileCopyrightText: The palpate developers
 * SPDX-License-Identifier: Apache-2.0 */
/* A program of somebody else, in C99: stretches a cube of five tetrahedra, and misuses the interface in
 * every way that comes to mind. Exit code 0 if all went as it should. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "palpate.h"

static int failures = 0;

static void expect(int condition, const char *what) {
    if (condition) return;
    printf("failed: %s (last error: %s)\n", what, palpate_last_error());
    ++failures;
}

enum { num_nodes = 8, num_elements = 5 };

static double nodes[3 * num_nodes];
static const int32_t elements[4 * num_elements] = {0, 1, 2, 4, 3, 2, 1, 7, 5, 4,
                                                   7, 1, 6, 7, 4, 2, 1, 2, 4, 7};
static uint8_t prescribed[3 * num_nodes];
static double stiffness[1] = {10}, ratio[1] = {0.0};

static palpate_model cube(void) {
    palpate_model model;
    palpate_model_init(&model);
    for (int n = 0; n < num_nodes; ++n) {
        for (int i = 0; i < 3; ++i) nodes[3 * n + i] = (n >> i) & 1;
        /* Slides on three planes. */
        for (int i = 0; i < 3; ++i) prescribed[3 * n + i] = nodes[3 * n + i] == 0;
    }
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

/* Two columns: pulled by 1 and by 2 kPa at z = 1, whose two triangles share nodes 4 and 7. */
static void pull(double *load) {
    memset(load, 0, 2 * 3 * num_nodes * sizeof *load);
    for (int n = 4; n < 8; ++n)
        for (int c = 0; c < 2; ++c)
            load[2 * (3 * n + 2) + c] = (n == 4 || n == 7 ? 1.0 / 3 : 1.0 / 6) * (c + 1);
}

static void solve(palpate_solver *solver) {
    double load[2 * 3 * num_nodes], u[2 * 3 * num_nodes], reaction[2 * 3 * num_nodes];
    double f[2 * 3 * num_nodes], by_load[2 * 3 * num_nodes], by_stiffness[1];
    pull(load);
    expect(palpate_solver_solve(solver, load, 2, u, reaction) == PALPATE_OK, "solves");
    double total[2] = {0, 0};
    for (int n = 0; n < num_nodes; ++n)
        for (int c = 0; c < 2; ++c) {
            const double wanted = n >= 4 ? (c + 1) / 10.0 : 0;
            expect(fabs(u[2 * (3 * n + 2) + c] - wanted) < 1e-6, "stretches as Hooke says");
            total[c] += reaction[2 * (3 * n + 2) + c];
        }
    expect(fabs(total[0] + 1) < 1e-5 && fabs(total[1] + 2) < 1e-5, "reactions hold the pull");
    expect(palpate_solver_apply(solver, u, 2, f) == PALPATE_OK, "applies K");
    expect(fabs(f[2 * (3 * 4 + 2)] - 1.0 / 3) < 1e-5, "K u is the force");
    /* J = u_z of node 7 in column 1: J = 2 / E, dJ/dE = -2 / E^2. */
    double slope[2 * 3 * num_nodes] = {0};
    slope[2 * (3 * 7 + 2) + 1] = 1;
    expect(palpate_solver_gradient(solver, u, slope, 2, by_load, by_stiffness) == PALPATE_OK,
           "differentiates");
    expect(fabs(by_stiffness[0] + 0.02) < 1e-6, "dJ/dE");
    const double stiffer[1] = {20};
    expect(palpate_solver_set_stiffness(solver, stiffer) == PALPATE_OK, "takes new moduli");
    expect(palpate_solver_solve(solver, load, 2, u, NULL) == PALPATE_OK, "solves again");
    expect(fabs(u[2 * (3 * 7 + 2)] - 0.05) < 1e-6, "is stiffer");
    const double negative[1] = {-1};
    expect(palpate_solver_set_stiffness(solver, negative) == PALPATE_INVALID_ARGUMENT,
           "refuses a negative modulus");
    expect(palpate_solver_solve(solver, load, 2, u, NULL) == PALPATE_OK, "still works");
    expect(palpate_solver_solve(solver, load, 0, u, NULL) == PALPATE_INVALID_ARGUMENT,
           "refuses no columns");
    expect(palpate_solver_solve(solver, NULL, 1, u, NULL) == PALPATE_INVALID_ARGUMENT,
           "refuses a null load");
    load[5] = NAN;
    expect(palpate_solver_solve(solver, load, 2, u, NULL) == PALPATE_INVALID_ARGUMENT,
           "refuses a load that is no number");
}

static void misuse(void) {
    palpate_solver *solver = NULL;
    palpate_model model = cube();
    expect(palpate_solver_create(NULL, NULL, &solver) == PALPATE_INVALID_ARGUMENT, "null model");
    expect(palpate_solver_create(&model, NULL, NULL) == PALPATE_INVALID_ARGUMENT, "null place");
    model.struct_size = 0;
    expect(palpate_solver_create(&model, NULL, &solver) == PALPATE_INVALID_ARGUMENT,
           "a struct that was not initialised");
    expect(strlen(palpate_last_error()) > 10, "says why");
    model = cube();
    model.struct_size = 1u << 30;
    expect(palpate_solver_create(&model, NULL, &solver) == PALPATE_INVALID_ARGUMENT,
           "a struct of absurd size");
    model = cube();
    model.prescribed = NULL;
    expect(palpate_solver_create(&model, NULL, &solver) == PALPATE_INVALID_ARGUMENT,
           "an array that is missing");
    model = cube();
    int32_t wild[4 * num_elements];
    memcpy(wild, elements, sizeof wild);
    wild[3] = 1000;
    model.elements = wild;
    expect(palpate_solver_create(&model, NULL, &solver) == PALPATE_INVALID_ARGUMENT,
           "a node that does not exist");
    expect(solver == NULL, "no handle after a failure");
    palpate_solver_options options;
    palpate_solver_options_init(&options);
    model = cube();
    options.method = "magic";
    expect(palpate_solver_create(&model, &options, &solver) == PALPATE_INVALID_ARGUMENT,
           "a method that does not exist");
    options.method = NULL;
    options.backend = "abacus";
    expect(palpate_solver_create(&model, &options, &solver) == PALPATE_INVALID_ARGUMENT,
           "a back end that does not exist");
    palpate_solver_free(NULL);
    palpate_result_free(NULL);
    expect(palpate_result_num_regions(NULL) == 0 && palpate_result_nodes(NULL) == NULL,
           "no result has nothing");
    palpate_result *result = NULL;
    palpate_recover_options recover;
    palpate_recover_options_init(&recover);
    expect(palpate_recover_files("a", "b", &recover, &result) == PALPATE_INVALID_ARGUMENT,
           "no settings");
    recover.settings_toml = "[background]\nstiffness_kpa = 10\n[[organ]]\nname = \"a\"\nlabel = 1\n";
    expect(palpate_recover_files("no/such.nii", "b", &recover, &result) != PALPATE_OK,
           "no such file");
    expect(result == NULL, "no result after a failure");
}

/* As a program that was compiled when the options ended before `expected_columns`. */
static void older_header(void) {
    palpate_model model = cube();
    palpate_solver_options options;
    palpate_solver_options_init(&options);
    options.struct_size = offsetof(palpate_solver_options, expected_columns);
    options.expected_columns = -77;
    palpate_solver *solver = NULL;
    expect(palpate_solver_create(&model, &options, &solver) == PALPATE_OK,
           "an older program's options");
    palpate_solver_free(solver);
}

int main(void) {
    expect(palpate_abi_version() / 1000 == 2, "the interface of this header");
    expect(strlen(palpate_version()) > 0, "has a version");
    expect(strcmp(palpate_status_text(PALPATE_NOT_CONVERGED), "not converged") == 0, "status text");
    palpate_model model = cube();
    const char *methods[] = {"auto", "direct", "jacobi"};
    for (int k = 0; k < 3; ++k) {
        palpate_solver_options options;
        palpate_solver_options_init(&options);
        options.method = methods[k];
        palpate_solver *solver = NULL;
        expect(palpate_solver_create(&model, &options, &solver) == PALPATE_OK, "makes a solver");
        if (!solver) break;
        expect(strlen(palpate_solver_description(solver)) > 5, "says who solves");
        solve(solver);
        palpate_solver_free(solver);
    }
    misuse();
    older_header();
    return failures == 0 ? 0 : 1;
}
