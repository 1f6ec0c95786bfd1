// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/measured_data.hpp"

#include <fmt/format.h>

#include "host/apps/simulate/setting_values.hpp"

namespace palpate {

const NumberTable& DataTables::read(const std::string& file) {
    const auto there = tables_.find(file);
    if (there != tables_.end()) return there->second;
    return tables_.emplace(file, read_number_table(folder_ / file)).first->second;
}

Eigen::VectorXd vector_of(const std::vector<double>& values) {
    return Eigen::Map<const Eigen::VectorXd>(values.data(), Eigen::Index(values.size()));
}

Eigen::VectorXd read_sd(const DataSource& source, std::string_view key) {
    const auto given = source.table.number(key, positive);
    if (given) return Eigen::VectorXd::Constant(Eigen::Index(source.numbers.rows.size()), *given);
    if (!source.numbers.find(key))
        source.table.missing(key, fmt::format("the noise of one measurement, here or as a column "
                                              "'{}' of the file",
                                              key));
    const std::vector<double> sd = source.numbers.values(key);
    for (std::size_t row = 0; row < sd.size(); ++row)
        if (!(sd[row] > 0)) source.numbers.refuse_row(row, "a standard deviation is not above 0");
    return vector_of(sd);
}

}  // namespace palpate
