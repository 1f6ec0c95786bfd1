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

class Labels {
public:
    Labels(const Voxels& voxels, std::array<double, 3> spacing, std::array<double, 3> origin,
           std::array<double, 9> direction, std::string name)
        : voxels_(voxels), name_(std::move(name)) {
        palpate_labels_init(&labels_);
        for (int i = 0; i < 3; ++i) {
            labels_.size[i] = static_cast<std::int32_t>(voxels.shape(2 - i));
            labels_.spacing[i] = spacing[i];
            labels_.origin[i] = origin[i];
        }
        for (int i = 0; i < 9; ++i) labels_.direction[i] = direction[i];
        labels_.voxels = voxels_.data();
        labels_.name = name_.c_str();
    }
    Labels(const Labels&) = delete;
    const palpate_labels* get() const { return &labels_; }

private:
    Voxels voxels_;
    std::string name_;
    palpate_labels labels_;
};

class Result {
public:
    /// Holds what `make`, which returns a status, makes.
    template <class Make>
    palpate_status take(Make&& make) {
        palpate_result* made = nullptr;
        const palpate_status status = make(&made);
        handle_.reset(made);
        converged_ = status == PALPATE_OK;
        return status;
    }

    bool converged() const { return converged_; }
    std::string json() const { return palpate_result_json(handle_.get()); }
    void write(const std::string& folder, const std::string& fields) const {
        palpate_write_options options;
        palpate_write_options_init(&options);
        options.fields = fields.c_str();
        Progress(nb::none()).run([&] {
            return palpate_result_write_with(handle_.get(), folder.c_str(), &options);
        });
    }
    const palpate_result* get() const { return handle_.get(); }

private:
    struct Free {
        void operator()(palpate_result* result) const { palpate_result_free(result); }
    };
    std::unique_ptr<palpate_result, Free> handle_;
    bool converged_ = false;
};

nb::object regions_of(const Result& result) {
    nb::list list;
    for (std::int32_t k = 0; k < palpate_result_num_regions(result.get()); ++k) {
        palpate_region region{};
        region.struct_size = sizeof region;
        check(palpate_result_region(result.get(), k, &region));
        nb::dict entry;
        entry["name"] = region.name;
        entry["label"] = region.label;
        entry["role"] = region.role;
        entry["verdict"] = region.verdict;
        entry["reason"] = region.reason;
        entry["stiffness_kpa"] = region.stiffness_kpa;
        entry["interval_kpa"] = nb::make_tuple(region.interval_kpa[0], region.interval_kpa[1]);
        entry["poisson_ratio"] = region.poisson_ratio;
        entry["most_probable_kpa"] = region.most_probable_kpa;
        list.append(entry);
    }
    return list;
}

/// How a recovery is done: palpate_recover_options with strings of its own.
struct RecoverChoice {
    std::string settings, align = "auto", material = "linear", element = "tet4", mesh, mesh_program;
    std::int32_t num_nodes = 0;
    SolverChoice solver;
};

template <class Run>
Result recovered(const RecoverChoice& choice, nb::object function, Run&& run) {
    Progress progress(std::move(function));
    const palpate_solver_options solver = choice.solver.options();
    palpate_recover_options options;
    palpate_recover_options_init(&options);
    options.settings_toml = choice.settings.c_str();
    options.align = choice.align.c_str();
    options.material = choice.material.c_str();
    options.element = choice.element.c_str();
    if (!choice.mesh.empty()) options.mesh = choice.mesh.c_str();
    if (!choice.mesh_program.empty()) options.mesh_program = choice.mesh_program.c_str();
    options.num_nodes = choice.num_nodes;
    options.solver = &solver;
    options.progress = Progress::call;
    options.progress_user = &progress;
    Result result;
    progress.run(
        [&] { return result.take([&](palpate_result** made) { return run(&options, made); }); });
    return result;
}

}  // namespace

void add_recovery(nb::module_& m) {
    nb::class_<Labels>(m, "Labels")
        .def(nb::init<const Voxels&, std::array<double, 3>, std::array<double, 3>,
                      std::array<double, 9>, std::string>(),
             "voxels"_a.noconvert(), "spacing"_a, "origin"_a, "direction"_a, "name"_a);

    nb::class_<Result>(m, "Result")
        .def_prop_ro("converged", &Result::converged)
        .def_prop_ro("json", &Result::json)
        .def_prop_ro("regions", &regions_of)
        .def("write", &Result::write, "folder"_a, "fields"_a)
        .def_prop_ro("nodes",
                     [](nb::handle self) {
                         const palpate_result* r = nb::cast<Result&>(self).get();
                         return view(self, palpate_result_nodes(r), palpate_result_num_nodes(r), 3);
                     })
        .def_prop_ro("displacement",
                     [](nb::handle self) {
                         const palpate_result* r = nb::cast<Result&>(self).get();
                         return view(self, palpate_result_displacement(r),
                                     palpate_result_num_nodes(r), 3);
                     })
        .def_prop_ro("force",
                     [](nb::handle self) {
                         const palpate_result* r = nb::cast<Result&>(self).get();
                         return view(self, palpate_result_force(r), palpate_result_num_nodes(r), 3);
                     })
        .def_prop_ro("elements",
                     [](nb::handle self) {
                         const palpate_result* r = nb::cast<Result&>(self).get();
                         return view(self, palpate_result_elements(r),
                                     palpate_result_num_elements(r),
                                     palpate_result_nodes_per_element(r));
                     })
        .def_prop_ro("element_stiffness_kpa",
                     [](nb::handle self) {
                         const palpate_result* r = nb::cast<Result&>(self).get();
                         return view(self, palpate_result_stiffness(r),
                                     palpate_result_num_elements(r));
                     })
        .def_prop_ro("displacement_field", [](nb::handle self) {
            std::int32_t size[3] = {0, 0, 0};
            const double* field = palpate_result_field(nb::cast<Result&>(self).get(), size);
            return view(self, field, size[2], size[1], size[0], 3);
        });

    nb::class_<RecoverChoice>(m, "RecoverChoice")
        .def(nb::init<>())
        .def_rw("settings", &RecoverChoice::settings)
        .def_rw("align", &RecoverChoice::align)
        .def_rw("material", &RecoverChoice::material)
        .def_rw("element", &RecoverChoice::element)
        .def_rw("mesh", &RecoverChoice::mesh)
        .def_rw("mesh_program", &RecoverChoice::mesh_program)
        .def_rw("num_nodes", &RecoverChoice::num_nodes)
        .def_rw("solver", &RecoverChoice::solver);
    m.def(
        "recover",
        [](const Labels& reference, const Labels& target, const RecoverChoice& choice,
           nb::object progress) {
            return recovered(choice, std::move(progress),
                             [&](const palpate_recover_options* options, palpate_result** result) {
                                 return palpate_recover(reference.get(), target.get(), options,
                                                        result);
                             });
        },
        "reference"_a, "target"_a, "choice"_a, "progress"_a.none());
    m.def(
        "recover_files",
        [](const std::string& reference, const std::string& target, const RecoverChoice& choice,
           nb::object progress) {
            return recovered(choice, std::move(progress),
                             [&](const palpate_recover_options* options, palpate_result** result) {
                                 return palpate_recover_files(reference.c_str(), target.c_str(),
                                                              options, result);
                             });
        },
        "reference"_a, "target"_a, "choice"_a, "progress"_a.none());
}

}  // namespace palpate_python
