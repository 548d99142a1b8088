// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "surefoot/stairs/features.hpp"

namespace surefoot::stairs {

/// True if the directions agree within 15 deg. A single edge has a ragged direction.
[[nodiscard]] bool is_parallel(const Edge& a, const Edge& b);
/// True if both edges have the same heights above and below.
[[nodiscard]] bool same_ground(const Edge& a, const Edge& b);
/// Length that two edges share, along the first one; negative = the gap between them.
[[nodiscard]] double overlap_m(const Edge& a, const Edge& b);
/// True if `piece` belongs to `edge`: a piece of it, or a false line beside a ragged edge.
[[nodiscard]] bool is_part_of(const Edge& piece, const Edge& edge);
/// True for a leftover edge of a flight with an unclear far end: it lies among the steps of
/// `chain`, has their height and faces the same way. `chain`: lowest step first.
[[nodiscard]] bool is_among(const Edge& edge, std::span<const Edge> chain);
/// True for two pieces of one straight line that are at most `max_gap_m` apart.
[[nodiscard]] bool goes_on(const Edge& edge, const Edge& piece, double max_gap_m);
/// One line through both edges, with the length of both; other fields come from the first.
[[nodiscard]] Edge joined(Edge edge, const Edge& piece);

}  // namespace surefoot::stairs
