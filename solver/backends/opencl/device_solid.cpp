// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/device_solid.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "solver/backends/opencl/device_blocks.hpp"
#include "solver/backends/opencl/pass_size.hpp"
#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

constexpr int entries_at_a_time = 4;  // of H, in one vector of a CPU: 1 and 8 are slower

/// The numbers of the law's materials, [num_materials, LAW_COEFFICIENTS]; zeros for materials of
/// other laws, which no element of the law has.
std::vector<double> coefficients_of(const std::vector<SolidMaterial>& materials,
                                    std::string_view law) {
    std::vector<std::vector<double>> rows;
    std::size_t width = 0;
    for (const SolidMaterial& material : materials) {
        rows.push_back(material.law == law ? material_coefficients(law, material.parameters)
                                           : std::vector<double>());
        width = std::max(width, rows.back().size());
    }
    std::vector<double> numbers;
    for (std::vector<double>& row : rows) {
        row.resize(width);
        numbers.insert(numbers.end(), row.begin(), row.end());
    }
    return numbers;
}

}  // namespace

DeviceSolid::DeviceSolid(Session& session, const SolidTables& tables)
    : session_(session), tables_(tables) {
    elements_ = session_.upload(tables_.elements);
    region_ = session_.upload(tables_.region);
    points_ = session_.upload_real(tables_.points);
    const Adjacency corners = places_of(tables_.elements, tables_.num_nodes);
    node_start_ = session_.upload(corners.offsets);
    node_corners_ = session_.upload(corners.items);
    const Adjacency pairs =
        places_of(tables_.blocks, static_cast<Index>(tables_.graph.items.size()));
    block_start_ = session_.upload(pairs.offsets);
    block_items_ = session_.upload(pairs.items);
    for (const LawElements& own : tables_.laws)
        laws_.push_back({own.law, own.elements.size(), session_.upload(own.elements),
                         session_.upload_real(coefficients_of(tables_.materials, own.law))});
    state_ = session_.make_real_buffer(tables_.num_dofs());
}

template <class... Args>
void DeviceSolid::run_laws(const char* program, const ColumnPass& pass, const Args&... args) {
    for (const Law& law : laws_) {
        const KernelVariant variant{.nodes_per_element = tables_.layout.num_nodes,
                                    .points_per_element = tables_.layout.num_points,
                                    .has_hoop = tables_.layout.has_hoop,
                                    .has_mean_volume = tables_.layout.has_mean_volume,
                                    .law = law.name};
        session_.run({program, program, variant}, law.num_elements, pass, law.coefficients,
                     law.list, cl_int(law.num_elements), elements_, region_, points_, args...);
    }
}

SolidForce DeviceSolid::internal_force(std::span<const double> u) {
    const cl::Buffer state = session_.upload_real(u);
    const cl::Buffer energy = session_.make_real_buffer(tables_.region.size());
    const cl::Buffer parts = session_.make_real_buffer(3 * tables_.elements.size());
    const cl::Buffer force = session_.make_real_buffer(u.size());
    run_laws("solid_force", single_column, state, energy, parts);
    gather_to_nodes(parts, state, force, 1, single_column, 0, 1);

    SolidForce result{0, std::vector<double>(u.size()), true};
    std::vector<double> stored(tables_.region.size());
    session_.read_real(energy, stored);
    session_.read_real(force, result.force);
    for (const double part : stored) result.energy += part;
    result.is_valid = is_valid_force(result.energy, result.force);
    if (!result.is_valid) result.energy = std::numeric_limits<double>::infinity();
    return result;
}

void DeviceSolid::tangent(std::span<const double> u, std::span<double> blocks) {
    const cl::Buffer state = session_.upload_real(u);
    const cl::Buffer sums = session_.make_real_buffer(blocks.size());
    if (!element_blocks_()) element_blocks_ = session_.make_real_buffer(9 * tables_.blocks.size());
    const ColumnPass entries = {0, 1, session_.device().is_cpu ? entries_at_a_time : 1};
    run_laws("solid_tangent", entries, state, element_blocks_);
    const std::size_t num_blocks = tables_.graph.items.size();
    session_.run({"gather_blocks", "gather_blocks"}, num_blocks, single_column, block_start_,
                 block_items_, element_blocks_, sums, static_cast<cl_int>(num_blocks));
    session_.read_real(sums, blocks);
}

void DeviceSolid::linearise(std::span<const double> u) { session_.write_real(u, state_); }

void DeviceSolid::apply(const cl::Buffer& x, const cl::Buffer& y, std::size_t num_columns) {
    const std::size_t held = std::min(num_columns, max_pass_columns);
    if (held > forces_columns_) {
        forces_ = session_.make_real_buffer(3 * tables_.elements.size() * held);
        forces_columns_ = held;
    }
    for (std::size_t first = 0; first < num_columns; first += held)
        for (const ColumnPass& pass : session_.passes(std::min(held, num_columns - first))) {
            const std::size_t begin = first + pass.first, width = pass.groups * pass.width;
            run_laws("solid_product", pass, state_, x, forces_, cl_int(num_columns), cl_int(begin),
                     cl_int(width));
            gather_to_nodes(forces_, x, y, num_columns, pass, begin, width);
        }
}

void DeviceSolid::gather_to_nodes(const cl::Buffer& parts, const cl::Buffer& unused,
                                  const cl::Buffer& y, std::size_t num_columns,
                                  const ColumnPass& pass, std::size_t first, std::size_t width) {
    const KernelName gather = {
        "gather_to_nodes", "gather_to_nodes",
        KernelVariant{.constrained = 0, .mode = 0, .has_sum = 0, .block_rows = 3}};
    with_real(session_, [&](auto real) {
        session_.run_parts(gather,
                           session_.num_parts(tables_.num_nodes, gathered_reals * num_columns),
                           pass, node_start_, node_corners_, parts, unused, unused, unused, unused,
                           y, real(0), real(0), real(0), unused, cl_int(tables_.num_nodes),
                           cl_int(num_columns), cl_int(first), cl_int(width));
    });
}

std::vector<std::vector<double>> DeviceSolid::parameter_products(std::span<const double> u,
                                                                 std::span<const double> lambda) {
    const std::size_t stride = tables_.most_parameters();
    const cl::Buffer state = session_.upload_real(u), weights = session_.upload_real(lambda);
    const cl::Buffer parts = session_.make_real_buffer(stride * tables_.region.size());
    run_laws("solid_parameters", single_column, state, weights, parts, cl_int(stride));
    std::vector<double> numbers(stride * tables_.region.size());
    session_.read_real(parts, numbers);
    return sum_by_material(tables_, numbers);
}

}  // namespace palpate
