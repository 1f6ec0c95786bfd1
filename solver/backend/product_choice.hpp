// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "solver/backend/backend.hpp"

namespace palpate {

/// Numbers of columns that share a choice are in one class, named by its largest: 1, 4 (2 to 4), 8,
/// 16 and 32 (17 and more).
Index column_class(Index columns);

/// Runs the product once and says how long it took, in seconds, from the call to the result.
using TimeProduct = std::function<double(Product)>;

/// The fastest of `candidates` (at least one, in order of preference): an earlier one stays unless
/// a later one is more than a tenth faster, so that noise does not decide. Each counts with the
/// best of three runs, but is dropped at the first run that takes three times the best so far. The
/// reason names every time. What `time_product` throws passes through.
ProductChoice fastest_product(Index columns, std::span<const Product> candidates,
                              const TimeProduct& time_product);

/// Choices already made, so that each is measured once. Safe to use from several threads; only one
/// measures at a time.
class ProductChoices {
public:
    /// What was chosen for `setting` (everything else that matters: device, precision, size) and
    /// the class of `columns`; measures it if nothing was.
    ProductChoice choose(const std::string& setting, Index columns,
                         std::span<const Product> candidates, const TimeProduct& time_product);

    std::optional<ProductChoice> find(const std::string& setting, Index columns) const;
    /// Takes over a choice made earlier, by another process for example.
    void remember(const std::string& setting, const ProductChoice& choice);
    /// All choices for one setting, by ascending number of columns.
    std::vector<ProductChoice> choices(const std::string& setting) const;

private:
    using Key = std::pair<std::string, Index>;  ///< setting, class of columns

    mutable std::mutex mutex_;
    std::map<Key, ProductChoice> choices_;
};

}  // namespace palpate
