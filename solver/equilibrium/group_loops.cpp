// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/group_loops.hpp"

#include "solver/base/multiversion.hpp"
#include "solver/model/mean_volume.hpp"

namespace palpate {
namespace {

/// Points that know nothing of each other, with the interface of `MeanDilatation`.
template <class Laws>
class GroupPointwise {
public:
    using Law = typename Laws::Law;
    using Tensors = TensorsAtPoints<Pack>;

    GroupPointwise(const Laws& laws, const GroupElement& element, const Pack* u)
        : laws_(laws), element_(element) {
        for (int q = 0; q < element.num_points(); ++q) {
            gradient_[q] = element.displacement_gradient_at(q, u);
            states_[q] = laws(q).state(gradient_[q]);
            is_valid_ = is_valid_ && states_[q].is_valid;
        }
    }

    bool is_valid() const { return is_valid_; }
    Pack energy() const {
        Pack sum = 0;
        for (int q = 0; q < element_.num_points(); ++q)
            sum += element_.point(q).volume * law(q).energy(states_[q]);
        return sum;
    }
    void stress(Tensors& p) const {
        for (int q = 0; q < element_.num_points(); ++q) p[q] = law(q).stress(states_[q]);
    }
    void add_stiffness(Pack* blocks) const {
        Tensor3<Pack> moduli[9];
        for (int q = 0; q < element_.num_points(); ++q) {
            moduli_of(law(q), states_[q], moduli);
            palpate::add_stiffness(element_.point(q), moduli, blocks);
        }
    }
    void law_directions(const Tensors& dh, Tensors& given) const { given = dh; }
    void pull_back(Tensors&) const {}

    const Law& law(std::size_t q) const { return laws_(q); }
    const typename Law::State& state(std::size_t q) const { return states_[q]; }
    const Tensor3<Pack>& gradient(std::size_t q) const { return gradient_[q]; }

private:
    const Laws& laws_;
    const GroupElement& element_;
    Tensors gradient_;
    typename Law::State states_[most_element_points];
    bool is_valid_ = true;
};

/// Calls work(response) unless a point is not valid.
template <class Laws, class Work>
bool with_group_response(const Laws& laws, const GroupElement& element, const Pack* u,
                         const Work& work) {
    if (element.layout.has_mean_volume) {
        const MeanDilatation<typename Laws::Law, Laws, GroupElement> response(laws, element, u);
        if (!response.is_valid()) return false;
        work(response);
    } else {
        const GroupPointwise<Laws> response(laws, element, u);
        if (!response.is_valid()) return false;
        work(response);
    }
    return true;
}

void add_forces(const GroupElement& element, const TensorsAtPoints<Pack>& stress, Pack* force) {
    for (int k = 0; k < 3 * element.layout.num_nodes; ++k) force[k] = 0;
    for (int q = 0; q < element.num_points(); ++q) add_force(element.point(q), stress[q], force);
}

}  // namespace

template <class Laws>
PALPATE_MULTIVERSION PALPATE_FLATTEN bool group_force(const Laws& laws, const GroupElement& element,
                                                      const Pack* u, Pack& energy, Pack* force) {
    return with_group_response(laws, element, u, [&](const auto& response) {
        TensorsAtPoints<Pack> stress;
        response.stress(stress);
        energy = response.energy();
        add_forces(element, stress, force);
    });
}

template <class Laws>
PALPATE_MULTIVERSION PALPATE_FLATTEN bool group_tangent(const Laws& laws,
                                                        const GroupElement& element, const Pack* u,
                                                        Pack* blocks) {
    const int num_nodes = element.layout.num_nodes;
    for (int k = 0; k < 9 * num_nodes * num_nodes; ++k) blocks[k] = 0;
    return with_group_response(laws, element, u,
                               [&](const auto& response) { response.add_stiffness(blocks); });
}

template <class Laws>
PALPATE_MULTIVERSION PALPATE_FLATTEN bool group_force_changes(const Laws& laws,
                                                              const GroupElement& element,
                                                              const Pack* u,
                                                              std::span<const GroupChange> changes,
                                                              Pack* force) {
    return with_group_response(laws, element, u, [&](const auto& response) {
        using Relaxing = decltype(relaxing_at(response.law(0), response.state(0)));
        Relaxing relaxing[most_element_points];
        for (int q = 0; q < element.num_points(); ++q)
            relaxing[q] = relaxing_at(response.law(q), response.state(q));
        for (const GroupChange& change : changes) {
            TensorsAtPoints<Pack> stress;
            for (int q = 0; q < element.num_points(); ++q)
                stress[q] =
                    held_stress_change(response.law(q), response.state(q), relaxing[q], q, change);
            response.pull_back(stress);
            add_forces(element, stress, force);
            force += 3 * element.layout.num_nodes;
        }
    });
}

PALPATE_MULTIVERSION PALPATE_FLATTEN bool group_relaxing_stress(const ViscousGroup& laws,
                                                                const GroupElement& element,
                                                                const Pack* u,
                                                                Tensor3<Pack>* stress) {
    return with_group_response(laws, element, u, [&](const auto& response) {
        for (int q = 0; q < element.num_points(); ++q)
            // S = F^-1 P
            stress[q] = inverse_times<false>(
                response.gradient(q), relaxing_at(response.law(q), response.state(q)).stress);
    });
}

PALPATE_MULTIVERSION PALPATE_FLATTEN bool group_relaxing_stress_changes(
    const ViscousGroup& laws, const GroupElement& element, const Pack* u, const Pack* du,
    std::span<const GroupChange> changes, Tensor3<Pack>* stress) {
    return with_group_response(laws, element, u, [&](const auto& response) {
        ViscousGroup::Law::Relaxing relaxing[most_element_points];
        for (int q = 0; q < element.num_points(); ++q)
            relaxing[q] = relaxing_at(response.law(q), response.state(q));
        for (const GroupChange& change : changes) {
            TensorsAtPoints<Pack> given, along;
            for (int q = 0; q < element.num_points(); ++q)
                given[q] = element.displacement_gradient_at(q, du);
            response.law_directions(given, along);
            for (int q = 0; q < element.num_points(); ++q)
                *stress++ = response.law(q).relaxing_stress_change(response.state(q), relaxing[q],
                                                                   along[q], change.parameters);
            du += 3 * element.layout.num_nodes;
        }
    });
}

template bool group_force(const ElasticGroup&, const GroupElement&, const Pack*, Pack&, Pack*);
template bool group_force(const ViscousGroup&, const GroupElement&, const Pack*, Pack&, Pack*);
template bool group_tangent(const ElasticGroup&, const GroupElement&, const Pack*, Pack*);
template bool group_tangent(const ViscousGroup&, const GroupElement&, const Pack*, Pack*);
template bool group_force_changes(const ElasticGroup&, const GroupElement&, const Pack*,
                                  std::span<const GroupChange>, Pack*);
template bool group_force_changes(const ViscousGroup&, const GroupElement&, const Pack*,
                                  std::span<const GroupChange>, Pack*);

}  // namespace palpate
