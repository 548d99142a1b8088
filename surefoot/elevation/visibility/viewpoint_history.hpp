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
    double min_translation_m = 0.005;  ///< closer viewpoints repeat the matcher's errors
    double min_rotation_deg = 0.5;
    void describe(ConfigVisitor& visitor);
};

/// Remembers the viewpoints from which the ground was observed, so that a standing camera does not
/// count the same error many times as independent evidence. Poses closer than a quarter of the
/// limits share an entry, so the limits are not exact. Beyond 1024 entries (at least 1.2 m of
/// straight travel with the defaults) the oldest entries are dropped and count as far away. No
/// allocation after construction.
class ViewpointHistory {
  public:
    using Id = std::uint32_t;
    /// Id that stands for no viewpoint. Every pose differs from it.
    static constexpr Id kNever = 0;

    explicit ViewpointHistory(const ViewpointConfig& config);
    /// Sets the pose as the present viewpoint and returns its id. Ids never decrease.
    Id look_from(const Pose& T_odom_body);
    /// True if the present viewpoint differs from viewpoint `id` by at least a limit of the config.
    [[nodiscard]] bool is_new_since(Id id) const;

  private:
    [[nodiscard]] bool apart(const Pose& a, const Pose& b, double share) const;

    ViewpointConfig config_;
    std::vector<Pose> poses_;            ///< ring buffer; index of an id: id % size
    std::vector<std::uint8_t> is_near_;  ///< by ring position: 1 = too close to the present view
    Id newest_ = kNever;
};

}  // namespace surefoot::elevation
