// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/identify/measured_data.hpp"

// The kinds of data, one file each; `data_kinds()` lists them.
namespace palpate {

DataKind force_kind();
DataKind displacement_kind();
DataKind points_kind();
DataKind profile_kind();
DataKind stress_stretch_kind();
DataKind relaxation_kind();

/// One line for each kind.
const std::vector<DataKind>& data_kinds();

/// Reads [[data]]; `number` counts from 1. Throws Error(invalid_argument) and
/// Error(input_unreadable).
std::unique_ptr<MeasuredData> read_data(const SettingsTable& table, std::size_t number,
                                        DataTables& tables);

}  // namespace palpate
