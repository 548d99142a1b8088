// SPDX-License-Identifier: Apache-2.0
#include "surefoot/place_recognition/view_comparison.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/odometry/visual/pose_solver.hpp"

namespace surefoot::place_recognition {
namespace {

using odometry::PointMatch;
using odometry::PoseSolution;
using odometry::StereoPixel;

constexpr std::uint64_t kSeed = 1;  ///< fixed, so that the same views always give the same pose
constexpr int kBorder_px = 32;  ///< `describe` finds no features nearer than 31 px to the border

StereoPixel pixel_of(const Feature& feature) {
    return feature.pixel_px.cast<double>();
}

PointMatch point_match(const ComparisonConfig& config,
                       const View& candidate,
                       const View& query,
                       const FeatureMatch& match) {
    const StereoPixel there =
        pixel_of(candidate.features[static_cast<std::size_t>(match.candidate)]);
    PointMatch point;
    point.p_world_m = odometry::triangulate(candidate.rig, there);
    point.covariance_m2 = odometry::point_covariance(candidate.rig, there, config.sigma_px);
    point.pixel_px = pixel_of(query.features[static_cast<std::size_t>(match.query)]);
    return point;
}

std::vector<PointMatch> point_matches(const ComparisonConfig& config,
                                      const View& candidate,
                                      const View& query,
                                      const std::vector<FeatureMatch>& matches) {
    std::vector<PointMatch> points;
    points.reserve(matches.size());
    for (const FeatureMatch& match : matches)
        points.push_back(point_match(config, candidate, query, match));
    return points;
}

/// Result of a search for the features of one view in the other view.
struct Answers {
    std::vector<int> who;                ///< checked features
    std::vector<FeatureMatch> agreeing;  ///< (checked feature, found feature)
    std::vector<int> asked;              ///< number of checked features per part of the other image
    std::vector<int> found;
};

/// Returns the index of the feature with the most similar descriptor near `pixel`, or -1.
int find_at(const ComparisonConfig& config,
            const std::vector<Feature>& features,
            const StereoPixel& pixel,
            const Descriptor& descriptor) {
    int best = -1;
    int least = config.max_distance + 1;
    for (std::size_t i = 0; i < features.size(); ++i) {
        const StereoPixel off_px = pixel_of(features[i]) - pixel;
        if (std::abs(off_px.x()) > config.search_px || std::abs(off_px.y()) > config.search_px)
            continue;
        if (std::abs(off_px.x() - off_px.z()) > config.disparity_px) continue;
        const int d = distance(features[i].descriptor, descriptor);
        if (d >= least) continue;
        least = d;
        best = static_cast<int>(i);
    }
    return best;
}

int part_of(const ComparisonConfig& config,
            const camera::RectifiedRig& rig,
            const StereoPixel& pixel) {
    const int u = clamped_integer<int>(pixel.x(), 0, rig.width - 1);
    const int v = clamped_integer<int>(pixel.y(), 0, rig.height - 1);
    const int column = u * config.part_columns / rig.width;
    const int row = v * config.part_rows / rig.height;
    return row * config.part_columns + column;
}

Answers ask(const ComparisonConfig& config,
            const View& asked,
            const View& shown,
            const Pose& T_shown_asked) {
    Answers answers;
    const auto parts = static_cast<std::size_t>(config.part_columns * config.part_rows);
    answers.asked.assign(parts, 0);
    answers.found.assign(parts, 0);
    for (std::size_t i = 0; i < asked.features.size(); ++i) {
        const Eigen::Vector3d p_asked =
            odometry::triangulate(asked.rig, pixel_of(asked.features[i]));
        const Eigen::Vector3d p = T_shown_asked * p_asked;
        const double scale =
            p.z() * asked.rig.fx_px / std::max(1e-9, p_asked.z() * shown.rig.fx_px);
        if (p.z() <= 0.0 || scale < config.min_scale || scale > 1.0 / config.min_scale) continue;
        const StereoPixel pixel = odometry::project_stereo(shown.rig, p);
        if (pixel.x() < kBorder_px || pixel.x() >= shown.rig.width - kBorder_px ||
            pixel.y() < kBorder_px || pixel.y() >= shown.rig.height - kBorder_px)
            continue;
        const auto part = static_cast<std::size_t>(part_of(config, shown.rig, pixel));
        ++answers.asked[part];
        answers.who.push_back(static_cast<int>(i));
        const int found = find_at(config, shown.features, pixel, asked.features[i].descriptor);
        if (found < 0) continue;
        ++answers.found[part];
        answers.agreeing.push_back({static_cast<int>(i), found});
    }
    return answers;
}

void judge_parts(const ComparisonConfig& config, const Answers& answers, Comparison& out) {
    for (std::size_t part = 0; part < answers.asked.size(); ++part) {
        out.asked += answers.asked[part];
        out.agreeing += answers.found[part];
        if (answers.asked[part] < config.min_asked) continue;
        ++out.parts;
        if (answers.found[part] < config.min_agreeing * answers.asked[part]) ++out.parts_against;
    }
}

/// A level surface in the candidate's camera frame.
struct Level {
    Eigen::Vector3d up;     ///< unit vector
    double height_m = 0.0;  ///< height above the camera

