// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "surefoot/calibration/bundle/view_check.hpp"

namespace surefoot::calibration {

struct SelectionLimits {
    /// A view in which no corner moved further (rms) since an earlier one is that view again:
    /// corner noise of 0.1 px per coordinate makes this difference.
    double least_motion_px = 0.2;
    /// Of a long video, the views that differ most; more cost time and tell little.
    std::size_t most_views = 100;
};

/// Chooses among the views `candidates` (ascending indices); `motion_px(a, b)` tells how much two
/// of them differ. Views that repeat an earlier one leave; of too many, those stay that lie
/// farthest from the ones already taken, beginning with the first. Gives ascending indices, and
/// adds the others to `rejected`.
[[nodiscard]] std::vector<std::size_t> select_views(
    std::span<const std::size_t> candidates,
    const std::function<double(std::size_t, std::size_t)>& motion_px,
    const SelectionLimits& limits,
    std::vector<RejectedView>& rejected);

}  // namespace surefoot::calibration
