// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/opencl_backend.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "solver/backends/opencl/device_model.hpp"
#include "solver/backends/opencl/opencl_objects.hpp"
#include "solver/backends/opencl/opencl_solid.hpp"

namespace palpate {
namespace {

constexpr std::size_t vector_work = 4;  // a vector operation per row, in multiply-adds
constexpr std::size_t lane_width = 16;  // of a single column on a CPU, see kernels/parts.cl

class OpenclBackend final : public Backend {
public:
    OpenclBackend(std::shared_ptr<OpenclDevice> device, const BackendOptions& options)
        : session_(std::move(device), options.precision), product_(options.product) {}

    BackendInfo describe() const override;
    void fill(DeviceVector& v, double value) override;
    void wait() override;

private:
    void do_prepare(const Model& model) override;
    void do_set_stiffness(std::span<const double> stiffness_kpa) override;
    std::unique_ptr<DeviceVector> do_make_vector(Index rows, Index columns) override;
    void do_copy_in(std::span<const double> host, DeviceVector& v) override;
    void do_copy_out(const DeviceVector& v, std::span<double> host) override;
    void do_copy_columns(const DeviceVector& from, std::span<const Index> from_columns,
                         DeviceVector& to, std::span<const Index> to_columns) override;
    std::unique_ptr<DeviceSums> do_make_sums(Index columns) override;
    void do_set(DeviceSums& sums, std::span<const double> values) override;
    void do_read(const DeviceSums& sums, std::span<double> values) override;
    void do_dot(const DeviceVector& x, const DeviceVector& y, DeviceSums& xy) override;
    std::unique_ptr<DeviceOperator> do_make_operator(const BlockMatrix& matrix,
                                                     bool has_inverse_diagonal) override;
    void do_set_values(DeviceOperator& a, const BlockMatrix& matrix,
                       std::span<const double> inverse_diagonal) override;
    const DeviceOperator& do_stiffness() override { return *stiffness_; }
    void do_multiply(const OperatorProduct& product) override;
    void do_apply_inverse_diagonal(const DeviceOperator& a, double weight, const DeviceVector& r,
                                   DeviceVector& z, DeviceSums* rz) override;
    void do_advance(const DeviceSums& rz, const DeviceSums& pq, const DeviceSums& rr,
                    const DeviceSums& limit, const DeviceVector& p, const DeviceVector& q,
                    DeviceVector& x, DeviceVector& r, DeviceSums& rr_new) override;
    void do_turn(const DeviceSums& rz_new, const DeviceSums& rz, const DeviceVector& z,
                 DeviceVector& p) override;
    void do_internal_force(const DeviceVector& x, DeviceVector& y) override;
    void do_strain_energy(const DeviceVector& x, std::span<double> energy) override;
    void do_parameter_gradient(const DeviceVector& lambda, const DeviceVector& x,
                               std::span<double> gradient) override;
    std::unique_ptr<SolidDevice> do_make_solid(SolidTables tables) override;

    const cl::Buffer& buffer_of(const DeviceVector& v) const {
        return own_of<const OpenclVector>(session_, v).buffer();
    }
    const OpenclSums& mine(const DeviceSums& sums) const {
        return own_of<const OpenclSums>(session_, sums);
    }
    OpenclSums& mine(DeviceSums& sums) const { return own_of<OpenclSums>(session_, sums); }
    void fill_range(const OpenclVector& v, double value, std::size_t first, std::size_t end);
    /// A vector operation over parts; `args` come before num_rows, num_columns, first_column.
    template <class... Args>
    std::size_t run_on_columns(const char* function, const DeviceVector& shape,
                               const Args&... args);

