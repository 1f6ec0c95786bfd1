// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/sensitivity/history_directions.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "solver/base/error.hpp"
#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

void check_number(const char* what, std::size_t number, std::size_t count) {
    if (number < count) return;
    throw Error(ErrorCode::invalid_argument,
                fmt::format("there is no {} {} to differentiate by; there are {}, counted from 0",
                            what, number, count));
}

HistoryDirection along_term(const SolidModel& model, std::size_t material, std::size_t term,
                            const char* what, RelaxationTerm unit) {
    check_number("material", material, model.materials.size());
    check_number("relaxation term", term, model.materials[material].relaxation.size());
    HistoryDirection direction;
    direction.name = fmt::format("{} of term {} of material {}", what, term, material);
    for (const SolidMaterial& of : model.materials)
        direction.relaxation.emplace_back(of.relaxation.size(), RelaxationTerm{0, 0});
    direction.relaxation[material][term] = unit;
    return direction;
}

/// factor (a + sign b); what is not given is zero.
void combine(std::vector<double>& a, const std::vector<double>& b, double sign, double factor) {
    a.resize(std::max(a.size(), b.size()), 0.0);
    for (std::size_t k = 0; k < b.size(); ++k) a[k] += sign * b[k];
    for (double& one : a) one *= factor;
}

/// (to - from) / span; motions that are not given are zero.
SolidLoads slope_between(const SolidLoads* from, const SolidLoads& to, double span_s) {
    SolidLoads slope = to;
    if (from) {
        slope.displacement -= from->displacement;
        slope.force -= from->force;
        slope.obstacle_motion.resize(
            std::max(to.obstacle_motion.size(), from->obstacle_motion.size()), Vec3::Zero());
        for (std::size_t c = 0; c < from->obstacle_motion.size(); ++c)
            slope.obstacle_motion[c] -= from->obstacle_motion[c];
    }
    combine(slope.pressure_kpa, from ? from->pressure_kpa : std::vector<double>{}, -1, 1 / span_s);
    slope.displacement /= span_s;
    slope.force /= span_s;
    for (Vec3& by : slope.obstacle_motion) by /= span_s;
    return slope;
}

/// -(a + b) / 2
SolidLoads negative_mean(SolidLoads a, const SolidLoads& b) {
    a.displacement = -0.5 * (a.displacement + b.displacement);
    a.force = -0.5 * (a.force + b.force);
    combine(a.pressure_kpa, b.pressure_kpa, 1, -0.5);
    a.obstacle_motion.resize(std::max(a.obstacle_motion.size(), b.obstacle_motion.size()),
                             Vec3::Zero());
    for (std::size_t c = 0; c < b.obstacle_motion.size(); ++c)
        a.obstacle_motion[c] += b.obstacle_motion[c];
    for (Vec3& by : a.obstacle_motion) by *= -0.5;
    return a;
}

/// Whether displacements of one are displacements of the other.
bool is_alike(const SolidModel& a, const SolidModel& b) {
    const auto faces = [](const SolidModel& model) {
        std::vector<std::vector<Face>> list;
        for (const Contact& contact : model.contacts) list.push_back(contact.faces);
        for (const PressureSurface& pressure : model.pressures) list.push_back(pressure.faces);
        return list;
    };
    return a.mesh.type == b.mesh.type && a.mesh.nodes.size() == b.mesh.nodes.size() &&
           a.mesh.elements == b.mesh.elements && a.mesh.region == b.mesh.region &&
           a.prescribed == b.prescribed && faces(a) == faces(b);
}

}  // namespace

HistoryDirection along_parameter(const SolidModel& model, std::size_t material,
                                 std::size_t parameter) {
    check_number("material", material, model.materials.size());
    check_number("parameter", parameter, model.materials[material].parameters.size());
    HistoryDirection direction;
    direction.name = fmt::format(
        "{} of material {}", material_law(model.materials[material].law).parameters[parameter].name,
        material);
    for (const SolidMaterial& of : model.materials)
        direction.parameters.emplace_back(of.parameters.size(), 0.0);
    direction.parameters[material][parameter] = 1;
    return direction;
}

HistoryDirection along_amplitude(const SolidModel& model, std::size_t material, std::size_t term) {
    return along_term(model, material, term, "amplitude", {1, 0});
}

