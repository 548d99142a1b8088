// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/sim/motion/gait_trace.hpp"
#include "surefoot/sim/motion/rex_gait.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

constexpr int kTrace = 64;
// The first and the last weight shift take longer than in the trace, so the first and the last
// sample of the trace are repeated `kLead` times.
constexpr int kLead = 5;
constexpr int kSamples = kLead + kTrace + kLead;
/// Tilt of the trailing foot before its swing: 10 deg about the toes. In the trace the ankle of
/// that foot is then 42 mm higher than with a flat sole. The heel rises during `kHeel` samples,
/// after the other foot has landed.
constexpr double kHeelLift_rad = 10.0 * kRadPerDeg;
constexpr double kHeel = 6.0;
/// Smallest height difference of a step on stairs.
constexpr double kStair_m = 0.02;
/// Highest riser: the stair limit of the machine file (0.18 m) plus 20 mm for irregular stairs.
constexpr double kMaxRise_m = 0.20;
/// Limit of the acceleration of the ringing: the largest default acceleration of a foot strike.
constexpr double kMaxRing_m_s2 = 2.0;

/// Part of a step, from one sample of the trace to another.
struct Phase {
    double from;
    double to;
    [[nodiscard]] double share(double sample) const { return eased((sample - from) / (to - from)); }
    [[nodiscard]] constexpr Phase played_backwards() const {
        return {kTrace - 1 - to, kTrace - 1 - from};
    }
};

/// Times of the swings and of the weight shifts, in samples of the trace.
struct Phases {
    Phase lead_swings;
    Phase trail_swings;
    Phase lead_closes;
    Phase to_trail;
    Phase to_lead;
    Phase to_trail_again;
    Phase to_middle;
};
/// Phases of a step ahead, from the kinematics of the trace. A foot lands when the pelvis has moved
/// over the other foot.
constexpr Phases kAhead{
    {5.0, 20.0}, {26.0, 44.0}, {52.0, 60.0}, {-5.0, 5.0}, {16.0, 26.0}, {41.0, 51.0}, {58.0, 68.0}};
constexpr Phases kBackward{kAhead.lead_closes.played_backwards(),
                           kAhead.trail_swings.played_backwards(),
                           kAhead.lead_swings.played_backwards(),
                           kAhead.to_middle.played_backwards(),
                           kAhead.to_trail_again.played_backwards(),
                           kAhead.to_lead.played_backwards(),
                           kAhead.to_trail.played_backwards()};

const Phases& phases_of(const RexMovement& movement) {
    return movement.forward_m < 0.0 ? kBackward : kAhead;
}

/// Path of base_link through the trace, relative to the left sole at the start; the right foot
/// leads.
struct TraceWay {
    double length_m = 0.0;                  ///< length of the whole step
    std::array<double, kTrace> progress{};  ///< progress of base_link, 0 to 1
    std::array<double, kTrace> sink_m{};    ///< height relative to standing
    std::array<double, kTrace> pitch_rad{};
};

struct Carried {
    double x_m;  ///< position of the hips relative to the carrying sole
    double z_m;
    double other_x_m;  ///< position of the other sole relative to the carrying sole
    double pitch_rad;
};

/// Position of the sole point relative to the hips: down the leg to the ankle, then to the sole.
Eigen::Vector2d hanging(const LinkAngles& leg) {
    const double sole = leg.foot_rad - kFlatFoot_rad;
    return {
        -rex::kUpperLeg_m * std::sin(leg.upper_leg_rad) -
            rex::kLowerLeg_m * std::sin(leg.lower_leg_rad) - rex::kAnkleHeight_m * std::sin(sole),
        -rex::kUpperLeg_m * std::cos(leg.upper_leg_rad) -
            rex::kLowerLeg_m * std::cos(leg.lower_leg_rad) - rex::kAnkleHeight_m * std::cos(sole)};
}

