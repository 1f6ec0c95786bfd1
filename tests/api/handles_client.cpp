// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// Misuse of handles, callbacks that throw, too little memory, and two threads with two handles
// each, through the C interface: statuses only, never a crash. In C++ for its threads and
// exceptions; what C99 can do is in solver_client.c. Exit code 0 if all went as it should.
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "palpate.h"

namespace {

int failures = 0;

void expect(bool condition, const std::string& what) {
    if (condition) return;
    std::printf("failed: %s (last error: %s)\n", what.c_str(), palpate_last_error());
    ++failures;
}

void expect_refused(palpate_status status, const std::string& what) {
    expect(status == PALPATE_INVALID_ARGUMENT && std::strlen(palpate_last_error()) > 10, what);
}

/// A cube of n^3 cells of five tetrahedra, held below.
struct Cube {
    explicit Cube(int n) {
        const int side = n + 1;
        for (int k = 0; k < side; ++k)
            for (int j = 0; j < side; ++j)
                for (int i = 0; i < side; ++i) {
                    nodes.insert(nodes.end(), {double(i), double(j), double(k)});
                    prescribed.insert(prescribed.end(), 3, k == 0);
                }
        constexpr int even[5][4] = {
            {0, 1, 2, 4}, {3, 2, 1, 7}, {5, 4, 7, 1}, {6, 7, 4, 2}, {1, 2, 4, 7}};
        constexpr int odd[5][4] = {
            {1, 3, 0, 5}, {2, 0, 3, 6}, {4, 5, 6, 0}, {7, 6, 5, 3}, {0, 3, 5, 6}};
        for (int k = 0; k < n; ++k)
            for (int j = 0; j < n; ++j)
                for (int i = 0; i < n; ++i)
                    for (const auto& tet : (i + j + k) % 2 ? odd : even) {
                        for (const int c : tet)
                            elements.push_back(((k + (c >> 2)) * side + j + (c >> 1 & 1)) * side +
                                               i + (c & 1));
                    }
        load.assign(nodes.size(), 0);
        for (std::size_t d = 2; d < load.size(); d += 3)
            if (!prescribed[d]) load[d] = 0.01;
        turn_positive();
    }
    void turn_positive() {
        for (std::size_t e = 0; e < elements.size(); e += 4) {
            double d[3][3];
            for (int r = 0; r < 3; ++r)
                for (int i = 0; i < 3; ++i)
                    d[r][i] = nodes[3 * elements[e + r + 1] + i] - nodes[3 * elements[e] + i];
            const double volume = d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) -
                                  d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
                                  d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
            if (volume < 0) std::swap(elements[e + 2], elements[e + 3]);
        }
    }
    palpate_model model() const {
        palpate_model given;
        palpate_model_init(&given);
        given.num_nodes = static_cast<int32_t>(nodes.size() / 3);
        given.nodes = nodes.data();
        given.num_elements = static_cast<int32_t>(elements.size() / 4);
        given.elements = elements.data();
        given.num_regions = 1;
        given.stiffness_kpa = &stiffness;
        given.poisson_ratio = &ratio;
        given.prescribed = prescribed.data();
        return given;
    }

    std::vector<double> nodes, load;
    std::vector<int32_t> elements;
    std::vector<uint8_t> prescribed;
    double stiffness = 10, ratio = 0.3;
};

palpate_solver* solver_for(const Cube& cube, const char* method) {
    palpate_solver_options options;
    palpate_solver_options_init(&options);
    options.method = method;
    const palpate_model model = cube.model();
    palpate_solver* solver = nullptr;
    expect(palpate_solver_create(&model, &options, &solver) == PALPATE_OK, "makes a solver");
    return solver;
}

