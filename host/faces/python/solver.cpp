// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <memory>
#include <mutex>
#include <optional>

#include "host/faces/python/arrays.hpp"
#include "host/faces/python/call.hpp"
#include "host/faces/python/module.hpp"
#include "host/faces/python/solver_choice.hpp"

namespace palpate_python {

using namespace nb::literals;

namespace {

class Solver {
public:
    Solver(const Doubles& nodes, const Numbers& elements, const std::optional<Numbers>& regions,
           const Doubles& stiffness_kpa, const Doubles& poisson_ratio, const Flags& prescribed,
           const SolverChoice& choice, nb::object progress)
        : progress_(std::make_unique<Progress>(std::move(progress))) {
        require_shape(nodes.ndim() == 2 && nodes.shape(1) == 3, "nodes must be [num_nodes, 3]");
        require_shape(elements.ndim() == 2 && elements.shape(1) == 4,
                      "elements must be [num_elements, 4]");
        require_shape(!regions || (regions->ndim() == 1 && regions->shape(0) == elements.shape(0)),
                      "regions must be [num_elements]");
        require_shape(stiffness_kpa.ndim() == 1 && poisson_ratio.ndim() == 1 &&
                          stiffness_kpa.shape(0) == poisson_ratio.shape(0),
                      "moduli and Poisson's ratios must be [num_regions]");
        require_shape(prescribed.ndim() == 2 && prescribed.shape(0) == nodes.shape(0) &&
                          prescribed.shape(1) == 3,
                      "prescribed must be [num_nodes, 3]");
        palpate_model model;
        palpate_model_init(&model);
        model.num_nodes = static_cast<std::int32_t>(nodes.shape(0));
        model.nodes = nodes.data();
        model.num_elements = static_cast<std::int32_t>(elements.shape(0));
        model.elements = elements.data();
        model.regions = regions ? regions->data() : nullptr;
        model.num_regions = static_cast<std::int32_t>(stiffness_kpa.shape(0));
        model.stiffness_kpa = stiffness_kpa.data();
        model.poisson_ratio = poisson_ratio.data();
        model.prescribed = prescribed.data();
        num_nodes_ = nodes.shape(0);
        num_regions_ = stiffness_kpa.shape(0);
        palpate_solver_options options = choice.options();
        options.progress = Progress::call;
        options.progress_user = progress_.get();
        palpate_solver* made = nullptr;
        progress_->run([&] { return palpate_solver_create(&model, &options, &made); });
        handle_.reset(made);
    }

    void set_stiffness(const Doubles& stiffness_kpa) {
        require_shape(stiffness_kpa.ndim() == 1 && stiffness_kpa.shape(0) == num_regions_,
                      "moduli must be [num_regions]");
        run([&] { return palpate_solver_set_stiffness(handle_.get(), stiffness_kpa.data()); });
    }

    /// (displacement, reaction, converged)
    nb::tuple solve(const Doubles& load) {
        const std::size_t columns = columns_of(load);
        Array displacement = like(load), reaction = like(load);
        const palpate_status status = run([&] {
            return palpate_solver_solve(handle_.get(), load.data(),
                                        static_cast<std::int32_t>(columns), displacement.data(),
                                        reaction.data());
        });
        return nb::make_tuple(displacement, reaction, status == PALPATE_OK);
    }

    /// (by_load, by_stiffness)
    nb::tuple gradient(const Doubles& displacement, const Doubles& slope) {
        const std::size_t columns = columns_of(displacement);
        require_shape(columns_of(slope) == columns, "slope must have the shape of displacement");
        Array by_load = like(slope), by_stiffness = new_array({num_regions_});
        run([&] {
            return palpate_solver_gradient(handle_.get(), displacement.data(), slope.data(),
                                           static_cast<std::int32_t>(columns), by_load.data(),
                                           by_stiffness.data());
        });
        return nb::make_tuple(by_load, by_stiffness);
    }

