// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "surefoot/core/frame.hpp"
#include "surefoot/odometry/inertial/imu_preintegration.hpp"

namespace surefoot::odometry {

/// Checks whether the IMU delivers samples at its usual rate. A frame lacks samples if its readings
/// cannot be integrated, or if no sample comes for four usual periods (median of the last periods).
/// One such frame may be a late delivery, so `gap` needs two of them in a row. An IMU that never
/// delivered a sample has no gap.
class ImuWatch {
  public:
    /// `late_s`: samples may arrive this much later than their frame.
    explicit ImuWatch(double late_s);

    /// Takes samples in the order of their arrival.
    void listen(std::span<const ImuSample> samples);
    /// Call after the samples of a frame, with its stamp and the result of their integration.
    void finish(std::int64_t time_ns, ImuProblem problem);
    [[nodiscard]] bool gap() const noexcept;

  private:
    [[nodiscard]] std::optional<std::int64_t> longest_ns() const;

    std::int64_t late_ns_ = 0;
    std::array<std::int64_t, 32> periods_ns_{};  ///< the last periods, in a ring
    std::size_t heard_periods_ = 0;
    std::optional<std::int64_t> last_ns_;  ///< stamp of the last sample
    bool hole_ = false;                    ///< a sample since the last frame came after a gap
    int lacking_frames_ = 0;               ///< number of consecutive frames that lack samples
};

}  // namespace surefoot::odometry
