// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/preconditioner.hpp"

#include <map>
#include <numeric>

namespace palpate {
namespace {

class BlockJacobi final : public Preconditioner {
public:
    BlockJacobi(Backend& backend, const DeviceOperator& matrix)
        : backend_(backend), matrix_(matrix) {}

    void apply(const DeviceVector& r, DeviceVector& z, DeviceSums& rz) override {
        backend_.apply_inverse_diagonal(matrix_, 1.0, r, z, &rz);
    }
    void keep_only(Index) override {}

private:
    Backend& backend_;
    const DeviceOperator& matrix_;
};

class PrecisionBridge final : public Preconditioner {
public:
    PrecisionBridge(Backend& outer, Backend& single, std::unique_ptr<Preconditioner> inner)
        : outer_(outer), single_(single), inner_(std::move(inner)) {}

    void apply(const DeviceVector& r, DeviceVector& z, DeviceSums& rz) override {
        Vectors& v = vectors_[r.columns()];
        if (!v.r) {
            v.r = single_.make_vector(r.rows(), r.columns());
            v.z = single_.make_vector(r.rows(), r.columns());
            v.rz = single_.make_sums(r.columns());
            v.all.resize(r.columns());
            std::iota(v.all.begin(), v.all.end(), 0);
        }
        single_.copy_columns(r, v.all, *v.r, v.all);
        inner_->apply(*v.r, *v.z, *v.rz);
        outer_.copy_columns(*v.z, v.all, z, v.all);
        outer_.dot(r, z, rz);
    }

    void keep_only(Index columns) override {
        std::erase_if(vectors_, [&](const auto& entry) { return entry.first != columns; });
        inner_->keep_only(columns);
    }

private:
    struct Vectors {
        std::unique_ptr<DeviceVector> r, z;
        std::unique_ptr<DeviceSums> rz;
        std::vector<Index> all;
    };

    Backend& outer_;
    Backend& single_;
    std::unique_ptr<Preconditioner> inner_;
    std::map<Index, Vectors> vectors_;
};

}  // namespace

std::unique_ptr<Preconditioner> make_block_jacobi(Backend& backend, const DeviceOperator& matrix) {
    return std::make_unique<BlockJacobi>(backend, matrix);
}

std::unique_ptr<Preconditioner> make_precision_bridge(Backend& outer, Backend& single,
                                                      std::unique_ptr<Preconditioner> inner) {
    return std::make_unique<PrecisionBridge>(outer, single, std::move(inner));
}

}  // namespace palpate
