// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/pose.hpp"

namespace surefoot::place_recognition {

/// Descriptor of a corner's surroundings: 256 comparisons of two grey values each.
struct Descriptor {
    std::array<std::uint64_t, 4> bits{};
    friend bool operator==(const Descriptor&, const Descriptor&) = default;
};

/// Hamming distance: the number of comparisons that differ, 0 to 256; about 128 by chance. A query
/// spends most of its time here. The function is inline and uses no population-count instruction,
/// because not all processors have it. Method: Warren, Hacker's Delight, chapter 5.
[[nodiscard]] inline int distance(const Descriptor& a, const Descriptor& b) noexcept {
    constexpr std::uint64_t kPairs = 0x5555555555555555ULL;
    constexpr std::uint64_t kNibbles = 0x3333333333333333ULL;
    constexpr std::uint64_t kBytes = 0x0f0f0f0f0f0f0f0fULL;
    constexpr std::uint64_t kWords = 0x00ff00ff00ff00ffULL;
    std::uint64_t bytes = 0;  // eight sums, one per byte, at most 32 each
    for (std::size_t i = 0; i < 4; ++i) {
        std::uint64_t x = a.bits[i] ^ b.bits[i];
        x -= x >> 1U & kPairs;
        x = (x & kNibbles) + (x >> 2U & kNibbles);
        bytes += (x + (x >> 4U)) & kBytes;
    }
    const std::uint64_t words = (bytes & kWords) + (bytes >> 8U & kWords);
    return static_cast<int>(words * 0x0001000100010001ULL >> 48U);
}

/// A corner with depth.
struct Feature {
    /// Position (u_left, v, u_right) in rectified pixels, as in `odometry::StereoPixel`.
    Eigen::Vector3f pixel_px = Eigen::Vector3f::Zero();
    Descriptor descriptor;
};

/// Features that a rig saw at one instant.
struct View {
    std::int64_t time_ns = 0;
    camera::RectifiedRig rig;
    std::vector<Feature> features;
};

/// A view with the pose of base_link. The map frame has z up, so that gravity can be compared.
struct Keyframe {
    View view;
    Pose T_map_body;
};

/// Stored keyframes of a place (home, clinic). The map frame is the odom of its first run.
struct Place {
    std::vector<Keyframe> keyframes;

    /// Returns the first reason why the place is invalid, with the value; or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
};

/// Limits of a place. They also bound the time of a query.
inline constexpr int kMostKeyframes = 500;
inline constexpr int kMostFeatures = 400;  ///< features per view
inline constexpr double kMostImage_px = 16384.0;
inline constexpr double kMostDistance_m = 1e4;  ///< largest |x|, |y| or |z| of a pose

}  // namespace surefoot::place_recognition
