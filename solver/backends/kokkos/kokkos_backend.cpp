// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/kokkos/kokkos_backend.hpp"

#include <chrono>
#include <cmath>
#include <optional>

#include "solver/backends/kokkos/checks.hpp"
#include "solver/backends/kokkos/kokkos_model.hpp"
#include "solver/backends/kokkos/kokkos_solid.hpp"
#include "solver/backends/kokkos/operator_body.hpp"

namespace palpate {
namespace {

using namespace kokkos;

const KokkosSums& own_sums(const DeviceSums& sums, Index columns, const char* function) {
    require(sums.columns() == columns, function, "sums and vectors differ in columns");
    return own<const KokkosSums>(sums, function);
}

KokkosSums& own_sums(DeviceSums& sums, Index columns, const char* function) {
    require(sums.columns() == columns, function, "sums and vectors differ in columns");
    return own<KokkosSums>(sums, function);
}

KokkosSums* own_sums(DeviceSums* sums, Index columns, const char* function) {
    return sums ? &own_sums(*sums, columns, function) : nullptr;
}

void require_sound(const BlockMatrix& matrix, std::span<const double> inverse_diagonal,
                   const char* function) {
    const auto in_range = [&](Index item) { return item >= 0 && item < matrix.num_columns; };
    const std::vector<Index>& offsets = matrix.graph.offsets;
    const std::vector<Index>& items = matrix.graph.items;
    require(matrix.block_rows >= 1 && matrix.block_rows <= max_block && matrix.block_columns >= 1 &&
                matrix.block_columns <= max_block,
            function, "blocks have 1 to 6 rows and columns");
    require(!offsets.empty() && offsets.front() == 0 &&
                offsets.back() == static_cast<Index>(items.size()) &&
                std::is_sorted(offsets.begin(), offsets.end()) &&
                std::all_of(items.begin(), items.end(), in_range) &&
                matrix.blocks.size() == items.size() * matrix.block_size(),
            function, "offsets, block columns and blocks of the matrix do not fit together");
    require(inverse_diagonal.empty() ||
                inverse_diagonal.size() == static_cast<std::size_t>(matrix.num_rows()) *
                                               matrix.block_rows * matrix.block_rows,
            function, "one inverted block per block row is needed");
}

template <typename Real>
class KokkosBackend final : public Backend {
    KokkosLease lease_;  // before all memory: it goes last

public:
    explicit KokkosBackend(const BackendOptions& options) : product_(options.product) {}

    BackendInfo describe() const override {
        const DeviceInfo device = kokkos_device();
        BackendInfo info{.backend = device.backend,
                         .platform = device.platform,
                         .device = device.id,
                         .version = device.version,
                         .precision = precision(),
                         .product = product_,
                         .choices = {},
                         .compute_units = device.compute_units};
        if (product_ == Product::automatic && model_)
            info.choices = kokkos_product_choices().choices(setting());
        return info;
    }

    void prepare(const Model& model) override {
        check_model(model);
        guarded("prepare", [&] {
            model_.reset();
            chosen_.clear();
            model_ = std::make_unique<KokkosModel<Real>>(model);
        });
    }

    void set_stiffness(std::span<const double> stiffness_kpa) override {
        require(model_ && static_cast<Index>(stiffness_kpa.size()) == model_->num_regions(),
                "set_stiffness", "one modulus per material is needed");
        for (double modulus : stiffness_kpa)
            require(modulus > 0, "set_stiffness", "every modulus must be above 0 kPa");
        guarded("set_stiffness", [&] { model_->set_stiffness(stiffness_kpa); });
    }

    std::unique_ptr<DeviceVector> make_vector(Index rows, Index columns) override {
        require(rows >= 0 && columns >= 1, "make_vector", "rows >= 0 and columns >= 1 are needed");
        return guarded("make_vector",
                       [&] { return std::make_unique<KokkosVector<Real>>(rows, columns); });
    }

    void copy_in(std::span<const double> host, DeviceVector& v) override {
        const Array<Real>& values = vector_of(v, "copy_in").values;
        require(host.size() == values.size(), "copy_in",
                "the host array has another size than the vector");
        guarded("copy_in", [&] { write_array(host, values); });
    }

