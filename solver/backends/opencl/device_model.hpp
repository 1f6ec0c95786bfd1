// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "solver/backends/opencl/device_blocks.hpp"
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
    /// What `job` makes of the product with the constrained K; returns the number of parts of its
    /// sum.
    std::size_t run(const RowJob& job);
    /// The choices of an automatic product so far, by ascending number of columns.
    std::vector<ProductChoice> choices() const;
    /// y = K x without regard to prescribed dofs.
    void internal_force(const cl::Buffer& x, const cl::Buffer& y, std::size_t num_columns);
    /// z = weight D^-1 r; returns the number of parts of r . z in `sum`, if given.
    std::size_t apply_inverse_diagonal(double weight, const cl::Buffer& r, const cl::Buffer& z,
                                       const cl::Buffer* sum, std::size_t num_columns);
    /// lambda_c . K_r x_c at unit modulus: [num_materials, num_columns].
    std::vector<double> energy_products(const cl::Buffer& lambda, const cl::Buffer& x,
                                        std::size_t num_columns);
    /// 1/2 x_c . K x_c: [num_columns].
    void strain_energy(const cl::Buffer& x, std::span<double> energy);

private:
    bool holds(Product product) const {
        return product_ == product || product_ == Product::automatic;
    }
    std::size_t run(const RowJob& job, Product product);
    Product product_for(std::size_t num_columns);
    ProductChoice measure_products(std::size_t num_columns);
    /// What a choice depends on beside the device and the number of columns.
    std::string setting() const;
    /// Columns whose element forces are held at a time.
    std::size_t pass_columns() const;
    void upload_mesh(const Mesh& mesh);
    void upload_assembly_tables(const Mesh& mesh, const Adjacency& corners);
    void compute_stiffness();
    std::size_t multiply_elements(const RowJob& job, bool constrained, bool recomputed);
    std::size_t multiply_pass(const RowJob& job, bool constrained, bool recomputed,
                              std::size_t first, std::size_t count);

    Session& session_;
    Product product_;
    Index num_nodes_ = 0;
    Index num_elements_ = 0;
    Index num_chunks_ = 0;
    std::vector<double> stiffness_kpa_;
    std::vector<Index> chunk_region_;
    cl::Buffer elements_, region_, geometry_, unit_moduli_, stiffness_, prescribed_;
    cl::Buffer node_start_, node_corners_, inverse_blocks_, region_order_, chunk_start_;
    cl::Buffer nodes_;                    ///< Product::recomputed
    cl::Buffer corner_slots_;             ///< Product::assembled
    std::optional<DeviceBlocks> blocks_;  ///< Product::assembled
    cl::Buffer forces_;                   ///< element forces of one pass
    std::size_t forces_columns_ = 0;
};

}  // namespace palpate
