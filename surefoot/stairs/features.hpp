// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace surefoot::stairs {

/// State of a feature over several observations (FeatureTracker). One map alone gives no id.
struct Tracked {
    std::uint32_t id = 0;           ///< constant while the feature is tracked; 0 = not tracked
    int observations = 1;           ///< number of observations that found the feature
    std::int64_t last_seen_ns = 0;  ///< stamp of the last observation that found the feature
    bool seen_now = true;           ///< the newest observation found the feature
    /// True if the final map of a run shows the feature without the images (`surefoot stairs` on
    /// the folder of the run). Empty = not checked.
    std::optional<bool> in_final_map = std::nullopt;

    /// A single observation may be a wrong match.
    [[nodiscard]] bool is_confirmed() const { return observations >= 2; }
};

/// A straight line at which the ground changes its height. Map frame [m].
struct Edge {
    /// Ends of the border of the upper ground. Seen along the way from `from_m` to `to_m`, the
    /// lower ground lies on the right.
    Eigen::Vector2d from_m = Eigen::Vector2d::Zero();
    Eigen::Vector2d to_m = Eigen::Vector2d::Zero();
    double upper_m = 0.0;  ///< height of the ground above the edge, at the line
    double lower_m = 0.0;  ///< height of the ground below the edge; an upper bound if not seen
    bool lower_seen = false;
    bool open = false;            ///< a board without a riser: the camera sees the ground below it
    double height_sigma_m = 0.0;  ///< one sigma of upper_m - lower_m
    double across_sigma_m = 0.0;  ///< one sigma of the line's position, across the line
    double angle_sigma_rad = 0.0;
    /// Depth of the level ground on each side, until it falls, rises or becomes unknown.
    double upper_depth_m = 0.0;
    double lower_depth_m = 0.0;
    /// Natural logarithm of the likelihood ratio "step" over "smooth ground", last observation
    /// (StepEvidenceFinder). NaN = the lower ground is not seen, or too little ground is known.
    double log_step_ratio = std::numeric_limits<double>::quiet_NaN();
    bool hidden = false;  ///< true: the falling ground between both sides is not seen

    bool upper_walkable = false;  ///< the stance reaches the upper side without a step
    bool lower_walkable = false;
    Tracked tracked;

    [[nodiscard]] double height_m() const { return upper_m - lower_m; }
    [[nodiscard]] double length_m() const { return (to_m - from_m).norm(); }
    [[nodiscard]] Eigen::Vector2d middle_m() const { return 0.5 * (from_m + to_m); }
    /// Unit vector along the edge.
    [[nodiscard]] Eigen::Vector2d along() const { return (to_m - from_m).normalized(); }
    /// Unit vector that points to the lower ground.
    [[nodiscard]] Eigen::Vector2d down() const {
        const Eigen::Vector2d a = along();
        return {a.y(), -a.x()};
    }
    /// Distance of a point from the edge; positive on the lower side.
    [[nodiscard]] double below_m(const Eigen::Vector2d& point_m) const {
        return (point_m - from_m).dot(down());
    }
};

/// Pose of a feature: its middle, the height of the ground before it, the direction across it.
struct FeaturePose {
    Eigen::Vector3d p_m = Eigen::Vector3d::Zero();
    double yaw_rad = 0.0;
};

/// A feature that consists of one line: a drop, a kerb or a door sill.
struct LineFeature {
    FeaturePose pose;       ///< yaw = direction of crossing; z = ground before the feature
    double height_m = 0.0;  ///< height behind minus height before; for a sill: its own height
    double length_m = 0.0;
    double sigma_m = 0.0;         ///< one sigma of the height
    double across_sigma_m = 0.0;  ///< one sigma of the position along the yaw
    bool bottom_seen = true;      ///< false: `height_m` is a bound, the ground may be deeper
    double log_step_ratio = std::numeric_limits<double>::quiet_NaN();  ///< see Edge::log_step_ratio
    Tracked tracked;  ///< drops and kerbs: the state of their edge
};

/// The line feature of an edge that is crossed downward (`goes_down`) or upward.
[[nodiscard]] LineFeature line_feature(const Edge& edge, bool goes_down);

enum class FlightKind : std::uint8_t { up, down };

/// The kind of ground beside the steps of a flight.
enum class SideKind : std::uint8_t { unknown, wall, level, open };

/// Returns the name in stairs.json, for example "wall".
[[nodiscard]] const char* to_string(SideKind kind);

struct FlightSide {
    SideKind kind = SideKind::unknown;
    double rail_m = 0.0;  ///< height of a rail above the nosing line; 0 = none seen
};

/// Consecutive steps, as seen from the stance.
struct Flight {
    FlightKind kind = FlightKind::up;
    /// Middle of the first edge; z = ground before it; yaw = direction of travel along the flight.
    FeaturePose pose;
    int steps = 0;                ///< number of risers
    double riser_m = 0.0;         ///< mean height of the risers
    double riser_sigma_m = 0.0;   ///< one sigma of `riser_m`
    double riser_spread_m = 0.0;  ///< standard deviation of single risers; 0 for one step
    /// Mean distance from nosing to nosing. Its value, sigma and spread are NaN for a single step.
    double going_m = 0.0;
    double going_sigma_m = 0.0;
    double going_spread_m = 0.0;
    double width_m = 0.0;
    double landing_m = 0.0;  ///< length of the known level ground behind the last edge
    /// The edges of the flight, in order from the stance.
    std::vector<Edge> edges;
    double turn_rad = 0.0;  ///< change of direction from the first edge to the last (spiral)
    bool cut = false;       ///< the flight may continue beyond the known ground
    bool open = false;      ///< boards without risers, found at half of the steps or more
    FlightSide left;        ///< left side, seen from the stance in the direction of travel
    FlightSide right;
    Tracked tracked;
};

/// An opening between two walls; the ground leads through it.
struct Door {
    FeaturePose pose;  ///< middle of the opening; z = ground before it; yaw = direction through it
    double width_m = 0.0;
    double width_sigma_m = 0.0;
    double sill_m = 0.0;  ///< height of the sill above the ground before the opening; 0 = none
    double sill_sigma_m = 0.0;
    double clearance_m = 0.0;  ///< smallest free height; NaN = nothing seen overhead
    Tracked tracked;
};

/// All features of one map.
struct TerrainFeatures {
    std::vector<Edge> edges;
    std::vector<LineFeature> drops;
    std::vector<LineFeature> kerbs;
    std::vector<LineFeature> sills;
    std::vector<Flight> flights;
    std::vector<Door> doors;
    std::int64_t time_ns = 0;  ///< stamp of the last observation; 0 = not tracked
};

}  // namespace surefoot::stairs