    void copy_out(const DeviceVector& v, std::span<double> host) override {
        const Array<Real>& values = vector_of(v, "copy_out").values;
        require(host.size() == values.size(), "copy_out",
                "the host array has another size than the vector");
        guarded("copy_out", [&] { read_array(values, host); });
    }

    void copy_columns(const DeviceVector& from, std::span<const Index> from_columns,
                      DeviceVector& to, std::span<const Index> to_columns) override {
        require(from.rows() == to.rows() && from_columns.size() == to_columns.size(),
                "copy_columns", "rows and numbers of columns must agree");
        for (std::size_t i = 0; i < from_columns.size(); ++i)
            require(from_columns[i] >= 0 && from_columns[i] < from.columns() &&
                        to_columns[i] >= 0 && to_columns[i] < to.columns(),
                    "copy_columns", "a column does not exist");
        KokkosVector<Real>& target = vector_of(to, "copy_columns");
        guarded("copy_columns", [&] {
            if (const auto* single = dynamic_cast<const KokkosVector<float>*>(&from))
                copy_chosen(*single, from_columns, target, to_columns);
            else
                copy_chosen(own<const KokkosVector<double>>(from, "copy_columns"), from_columns,
                            target, to_columns);
        });
    }

    void fill(DeviceVector& v, double value) override {
        const Array<Real>& values = vector_of(v, "fill").values;
        guarded("fill", [&] { Kokkos::deep_copy(values, static_cast<Real>(value)); });
    }

    std::unique_ptr<DeviceSums> make_sums(Index columns) override {
        require(columns >= 1, "make_sums", "columns >= 1 are needed");
        return guarded("make_sums", [&] { return std::make_unique<KokkosSums>(columns); });
    }

    void set(DeviceSums& sums, std::span<const double> values) override {
        const auto& own_one = own_sums(sums, static_cast<Index>(values.size()), "set");
        guarded("set", [&] { write_array(values, own_one.values); });
    }

    void read(const DeviceSums& sums, std::span<double> values) override {
        const auto& own_one = own_sums(sums, static_cast<Index>(values.size()), "read");
        guarded("read", [&] { read_array(own_one.values, values); });
    }

    void dot(const DeviceVector& x, const DeviceVector& y, DeviceSums& xy) override {
        require_same_shape(x, y, "dot");
        KokkosSums& sums = own_sums(xy, x.columns(), "dot");
        const DotBody<Real> body{data(x, "dot"), data(y, "dot"), x.columns()};
        guarded("dot", [&] { sweep<Real>(body, x.rows(), x.columns(), buffers_, &sums); });
    }

    std::unique_ptr<DeviceOperator> make_operator(
        const BlockMatrix& matrix, std::span<const double> inverse_diagonal) override {
        require_sound(matrix, inverse_diagonal, "make_operator");
        return guarded("make_operator", [&] {
            auto a = std::make_unique<KokkosOperator<Real>>(
                matrix.num_rows() * matrix.block_rows, matrix.num_columns * matrix.block_columns,
                false, matrix.block_rows, matrix.block_columns);
            a->offsets = array_of(matrix.graph.offsets);
            a->items = array_of(matrix.graph.items);
            a->blocks = make_array<Real>(matrix.blocks.size());
            write_values(*a, matrix, inverse_diagonal);
            return a;
        });
    }

    void set_values(DeviceOperator& a, const BlockMatrix& matrix,
                    std::span<const double> inverse_diagonal) override {
        require_sound(matrix, inverse_diagonal, "set_values");
        auto& target = own<KokkosOperator<Real>>(a, "set_values");
        require(!target.is_stiffness && target.block_rows == matrix.block_rows &&
                    target.block_columns == matrix.block_columns &&
                    target.rows() == matrix.num_rows() * matrix.block_rows &&
                    target.columns() == matrix.num_columns * matrix.block_columns &&
                    target.items.size() == matrix.graph.items.size(),
                "set_values", "the matrix has another size or pattern than the operator");
        guarded("set_values", [&] { write_values(target, matrix, inverse_diagonal); });
    }

