// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/reference/reference_backend.hpp"

#include <Eigen/LU>
#include <Eigen/SparseCore>

#include "solver/backends/reference/host_vector.hpp"
#include "solver/backends/reference/reference_solid.hpp"
#include "solver/elements/tet4.hpp"

namespace palpate {
namespace {

using namespace reference;

using Values = HostValues;
using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;

class HostSums final : public DeviceSums {
public:
    explicit HostSums(Index columns)
        : DeviceSums(columns), values(columns, std::numeric_limits<double>::quiet_NaN()) {}
    std::vector<double> values;
};

/// A block matrix as plain compressed rows, or the stiffness of the back end's model.
class HostOperator final : public DeviceOperator {
public:
    using DeviceOperator::DeviceOperator;
    Sparse matrix;
    std::vector<double> inverse_diagonal;  ///< [rows / block, block, block] or empty
};

std::vector<double>& numbers_of(DeviceSums& sums) { return own<HostSums>(sums).values; }
const std::vector<double>& numbers_of(const DeviceSums& sums) {
    return own<const HostSums>(sums).values;
}

std::string eigen_version() {
    return "Eigen " + std::to_string(EIGEN_WORLD_VERSION) + "." +
           std::to_string(EIGEN_MAJOR_VERSION) + "." + std::to_string(EIGEN_MINOR_VERSION);
}

class ReferenceBackend final : public Backend {
public:
    explicit ReferenceBackend(const BackendOptions& options) : product_(options.product) {}

    BackendInfo describe() const override {
        return {.backend = "reference",
                .platform = "",
                .device = "host",
                .version = eigen_version(),
                .precision = Precision::double_,
                .product = product_,
                .choices = {},
                .compute_units = 1,
                .type = "host"};
    }

    void fill(DeviceVector& v, double value) override { values_of(v).setConstant(value); }

    void wait() override {}

private:
    void do_prepare(const Model& model) override {
        model_ = model;
        compute_element_stiffness();
        stiffness_operator_ = std::make_unique<HostOperator>(model_.num_dofs());
        update_matrices();
    }

    void do_set_stiffness(std::span<const double> stiffness_kpa) override {
        for (std::size_t r = 0; r < stiffness_kpa.size(); ++r)
            model_.materials[r].stiffness_kpa = stiffness_kpa[r];
        update_matrices();
    }

    std::unique_ptr<DeviceVector> do_make_vector(Index rows, Index columns) override {
        return std::make_unique<HostVector>(rows, columns);
    }

    void do_copy_in(std::span<const double> host, DeviceVector& v) override {
        std::copy(host.begin(), host.end(), values_of(v).data());
    }

    void do_copy_out(const DeviceVector& v, std::span<double> host) override {
        std::copy_n(values_of(v).data(), host.size(), host.begin());
    }

    void do_copy_columns(const DeviceVector& from, std::span<const Index> from_columns,
                         DeviceVector& to, std::span<const Index> to_columns) override {
        for (std::size_t i = 0; i < from_columns.size(); ++i)
            values_of(to).col(to_columns[i]) = values_of(from).col(from_columns[i]);
    }

    std::unique_ptr<DeviceSums> do_make_sums(Index columns) override {
        return std::make_unique<HostSums>(columns);
    }

    void do_set(DeviceSums& sums, std::span<const double> values) override {
        numbers_of(sums).assign(values.begin(), values.end());
    }

    void do_read(const DeviceSums& sums, std::span<double> values) override {
        std::copy(numbers_of(sums).begin(), numbers_of(sums).end(), values.begin());
    }

    void do_dot(const DeviceVector& x, const DeviceVector& y, DeviceSums& xy) override {
        sum_products(values_of(x), values_of(y), xy);
    }

    std::unique_ptr<DeviceOperator> do_make_operator(const BlockMatrix& matrix,
                                                     bool has_inverse_diagonal) override {
        return std::make_unique<HostOperator>(matrix, has_inverse_diagonal);
    }

    void do_set_values(DeviceOperator& a, const BlockMatrix& matrix,
                       std::span<const double> inverse_diagonal) override {
        auto& host = own<HostOperator>(a);
        host.matrix = to_sparse(matrix);
        host.inverse_diagonal.assign(inverse_diagonal.begin(), inverse_diagonal.end());
    }

    const DeviceOperator& do_stiffness() override { return *stiffness_operator_; }

    void do_multiply(const OperatorProduct& job) override {
        const auto& a = own<const HostOperator>(job.a);
        const Values& x = values_of(job.x);
        Values& y = values_of(job.y);
        Values product(y.rows(), y.cols());
        multiply(a, x, product);
        switch (job.result) {
            case RowResult::apply:
                y.swap(product);
                break;
            case RowResult::add:
                y += product;
                break;
            case RowResult::residual:
                y = values_of(*job.b) - product;
                break;
            case RowResult::smooth:
                product = job.alpha * x + job.weight * scaled(a, values_of(*job.b) - product);
                if (job.beta != 0) product += job.beta * y;
                y.swap(product);
                break;
        }
        if (job.sum) do_dot(job.result == RowResult::smooth ? *job.b : job.x, job.y, *job.sum);
    }