    /// True if a point can lie on this surface, within the uncertainty of the point's disparity.
    [[nodiscard]] bool holds(const ComparisonConfig& config,
                             const Eigen::Vector3d& p_m,
                             double point_disparity_px) const {
        const double off_m = up.dot(p_m) - height_m;
        // An error of `disparity_px` moves a point along its ray by this share of its range.
        const double share = config.disparity_px / point_disparity_px;
        return std::abs(off_m) <= share * std::abs(up.dot(p_m)) + config.level_m;
    }
};

/// Returns the level surface that contains the most inliers of the pose.
Level floor_of(const ComparisonConfig& config,
               const camera::RectifiedRig& rig,
               const std::vector<PointMatch>& points,
               const PoseSolution& solution,
               const Eigen::Vector3d& up_camera) {
    Level best{up_camera};
    int most = -1;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (solution.inlier[i] == 0) continue;
        const Level level{up_camera, up_camera.dot(points[i].p_world_m)};
        int held = 0;
        for (std::size_t k = 0; k < points.size(); ++k) {
            const Eigen::Vector3d& p_m = points[k].p_world_m;
            if (solution.inlier[k] != 0 &&
                level.holds(config, p_m, rig.depth_to_disparity_px_m() / p_m.z()))
                ++held;
        }
        if (held <= most) continue;
        most = held;
        best = level;
    }
    return best;
}

/// Counts the checked features of a view that do not lie on the floor.
void judge_off_floor(const ComparisonConfig& config,
                     const Level& floor,
                     const View& view,
                     const Pose& T_candidate_view,
                     const Answers& answers,
                     Comparison& out) {
    const auto off_floor = [&](int number) {
        const StereoPixel pixel = pixel_of(view.features[static_cast<std::size_t>(number)]);
        const Eigen::Vector3d p_m = T_candidate_view * odometry::triangulate(view.rig, pixel);
        return !floor.holds(config, p_m, odometry::disparity_px(pixel));
    };
    out.asked_off_floor +=
        static_cast<int>(std::count_if(answers.who.begin(), answers.who.end(), off_floor));
    out.agreeing_off_floor += static_cast<int>(std::count_if(
        answers.agreeing.begin(), answers.agreeing.end(), [&](const FeatureMatch& match) {
            return off_floor(match.candidate);
        }));
}

/// True if enough features off the floor agree. Features outside the other image do not count.
bool more_than_a_floor(const ComparisonConfig& config, const Comparison& found) {
    return found.asked_off_floor >= config.min_asked_off_floor &&
           found.agreeing_off_floor >= config.min_agreeing_off_floor * found.asked_off_floor;
}

int parts_with_inliers(const ComparisonConfig& config,
                       const View& query,
                       const std::vector<PointMatch>& points,
                       const PoseSolution& solution) {
    std::vector<bool> holds(static_cast<std::size_t>(config.part_columns * config.part_rows));
    for (std::size_t i = 0; i < points.size(); ++i)
        if (solution.inlier[i] != 0)
            // in range: part_of() gives a whole number
            holds[static_cast<std::size_t>(part_of(config, query.rig, points[i].pixel_px))] = true;
    return static_cast<int>(std::count(holds.begin(), holds.end(), true));
}

bool is_precise(const ComparisonConfig& config, const Matrix6& covariance) {
    const double sigma_m = std::sqrt(covariance.diagonal().head<3>().maxCoeff());
    const double sigma_deg = kDegPerRad * std::sqrt(covariance.diagonal().tail<3>().maxCoeff());
    return sigma_m <= config.max_sigma_m && sigma_deg <= config.max_sigma_deg;
}

}  // namespace

