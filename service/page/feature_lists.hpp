// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "service/gate_process/protocol/json_text.hpp"
#include "surefoot/stairs/features.hpp"

namespace surefoot::page {

/// Flights, drops, kerbs, sills, doors and edges, as stairs.json and pages have them. Poses are
/// x, y, z [m] and yaw [rad] in the frame of the map; std = standard error, spread = scatter of the
/// single ones; drops and kerbs have positive heights. What was followed has `id`, `looks` and
/// `last_seen_s`. What is no number is null.
[[nodiscard]] wire::Json feature_lists(const stairs::TerrainFeatures& features);

/// The "stairs" message of messages.json.
[[nodiscard]] std::string stairs_text(const stairs::TerrainFeatures& features);

/// Whether a page would learn nothing from the second that it does not know from the first: time
/// alone that has passed is nothing.
[[nodiscard]] bool say_the_same(const stairs::TerrainFeatures& one,
                                const stairs::TerrainFeatures& other);

}  // namespace surefoot::page
