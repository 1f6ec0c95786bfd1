// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "solver/backend/solid_device.hpp"
#include "solver/backend/solid_tables.hpp"
#include "solver/backends/opencl/session.hpp"

namespace palpate {

/// One SolidModel on the device: a launch per law, then one that gathers. The headers of
/// kernels/solid_*.cl say what each buffer holds. Displacements are [3 num_nodes] mm.
class DeviceSolid {
public:
    /// `tables` outlive it.
    DeviceSolid(Session& session, const SolidTables& tables);

    SolidForce internal_force(std::span<const double> u);
    /// Into blocks [graph.items, 9].
    void tangent(std::span<const double> u, std::span<double> blocks);
    void linearise(std::span<const double> u);
    /// y = K x at the state of `linearise`.
    void apply(const cl::Buffer& x, const cl::Buffer& y, std::size_t num_columns);
    std::vector<std::vector<double>> parameter_products(std::span<const double> u,
                                                        std::span<const double> lambda);

private:
    /// The elements of one law and the coefficients of its materials.
    struct Law {
        std::string_view name;
        std::size_t num_elements;
        cl::Buffer list, coefficients;
    };

    /// Starts the kernel of that name for every law; `args` follow the mesh.
    template <class... Args>
    void run_laws(const char* kernel, const ColumnPass& pass, const Args&... args);
    /// y[:, first .. first + width) from the forces of the elements; `unused`: any other buffer.
    void gather_to_nodes(const cl::Buffer& parts, const cl::Buffer& unused, const cl::Buffer& y,
                         std::size_t num_columns, const ColumnPass& pass, std::size_t first,
                         std::size_t width);

    Session& session_;
    const SolidTables& tables_;
    std::vector<Law> laws_;
    cl::Buffer elements_, region_, points_;
    cl::Buffer node_start_, node_corners_, block_start_, block_items_;
    cl::Buffer state_;           ///< of `linearise`
    cl::Buffer element_blocks_;  ///< of the elements, for `tangent`
    cl::Buffer forces_;          ///< of the elements, for a product
    std::size_t forces_columns_ = 0;
};

}  // namespace palpate
