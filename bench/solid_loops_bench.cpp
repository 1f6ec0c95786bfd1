// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// How long do the element loops of large deformation take on each back end? A box of neo-Hookean
// tetrahedra at 10 % strain; `host` is SolidAssembly, which equilibrium uses. Figures in
// docs/performance.md.
//   force    energy and forces, with copies to and from the device
//   tangent  all blocks of the stiffness, with copies
//   product  of the stiffness with 1 or 16 columns, from the elements, without copies
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <string>

#include "bench/solid_problem.hpp"
#include "solver/backend/registry.hpp"
#include "solver/base/error.hpp"
#include "solver/equilibrium/solid_assembly.hpp"

namespace palpate {
namespace {

constexpr bench::SolidSize sizes[] = {bench::small_solid, bench::seed_size_solid,
                                      bench::quadratic_solid};

Eigen::VectorXd compressed(const SolidModel& model) {
    Eigen::VectorXd u = Eigen::VectorXd::Zero(model.num_dofs());
    for (Index n = 0; n < model.mesh.num_nodes(); ++n)
        u[3 * n + 2] = -0.1 * model.mesh.nodes[n].z() + 0.3 * std::sin(model.mesh.nodes[n].x());
    return u;
}

std::span<const double> span_of(const Eigen::VectorXd& v) {
    return {v.data(), static_cast<std::size_t>(v.size())};
}

/// A model on a back end, checked against the host once.
struct Contender {
    std::unique_ptr<Backend> backend;
    std::unique_ptr<SolidDevice> solid;
    SolidModel model;
    Eigen::VectorXd u;
    BlockMatrix matrix;
    std::unique_ptr<DeviceVector> x, y;
};

Contender contender(const std::string& name, Precision precision, const bench::SolidSize& size) {
    Contender made;
    made.backend = make_backend(name, {precision, {}, ""});
    made.model = bench::compressed_box(size).model;
    made.solid = made.backend->make_solid(made.model);
    made.u = compressed(made.model);
    const SolidAssembly host(made.model);
    made.matrix = host.make_matrix();
    const InternalForce expected = host.internal_force(made.u);
    const SolidForce found = made.solid->internal_force(span_of(made.u));
    const Eigen::Map<const Eigen::VectorXd> force(found.force.data(), made.u.size());
    if (!((force - expected.force).norm() <= 1e-4 * expected.force.norm()))
        throw Error(ErrorCode::internal, "failed: the forces are not those of the host");
    return made;
}

void count(benchmark::State& state, const SolidModel& model) {
    state.counters["elements/s"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * model.mesh.num_elements(),
                           benchmark::Counter::kIsRate);
}

/// Rows that this machine cannot run say why.
template <typename Work>
void measure(benchmark::State& state, const std::string& name, Precision precision,
             const bench::SolidSize& size, Work&& work) {
    try {
        Contender made = contender(name, precision, size);
        work(made);  // builds kernels
        for (auto _ : state) work(made);
        count(state, made.model);
    } catch (const Error& error) {
        state.SkipWithError((std::string("skipped: ") + error.what()).c_str());
    }
}

void add_backend(const std::string& name, Precision precision, const bench::SolidSize& size) {
    const std::string row =
        name + (precision == Precision::single ? "/single/" : "/double/") + size.name;
    const auto add = [&](const std::string& what, auto work) {
        benchmark::RegisterBenchmark(
            (what + "/" + row).c_str(),
            [=](benchmark::State& state) { measure(state, name, precision, size, work); })
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime();
    };
    add("force", [](Contender& c) { c.solid->internal_force(span_of(c.u)); });
    add("tangent", [](Contender& c) { c.solid->tangent(span_of(c.u), c.matrix); });
    for (const Index columns : {1, 16})
        add("product" + std::to_string(columns), [columns](Contender& c) {
            if (!c.x) {
                c.x = c.backend->make_vector(c.model.num_dofs(), columns);
                c.y = c.backend->make_vector(c.model.num_dofs(), columns);
                c.backend->fill(*c.x, 1);
                c.solid->linearise(span_of(c.u));
            }
            c.solid->apply(*c.x, *c.y);
            c.backend->wait();
        });
}

void add_host(const bench::SolidSize& size) {
    const auto add = [&](const char* what, auto work) {
        benchmark::RegisterBenchmark((std::string(what) + "/host/double/" + size.name).c_str(),
                                     [=](benchmark::State& state) {
                                         const SolidModel model = bench::compressed_box(size).model;
                                         const SolidAssembly host(model);
                                         const Eigen::VectorXd u = compressed(model);
                                         BlockMatrix matrix = host.make_matrix();
                                         for (auto _ : state) work(host, u, matrix);
                                         count(state, model);
                                     })
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime();
    };
    add("force", [](const SolidAssembly& host, const Eigen::VectorXd& u, BlockMatrix&) {
        benchmark::DoNotOptimize(host.internal_force(u).energy);
    });
    add("tangent", [](const SolidAssembly& host, const Eigen::VectorXd& u, BlockMatrix& matrix) {
        host.tangent(u, matrix);
    });
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
    using namespace palpate;
    for (const bench::SolidSize& size : sizes) {
        add_host(size);
        for (const BackendEntry& entry : backend_registry())
            for (const Precision precision : {Precision::single, Precision::double_})
                if (entry.name != "reference" || precision == Precision::double_)
                    add_backend(entry.name, precision, size);
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
