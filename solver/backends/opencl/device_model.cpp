// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/device_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <set>

#include "solver/backends/opencl/pass_size.hpp"

namespace palpate {
namespace {

constexpr double hopeless_ratio = 5;         // of a product's time to the best so far
constexpr double kernel_load_seconds = 0.3;  // at most, from the folder of compiled programs
constexpr std::size_t max_forces_bytes = std::size_t(256) << 20;
constexpr Index element_reals = 10;  // ELEMENT_REALS of elements/tet4.cl
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

/// Node positions about their middle, where rounding to single precision costs least.
std::vector<double> centred_nodes(const Mesh& mesh) {
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
    if (!mesh.nodes.empty()) low = high = mesh.nodes.front();
    for (const Vec3& x : mesh.nodes) {
        low = low.cwiseMin(x);
        high = high.cwiseMax(x);
    }
    const Vec3 middle = 0.5 * (low + high);
    std::vector<double> nodes;
    nodes.reserve(3 * mesh.nodes.size());
    for (const Vec3& x : mesh.nodes)
        for (int c = 0; c < 3; ++c) nodes.push_back(x[c] - middle[c]);
    return nodes;
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
    compute_stiffness();
}

void DeviceModel::upload_mesh(const Mesh& mesh) {
    const Adjacency corners = corners_of_nodes(mesh);
    elements_ = session_.upload(flat(mesh.tets));
    region_ = session_.upload(mesh.region);
    node_start_ = session_.upload(corners.offsets);
    node_corners_ = session_.upload(corners.items);
    if (holds(Product::assembled)) upload_assembly_tables(mesh, corners);
    inverse_blocks_ = blocks_ ? blocks_->inverse_diagonal()
                              : session_.make_real_buffer(std::size_t(9) * num_nodes_);
    if (holds(Product::recomputed)) nodes_ = session_.upload_real(centred_nodes(mesh));

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
    blocks_.emplace(session_, pattern, 3, 3, true);
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
    if (blocks_)
        session_.run({"stiffness_blocks", "stiffness_blocks"}, num_nodes_, single_column, region_,
                     geometry_, unit_moduli_, stiffness_, prescribed_, node_start_, node_corners_,
                     corner_slots_, blocks_->row_start(), blocks_->block_node(), blocks_->blocks(),
                     cl_int(num_nodes_));
}

std::size_t DeviceModel::run(const RowJob& job) {
    return run(job, product_ == Product::automatic ? product_for(job.num_columns) : product_);
}

std::string DeviceModel::setting() const {
    return fmt::format("{} precision, about 2^{} elements",
                       session_.is_double() ? "double" : "single",
                       std::lround(std::log2(std::max<double>(num_elements_, 1))));
}

std::vector<ProductChoice> DeviceModel::choices() const {
    if (product_ != Product::automatic) return {};
    return session_.device().choices.choices(setting());
}

/// Measured once per device, size and class of columns: by this process, or by one before it whose
/// note lies beside the compiled programs.
Product DeviceModel::product_for(std::size_t num_columns) {
    const Index columns = column_class(static_cast<Index>(num_columns));
    ProductChoices& choices = session_.device().choices;
    if (const auto known = choices.find(setting(), columns)) return known->product;
    const std::string name = fmt::format("product, {}, {} columns", setting(), columns);
    const ProgramCache& notes = *session_.device().programs;
    if (const std::optional<std::string> note = notes.recall(name))
        for (Product product : {Product::assembled, Product::matrix_free, Product::recomputed})
            if (note->starts_with(name_of(product) + ": ")) {
                choices.remember(setting(),
                                 {columns, product, note->substr(name_of(product).size() + 2)});
                return product;
            }
    const ProductChoice choice = measure_products(num_columns);
    notes.note(name, name_of(choice.product) + ": " + choice.reason);
    return choice.product;
}

ProductChoice DeviceModel::measure_products(std::size_t num_columns) {
    const std::size_t size = num_rows() * num_columns;
    const cl::Buffer x = session_.upload_real(std::vector<double>(size, 1.0));
    const cl::Buffer y = session_.make_real_buffer(size);
    const RowJob job{.x = &x, .y = &y, .num_columns = num_columns};
    const auto seconds_of_run = [&](Product product) {
        session_.wait();
        const auto start = std::chrono::steady_clock::now();
        run(job, product);
        session_.wait();
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    std::set<Product> warm;
    double best = std::numeric_limits<double>::infinity();
    const auto time_product = [&](Product product) {
        if (warm.insert(product).second) {
            // The first run also loads kernels; one that is slow beyond that needs no second.
            const double first = seconds_of_run(product);
            if (first > hopeless_ratio * best + kernel_load_seconds) return first;
        }
        const double seconds = seconds_of_run(product);
        best = std::min(best, seconds);
        return seconds;
    };
    constexpr Product candidates[] = {Product::assembled, Product::matrix_free,
                                      Product::recomputed};
    const ProductChoice choice = session_.device().choices.choose(
        setting(), static_cast<Index>(num_columns), candidates, time_product);
    if (choice.product == Product::assembled) {
        forces_ = cl::Buffer();
        forces_columns_ = 0;
    }
    return choice;
}

std::size_t DeviceModel::run(const RowJob& job, Product product) {
    if (product == Product::assembled) return blocks_->run(session_, job);
    return multiply_elements(job, true, product == Product::recomputed);
}

void DeviceModel::internal_force(const cl::Buffer& x, const cl::Buffer& y,
                                 std::size_t num_columns) {
    multiply_elements({.x = &x, .y = &y, .num_columns = num_columns}, false, false);
}

std::size_t DeviceModel::multiply_elements(const RowJob& job, bool constrained, bool recomputed) {
    std::size_t parts = 0;
    const std::size_t step = pass_columns();
    for (std::size_t first = 0; first < job.num_columns; first += step)
        parts = multiply_pass(job, constrained, recomputed, first,
                              std::min(step, job.num_columns - first));
    return parts;
}

std::size_t DeviceModel::pass_columns() const {
    const std::size_t column_bytes = 12 * session_.real_bytes() * std::max<Index>(num_elements_, 1);
    std::size_t columns = max_pass_columns;
    while (columns > 1 && columns * column_bytes > max_forces_bytes) columns /= 2;
    return columns;
}

std::size_t DeviceModel::multiply_pass(const RowJob& job, bool constrained, bool recomputed,
                                       std::size_t first, std::size_t count) {
    if (count > forces_columns_) {
        forces_ = session_.make_real_buffer(std::size_t(12) * num_elements_ * count);
        forces_columns_ = count;
    }
    const KernelName element_half = {
        "stiffness_apply", "stiffness_apply",
        KernelVariant{.constrained = constrained, .recomputed = recomputed}};
    const KernelName node_half = {"gather_to_nodes", "gather_to_nodes",
                                  KernelVariant{.constrained = constrained,
                                                .mode = static_cast<int>(job.result),
                                                .has_sum = job.sum != nullptr,
                                                .block_rows = 3}};
    // All passes cut the nodes alike, so that their sums share one table of parts.
    const std::size_t parts = session_.num_parts(num_nodes_, gathered_reals * job.num_columns);
    with_real(session_, [&](auto real) {
        for (const ColumnPass& pass : session_.passes(count)) {
            const cl_int begin = cl_int(first + pass.first);
            const cl_int width = cl_int(pass.groups * pass.width);
            session_.run(element_half, num_elements_, pass, elements_, region_,
                         recomputed ? nodes_ : geometry_, unit_moduli_, stiffness_, prescribed_,
                         *job.x, forces_, cl_int(num_elements_), cl_int(job.num_columns), begin,
                         width);
            session_.run_parts(node_half, parts, pass, node_start_, node_corners_, forces_,
                               prescribed_, inverse_blocks_, job.b ? *job.b : *job.x, *job.x,
                               *job.y, real(job.alpha), real(job.beta), real(job.weight),
                               job.sum ? *job.sum : *job.y, cl_int(num_nodes_),
                               cl_int(job.num_columns), begin, width);
        }
    });
    return parts;
}

std::size_t DeviceModel::apply_inverse_diagonal(double weight, const cl::Buffer& r,
                                                const cl::Buffer& z, const cl::Buffer* sum,
                                                std::size_t num_columns) {
    return multiply_diagonal(session_, inverse_blocks_, num_nodes_, 3, weight, r, z, sum,
                             num_columns);
}

std::vector<double> DeviceModel::energy_products(const cl::Buffer& lambda, const cl::Buffer& x,
                                                 std::size_t num_columns) {
    const std::size_t num_parts = num_chunks_ * num_columns;
    const cl::Buffer parts = session_.make_buffer(num_parts * session_.wide_bytes());
    for (const ColumnPass& pass : session_.passes(num_columns))
        session_.run({"parameter_gradient", "parameter_gradient", {}, RowShare::long_items},
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