void refuses_handles_that_are_none() {
    const Cube cube(2);
    std::vector<double> u(cube.load.size());
    palpate_solver* solver = solver_for(cube, "direct");
    expect(palpate_solver_free(solver) == PALPATE_OK, "frees");
    expect_refused(palpate_solver_free(solver), "refuses to free twice");
    palpate_solver* other = solver_for(cube, "direct");
    expect_refused(palpate_solver_free(solver), "an old handle does not free a new solver");
    expect(palpate_solver_solve(other, cube.load.data(), 1, u.data(), nullptr) == PALPATE_OK,
           "the new solver works");
    double modulus = 5;
    for (palpate_solver* none :
         {solver, reinterpret_cast<palpate_solver*>(&modulus), reinterpret_cast<palpate_solver*>(8),
          static_cast<palpate_solver*>(nullptr)}) {
        expect_refused(palpate_solver_solve(none, cube.load.data(), 1, u.data(), nullptr), "solve");
        expect_refused(palpate_solver_set_stiffness(none, &modulus), "set_stiffness");
        expect_refused(palpate_solver_apply(none, u.data(), 1, u.data()), "apply");
        expect_refused(palpate_solver_gradient(none, u.data(), u.data(), 1, u.data(), nullptr),
                       "gradient");
        expect(std::strcmp(palpate_solver_description(none), "") == 0, "description");
    }
    auto* result = reinterpret_cast<palpate_result*>(other);
    palpate_region region;
    region.struct_size = sizeof region;
    int32_t size[3];
    expect_refused(palpate_result_free(result), "a solver is no result");
    expect_refused(palpate_result_region(result, 0, &region), "region of no result");
    expect_refused(palpate_result_write(result, "nowhere"), "write of no result");
    expect_refused(palpate_result_write_with(result, "nowhere", nullptr), "the same with options");
    expect(!palpate_result_nodes(result) && !palpate_result_displacement(result) &&
               !palpate_result_force(result) && !palpate_result_elements(result) &&
               !palpate_result_stiffness(result) && !palpate_result_field(result, size) &&
               palpate_result_num_nodes(result) == 0 && palpate_result_num_elements(result) == 0 &&
               palpate_result_num_regions(result) == 0 && palpate_result_json(result)[0] == 0,
           "no result has nothing");
    auto* phantom = reinterpret_cast<palpate_phantom*>(other);
    palpate_labels labels;
    palpate_labels_init(&labels);
    expect_refused(palpate_phantom_free(phantom), "a solver is no phantom");
    expect_refused(palpate_phantom_labels(phantom, 0, &labels), "labels of no phantom");
    expect(palpate_phantom_settings(phantom)[0] == 0, "settings of no phantom");
    expect(palpate_solver_free(other) == PALPATE_OK, "frees the other");
    expect(palpate_solver_free(nullptr) == PALPATE_OK &&
               palpate_result_free(nullptr) == PALPATE_OK &&
               palpate_phantom_free(nullptr) == PALPATE_OK,
           "frees null");
}

void refuses_null_everywhere() {
    const Cube cube(2);
    std::vector<double> u(cube.load.size());
    palpate_solver* solver = solver_for(cube, "direct");
    expect_refused(palpate_solver_solve(solver, nullptr, 1, u.data(), nullptr), "null load");
    expect_refused(palpate_solver_solve(solver, u.data(), 1, nullptr, nullptr),
                   "null displacement");
    expect_refused(palpate_solver_set_stiffness(solver, nullptr), "null moduli");
    expect_refused(palpate_solver_apply(solver, nullptr, 1, u.data()), "null x");
    expect_refused(palpate_solver_apply(solver, u.data(), 1, nullptr), "null y");
    expect_refused(palpate_solver_gradient(solver, nullptr, u.data(), 1, u.data(), nullptr),
                   "null u");
    expect_refused(palpate_solver_gradient(solver, u.data(), nullptr, 1, u.data(), nullptr),
                   "null g");
    expect_refused(palpate_solver_gradient(solver, u.data(), u.data(), 1, nullptr, nullptr),
                   "null out");
    for (const int32_t columns : {0, -1, std::numeric_limits<int32_t>::min()})
        expect_refused(palpate_solver_solve(solver, u.data(), columns, u.data(), nullptr),
                       "columns out of range");
    palpate_solver_free(solver);
    palpate_model_init(nullptr);
    palpate_solver_options_init(nullptr);
    palpate_labels_init(nullptr);
    palpate_recover_options_init(nullptr);
    palpate_phantom_options_init(nullptr);
    palpate_result* result = nullptr;
    palpate_phantom* phantom = nullptr;
    palpate_recover_options options;
    palpate_recover_options_init(&options);
    options.settings_toml =
        "[background]\nstiffness_kpa = 10\n[[organ]]\nname = \"a\"\nlabel = 1\n";
    palpate_labels labels;
    palpate_labels_init(&labels);
    expect_refused(palpate_recover(nullptr, &labels, &options, &result), "null reference");
    expect_refused(palpate_recover(&labels, &labels, &options, &result), "null voxels");
    expect_refused(palpate_recover(&labels, &labels, nullptr, &result), "null options");
    expect_refused(palpate_recover(&labels, &labels, &options, nullptr), "null place");
    expect_refused(palpate_recover_files(nullptr, "b", &options, &result), "null path");
    expect_refused(palpate_recover_files("a", nullptr, &options, &result), "null path");
    expect_refused(palpate_phantom_pelvis(nullptr, nullptr), "null place for a phantom");
    expect(!result && !phantom, "no handles after failures");
    for (std::size_t size :
         {std::size_t(0), std::size_t(7), std::numeric_limits<std::size_t>::max()}) {
        palpate_model model = cube.model();
        model.struct_size = size;
        palpate_solver* none = nullptr;
        expect_refused(palpate_solver_create(&model, nullptr, &none), "model of a wrong size");
        options.struct_size = size;
        expect_refused(palpate_recover(&labels, &labels, &options, &result),
                       "options of a wrong size");
    }
}

