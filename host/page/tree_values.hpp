// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/page/result_tree.hpp"
#include "solver/base/types.hpp"

namespace palpate {

/// Of geometry as values of figures.
inline std::vector<double> components(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
/// Row by row.
inline std::vector<std::vector<double>> rows_of_matrix(const Mat3& m) {
    return {components(m.row(0)), components(m.row(1)), components(m.row(2))};
}

/// The value of what may not be there.
template <class Optional>
FigureValue value_or_null(const Optional& value) {
    return value ? FigureValue(*value) : FigureValue();
}

}  // namespace palpate