/// The carrying sole is flat, so the pelvis turns back by the angle of that sole in the trace.
Carried carried_by(const LinkAngles& leg, const LinkAngles& other) {
    const double pitch = -(leg.foot_rad - kFlatFoot_rad);
    const auto upright = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
        return {std::cos(pitch) * p.x() + std::sin(pitch) * p.y(),
                -std::sin(pitch) * p.x() + std::cos(pitch) * p.y()};
    };
    const Eigen::Vector2d sole = upright(hanging(leg));
    return {-sole.x(), -sole.y(), upright(hanging(other)).x() - sole.x(), pitch};
}

TraceWay make_trace_way() {
    const auto trace = gait_trace();
    std::array<Carried, kTrace> left{};
    std::array<Carried, kTrace> right{};
    double between_m = 0.0;
    for (std::size_t i = 0; i < kTrace; ++i) {
        left[i] = carried_by(trace[i].left, trace[i].right);
        right[i] = carried_by(trace[i].right, trace[i].left);
        // Both feet stand while the weight moves from left to right.
        if (i >= 16 && i < 26) between_m += 0.1 * left[i].other_x_m;
    }
    TraceWay way;
    way.length_m = 2.0 * between_m;
    for (std::size_t i = 0; i < kTrace; ++i) {
        const auto sample = static_cast<double>(i);
        const double on_right = kAhead.to_lead.share(sample) - kAhead.to_trail_again.share(sample);
        const double left_x_m = left[i].x_m + (i < 33 ? 0.0 : way.length_m);
        const double x_m = (1.0 - on_right) * left_x_m + on_right * (right[i].x_m + between_m);
        way.progress[i] = (x_m - left[0].x_m) / way.length_m;
        way.sink_m[i] = (1.0 - on_right) * left[i].z_m + on_right * right[i].z_m - left[0].z_m;
        way.pitch_rad[i] = (1.0 - on_right) * left[i].pitch_rad + on_right * right[i].pitch_rad;
    }
    // The trace ends a fraction of a millimetre and of a degree before the end of the step.
    way.progress[kTrace - 1] = 1.0;
    way.sink_m[kTrace - 1] = 0.0;
    way.pitch_rad[kTrace - 1] = 0.0;
    return way;
}

const TraceWay& trace_way() {
    static const TraceWay way = make_trace_way();
    return way;
}

std::size_t clamped(int sample) {
    return static_cast<std::size_t>(std::clamp(sample, 0, kSamples - 1));
}

double drawn(Rng& rng, const Spread& spread) {
    return rng.uniform(spread.low, spread.high);
}

Pose level_pose(double x_m, double y_m, double z_m, double yaw_rad) {
    Pose T;
    T.translation_m = {x_m, y_m, z_m};
    T.rotation = Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ());
    return T;
}

/// One sample of the motion of base_link.
struct Row {
    Vector3d at_m;
    double pitch_rad;
    double yaw_rad;
    double sway_roll_rad;
    double sway_yaw_rad;
};

}  // namespace

class RexMotionBuilder {
  public:
    RexMotionBuilder(const RexGaitConfig& config, const GroundHeight& ground_z_m)
        : config_(config), ground_z_m_(ground_z_m) {}

    void stand(const RexStand& place);
    Status step(const RexStep& step, std::uint64_t seed);
    void wait(double time_s) { now_s_ += time_s; }
    RexMotion finish() {
        motion_.duration_s_ = now_s_;
        return std::move(motion_);
    }

  private:
    struct Sway {
        double shift_m;
        double roll_rad;
        double yaw_rad;
        double size;  ///< scale of the trace; 1 = the step of the trace
    };
    [[nodiscard]] double interval_s() const {
        return (config_.step_s - config_.settle_s) / (kSamples + 1);
    }
    [[nodiscard]] double time_of(double trace_sample) const {
        return now_s_ + (trace_sample + kLead + 1.0) * interval_s();
    }
    [[nodiscard]] Vector3d sole_m(Side side, const RexStand& stand) const;
    [[nodiscard]] double stand_z_m(const RexStand& stand) const;
    [[nodiscard]] Pose stand_pose(const RexStand& stand) const;
    void swing(Side side, const Phase& phase, double lift_rad, const RexStand& to, Rng& rng);
    void swing_feet(const RexStep& step, Side lead, Rng& rng);
    [[nodiscard]] std::vector<Row> rows(const RexStep& step, Side lead, const Sway& sway) const;
    [[nodiscard]] double reach_limit_m(const RexMotion::Body& body, double time_s) const;
    void sink_to_reach(RexMotion::Body& body, std::vector<double> heights_m) const;
    [[nodiscard]] Status check(const RexStep& step) const;

