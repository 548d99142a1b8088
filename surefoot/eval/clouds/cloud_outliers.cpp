// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/clouds/cloud_outliers.hpp"

#include <cmath>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/pieces.hpp"

namespace surefoot::eval {
namespace {

constexpr std::size_t kTaken = 1U << 13U;  ///< points in one task of a thread

}  // namespace

OutlierFilter::OutlierFilter(geometry::KdTree cloud,
                             const OutlierConfig& config,
                             Executor& executor)
    : cloud_(std::move(cloud)), to_neighbours_m_(cloud_.points_m().size()) {
    SUREFOOT_ASSERT(config.others > 0 && config.sigmas >= 0.0);
    const auto points_m = cloud_.points_m();
    in_pieces(points_m.size(), kTaken, executor, [&](std::size_t begin, std::size_t end, auto) {
        std::vector<geometry::Neighbour> found(static_cast<std::size_t>(config.others) + 1);
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t count = cloud_.nearest(points_m[i], found);
            double sum_m = 0.0;  // the point itself is found too, at distance 0
            for (std::size_t k = 0; k < count; ++k)
                sum_m += std::sqrt(static_cast<double>(found[k].sq_distance_m2));
            to_neighbours_m_[i] =
                count > 1 ? static_cast<float>(sum_m / static_cast<double>(count - 1)) : 0.0F;
        }
    });
    if (points_m.empty()) return;
    const auto n = static_cast<double>(points_m.size());
    for (const float d_m : to_neighbours_m_) mean_m_ += static_cast<double>(d_m) / n;
    double scatter_m2 = 0.0;
    for (const float d_m : to_neighbours_m_) {
        const double off_m = static_cast<double>(d_m) - mean_m_;
        scatter_m2 += off_m * off_m;
    }
    std_m_ = std::sqrt(scatter_m2 / n);
    limit_m_ = mean_m_ + config.sigmas * std_m_;
}

bool OutlierFilter::keeps(const Eigen::Vector3f& point_m) const {
    const std::uint32_t index = cloud_.find(point_m);
    return index != geometry::Neighbour::kNone &&
           static_cast<double>(to_neighbours_m_[index]) <= limit_m_;
}

}  // namespace surefoot::eval
