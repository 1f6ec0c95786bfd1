// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "bench/peers/peers.hpp"

namespace palpate::bench {
namespace {

void append(std::vector<PeerEntry>& all, std::vector<PeerEntry> some) {
    all.insert(all.end(), some.begin(), some.end());
}

std::vector<PeerEntry> make_registry() {
    std::vector<PeerEntry> all;
    append(all, eigen_peers());
#ifdef PALPATE_BENCH_CHOLMOD
    append(all, cholmod_peers());
#endif
#ifdef PALPATE_BENCH_PETSC
    append(all, petsc_peers());
#endif
    return all;
}

}  // namespace

const std::vector<PeerEntry>& peer_registry() {
    static const std::vector<PeerEntry> registry = make_registry();
    return registry;
}

ParallelRun parallel_run() {
#ifdef PALPATE_BENCH_PETSC
    return petsc_parallel_run();
#else
    return {};
#endif
}

}  // namespace palpate::bench
