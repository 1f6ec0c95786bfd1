// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/kokkos/kokkos_solid.hpp"

#include <limits>
#include <vector>

#include "solver/backends/kokkos/device_arrays.hpp"
#include "solver/backends/kokkos/guarded.hpp"
#include "solver/backends/kokkos/solid_loops.hpp"
#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

using namespace kokkos;

template <typename Real>
struct DeviceSolidMesh {
    explicit DeviceSolidMesh(const SolidTables& tables)
        : layout(tables.layout),
          elements(array_of(tables.elements)),
          region(array_of(tables.region)),
          points(array_of<Real, double>(tables.points)) {}

    SolidLayout layout;
    Array<Index> elements, region;
    Array<Real> points;
};

/// The loops over the elements of one law.
template <typename Real>
class LawLoops {
public:
    virtual ~LawLoops() = default;
    virtual void force(const Real* u, Real* energy, Real* force) const = 0;
    virtual void tangent(const Real* u, Real* blocks) const = 0;
    virtual void product(const Real* u, const Real* x, Index columns, Real* forces) const = 0;
    virtual void parameters(const Real* u, const Real* lambda, int stride, Real* parts) const = 0;
};

template <class Law>
class LoopsOf final : public LawLoops<typename Law::Number> {
    using Real = typename Law::Number;

public:
    /// `law`: any of this type, for regions of other laws, which no element of the list has.
    LoopsOf(const Law& law, const DeviceSolidMesh<Real>& mesh, const SolidTables& tables,
            const LawElements& own)
        : mesh_(mesh),
          list_(array_of(own.elements)),
          num_parameters_(static_cast<int>(Law::description().parameters.size())) {
        std::vector<Law> laws(tables.materials.size(), law);
        for (std::size_t m = 0; m < laws.size(); ++m)
            if (tables.materials[m].law == own.law)
                laws[m] = Law::from_parameters(tables.materials[m].parameters.data());
        laws_ = Array<Law>(Kokkos::view_alloc("palpate", Kokkos::WithoutInitializing), laws.size());
        const auto mirror = Kokkos::create_mirror_view(laws_);
        std::copy(laws.begin(), laws.end(), mirror.data());
        Kokkos::deep_copy(laws_, mirror);
    }

    void force(const Real* u, Real* energy, Real* force) const override {
        run(ForceLoop<Law>{loop(), u, energy, force});
    }
    void tangent(const Real* u, Real* blocks) const override {
        run(TangentLoop<Law>{loop(), u, blocks});
    }
    void product(const Real* u, const Real* x, Index columns, Real* forces) const override {
        run(ProductLoop<Law>{loop(), u, x, columns, forces});
    }
    void parameters(const Real* u, const Real* lambda, int stride, Real* parts) const override {
        run(ParameterLoop<Law>{loop(), u, lambda, num_parameters_, stride, parts});
    }

private:
    LawLoop<Law> loop() const {
        return {laws_.data(),        list_.data(),        mesh_.elements.data(),
                mesh_.region.data(), mesh_.points.data(), mesh_.layout};
    }
    template <class Loop>
    void run(const Loop& loop) const {
        for_each_work(static_cast<std::int64_t>(list_.size()), loop);
    }

    const DeviceSolidMesh<Real>& mesh_;
    Array<Law> laws_;
    Array<Index> list_;
    int num_parameters_;
};

/// Rows and what is added up in each.
struct GatherLists {
    GatherLists(std::span<const Index> targets, Index count) {
        const Adjacency places = places_of(targets, count);
        offsets = array_of(places.offsets);
        items = array_of(places.items);
    }
    template <typename Real>
    void run(const Real* from, Real* to, std::int64_t width) const {
        for_each_work(static_cast<std::int64_t>(offsets.size()) - 1,
                      GatherRows<Real>{offsets.data(), items.data(), from, to, width});
    }
    Array<Index> offsets, items;
};

