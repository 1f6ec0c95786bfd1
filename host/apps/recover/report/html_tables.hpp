// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/recover/result/recovery_result.hpp"

namespace palpate {

/// Pieces of the report page as HTML; every text from outside is escaped.
std::string headline_html(const RecoveryResult& result);  ///< the answer in a few words
std::string findings_html(const RecoveryResult& result);  ///< one card per unknown modulus
std::string notices_html(const RecoveryResult& result);   ///< not converged, warnings
std::string regions_table_html(const RecoveryResult& result);
std::string surfaces_table_html(const RecoveryResult& result);
std::string correlation_table_html(const RecoveryResult& result);
std::string sensitivity_table_html(const RecoveryResult& result);
std::string details_html(const RecoveryResult& result);  ///< alignment, mesh, device, times

}  // namespace palpate
