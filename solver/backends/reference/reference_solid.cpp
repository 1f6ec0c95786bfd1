// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/reference/reference_solid.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "solver/backends/reference/host_vector.hpp"
#include "solver/materials/registry.hpp"
#include "solver/model/solid_element.hpp"

namespace palpate {
namespace {

using namespace reference;

class ReferenceSolid final : public SolidDevice {
public:
    explicit ReferenceSolid(SolidTables of_model)
        : SolidDevice(std::move(of_model)),
          elements_of_region_(
              places_of(tables().region, static_cast<Index>(tables().materials.size()))) {}

private:
    SolidForce do_internal_force(std::span<const double> u) override {
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

    void do_tangent(std::span<const double> u, std::span<double> blocks) override {
        std::fill(blocks.begin(), blocks.end(), 0.0);
        const std::size_t pairs = tables().layout.num_nodes * tables().layout.num_nodes;
        for_each_element([&](const auto& law, Index e, const SolidElement<double>& element) {
            double parts[9 * most_element_nodes * most_element_nodes];
            element_tangent(law, element, u.data(), parts);
            for (std::size_t p = 0; p < pairs; ++p) {
                double* const block = &blocks[std::size_t{9} * tables().blocks[e * pairs + p]];
                for (int k = 0; k < 9; ++k) block[k] += parts[9 * p + k];
            }
        });
    }

    void do_linearise(std::span<const double> u) override { state_.assign(u.begin(), u.end()); }

    void do_apply(const DeviceVector& x, DeviceVector& y) override {
        const HostValues& in = values_of(x);
        HostValues& out = values_of(y);
        out.setZero();
        HostValues forces(3 * tables().layout.num_nodes, x.columns());
        for_each_element([&](const auto& law, Index, const SolidElement<double>& element) {
            element_product(law, element, state_.data(), in.data(), x.columns(), forces.data());
            for (int a = 0; a < element.layout.num_nodes; ++a)
                out.middleRows<3>(3 * element.nodes[a]) += forces.middleRows<3>(3 * a);
        });
    }

    std::vector<std::vector<double>> do_parameter_products(
        std::span<const double> u, std::span<const double> lambda) override {
        const std::size_t most = tables().most_parameters();
        std::vector<double> parts(most * tables().region.size());
        for_each_element([&](const auto& law, Index e, const SolidElement<double>& element) {
            const std::size_t count = tables().materials[tables().region[e]].parameters.size();
            for (std::size_t k = 0; k < count; ++k)
                parts[e * most + k] = element_parameter_product(law, element, u.data(),
                                                                lambda.data(), static_cast<int>(k));
        });
        return sum_by_material(tables(), parts);
    }

    /// Calls work(law, number, element) for the elements of one material after the other.
    template <class Work>
    void for_each_element(const Work& work) const {
        const SolidLayout& layout = tables().layout;
        const std::size_t reals = layout.num_points * layout.reals_per_point();
        for (std::size_t m = 0; m < tables().materials.size(); ++m) {
            const SolidMaterial& material = tables().materials[m];
            with_material_law<double>(material.law, material.parameters, [&](const auto& law) {
                for (Index k = elements_of_region_.offsets[m];
                     k < elements_of_region_.offsets[m + 1]; ++k) {
                    const std::size_t e = elements_of_region_.items[k];
                    work(law, static_cast<Index>(e),
                         SolidElement<double>{&tables().elements[e * layout.num_nodes],
                                              &tables().points[e * reals], layout});
                }
            });
        }
    }

    Adjacency elements_of_region_;
    std::vector<double> state_;  ///< of `linearise`
};

}  // namespace

std::unique_ptr<SolidDevice> make_reference_solid(SolidTables tables) {
    return std::make_unique<ReferenceSolid>(std::move(tables));
}

}  // namespace palpate