int throwing(void*, const char*, double, const char*) { throw std::runtime_error("not for C"); }
int throwing_a_number(void*, const char*, double, const char*) { throw 7; }

void survives_callbacks_that_throw() {
    for (const palpate_progress callback : {throwing, throwing_a_number}) {
        palpate_phantom_options options;
        palpate_phantom_options_init(&options);
        options.progress = callback;
        palpate_phantom* phantom = nullptr;
        expect(palpate_phantom_pelvis(&options, &phantom) == PALPATE_INTERNAL && !phantom,
               "an exception becomes a status");
    }
}

/// Of address space.
std::size_t mapped_bytes() {
    unsigned long pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

/// A phantom whose volumes (some 90 million voxels) do not fit into what is left.
void tells_that_memory_ran_out() {
#ifndef PALPATE_SANITIZED  // sanitizers map terabytes
    rlimit before{}, little{};
    getrlimit(RLIMIT_AS, &before);
    little = before;
    little.rlim_cur = mapped_bytes() + (std::size_t(350) << 20);
    setrlimit(RLIMIT_AS, &little);
    palpate_phantom_options options;
    palpate_phantom_options_init(&options);
    options.num_nodes = 2000;
    for (double& spacing : options.spacing) spacing = 0.3;
    palpate_phantom* phantom = nullptr;
    const palpate_status status = palpate_phantom_pelvis(&options, &phantom);
    const std::string sentence = palpate_last_error();
    setrlimit(RLIMIT_AS, &before);
    expect(status == PALPATE_DEVICE_FAILED && !phantom,
           "a call that needs too much memory, status " + std::to_string(status));
    expect(sentence.find("memory") != std::string::npos, "the sentence about memory");
#endif
}

/// Each thread has two solvers and uses them in turn.
void two_threads_do_not_disturb_each_other() {
    const Cube cube(4);
    std::vector<double> expected(cube.load.size());
    palpate_solver* alone = solver_for(cube, "direct");
    palpate_solver_solve(alone, cube.load.data(), 1, expected.data(), nullptr);
    palpate_solver_free(alone);
    std::vector<int> wrong(2, 0);
    const auto work = [&](int which) {
        const char* methods[2] = {"jacobi", "direct"};
        palpate_solver* solvers[2] = {solver_for(cube, methods[0]), solver_for(cube, methods[1])};
        std::vector<double> u(cube.load.size());
        for (int k = 0; k < 20; ++k) {
            const palpate_status status =
                palpate_solver_solve(solvers[k % 2], cube.load.data(), 1, u.data(), nullptr);
            wrong[which] += status != PALPATE_OK;
            for (std::size_t d = 0; d < u.size(); ++d)
                wrong[which] += !(std::abs(u[d] - expected[d]) < 1e-6);
            wrong[which] += palpate_solver_solve(nullptr, u.data(), 1, u.data(), nullptr) !=
                            PALPATE_INVALID_ARGUMENT;
        }
        for (palpate_solver* solver : solvers) wrong[which] += palpate_solver_free(solver) != 0;
    };
    std::thread first(work, 0), second(work, 1);
    first.join();
    second.join();
    expect(wrong[0] == 0 && wrong[1] == 0, "two threads with two handles each");
}

/// One thread frees what another one uses.
void a_handle_freed_in_use_ends_well() {
    const Cube cube(4);
    for (int k = 0; k < 20; ++k) {
        palpate_solver* solver = solver_for(cube, "direct");
        std::thread user([&] {
            std::vector<double> u(cube.load.size());
            for (int s = 0; s < 5; ++s) {
                const palpate_status status =
                    palpate_solver_solve(solver, cube.load.data(), 1, u.data(), nullptr);
                if (status != PALPATE_OK && status != PALPATE_INVALID_ARGUMENT) ++failures;
            }
        });
        palpate_solver_free(solver);
        user.join();
    }
}

}  // namespace

int main() {
    refuses_handles_that_are_none();
    refuses_null_everywhere();
    survives_callbacks_that_throw();
    tells_that_memory_ran_out();
    two_threads_do_not_disturb_each_other();
    a_handle_freed_in_use_ends_well();
    return failures == 0 ? 0 : 1;
}
