// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "solver/equilibrium/time_steps.hpp"

namespace palpate {

/// A model with a parameter by half of `apart` smaller and larger: of the same nodes, elements and
/// contact points, which may have other places.
struct ModelPair {
    std::array<std::shared_ptr<const SolidModel>, 2> models;
    double apart = 0;
};

/// How everything that a load history is made of changes with one parameter, per unit of it. An
/// empty list means that nothing of it changes.
struct HistoryDirection {
    std::string name;                                     ///< for messages
    std::vector<std::vector<double>> parameters;          ///< [materials][parameters]
    std::vector<std::vector<RelaxationTerm>> relaxation;  ///< [materials][terms]
    std::vector<double> friction;                         ///< [contacts] of the coefficients
    std::vector<Eigen::Vector4d> sizes;                   ///< [contacts] mm, of `obstacle_sizes`
    std::vector<Eigen::Vector2d> penalties;               ///< [contacts] kPa/mm, as ContactChange
    std::vector<SolidLoads> loads;                        ///< [times] as in `LoadTime`
    std::vector<double> time_s;                           ///< [times] of the times themselves
    ModelPair pair = {};  ///< what the lists above cannot say: places of nodes; none: nothing
};

/// Along one parameter of a material's law. Throws Error(invalid_argument), like all of these, for
/// a number out of range.
HistoryDirection along_parameter(const SolidModel& model, std::size_t material,
                                 std::size_t parameter);
/// Along the amplitude C_k, or the time tau_k, of one relaxation term.
HistoryDirection along_amplitude(const SolidModel& model, std::size_t material, std::size_t term);
HistoryDirection along_relaxation_time(const SolidModel& model, std::size_t material,
                                       std::size_t term);
/// Along an obstacle's coefficient of friction, which must not be 0: there the derivative has two
/// sides.
HistoryDirection along_friction(const SolidModel& model, std::size_t contact);
/// Along one of the four sizes of an obstacle, counted as in `obstacle_sizes`.
HistoryDirection along_size(const SolidModel& model, std::size_t contact, int size);
/// Along a factor of all loads: of displacements, forces and motions of obstacles. For a factor of
/// some of them keep those only in `loads`.
HistoryDirection along_load_scale(const std::vector<LoadTime>& times);
/// Along a delay of the loads, s, while the times at which the body is looked at stay: -dL/dt of
/// the loads that change linearly between the times. Where their slope jumps it is the mean of both
/// sides, as central differences have it; after the last time they go on as before.
HistoryDirection along_load_delay(const std::vector<LoadTime>& times);
/// Along a shift of all times with their loads, s: everything happens later, the first step is
/// longer. Unlike the delay it has no jumps; displacements then belong to times that move.
HistoryDirection along_time_shift(const std::vector<LoadTime>& times);

/// Along what differs between two models: forces at held displacements are compared, so that the
/// error is of the order of `apart` squared. Throws Error(invalid_argument) for models that are not
/// alike.
HistoryDirection along_pair(const SolidModel& model, ModelPair pair);

/// Throws Error(invalid_argument) for lists of a size that does not fit.
void check_direction(const HistoryDirection& direction, const SolidModel& model,
                     std::size_t num_times);

}  // namespace palpate
