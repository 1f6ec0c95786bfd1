// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "host/faces/capi/guard.hpp"
#include "host/faces/capi/handles.hpp"
#include "host/faces/capi/solver_options.hpp"
#include "solver/adjoint/adjoint.hpp"
#include "solver/backend/registry.hpp"
#include "solver/linear/make_linear_solver.hpp"
#include "solver/model/stiffness_matrix.hpp"

using namespace palpate;
using capi::completed;
using capi::guarded;
using capi::hold;
using capi::require;

/// The handle.
struct palpate_solver {
    Model model;
    palpate_progress progress = nullptr;
    void* progress_user = nullptr;
    std::unique_ptr<LinearSolver> solver;
    StiffnessMatrix stiffness;
    std::string description;
};

namespace {

void check_count(std::int32_t count, const char* what) {
    if (count > 0) return;
    throw Error(ErrorCode::invalid_argument,
                fmt::format("the number of {} is {}; it must be positive", what, count));
}

Model model_of(const palpate_model& given) {
    check_count(given.num_nodes, "nodes");
    check_count(given.num_elements, "elements");
    check_count(given.num_regions, "regions");
    require(given.nodes, "the array of nodes");
    require(given.elements, "the array of elements");
    require(given.stiffness_kpa, "the array of Young's moduli");
    require(given.poisson_ratio, "the array of Poisson's ratios");
    require(given.prescribed, "the array of prescribed flags");
    Model model;
    for (std::int32_t n = 0; n < given.num_nodes; ++n)
        model.mesh.nodes.emplace_back(given.nodes[3 * std::size_t(n)],
                                      given.nodes[3 * std::size_t(n) + 1],
                                      given.nodes[3 * std::size_t(n) + 2]);
    for (std::int32_t e = 0; e < given.num_elements; ++e) {
        const std::int32_t* corner = given.elements + 4 * std::size_t(e);
        model.mesh.tets.push_back({corner[0], corner[1], corner[2], corner[3]});
        model.mesh.region.push_back(given.regions ? given.regions[e] : 0);
    }
    for (std::int32_t r = 0; r < given.num_regions; ++r)
        model.materials.push_back({given.stiffness_kpa[r], given.poisson_ratio[r]});
    model.prescribed.assign(given.prescribed, given.prescribed + 3 * std::size_t(given.num_nodes));
    return model;
}

std::string describe(const LinearSolverInfo& info) {
    const std::string where = info.method == LinearMethod::direct
                                  ? info.library
                                  : info.device.backend + " on " + info.device.device;
    return fmt::format("{} ({}): {}", name_of(info.method), where, info.reason);
}

using ConstColumns = Eigen::Map<const Columns>;

/// [3 num_nodes, columns] of the caller.
ConstColumns columns_at(const palpate_solver& solver, const double* values, std::int32_t columns,
                        const char* what) {
    require(values, what);
    return {values, solver.model.num_dofs(), columns};
}

/// A call that was cancelled does not cancel the next one.
ProgressSink told_in_this_call(const palpate_solver& solver) {
    return capi::progress_sink(solver.progress, solver.progress_user);
}

/// Runs `work`, which cannot be interrupted, and asks every half second whether to cancel. If so,
/// throws when `work` is done.
void run_uninterrupted(const ProgressSink& progress, const std::function<void()>& work) {
    constexpr std::chrono::milliseconds pause(500);
    if (!progress) return work();
    std::exception_ptr cancelled;
    {
        const std::jthread teller([&](const std::stop_token& end) {
            std::mutex mutex;
            std::condition_variable_any wake;
            std::unique_lock lock(mutex);
            try {
                while (wake.wait_for(lock, end, pause, [] { return false; }), !end.stop_requested())
                    report_progress(progress, "preparing", -1);
            } catch (...) {
                cancelled = std::current_exception();
            }
        });
        work();
    }
    if (cancelled) std::rethrow_exception(cancelled);
}

void multiply(const palpate_solver& solver, const double* x, std::int32_t columns, double* y) {
    multiply_rows(solver.stiffness, 0, solver.stiffness.num_nodes(), x, columns, {}, y);
}

}  // namespace

namespace palpate::capi {

LinearSolverOptions linear_solver_options(const palpate_solver_options* chosen) {
    palpate_solver_options given;
    palpate_solver_options_init(&given);
    if (chosen) given = completed(chosen, palpate_solver_options_init, "the solver's options");
    LinearSolverOptions options;
    const std::string method = given.method ? given.method : "auto";
    bool is_known = false;
    for (const LinearMethod known : {LinearMethod::automatic, LinearMethod::multigrid,
                                     LinearMethod::jacobi, LinearMethod::direct})
        if (method == name_of(known)) {
            options.method = known;
            is_known = true;
        }
    if (!is_known)
        throw Error(ErrorCode::invalid_argument,
                    "there is no linear solver '" + method +
                        "'; there are auto, multigrid, jacobi, direct");
    options.backend = given.backend ? given.backend : backend_registry().front().name;
    if (given.device) options.device.device = given.device;
    options.device.precision = given.use_double ? Precision::double_ : Precision::single;
    if (!(given.relative_tolerance > 0 && given.relative_tolerance < 1))
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("the relative tolerance is {}; it must lie between 0 and 1",
                                given.relative_tolerance));
    options.relative_tolerance = given.relative_tolerance;
    check_count(given.expected_columns, "expected columns");
    options.expected_columns = given.expected_columns;
    make_backend(options.backend, options.device);  // a missing device is told before any work
    return options;
}

}  // namespace palpate::capi