    const DeviceOperator& stiffness() override {
        require(model_ != nullptr, "stiffness", "call prepare(model) first");
        return model_->stiffness();
    }

    void apply(const DeviceOperator& a, const DeviceVector& x, DeviceVector& y,
               DeviceSums* xy) override {
        require_operator_vectors(a, x, y, "apply");
        require(!xy || a.rows() == a.columns(), "apply", "sums need a square operator");
        run(a, step_of(StepKind::product, a, x, y, "apply"), own_sums(xy, x.columns(), "apply"),
            "apply");
    }

    void apply_add(const DeviceOperator& a, const DeviceVector& x, DeviceVector& y) override {
        require_operator_vectors(a, x, y, "apply_add");
        run(a, step_of(StepKind::add, a, x, y, "apply_add"), nullptr, "apply_add");
    }

    void residual(const DeviceOperator& a, const DeviceVector& b, const DeviceVector& x,
                  DeviceVector& r) override {
        require_operator_vectors(a, x, r, "residual");
        require_same_shape(b, r, "residual");
        OperatorStep<Real> step = step_of(StepKind::residual, a, x, r, "residual");
        step.b = data(b, "residual");
        run(a, step, nullptr, "residual");
    }

    void smooth(const DeviceOperator& a, const DeviceVector& b, const DeviceVector& x, double alpha,
                double beta, double weight, DeviceVector& y, DeviceSums* by) override {
        require_operator_vectors(a, x, y, "smooth");
        require_same_shape(b, y, "smooth");
        require_inverse_diagonal(a, "smooth");
        OperatorStep<Real> step = step_of(StepKind::smooth, a, x, y, "smooth");
        step.b = data(b, "smooth");
        step.alpha = static_cast<Real>(alpha);
        step.beta = static_cast<Real>(beta);
        step.weight = static_cast<Real>(weight);
        run(a, step, own_sums(by, x.columns(), "smooth"), "smooth");
    }

    void apply_inverse_diagonal(const DeviceOperator& a, double weight, const DeviceVector& r,
                                DeviceVector& z, DeviceSums* rz) override {
        const char* const function = "apply_inverse_diagonal";
        require_same_shape(r, z, function);
        require(r.rows() == a.rows(), function, "the vectors have a wrong size");
        const KokkosOperator<Real>& op = require_inverse_diagonal(a, function);
        KokkosSums* const sums = own_sums(rz, r.columns(), function);
        const InverseDiagonalBody<Real> body{op.inverse_diagonal.data(), op.block_rows,
                                             static_cast<Real>(weight),  data(r, function),
                                             data(z, function),          r.columns()};
        guarded(function,
                [&] { sweep<Real>(body, op.rows() / op.block_rows, r.columns(), buffers_, sums); });
    }

    void advance(const DeviceSums& rz, const DeviceSums& pq, const DeviceSums& rr,
                 const DeviceSums& limit, const DeviceVector& p, const DeviceVector& q,
                 DeviceVector& x, DeviceVector& r, DeviceSums& rr_new) override {
        const char* const function = "advance";
        require_same_shape(p, q, function);
        require_same_shape(p, x, function);
        require_same_shape(p, r, function);
        require(&rr != &rr_new, function, "old and new sums must be different objects");
        const Index columns = p.columns();
        const AdvanceBody<Real> body{own_sums(rz, columns, function).values.data(),
                                     own_sums(pq, columns, function).values.data(),
                                     own_sums(rr, columns, function).values.data(),
                                     own_sums(limit, columns, function).values.data(),
                                     data(p, function),
                                     data(q, function),
                                     data(x, function),
                                     data(r, function),
                                     columns};
        KokkosSums& sums = own_sums(rr_new, columns, function);
        guarded(function, [&] { sweep<Real>(body, p.rows(), columns, buffers_, &sums); });
    }