template <typename Real>
class KokkosSolid final : public SolidDevice {
    KokkosLease lease_;  // before all memory: it goes last

public:
    explicit KokkosSolid(SolidTables of_model)
        : SolidDevice(std::move(of_model)),
          mesh_(tables()),
          nodes_(tables().elements, tables().num_nodes),
          blocks_(tables().blocks, static_cast<Index>(tables().graph.items.size())) {
        for (const LawElements& own : tables().laws)
            for (const SolidMaterial& material : tables().materials) {
                if (material.law != own.law) continue;
                with_material_law<Real>(own.law, material.parameters, [&](const auto& law) {
                    using Law = std::decay_t<decltype(law)>;
                    loops_.push_back(std::make_unique<LoopsOf<Law>>(law, mesh_, tables(), own));
                });
                break;
            }
    }

private:
    SolidForce do_internal_force(std::span<const double> u) override {
        return guarded("internal_force", [&] {
            const Array<Real> state = array_of<Real, double>(u);
            const Array<Real> energy = make_array<Real>(tables().region.size());
            const Array<Real> parts = make_array<Real>(3 * tables().elements.size());
            const Array<Real> force = make_array<Real>(u.size());
            for (const auto& law : loops_) law->force(state.data(), energy.data(), parts.data());
            nodes_.run(parts.data(), force.data(), 3);
            return force_of(energy, force);
        });
    }

    void do_tangent(std::span<const double> u, std::span<double> blocks) override {
        guarded("tangent", [&] {
            const Array<Real> state = array_of<Real, double>(u);
            const Array<Real> sums = make_array<Real>(blocks.size());
            if (element_blocks_.size() == 0)
                element_blocks_ = make_array<Real>(9 * tables().blocks.size());
            for (const auto& law : loops_) law->tangent(state.data(), element_blocks_.data());
            blocks_.run(element_blocks_.data(), sums.data(), 9);
            read_array(sums, blocks);
        });
    }

    void do_linearise(std::span<const double> u) override {
        guarded("linearise", [&] { state_ = array_of<Real, double>(u); });
    }

    void do_apply(const DeviceVector& x, DeviceVector& y) override {
        const auto& in = own<const KokkosVector<Real>>(x);
        auto& out = own<KokkosVector<Real>>(y);
        guarded("apply", [&] {
            const std::size_t size = 3 * tables().elements.size() * x.columns();
            if (parts_.size() < size) parts_ = make_array<Real>(size);
            for (const auto& law : loops_)
                law->product(state_.data(), in.values.data(), x.columns(), parts_.data());
            nodes_.run(parts_.data(), out.values.data(), std::int64_t{3} * x.columns());
        });
    }

    std::vector<std::vector<double>> do_parameter_products(
        std::span<const double> u, std::span<const double> lambda) override {
        return guarded("parameter_products", [&] {
            const auto stride = static_cast<int>(tables().most_parameters());
            const Array<Real> state = array_of<Real, double>(u);
            const Array<Real> weights = array_of<Real, double>(lambda);
            const Array<Real> parts = make_array<Real>(stride * tables().region.size());
            for (const auto& law : loops_)
                law->parameters(state.data(), weights.data(), stride, parts.data());
            return sum_by_material(tables(), numbers_of(parts));
        });
    }

    static std::vector<double> numbers_of(const Array<Real>& array) {
        std::vector<double> numbers(array.size());
        read_array(array, std::span<double>(numbers));
        return numbers;
    }
    static SolidForce force_of(const Array<Real>& energy, const Array<Real>& force) {
        SolidForce result{0, numbers_of(force), true};
        for (const double part : numbers_of(energy)) result.energy += part;
        result.is_valid = is_valid_force(result.energy, result.force);
        if (!result.is_valid) result.energy = std::numeric_limits<double>::infinity();
        return result;
    }

    DeviceSolidMesh<Real> mesh_;
    GatherLists nodes_, blocks_;
    std::vector<std::unique_ptr<LawLoops<Real>>> loops_;
    Array<Real> state_;           ///< of `linearise`
    Array<Real> element_blocks_;  ///< of the last tangent
    Array<Real> parts_;           ///< of the last product
};

}  // namespace

template <typename Real>
std::unique_ptr<SolidDevice> make_kokkos_solid(SolidTables tables) {
    return std::make_unique<KokkosSolid<Real>>(std::move(tables));
}
template std::unique_ptr<SolidDevice> make_kokkos_solid<float>(SolidTables);
template std::unique_ptr<SolidDevice> make_kokkos_solid<double>(SolidTables);

}  // namespace palpate
