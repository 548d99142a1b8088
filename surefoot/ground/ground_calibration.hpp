// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>

#include "surefoot/core/pose.hpp"
#include "surefoot/ground/ground_config.hpp"
#include "surefoot/ground/ground_observation.hpp"

namespace surefoot::ground {

/// Why the average is accepted or not.
enum class CalibrationReason : std::uint8_t {
    accepted,
    no_observation,  ///< no accepted sighting yet
    too_few,         ///< fewer accepted sightings than must agree
    disagreement,    ///< too few of them, or not the majority, agree
};
[[nodiscard]] const char* to_string(CalibrationReason reason) noexcept;

/// How the body stands over the ground. Values are those of the largest agreeing group even when it
/// is not accepted (defaults with no_observation).
struct GroundAlignment {
    bool accepted = false;
    CalibrationReason reason = CalibrationReason::no_observation;
    int agreeing = 0;  ///< sightings averaged
    int rejected = 0;  ///< sightings in the window that disagree with them
    Eigen::Vector3d normal_body = Eigen::Vector3d::UnitZ();  ///< unit, up
    double tilt_rad = 0.0;  ///< between the normal and the body's z axis
    double height_m = 0.0;  ///< of the body's origin above the plane
    /// Of `normal_body` and `height_m`: what the sightings state on the average, and how they
    /// scatter. More of them do not make it smaller: errors of a calibration and of matching are
    /// the same in all images of one place.
    PlaneUncertainty uncertainty;
    /// Frame "ground": z along the normal, origin at the foot of the perpendicular from the body's
    /// origin, turned from the body by the tilt alone (no yaw).
    Pose T_ground_body;
};

/// Shortest rotation that takes `normal_body` (unit) to z: axis = cross product, angle = arc cosine
/// of the dot product (thesis eq. 4.1), without the arc cosine.
[[nodiscard]] Eigen::Quaterniond tilt_rotation(const Eigen::Vector3d& normal_body);

/// Averages the last sightings of the ground: tilt after Markley et al. 2007, height as the mean. A
/// single sighting that disagrees with the others (an over-exposed image, a table top) is left out,
/// and the group of agreeing ones must be the majority. Feed it every sighting: the window moves
/// on, so it can be asked at any time whether the mounting still fits.
class GroundCalibration {
  public:
    explicit GroundCalibration(const GroundConfig& config) : config_(config) {}

    /// Sightings that are not accepted are ignored.
    void add(const GroundSighting& sighting_body);
    void clear() { window_.clear(); }
    [[nodiscard]] GroundAlignment alignment() const;

  private:
    [[nodiscard]] bool agree(const GroundSighting& a, const GroundSighting& b) const;

    GroundConfig config_;
    std::deque<GroundSighting> window_;
};

}  // namespace surefoot::ground