    void do_apply_inverse_diagonal(const DeviceOperator& a, double weight, const DeviceVector& r,
                                   DeviceVector& z, DeviceSums* rz) override {
        Values result = weight * scaled(own<const HostOperator>(a), values_of(r));
        if (rz) sum_products(values_of(r), result, *rz);
        values_of(z).swap(result);
    }

    void do_advance(const DeviceSums& rz, const DeviceSums& pq, const DeviceSums& rr,
                    const DeviceSums& limit, const DeviceVector& p, const DeviceVector& q,
                    DeviceVector& x, DeviceVector& r, DeviceSums& rr_new) override {
        const auto &of_rz = numbers_of(rz), &of_pq = numbers_of(pq), &of_rr = numbers_of(rr),
                   &limits = numbers_of(limit);
        const Values &direction = values_of(p), &product = values_of(q);
        Values &solution = values_of(x), &rest = values_of(r);
        own<HostSums>(rr_new);
        for (Index c = 0; c < p.columns(); ++c) {
            const bool moves = of_rr[c] > limits[c] && of_pq[c] > 0;
            const double step = moves ? of_rz[c] / of_pq[c] : 0.0;
            solution.col(c) += step * direction.col(c);
            rest.col(c) -= step * product.col(c);
        }
        sum_products(rest, rest, rr_new);
    }

    void do_turn(const DeviceSums& rz_new, const DeviceSums& rz, const DeviceVector& z,
                 DeviceVector& p) override {
        const auto &now = numbers_of(rz_new), &before = numbers_of(rz);
        const Values& scaled_rest = values_of(z);
        Values& direction = values_of(p);
        for (Index c = 0; c < p.columns(); ++c) {
            if (before[c] > 0)
                direction.col(c) = scaled_rest.col(c) + now[c] / before[c] * direction.col(c);
            else
                direction.col(c) = scaled_rest.col(c);
        }
    }

    void do_internal_force(const DeviceVector& x, DeviceVector& y) override {
        if (is_assembled())
            values_of(y) = stiffness_ * values_of(x);
        else
            element_loop(values_of(x), values_of(y));
    }

    void do_strain_energy(const DeviceVector& x, std::span<double> energy) override {
        Values force(x.rows(), x.columns());
        element_loop(values_of(x), force);
        for (Index c = 0; c < x.columns(); ++c)
            energy[c] = 0.5 * values_of(x).col(c).dot(force.col(c));
    }

    void do_parameter_gradient(const DeviceVector& lambda, const DeviceVector& x,
                               std::span<double> gradient) override {
        std::fill(gradient.begin(), gradient.end(), 0.0);
        for (Index t = 0; t < model_.mesh.num_tets(); ++t) {
            const auto corners_lambda = at_corners(values_of(lambda), t);
            const auto corners_x = at_corners(values_of(x), t);
            gradient[model_.mesh.region[t]] +=
                (corners_lambda.array() * (unit_stiffness_[t] * corners_x).array()).sum();
        }
    }

    std::unique_ptr<SolidDevice> do_make_solid(SolidTables tables) override {
        return make_reference_solid(std::move(tables));
    }

    bool is_assembled() const {
        return product_ == Product::assembled || product_ == Product::automatic;
    }

    static void sum_products(const Values& x, const Values& y, DeviceSums& xy) {
        for (Index c = 0; c < x.cols(); ++c)
            numbers_of(xy)[c] = x.rows() == 0 ? 0 : x.col(c).dot(y.col(c));
    }

    static Sparse to_sparse(const BlockMatrix& matrix) {
        std::vector<Eigen::Triplet<double>> entries;
        entries.reserve(matrix.blocks.size());
        for (Index n = 0; n < matrix.num_rows(); ++n)
            for (Index k = matrix.graph.offsets[n]; k < matrix.graph.offsets[n + 1]; ++k)
                for (int i = 0; i < matrix.block_rows; ++i)
                    for (int j = 0; j < matrix.block_columns; ++j)
                        entries.emplace_back(n * matrix.block_rows + i,
                                             matrix.graph.items[k] * matrix.block_columns + j,
                                             matrix.block(k)[matrix.block_columns * i + j]);
        Sparse sparse(matrix.num_rows() * matrix.block_rows,
                      matrix.num_columns * matrix.block_columns);
        sparse.setFromTriplets(entries.begin(), entries.end());
        return sparse;
    }

    void multiply(const HostOperator& a, const Values& x, Values& y) const {
        if (!a.is_stiffness()) {
            y = a.matrix * x;
            return;
        }
        if (is_assembled()) {
            y = constrained_ * x;
            return;
        }
        Values free_part = x;
        for (Index d = 0; d < model_.num_dofs(); ++d)
            if (model_.prescribed[d]) free_part.row(d).setZero();
        element_loop(free_part, y);
        for (Index d = 0; d < model_.num_dofs(); ++d)
            if (model_.prescribed[d]) y.row(d) = x.row(d);
    }