    Array apply(const Doubles& x) {
        const std::size_t columns = columns_of(x);
        Array y = like(x);
        run([&] {
            return palpate_solver_apply(handle_.get(), x.data(), static_cast<std::int32_t>(columns),
                                        y.data());
        });
        return y;
    }

    std::string description() const { return palpate_solver_description(handle_.get()); }
    std::size_t num_nodes() const { return num_nodes_; }
    std::size_t num_regions() const { return num_regions_; }
    nb::object& function() { return progress_->function(); }

private:
    /// A solver serves one call at a time; Python's other threads go on meanwhile.
    template <class Work>
    palpate_status run(Work&& work) {
        return progress_->run([&] {
            const std::lock_guard lock(mutex_);
            return work();
        });
    }
    std::size_t columns_of(const Doubles& x) const {
        require_shape(
            (x.ndim() == 2 || x.ndim() == 3) && x.shape(0) == num_nodes_ && x.shape(1) == 3,
            "an array of nodes must be [num_nodes, 3] or [num_nodes, 3, columns]");
        return x.ndim() == 3 ? x.shape(2) : 1;
    }
    Array like(const Doubles& x) const {
        if (x.ndim() == 3) return new_array({x.shape(0), x.shape(1), x.shape(2)});
        return new_array({x.shape(0), x.shape(1)});
    }

    struct Free {
        void operator()(palpate_solver* solver) const { palpate_solver_free(solver); }
    };
    std::mutex mutex_;
    std::unique_ptr<Progress> progress_;
    std::unique_ptr<palpate_solver, Free> handle_;
    std::size_t num_nodes_ = 0, num_regions_ = 0;
};

// A progress function often belongs to an object that has the solver: a cycle that Python must see.
int visit_function(PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    if (nb::inst_ready(self)) Py_VISIT(nb::inst_ptr<Solver>(self)->function().ptr());
    return 0;
}

int clear_function(PyObject* self) {
    if (nb::inst_ready(self)) nb::inst_ptr<Solver>(self)->function() = nb::none();
    return 0;
}

PyType_Slot solver_slots[] = {{Py_tp_traverse, reinterpret_cast<void*>(visit_function)},
                              {Py_tp_clear, reinterpret_cast<void*>(clear_function)},
                              {0, nullptr}};

}  // namespace

void add_solver(nb::module_& m) {
    nb::class_<SolverChoice>(m, "SolverChoice")
        .def(nb::init<>())
        .def_rw("method", &SolverChoice::method)
        .def_rw("backend", &SolverChoice::backend)
        .def_rw("device", &SolverChoice::device)
        .def_rw("use_double", &SolverChoice::use_double)
        .def_rw("relative_tolerance", &SolverChoice::relative_tolerance)
        .def_rw("expected_columns", &SolverChoice::expected_columns);

    nb::class_<Solver>(m, "Solver", nb::type_slots(solver_slots))
        .def(nb::init<const Doubles&, const Numbers&, const std::optional<Numbers>&, const Doubles&,
                      const Doubles&, const Flags&, const SolverChoice&, nb::object>(),
             "nodes"_a.noconvert(), "elements"_a.noconvert(), "regions"_a.none().noconvert(),
             "stiffness_kpa"_a.noconvert(), "poisson_ratio"_a.noconvert(),
             "prescribed"_a.noconvert(), "choice"_a, "progress"_a.none())
        .def("set_stiffness", &Solver::set_stiffness, "stiffness_kpa"_a.noconvert())
        .def("solve", &Solver::solve, "load"_a.noconvert())
        .def("gradient", &Solver::gradient, "displacement"_a.noconvert(), "slope"_a.noconvert())
        .def("apply", &Solver::apply, "displacement"_a.noconvert())
        .def_prop_ro("description", &Solver::description)
        .def_prop_ro("num_nodes", &Solver::num_nodes)
        .def_prop_ro("num_regions", &Solver::num_regions);
}

}  // namespace palpate_python
