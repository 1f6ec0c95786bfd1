// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/kokkos/kokkos_backend.hpp"

#include <chrono>
#include <cmath>
#include <optional>

#include "solver/backends/kokkos/guarded.hpp"
#include "solver/backends/kokkos/kokkos_model.hpp"
#include "solver/backends/kokkos/kokkos_solid.hpp"
#include "solver/backends/kokkos/operator_body.hpp"

namespace palpate {
namespace {

using namespace kokkos;

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

    void fill(DeviceVector& v, double value) override {
        const Array<Real>& values = own<KokkosVector<Real>>(v).values;
        guarded("fill", [&] { Kokkos::deep_copy(values, static_cast<Real>(value)); });
    }

    void wait() override {
        guarded("wait", [] { Kokkos::fence(); });
    }

private:
    void do_prepare(const Model& model) override {
        guarded("prepare", [&] {
            model_.reset();
            chosen_.clear();
            model_ = std::make_unique<KokkosModel<Real>>(model);
        });
    }

    void do_set_stiffness(std::span<const double> stiffness_kpa) override {
        guarded("set_stiffness", [&] { model_->set_stiffness(stiffness_kpa); });
    }

    std::unique_ptr<DeviceVector> do_make_vector(Index rows, Index columns) override {
        return guarded("make_vector",
                       [&] { return std::make_unique<KokkosVector<Real>>(rows, columns); });
    }

    void do_copy_in(std::span<const double> host, DeviceVector& v) override {
        guarded("copy_in", [&] { write_array(host, own<KokkosVector<Real>>(v).values); });
    }

    void do_copy_out(const DeviceVector& v, std::span<double> host) override {
        guarded("copy_out", [&] { read_array(own<const KokkosVector<Real>>(v).values, host); });
    }

    void do_copy_columns(const DeviceVector& from, std::span<const Index> from_columns,
                         DeviceVector& to, std::span<const Index> to_columns) override {
        const auto& target = own<KokkosVector<Real>>(to);
        guarded("copy_columns", [&] {
            if (const auto* single = dynamic_cast<const KokkosVector<float>*>(&from))
                copy_chosen(*single, from_columns, target, to_columns);
            else
                copy_chosen(own<const KokkosVector<double>>(from), from_columns, target,
                            to_columns);
        });
    }

    std::unique_ptr<DeviceSums> do_make_sums(Index columns) override {
        return guarded("make_sums", [&] { return std::make_unique<KokkosSums>(columns); });
    }

    void do_set(DeviceSums& sums, std::span<const double> values) override {
        guarded("set", [&] { write_array(values, own<KokkosSums>(sums).values); });
    }

    void do_read(const DeviceSums& sums, std::span<double> values) override {
        guarded("read", [&] { read_array(own<const KokkosSums>(sums).values, values); });
    }

    void do_dot(const DeviceVector& x, const DeviceVector& y, DeviceSums& xy) override {
        const DotBody<Real> body{data(x), data(y), x.columns()};
        auto& sums = own<KokkosSums>(xy);
        guarded("dot", [&] { sweep<Real>(body, x.rows(), x.columns(), buffers_, &sums); });
    }

    std::unique_ptr<DeviceOperator> do_make_operator(const BlockMatrix& matrix,
                                                     bool has_inverse_diagonal) override {
        return guarded("make_operator", [&] {
            auto a = std::make_unique<KokkosOperator<Real>>(matrix, has_inverse_diagonal);
            a->offsets = array_of(matrix.graph.offsets);
            a->items = array_of(matrix.graph.items);
            a->blocks = make_array<Real>(matrix.blocks.size());
            if (has_inverse_diagonal)
                a->inverse_diagonal =
                    make_array<Real>(static_cast<std::size_t>(a->rows()) * a->block_rows());
            return a;
        });
    }

    void do_set_values(DeviceOperator& a, const BlockMatrix& matrix,
                       std::span<const double> inverse_diagonal) override {
        const auto& target = own<KokkosOperator<Real>>(a);
        guarded("set_values", [&] {
            write_array(std::span<const double>(matrix.blocks), target.blocks);
            write_array(inverse_diagonal, target.inverse_diagonal);
        });
    }

    const DeviceOperator& do_stiffness() override { return model_->stiffness(); }

    void do_multiply(const OperatorProduct& product) override {
        const auto& a = own<const KokkosOperator<Real>>(product.a);
        if (a.is_stiffness() && !(model_ && &a == &model_->stiffness())) refuse_foreign_argument();
        auto* const sums = product.sum ? &own<KokkosSums>(*product.sum) : nullptr;
        const OperatorStep<Real> step{.result = product.result,
                                      .x = data(product.x),
                                      .b = product.b ? data(*product.b) : nullptr,
                                      .y = data(product.y),
                                      .inverse_diagonal = a.inverse_diagonal.data(),
                                      .alpha = static_cast<Real>(product.alpha),
                                      .beta = static_cast<Real>(product.beta),
                                      .weight = static_cast<Real>(product.weight),
                                      .columns = product.x.columns(),
                                      .is_square = a.rows() == a.columns()};
        guarded("multiply", [&] {
            if (a.is_stiffness())
                sweep_stiffness(product_for(step.columns), step, sums);
            else
                sweep_blocks(a, step, sums);
        });
    }

    void do_apply_inverse_diagonal(const DeviceOperator& a, double weight, const DeviceVector& r,
                                   DeviceVector& z, DeviceSums* rz) override {
        const auto& op = own<const KokkosOperator<Real>>(a);
        auto* const sums = rz ? &own<KokkosSums>(*rz) : nullptr;
        const InverseDiagonalBody<Real> body{op.inverse_diagonal.data(),
                                             op.block_rows(),
                                             static_cast<Real>(weight),
                                             data(r),
                                             data(z),
                                             r.columns()};
        guarded("apply_inverse_diagonal", [&] {
            sweep<Real>(body, op.rows() / op.block_rows(), r.columns(), buffers_, sums);
        });
    }

