// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The entries of each file of this folder, for `all.cpp`.
#include "bench/peers/peer.hpp"

namespace palpate::bench {

std::vector<PeerEntry> eigen_peers();
std::vector<PeerEntry> cholmod_peers();
std::vector<PeerEntry> petsc_peers();
ParallelRun petsc_parallel_run();

}  // namespace palpate::bench
