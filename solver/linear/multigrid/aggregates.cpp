// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/multigrid/aggregates.hpp"

#include <algorithm>

namespace palpate {
namespace {

class Aggregation {
public:
    Aggregation(const Adjacency& graph, std::span<const unsigned char> takes_part)
        : graph_(graph), takes_part_(takes_part) {
        result_.of_node.assign(graph.num_lists(), -1);
    }

    Aggregates run() {
        take_free_neighbourhoods();
        join_neighbours();
        group_leftovers();
        return std::move(result_);
    }

private:
    std::span<const Index> neighbours(Index node) const {
        return {graph_.items.data() + graph_.offsets[node],
                graph_.items.data() + graph_.offsets[node + 1]};
    }
    bool is_open(Index node) const { return takes_part_[node] && result_.of_node[node] < 0; }

    void take_free_neighbourhoods() {
        for (Index root = 0; root < graph_.num_lists(); ++root) {
            if (!is_open(root)) continue;
            const auto list = neighbours(root);
            const bool untouched = std::all_of(list.begin(), list.end(), [&](Index n) {
                return !takes_part_[n] || result_.of_node[n] < 0;
            });
            if (untouched) found(root);
        }
    }

    /// Looks at the state before this phase only, so that no aggregate grows into a chain.
    void join_neighbours() {
        const std::vector<Index> before = result_.of_node;
        std::vector<Index> edges(result_.count, 0);
        for (Index node = 0; node < graph_.num_lists(); ++node) {
            if (!is_open(node)) continue;
            Index best = -1;
            for (Index n : neighbours(node))
                if (before[n] >= 0) ++edges[before[n]];
            for (Index n : neighbours(node)) {
                const Index a = before[n];
                if (a >= 0 && (best < 0 || edges[a] > edges[best])) best = a;
            }
            for (Index n : neighbours(node))
                if (before[n] >= 0) edges[before[n]] = 0;
            result_.of_node[node] = best;
        }
    }

    void group_leftovers() {
        for (Index node = 0; node < graph_.num_lists(); ++node)
            if (is_open(node)) found(node);
    }

    void found(Index root) {
        for (Index n : neighbours(root))
            if (is_open(n)) result_.of_node[n] = result_.count;
        ++result_.count;
    }

    const Adjacency& graph_;
    std::span<const unsigned char> takes_part_;
    Aggregates result_;
};

}  // namespace

Aggregates aggregate_nodes(const Adjacency& graph, std::span<const unsigned char> takes_part) {
    return Aggregation(graph, takes_part).run();
}

}  // namespace palpate