    void turn(const DeviceSums& rz_new, const DeviceSums& rz, const DeviceVector& z,
              DeviceVector& p) override {
        require_same_shape(z, p, "turn");
        const Index columns = p.columns();
        const TurnBody<Real> body{own_sums(rz_new, columns, "turn").values.data(),
                                  own_sums(rz, columns, "turn").values.data(), data(z, "turn"),
                                  data(p, "turn"), columns};
        guarded("turn", [&] { sweep<Real>(body, p.rows(), columns, buffers_); });
    }

    void internal_force(const DeviceVector& x, DeviceVector& y) override {
        const char* const function = "internal_force";
        require_model_vectors(x, y, function);
        const OperatorStep<Real> step =
            step_of(StepKind::product, model_->stiffness(), x, y, function);
        guarded(function, [&] {
            if (product_ == Product::matrix_free)
                sweep_elements(model_->free_mesh(), model_->stored(), step, nullptr);
            else
                sweep_elements(model_->free_mesh(), model_->template recomputed<Real>(), step,
                               nullptr);
        });
    }

    void strain_energy(const DeviceVector& x, std::span<double> energy) override {
        require(model_ && x.rows() == model_->num_dofs(), "strain_energy",
                "the vector has a wrong size");
        require(energy.size() == static_cast<std::size_t>(x.columns()), "strain_energy",
                "one result per column is needed");
        std::fill(energy.begin(), energy.end(), 0.0);
        guarded("strain_energy", [&] {
            for (Index region = 0; region < model_->num_regions(); ++region) {
                const std::vector<double> work = unit_work(region, x, x, "strain_energy");
                const double half_modulus = 0.5 * model_->material(region).stiffness_kpa;
                for (std::size_t c = 0; c < work.size(); ++c) energy[c] += half_modulus * work[c];
            }
        });
    }

    void parameter_gradient(const DeviceVector& lambda, const DeviceVector& x,
                            std::span<double> gradient) override {
        const char* const function = "parameter_gradient";
        require_same_shape(lambda, x, function);
        require(model_ && x.rows() == model_->num_dofs(), function,
                "the vectors need three rows per node of the prepared model");
        require(static_cast<Index>(gradient.size()) == model_->num_regions(), function,
                "one result per material is needed");
        guarded(function, [&] {
            for (Index region = 0; region < model_->num_regions(); ++region) {
                const std::vector<double> work = unit_work(region, lambda, x, function);
                gradient[region] = std::accumulate(work.begin(), work.end(), 0.0);
            }
        });
    }

    std::unique_ptr<SolidDevice> make_solid(const SolidModel& model) override {
        return guarded("make_solid", [&] { return make_kokkos_solid<Real>(model); });
    }

    void wait() override {
        guarded("wait", [] { Kokkos::fence(); });
    }

private:
    static constexpr Precision precision() {
        return std::is_same_v<Real, double> ? Precision::double_ : Precision::single;
    }

    static const KokkosVector<Real>& vector_of(const DeviceVector& v, const char* function) {
        return own<const KokkosVector<Real>>(v, function);
    }
    static KokkosVector<Real>& vector_of(DeviceVector& v, const char* function) {
        return own<KokkosVector<Real>>(v, function);
    }
    static const Real* data(const DeviceVector& v, const char* function) {
        return vector_of(v, function).values.data();
    }
    static Real* data(DeviceVector& v, const char* function) {
        return vector_of(v, function).values.data();
    }

    static void require_operator_vectors(const DeviceOperator& a, const DeviceVector& x,
                                         const DeviceVector& y, const char* function) {
        require(&x != &y, function, "input and output must be different vectors");
        require(a.columns() == x.rows() && a.rows() == y.rows() && x.columns() == y.columns(),
                function, "operator and vectors differ in size");
    }

    void require_model_vectors(const DeviceVector& x, const DeviceVector& y,
                               const char* function) const {
        require_same_shape(x, y, function);
        require(&x != &y, function, "input and output must be different vectors");
        require(model_ && x.rows() == model_->num_dofs(), function,
                "the vectors need three rows per node of the prepared model");
    }

    static const KokkosOperator<Real>& require_inverse_diagonal(const DeviceOperator& a,
                                                                const char* function) {
        const auto& op = own<const KokkosOperator<Real>>(a, function);
        require(op.inverse_diagonal.size() > 0 || op.rows() == 0, function,
                "the operator was made without its inverted diagonal");
        return op;
    }

