// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "surefoot/core/machine.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::app {

/// A map from a folder, and the assumptions that its use needs.
struct OfflineMap {
    std::unique_ptr<grid::MapSnapshot> snapshot;
    std::vector<std::string> assumed;
};

/// Reads map.snapshot of a run. Without this file, reads elevation.asc and variance.asc.
[[nodiscard]] Result<OfflineMap> load_offline_map(const std::string& folder);

/// Makes an operator attestation for the ground around base_link, at the lower quartile of the
/// known heights there. A negative radius selects the reach of the standing feet. Adds a sentence
/// to `assumed`. Returns a usage error if the radius exceeds the limit of the machine file.
[[nodiscard]] Result<gate::AttestedArea> attest_start(const Machine& machine,
                                                      const gate::Query& query,
                                                      const grid::MapSnapshot& map,
                                                      double radius_m,
                                                      std::vector<std::string>& assumed);

/// Inputs of the gate besides map and query when the gate runs offline. The gate state is `ready`.
/// The time is the latest stamp of the map, so an old depth frame still counts as old.
struct OfflineMoment {
    gate::GateHealth health{gate::GateState::ready, {}};
    std::int64_t now_ns = 0;
};
[[nodiscard]] OfflineMoment moment_of(const grid::MapSnapshot& map);
/// Runs gate::decide() with moment_of(map).
[[nodiscard]] gate::Verdict decide_offline(const Machine& machine,
                                           const gate::Query& query,
                                           const grid::MapSnapshot& map);

}  // namespace surefoot::app
