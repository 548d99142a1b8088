// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/eval/report/html_report.hpp"
#include "surefoot/stairs/features.hpp"

namespace surefoot::app {

/// Returns a text such as "2 flights, 1 drop, no kerb, no sill, no door; 9 edges".
[[nodiscard]] std::string features_count_text(const stairs::TerrainFeatures& features);

/// Returns one line for each flight, drop, kerb, sill and door.
[[nodiscard]] std::string features_text(const stairs::TerrainFeatures& features);

/// Returns the same features as a table for a report; no rows without features.
[[nodiscard]] eval::ReportTable features_table(const stairs::TerrainFeatures& features);

}  // namespace surefoot::app
