// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "surefoot/calibration/bundle/view_check.hpp"

namespace surefoot::calibration {

struct SelectionLimits {
    /// A view repeats an earlier view if its corners moved by less than this (rms). Corner noise of
    /// 0.1 px per coordinate alone causes this difference.
    double least_motion_px = 0.2;
    /// Largest number of selected views. More views cost time and add little.
    std::size_t most_views = 100;
};

/// Selects from the views `candidates` (ascending indices). `motion_px(a, b)` is the difference of
/// two views. Removes views that repeat an earlier one. If more than `most_views` remain, starts
/// with the first view and adds the view that differs most from the selected views. Returns
/// ascending indices and adds the other views to `rejected`.
[[nodiscard]] std::vector<std::size_t> select_views(
    std::span<const std::size_t> candidates,
    const std::function<double(std::size_t, std::size_t)>& motion_px,
    const SelectionLimits& limits,
    std::vector<RejectedView>& rejected);

}  // namespace surefoot::calibration
