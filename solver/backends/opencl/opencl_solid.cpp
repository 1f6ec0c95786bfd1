// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/opencl_solid.hpp"

#include "solver/backends/opencl/device_solid.hpp"
#include "solver/backends/opencl/opencl_objects.hpp"

namespace palpate {
namespace {

/// What `DeviceSolid` does, behind checks of what it is given.
class OpenclSolid final : public SolidDevice {
public:
    OpenclSolid(Session& session, SolidTables tables)
        : session_(session), solid_(session, std::move(tables)) {}

    SolidForce internal_force(std::span<const double> u) override {
        check(u, "internal_force");
        return guarded("compute internal forces", [&] { return solid_.internal_force(u); });
    }

    void tangent(std::span<const double> u, BlockMatrix& matrix) override {
        check(u, "tangent");
        require_pattern(solid_.tables(), matrix, "opencl");
        guarded("assemble the tangent", [&] { solid_.tangent(u, matrix.blocks); });
    }

    void linearise(std::span<const double> u) override {
        check(u, "linearise");
        guarded("copy a displacement", [&] { solid_.linearise(u); });
    }

    void apply(const DeviceVector& x, DeviceVector& y) override {
        const auto &in = own_of<const OpenclVector>(session_, x),
                   &out = own_of<const OpenclVector>(session_, y);
        if (!solid_.has_state() || &x == &y || x.rows() != solid_.tables().num_dofs() ||
            y.rows() != x.rows() || y.columns() != x.columns())
            throw Error(ErrorCode::invalid_argument,
                        "Back end opencl, apply: call linearise(u) first and give two vectors of "
                        "three rows per node and as many columns.");
        guarded("multiply with the tangent",
                [&] { solid_.apply(in.buffer(), out.buffer(), x.columns()); });
    }

    std::vector<std::vector<double>> parameter_products(std::span<const double> u,
                                                        std::span<const double> lambda) override {
        check(u, "parameter_products");
        check(lambda, "parameter_products");
        return guarded("compute parameter products",
                       [&] { return solid_.parameter_products(u, lambda); });
    }

private:
    void check(std::span<const double> u, const char* function) const {
        require_displacement(solid_.tables(), u, "opencl", function);
    }

    Session& session_;
    DeviceSolid solid_;
};

}  // namespace

std::unique_ptr<SolidDevice> make_opencl_solid(Session& session, const SolidModel& model) {
    return guarded("prepare element loops", [&] {
        return std::make_unique<OpenclSolid>(session, solid_tables(model, "opencl"));
    });
}

}  // namespace palpate
