// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/opencl_backend.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "solver/backends/opencl/device_model.hpp"
#include "solver/backends/opencl/session.hpp"

namespace palpate {
namespace {

constexpr std::size_t max_coefficients = 16;  // MAX_COEFFICIENTS of vector_ops.cl

template <class Real>
struct Coefficients {
    Real value[max_coefficients] = {};

    Coefficients(std::span<const double> all, const ColumnPass& pass) {
        for (std::size_t c = 0; c < pass.groups * pass.width; ++c)
            value[c] = static_cast<Real>(all[pass.first + c]);
    }
};

// Parts that the rows of an inner product are cut into: enough to share out, few enough to read.
std::size_t num_dot_parts(std::size_t rows, bool is_cpu) {
    return is_cpu ? std::clamp<std::size_t>(rows / 512, 1, 256)
                  : std::clamp<std::size_t>(rows / 16, 1, 4096);
}

[[noreturn]] void refuse(const std::string& message) {
    throw Error(ErrorCode::invalid_argument, message);
}

void refuse_same(const DeviceVector& x, const DeviceVector& y) {
    if (&x == &y) refuse("The product K x cannot overwrite x: give two vectors.");
}

std::string shape_of(const DeviceVector& v) { return fmt::format("{}x{}", v.rows(), v.columns()); }

class OpenclVector final : public DeviceVector {
public:
    OpenclVector(Index rows, Index columns, cl::Buffer buffer, const Session* owner)
        : DeviceVector(rows, columns), buffer_(std::move(buffer)), owner_(owner) {}
    const cl::Buffer& buffer() const { return buffer_; }
    const Session* owner() const { return owner_; }
    std::size_t size() const { return static_cast<std::size_t>(rows()) * columns(); }

private:
    cl::Buffer buffer_;
    const Session* owner_;
};

class OpenclBackend final : public Backend {
public:
    OpenclBackend(std::shared_ptr<OpenclDevice> device, const BackendOptions& options)
        : session_(std::move(device), options.precision), product_(options.product) {}

    BackendInfo describe() const override;
    void prepare(const Model& model) override;
    void set_stiffness(std::span<const double> stiffness_kpa) override;
    std::unique_ptr<DeviceVector> make_vector(Index rows, Index columns) override;
    void copy_in(std::span<const double> host, DeviceVector& v) override;
    void copy_out(const DeviceVector& v, std::span<double> host) override;
    void fill(DeviceVector& v, double value) override;
    void axpby(std::span<const double> alpha, const DeviceVector& x, std::span<const double> beta,
               DeviceVector& y) override;
    void dot(const DeviceVector& x, const DeviceVector& y, std::span<double> result) override;
    void internal_force(const DeviceVector& x, DeviceVector& y) override;
    void apply_stiffness(const DeviceVector& x, DeviceVector& y) override;
    void apply_block_jacobi(const DeviceVector& r, DeviceVector& z) override;
    void strain_energy(const DeviceVector& x, std::span<double> energy) override;
    void parameter_gradient(const DeviceVector& lambda, const DeviceVector& x,
                            std::span<double> gradient) override;
    void wait() override;

private:
    const OpenclVector& mine(const DeviceVector& v) const;
    const cl::Buffer& buffer_of(const DeviceVector& v) const { return mine(v).buffer(); }
    DeviceModel& model_for(const DeviceVector& x, const DeviceVector& y);
    template <class Real>
    void axpby_pass(std::span<const double> alpha, const DeviceVector& x,
                    std::span<const double> beta, const DeviceVector& y, const ColumnPass& pass);
    const cl::Buffer& parts_buffer(std::size_t count);

