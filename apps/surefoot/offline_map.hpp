// SPDX-License-Identifier: Apache-2.0
#pragma once

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

/// The operator's word for the ground under the present feet: as far as the machine file allows, at the
/// height that the map gives there. Adds a sentence to `assumed`.
[[nodiscard]] gate::VouchedArea vouch_for_start(const Machine& machine,
                                                const gate::Query& query,
                                                const grid::MapSnapshot& map,
                                                std::vector<std::string>& assumed);

}  // namespace surefoot::app