    RexGaitConfig config_;
    GroundHeight ground_z_m_;
    RexMotion motion_;
    double now_s_ = 0.0;
};

/// Position of a sole on the ground. The sole has the height of the ground under its middle, so
/// toes or heels may reach over an edge. With `ground_under_body` it has the height of the ground
/// under base_link.
Vector3d RexMotionBuilder::sole_m(Side side, const RexStand& stand) const {
    constexpr double kMiddle_x_m = 0.057;  // key feet of machines/rex.yaml
    constexpr double kMiddle_y_m = 0.180;
    const double c = std::cos(stand.yaw_rad);
    const double s = std::sin(stand.yaw_rad);
    const double ankle_m = sign_of(side) * rex::kHip_y_m;
    const double middle_m = sign_of(side) * kMiddle_y_m;
    const double z_m = config_.ground_under_body
                           ? ground_z_m_(stand.x_m, stand.y_m)
                           : ground_z_m_(stand.x_m + c * kMiddle_x_m - s * middle_m,
                                         stand.y_m + s * kMiddle_x_m + c * middle_m);
    return {stand.x_m - s * ankle_m, stand.y_m + c * ankle_m, z_m};
}

double RexMotionBuilder::stand_z_m(const RexStand& stand) const {
    return std::min(sole_m(Side::left, stand).z(), sole_m(Side::right, stand).z()) + rex::kStand_m;
}

Pose RexMotionBuilder::stand_pose(const RexStand& stand) const {
    return level_pose(stand.x_m, stand.y_m, stand_z_m(stand), stand.yaw_rad);
}

void RexMotionBuilder::stand(const RexStand& place) {
    const auto resting = [](double value) { return SmoothCurve(0.0, 1.0, {value}); };
    motion_.bodies_.push_back({0.0,
                               {resting(place.x_m), resting(place.y_m), resting(stand_z_m(place))},
                               resting(0.0),
                               resting(place.yaw_rad),
                               resting(0.0),
                               resting(0.0)});
    for (const Side side : {Side::left, Side::right}) {
        RexMotion::Swing standing;
        standing.from_m = standing.to_m = sole_m(side, place);
        standing.from_yaw_rad = standing.to_yaw_rad = place.yaw_rad;
        motion_.swings_[static_cast<std::size_t>(side)].push_back(standing);
    }
}

/// Adds a swing. If `lift_rad` > 0, the heel rises before the swing. If `lift_rad` < 0, the heel
/// comes down after the swing.
void RexMotionBuilder::swing(
    Side side, const Phase& phase, double lift_rad, const RexStand& to, Rng& rng) {
    auto& swings = motion_.swings_[static_cast<std::size_t>(side)];
    RexMotion::Swing next;
    next.start_s = time_of(phase.from);
    next.end_s = time_of(phase.to);
    next.heel_up_s = lift_rad > 0.0 ? time_of(phase.from - kHeel) : next.start_s;
    next.heel_down_s = lift_rad < 0.0 ? time_of(phase.to + kHeel) : next.end_s;
    next.lift_rad = std::abs(lift_rad);
    next.from_m = swings.back().to_m;
    next.from_yaw_rad = swings.back().to_yaw_rad;
    next.to_m = sole_m(side, to);
    next.to_yaw_rad = to.yaw_rad;
    next.clearance_m = config_.foot_clearance_m;
    swings.push_back(next);

    RexMotion::Strike strike;
    strike.time_s = next.end_s;
    strike.omega_rad_s = 2.0 * std::numbers::pi * drawn(rng, config_.ring_hz);
    const double limit_m = kMaxRing_m_s2 / (strike.omega_rad_s * strike.omega_rad_s);
    const double ring_m = std::min(1e-3 * drawn(rng, config_.ring_mm), limit_m);
    strike.ring_m = {ring_m * rng.uniform(-0.5, 0.5), ring_m * rng.uniform(-0.5, 0.5), ring_m};
    for (const std::size_t axis : {0U, 1U})
        strike.ring_rad[axis] =
            drawn(rng, config_.ring_deg) * kRadPerDeg * (rng.below(2) ? 1.0 : -1.0);
    strike.pulse_m_s2 = drawn(rng, config_.strike_m_s2);
    motion_.strikes_.push_back(strike);
}

