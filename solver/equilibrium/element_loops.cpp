// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/element_loops.hpp"

#include <algorithm>
#include <span>

#include "solver/backend/registry.hpp"
#include "solver/base/error.hpp"
#include "solver/base/parallel.hpp"

namespace palpate {
namespace {

/// Below, a device takes longer to start than the host takes for everything.
constexpr Index fewest_dofs = 8000;

std::span<const double> span_of(const Eigen::VectorXd& v) {
    return {v.data(), static_cast<std::size_t>(v.size())};
}

bool is_in_this_build(const std::string& backend) {
    const auto& entries = backend_registry();
    return std::any_of(entries.begin(), entries.end(),
                       [&](const BackendEntry& entry) { return entry.name == backend; });
}

/// Why the host has the loops whatever the device; empty: it has not.
std::string reason_for_host(const SolidModel& model, const ElementLoopOptions& options) {
    if (options.backend.empty()) return "the host's own loops";
    const auto relaxes = [](const SolidMaterial& m) { return !m.relaxation.empty(); };
    if (std::any_of(model.materials.begin(), model.materials.end(), relaxes))
        return "relaxation is not implemented on devices";
    if (options.is_by_name) return "";
    return model.num_dofs() < fewest_dofs ? "a small mesh" : "";
}

}  // namespace

ElementLoops::ElementLoops(const SolidModel& model, const ElementLoopOptions& options) {
    info_.device.backend = "reference";
    info_.device.device = "host";
    info_.device.compute_units = num_host_threads();
    info_.reason = reason_for_host(model, options);
    if (!info_.reason.empty()) return;
    BackendOptions device = options.device;
    device.precision = Precision::double_;
    try {
        backend_ = make_backend(options.backend, device);
        solid_ = backend_->make_solid(model);
        info_ = {backend_->describe(), options.is_by_name ? "asked for" : "a large mesh"};
    } catch (const Error& error) {
        const bool lacks_feature =
            error.code() == ErrorCode::unsupported && is_in_this_build(options.backend);
        const bool is_missing = error.code() == ErrorCode::device_unavailable ||
                                error.code() == ErrorCode::kernel_build_failed;
        if (!lacks_feature && (!is_missing || options.is_by_name)) throw;
        backend_.reset();
        info_.reason = error.what();
    }
}

SolidForce ElementLoops::internal_force(const Eigen::VectorXd& u) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return solid_->internal_force(span_of(u));
}

void ElementLoops::tangent(const Eigen::VectorXd& u, BlockMatrix& matrix) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    solid_->tangent(span_of(u), matrix);
}

std::vector<std::vector<double>> ElementLoops::parameter_products(
    const Eigen::VectorXd& u, const Eigen::VectorXd& lambda) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return solid_->parameter_products(span_of(u), span_of(lambda));
}

}  // namespace palpate
