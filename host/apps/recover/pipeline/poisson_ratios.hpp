// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "host/apps/recover/inverse/map_estimate.hpp"
#include "host/apps/recover/inverse/poisson_search.hpp"
#include "host/apps/recover/pipeline/recover_options.hpp"

namespace palpate {

/// What a search with unknown Poisson's ratios finds.
struct PoissonEstimate {
    std::shared_ptr<const Mechanics> mechanics;  ///< at the most probable ratios
    MapEstimate estimate;        ///< there; moduli as uncertain as the ratios make them
    std::vector<Index> regions;  ///< whose ratios were searched: those with any influence
    RatioPosterior ratios;       ///< of `regions`
};

/// Poisson's ratios together with everything else: each trial of ratios condenses the model anew
/// and starts at the estimate of the last one, with the noise held so that objectives compare. If
/// the noise at the end is another one, the search is repeated once with it. Throws what
/// `make_mechanics` throws.
PoissonEstimate search_poisson_ratios(const Mechanics& start,
                                      const SurfaceObservations& observations,
                                      const RecoverOptions& options, const ProgressSink& progress);

/// Throws Error(invalid_argument) for options that do not go with an unknown ratio.
void check_unknown_ratios(const RecoverOptions& options);

}  // namespace palpate
