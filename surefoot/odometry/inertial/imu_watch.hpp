// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "surefoot/core/frame.hpp"
#include "surefoot/odometry/inertial/imu_preintegration.hpp"

namespace surefoot::odometry {

/// Does the IMU deliver what its own rate promises? A frame lacks samples when more than four of
/// the stream's usual periods (the median of the last ones) went by without one, or when its
/// readings cannot be integrated for whatever reason. One such frame is an accident of delivery;
/// `gap` says that the second in a row has come. An IMU that never brought a sample has no gap.
class ImuWatch {
  public:
    /// Samples may come this much after the frame that they belong to.
    explicit ImuWatch(double late_s);

    /// Takes samples in the order in which they come.
    void listen(std::span<const ImuSample> samples);
    /// A frame at `time_ns` has all the samples that it gets; what came of integrating them.
    void finish(std::int64_t time_ns, ImuProblem problem);
    [[nodiscard]] bool gap() const noexcept;

  private:
    [[nodiscard]] std::optional<std::int64_t> longest_ns() const;

    std::int64_t late_ns_ = 0;
    std::array<std::int64_t, 32> periods_ns_{};  ///< the last ones, in a ring
    std::size_t heard_periods_ = 0;
    std::optional<std::int64_t> last_ns_;  ///< stamp of the last sample
    bool hole_ = false;                    ///< before one of the samples since the last frame
    int lacking_frames_ = 0;               ///< in a row
};

}  // namespace surefoot::odometry
