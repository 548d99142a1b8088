// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>

#include "surefoot/core/pose.hpp"
#include "surefoot/ground/ground_config.hpp"
#include "surefoot/ground/ground_observation.hpp"

namespace surefoot::ground {

/// Result of the calibration: accepted, or the reason why not.
enum class CalibrationReason : std::uint8_t {
    accepted,
    no_observation,  ///< no accepted observation yet
    too_few,         ///< fewer accepted observations than must agree
    disagreement,    ///< too few observations agree, or no majority
};
[[nodiscard]] const char* to_string(CalibrationReason reason) noexcept;

/// Orientation and height of the body above the ground. The values describe the largest agreeing
/// group, even if it is not accepted (defaults with no_observation).
struct GroundAlignment {
    bool accepted = false;
    CalibrationReason reason = CalibrationReason::no_observation;
    int agreeing = 0;  ///< number of observations averaged
    int rejected = 0;  ///< observations in the window that disagree with the average
    Eigen::Vector3d normal_body = Eigen::Vector3d::UnitZ();  ///< unit, points up
    double tilt_rad = 0.0;  ///< angle between the normal and the body's z axis
    double height_m = 0.0;  ///< height of the body's origin above the plane
    /// Uncertainty of `normal_body` and `height_m`: the mean of the observations' uncertainty plus
    /// their scatter. More observations do not reduce it, because errors of calibration and
    /// matching are the same in all images from one position.
    PlaneUncertainty uncertainty;
    /// Frame "ground": z along the normal, origin at the foot of the perpendicular from the body's
    /// origin, rotated from the body by the tilt only (no yaw).
    Pose T_ground_body;
};

/// Shortest rotation from `normal_body` (unit) to z: its axis is the cross product, its angle the
/// arc cosine of the dot product (Lange 2016, eq. 4.1). Computed without the arc cosine.
[[nodiscard]] Eigen::Quaterniond tilt_rotation(const Eigen::Vector3d& normal_body);

/// Averages the last observations of the ground: tilt after Markley et al. 2007, height as the
/// mean. A single observation that disagrees (over-exposed image, table top) is left out. The
/// agreeing observations must be the majority. Add every observation: the window moves on, so
/// `alignment` shows at any time whether the mounting is still correct.
class GroundCalibration {
  public:
    explicit GroundCalibration(const GroundConfig& config) : config_(config) {}

    /// Adds an observation; ignores it if it is not accepted.
    void add(const GroundSighting& sighting_body);
    void clear() { window_.clear(); }
    [[nodiscard]] GroundAlignment alignment() const;

  private:
    [[nodiscard]] bool agree(const GroundSighting& a, const GroundSighting& b) const;

    GroundConfig config_;
    std::deque<GroundSighting> window_;
};

}  // namespace surefoot::ground
