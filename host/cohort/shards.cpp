// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/shards.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <numeric>
#include <queue>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

using Variable = std::function<const char*(const char*)>;

/// Where an engine tells the index of a task, the least index and the number of tasks.
struct ArrayVariables {
    const char* index;
    const char* first;  ///< null: `usual_first`
    std::size_t usual_first;
    const char* count;
    bool count_is_last;  ///< `count` holds the last index
};

constexpr ArrayVariables engines[] = {
    {"SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_MIN", 1, "SLURM_ARRAY_TASK_MAX", true},
    {"SGE_TASK_ID", "SGE_TASK_FIRST", 1, "SGE_TASK_LAST", true},
    {"LSB_JOBINDEX", nullptr, 1, "LSB_JOBINDEX_END", true},
    {"PBS_ARRAY_INDEX", nullptr, 1, "PALPATE_SHARDS", false},
    {"AWS_BATCH_JOB_ARRAY_INDEX", nullptr, 0, "AWS_BATCH_JOB_ARRAY_SIZE", false},
    {"JOB_COMPLETION_INDEX", nullptr, 0, "PALPATE_SHARDS", false},
};

std::optional<std::size_t> count_in(std::string_view text) {
    std::size_t value = 0;
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failed != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

std::optional<std::size_t> count_of(const Variable& variable, const char* name) {
    const char* text = name ? variable(name) : nullptr;
    return text ? count_in(text) : std::nullopt;  // "undefined" outside arrays of Grid Engine
}

Shard checked(std::size_t number, std::size_t count, const std::string& text) {
    if (number < 1 || number > count)
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("--shard {} is part {} of {}; allowed: K/N with K from 1 to N",
                                text, number, count));
    return {number, count};
}

Shard shard_of_engine(const Variable& variable) {
    for (const ArrayVariables& engine : engines) {
        const auto index = count_of(variable, engine.index);
        if (!index || (*index == 0 && engine.usual_first == 1)) continue;
        const std::size_t first = count_of(variable, engine.first).value_or(engine.usual_first);
        auto count = count_of(variable, "PALPATE_SHARDS");
        if (!count) count = count_of(variable, engine.count);
        if (!count)
            throw Error(
                ErrorCode::invalid_argument,
                fmt::format("--shard auto: {} is set, but nothing says how many tasks there "
                            "are; set PALPATE_SHARDS",
                            engine.index));
        if (engine.count_is_last && !variable("PALPATE_SHARDS")) *count = *count + 1 - first;
        return checked(*index + 1 - first, *count, "auto");
    }
    throw Error(ErrorCode::invalid_argument,
                "--shard auto: this is no task of an array job (no SLURM_ARRAY_TASK_ID, "
                "SGE_TASK_ID, ...); give K/N");
}

}  // namespace

std::vector<std::vector<std::size_t>> balanced_shards(const std::vector<double>& estimates_s,
                                                      std::size_t count) {
    std::vector<std::size_t> order(estimates_s.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return estimates_s[a] > estimates_s[b]; });
    using Load = std::pair<double, std::size_t>;  // ties go to the first
    std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
    for (std::size_t k = 0; k < count; ++k) loads.emplace(0.0, k);
    std::vector<std::vector<std::size_t>> shards(count);
    for (const std::size_t k : order) {
        const auto [load, shard] = loads.top();
        loads.pop();
        shards[shard].push_back(k);
        loads.emplace(load + estimates_s[k], shard);
    }
    return shards;
}

Shard shard_of(const std::string& text, const Variable& variable) {
    if (text == "auto") return shard_of_engine(variable);
    const std::size_t slash = text.find('/');
    const auto number = count_in(text.substr(0, slash));
    const auto count = slash == std::string::npos ? std::nullopt : count_in(text.substr(slash + 1));
    if (!number || !count)
        throw Error(
            ErrorCode::invalid_argument,
            fmt::format("--shard is \"{}\"; allowed: K/N, for example 3/50, or auto", text));
    return checked(*number, *count, text);
}

}  // namespace palpate
