// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/inertial/imu_watch.hpp"

#include <algorithm>

#include "surefoot/core/time.hpp"

namespace surefoot::odometry {
namespace {

/// A pause longer than this number of usual periods is a gap. Half the usual rate (pauses of 2
/// periods) and a jitter of two periods (pauses of 3 periods) are not gaps.
constexpr std::int64_t kGapPeriods = 4;
constexpr std::size_t kLeastPeriods = 8;  ///< with fewer periods the rate is unknown
constexpr int kLackingFrames = 2;

}  // namespace

ImuWatch::ImuWatch(double late_s) : late_ns_(ns_from_seconds(late_s)) {}

void ImuWatch::listen(std::span<const ImuSample> samples) {
    const std::optional<std::int64_t> longest = longest_ns();
    for (const ImuSample& sample : samples) {
        // Stamps that repeat or go back contain no information about the rate.
        if (last_ns_ && sample.time_ns > *last_ns_) {
            const std::int64_t period_ns = sample.time_ns - *last_ns_;
            if (longest && period_ns > *longest) hole_ = true;
            periods_ns_[heard_periods_ % periods_ns_.size()] = period_ns;
            ++heard_periods_;
        }
        last_ns_ = sample.time_ns;
    }
}

void ImuWatch::finish(std::int64_t time_ns, ImuProblem problem) {
    const std::optional<std::int64_t> longest = longest_ns();
    const bool silent = longest && time_ns - *last_ns_ > std::max(*longest, late_ns_);
    const bool lacks = last_ns_ && (hole_ || silent || problem != ImuProblem::none);
    lacking_frames_ = lacks ? std::min(lacking_frames_ + 1, kLackingFrames) : 0;
    hole_ = false;
}

bool ImuWatch::gap() const noexcept {
    return lacking_frames_ >= kLackingFrames;
}

/// Longest time without a sample that still counts as normal; nothing while the rate is unknown.
std::optional<std::int64_t> ImuWatch::longest_ns() const {
    if (heard_periods_ < kLeastPeriods) return std::nullopt;
    auto periods_ns = periods_ns_;
    const auto end = periods_ns.begin() +
                     static_cast<std::ptrdiff_t>(std::min(heard_periods_, periods_ns.size()));
    const auto middle = periods_ns.begin() + (end - periods_ns.begin()) / 2;
    std::nth_element(periods_ns.begin(), middle, end);
    return kGapPeriods * *middle;
}

}  // namespace surefoot::odometry
