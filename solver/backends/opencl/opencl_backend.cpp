// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/opencl_backend.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <optional>

#include "solver/backends/opencl/device_model.hpp"
#include "solver/backends/opencl/opencl_solid.hpp"
#include "solver/backends/opencl/opencl_vector.hpp"
#include "solver/backends/opencl/session.hpp"

namespace palpate {
namespace {

constexpr std::size_t vector_work = 4;  // a vector operation per row, in multiply-adds
constexpr std::size_t lane_width = 16;  // of a single column on a CPU, see kernels/parts.cl

[[noreturn]] void refuse(const std::string& message) {
    throw Error(ErrorCode::invalid_argument, message);
}

void refuse_same(const DeviceVector& x, const DeviceVector& y) {
    if (&x == &y) refuse("The product K x cannot overwrite x: give two vectors.");
}

std::string shape_of(const DeviceVector& v) { return fmt::format("{}x{}", v.rows(), v.columns()); }

void refuse_other_shapes(const char* what, std::initializer_list<const DeviceVector*> vectors) {
    const DeviceVector& first = **vectors.begin();
    for (const DeviceVector* v : vectors)
        if (v->rows() != first.rows() || v->columns() != first.columns())
            refuse(fmt::format("{} needs vectors of one shape, not {} and {}.", what,
                               shape_of(first), shape_of(*v)));
}

class OpenclSums final : public DeviceSums {
public:
    OpenclSums(Index columns, cl::Buffer buffer, const Session* owner)
        : DeviceSums(columns), buffer_(std::move(buffer)), owner_(owner) {}
    const cl::Buffer& buffer() const { return buffer_; }
    const Session* owner() const { return owner_; }
    std::size_t num_parts = 0;  ///< rows of the buffer that hold the sums

private:
    cl::Buffer buffer_;
    const Session* owner_;
};

/// A block matrix, or the stiffness of the back end's model (then without blocks of its own).
class OpenclOperator final : public DeviceOperator {
public:
    OpenclOperator(Index rows, Index columns, const Session* owner)
        : DeviceOperator(rows, columns), owner_(owner) {}
    const Session* owner() const { return owner_; }
    std::optional<DeviceBlocks> blocks;

private:
    const Session* owner_;
};

void refuse_without_diagonal(const OpenclOperator& a) {
    if (a.blocks && !a.blocks->is_square())
        refuse("The operator was made without its inverted diagonal blocks: give them to smooth.");
}

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
    void copy_columns(const DeviceVector& from, std::span<const Index> from_columns,
                      DeviceVector& to, std::span<const Index> to_columns) override;
    std::unique_ptr<DeviceSums> make_sums(Index columns) override;
    void set(DeviceSums& sums, std::span<const double> values) override;
    void read(const DeviceSums& sums, std::span<double> values) override;
    void dot(const DeviceVector& x, const DeviceVector& y, DeviceSums& xy) override;
    std::unique_ptr<DeviceOperator> make_operator(
        const BlockMatrix& matrix, std::span<const double> inverse_diagonal) override;
    void set_values(DeviceOperator& a, const BlockMatrix& matrix,
                    std::span<const double> inverse_diagonal) override;
    const DeviceOperator& stiffness() override;
    void apply(const DeviceOperator& a, const DeviceVector& x, DeviceVector& y,
               DeviceSums* xy) override;
    void apply_add(const DeviceOperator& a, const DeviceVector& x, DeviceVector& y) override;
    void residual(const DeviceOperator& a, const DeviceVector& b, const DeviceVector& x,
                  DeviceVector& r) override;
    void apply_inverse_diagonal(const DeviceOperator& a, double weight, const DeviceVector& r,
                                DeviceVector& z, DeviceSums* rz) override;
    void smooth(const DeviceOperator& a, const DeviceVector& b, const DeviceVector& x, double alpha,
                double beta, double weight, DeviceVector& y, DeviceSums* by) override;
    void advance(const DeviceSums& rz, const DeviceSums& pq, const DeviceSums& rr,
                 const DeviceSums& limit, const DeviceVector& p, const DeviceVector& q,
                 DeviceVector& x, DeviceVector& r, DeviceSums& rr_new) override;
    void turn(const DeviceSums& rz_new, const DeviceSums& rz, const DeviceVector& z,
              DeviceVector& p) override;
    void internal_force(const DeviceVector& x, DeviceVector& y) override;
    void strain_energy(const DeviceVector& x, std::span<double> energy) override;
    void parameter_gradient(const DeviceVector& lambda, const DeviceVector& x,
                            std::span<double> gradient) override;
    std::unique_ptr<SolidDevice> make_solid(const SolidModel& model) override;
    void wait() override;

private:
    const OpenclVector& mine(const DeviceVector& v) const { return vector_of(v, session_); }
    const cl::Buffer& buffer_of(const DeviceVector& v) const { return mine(v).buffer(); }
    DeviceModel& model_for(const DeviceVector& x, const DeviceVector& y);
    const OpenclSums& mine(const DeviceSums& sums, Index columns) const;
    OpenclSums& mine(DeviceSums& sums, Index columns) const;
    const OpenclOperator& mine(const DeviceOperator& a) const;
    void fill_range(const OpenclVector& v, double value, std::size_t first, std::size_t end);
    /// `apply` and its relatives: sizes checked, then the product.
    void run(const char* what, const DeviceOperator& a, const DeviceVector* b,
             const DeviceVector& x, DeviceVector& y, RowJob job, DeviceSums* sum);
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
        stiffness_.emplace(model.num_dofs(), model.num_dofs(), &session_);
        session_.wait();
    });
}

