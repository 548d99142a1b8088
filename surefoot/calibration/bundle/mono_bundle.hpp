// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/calibration/bundle/board_bundle.hpp"

namespace surefoot::calibration {

/// Returns the views `kept` (indices into `views`, which must be usable) as a bundle of one camera
/// with unknown lens and unknown poses. Sights are ordered by view.
[[nodiscard]] BoardBundle mono_bundle(const Board& board,
                                      std::span<const BoardView> views,
                                      std::span<const std::size_t> kept,
                                      ImageSize size,
                                      LensKind kind);

}  // namespace surefoot::calibration
