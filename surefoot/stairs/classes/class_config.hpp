// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "surefoot/core/config.hpp"

namespace surefoot::stairs {

/// What makes a cell floor, ramp, table or tunnel.
struct ClassConfig {
    double headroom_m = 2.1;    ///< the machine's 2.05 m (machines/rex.yaml) with 50 mm to spare
    double max_step_m = 0.20;   ///< ground that lies higher or lower by more is not stepped onto
    double level_deg = 2.9;     ///< steeper than 1:20 is a ramp (ADA 402.1, 405)
    double ramp_deg = 12.0;     ///< nobody walks on what is steeper; built are 1:8 and less
    double min_table_m = 0.30;  ///< what stands and is narrower is a wall: 0.1 to 0.25 m thick
    double max_table_m = 1.3;   ///< level or not, what is higher is a wall: counters have 1.1 m
    double max_sigma_m = 0.03;  ///< a cell known worse may hide a drop
    double reach_m = 1.0;       ///< ground further away says nothing about a cell

    void describe(ConfigVisitor& visitor);
    /// First reason why this cannot be used, or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
};

}  // namespace surefoot::stairs
