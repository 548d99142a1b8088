// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/calibration/lenses/lens.hpp"

namespace surefoot::calibration {

/// A view that a calibration leaves out.
struct RejectedView {
    std::size_t index = 0;  ///< into the views given
    std::string reason;
    friend bool operator==(const RejectedView&, const RejectedView&) = default;
};

/// Adds a view in ascending order; a second reason joins the first.
void reject(std::vector<RejectedView>& rejected, std::size_t index, const std::string& reason);

/// First reason why a view cannot serve: ids and pixels that do not match, ids out of order or not
/// on the board, pixels that are NaN or outside the image, fewer than `least_points`, points on a
/// line.
[[nodiscard]] std::optional<std::string> view_problem(const Board& board,
                                                      const BoardView& view,
                                                      ImageSize size,
                                                      int least_points);

/// Rms distance of the points that two views share [px]; infinity when less than half of the points
/// of one are shared.
[[nodiscard]] double motion_px(const BoardView& a, const BoardView& b);

/// Median of what the views say of their discs' radius; 0 where they show points.
[[nodiscard]] double disc_radius_m(std::span<const BoardView> views);

/// "6 of 8 views left out: view 2 ...; view 5 ...": the first three reasons.
[[nodiscard]] std::string summary_of(std::span<const RejectedView> rejected, std::size_t views);

[[nodiscard]] double median(std::vector<double> values);  ///< 0 when empty

}  // namespace surefoot::calibration
