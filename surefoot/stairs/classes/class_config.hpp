// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "surefoot/core/config.hpp"

namespace surefoot::stairs {

/// Settings that define the classes floor, ramp, table and tunnel.
struct ClassConfig {
    double headroom_m = 2.1;    ///< 2.05 m for the machine (machines/rex.yaml) plus 50 mm
    double max_step_m = 0.20;   ///< higher or lower ground cannot be reached by a step
    double level_deg = 2.9;     ///< ground steeper than 1:20 is a ramp (ADA 402.1, 405)
    double ramp_deg = 12.0;     ///< steeper ground is not walked on; built ramps have 1:8 or less
    double min_table_m = 0.30;  ///< narrower raised objects are walls; walls have 0.1 to 0.25 m
    double max_table_m = 1.3;   ///< higher objects are walls, even level ones; counters have 1.1 m
    double max_sigma_m = 0.03;  ///< a less certain cell may hide a drop
    double reach_m = 1.0;       ///< ground farther away has no effect on a cell

    void describe(ConfigVisitor& visitor);
    /// Returns the first reason why these settings are invalid, or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
};

}  // namespace surefoot::stairs
