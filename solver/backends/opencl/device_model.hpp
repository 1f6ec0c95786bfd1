// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "solver/backends/opencl/model_tables.hpp"
#include "solver/backends/opencl/session.hpp"
#include "solver/model/model.hpp"

namespace palpate {

/// One model on the device. The headers of kernels/*.cl say what each buffer holds.
class DeviceModel {
public:
    /// Brings the model to the device and computes geometry and stiffness there.
    DeviceModel(Session& session, const Model& model, Product product);

    Index num_nodes() const { return num_nodes_; }
    Index num_rows() const { return 3 * num_nodes_; }
    Index num_materials() const { return static_cast<Index>(stiffness_kpa_.size()); }

    void set_stiffness(std::span<const double> stiffness_kpa);
    /// y = K x; identity at prescribed dofs if `constrained`.
    void multiply(const cl::Buffer& x, const cl::Buffer& y, std::size_t num_columns,
                  bool constrained);
    /// z = D^-1 r
    void apply_block_jacobi(const cl::Buffer& r, const cl::Buffer& z, std::size_t num_columns);
    /// lambda_c . K_r x_c at unit modulus: [num_materials, num_columns].
    std::vector<double> energy_products(const cl::Buffer& lambda, const cl::Buffer& x,
                                        std::size_t num_columns);
    /// 1/2 x_c . K x_c: [num_columns].
    void strain_energy(const cl::Buffer& x, std::span<double> energy);

private:
    void upload_mesh(const Mesh& mesh);
    void upload_assembly_tables(const Mesh& mesh, const Adjacency& corners);
    void compute_stiffness();
    void multiply_assembled(const cl::Buffer& x, const cl::Buffer& y, std::size_t num_columns);
    void multiply_elements(const cl::Buffer& x, const cl::Buffer& y, std::size_t num_columns,
                           std::size_t first, std::size_t count, bool constrained);

    Session& session_;
    Product product_;
    Index num_nodes_ = 0;
    Index num_elements_ = 0;
    Index num_chunks_ = 0;
    std::vector<double> stiffness_kpa_;
    std::vector<Index> chunk_region_;
    cl::Buffer elements_, region_, geometry_, unit_moduli_, stiffness_, prescribed_;
    cl::Buffer node_start_, node_corners_, inverse_blocks_, region_order_, chunk_start_;
    cl::Buffer corner_slots_, row_start_, block_node_, blocks_;  ///< Product::assembled only
    cl::Buffer forces_;                                          ///< element forces of one pass
    std::size_t forces_columns_ = 0;
};

}  // namespace palpate
