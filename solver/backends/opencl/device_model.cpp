// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/device_model.hpp"

#include <algorithm>

namespace palpate {
namespace {

constexpr std::size_t max_pass_columns = 16;  // columns whose element forces are held at a time
constexpr Index element_reals = 10;           // ELEMENT_REALS of elements/tet4.cl
constexpr std::size_t block_padding = 3;      // reals that block_csr.cl may read past the end
constexpr Index tets_per_chunk_cpu = 512;
constexpr Index tets_per_chunk_gpu = 32;

std::vector<double> unit_moduli(const std::vector<LinearElastic>& materials) {
    std::vector<double> moduli;
    for (const LinearElastic& m : materials) {
        moduli.push_back(m.unit_lambda());
        moduli.push_back(m.unit_mu());
    }
    return moduli;
}

std::vector<Index> flat(const std::vector<Tet>& tets) {
    std::vector<Index> nodes;
    nodes.reserve(4 * tets.size());
    for (const Tet& tet : tets) nodes.insert(nodes.end(), tet.begin(), tet.end());
    return nodes;
}

}  // namespace

DeviceModel::DeviceModel(Session& session, const Model& model, Product product)
    : session_(session),
      product_(product),
      num_nodes_(model.mesh.num_nodes()),
      num_elements_(model.mesh.num_tets()) {
    for (const LinearElastic& m : model.materials) stiffness_kpa_.push_back(m.stiffness_kpa);
    unit_moduli_ = session_.upload_real(unit_moduli(model.materials));
    stiffness_ = session_.upload_real(stiffness_kpa_);
    prescribed_ = session_.upload(model.prescribed);
    upload_mesh(model.mesh);
    inverse_blocks_ = session_.make_real_buffer(std::size_t(9) * num_nodes_);
    compute_stiffness();
}

void DeviceModel::upload_mesh(const Mesh& mesh) {
    const Adjacency corners = corners_of_nodes(mesh);
    elements_ = session_.upload(flat(mesh.tets));
    region_ = session_.upload(mesh.region);
    node_start_ = session_.upload(corners.offsets);
    node_corners_ = session_.upload(corners.items);
    if (product_ == Product::assembled) upload_assembly_tables(mesh, corners);

    const RegionChunks chunks = region_chunks(
        mesh, num_materials(), session_.device().is_cpu ? tets_per_chunk_cpu : tets_per_chunk_gpu);
    num_chunks_ = static_cast<Index>(chunks.region.size());
    chunk_region_ = chunks.region;
    region_order_ = session_.upload(chunks.order);
    chunk_start_ = session_.upload(chunks.start);

    const cl::Buffer edges = session_.upload_real(tet_edges(mesh));
    geometry_ = session_.make_real_buffer(std::size_t(element_reals) * num_elements_);
    session_.run({"element_geometry", "element_geometry"}, num_elements_, single_column, edges,
                 geometry_, cl_int(num_elements_));
}

void DeviceModel::upload_assembly_tables(const Mesh& mesh, const Adjacency& corners) {
    const Adjacency pattern = node_graph(mesh);
    corner_slots_ = session_.upload(corner_slots(mesh, corners, pattern));
    row_start_ = session_.upload(pattern.offsets);
    block_node_ = session_.upload(pattern.items);
    blocks_ = session_.make_real_buffer(9 * pattern.items.size() + block_padding);
}

void DeviceModel::set_stiffness(std::span<const double> stiffness_kpa) {
    stiffness_kpa_.assign(stiffness_kpa.begin(), stiffness_kpa.end());
    session_.write_real(stiffness_kpa_, stiffness_);
    compute_stiffness();
}

void DeviceModel::compute_stiffness() {
    session_.run({"diagonal_blocks", "invert_diagonal_blocks"}, num_nodes_, single_column, region_,
                 geometry_, unit_moduli_, stiffness_, prescribed_, node_start_, node_corners_,
                 inverse_blocks_, cl_int(num_nodes_));
    if (product_ == Product::assembled)
        session_.run({"stiffness_blocks", "stiffness_blocks"}, num_nodes_, single_column, region_,
                     geometry_, unit_moduli_, stiffness_, prescribed_, node_start_, node_corners_,
                     corner_slots_, row_start_, block_node_, blocks_, cl_int(num_nodes_));
}

void DeviceModel::multiply(const cl::Buffer& x, const cl::Buffer& y, std::size_t num_columns,
                           bool constrained) {
    if (constrained && product_ == Product::assembled) {
        multiply_assembled(x, y, num_columns);
        return;
    }
    for (std::size_t first = 0; first < num_columns; first += max_pass_columns)
        multiply_elements(x, y, num_columns, first, std::min(max_pass_columns, num_columns - first),
                          constrained);
}

void DeviceModel::multiply_assembled(const cl::Buffer& x, const cl::Buffer& y,
                                     std::size_t num_columns) {
    for (const ColumnPass& pass : session_.passes(num_columns))
        session_.run({"block_csr", "block_csr_apply"}, num_nodes_, pass, row_start_, block_node_,
                     blocks_, x, y, cl_int(num_nodes_), cl_int(num_columns), cl_int(pass.first));
}

void DeviceModel::multiply_elements(const cl::Buffer& x, const cl::Buffer& y,
                                    std::size_t num_columns, std::size_t first, std::size_t count,
                                    bool constrained) {
    if (count > forces_columns_) {
        forces_ = session_.make_real_buffer(std::size_t(12) * num_elements_ * count);
        forces_columns_ = count;
    }
    for (const ColumnPass& pass : session_.passes(count)) {
        const cl_int begin = cl_int(first + pass.first);
        const cl_int width = cl_int(pass.groups * pass.width);
        session_.run({"stiffness_apply", "stiffness_apply", constrained}, num_elements_, pass,
                     elements_, region_, geometry_, unit_moduli_, stiffness_, prescribed_, x,
                     forces_, cl_int(num_elements_), cl_int(num_columns), begin, width);
        session_.run({"gather_to_nodes", "gather_to_nodes", constrained}, num_nodes_, pass,
                     node_start_, node_corners_, forces_, prescribed_, x, y, cl_int(num_nodes_),
                     cl_int(num_columns), begin, width);
    }
}

void DeviceModel::apply_block_jacobi(const cl::Buffer& r, const cl::Buffer& z,
                                     std::size_t num_columns) {
    for (const ColumnPass& pass : session_.passes(num_columns))
        session_.run({"block_jacobi", "block_jacobi"}, num_nodes_, pass, inverse_blocks_, r, z,
                     cl_int(num_nodes_), cl_int(num_columns), cl_int(pass.first));
}

std::vector<double> DeviceModel::energy_products(const cl::Buffer& lambda, const cl::Buffer& x,
                                                 std::size_t num_columns) {
    const std::size_t num_parts = num_chunks_ * num_columns;
    const cl::Buffer parts = session_.make_buffer(num_parts * session_.wide_bytes());
    for (const ColumnPass& pass : session_.passes(num_columns))
        session_.run({"parameter_gradient", "parameter_gradient", -1, ItemLength::many_rows},
                     num_chunks_, pass, elements_, region_, geometry_, unit_moduli_, region_order_,
                     chunk_start_, lambda, x, parts, cl_int(num_chunks_), cl_int(num_columns),
                     cl_int(pass.first));
    const std::vector<double> sums = session_.read_wide(parts, num_parts);
    std::vector<double> products(num_materials() * num_columns, 0.0);
    for (Index chunk = 0; chunk < num_chunks_; ++chunk)
        for (std::size_t c = 0; c < num_columns; ++c)
            products[chunk_region_[chunk] * num_columns + c] += sums[chunk * num_columns + c];
    return products;
}

void DeviceModel::strain_energy(const cl::Buffer& x, std::span<double> energy) {
    const std::vector<double> products = energy_products(x, x, energy.size());
    std::fill(energy.begin(), energy.end(), 0.0);
    for (std::size_t i = 0; i < products.size(); ++i)
        energy[i % energy.size()] += 0.5 * stiffness_kpa_[i / energy.size()] * products[i];
}

}  // namespace palpate
