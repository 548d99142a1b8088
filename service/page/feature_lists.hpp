// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "service/gate_process/protocol/json_text.hpp"
#include "surefoot/stairs/features.hpp"

namespace surefoot::page {

/// Returns the lists "flights", "drops", "kerbs", "sills", "doors" and "edges" of stairs.json and
/// of the "stairs" message (docs/reference/json.md). A pose is [x_m, y_m, z_m, yaw_rad] in the
/// frame of the map. `std` is a standard error, `spread` the scatter of the single steps. Drops and
/// kerbs have positive heights. A tracked feature also has `id`, `observations` (their number) and
/// `last_seen_s` (age of the last observation at `features.time_ns`). A value that is NaN or
/// infinite becomes null.
[[nodiscard]] gate_process::Json feature_lists(const stairs::TerrainFeatures& features);

/// Returns the "stairs" message of messages.json, one line of JSON.
[[nodiscard]] std::string stairs_text(const stairs::TerrainFeatures& features);

/// Returns true if both contain the same features; the times of observations may differ. A page
/// then needs no new "stairs" message.
[[nodiscard]] bool say_the_same(const stairs::TerrainFeatures& one,
                                const stairs::TerrainFeatures& other);

}  // namespace surefoot::page
