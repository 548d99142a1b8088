// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/core/pose.hpp"

namespace surefoot::elevation {

struct ViewpointConfig {
    double min_translation_m = 0.005;  ///< nearer views repeat the matcher's errors
    double min_rotation_deg = 0.5;
    void describe(ConfigVisitor& visitor);
};

/// Remembers from where the ground was seen, so that a camera that stands still does not count the
/// same error many times as independent evidence. Poses closer than a quarter of the limits share
/// an entry, which is how exact the limits are kept. Beyond 1024 entries (at least 1.2 m of way
/// with the defaults) the oldest are forgotten and count as far away. No allocation after
/// construction.
class ViewpointHistory {
  public:
    using Id = std::uint32_t;
    /// No view: differs from every pose.
    static constexpr Id kNever = 0;

    explicit ViewpointHistory(const ViewpointConfig& config);
    /// Takes the pose as the present view and returns its id; ids grow.
    Id look_from(const Pose& T_odom_body);
    /// Whether the present view is farther from the view `id` than the limits: new information.
    [[nodiscard]] bool is_new_since(Id id) const;

  private:
    [[nodiscard]] bool apart(const Pose& a, const Pose& b, double share) const;

    ViewpointConfig config_;
    std::vector<Pose> poses_;            ///< ring, entry of id at id % size
    std::vector<std::uint8_t> is_near_;  ///< by ring position: too close to the present view
    Id newest_ = kNever;
};

}  // namespace surefoot::elevation
