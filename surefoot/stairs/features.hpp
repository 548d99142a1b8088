// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace surefoot::stairs {

/// What is known of a feature over several looks (FeatureTracker). One look alone gives no id.
struct Tracked {
    std::uint32_t id = 0;           ///< the same as long as it is followed; 0 = was not followed
    int observations = 1;           ///< that found it
    std::int64_t last_seen_ns = 0;  ///< stamp of the last of them
    bool seen_now = true;           ///< by the last look of all
    /// The map that a run left shows it by itself, looked at without images (`surefoot stairs` of
    /// its folder). Nothing = was not asked.
    std::optional<bool> in_final_map = std::nullopt;

    /// One look alone may be a wrong match.
    [[nodiscard]] bool is_confirmed() const { return observations >= 2; }
};

/// A straight piece of a line at which the ground changes its height. Frame of the map [m].
struct Edge {
    /// Ends of the border of the upper ground. Who goes from one to the other has the lower ground
    /// on the right hand.
    Eigen::Vector2d from_m = Eigen::Vector2d::Zero();
    Eigen::Vector2d to_m = Eigen::Vector2d::Zero();
    double upper_m = 0.0;  ///< height of the ground above it, at the line
    double lower_m = 0.0;  ///< below it; where that was not seen, the ground lies no higher
    bool lower_seen = false;
    bool open = false;            ///< a step whose riser one sees through: a board
    double height_sigma_m = 0.0;  ///< one sigma of upper_m - lower_m
    double across_sigma_m = 0.0;  ///< one sigma of where the line lies, across it
    double angle_sigma_rad = 0.0;
    /// The ground goes on as far as this on either side before the next edge or the unknown.
    double upper_depth_m = 0.0;
    double lower_depth_m = 0.0;
    /// Natural logarithm of the likelihood ratio, step over smooth ground, of the last look
    /// (StepEvidenceFinder). NaN = not asked: the ground below it is not seen.
    double log_step_ratio = std::numeric_limits<double>::quiet_NaN();
    bool hidden = false;  ///< the ground between both sides is not seen where it falls

    bool upper_walkable = false;  ///< one comes to it from the stance without taking a step
    bool lower_walkable = false;
    Tracked tracked;

    [[nodiscard]] double height_m() const { return upper_m - lower_m; }
    [[nodiscard]] double length_m() const { return (to_m - from_m).norm(); }
    [[nodiscard]] Eigen::Vector2d middle_m() const { return 0.5 * (from_m + to_m); }
    /// Unit vector along it.
    [[nodiscard]] Eigen::Vector2d along() const { return (to_m - from_m).normalized(); }
    /// Unit vector that points to the lower ground.
    [[nodiscard]] Eigen::Vector2d down() const {
        const Eigen::Vector2d a = along();
        return {a.y(), -a.x()};
    }
    /// How far a point lies on the lower side.
    [[nodiscard]] double below_m(const Eigen::Vector2d& point_m) const {
        return (point_m - from_m).dot(down());
    }
};

/// Place of a feature: its middle, the height of the ground before it, and the way across it.
struct FeaturePose {
    Eigen::Vector3d p_m = Eigen::Vector3d::Zero();
    double yaw_rad = 0.0;
};

/// Something that is found as one line: a drop, a kerb, a sill.
struct LineFeature {
    FeaturePose pose;       ///< seen from the stance: yaw leads over it, z is the ground before it
    double height_m = 0.0;  ///< of the ground behind it above the ground before it; sill: its own
    double length_m = 0.0;
    double sigma_m = 0.0;         ///< one sigma of the height
    double across_sigma_m = 0.0;  ///< one sigma of its place, along the yaw
    bool bottom_seen = true;      ///< false: the ground behind it lies at least so deep
    double log_step_ratio = std::numeric_limits<double>::quiet_NaN();  ///< of its edge
    Tracked tracked;  ///< drops and kerbs: that of their edge
};

/// An edge as met by who goes down or up over it.
[[nodiscard]] LineFeature line_feature(const Edge& edge, bool goes_down);

enum class FlightKind : std::uint8_t { up, down };

/// What lies beside the steps of a flight.
enum class SideKind : std::uint8_t { unknown, wall, level, open };

/// "wall", as in stairs.json.
[[nodiscard]] const char* to_string(SideKind kind);

struct FlightSide {
    SideKind kind = SideKind::unknown;
    double rail_m = 0.0;  ///< a rail runs so high above the line of the noses; 0 = none was seen
};

/// Steps one behind the other, as seen from the stance.
struct Flight {
    FlightKind kind = FlightKind::up;
    /// Middle of its first edge, z = ground before it, yaw = the way that leads along it.
    FeaturePose pose;
    int steps = 0;                ///< rises
    double riser_m = 0.0;         ///< mean
    double riser_sigma_m = 0.0;   ///< standard error of the mean
    double riser_spread_m = 0.0;  ///< scatter of single risers; 0 for one step
    /// From nose to nose, mean; NaN for one step, as the two that follow.
    double going_m = 0.0;
    double going_sigma_m = 0.0;
    double going_spread_m = 0.0;
    double width_m = 0.0;
    double landing_m = 0.0;  ///< level ground behind the last edge, as far as it is known
    /// Lines of its edges, from the stance on.
    std::vector<Edge> edges;
    double turn_rad = 0.0;  ///< how far the way turns from the first edge to the last: spirals
    bool cut = false;       ///< it may go on beyond what is known
    bool open = false;      ///< boards without risers, as far as half of its steps or more show it
    FlightSide left;        ///< as seen from the stance, along the way that it leads
    FlightSide right;
    Tracked tracked;
};

/// An opening between two walls through which the ground leads.
struct Door {
    FeaturePose pose;  ///< middle of the opening, z = ground before it, yaw = the way through it
    double width_m = 0.0;
    double width_sigma_m = 0.0;
    double sill_m = 0.0;  ///< highest across the opening above the ground before it; 0 = none
    double sill_sigma_m = 0.0;
    double clearance_m = 0.0;  ///< least free height; NaN = nothing was seen above it
    Tracked tracked;
};

/// What the ground is.
struct TerrainFeatures {
    std::vector<Edge> edges;
    std::vector<LineFeature> drops;
    std::vector<LineFeature> kerbs;
    std::vector<LineFeature> sills;
    std::vector<Flight> flights;
    std::vector<Door> doors;
    std::int64_t time_ns = 0;  ///< stamp of the last look; 0 = were not followed
};

}  // namespace surefoot::stairs
