// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/maps/thesis_policy.hpp"

#include <cmath>

#include "surefoot/grid/whole_cells.hpp"

namespace surefoot::eval {

ThesisAnswer thesis_policy(const ThesisPolicy& policy,
                           const traversability::FootprintPose& target,
                           const grid::GridGeometry& geometry,
                           ImageView<const float> rating) {
    const double side_m = geometry.resolution_m;
    const double reach_m = 0.5 * std::hypot(policy.length_m, policy.width_m);
    const auto index = [&](double at_m, double origin_m) {
        return grid::whole_cells(std::floor((at_m - origin_m) / side_m));
    };
    const double c = std::cos(target.yaw_rad);
    const double s = std::sin(target.yaw_rad);
    ThesisAnswer answer;
    double sum = 0.0;
    for (int iy = index(target.y_m - reach_m, geometry.origin_m.y());
         iy <= index(target.y_m + reach_m, geometry.origin_m.y());
         ++iy) {
        for (int ix = index(target.x_m - reach_m, geometry.origin_m.x());
             ix <= index(target.x_m + reach_m, geometry.origin_m.x());
             ++ix) {
            const Eigen::Vector2d d =
                geometry.center_m({ix, iy}) - Eigen::Vector2d(target.x_m, target.y_m);
            if (std::abs(c * d.x() + s * d.y()) > 0.5 * policy.length_m ||
                std::abs(c * d.y() - s * d.x()) > 0.5 * policy.width_m)
                continue;
            const bool mapped = geometry.contains({ix, iy}) && !std::isnan(rating.at(ix, iy));
            sum += mapped ? static_cast<double>(rating.at(ix, iy)) : policy.unmapped;
            ++answer.cells;
            answer.unmapped += mapped ? 0 : 1;
        }
    }
    if (answer.cells == 0) return answer;
    answer.mean = sum / answer.cells;
    answer.allowed = answer.mean >= policy.safe_mean;
    return answer;
}

}  // namespace surefoot::eval
