// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "solver/backend/backend.hpp"

namespace palpate {

/// Where the element loops of a SolidAssembly run.
struct ElementLoopOptions {
    std::string backend = {};  ///< empty: on the host
    BackendOptions device = {};
    /// The back end was asked for by name. If not, the host keeps small meshes.
    bool is_by_name = false;
};

/// Who runs them, and why so.
struct ElementLoopInfo {
    BackendInfo device;
    std::string reason;  ///< one clause
};

/// The element loops of one model on a back end in fp64, for one caller at a time.
class ElementLoops {
public:
    /// On the host where that is asked for, where the device lacks a feature that the model needs
    /// (or fp64), and where there is no device that was not asked for by name. Throws as
    /// `make_backend` and `Backend::make_solid` do.
    ElementLoops(const SolidModel& model, const ElementLoopOptions& options);

    /// Whether the functions below may be called.
    bool are_on_device() const { return solid_ != nullptr; }
    const ElementLoopInfo& describe() const { return info_; }

    SolidForce internal_force(const Eigen::VectorXd& u) const;
    void tangent(const Eigen::VectorXd& u, BlockMatrix& matrix) const;
    std::vector<std::vector<double>> parameter_products(const Eigen::VectorXd& u,
                                                        const Eigen::VectorXd& lambda) const;

private:
    ElementLoopInfo info_;
    std::unique_ptr<Backend> backend_;
    std::unique_ptr<SolidDevice> solid_;
    mutable std::mutex mutex_;  ///< a device has one queue
};

}  // namespace palpate
