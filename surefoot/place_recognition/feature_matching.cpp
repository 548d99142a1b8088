// SPDX-License-Identifier: Apache-2.0
#include "surefoot/place_recognition/feature_matching.hpp"

#include <cstdint>

namespace surefoot::place_recognition {
namespace {

constexpr int kNone = 257;  ///< larger than any distance

/// Returns the index of the smallest distance in a row or column. Returns -1 if that distance
/// exceeds the limit or is not clearly the smallest.
int best_of(const MatchConfig& config,
            std::span<const Feature> others,
            std::span<const std::uint16_t> distances,
            std::size_t first,
            std::size_t step) {
    int best = -1;
    int least = kNone;
    for (std::size_t i = 0; i < others.size(); ++i) {
        const int d = distances[first + i * step];
        if (d >= least) continue;
        least = d;
        best = static_cast<int>(i);
    }
    if (best < 0 || least > config.max_distance) return -1;
    const Eigen::Vector2f at_px = others[static_cast<std::size_t>(best)].pixel_px.head<2>();
    const auto elsewhere_px = static_cast<float>(config.elsewhere_px);
    for (std::size_t i = 0; i < others.size(); ++i) {
        const int d = distances[first + i * step];
        if (static_cast<double>(least) < config.ratio * static_cast<double>(d)) continue;
        const Eigen::Vector2f away_px = others[i].pixel_px.head<2>() - at_px;
        if (away_px.squaredNorm() > elsewhere_px * elsewhere_px) return -1;
    }
    return best;
}

}  // namespace

std::vector<FeatureMatch> match_features(const MatchConfig& config,
                                         std::span<const Feature> candidate,
                                         std::span<const Feature> query) {
    const std::size_t columns = query.size();
    std::vector<std::uint16_t> distances(candidate.size() * columns);
    for (std::size_t i = 0; i < candidate.size(); ++i)
        for (std::size_t k = 0; k < columns; ++k)
            distances[i * columns + k] =
                static_cast<std::uint16_t>(distance(candidate[i].descriptor, query[k].descriptor));
    std::vector<FeatureMatch> matches;
    for (std::size_t i = 0; i < candidate.size(); ++i) {
        const int k = best_of(config, query, distances, i * columns, 1);
        if (k < 0) continue;
        const int back =
            best_of(config, candidate, distances, static_cast<std::size_t>(k), columns);
        if (back == static_cast<int>(i)) matches.push_back({static_cast<int>(i), k});
    }
    return matches;
}

}  // namespace surefoot::place_recognition