HistoryDirection along_relaxation_time(const SolidModel& model, std::size_t material,
                                       std::size_t term) {
    return along_term(model, material, term, "time", {0, 1});
}

HistoryDirection along_friction(const SolidModel& model, std::size_t contact) {
    check_number("obstacle", contact, model.contacts.size());
    if (!(model.contacts[contact].friction > 0))
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("the friction of obstacle {} is 0, where it has no derivative; "
                                "begin above 0",
                                contact));
    HistoryDirection direction;
    direction.name = fmt::format("friction of obstacle {}", contact);
    direction.friction.assign(model.contacts.size(), 0.0);
    direction.friction[contact] = 1;
    return direction;
}

HistoryDirection along_size(const SolidModel& model, std::size_t contact, int size) {
    check_number("obstacle", contact, model.contacts.size());
    check_number("size", static_cast<std::size_t>(size), 4);
    HistoryDirection direction;
    direction.name = fmt::format("size {} of obstacle {}", size, contact);
    direction.sizes.assign(model.contacts.size(), Eigen::Vector4d::Zero());
    direction.sizes[contact][size] = 1;
    return direction;
}

HistoryDirection along_load_scale(const std::vector<LoadTime>& times) {
    HistoryDirection direction;
    direction.name = "scale of the loads";
    for (const LoadTime& at : times) direction.loads.push_back(at.loads);
    return direction;
}

HistoryDirection along_load_delay(const std::vector<LoadTime>& times) {
    check_times(times);
    std::vector<SolidLoads> slopes;  // up to each time
    for (std::size_t i = 0; i < times.size(); ++i) {
        const SolidLoads* before = i == 0 ? nullptr : &times[i - 1].loads;
        const double span_s = times[i].time_s - (i == 0 ? 0 : times[i - 1].time_s);
        slopes.push_back(slope_between(before, times[i].loads, span_s));
    }
    HistoryDirection direction;
    direction.name = "delay of the loads";
    for (std::size_t i = 0; i < times.size(); ++i)
        // L(t - delay) changes by -dL/dt
        direction.loads.push_back(
            negative_mean(slopes[i], slopes[std::min(i + 1, times.size() - 1)]));
    return direction;
}

HistoryDirection along_time_shift(const std::vector<LoadTime>& times) {
    HistoryDirection direction;
    direction.name = "shift of all times";
    direction.time_s.assign(times.size(), 1.0);
    return direction;
}

HistoryDirection along_pair(const SolidModel& model, ModelPair pair) {
    HistoryDirection direction;
    direction.name = "a pair of models";
    direction.pair = std::move(pair);
    check_direction(direction, model, 0);
    return direction;
}

void check_direction(const HistoryDirection& direction, const SolidModel& model,
                     std::size_t num_times) {
    const auto expect = [&](const char* what, std::size_t size, std::size_t expected) {
        if (size != 0 && size != expected)
            throw Error(ErrorCode::invalid_argument,
                        fmt::format("the direction '{}' has {} {}, not {}", direction.name, size,
                                    what, expected));
    };
    const std::size_t materials = model.materials.size();
    expect("materials", direction.parameters.size(), materials);
    expect("materials", direction.relaxation.size(), materials);
    expect("obstacles", direction.friction.size(), model.contacts.size());
    expect("obstacles", direction.sizes.size(), model.contacts.size());
    expect("obstacles", direction.penalties.size(), model.contacts.size());
    expect("loads", direction.loads.size(), num_times);
    expect("times", direction.time_s.size(), num_times);
    for (std::size_t m = 0; m < direction.parameters.size(); ++m)
        expect("parameters", direction.parameters[m].size(), model.materials[m].parameters.size());
    for (std::size_t m = 0; m < direction.relaxation.size(); ++m)
        expect("terms", direction.relaxation[m].size(), model.materials[m].relaxation.size());
    for (const SolidLoads& loads : direction.loads) check_loads(model, loads);
    const auto& [less, more] = direction.pair.models;
    if (less || more)
        if (!less || !more || !is_alike(*less, model) || !is_alike(*more, model) ||
            !(direction.pair.apart > 0))
            throw Error(
                ErrorCode::invalid_argument,
                fmt::format("the direction '{}' is between models of other nodes, elements, "
                            "regions or contacts, or of no distance",
                            direction.name));
}

}  // namespace palpate