void RexMotionBuilder::swing_feet(const RexStep& step, Side lead, Rng& rng) {
    const Phases& phases = phases_of(step.movement);
    const Side trail = lead == Side::left ? Side::right : Side::left;
    const double rise_m = stand_z_m(step.after) - stand_z_m(step.before);
    // A foot that moves forward lifts its heel before the swing; a foot that moves backward lowers
    // it after the swing.
    const double lift_rad = kHeelLift_rad * step.movement.forward_m / trace_way().length_m;
    const double lead_rad = std::min(lift_rad, 0.0);
    const double close_rad = std::max(lift_rad, 0.0);
    if (std::abs(rise_m) > kStair_m) {
        swing(lead, phases.lead_swings, lead_rad, step.after, rng);
        swing(trail, phases.trail_swings, lift_rad, step.after, rng);
        return;
    }
    swing(lead, phases.lead_swings, lead_rad, moved(step.before, step.movement, 0.5), rng);
    swing(trail, phases.trail_swings, lift_rad, step.after, rng);
    swing(lead, phases.lead_closes, close_rad, step.after, rng);
}

std::vector<Row> RexMotionBuilder::rows(const RexStep& step, Side lead, const Sway& sway) const {
    const TraceWay& way = trace_way();
    const Phases& phases = phases_of(step.movement);
    const bool backward = step.movement.forward_m < 0.0;
    const Pose from = stand_pose(step.before);
    const Vector3d go_m = stand_pose(step.after).translation_m - from.translation_m;
    const Vector3d left(-std::sin(step.before.yaw_rad), std::cos(step.before.yaw_rad), 0.0);
    const double turn_rad = step.after.yaw_rad - step.before.yaw_rad;
    std::vector<Row> rows;
    for (int k = 0; k < kSamples; ++k) {
        const int sample = k - kLead;
        const int in_trace = std::clamp(sample, 0, kTrace - 1);
        const auto i = static_cast<std::size_t>(backward ? kTrace - 1 - in_trace : in_trace);
        const double share = backward ? 1.0 - way.progress[i] : way.progress[i];
        // The weight moves over the trailing foot, the leading foot and the trailing foot again,
        // then back to the middle.
        const double over_trail =
            phases.to_trail.share(sample) - 2.0 * phases.to_lead.share(sample) +
            2.0 * phases.to_trail_again.share(sample) - phases.to_middle.share(sample);
        const double to_left = lead == Side::right ? over_trail : -over_trail;
        // The pelvis turns with the foot that is in front.
        const double lead_ahead = phases.lead_swings.share(sample) -
                                  2.0 * phases.trail_swings.share(sample) +
                                  phases.lead_closes.share(sample);
        const double right_ahead = (lead == Side::right) != backward ? lead_ahead : -lead_ahead;
        const Vector3d at_m = from.translation_m + share * go_m + (sway.shift_m * to_left) * left;
        rows.push_back({at_m + Vector3d(0.0, 0.0, sway.size * sway.size * way.sink_m[i]),
                        sway.size * way.pitch_rad[i],
                        step.before.yaw_rad + share * turn_rad,
                        -sway.roll_rad * to_left,
                        sway.yaw_rad * right_ahead});
    }
    return rows;
}

