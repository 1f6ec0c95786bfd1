// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/reference/reference_solid.hpp"

#include <algorithm>
#include <limits>

#include "solver/backend/solid_tables.hpp"
#include "solver/backends/reference/host_vector.hpp"
#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

using namespace reference;

class ReferenceSolid final : public SolidDevice {
public:
    explicit ReferenceSolid(const SolidModel& model)
        : tables_(solid_tables(model, "reference")),
          elements_of_region_(
              places_of(tables_.region, static_cast<Index>(model.materials.size()))) {}

    SolidForce internal_force(std::span<const double> u) override {
        check(u, "internal_force");
        SolidForce result{0, std::vector<double>(u.size(), 0.0), true};
        for_each_element([&](const auto& law, Index, const SolidElement<double>& element) {
            double force[3 * most_element_nodes];
            result.energy += element_force(law, element, u.data(), force);
            for (int k = 0; k < 3 * element.layout.num_nodes; ++k)
                result.force[3 * element.nodes[k / 3] + k % 3] += force[k];
        });
        result.is_valid = is_valid_force(result.energy, result.force);
        if (!result.is_valid) result.energy = std::numeric_limits<double>::infinity();
        return result;
    }

    void tangent(std::span<const double> u, BlockMatrix& matrix) override {
        check(u, "tangent");
        require_pattern(tables_, matrix, "reference");
        std::fill(matrix.blocks.begin(), matrix.blocks.end(), 0.0);
        const std::size_t pairs = tables_.layout.num_nodes * tables_.layout.num_nodes;
        for_each_element([&](const auto& law, Index e, const SolidElement<double>& element) {
            double blocks[9 * most_element_nodes * most_element_nodes];
            element_tangent(law, element, u.data(), blocks);
            for (std::size_t p = 0; p < pairs; ++p) {
                double* const block = matrix.block(tables_.blocks[e * pairs + p]);
                for (int k = 0; k < 9; ++k) block[k] += blocks[9 * p + k];
            }
        });
    }

    void linearise(std::span<const double> u) override {
        check(u, "linearise");
        state_.assign(u.begin(), u.end());
    }

    void apply(const DeviceVector& x, DeviceVector& y) override {
        if (state_.empty() || &x == &y || x.rows() != tables_.num_dofs() || y.rows() != x.rows() ||
            y.columns() != x.columns())
            refuse("Call linearise(u) first and give two vectors of three rows per node.");
        const HostValues& in = values_of(x);
        HostValues& out = values_of(y);
        out.setZero();
        HostValues forces(3 * tables_.layout.num_nodes, x.columns());
        for_each_element([&](const auto& law, Index, const SolidElement<double>& element) {
            element_product(law, element, state_.data(), in.data(), x.columns(), forces.data());
            for (int a = 0; a < element.layout.num_nodes; ++a)
                out.middleRows<3>(3 * element.nodes[a]) += forces.middleRows<3>(3 * a);
        });
    }

    std::vector<std::vector<double>> parameter_products(std::span<const double> u,
                                                        std::span<const double> lambda) override {
        check(u, "parameter_products");
        check(lambda, "parameter_products");
        const std::size_t most = tables_.most_parameters();
        std::vector<double> parts(most * tables_.region.size());
        for_each_element([&](const auto& law, Index e, const SolidElement<double>& element) {
            const std::size_t count = tables_.materials[tables_.region[e]].parameters.size();
            for (std::size_t k = 0; k < count; ++k)
                parts[e * most + k] = element_parameter_product(law, element, u.data(),
                                                                lambda.data(), static_cast<int>(k));
        });
        return sum_by_material(tables_, parts);
    }

private:
    void check(std::span<const double> u, const char* function) const {
        require_displacement(tables_, u, "reference", function);
    }

    /// Calls work(law, number, element) for the elements of one material after the other.
    template <class Work>
    void for_each_element(const Work& work) const {
        const SolidLayout& layout = tables_.layout;
        const std::size_t reals = layout.num_points * layout.reals_per_point();
        for (std::size_t m = 0; m < tables_.materials.size(); ++m) {
            const SolidMaterial& material = tables_.materials[m];
            with_material_law<double>(material.law, material.parameters, [&](const auto& law) {
                for (Index k = elements_of_region_.offsets[m];
                     k < elements_of_region_.offsets[m + 1]; ++k) {
                    const std::size_t e = elements_of_region_.items[k];
                    work(law, static_cast<Index>(e),
                         SolidElement<double>{&tables_.elements[e * layout.num_nodes],
                                              &tables_.points[e * reals], layout});
                }
            });
        }
    }

    SolidTables tables_;
    Adjacency elements_of_region_;
    std::vector<double> state_;  ///< of `linearise`
};

}  // namespace

std::unique_ptr<SolidDevice> make_reference_solid(const SolidModel& model) {
    return std::make_unique<ReferenceSolid>(model);
}

}  // namespace palpate
