// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/opencl_solid.hpp"

#include "solver/backends/opencl/device_solid.hpp"
#include "solver/backends/opencl/opencl_objects.hpp"

namespace palpate {
namespace {

class OpenclSolid final : public SolidDevice {
public:
    OpenclSolid(Session& session, SolidTables of_model)
        : SolidDevice(std::move(of_model)), session_(session), solid_(session, tables()) {}

private:
    SolidForce do_internal_force(std::span<const double> u) override {
        return guarded("compute internal forces", [&] { return solid_.internal_force(u); });
    }

    void do_tangent(std::span<const double> u, std::span<double> blocks) override {
        guarded("assemble the tangent", [&] { solid_.tangent(u, blocks); });
    }

    void do_linearise(std::span<const double> u) override {
        guarded("copy a displacement", [&] { solid_.linearise(u); });
    }

    void do_apply(const DeviceVector& x, DeviceVector& y) override {
        const auto &in = own_of<const OpenclVector>(session_, x),
                   &out = own_of<const OpenclVector>(session_, y);
        guarded("multiply with the tangent",
                [&] { solid_.apply(in.buffer(), out.buffer(), x.columns()); });
    }

    std::vector<std::vector<double>> do_parameter_products(
        std::span<const double> u, std::span<const double> lambda) override {
        return guarded("compute parameter products",
                       [&] { return solid_.parameter_products(u, lambda); });
    }

    Session& session_;
    DeviceSolid solid_;
};

}  // namespace

std::unique_ptr<SolidDevice> make_opencl_solid(Session& session, SolidTables tables) {
    return guarded("prepare element loops",
                   [&] { return std::make_unique<OpenclSolid>(session, std::move(tables)); });
}

}  // namespace palpate