/// Highest base_link at which both legs reach their feet.
double RexMotionBuilder::reach_limit_m(const RexMotion::Body& body, double time_s) const {
    const Vector3d at_m(
        body.position_m[0].at(time_s).value, body.position_m[1].at(time_s).value, 0.0);
    const Eigen::Matrix3d R =
        (Eigen::AngleAxisd(body.yaw_rad.at(time_s).value, Vector3d::UnitZ()) *
         Eigen::AngleAxisd(body.pitch_rad.at(time_s).value, Vector3d::UnitY()))
            .toRotationMatrix();
    double limit_m = std::numeric_limits<double>::infinity();
    for (const Side side : {Side::left, Side::right}) {
        const Vector3d hip = R * Vector3d(rex::kHip_x_m, sign_of(side) * rex::kHip_y_m, 0.0);
        const Vector3d ankle_m =
            motion_.foot(side, time_s).T_world_sole * Vector3d(0.0, 0.0, rex::kAnkleHeight_m);
        const double away_m = (at_m + hip - ankle_m).head<2>().norm();
        limit_m = std::min(limit_m, ankle_m.z() + hip_reach_m(away_m) - hip.z());
    }
    return limit_m;
}

/// Lowers base_link until both legs reach their feet. Where the spline is too high, the samples
/// that influence it are lowered in proportion to their weights, in at most `kRounds` rounds
/// (Kaczmarz' method). The first and last samples stay unchanged.
void RexMotionBuilder::sink_to_reach(RexMotion::Body& body, std::vector<double> heights_m) const {
    constexpr int kPerSample = 4;
    constexpr int kRounds = 100;
    constexpr double kEnough_m = 1e-5;  // the knee bend in the reach limit leaves at least 0.2 mm
    std::vector<double> limits_m;
    for (int i = 0; i <= kPerSample * (kSamples + 1); ++i)
        limits_m.push_back(reach_limit_m(body, now_s_ + interval_s() * i / kPerSample));
    for (int round = 0; round < kRounds; ++round) {
        bool enough = true;
        for (std::size_t i = 0; i < limits_m.size(); ++i) {
            const double u = static_cast<double>(i % kPerSample) / kPerSample;
            const double v = 1.0 - u;
            const double weights[] = {v * v * v / 6.0,
                                      (4.0 - 6.0 * u * u + 3.0 * u * u * u) / 6.0,
                                      (4.0 - 6.0 * v * v + 3.0 * v * v * v) / 6.0,
                                      u * u * u / 6.0};
            double height_m = 0.0;
            double norm_sq = 0.0;
            for (int j = 0; j < 4; ++j) {
                const int sample = static_cast<int>(i) / kPerSample + j - 2;
                height_m += weights[j] * heights_m[clamped(sample)];
                norm_sq += weights[j] * weights[j];
            }
            const double excess_m = height_m - limits_m[i];
            if (excess_m <= kEnough_m) continue;
            enough = false;
            for (int j = 0; j < 4; ++j) {
                const int sample = static_cast<int>(i) / kPerSample + j - 2;
                if (sample > 0 && sample < kSamples - 1)
                    heights_m[clamped(sample)] -= weights[j] / norm_sq * excess_m;
            }
        }
        if (enough) break;
    }
    body.position_m[2] = SmoothCurve(now_s_, interval_s(), std::move(heights_m));
}

Status RexMotionBuilder::check(const RexStep& step) const {
    const bool level = std::abs(stand_z_m(step.after) - stand_z_m(step.before)) <= kStair_m &&
                       std::abs(sole_m(Side::left, step.after).z() -
                                sole_m(Side::right, step.after).z()) <= kStair_m;
    const std::string where =
        fmt::format("simulator: step {} of the rex (code {}, at x {:.2f} y {:.2f})",
                    motion_.steps_.size(),
                    step.movement.command,
                    step.before.x_m,
                    step.before.y_m);
    for (int k = 0; k <= 2 * (kSamples + 1); ++k) {
        const double t_s = now_s_ + 0.5 * k * interval_s();
        const Pose T_world_body = motion_.pelvis(t_s);
        for (const Side side : {Side::left, Side::right}) {
            const auto angles =
                leg_angles(side, T_world_body.inverse() * motion_.foot(side, t_s).T_world_sole);
            if (!angles) {
                return usage_error(
                    fmt::format("{}: the {} leg cannot reach the position of its foot; make the "
                                "step smaller or the ground more even",
                                where,
                                kSideNames[static_cast<int>(side)]));
            }
            if (!level) continue;
            if (const auto problem = joint_problem(side, *angles)) {
                return usage_error(fmt::format("{}: {}; make the step smaller", where, *problem));
            }
        }
    }
    return {};
}