    void do_advance(const DeviceSums& rz, const DeviceSums& pq, const DeviceSums& rr,
                    const DeviceSums& limit, const DeviceVector& p, const DeviceVector& q,
                    DeviceVector& x, DeviceVector& r, DeviceSums& rr_new) override {
        const AdvanceBody<Real> body{data(rz), data(pq), data(rr), data(limit), data(p),
                                     data(q),  data(x),  data(r),  p.columns()};
        auto& sums = own<KokkosSums>(rr_new);
        guarded("advance", [&] { sweep<Real>(body, p.rows(), p.columns(), buffers_, &sums); });
    }

    void do_turn(const DeviceSums& rz_new, const DeviceSums& rz, const DeviceVector& z,
                 DeviceVector& p) override {
        const TurnBody<Real> body{data(rz_new), data(rz), data(z), data(p), p.columns()};
        guarded("turn", [&] { sweep<Real>(body, p.rows(), p.columns(), buffers_); });
    }

    void do_internal_force(const DeviceVector& x, DeviceVector& y) override {
        const OperatorStep<Real> step = product_of(x, y);
        guarded("internal_force", [&] {
            if (product_ == Product::matrix_free)
                sweep_elements(model_->free_mesh(), model_->stored(), step, nullptr);
            else
                sweep_elements(model_->free_mesh(), model_->template recomputed<Real>(), step,
                               nullptr);
        });
    }

    void do_strain_energy(const DeviceVector& x, std::span<double> energy) override {
        std::fill(energy.begin(), energy.end(), 0.0);
        guarded("strain_energy", [&] {
            for (Index region = 0; region < model_->num_regions(); ++region) {
                const std::vector<double> work = unit_work(region, x, x);
                const double half_modulus = 0.5 * model_->material(region).stiffness_kpa;
                for (std::size_t c = 0; c < work.size(); ++c) energy[c] += half_modulus * work[c];
            }
        });
    }

    void do_parameter_gradient(const DeviceVector& lambda, const DeviceVector& x,
                               std::span<double> gradient) override {
        guarded("parameter_gradient", [&] {
            for (Index region = 0; region < model_->num_regions(); ++region) {
                const std::vector<double> work = unit_work(region, lambda, x);
                gradient[region] = std::accumulate(work.begin(), work.end(), 0.0);
            }
        });
    }

    std::unique_ptr<SolidDevice> do_make_solid(SolidTables tables) override {
        return guarded("make_solid", [&] { return make_kokkos_solid<Real>(std::move(tables)); });
    }

    static constexpr Precision precision() {
        return std::is_same_v<Real, double> ? Precision::double_ : Precision::single;
    }

    static const Real* data(const DeviceVector& v) {
        return own<const KokkosVector<Real>>(v).values.data();
    }
    static Real* data(DeviceVector& v) { return own<KokkosVector<Real>>(v).values.data(); }
    static const double* data(const DeviceSums& sums) {
        return own<const KokkosSums>(sums).values.data();
    }

    /// y = A x
    static OperatorStep<Real> product_of(const DeviceVector& x, DeviceVector& y) {
        return {.result = RowResult::apply,
                .x = data(x),
                .b = nullptr,
                .y = data(y),
                .inverse_diagonal = nullptr,
                .alpha = 0,
                .beta = 0,
                .weight = 0,
                .columns = x.columns(),
                .is_square = x.rows() == y.rows()};
    }

    template <typename From>
    static void copy_chosen(const KokkosVector<From>& from, std::span<const Index> from_columns,
                            const KokkosVector<Real>& to, std::span<const Index> to_columns) {
        if (from_columns.empty()) return;
        for_each_work(from.rows(), CopyColumns<From, Real>{
                                       from.values, array_of<Index>(from_columns), to.values,
                                       array_of<Index>(to_columns), from.columns(), to.columns()});
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
        if (a.block_rows() == 3 && a.block_columns() == 3)
            sweep_fixed_blocks<3, 3>(a, step, sums);
        else if (a.block_rows() == 6 && a.block_columns() == 6)
            sweep_fixed_blocks<6, 6>(a, step, sums);
        else if (a.block_rows() == 3 && a.block_columns() == 6)
            sweep_fixed_blocks<3, 6>(a, step, sums);
        else if (a.block_rows() == 6 && a.block_columns() == 3)
            sweep_fixed_blocks<6, 3>(a, step, sums);
        else
            sweep_rows(AnyBlockRows<Real>{a.offsets.data(), a.items.data(), a.blocks.data(),
                                          a.block_rows(), a.block_columns()},
                       a.rows() / a.block_rows(), step, sums);
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
        const OperatorStep<Real> step = product_of(x, y);
        if (product == Product::assembled) model_->assemble();
        if (product == Product::matrix_free) model_->stored();
        Kokkos::fence();
        const auto start = std::chrono::steady_clock::now();
        sweep_stiffness(product, step, nullptr);
        Kokkos::fence();
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

    /// lambda_c . K_r x_c of one region at E = 1 kPa, per column.
    std::vector<double> unit_work(Index region, const DeviceVector& lambda, const DeviceVector& x) {
        const LinearElastic& material = model_->material(region);
        const ElementWorkBody<Real> body{model_->template recomputed<Real>(),
                                         model_->tets_of(region),
                                         static_cast<Real>(material.unit_lambda()),
                                         static_cast<Real>(material.unit_mu()),
                                         data(lambda),
                                         data(x),
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