    Session session_;
    Product product_;
    std::optional<DeviceModel> model_;
    std::optional<OpenclOperator> stiffness_;
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
    if (model_) info.choices = model_->choices();
    info.compute_units = device.compute_units;
    info.type = device.type;
    return info;
}

void OpenclBackend::do_prepare(const Model& model) {
    guarded("prepare the model", [&] {
        model_.reset();
        model_.emplace(session_, model, product_);
        stiffness_.emplace(model.num_dofs(), session_);
        session_.wait();
    });
}

void OpenclBackend::do_set_stiffness(std::span<const double> stiffness_kpa) {
    guarded("set the stiffness", [&] { model_->set_stiffness(stiffness_kpa); });
}

std::unique_ptr<DeviceVector> OpenclBackend::do_make_vector(Index rows, Index columns) {
    return guarded("make a vector", [&] {
        const std::size_t size = static_cast<std::size_t>(rows) * columns;
        const std::size_t padded = (size + lane_width - 1) / lane_width * lane_width;
        auto vector = std::make_unique<OpenclVector>(rows, columns,
                                                     session_.make_real_buffer(padded), session_);
        fill_range(*vector, 0, size, padded);
#ifndef NDEBUG
        fill(*vector, std::numeric_limits<double>::quiet_NaN());  // shows results nobody wrote
#endif
        return vector;
    });
}

void OpenclBackend::do_copy_in(std::span<const double> host, DeviceVector& v) {
    guarded("copy to the device", [&] { session_.write_real(host, buffer_of(v)); });
}

void OpenclBackend::do_copy_out(const DeviceVector& v, std::span<double> host) {
    guarded("copy from the device", [&] { session_.read_real(buffer_of(v), host); });
}

void OpenclBackend::fill(DeviceVector& v, double value) {
    const auto& to = own_of<const OpenclVector>(session_, v);
    guarded("fill a vector", [&] { fill_range(to, value, 0, to.size()); });
}

void OpenclBackend::fill_range(const OpenclVector& v, double value, std::size_t first,
                               std::size_t end) {
    with_real(session_, [&](auto real) {
        session_.run({"vector_ops", "fill"}, end - first, single_column, v.buffer(), real(value),
                     static_cast<cl_ulong>(first), static_cast<cl_ulong>(end));
    });
}

void OpenclBackend::do_copy_columns(const DeviceVector& from, std::span<const Index> from_columns,
                                    DeviceVector& to, std::span<const Index> to_columns) {
    const auto& source = own<const OpenclVector>(from);
    if (&source.owner().device() != &session_.device())
        refuse("The vector belongs to another device: copy it through the host.");
    const cl::Buffer& target = buffer_of(to);
    const KernelVariant variant = {.from_is_double = source.owner().is_double()};
    const auto is_all = [](std::span<const Index> columns, Index count) {
        for (std::size_t i = 0; i < columns.size(); ++i)
            if (columns[i] != static_cast<Index>(i)) return false;
        return static_cast<Index>(columns.size()) == count;
    };
    guarded("copy columns", [&] {
        if (is_all(from_columns, from.columns()) && is_all(to_columns, to.columns())) {
            session_.run({"vector_ops", "copy_all", variant}, to.size(), single_column,
                         source.buffer(), target, cl_ulong(to.size()));
            return;
        }
        const cl::Buffer from_list =
            session_.upload(std::vector<Index>(from_columns.begin(), from_columns.end()));
        const cl::Buffer to_list =
            session_.upload(std::vector<Index>(to_columns.begin(), to_columns.end()));
        session_.run({"vector_ops", "copy_columns", variant}, to.rows(), single_column,
                     source.buffer(), from_list, cl_int(from.columns()), target, to_list,
                     cl_int(to.columns()), cl_int(to.rows()), cl_int(from_columns.size()));
    });
}

std::unique_ptr<DeviceSums> OpenclBackend::do_make_sums(Index columns) {
    return guarded("make sums", [&] {
        return std::make_unique<OpenclSums>(
            columns, session_.make_buffer(session_.most_parts() * columns * session_.wide_bytes()),
            session_);
    });
}

void OpenclBackend::do_set(DeviceSums& sums, std::span<const double> values) {
    OpenclSums& to = mine(sums);
    guarded("write sums", [&] { session_.write_wide(values, to.buffer()); });
    to.num_parts = 1;
}

void OpenclBackend::do_read(const DeviceSums& sums, std::span<double> values) {
    const OpenclSums& from = mine(sums);
    const std::vector<double> parts = guarded("read sums", [&] {
        return session_.read_wide(from.buffer(), from.num_parts * values.size());
    });
    std::fill(values.begin(), values.end(), 0.0);
    for (std::size_t i = 0; i < parts.size(); ++i) values[i % values.size()] += parts[i];
}

template <class... Args>
std::size_t OpenclBackend::run_on_columns(const char* function, const DeviceVector& shape,
                                          const Args&... args) {
    const std::size_t rows = shape.rows(), columns = shape.columns();
    if (columns == 1 && session_.device().is_cpu) {
        const std::size_t lanes = (rows + lane_width - 1) / lane_width;
        const std::size_t parts = session_.num_parts(lanes, vector_work * lane_width);
        session_.run_parts({"conjugate_gradients", function, {.lanes = 1}}, parts,
                           {0, 1, lane_width}, args..., cl_int(lanes), cl_int(1), cl_int(0));
        return parts;
    }
    const std::size_t parts = session_.num_parts(rows, vector_work * columns);
    for (const ColumnPass& pass : session_.passes(columns))
        session_.run_parts({"conjugate_gradients", function}, parts, pass, args..., cl_int(rows),
                           cl_int(columns), cl_int(pass.first));
    return parts;
}

void OpenclBackend::do_dot(const DeviceVector& x, const DeviceVector& y, DeviceSums& xy) {
    OpenclSums& sums = mine(xy);
    guarded("take inner products", [&] {
        sums.num_parts =
            run_on_columns("dot_columns", x, buffer_of(x), buffer_of(y), sums.buffer());
    });
}

void OpenclBackend::do_advance(const DeviceSums& rz, const DeviceSums& pq, const DeviceSums& rr,
                               const DeviceSums& limit, const DeviceVector& p,
                               const DeviceVector& q, DeviceVector& x, DeviceVector& r,
                               DeviceSums& rr_new) {
    const OpenclSums& a = mine(rz);
    const OpenclSums& b = mine(pq);
    const OpenclSums& c = mine(rr);
    const OpenclSums& d = mine(limit);
    OpenclSums& e = mine(rr_new);
    guarded("step along the search directions", [&] {
        e.num_parts = run_on_columns("advance", p, a.buffer(), cl_int(a.num_parts), b.buffer(),
                                     cl_int(b.num_parts), c.buffer(), cl_int(c.num_parts),
                                     d.buffer(), cl_int(d.num_parts), buffer_of(p), buffer_of(q),
                                     buffer_of(x), buffer_of(r), e.buffer());
    });
}

void OpenclBackend::do_turn(const DeviceSums& rz_new, const DeviceSums& rz, const DeviceVector& z,
                            DeviceVector& p) {
    const OpenclSums& now = mine(rz_new);
    const OpenclSums& before = mine(rz);
    guarded("turn the search directions", [&] {
        run_on_columns("turn", p, now.buffer(), cl_int(now.num_parts), before.buffer(),
                       cl_int(before.num_parts), buffer_of(z), buffer_of(p));
    });
}

std::unique_ptr<DeviceOperator> OpenclBackend::do_make_operator(const BlockMatrix& matrix,
                                                                bool has_inverse_diagonal) {
    return guarded("make an operator", [&] {
        auto a = std::make_unique<OpenclOperator>(matrix, has_inverse_diagonal, session_);
        a->blocks.emplace(session_, matrix.graph, matrix.block_rows, matrix.block_columns,
                          has_inverse_diagonal);
        return a;
    });
}

void OpenclBackend::do_set_values(DeviceOperator& a, const BlockMatrix& matrix,
                                  std::span<const double> inverse_diagonal) {
    auto& op = own_of<OpenclOperator>(session_, a);
    guarded("write an operator",
            [&] { op.blocks->set_values(session_, matrix, inverse_diagonal); });
}

void OpenclBackend::do_multiply(const OperatorProduct& product) {
    const auto& op = own_of<const OpenclOperator>(session_, product.a);
    OpenclSums* const sums = product.sum ? &mine(*product.sum) : nullptr;
    const RowJob job{.result = product.result,
                     .x = &buffer_of(product.x),
                     .y = &buffer_of(product.y),
                     .b = product.b ? &buffer_of(*product.b) : nullptr,
                     .alpha = product.alpha,
                     .beta = product.beta,
                     .weight = product.weight,
                     .sum = sums ? &sums->buffer() : nullptr,
                     .num_columns = static_cast<std::size_t>(product.x.columns())};
    guarded("multiply with an operator", [&] {
        const std::size_t parts = op.blocks ? op.blocks->run(session_, job) : model_->run(job);
        if (sums) sums->num_parts = parts;
    });
}

void OpenclBackend::do_apply_inverse_diagonal(const DeviceOperator& a, double weight,
                                              const DeviceVector& r, DeviceVector& z,
                                              DeviceSums* rz) {
    const auto& op = own_of<const OpenclOperator>(session_, a);
    OpenclSums* const sums = rz ? &mine(*rz) : nullptr;
    const cl::Buffer* const sum = sums ? &sums->buffer() : nullptr;
    guarded("scale with the diagonal", [&] {
        const std::size_t parts =
            op.blocks ? multiply_diagonal(session_, op.blocks->inverse_diagonal(),
                                          op.blocks->num_rows(), op.blocks->block_rows(), weight,
                                          buffer_of(r), buffer_of(z), sum, r.columns())
                      : model_->apply_inverse_diagonal(weight, buffer_of(r), buffer_of(z), sum,
                                                       r.columns());
        if (sums) sums->num_parts = parts;
    });
}

void OpenclBackend::do_internal_force(const DeviceVector& x, DeviceVector& y) {
    guarded("compute internal forces",
            [&] { model_->internal_force(buffer_of(x), buffer_of(y), x.columns()); });
}

void OpenclBackend::do_strain_energy(const DeviceVector& x, std::span<double> energy) {
    guarded("compute strain energy", [&] { model_->strain_energy(buffer_of(x), energy); });
}

void OpenclBackend::do_parameter_gradient(const DeviceVector& lambda, const DeviceVector& x,
                                          std::span<double> gradient) {
    guarded("compute the parameter gradient", [&] {
        const std::size_t columns = x.columns();
        const std::vector<double> products =
            model_->energy_products(buffer_of(lambda), buffer_of(x), columns);
        std::fill(gradient.begin(), gradient.end(), 0.0);
        for (std::size_t i = 0; i < products.size(); ++i) gradient[i / columns] += products[i];
    });
}

std::unique_ptr<SolidDevice> OpenclBackend::do_make_solid(SolidTables tables) {
    return make_opencl_solid(session_, std::move(tables));
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
