// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/reference/reference_backend.hpp"

#include <Eigen/LU>
#include <Eigen/SparseCore>

#include "solver/base/error.hpp"
#include "solver/elements/tet4.hpp"

namespace palpate {
namespace {

using Values = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;

class HostVector final : public DeviceVector {
public:
    HostVector(Index rows, Index columns) : DeviceVector(rows, columns), values(rows, columns) {
        values.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    Values values;
};

const Values& values_of(const DeviceVector& v) { return dynamic_cast<const HostVector&>(v).values; }
Values& values_of(DeviceVector& v) { return dynamic_cast<HostVector&>(v).values; }

std::string eigen_version() {
    return "Eigen " + std::to_string(EIGEN_WORLD_VERSION) + "." +
           std::to_string(EIGEN_MAJOR_VERSION) + "." + std::to_string(EIGEN_MINOR_VERSION);
}

void require(bool holds, const char* function, const char* what) {
    if (!holds)
        throw Error(ErrorCode::invalid_argument,
                    std::string("Back end reference, ") + function + ": " + what + ".");
}

void require_same_shape(const DeviceVector& x, const DeviceVector& y, const char* function) {
    require(x.rows() == y.rows() && x.columns() == y.columns(), function,
            "the vectors differ in rows or columns");
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
                .compute_units = 1,
                .type = "host"};
    }

    void prepare(const Model& model) override {
        check_model(model);
        model_ = model;
        compute_element_stiffness();
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

    void axpby(std::span<const double> alpha, const DeviceVector& x, std::span<const double> beta,
               DeviceVector& y) override {
        require_same_shape(x, y, "axpby");
        require(
            alpha.size() == static_cast<std::size_t>(x.columns()) && beta.size() == alpha.size(),
            "axpby", "one alpha and one beta per column are needed");
        for (Index c = 0; c < x.columns(); ++c) {
            auto out = values_of(y).col(c);
            if (beta[c] == 0)
                out = alpha[c] * values_of(x).col(c);
            else
                out = alpha[c] * values_of(x).col(c) + beta[c] * out;
        }
    }

    void dot(const DeviceVector& x, const DeviceVector& y, std::span<double> result) override {
        require_same_shape(x, y, "dot");
        require(result.size() == static_cast<std::size_t>(x.columns()), "dot",
                "one result per column is needed");
        for (Index c = 0; c < x.columns(); ++c)
            result[c] = values_of(x).col(c).dot(values_of(y).col(c));
    }

    void internal_force(const DeviceVector& x, DeviceVector& y) override {
        require_model_vectors(x, y, "internal_force");
        if (product_ == Product::assembled)
            values_of(y) = stiffness_ * values_of(x);
        else
            element_loop(values_of(x), values_of(y));
    }

    void apply_stiffness(const DeviceVector& x, DeviceVector& y) override {
        require_model_vectors(x, y, "apply_stiffness");
        if (product_ == Product::assembled) {
            values_of(y) = constrained_ * values_of(x);
            return;
        }
        Values free_part = values_of(x);
        for (Index d = 0; d < model_.num_dofs(); ++d)
            if (model_.prescribed[d]) free_part.row(d).setZero();
        element_loop(free_part, values_of(y));
        for (Index d = 0; d < model_.num_dofs(); ++d)
            if (model_.prescribed[d]) values_of(y).row(d) = values_of(x).row(d);
    }

    void apply_block_jacobi(const DeviceVector& r, DeviceVector& z) override {
        require_model_vectors(r, z, "apply_block_jacobi");
        for (Index n = 0; n < model_.mesh.num_nodes(); ++n)
            values_of(z).middleRows<3>(3 * n) =
                inverse_diagonal_[n] * values_of(r).middleRows<3>(3 * n);
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

    void wait() override {}

private:
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
