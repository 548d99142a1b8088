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

/// A map from a folder, and what had to be assumed to use it.
struct OfflineMap {
    std::unique_ptr<grid::MapSnapshot> snapshot;
    std::vector<std::string> assumed;
};

/// map.snapshot of a run, else elevation.asc with variance.asc.
[[nodiscard]] Result<OfflineMap> load_offline_map(const std::string& folder);

/// An operator's word for the ground around base_link, at the height that the map gives there. A
/// negative radius means as far as the present feet reach. Adds a sentence to `assumed`; a
/// usage error when the radius exceeds what the machine file allows.
[[nodiscard]] Result<gate::VouchedArea> vouch_for_start(const Machine& machine,
                                                        const gate::Query& query,
                                                        const grid::MapSnapshot& map,
                                                        double radius_m,
                                                        std::vector<std::string>& assumed);

/// What a gate is told offline beside map and question: it is ready, and asked right after the last
/// thing that the run did; an old depth frame stays old.
struct OfflineMoment {
    gate::GateHealth health{gate::GateState::ready, {}};
    std::int64_t now_ns = 0;
};
[[nodiscard]] OfflineMoment moment_of(const grid::MapSnapshot& map);
[[nodiscard]] gate::Verdict decide_offline(const Machine& machine,
                                           const gate::Query& query,
                                           const grid::MapSnapshot& map);

}  // namespace surefoot::app