    Session session_;
    Product product_;
    std::optional<DeviceModel> model_;
    cl::Buffer parts_;  ///< partial sums of `dot`
    std::size_t parts_count_ = 0;
};

BackendInfo OpenclBackend::describe() const {
    const DeviceInfo& device = session_.device().info;
    BackendInfo info;
    info.backend = "opencl";
    info.platform = device.platform;
    info.device = device.name;
    info.version = fmt::format("{}, driver {}", device.version, device.driver);
    info.precision = session_.precision();
    info.product = product_;
    info.compute_units = device.compute_units;
    info.type = device.type;
    return info;
}

const OpenclVector& OpenclBackend::mine(const DeviceVector& v) const {
    const auto* vector = dynamic_cast<const OpenclVector*>(&v);
    if (!vector || vector->owner() != &session_)
        refuse("The vector belongs to another back end: make it with the one that uses it.");
    return *vector;
}

DeviceModel& OpenclBackend::model_for(const DeviceVector& x, const DeviceVector& y) {
    if (!model_) refuse("The OpenCL back end holds no model: call prepare(model) first.");
    if (x.rows() != model_->num_rows() || y.rows() != x.rows() || x.columns() != y.columns())
        refuse(
            fmt::format("Vectors of {} and {} do not fit the model: both need {} rows and the "
                        "same number of columns.",
                        shape_of(x), shape_of(y), model_->num_rows()));
    return *model_;
}

void OpenclBackend::prepare(const Model& model) {
    check_model(model);
    guarded("prepare the model", [&] {
        model_.reset();
        model_.emplace(session_, model, product_);
        session_.wait();
    });
}

void OpenclBackend::set_stiffness(std::span<const double> stiffness_kpa) {
    if (!model_) refuse("The OpenCL back end holds no model: call prepare(model) first.");
    if (stiffness_kpa.size() != static_cast<std::size_t>(model_->num_materials()))
        refuse(fmt::format("{} Young's moduli were given, the model has {} materials.",
                           stiffness_kpa.size(), model_->num_materials()));
    guarded("set the stiffness", [&] { model_->set_stiffness(stiffness_kpa); });
}

std::unique_ptr<DeviceVector> OpenclBackend::make_vector(Index rows, Index columns) {
    if (rows < 0 || columns < 1)
        refuse(
            fmt::format("A vector of {}x{} was asked for: rows must be at least 0, columns at "
                        "least 1.",
                        rows, columns));
    return guarded("make a vector", [&] {
        auto vector = std::make_unique<OpenclVector>(
            rows, columns, session_.make_real_buffer(static_cast<std::size_t>(rows) * columns),
            &session_);
#ifndef NDEBUG
        fill(*vector, std::numeric_limits<double>::quiet_NaN());  // shows results nobody wrote
#endif
        return vector;
    });
}

void OpenclBackend::copy_in(std::span<const double> host, DeviceVector& v) {
    const OpenclVector& to = mine(v);
    if (host.size() != to.size())
        refuse(fmt::format("{} numbers do not fit a vector of {}.", host.size(), shape_of(v)));
    guarded("copy to the device", [&] { session_.write_real(host, to.buffer()); });
}

void OpenclBackend::copy_out(const DeviceVector& v, std::span<double> host) {
    const OpenclVector& from = mine(v);
    if (host.size() != from.size())
        refuse(fmt::format("A vector of {} does not fit {} numbers.", shape_of(v), host.size()));
    guarded("copy from the device", [&] { session_.read_real(from.buffer(), host); });
}

void OpenclBackend::fill(DeviceVector& v, double value) {
    const OpenclVector& to = mine(v);
    const auto run = [&](auto real_value) {
        session_.run({"vector_ops", "fill"}, to.size(), single_column, to.buffer(), real_value,
                     static_cast<cl_ulong>(to.size()));
    };
    guarded("fill a vector", [&] {
        if (session_.is_double())
            run(static_cast<cl_double>(value));
        else
            run(static_cast<cl_float>(value));
    });
}

template <class Real>
void OpenclBackend::axpby_pass(std::span<const double> alpha, const DeviceVector& x,
                               std::span<const double> beta, const DeviceVector& y,
                               const ColumnPass& pass) {
    session_.run({"vector_ops", "axpby"}, y.rows(), pass, Coefficients<Real>(alpha, pass),
                 buffer_of(x), Coefficients<Real>(beta, pass), buffer_of(y), cl_int(y.rows()),
                 cl_int(y.columns()), cl_int(pass.first));
}

void OpenclBackend::axpby(std::span<const double> alpha, const DeviceVector& x,
                          std::span<const double> beta, DeviceVector& y) {
    const std::size_t columns = y.columns();
    if (x.rows() != y.rows() || x.columns() != y.columns() || alpha.size() != columns ||
        beta.size() != columns)
        refuse(fmt::format("axpby of {} to {} with {} and {} coefficients: the sizes must agree.",
                           shape_of(x), shape_of(y), alpha.size(), beta.size()));
    guarded("add vectors", [&] {
        for (std::size_t begin = 0; begin < columns; begin += max_coefficients)
            for (ColumnPass pass : session_.passes(std::min(max_coefficients, columns - begin))) {
                pass.first += begin;
                if (session_.is_double())
                    axpby_pass<cl_double>(alpha, x, beta, y, pass);
                else
                    axpby_pass<cl_float>(alpha, x, beta, y, pass);
            }
    });
}

const cl::Buffer& OpenclBackend::parts_buffer(std::size_t count) {
    if (count > parts_count_) {
        parts_ = session_.make_buffer(count * session_.wide_bytes());
        parts_count_ = count;
    }
    return parts_;
}

void OpenclBackend::dot(const DeviceVector& x, const DeviceVector& y, std::span<double> result) {
    const std::size_t columns = x.columns();
    if (x.rows() != y.rows() || x.columns() != y.columns() || result.size() != columns)
        refuse(fmt::format("dot of {} with {} into {} numbers: the sizes must agree.", shape_of(x),
                           shape_of(y), result.size()));
    guarded("take inner products", [&] {
        const std::size_t num_parts = num_dot_parts(x.rows(), session_.device().is_cpu);
        const cl::Buffer& parts = parts_buffer(num_parts * columns);
        for (const ColumnPass& pass : session_.passes(columns))
            session_.run({"vector_ops", "dot_parts", -1, ItemLength::many_rows}, num_parts, pass,
                         buffer_of(x), buffer_of(y), parts, cl_int(x.rows()), cl_int(columns),
                         cl_int(pass.first), cl_int(num_parts));
        const std::vector<double> sums = session_.read_wide(parts, num_parts * columns);
        std::fill(result.begin(), result.end(), 0.0);
        for (std::size_t i = 0; i < sums.size(); ++i) result[i % columns] += sums[i];
    });
}

void OpenclBackend::internal_force(const DeviceVector& x, DeviceVector& y) {
    DeviceModel& model = model_for(x, y);
    refuse_same(x, y);
    guarded("compute internal forces",
            [&] { model.multiply(buffer_of(x), buffer_of(y), x.columns(), false); });
}

void OpenclBackend::apply_stiffness(const DeviceVector& x, DeviceVector& y) {
    DeviceModel& model = model_for(x, y);
    refuse_same(x, y);
    guarded("multiply with the stiffness",
            [&] { model.multiply(buffer_of(x), buffer_of(y), x.columns(), true); });
}

void OpenclBackend::apply_block_jacobi(const DeviceVector& r, DeviceVector& z) {
    DeviceModel& model = model_for(r, z);
    guarded("apply block-Jacobi",
            [&] { model.apply_block_jacobi(buffer_of(r), buffer_of(z), r.columns()); });
}

void OpenclBackend::strain_energy(const DeviceVector& x, std::span<double> energy) {
    DeviceModel& model = model_for(x, x);
    if (energy.size() != static_cast<std::size_t>(x.columns()))
        refuse(fmt::format("Strain energies of {} columns do not fit {} numbers.", x.columns(),
                           energy.size()));
    guarded("compute strain energy", [&] { model.strain_energy(buffer_of(x), energy); });
}

void OpenclBackend::parameter_gradient(const DeviceVector& lambda, const DeviceVector& x,
                                       std::span<double> gradient) {
    DeviceModel& model = model_for(lambda, x);
    if (gradient.size() != static_cast<std::size_t>(model.num_materials()))
        refuse(fmt::format("The gradient of {} moduli does not fit {} numbers.",
                           model.num_materials(), gradient.size()));
    guarded("compute the parameter gradient", [&] {
        const std::size_t columns = x.columns();
        const std::vector<double> products =
            model.energy_products(buffer_of(lambda), buffer_of(x), columns);
        std::fill(gradient.begin(), gradient.end(), 0.0);
        for (std::size_t i = 0; i < products.size(); ++i) gradient[i / columns] += products[i];
    });
}

void OpenclBackend::wait() {
    guarded("wait for the device", [&] { session_.wait(); });
}

}  // namespace

std::unique_ptr<Backend> make_opencl_backend(const BackendOptions& options) {
    return make_opencl_backend_on(open_device(options.device), options);
}

std::unique_ptr<Backend> make_opencl_backend_on(std::shared_ptr<OpenclDevice> device,
                                                const BackendOptions& options) {
    if (options.precision == Precision::double_ && !device->has_double)
        throw Error(ErrorCode::unsupported,
                    fmt::format("The device {} has no double precision (cl_khr_fp64): use single "
                                "precision or another device.",
                                device->info.name));
    return guarded("open a queue on the device",
                   [&] { return std::make_unique<OpenclBackend>(std::move(device), options); });
}

}  // namespace palpate