Comparison compare(const ComparisonConfig& config,
                   const View& candidate,
                   const Eigen::Vector3d& up_candidate,
                   const View& query,
                   const Eigen::Vector3d& up_query) {
    Comparison out;
    const auto matches = match_features(config.matching, candidate.features, query.features);
    out.matches = static_cast<int>(matches.size());
    if (out.matches < config.min_matches) return out;

    odometry::PoseSolverConfig solver;
    solver.sigma_px = config.sigma_px;
    solver.ransac_rounds = config.ransac_rounds;
    solver.ransac_threshold_px = config.ransac_threshold_px;
    auto points = point_matches(config, candidate, query, matches);
    const auto found = odometry::find_pose(query.rig, solver, points, Pose{}, Rng(kSeed));
    auto solution = odometry::refine_pose(query.rig, solver, points, found.T_world_camera);
    out.refusal = Refusal::few_inliers;
    if (!found.found || !solution.found || solution.inliers < config.min_matches) {
        out.inliers = solution.inliers;
        return out;
    }
    // The pose predicts where each corner should be. A search there finds far more corners than the
    // descriptors alone.
    const auto guided = ask(config, candidate, query, solution.T_world_camera.inverse()).agreeing;
    points = point_matches(config, candidate, query, guided);
    solution = odometry::refine_pose(query.rig, solver, points, solution.T_world_camera);
    out.inliers = solution.inliers;
    if (!solution.found || out.inliers < config.min_inliers) return out;

    const Pose& T_candidate_query = solution.T_world_camera;  // pose between the cameras
    out.T_candidate_query =
        candidate.rig.T_body_camera * T_candidate_query * query.rig.T_body_camera.inverse();
    out.covariance =
        odometry::camera_to_body_covariance(solution.covariance, query.rig.T_body_camera);
    const Answers of_candidate = ask(config, candidate, query, T_candidate_query.inverse());
    const Answers of_query = ask(config, query, candidate, T_candidate_query);
    judge_parts(config, of_candidate, out);
    judge_parts(config, of_query, out);
    const Level floor = floor_of(config,
                                 candidate.rig,
                                 points,
                                 solution,
                                 candidate.rig.T_body_camera.rotation.conjugate() * up_candidate);
    judge_off_floor(config, floor, candidate, Pose{}, of_candidate, out);
    judge_off_floor(config, floor, query, T_candidate_query, of_query, out);
    out.tilt_deg =
        kDegPerRad * std::acos(std::clamp(
                         up_candidate.dot(out.T_candidate_query.rotation * up_query), -1.0, 1.0));
    if (parts_with_inliers(config, query, points, solution) < config.min_parts)
        out.refusal = Refusal::poor_spread;
    else if (!is_precise(config, out.covariance))
        out.refusal = Refusal::imprecise;
    else if (!(out.tilt_deg <= config.max_tilt_deg))
        out.refusal = Refusal::tilted;
    else if (out.agreeing_share() < config.min_agreeing_all ||
             out.parts_against > config.max_parts_against * out.parts)
        out.refusal = Refusal::contradicted;
    else if (!more_than_a_floor(config, out))
        out.refusal = Refusal::floor_only;
    else
        out.refusal = Refusal::none;
    return out;
}

}  // namespace surefoot::place_recognition
