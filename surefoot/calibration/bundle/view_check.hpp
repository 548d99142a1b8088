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

/// A view or pair that the calibration does not use.
struct RejectedView {
    std::size_t index = 0;  ///< index into the input views
    std::string reason;
    friend bool operator==(const RejectedView&, const RejectedView&) = default;
};

/// Adds a view, in ascending order of index. Appends a second reason for a view to its first.
void reject(std::vector<RejectedView>& rejected, std::size_t index, const std::string& reason);

/// Describes the first problem of a view; nullopt if the view is usable. Problems: ids and pixels
/// do not match; ids are not in order or not on the board; a pixel is NaN or outside the image; the
/// disc radius is wrong; fewer than `least_points` points; all points on one line.
[[nodiscard]] std::optional<std::string> view_problem(const Board& board,
                                                      const BoardView& view,
                                                      ImageSize size,
                                                      int least_points);

/// Rms distance of the common points of two views [px]; infinity if a view shares fewer than half
/// of its points.
[[nodiscard]] double motion_px(const BoardView& a, const BoardView& b);

/// Returns the median of the disc radii of the views [m]; 0 for views of points.
[[nodiscard]] double disc_radius_m(std::span<const BoardView> views);

/// Returns a text with up to three reasons: "6 of 8 views were left out: view 2: ...; view 5: ...".
[[nodiscard]] std::string summary_of(std::span<const RejectedView> rejected, std::size_t views);

[[nodiscard]] double median(std::vector<double> values);  ///< upper median; 0 without values

}  // namespace surefoot::calibration