void OpenclBackend::set_stiffness(std::span<const double> stiffness_kpa) {
    if (!model_) refuse("The OpenCL back end holds no model: call prepare(model) first.");
    if (stiffness_kpa.size() != static_cast<std::size_t>(model_->num_materials()))
        refuse(fmt::format("{} Young's moduli were given, the model has {} materials.",
                           stiffness_kpa.size(), model_->num_materials()));
    for (double modulus : stiffness_kpa)
        if (!(modulus > 0))
            refuse(
                fmt::format("A Young's modulus of {} kPa was given: it must be above 0.", modulus));
    guarded("set the stiffness", [&] { model_->set_stiffness(stiffness_kpa); });
}

std::unique_ptr<DeviceVector> OpenclBackend::make_vector(Index rows, Index columns) {
    if (rows < 0 || columns < 1)
        refuse(
            fmt::format("A vector of {}x{} was asked for: rows must be at least 0, columns at "
                        "least 1.",
                        rows, columns));
    return guarded("make a vector", [&] {
        const std::size_t size = static_cast<std::size_t>(rows) * columns;
        const std::size_t padded = (size + lane_width - 1) / lane_width * lane_width;
        auto vector = std::make_unique<OpenclVector>(rows, columns,
                                                     session_.make_real_buffer(padded), &session_);
        fill_range(*vector, 0, size, padded);
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
    guarded("fill a vector", [&] { fill_range(to, value, 0, to.size()); });
}

void OpenclBackend::fill_range(const OpenclVector& v, double value, std::size_t first,
                               std::size_t end) {
    with_real(session_, [&](auto real) {
        session_.run({"vector_ops", "fill"}, end - first, single_column, v.buffer(), real(value),
                     static_cast<cl_ulong>(first), static_cast<cl_ulong>(end));
    });
}

void OpenclBackend::copy_columns(const DeviceVector& from, std::span<const Index> from_columns,
                                 DeviceVector& to, std::span<const Index> to_columns) {
    const auto* source = dynamic_cast<const OpenclVector*>(&from);
    if (!source || &source->owner()->device() != &session_.device())
        refuse("The vector belongs to another device: copy it through the host.");
    const OpenclVector& target = mine(to);
    const auto has = [](Index columns) {
        return [columns](Index c) { return c >= 0 && c < columns; };
    };
    if (from.rows() != to.rows() || from_columns.size() != to_columns.size() ||
        !std::all_of(from_columns.begin(), from_columns.end(), has(from.columns())) ||
        !std::all_of(to_columns.begin(), to_columns.end(), has(to.columns())))
        refuse(
            fmt::format("{} columns of {} do not fit {} columns of {}: rows and numbers of "
                        "columns must agree, and every column must exist.",
                        from_columns.size(), shape_of(from), to_columns.size(), shape_of(to)));
    const KernelVariant variant = {.from_is_double = source->owner()->is_double()};
    const auto is_all = [](std::span<const Index> columns, Index count) {
        for (std::size_t i = 0; i < columns.size(); ++i)
            if (columns[i] != static_cast<Index>(i)) return false;
        return static_cast<Index>(columns.size()) == count;
    };
    guarded("copy columns", [&] {
        if (is_all(from_columns, from.columns()) && is_all(to_columns, to.columns())) {
            session_.run({"vector_ops", "copy_all", variant}, target.size(), single_column,
                         source->buffer(), target.buffer(), cl_ulong(target.size()));
            return;
        }
        const cl::Buffer from_list =
            session_.upload(std::vector<Index>(from_columns.begin(), from_columns.end()));
        const cl::Buffer to_list =
            session_.upload(std::vector<Index>(to_columns.begin(), to_columns.end()));
        session_.run({"vector_ops", "copy_columns", variant}, to.rows(), single_column,
                     source->buffer(), from_list, cl_int(from.columns()), target.buffer(), to_list,
                     cl_int(to.columns()), cl_int(to.rows()), cl_int(from_columns.size()));
    });
}

OpenclSums& OpenclBackend::mine(DeviceSums& sums, Index columns) const {
    auto* found = dynamic_cast<OpenclSums*>(&sums);
    if (!found || found->owner() != &session_)
        refuse("The sums belong to another back end: make them with the one that uses them.");
    if (sums.columns() != columns)
        refuse(fmt::format("Sums of {} columns do not fit {}.", sums.columns(), columns));
    return *found;
}

const OpenclSums& OpenclBackend::mine(const DeviceSums& sums, Index columns) const {
    return mine(const_cast<DeviceSums&>(sums), columns);
}

const OpenclOperator& OpenclBackend::mine(const DeviceOperator& a) const {
    const auto* found = dynamic_cast<const OpenclOperator*>(&a);
    if (!found || found->owner() != &session_)
        refuse("The operator belongs to another back end: make it with the one that uses it.");
    return *found;
}

std::unique_ptr<DeviceSums> OpenclBackend::make_sums(Index columns) {
    if (columns < 1) refuse(fmt::format("Sums of {} columns: at least 1 is needed.", columns));
    return guarded("make sums", [&] {
        return std::make_unique<OpenclSums>(
            columns, session_.make_buffer(session_.most_parts() * columns * session_.wide_bytes()),
            &session_);
    });
}

void OpenclBackend::set(DeviceSums& sums, std::span<const double> values) {
    OpenclSums& to = mine(sums, static_cast<Index>(values.size()));
    guarded("write sums", [&] { session_.write_wide(values, to.buffer()); });
    to.num_parts = 1;
}

void OpenclBackend::read(const DeviceSums& sums, std::span<double> values) {
    const OpenclSums& from = mine(sums, static_cast<Index>(values.size()));
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

void OpenclBackend::dot(const DeviceVector& x, const DeviceVector& y, DeviceSums& xy) {
    OpenclSums& sums = mine(xy, x.columns());
    refuse_other_shapes("The inner product", {&x, &y});
    guarded("take inner products", [&] {
        sums.num_parts =
            run_on_columns("dot_columns", x, buffer_of(x), buffer_of(y), sums.buffer());
    });
}

void OpenclBackend::advance(const DeviceSums& rz, const DeviceSums& pq, const DeviceSums& rr,
                            const DeviceSums& limit, const DeviceVector& p, const DeviceVector& q,
                            DeviceVector& x, DeviceVector& r, DeviceSums& rr_new) {
    const Index columns = p.columns();
    const OpenclSums& a = mine(rz, columns);
    const OpenclSums& b = mine(pq, columns);
    const OpenclSums& c = mine(rr, columns);
    const OpenclSums& d = mine(limit, columns);
    OpenclSums& e = mine(rr_new, columns);
    refuse_other_shapes("A step along the search directions", {&p, &q, &x, &r});
    if (&rr == &rr_new) refuse("The new sums cannot overwrite the old ones: give two objects.");
    guarded("step along the search directions", [&] {
        e.num_parts = run_on_columns("advance", p, a.buffer(), cl_int(a.num_parts), b.buffer(),
                                     cl_int(b.num_parts), c.buffer(), cl_int(c.num_parts),
                                     d.buffer(), cl_int(d.num_parts), buffer_of(p), buffer_of(q),
                                     buffer_of(x), buffer_of(r), e.buffer());
    });
}

void OpenclBackend::turn(const DeviceSums& rz_new, const DeviceSums& rz, const DeviceVector& z,
                         DeviceVector& p) {
    const OpenclSums& now = mine(rz_new, p.columns());
    const OpenclSums& before = mine(rz, p.columns());
    refuse_other_shapes("Turning the search directions", {&z, &p});
    guarded("turn the search directions", [&] {
        run_on_columns("turn", p, now.buffer(), cl_int(now.num_parts), before.buffer(),
                       cl_int(before.num_parts), buffer_of(z), buffer_of(p));
    });
}

std::unique_ptr<DeviceOperator> OpenclBackend::make_operator(
    const BlockMatrix& matrix, std::span<const double> inverse_diagonal) {
    const auto is_size = [](int size) { return size >= 1 && size <= 6; };
    if (!is_size(matrix.block_rows) || !is_size(matrix.block_columns))
        refuse(fmt::format("Blocks of {}x{} are not supported: 1 to 6 rows and columns are.",
                           matrix.block_rows, matrix.block_columns));
    auto a = guarded("make an operator", [&] {
        auto made =
            std::make_unique<OpenclOperator>(matrix.num_rows() * matrix.block_rows,
                                             matrix.num_columns * matrix.block_columns, &session_);
        made->blocks.emplace(session_, matrix.graph, matrix.block_rows, matrix.block_columns,
                             !inverse_diagonal.empty());
        return made;
    });
    set_values(*a, matrix, inverse_diagonal);
    return a;
}

void OpenclBackend::set_values(DeviceOperator& a, const BlockMatrix& matrix,
                               std::span<const double> inverse_diagonal) {
    auto& mine_a = const_cast<OpenclOperator&>(mine(a));
    const std::size_t diagonal = inverse_diagonal.size();
    if (!mine_a.blocks || a.rows() != matrix.num_rows() * matrix.block_rows ||
        mine_a.blocks->num_blocks() != matrix.graph.items.size() ||
        mine_a.blocks->block_columns() != matrix.block_columns ||
        matrix.blocks.size() != matrix.graph.items.size() * matrix.block_size() ||
        diagonal != (mine_a.blocks->is_square()
                         ? static_cast<std::size_t>(a.rows()) * matrix.block_rows
                         : 0))
        refuse(
            "New values need the pattern that the operator was made with, and one inverted "
            "diagonal block per block row if it has them.");
    guarded("write an operator",
            [&] { mine_a.blocks->set_values(session_, matrix, inverse_diagonal); });
}

const DeviceOperator& OpenclBackend::stiffness() {
    if (!stiffness_) refuse("The OpenCL back end holds no model: call prepare(model) first.");
    return *stiffness_;
}

void OpenclBackend::run(const char* what, const DeviceOperator& a, const DeviceVector* b,
                        const DeviceVector& x, DeviceVector& y, RowJob job, DeviceSums* sum) {
    const OpenclOperator& op = mine(a);
    if (a.columns() != x.rows() || a.rows() != y.rows() || x.columns() != y.columns() ||
        (b && (b->rows() != y.rows() || b->columns() != y.columns())))
        refuse(fmt::format("{}: an operator of {}x{} does not fit vectors of {} and {}.", what,
                           a.rows(), a.columns(), shape_of(x), shape_of(y)));
    refuse_same(x, y);
    if (b == &y) refuse("The right-hand side cannot be overwritten: give two vectors.");
    OpenclSums* sums = sum ? &mine(*sum, x.columns()) : nullptr;
    if (sums && job.result == RowResult::apply && a.rows() != a.columns())
        refuse("The sum x . A x needs a square operator.");
    job.x = &buffer_of(x);
    job.y = &buffer_of(y);
    job.b = b ? &buffer_of(*b) : nullptr;
    job.sum = sums ? &sums->buffer() : nullptr;
    job.num_columns = x.columns();
    guarded(what, [&] {
        const std::size_t parts = op.blocks ? op.blocks->run(session_, job) : model_->run(job);
        if (sums) sums->num_parts = parts;
    });
}

void OpenclBackend::apply(const DeviceOperator& a, const DeviceVector& x, DeviceVector& y,
                          DeviceSums* xy) {
    run("multiply with an operator", a, nullptr, x, y, {.result = RowResult::apply}, xy);
}

void OpenclBackend::apply_add(const DeviceOperator& a, const DeviceVector& x, DeviceVector& y) {
    run("add a product", a, nullptr, x, y, {.result = RowResult::add}, nullptr);
}

void OpenclBackend::residual(const DeviceOperator& a, const DeviceVector& b, const DeviceVector& x,
                             DeviceVector& r) {
    run("compute a residual", a, &b, x, r, {.result = RowResult::residual}, nullptr);
}

void OpenclBackend::smooth(const DeviceOperator& a, const DeviceVector& b, const DeviceVector& x,
                           double alpha, double beta, double weight, DeviceVector& y,
                           DeviceSums* by) {
    refuse_without_diagonal(mine(a));
    run("smooth", a, &b, x, y,
        {.result = RowResult::smooth, .alpha = alpha, .beta = beta, .weight = weight}, by);
}

void OpenclBackend::apply_inverse_diagonal(const DeviceOperator& a, double weight,
                                           const DeviceVector& r, DeviceVector& z, DeviceSums* rz) {
    const OpenclOperator& op = mine(a);
    refuse_without_diagonal(op);
    refuse_other_shapes("Scaling with the diagonal", {&r, &z});
    if (r.rows() != a.rows())
        refuse(fmt::format("A vector of {} does not fit an operator of {} rows.", shape_of(r),
                           a.rows()));
    OpenclSums* sums = rz ? &mine(*rz, r.columns()) : nullptr;
    const cl::Buffer* sum = sums ? &sums->buffer() : nullptr;
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

void OpenclBackend::internal_force(const DeviceVector& x, DeviceVector& y) {
    DeviceModel& model = model_for(x, y);
    refuse_same(x, y);
    guarded("compute internal forces",
            [&] { model.internal_force(buffer_of(x), buffer_of(y), x.columns()); });
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

std::unique_ptr<SolidDevice> OpenclBackend::make_solid(const SolidModel& model) {
    return make_opencl_solid(session_, model);
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
