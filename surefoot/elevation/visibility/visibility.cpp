// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/visibility/visibility.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace surefoot::elevation {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Smallest distance |dx| + |dy| [cells] from the camera. Nearer cells have no useful direction.
constexpr float kNearest = 2.0F;
/// A line gives no evidence in this number of rings before its end. The surface at the end covers
/// one or two cells.
constexpr int kEndRings = 3;

}  // namespace

void VisibilityConfig::describe(ConfigVisitor& visitor) {
    visitor.boolean("cleanup", cleanup, "true: remove surfaces that lines of sight pass through");
    visitor.boolean("drops",
                    drops,
                    "true: lines of sight over an unknown cell give an upper limit for the height "
                    "of its ground");
    visitor.number("margin_m",
                   margin_m,
                   0.0,
                   10.0,
                   "a line of sight contradicts a cell if it passes more than this distance below "
                   "the cell height; sigmas times the sigma of the cell height is added");
    visitor.number("sigmas",
                   sigmas,
                   0.0,
                   100.0,
                   "number of sigmas of the cell height that are added to margin_m");
    visitor.number(
        "neighbour_s",
        neighbour_s,
        0.0,
        60.0,
        "a cell is not removed if a neighbour of equal height was confirmed within this time");
    visitor.integer("frames",
                    frames,
                    1,
                    255,
                    "number of frames with a contradicting line of sight that remove a height "
                    "confirmed by every observation");
}

void FreeSpaceRays::reset(const grid::GridGeometry& geometry, const Eigen::Vector3d& camera_m) {
    for (std::size_t quarter = 0; quarter < used_.size(); ++quarter) {
        if (!used_[quarter]) continue;
        for (int ring = 0; ring < rings_; ++ring) {
            float* row = lowest_.data() + static_cast<std::ptrdiff_t>(ring) * kDirections;
            std::fill_n(row + quarter * kQuarter, kQuarter, kInfinity);
        }
    }
    used_ = {};
    geometry_ = geometry;
    const Eigen::Vector2d corner_cells =
        (camera_m.head<2>() - geometry.origin_m) / geometry.resolution_m;
    camera_x_ = static_cast<float>(corner_cells.x());
    camera_y_ = static_cast<float>(corner_cells.y());
    camera_z_m_ = static_cast<float>(camera_m.z());
    // The table reaches to the corner that is farthest from the camera. If the camera is far
    // outside or not finite, the table is empty.
    const auto nx = static_cast<float>(geometry.nx);
    const auto ny = static_cast<float>(geometry.ny);
    const float farthest =
        std::max(camera_x_, nx - camera_x_) + std::max(camera_y_, ny - camera_y_);
    // in range: from half of nx + ny, none of them negative, to 4 (nx + ny); NaN gives 0
    rings_ = farthest <= 4.0F * (nx + ny) ? static_cast<int>(farthest) + 1 : 0;
    const auto wanted = static_cast<std::size_t>(rings_) * kDirections;
    if (lowest_.size() < wanted) lowest_.resize(wanted, kInfinity);
}

std::size_t FreeSpaceRays::quarter_of(float dx_cells, float dy_cells) noexcept {
    if (dx_cells < 0.0F) return dy_cells > 0.0F ? 1 : 2;
    return dy_cells < 0.0F ? 3 : 0;
}

FreeSpaceRays::Place FreeSpaceRays::place_of(float dx_cells, float dy_cells) const {
    const float distance = std::abs(dx_cells) + std::abs(dy_cells);
    // Direction in quarters: 0 along +x, 1 along +y, 2 along -x, 3 along -y.
    const float along = dy_cells / distance;
    float turn = 0.0F;
    if (dx_cells < 0.0F) {
        turn = 2.0F - along;
    } else {
        turn = dy_cells < 0.0F ? 4.0F + along : along;
    }
    return {turn * kQuarter, distance};
}

void FreeSpaceRays::add(grid::Cell cell, float z_m) {
    const float dx = static_cast<float>(cell.ix) + 0.5F - camera_x_;
    const float dy = static_cast<float>(cell.iy) + 0.5F - camera_y_;
    const Place place = place_of(dx, dy);
    if (!(place.distance >= kNearest && place.distance < static_cast<float>(rings_))) return;
    // in range: below rings_, as checked above
    const int ring = static_cast<int>(place.distance) - kEndRings;
    if (ring < 0) return;
    const float slope = (z_m - camera_z_m_) / place.distance;
    // Neighbouring endpoints leave no gap between their lines.
    const float half_width = 0.5F * kQuarter / place.distance;
    // One quarter is added, so the value is positive and the conversion rounds down.
    // in range: from 0.75 to 5.25 quarters, as the distance is at least kNearest
    const float around = place.direction + kQuarter;
    const int first = static_cast<int>(around - half_width) - kQuarter;  // in range: as above
    const int last = static_cast<int>(around + half_width) - kQuarter;   // in range: as above
    float* row = lowest_.data() + static_cast<std::ptrdiff_t>(ring) * kDirections;
    for (int direction = first; direction <= last; ++direction) {
        float& lowest = row[direction & (kDirections - 1)];
        lowest = std::min(lowest, slope);
    }
    // A line is narrower than a quarter, so it lies in the quarters of its two ends.
    for (const int direction : {first, last})
        used_[static_cast<std::size_t>(direction & (kDirections - 1)) / kQuarter] = true;
}

void FreeSpaceRays::finish() {
    for (int ring = rings_ - 2; ring >= 0; --ring) {
        float* here = lowest_.data() + static_cast<std::ptrdiff_t>(ring) * kDirections;
        const float* beyond = here + kDirections;
        for (std::size_t quarter = 0; quarter < used_.size(); ++quarter) {
            if (!used_[quarter]) continue;
            float* nearer = here + quarter * kQuarter;
            const float* farther = beyond + quarter * kQuarter;
            for (int i = 0; i < kQuarter; ++i) {
                nearer[i] = farther[i] < nearer[i] ? farther[i] : nearer[i];
            }
        }
    }
}

float FreeSpaceRays::lowest_over(grid::Cell cell) const {
    const float dx = static_cast<float>(cell.ix) + 0.5F - camera_x_;
    const float dy = static_cast<float>(cell.iy) + 0.5F - camera_y_;
    // A direction on the border of two quarters may belong to either quarter, so it is not skipped.
    if (!used_[quarter_of(dx, dy)] && dx != 0.0F && dy != 0.0F) return kInfinity;
    const Place place = place_of(dx, dy);
    if (!(place.distance >= kNearest && place.distance < static_cast<float>(rings_ - 1))) {
        return kInfinity;
    }
    // in range: below rings_ - 1, as checked above
    const int ring = static_cast<int>(place.distance) + 1;
    const int direction = static_cast<int>(place.direction) & (kDirections - 1);
    const float slope =
        lowest_[static_cast<std::size_t>(ring) * kDirections + static_cast<std::size_t>(direction)];
    return camera_z_m_ + slope * place.distance;
}

}  // namespace surefoot::elevation
