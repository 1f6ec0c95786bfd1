// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backend/product_choice.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr int num_runs = 3;
constexpr double hopeless = 3.0;   ///< times the best so far: not worth another run
constexpr double advantage = 0.9;  ///< of the preferred time: what another must stay below

std::string in_words(Product product, double seconds) {
    char text[48];
    std::snprintf(text, sizeof text, "%s %.3g ms", name_of(product).c_str(), 1e3 * seconds);
    return text;
}

double best_time(Product product, const TimeProduct& time_product, double best_so_far) {
    double best = std::numeric_limits<double>::infinity();
    for (int run = 0; run < num_runs; ++run) {
        best = std::min(best, time_product(product));
        if (best > hopeless * best_so_far) break;
    }
    return best;
}

}  // namespace

std::string name_of(Product product) {
    switch (product) {
        case Product::automatic:
            return "auto";
        case Product::assembled:
            return "assembled";
        case Product::matrix_free:
            return "matrix-free";
        case Product::recomputed:
            return "recomputed";
    }
    return "unknown";
}

Index column_class(Index columns) {
    for (Index largest : {1, 4, 8, 16})
        if (columns <= largest) return largest;
    return 32;
}

ProductChoice fastest_product(Index columns, std::span<const Product> candidates,
                              const TimeProduct& time_product) {
    if (candidates.empty())
        throw Error(ErrorCode::internal, "There is no stiffness product to choose from.");
    ProductChoice choice{.columns = columns, .product = candidates.front(), .reason = ""};
    double best = std::numeric_limits<double>::infinity();
    for (Product product : candidates) {
        const double seconds = best_time(product, time_product, best);
        choice.reason += (choice.reason.empty() ? "" : ", ") + in_words(product, seconds);
        if (seconds < advantage * best) {
            best = seconds;
            choice.product = product;
        }
    }
    return choice;
}

ProductChoice ProductChoices::choose(const std::string& setting, Index columns,
                                     std::span<const Product> candidates,
                                     const TimeProduct& time_product) {
    const std::lock_guard lock(mutex_);
    const Key key{setting, column_class(columns)};
    const auto known = choices_.find(key);
    if (known != choices_.end()) return known->second;
    return choices_.emplace(key, fastest_product(columns, candidates, time_product)).first->second;
}

std::optional<ProductChoice> ProductChoices::find(const std::string& setting, Index columns) const {
    const std::lock_guard lock(mutex_);
    const auto known = choices_.find({setting, column_class(columns)});
    if (known == choices_.end()) return std::nullopt;
    return known->second;
}

void ProductChoices::remember(const std::string& setting, const ProductChoice& choice) {
    const std::lock_guard lock(mutex_);
    choices_.insert_or_assign({setting, column_class(choice.columns)}, choice);
}

std::vector<ProductChoice> ProductChoices::choices(const std::string& setting) const {
    const std::lock_guard lock(mutex_);
    std::vector<ProductChoice> found;
    for (const auto& [key, choice] : choices_)
        if (key.first == setting) found.push_back(choice);
    return found;
}

}  // namespace palpate
