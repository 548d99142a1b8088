// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/ground_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "surefoot/geometry/quaternion_mean.hpp"

namespace surefoot::ground {

const char* to_string(CalibrationReason reason) noexcept {
    switch (reason) {
        case CalibrationReason::accepted: return "accepted";
        case CalibrationReason::no_observation: return "no_observation";
        case CalibrationReason::too_few: return "too_few";
        case CalibrationReason::disagreement: return "disagreement";
    }
    return "unknown";
}

namespace {

PlaneUncertainty uncertainty_of(const std::vector<const GroundSighting*>& group,
                                const GroundAlignment& mean) {
    PlaneUncertainty sum;
    for (const GroundSighting* sighting : group) {
        const Eigen::Vector3d off = sighting->observation.normal - mean.normal_body;
        const double off_m = sighting->observation.height_m - mean.height_m;
        sum.normal_covariance += sighting->uncertainty.normal_covariance + off * off.transpose();
        sum.height_var_m2 += sighting->uncertainty.height_var_m2 + off_m * off_m;
    }
    const auto count = static_cast<double>(group.size());
    return {sum.normal_covariance / count, sum.height_var_m2 / count};
}

}  // namespace

Eigen::Quaterniond tilt_rotation(const Eigen::Vector3d& normal_body) {
    // The quaternion (1 + cos, axis sin) points along (cos(angle / 2), axis sin(angle / 2)).
    const Eigen::Vector3d axis = normal_body.cross(Eigen::Vector3d::UnitZ());
    const double w = 1.0 + normal_body.z();
    constexpr double kUpsideDown = 1e-12;
    if (w < kUpsideDown) return {0.0, 1.0, 0.0, 0.0};  // half a turn, about x: any axis is correct
    return Eigen::Quaterniond(w, axis.x(), axis.y(), axis.z()).normalized();
}

void GroundCalibration::add(const GroundSighting& sighting_body) {
    const GroundObservation& seen = sighting_body.observation;
    if (!seen.accepted || !seen.normal.allFinite() || !std::isfinite(seen.height_m)) return;
    window_.push_back(sighting_body);
    while (window_.size() > static_cast<std::size_t>(config_.window)) window_.pop_front();
}

bool GroundCalibration::agree(const GroundSighting& a, const GroundSighting& b) const {
    // The limit grows to two sigma of both observations, but at most to twice its value. Far and
    // rough ground is observed less precisely than the limits require. Leaving such ground out
    // would not help.
    constexpr double kSigmas = 2.0;
    const auto within = [](double off, double sigma, double limit) {
        return off <= std::clamp(kSigmas * sigma, limit, 2.0 * limit);
    };
    const Eigen::Vector3d& n = a.observation.normal;
    const Eigen::Vector3d& m = b.observation.normal;
    const double angle_rad = std::atan2(n.cross(m).norm(), n.dot(m));
    return within(angle_rad,
                  std::hypot(a.uncertainty.tilt_sigma_rad(), b.uncertainty.tilt_sigma_rad()),
                  config_.max_disagreement_deg * std::numbers::pi / 180.0) &&
           within(std::abs(a.observation.height_m - b.observation.height_m),
                  std::sqrt(a.uncertainty.height_var_m2 + b.uncertainty.height_var_m2),
                  config_.max_disagreement_m);
}

GroundAlignment GroundCalibration::alignment() const {
    GroundAlignment result;
    if (window_.empty()) return result;

    // The observation with which most others agree represents its group. The newest wins a tie.
    std::vector<const GroundSighting*> group;
    for (const auto& candidate : window_) {
        std::vector<const GroundSighting*> others;
        for (const auto& other : window_) {
            if (agree(candidate, other)) others.push_back(&other);
        }
        if (others.size() >= group.size()) group = std::move(others);
    }

    std::vector<Eigen::Quaterniond> rotations;
    for (const GroundSighting* sighting : group) {
        rotations.push_back(tilt_rotation(sighting->observation.normal));
        result.height_m += sighting->observation.height_m;
    }
    result.height_m /= static_cast<double>(group.size());
    // The mean is unique: the rotations lie within twice the allowed disagreement of each other.
    const Eigen::Quaterniond mean = geometry::quaternion_mean(rotations).value_or(rotations.back());
    result.T_ground_body = {mean, Eigen::Vector3d(0.0, 0.0, result.height_m)};
    result.normal_body = mean.conjugate() * Eigen::Vector3d::UnitZ();
    result.tilt_rad = std::atan2(result.normal_body.head<2>().norm(), result.normal_body.z());
    result.uncertainty = uncertainty_of(group, result);
    result.agreeing = static_cast<int>(group.size());
    result.rejected = static_cast<int>(window_.size() - group.size());

    if (window_.size() < static_cast<std::size_t>(config_.min_agreeing)) {
        result.reason = CalibrationReason::too_few;
    } else if (result.agreeing < config_.min_agreeing || result.agreeing <= result.rejected) {
        result.reason = CalibrationReason::disagreement;
    } else {
        result.reason = CalibrationReason::accepted;
        result.accepted = true;
    }
    return result;
}

}  // namespace surefoot::ground
