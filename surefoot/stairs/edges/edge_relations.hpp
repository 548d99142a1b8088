// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "surefoot/stairs/features.hpp"

namespace surefoot::stairs {

/// True if the directions agree within 15 deg. The direction of a single edge is uncertain.
[[nodiscard]] bool is_parallel(const Edge& a, const Edge& b);
/// True if the heights above and below both edges agree within 40 mm.
[[nodiscard]] bool same_ground(const Edge& a, const Edge& b);
/// Length that two edges share, along the first edge; negative = the gap between them.
[[nodiscard]] double overlap_m(const Edge& a, const Edge& b);
/// True if `piece` belongs to `edge`: a piece of it, or a false line beside a ragged edge.
[[nodiscard]] bool is_part_of(const Edge& piece, const Edge& edge);
/// True for a leftover edge of a flight with an unclear far end: it lies between the first step of
/// `chain` and 0.3 m beyond the last, also in height, and faces their way. `chain`: lowest first.
[[nodiscard]] bool is_among(const Edge& edge, std::span<const Edge> chain);
/// True for two pieces of one straight line that are at most `max_gap_m` apart.
[[nodiscard]] bool goes_on(const Edge& edge, const Edge& piece, double max_gap_m);
/// Returns one line that covers both edges; all other fields come from the first edge.
[[nodiscard]] Edge joined(Edge edge, const Edge& piece);

}  // namespace surefoot::stairs