void palpate_model_init(palpate_model* model) {
    if (!model) return;
    *model = {};
    model->struct_size = sizeof *model;
}

void palpate_solver_options_init(palpate_solver_options* options) {
    if (!options) return;
    const LinearSolverOptions defaults;
    *options = {};
    options->struct_size = sizeof *options;
    options->relative_tolerance = defaults.relative_tolerance;
    options->expected_columns = defaults.expected_columns;
}

palpate_status palpate_solver_create(const palpate_model* model,
                                     const palpate_solver_options* options,
                                     palpate_solver** solver) {
    return guarded([&] {
        require(solver, "the place for the solver");
        *solver = nullptr;
        palpate_solver_options chosen;
        palpate_solver_options_init(&chosen);
        if (options)
            chosen = completed(options, palpate_solver_options_init, "the solver's options");
        auto made = std::make_unique<palpate_solver>();
        made->model = model_of(completed(model, palpate_model_init, "the model"));
        check_model(made->model);
        made->progress = chosen.progress;
        made->progress_user = chosen.progress_user;
        const LinearSolverOptions how = capi::linear_solver_options(&chosen);
        run_uninterrupted(told_in_this_call(*made), [&] {
            made->solver = make_linear_solver(made->model, how);
            made->stiffness = assemble_stiffness(made->model);
        });
        made->description = describe(made->solver->describe());
        *solver = capi::Handles<palpate_solver>::all().keep(std::move(made));
        return PALPATE_OK;
    });
}

palpate_status palpate_solver_free(palpate_solver* solver) {
    return guarded([&] {
        capi::release(solver, "the solver");
        return PALPATE_OK;
    });
}

palpate_status palpate_solver_set_stiffness(palpate_solver* solver, const double* stiffness_kpa) {
    return guarded([&] {
        const auto held = hold(solver, "the solver");
        require(stiffness_kpa, "the array of Young's moduli");
        Model model = solver->model;
        for (std::size_t r = 0; r < model.materials.size(); ++r)
            model.materials[r].stiffness_kpa = stiffness_kpa[r];
        check_model(model);
        run_uninterrupted(told_in_this_call(*solver), [&] {
            solver->solver->set_stiffness({stiffness_kpa, model.materials.size()});
            solver->model = std::move(model);
            solver->stiffness = assemble_stiffness(solver->model);
        });
        return PALPATE_OK;
    });
}

palpate_status palpate_solver_solve(palpate_solver* solver, const double* load,
                                    std::int32_t columns, double* displacement, double* reaction) {
    return guarded([&] {
        const auto held = hold(solver, "the solver");
        check_count(columns, "columns");
        require(displacement, "the place for the displacement");
        const Columns b = columns_at(*solver, load, columns, "the load");
        if (!b.allFinite())
            throw Error(ErrorCode::invalid_argument, "a load is not a finite number");
        Columns x;
        const LinearSolverSummary summary = solver->solver->solve(b, x, told_in_this_call(*solver));
        std::copy_n(x.data(), x.size(), displacement);
        if (reaction) {
            multiply(*solver, x.data(), columns, reaction);
            Eigen::Map<Columns> all(reaction, b.rows(), b.cols());
            for (Index d = 0; d < solver->model.num_dofs(); ++d)
                if (!solver->model.prescribed[d]) all.row(d).setZero();
        }
        if (summary.converged) return PALPATE_OK;
        capi::last_error() = fmt::format("the solver stopped at a relative residual of {:.2g}: {}",
                                         summary.relative_residual, summary.message);
        return PALPATE_NOT_CONVERGED;
    });
}

palpate_status palpate_solver_gradient(palpate_solver* solver, const double* displacement,
                                       const double* slope, std::int32_t columns, double* by_load,
                                       double* by_stiffness) {
    return guarded([&] {
        const auto held = hold(solver, "the solver");
        check_count(columns, "columns");
        require(by_load, "the place for the gradient");
        const ConstColumns u = columns_at(*solver, displacement, columns, "the displacement");
        const ConstColumns by_u = columns_at(*solver, slope, columns, "the slope");
        if (!u.allFinite() || !by_u.allFinite())
            throw Error(ErrorCode::invalid_argument,
                        "a displacement or a slope is not a finite number");
        const LoadGradient gradient =
            load_gradient(solver->model, *solver->solver, u, by_u, told_in_this_call(*solver));
        std::copy_n(gradient.load.data(), gradient.load.size(), by_load);
        if (by_stiffness)
            std::copy_n(gradient.stiffness_kpa.data(), gradient.stiffness_kpa.size(), by_stiffness);
        return PALPATE_OK;
    });
}

palpate_status palpate_solver_apply(palpate_solver* solver, const double* x, std::int32_t columns,
                                    double* y) {
    return guarded([&] {
        const auto held = hold(solver, "the solver");
        check_count(columns, "columns");
        require(x, "the displacement");
        require(y, "the place for the forces");
        multiply(*solver, x, columns, y);
        return PALPATE_OK;
    });
}

const char* palpate_solver_description(const palpate_solver* solver) {
    const auto body = capi::found(solver);
    return body ? body->description.c_str() : "";
}