Status RexMotionBuilder::step(const RexStep& step, std::uint64_t seed) {
    wait(step.wait_s);
    const Pose before = stand_pose(step.before);
    const Pose after = stand_pose(step.after);
    const double rise_m = after.translation_m.z() - before.translation_m.z();
    if (!(std::abs(rise_m) <= kMaxRise_m)) {
        return usage_error(fmt::format(
            "simulator: step {} of the rex (code {}, at x {:.2f} y {:.2f}) would go {:+.3f} m in "
            "height, limit is {:.2f} m; move the waypoints away from the edge",
            motion_.steps_.size() + 1,
            step.movement.command,
            step.before.x_m,
            step.before.y_m,
            rise_m,
            kMaxRise_m));
    }
    const RexMovement& movement = step.movement;
    const bool to_left = movement.left_m > 0.0 || movement.turn_rad > 0.0;
    const Side lead = to_left ? Side::left : Side::right;
    Rng rng(seed);
    Sway sway{};
    sway.size = std::abs(movement.forward_m) / trace_way().length_m;
    // ASSUMPTION: roll and yaw of the sway shrink with the forward length of the step, down to half
    // for a step sideways or a turn.
    const double calm = 0.5 + 0.5 * std::min(1.0, std::abs(movement.forward_m) / 0.40);
    // A flat foot stands with its leg leaning by 9 deg at most (range of the ankle), which moves
    // the hip by 0.13 m. The limit of 0.12 m keeps a margin of 10 mm. Half of a sideways step
    // reduces this limit.
    constexpr double kLean_m = 0.12;
    sway.shift_m =
        std::min(drawn(rng, config_.lateral_shift_m), kLean_m - 0.5 * std::abs(movement.left_m));
    sway.roll_rad = calm * drawn(rng, config_.roll_deg) * kRadPerDeg;
    sway.yaw_rad = calm * drawn(rng, config_.yaw_deg) * kRadPerDeg;

    swing_feet(step, lead, rng);
    const std::vector<Row> samples = rows(step, lead, sway);
    const auto column = [&](auto value) {
        std::vector<double> values;
        values.reserve(samples.size());
        for (const Row& row : samples) values.push_back(value(row));
        return values;
    };
    const auto curve = [&](auto value) { return SmoothCurve(now_s_, interval_s(), column(value)); };
    const auto height = [](const Row& row) { return row.at_m.z(); };
    RexMotion::Body body{now_s_,
                         {curve([](const Row& row) { return row.at_m.x(); }),
                          curve([](const Row& row) { return row.at_m.y(); }),
                          curve(height)},
                         curve([](const Row& row) { return row.pitch_rad; }),
                         curve([](const Row& row) { return row.yaw_rad; }),
                         curve([](const Row& row) { return row.sway_roll_rad; }),
                         curve([](const Row& row) { return row.sway_yaw_rad; })};
    sink_to_reach(body, column(height));
    motion_.bodies_.push_back(std::move(body));
    motion_.steps_.push_back({now_s_, now_s_ + config_.step_s, before, after});
    if (Status status = check(step); !status) return status;
    now_s_ += config_.step_s;
    return {};
}

Result<RexMotion> RexMotion::make(const RexPlan& plan,
                                  const RexGaitConfig& config,
                                  const GroundHeight& ground_z_m,
                                  std::uint64_t seed) {
    RexMotionBuilder builder(config, ground_z_m);
    builder.stand(plan.start);
    std::uint64_t stream = 0;
    for (const RexStep& step : plan.steps) {
        if (Status status = builder.step(step, mix_seed(seed, stream++)); !status)
            return status.error();
    }
    builder.wait(plan.last_wait_s);
    return builder.finish();
}

}  // namespace surefoot::sim
