// SPDX-License-Identifier: Apache-2.0
#include "surefoot/core/nearest_names.hpp"

#include <algorithm>

namespace surefoot {
namespace {

/// Levenshtein distance in which a swap of two neighbouring characters counts as one edit (optimal
/// string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b) {
    const std::size_t columns = b.size() + 1;
    std::vector<std::size_t> before(columns), above(columns), row(columns);
    for (std::size_t j = 0; j < columns; ++j) above[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j < columns; ++j) {
            const std::size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
            row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + change});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                row[j] = std::min(row[j], before[j - 2] + 1);
            }
        }
        std::swap(before, above);
        std::swap(above, row);
    }
    return above[b.size()];
}

}  // namespace

std::vector<std::string> nearest_names(std::string_view name,
                                       std::span<const std::string> names,
                                       std::size_t count) {
    struct Candidate {
        std::size_t distance;
        const std::string* name;
    };
    std::vector<Candidate> candidates;
    // A key may have any length, so only its first 128 characters are compared: the work grows with
    // the length.
    const std::string_view key = name.substr(0, 128);
    for (const std::string& other : names) {
        const std::size_t distance = edit_distance(key, other);
        if (2 * distance <= std::max(key.size(), other.size())) {
            candidates.push_back({distance, &other});
        }
    }
    std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
        return a.distance < b.distance;
    });
    std::vector<std::string> nearest;
    for (const Candidate& candidate : candidates) {
        // Names that are clearly less similar than the best one are left out.
        if (candidate.distance > candidates.front().distance + 1) break;
        if (nearest.size() < count) nearest.push_back(*candidate.name);
    }
    return nearest;
}

std::string did_you_mean(std::string_view name, std::span<const std::string> names) {
    const std::vector<std::string> nearest = nearest_names(name, names);
    if (nearest.empty()) return {};
    std::string text = "; did you mean '" + nearest[0] + "'";
    for (std::size_t i = 1; i < nearest.size(); ++i) {
        text += (i + 1 == nearest.size() ? " or '" : ", '") + nearest[i] + "'";
    }
    return text + "?";
}

}  // namespace surefoot