    static void write_values(KokkosOperator<Real>& a, const BlockMatrix& matrix,
                             std::span<const double> inverse_diagonal) {
        write_array(std::span<const double>(matrix.blocks), a.blocks);
        if (a.inverse_diagonal.size() != inverse_diagonal.size())
            a.inverse_diagonal = make_array<Real>(inverse_diagonal.size());
        write_array(inverse_diagonal, a.inverse_diagonal);
    }

    template <typename From>
    static void copy_chosen(const KokkosVector<From>& from, std::span<const Index> from_columns,
                            const KokkosVector<Real>& to, std::span<const Index> to_columns) {
        if (from_columns.empty()) return;
        for_each_work(from.rows(), CopyColumns<From, Real>{
                                       from.values, array_of<Index>(from_columns), to.values,
                                       array_of<Index>(to_columns), from.columns(), to.columns()});
    }

    OperatorStep<Real> step_of(StepKind kind, const DeviceOperator& a, const DeviceVector& x,
                               DeviceVector& y, const char* function) const {
        const auto& op = own<const KokkosOperator<Real>>(a, function);
        require(!op.is_stiffness || (model_ && &op == &model_->stiffness()), function,
                "the stiffness belongs to another back end or an earlier model");
        return {.kind = kind,
                .x = data(x, function),
                .b = nullptr,
                .y = data(y, function),
                .inverse_diagonal = op.inverse_diagonal.data(),
                .alpha = 0,
                .beta = 0,
                .weight = 0,
                .columns = x.columns(),
                .is_square = a.rows() == a.columns()};
    }

    void run(const DeviceOperator& a, const OperatorStep<Real>& step, KokkosSums* sums,
             const char* function) {
        const auto& op = own<const KokkosOperator<Real>>(a, function);
        guarded(function, [&] {
            if (op.is_stiffness)
                sweep_stiffness(product_for(step.columns), step, sums);
            else
                sweep_blocks(op, step, sums);
        });
    }

    template <typename Rows>
    void sweep_rows(const Rows& rows, Index items, const OperatorStep<Real>& step,
                    KokkosSums* sums) {
        sweep<Real>(OperatorBody<Rows>{rows, step}, items, step.columns, buffers_, sums);
    }

    template <typename Geometry>
    void sweep_elements(const DeviceMesh& mesh, const Geometry& geometry,
                        const OperatorStep<Real>& step, KokkosSums* sums) {
        sweep_rows(ElementRows<Real, Geometry>{mesh, geometry}, model_->num_nodes(), step, sums);
    }

    template <int rows, int columns>
    void sweep_fixed_blocks(const KokkosOperator<Real>& a, const OperatorStep<Real>& step,
                            KokkosSums* sums) {
        sweep_rows(
            BlockRows<Real, rows, columns>{a.offsets.data(), a.items.data(), a.blocks.data()},
            a.rows() / rows, step, sums);
    }

    void sweep_blocks(const KokkosOperator<Real>& a, const OperatorStep<Real>& step,
                      KokkosSums* sums) {
        if (a.block_rows == 3 && a.block_columns == 3)
            sweep_fixed_blocks<3, 3>(a, step, sums);
        else if (a.block_rows == 6 && a.block_columns == 6)
            sweep_fixed_blocks<6, 6>(a, step, sums);
        else if (a.block_rows == 3 && a.block_columns == 6)
            sweep_fixed_blocks<3, 6>(a, step, sums);
        else if (a.block_rows == 6 && a.block_columns == 3)
            sweep_fixed_blocks<6, 3>(a, step, sums);
        else
            sweep_rows(AnyBlockRows<Real>{a.offsets.data(), a.items.data(), a.blocks.data(),
                                          a.block_rows, a.block_columns},
                       a.rows() / a.block_rows, step, sums);
    }

