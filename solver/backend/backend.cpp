// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backend/backend.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>

#include "solver/model/refuse.hpp"

namespace palpate {
namespace {

[[noreturn]] void refuse_call(const char* function, const std::string& what) {
    refuse(fmt::format("Backend::{}: {}.", function, what));
}

template <class Rectangle>
std::string shape_of(const Rectangle& vector_or_operator) {
    return fmt::format("{}x{}", vector_or_operator.rows(), vector_or_operator.columns());
}

void require_numbers(const char* function, std::size_t given, std::size_t wanted,
                     const char* each) {
    if (given != wanted)
        refuse_call(function, fmt::format("{} numbers were given where {} are needed, one {}",
                                          given, wanted, each));
}

void require_same_shape(const char* function, std::initializer_list<const DeviceVector*> vectors) {
    const DeviceVector& first = **vectors.begin();
    for (const DeviceVector* v : vectors)
        if (v->rows() != first.rows() || v->columns() != first.columns())
            refuse_call(function, fmt::format("vectors of one shape are needed, not of {} and {}",
                                              shape_of(first), shape_of(*v)));
}

/// Sums that are not given fit.
void require_columns(const char* function, Index columns,
                     std::initializer_list<const DeviceSums*> all) {
    for (const DeviceSums* sums : all)
        if (sums && sums->columns() != columns)
            refuse_call(function, fmt::format("sums of {} columns are needed, not of {}", columns,
                                              sums->columns()));
}

void require_inverse_diagonal(const char* function, const DeviceOperator& a) {
    if (!a.has_inverse_diagonal() && a.rows() > 0)
        refuse_call(function,
                    "the operator has no inverted diagonal: give the blocks to make_operator");
}

void check_matrix(const char* function, const BlockMatrix& matrix) {
    const auto is_size = [](int size) { return size >= 1 && size <= max_block; };
    if (!is_size(matrix.block_rows) || !is_size(matrix.block_columns))
        refuse_call(function, fmt::format("blocks need 1 to {} rows and columns, not {}x{}",
                                          max_block, matrix.block_rows, matrix.block_columns));
    const std::vector<Index>& offsets = matrix.graph.offsets;
    const std::vector<Index>& items = matrix.graph.items;
    const auto exists = [&](Index item) { return item >= 0 && item < matrix.num_columns; };
    if (offsets.empty() || offsets.front() != 0 ||
        offsets.back() != static_cast<Index>(items.size()) ||
        !std::is_sorted(offsets.begin(), offsets.end()) ||
        !std::all_of(items.begin(), items.end(), exists) ||
        matrix.blocks.size() != items.size() * matrix.block_size())
        refuse_call(function, fmt::format("a matrix of {} row offsets, {} block columns below {} "
                                          "and {} numbers in blocks does not fit together",
                                          offsets.size(), items.size(), matrix.num_columns,
                                          matrix.blocks.size()));
}

void require_inverse_blocks(const char* function, std::span<const double> inverse_diagonal,
                            const BlockMatrix& matrix) {
    require_numbers(
        function, inverse_diagonal.size(),
        static_cast<std::size_t>(matrix.num_rows()) * matrix.block_rows * matrix.block_rows,
        "per entry of the inverted diagonal blocks");
}

}  // namespace

void Backend::require_model(const char* function) const {
    if (!has_model_)
        refuse_call(function, "the back end holds no model: call prepare(model) first");
}

void Backend::require_dofs(const char* function, const DeviceVector& v) const {
    require_model(function);
    if (v.rows() != num_dofs_)
        refuse_call(function, fmt::format("a vector of {} does not fit the model: 3 rows per node "
                                          "are needed, {}",
                                          shape_of(v), num_dofs_));
}

void Backend::prepare(const Model& model) {
    check_model(model);
    has_model_ = false;
    do_prepare(model);
    num_dofs_ = model.num_dofs();
    num_materials_ = model.materials.size();
    has_model_ = true;
}

void Backend::set_stiffness(std::span<const double> stiffness_kpa) {
    const char* const function = "set_stiffness";
    require_model(function);
    require_numbers(function, stiffness_kpa.size(), num_materials_, "per material");
    for (const double modulus : stiffness_kpa)
        if (!(modulus > 0))
            refuse_call(function,
                        fmt::format("a Young's modulus must be above 0 kPa, not {}", modulus));
    do_set_stiffness(stiffness_kpa);
}

std::unique_ptr<DeviceVector> Backend::make_vector(Index rows, Index columns) {
    if (rows < 0 || columns < 1)
        refuse_call("make_vector", fmt::format("0 or more rows and 1 or more columns are needed, "
                                               "not {}x{}",
                                               rows, columns));
    return do_make_vector(rows, columns);
}

void Backend::copy_in(std::span<const double> host, DeviceVector& v) {
    require_numbers("copy_in", host.size(), v.size(), "per row and column of the vector");
    do_copy_in(host, v);
}

void Backend::copy_out(const DeviceVector& v, std::span<double> host) {
    require_numbers("copy_out", host.size(), v.size(), "per row and column of the vector");
    do_copy_out(v, host);
}

void Backend::copy_columns(const DeviceVector& from, std::span<const Index> from_columns,
                           DeviceVector& to, std::span<const Index> to_columns) {
    const auto has_all = [](const DeviceVector& v, std::span<const Index> columns) {
        return std::all_of(columns.begin(), columns.end(),
                           [&](Index c) { return c >= 0 && c < v.columns(); });
    };
    if (from.rows() != to.rows() || from_columns.size() != to_columns.size() ||
        !has_all(from, from_columns) || !has_all(to, to_columns))
        refuse_call(
            "copy_columns",
            fmt::format("{} columns of {} do not fit {} columns of {}: rows and numbers of "
                        "columns must agree, and every column must exist",
                        from_columns.size(), shape_of(from), to_columns.size(), shape_of(to)));
    do_copy_columns(from, from_columns, to, to_columns);
}

std::unique_ptr<DeviceSums> Backend::make_sums(Index columns) {
    if (columns < 1)
        refuse_call("make_sums", fmt::format("1 or more columns are needed, not {}", columns));
    return do_make_sums(columns);
}

void Backend::set(DeviceSums& sums, std::span<const double> values) {
    require_numbers("set", values.size(), sums.columns(), "per column of the sums");
    do_set(sums, values);
}

void Backend::read(const DeviceSums& sums, std::span<double> values) {
    require_numbers("read", values.size(), sums.columns(), "per column of the sums");
    do_read(sums, values);
}

void Backend::dot(const DeviceVector& x, const DeviceVector& y, DeviceSums& xy) {
    require_same_shape("dot", {&x, &y});
    require_columns("dot", x.columns(), {&xy});
    do_dot(x, y, xy);
}

std::unique_ptr<DeviceOperator> Backend::make_operator(const BlockMatrix& matrix,
                                                       std::span<const double> inverse_diagonal) {
    const char* const function = "make_operator";
    check_matrix(function, matrix);
    if (!inverse_diagonal.empty()) {
        if (matrix.num_rows() != matrix.num_columns || matrix.block_rows != matrix.block_columns)
            refuse_call(function, "only a square matrix of square blocks has an inverted diagonal");
        require_inverse_blocks(function, inverse_diagonal, matrix);
    }
    auto a = do_make_operator(matrix, !inverse_diagonal.empty());
    do_set_values(*a, matrix, inverse_diagonal);
    return a;
}

void Backend::set_values(DeviceOperator& a, const BlockMatrix& matrix,
                         std::span<const double> inverse_diagonal) {
    const char* const function = "set_values";
    check_matrix(function, matrix);
    if (a.is_stiffness()) refuse_call(function, "the stiffness follows prepare and set_stiffness");
    const DeviceOperator wanted(matrix, a.has_inverse_diagonal());
    if (a.rows() != wanted.rows() || a.columns() != wanted.columns() ||
        a.block_rows() != wanted.block_rows() || a.block_columns() != wanted.block_columns() ||
        a.num_blocks() != wanted.num_blocks())
        refuse_call(function,
                    fmt::format("new values need the pattern that the operator was made with: {} "
                                "blocks of {}x{} in {}, not {} of {}x{} in {}",
                                a.num_blocks(), a.block_rows(), a.block_columns(), shape_of(a),
                                wanted.num_blocks(), wanted.block_rows(), wanted.block_columns(),
                                shape_of(wanted)));
    if (a.has_inverse_diagonal())
        require_inverse_blocks(function, inverse_diagonal, matrix);
    else if (!inverse_diagonal.empty())
        refuse_call(function, "the operator was made without its inverted diagonal");
    do_set_values(a, matrix, inverse_diagonal);
}

const DeviceOperator& Backend::stiffness() {
    require_model("stiffness");
    return do_stiffness();
}

void Backend::multiply(const char* function, const OperatorProduct& product) {
    const auto& [result, a, x, y, b, alpha, beta, weight, sum] = product;
    if (&x == &y || b == &y)
        refuse_call(function, "the result cannot overwrite what it is made from: give two vectors");
    if (a.columns() != x.rows() || a.rows() != y.rows() || x.columns() != y.columns())
        refuse_call(function, fmt::format("an operator of {} does not fit vectors of {} and {}",
                                          shape_of(a), shape_of(x), shape_of(y)));
    if (b) require_same_shape(function, {b, &y});
    if (result == RowResult::smooth) require_inverse_diagonal(function, a);
    if (sum && a.rows() != a.columns())
        refuse_call(function, fmt::format("sums need a square operator, not {}", shape_of(a)));
    require_columns(function, x.columns(), {sum});
    do_multiply(product);
}

void Backend::apply(const DeviceOperator& a, const DeviceVector& x, DeviceVector& y,
                    DeviceSums* xy) {
    multiply("apply", {.result = RowResult::apply, .a = a, .x = x, .y = y, .sum = xy});
}

void Backend::apply_add(const DeviceOperator& a, const DeviceVector& x, DeviceVector& y) {
    multiply("apply_add", {.result = RowResult::add, .a = a, .x = x, .y = y});
}

void Backend::residual(const DeviceOperator& a, const DeviceVector& b, const DeviceVector& x,
                       DeviceVector& r) {
    multiply("residual", {.result = RowResult::residual, .a = a, .x = x, .y = r, .b = &b});
}

void Backend::smooth(const DeviceOperator& a, const DeviceVector& b, const DeviceVector& x,
                     double alpha, double beta, double weight, DeviceVector& y, DeviceSums* by) {
    multiply("smooth", {RowResult::smooth, a, x, y, &b, alpha, beta, weight, by});
}

void Backend::apply_inverse_diagonal(const DeviceOperator& a, double weight, const DeviceVector& r,
                                     DeviceVector& z, DeviceSums* rz) {
    const char* const function = "apply_inverse_diagonal";
    require_same_shape(function, {&r, &z});
    if (r.rows() != a.rows())
        refuse_call(function, fmt::format("an operator of {} does not fit vectors of {}",
                                          shape_of(a), shape_of(r)));
    require_inverse_diagonal(function, a);
    require_columns(function, r.columns(), {rz});
    do_apply_inverse_diagonal(a, weight, r, z, rz);
}

void Backend::advance(const DeviceSums& rz, const DeviceSums& pq, const DeviceSums& rr,
                      const DeviceSums& limit, const DeviceVector& p, const DeviceVector& q,
                      DeviceVector& x, DeviceVector& r, DeviceSums& rr_new) {
    const char* const function = "advance";
    require_same_shape(function, {&p, &q, &x, &r});
    require_columns(function, p.columns(), {&rz, &pq, &rr, &limit, &rr_new});
    for (const DeviceSums* old : {&rz, &pq, &rr, &limit})
        if (old == &rr_new)
            refuse_call(function, "the new sums cannot overwrite the old ones: give two objects");
    do_advance(rz, pq, rr, limit, p, q, x, r, rr_new);
}

void Backend::turn(const DeviceSums& rz_new, const DeviceSums& rz, const DeviceVector& z,
                   DeviceVector& p) {
    require_same_shape("turn", {&z, &p});
    require_columns("turn", p.columns(), {&rz_new, &rz});
    do_turn(rz_new, rz, z, p);
}

void Backend::internal_force(const DeviceVector& x, DeviceVector& y) {
    const char* const function = "internal_force";
    require_same_shape(function, {&x, &y});
    require_dofs(function, x);
    if (&x == &y) refuse_call(function, "the forces cannot overwrite x: give two vectors");
    do_internal_force(x, y);
}

void Backend::strain_energy(const DeviceVector& x, std::span<double> energy) {
    require_dofs("strain_energy", x);
    require_numbers("strain_energy", energy.size(), x.columns(), "per column of the vector");
    do_strain_energy(x, energy);
}

void Backend::parameter_gradient(const DeviceVector& lambda, const DeviceVector& x,
                                 std::span<double> gradient) {
    const char* const function = "parameter_gradient";
    require_same_shape(function, {&lambda, &x});
    require_dofs(function, x);
    require_numbers(function, gradient.size(), num_materials_, "per material");
    do_parameter_gradient(lambda, x, gradient);
}

std::unique_ptr<SolidDevice> Backend::make_solid(const SolidModel& model) {
    return do_make_solid(solid_tables(model, describe().backend));
}

}  // namespace palpate
