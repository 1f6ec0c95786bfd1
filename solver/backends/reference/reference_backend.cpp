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
    HostOperator(Index rows, Index columns, bool of_model)
        : DeviceOperator(rows, columns), is_stiffness(of_model) {}
    bool is_stiffness;
    Sparse matrix;
    int block = 0;                         ///< rows of a diagonal block, 0: none known
    std::vector<double> inverse_diagonal;  ///< [rows / block, block, block]
};

const HostOperator& operator_of(const DeviceOperator& a) {
    return dynamic_cast<const HostOperator&>(a);
}
std::vector<double>& numbers_of(DeviceSums& sums) { return dynamic_cast<HostSums&>(sums).values; }
const std::vector<double>& numbers_of(const DeviceSums& sums) {
    return dynamic_cast<const HostSums&>(sums).values;
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

    void prepare(const Model& model) override {
        check_model(model);
        model_ = model;
        compute_element_stiffness();
        stiffness_operator_ =
            std::make_unique<HostOperator>(model_.num_dofs(), model_.num_dofs(), true);
        update_matrices();
    }

    void set_stiffness(std::span<const double> stiffness_kpa) override {
        require(stiffness_kpa.size() == model_.materials.size(), "set_stiffness",
                "one modulus per material is needed");
        for (std::size_t r = 0; r < stiffness_kpa.size(); ++r) {
            require(stiffness_kpa[r] > 0, "set_stiffness", "every modulus must be above 0 kPa");
            model_.materials[r].stiffness_kpa = stiffness_kpa[r];
        }
        update_matrices();
    }

    std::unique_ptr<DeviceVector> make_vector(Index rows, Index columns) override {
        require(rows >= 0 && columns >= 1, "make_vector", "rows >= 0 and columns >= 1 are needed");
        return std::make_unique<HostVector>(rows, columns);
    }

    void copy_in(std::span<const double> host, DeviceVector& v) override {
        Values& values = values_of(v);
        require(host.size() == static_cast<std::size_t>(values.size()), "copy_in",
                "the host array has another size than the vector");
        std::copy(host.begin(), host.end(), values.data());
    }

    void copy_out(const DeviceVector& v, std::span<double> host) override {
        const Values& values = values_of(v);
        require(host.size() == static_cast<std::size_t>(values.size()), "copy_out",
                "the host array has another size than the vector");
        std::copy(values.data(), values.data() + values.size(), host.begin());
    }

    void fill(DeviceVector& v, double value) override { values_of(v).setConstant(value); }

    void copy_columns(const DeviceVector& from, std::span<const Index> from_columns,
                      DeviceVector& to, std::span<const Index> to_columns) override {
        require(from.rows() == to.rows() && from_columns.size() == to_columns.size(),
                "copy_columns", "rows and numbers of columns must agree");
        for (std::size_t i = 0; i < from_columns.size(); ++i) {
            require(from_columns[i] >= 0 && from_columns[i] < from.columns() &&
                        to_columns[i] >= 0 && to_columns[i] < to.columns(),
                    "copy_columns", "a column does not exist");
            values_of(to).col(to_columns[i]) = values_of(from).col(from_columns[i]);
        }
    }

    std::unique_ptr<DeviceSums> make_sums(Index columns) override {
        require(columns >= 1, "make_sums", "columns >= 1 are needed");
        return std::make_unique<HostSums>(columns);
    }

    void set(DeviceSums& sums, std::span<const double> values) override {
        require_columns(sums, values.size(), "set");
        numbers_of(sums).assign(values.begin(), values.end());
    }

    void read(const DeviceSums& sums, std::span<double> values) override {
        require_columns(sums, values.size(), "read");
        std::copy(numbers_of(sums).begin(), numbers_of(sums).end(), values.begin());
    }

    void dot(const DeviceVector& x, const DeviceVector& y, DeviceSums& xy) override {
        require_same_shape(x, y, "dot");
        require_columns(xy, x.columns(), "dot");
        for (Index c = 0; c < x.columns(); ++c)
            numbers_of(xy)[c] = x.rows() == 0 ? 0 : values_of(x).col(c).dot(values_of(y).col(c));
    }

    std::unique_ptr<DeviceOperator> make_operator(
        const BlockMatrix& matrix, std::span<const double> inverse_diagonal) override {
        auto a = std::make_unique<HostOperator>(matrix.num_rows() * matrix.block_rows,
                                                matrix.num_columns * matrix.block_columns, false);
        set_values(*a, matrix, inverse_diagonal);
        return a;
    }

    void set_values(DeviceOperator& a, const BlockMatrix& matrix,
                    std::span<const double> inverse_diagonal) override {
        auto& host = dynamic_cast<HostOperator&>(a);
        require(!host.is_stiffness && host.rows() == matrix.num_rows() * matrix.block_rows &&
                    host.columns() == matrix.num_columns * matrix.block_columns,
                "set_values", "the matrix has another size than the operator");
        require(inverse_diagonal.empty() ||
                    inverse_diagonal.size() ==
                        static_cast<std::size_t>(host.rows()) * matrix.block_rows,
                "set_values", "one inverted block per block row is needed");
        host.matrix = to_sparse(matrix);
        host.block = inverse_diagonal.empty() ? 0 : matrix.block_rows;
        host.inverse_diagonal.assign(inverse_diagonal.begin(), inverse_diagonal.end());
    }

    const DeviceOperator& stiffness() override {
        require(stiffness_operator_ != nullptr, "stiffness", "call prepare(model) first");
        return *stiffness_operator_;
    }

    void apply(const DeviceOperator& a, const DeviceVector& x, DeviceVector& y,
               DeviceSums* xy) override {
        require_operator_vectors(a, x, y, "apply");
        multiply(operator_of(a), values_of(x), values_of(y));
        if (xy) dot(x, y, *xy);
    }

    void apply_add(const DeviceOperator& a, const DeviceVector& x, DeviceVector& y) override {
        require_operator_vectors(a, x, y, "apply_add");
        Values product(y.rows(), y.columns());
        multiply(operator_of(a), values_of(x), product);
        values_of(y) += product;
    }

    void residual(const DeviceOperator& a, const DeviceVector& b, const DeviceVector& x,
                  DeviceVector& r) override {
        require_operator_vectors(a, x, r, "residual");
        require_same_shape(b, r, "residual");
        Values product(r.rows(), r.columns());
        multiply(operator_of(a), values_of(x), product);
        values_of(r) = values_of(b) - product;
    }

    void apply_inverse_diagonal(const DeviceOperator& a, double weight, const DeviceVector& r,
                                DeviceVector& z, DeviceSums* rz) override {
        require_same_shape(r, z, "apply_inverse_diagonal");
        require(r.rows() == a.rows(), "apply_inverse_diagonal", "the vectors have a wrong size");
        values_of(z) = weight * scaled(operator_of(a), values_of(r));
        if (rz) dot(r, z, *rz);
    }

    void smooth(const DeviceOperator& a, const DeviceVector& b, const DeviceVector& x, double alpha,
                double beta, double weight, DeviceVector& y, DeviceSums* by) override {
        require_operator_vectors(a, x, y, "smooth");
        require_same_shape(b, y, "smooth");
        Values product(y.rows(), y.columns());
        multiply(operator_of(a), values_of(x), product);
        Values result =
            alpha * values_of(x) + weight * scaled(operator_of(a), values_of(b) - product);
        if (beta != 0) result += beta * values_of(y);
        values_of(y) = result;
        if (by) dot(b, y, *by);
    }

    void advance(const DeviceSums& rz, const DeviceSums& pq, const DeviceSums& rr,
                 const DeviceSums& limit, const DeviceVector& p, const DeviceVector& q,
                 DeviceVector& x, DeviceVector& r, DeviceSums& rr_new) override {
        require_same_shape(p, q, "advance");
        require_same_shape(p, x, "advance");
        require_same_shape(p, r, "advance");
        for (const DeviceSums* sums :
             {&rz, &pq, &rr, &limit, const_cast<const DeviceSums*>(&rr_new)})
            require_columns(*sums, p.columns(), "advance");
        require(&rr != &rr_new, "advance", "old and new sums must be different objects");
        for (Index c = 0; c < p.columns(); ++c) {
            const bool moves = numbers_of(rr)[c] > numbers_of(limit)[c] && numbers_of(pq)[c] > 0;
            const double step = moves ? numbers_of(rz)[c] / numbers_of(pq)[c] : 0.0;
            values_of(x).col(c) += step * values_of(p).col(c);
            values_of(r).col(c) -= step * values_of(q).col(c);
        }
        dot(r, r, rr_new);
    }

    void turn(const DeviceSums& rz_new, const DeviceSums& rz, const DeviceVector& z,
              DeviceVector& p) override {
        require_same_shape(z, p, "turn");
        require_columns(rz_new, p.columns(), "turn");
        require_columns(rz, p.columns(), "turn");
        for (Index c = 0; c < p.columns(); ++c) {
            if (numbers_of(rz)[c] > 0)
                values_of(p).col(c) = values_of(z).col(c) + numbers_of(rz_new)[c] /
                                                                numbers_of(rz)[c] *
                                                                values_of(p).col(c);
            else
                values_of(p).col(c) = values_of(z).col(c);
        }
    }

    void internal_force(const DeviceVector& x, DeviceVector& y) override {
        require_model_vectors(x, y, "internal_force");
        if (is_assembled())
            values_of(y) = stiffness_ * values_of(x);
        else
            element_loop(values_of(x), values_of(y));
    }

    void strain_energy(const DeviceVector& x, std::span<double> energy) override {
        require(x.rows() == model_.num_dofs(), "strain_energy", "the vector has a wrong size");
        require(energy.size() == static_cast<std::size_t>(x.columns()), "strain_energy",
                "one result per column is needed");
        Values force(x.rows(), x.columns());
        element_loop(values_of(x), force);
        for (Index c = 0; c < x.columns(); ++c)
            energy[c] = 0.5 * values_of(x).col(c).dot(force.col(c));
    }

    void parameter_gradient(const DeviceVector& lambda, const DeviceVector& x,
                            std::span<double> gradient) override {
        require_model_vectors(lambda, x, "parameter_gradient");
        require(gradient.size() == model_.materials.size(), "parameter_gradient",
                "one result per material is needed");
        std::fill(gradient.begin(), gradient.end(), 0.0);
        for (Index t = 0; t < model_.mesh.num_tets(); ++t) {
            const auto corners_lambda = at_corners(values_of(lambda), t);
            const auto corners_x = at_corners(values_of(x), t);
            gradient[model_.mesh.region[t]] +=
                (corners_lambda.array() * (unit_stiffness_[t] * corners_x).array()).sum();
        }
    }

    std::unique_ptr<SolidDevice> make_solid(const SolidModel& model) override {
        return make_reference_solid(model);
    }

    void wait() override {}

private:
    bool is_assembled() const {
        return product_ == Product::assembled || product_ == Product::automatic;
    }

    static void require_columns(const DeviceSums& sums, std::size_t columns, const char* function) {
        require(static_cast<std::size_t>(sums.columns()) == columns, function,
                "sums and vectors differ in columns");
    }

    static void require_operator_vectors(const DeviceOperator& a, const DeviceVector& x,
                                         const DeviceVector& y, const char* function) {
        require(&x != &y, function, "input and output must be different vectors");
        require(a.columns() == x.rows() && a.rows() == y.rows() && x.columns() == y.columns(),
                function, "operator and vectors differ in size");
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
        if (!a.is_stiffness) {
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
        if (a.is_stiffness) {
            for (Index n = 0; n < model_.mesh.num_nodes(); ++n)
                z.middleRows<3>(3 * n) = inverse_diagonal_[n] * r.middleRows<3>(3 * n);
            return z;
        }
        require(a.block > 0, "smooth", "the operator was made without its inverted diagonal");
        for (Index n = 0; n < r.rows() / a.block; ++n)
            z.middleRows(n * a.block, a.block) =
                Eigen::Map<const Values>(
                    &a.inverse_diagonal[static_cast<std::size_t>(n) * a.block * a.block], a.block,
                    a.block) *
                r.middleRows(n * a.block, a.block);
        return z;
    }

    using Corners = Eigen::Matrix<double, 12, Eigen::Dynamic>;

    void require_model_vectors(const DeviceVector& x, const DeviceVector& y,
                               const char* function) const {
        require_same_shape(x, y, function);
        require(&x != &y, function, "input and output must be different vectors");
        require(x.rows() == model_.num_dofs(), function,
                "the vectors need three rows per node of the prepared model");
    }

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
