// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "surefoot/stairs/features.hpp"

namespace surefoot::stairs {

/// Within 15 deg: edges that were found alone are ragged.
[[nodiscard]] bool is_parallel(const Edge& a, const Edge& b);
/// The same heights above and below.
[[nodiscard]] bool same_ground(const Edge& a, const Edge& b);
/// Length that two edges share, along the first; negative = the gap between them.
[[nodiscard]] double overlap_m(const Edge& a, const Edge& b);
/// A piece of the same edge, or what a ragged edge looks like beside it.
[[nodiscard]] bool is_part_of(const Edge& piece, const Edge& edge);
/// What is left of the edges of a flight whose far end is seen badly: among its steps, as high as
/// they are, leading the same way. `chain`: from below.
[[nodiscard]] bool is_among(const Edge& edge, std::span<const Edge> chain);
/// Two pieces of one straight line, at most `max_gap_m` apart.
[[nodiscard]] bool goes_on(const Edge& edge, const Edge& piece, double max_gap_m);
/// The line through both, as long as both; all else is what the first says.
[[nodiscard]] Edge joined(Edge edge, const Edge& piece);

}  // namespace surefoot::stairs