    /// D^-1 r
    Values scaled(const HostOperator& a, const Values& r) const {
        Values z(r.rows(), r.cols());
        if (a.is_stiffness()) {
            for (Index n = 0; n < model_.mesh.num_nodes(); ++n)
                z.middleRows<3>(3 * n) = inverse_diagonal_[n] * r.middleRows<3>(3 * n);
            return z;
        }
        const int block = a.block_rows();
        for (Index n = 0; n < r.rows() / block; ++n)
            z.middleRows(n * block, block) =
                Eigen::Map<const Values>(
                    &a.inverse_diagonal[static_cast<std::size_t>(n) * block * block], block,
                    block) *
                r.middleRows(n * block, block);
        return z;
    }

    using Corners = Eigen::Matrix<double, 12, Eigen::Dynamic>;

    void compute_element_stiffness() {
        const Mesh& mesh = model_.mesh;
        unit_stiffness_.resize(mesh.tets.size());
        for (Index t = 0; t < mesh.num_tets(); ++t) {
            const Tet& tet = mesh.tets[t];
            const LinearElastic& material = model_.materials[mesh.region[t]];
            const Tet4 geometry = tet4_geometry(mesh.nodes[tet[0]], mesh.nodes[tet[1]],
                                                mesh.nodes[tet[2]], mesh.nodes[tet[3]]);
            unit_stiffness_[t] =
                tet4_stiffness(geometry, material.unit_lambda(), material.unit_mu());
        }
    }

    double modulus(Index tet) const {
        return model_.materials[model_.mesh.region[tet]].stiffness_kpa;
    }

    Index dof(Index tet, Index row) const { return 3 * model_.mesh.tets[tet][row / 3] + row % 3; }

    Corners at_corners(const Values& x, Index tet) const {
        Corners corners(12, x.cols());
        for (Index row = 0; row < 12; ++row) corners.row(row) = x.row(dof(tet, row));
        return corners;
    }

    void element_loop(const Values& x, Values& y) const {
        y.setZero();
        for (Index t = 0; t < model_.mesh.num_tets(); ++t) {
            const Corners force = modulus(t) * (unit_stiffness_[t] * at_corners(x, t));
            for (Index row = 0; row < 12; ++row) y.row(dof(t, row)) += force.row(row);
        }
    }

    void update_matrices() {
        stiffness_ = assemble([](Index) { return false; });
        constrained_ = assemble([&](Index d) { return model_.prescribed[d] != 0; });
        inverse_diagonal_.assign(model_.mesh.num_nodes(), Mat3::Identity());
        for (Index n = 0; n < model_.mesh.num_nodes(); ++n) {
            Mat3 block;
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) block(i, j) = constrained_.coeff(3 * n + i, 3 * n + j);
            if (!block.isZero(0)) inverse_diagonal_[n] = block.inverse();
        }
    }

    /// K with the rows and columns of every dof that `is_fixed` replaced by those of the identity.
    template <typename IsFixed>
    Sparse assemble(IsFixed is_fixed) const {
        std::vector<Eigen::Triplet<double>> entries;
        entries.reserve(144 * model_.mesh.tets.size());
        for (Index t = 0; t < model_.mesh.num_tets(); ++t)
            for (Index i = 0; i < 12; ++i)
                for (Index j = 0; j < 12; ++j)
                    if (!is_fixed(dof(t, i)) && !is_fixed(dof(t, j)))
                        entries.emplace_back(dof(t, i), dof(t, j),
                                             modulus(t) * unit_stiffness_[t](i, j));
        for (Index d = 0; d < model_.num_dofs(); ++d)
            if (is_fixed(d)) entries.emplace_back(d, d, 1.0);
        Sparse matrix(model_.num_dofs(), model_.num_dofs());
        matrix.setFromTriplets(entries.begin(), entries.end());
        return matrix;
    }

    Product product_;
    Model model_;
    std::unique_ptr<HostOperator> stiffness_operator_;
    std::vector<Tet4Stiffness> unit_stiffness_;  ///< [num_tets], at E = 1 kPa
    Sparse stiffness_;                           ///< K
    Sparse constrained_;                         ///< K, identity at prescribed dofs
    std::vector<Mat3> inverse_diagonal_;         ///< [num_nodes], of `constrained_`
};

}  // namespace

std::unique_ptr<Backend> make_reference_backend(const BackendOptions& options) {
    return std::make_unique<ReferenceBackend>(options);
}

std::vector<DeviceInfo> reference_devices() {
    return {DeviceInfo{.backend = "reference",
                       .id = "host",
                       .platform = "host",
                       .name = "host processor, one thread",
                       .type = "host",
                       .version = eigen_version(),
                       .driver = "",
                       .compute_units = 1,
                       .memory_gib = 0,
                       .has_double = true}};
}

}  // namespace palpate