    void sweep_stiffness(Product product, const OperatorStep<Real>& step, KokkosSums* sums) {
        switch (product) {
            case Product::matrix_free:
                return sweep_elements(model_->constrained_mesh(), model_->stored(), step, sums);
            case Product::recomputed:
                return sweep_elements(model_->constrained_mesh(),
                                      model_->template recomputed<Real>(), step, sums);
            default:
                model_->assemble();
                return sweep_blocks(model_->stiffness(), step, sums);
        }
    }

    /// Everything that a choice of product depends on but the number of columns; meshes of up to
    /// twice the size share it.
    std::string setting() const {
        return "kokkos " + kokkos_device().id +
               (precision() == Precision::single ? " single" : " double") + " 2^" +
               std::to_string(std::ilogb(std::max<double>(model_->num_nodes(), 1)));
    }

    Product product_for(Index columns) {
        if (product_ != Product::automatic) return product_;
        const auto known = chosen_.find(column_class(columns));
        if (known != chosen_.end()) return known->second;
        const Product product = measure(columns).product;
        chosen_[column_class(columns)] = product;
        const auto is_chosen = [&](Product candidate) {
            return std::any_of(chosen_.begin(), chosen_.end(),
                               [&](const auto& entry) { return entry.second == candidate; });
        };
        if (!is_chosen(Product::assembled)) model_->drop_blocks();
        if (!is_chosen(Product::matrix_free)) model_->drop_gradients();
        return product;
    }

    ProductChoice measure(Index columns) {
        constexpr Product candidates[] = {Product::assembled, Product::matrix_free,
                                          Product::recomputed};
        std::optional<KokkosVector<Real>> x, y;
        return kokkos_product_choices().choose(
            setting(), columns, candidates, [&](Product product) {
                if (!x) {
                    Kokkos::deep_copy(x.emplace(model_->num_dofs(), columns).values, Real(1));
                    y.emplace(model_->num_dofs(), columns);
                }
                return seconds_of(product, *x, *y);
            });
    }

    double seconds_of(Product product, const KokkosVector<Real>& x, KokkosVector<Real>& y) {
        const OperatorStep<Real> step =
            step_of(StepKind::product, model_->stiffness(), x, y, "apply");
        if (product == Product::assembled) model_->assemble();
        if (product == Product::matrix_free) model_->stored();
        Kokkos::fence();
        const auto start = std::chrono::steady_clock::now();
        sweep_stiffness(product, step, nullptr);
        Kokkos::fence();
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

    /// lambda_c . K_r x_c of one region at E = 1 kPa, per column.
    std::vector<double> unit_work(Index region, const DeviceVector& lambda, const DeviceVector& x,
                                  const char* function) {
        const LinearElastic& material = model_->material(region);
        const ElementWorkBody<Real> body{model_->template recomputed<Real>(),
                                         model_->tets_of(region),
                                         static_cast<Real>(material.unit_lambda()),
                                         static_cast<Real>(material.unit_mu()),
                                         data(lambda, function),
                                         data(x, function),
                                         x.columns()};
        KokkosSums sums(x.columns());
        sweep<Real>(body, model_->num_tets_of(region), x.columns(), buffers_, &sums);
        std::vector<double> work(x.columns());
        read_array(sums.values, work);
        return work;
    }

    Product product_;
    SumBuffers buffers_;
    std::unique_ptr<KokkosModel<Real>> model_;
    std::map<Index, Product> chosen_;  ///< of an automatic product, by class of columns
};

}  // namespace

std::unique_ptr<Backend> make_kokkos_backend(const BackendOptions& options) {
    const KokkosLease lease;
    const DeviceInfo device = kokkos_device();
    if (device.name.find(options.device) == std::string::npos)
        throw Error(ErrorCode::device_unavailable, "Back end kokkos has no device \"" +
                                                       options.device + "\", only \"" + device.id +
                                                       "\".");
    if (options.precision == Precision::double_)
        return std::make_unique<KokkosBackend<double>>(options);
    return std::make_unique<KokkosBackend<float>>(options);
}

std::vector<DeviceInfo> kokkos_devices() {
    try {
        const KokkosLease lease;
        return {kokkos_device()};
    } catch (const Error&) {
        return {};
    }
}

}  // namespace palpate
