// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>

#include <array>
#include <memory>

#include "host/faces/python/arrays.hpp"
#include "host/faces/python/call.hpp"
#include "host/faces/python/module.hpp"
#include "host/faces/python/solver_choice.hpp"

namespace palpate_python {

using namespace nb::literals;

namespace {

class Phantom {
public:
    Phantom(std::uint32_t seed, double stiffness_kpa, double background_stiffness_kpa,
            std::array<double, 3> spacing, std::int32_t num_nodes, const std::string& material,
            const std::string& mesh_program, const SolverChoice& choice, nb::object function) {
        Progress progress(std::move(function));
        const palpate_solver_options solver = choice.options();
        palpate_phantom_options options;
        palpate_phantom_options_init(&options);
        options.seed = seed;
        options.stiffness_kpa = stiffness_kpa;
        options.background_stiffness_kpa = background_stiffness_kpa;
        for (std::size_t i = 0; i < 3; ++i) options.spacing[i] = spacing[i];
        if (num_nodes > 0) options.num_nodes = num_nodes;
        options.material = material.c_str();
        if (!mesh_program.empty()) options.mesh_program = mesh_program.c_str();
        options.solver = &solver;
        options.progress = Progress::call;
        options.progress_user = &progress;
        palpate_phantom* made = nullptr;
        progress.run([&] {
            const palpate_status status = palpate_phantom_pelvis(&options, &made);
            handle_.reset(made);
            return status;
        });
    }
    palpate_labels labels(int state) const {
        palpate_labels labels;
        palpate_labels_init(&labels);
        check(palpate_phantom_labels(handle_.get(), state, &labels));
        return labels;
    }
    std::string settings() const { return palpate_phantom_settings(handle_.get()); }

private:
    struct Free {
        void operator()(palpate_phantom* phantom) const { palpate_phantom_free(phantom); }
    };
    std::unique_ptr<palpate_phantom, Free> handle_;
};

nb::dict labels_dict(nb::handle owner, int state) {
    const palpate_labels labels = nb::cast<Phantom&>(owner).labels(state);
    nb::dict entry;
    entry["voxels"] = view(owner, labels.voxels, labels.size[2], labels.size[1], labels.size[0]);
    entry["spacing"] = nb::make_tuple(labels.spacing[0], labels.spacing[1], labels.spacing[2]);
    entry["origin"] = nb::make_tuple(labels.origin[0], labels.origin[1], labels.origin[2]);
    nb::list direction;
    for (const double value : labels.direction) direction.append(value);
    entry["direction"] = nb::tuple(direction);
    return entry;
}

}  // namespace

void add_phantom(nb::module_& m) {
    nb::class_<Phantom>(m, "Phantom")
        .def(nb::init<std::uint32_t, double, double, std::array<double, 3>, std::int32_t,
                      const std::string&, const std::string&, const SolverChoice&, nb::object>(),
             "seed"_a, "stiffness_kpa"_a, "background_stiffness_kpa"_a, "spacing"_a, "num_nodes"_a,
             "material"_a, "mesh_program"_a, "solver"_a, "progress"_a.none())
        .def_prop_ro("settings", &Phantom::settings)
        .def_prop_ro("reference", [](nb::handle self) { return labels_dict(self, 0); })
        .def_prop_ro("target", [](nb::handle self) { return labels_dict(self, 1); });
}

}  // namespace palpate_python
