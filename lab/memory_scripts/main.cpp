// SPDX-License-Identifier: Apache-2.0
// Does the gate give correct answers about ground and obstacles that it only remembers?
// Usage: memory_scripts OUT.csv FIRST_SEED SEEDS [SCRIPT... ]
//   SCRIPT: table    walk to a table, turn by 180 deg, walk back to it with the camera facing away
//           door     walk to a door, turn by 90 deg, walk sideways through it
//           tread    walk to a step down, turn by 180 deg, walk back to it; then a movement of
//                    class stair onto the broad tread below. With the camera of the REX (32 deg
//                    down) and with a camera that looks 65 deg down.
//           quick    all of them with one seed each, analytic depth, without drift and with 10 %
//           images   table and door with rendered images and the whole pipeline
//           default: table, door and tread
//
// Joystick codes steer a simulated REX. Before each step the gate is asked at the believed pose,
// and the oracle at the true pose. The machine makes the step if the oracle rates it as safe or the
// script forces it. The gate's answer does not steer, so that every drift leads along the same
// path. Drift: the reported motion of base_link is too long or too short by a share; the seed
// chooses the sign. The stated covariance is that of a correct odometry (`own`), or it grows with
// the distance as the error does (`told`).
// Holes: each question about stairs is asked again of a map whose unknown and uncertain cells are
// filled from the nearest known ones, as if a second camera had seen them.
//
// Writes OUT.csv, one line per step:
// script,pitch_deg,seed,drift_percent,stated,look,holes,step,command,asked,forced,safe,clear,
// danger,verdict,primary,reasons,forward_m,left_m (position of the deciding cell relative to
// base_link), value_mm,limit_mm,stated_drift_mm,off_mm (distance of the believed from the true
// position), relief_mm,size_mm
#include <fmt/format.h>
#include <fmt/os.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "studies/runs/offline_map.hpp"
#include "studies/runs/run_session.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/gate/verdict_text.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/perception/settings.hpp"
#include "surefoot/sim/safety_oracle/safety_oracle.hpp"
#include "surefoot/sim/scene_source.hpp"
#include "surefoot/sim/sensors/rigs.hpp"

namespace surefoot {
namespace {

constexpr std::uint8_t kHalfBack = 5;
constexpr std::uint8_t kAhead = 9;
constexpr std::uint8_t kRight = 13;
constexpr std::uint8_t kBack = 17;
constexpr std::uint8_t kTurnLeft = 25;
constexpr double kToe_m = 0.24;
constexpr double kStepAhead_m = 0.40;
/// Length of the backward movement of class stair. A real REX cannot step so far back. A shorter
/// step would land on the strip behind the nosing, which the camera never sees.
constexpr double kStairBack_m = 0.60;
constexpr double kAttested_m = 1.0;
constexpr double kRate_hz = 0.5;  ///< camera rate; a step takes ten seconds
constexpr double kSettled_s = 1.0;

enum class Script : std::uint8_t { table, door, tread };
constexpr const char* kScriptNames[] = {"table", "door", "tread"};

enum class Stated : std::uint8_t { own, told };
constexpr const char* kStatedNames[] = {"own", "told"};

struct Setup {
    Script script = Script::table;
    std::uint64_t seed = 0;
    double pitch_deg = 32.0;
    double drift = 0.0;  ///< motion error as a share of the distance, without sign
    Stated stated = Stated::own;
    bool images = false;
};

struct Order {
    std::uint8_t command = 0;
    bool asked = false;   ///< true: this order is the question of the script
    bool forced = false;  ///< true: made even if the oracle forbids it, because it ends at an edge
    bool stair = false;   ///< true: movement of the machine with stairs; asked but not made
};

struct Plan {
    std::string yaml;
    std::vector<Order> orders;
    bool ends_where_unsafe = false;  ///< true: the script ends at an order that the oracle refuses
    double relief_m = 0.0;
    double size_m = 0.0;
};

void add(std::vector<Order>& orders, Order order, int times = 1) {
    orders.insert(orders.end(), static_cast<std::size_t>(times), order);
}

std::string scene_head(const char* name, Rng& rng) {
    constexpr const char* kLooks[] = {"carpet", "tiles", "wood", "concrete"};
    return fmt::format(
        "name: {}\ndescription: steps onto remembered ground\nlighting: {{ambient: {}, lamp: "
        "{}}}\nmaterials:\n"
        "  ground: {{pattern: {}, albedo: {}, contrast: 0.6}}\n"
        "  board: {{pattern: wood, albedo: 0.55, contrast: 0.6, texel_m: 0.0015}}\n"
        "  plaster: {{pattern: plaster, albedo: 0.6, contrast: 0.45, texel_m: 0.005}}\n"
        "  patches: {{pattern: patches, albedo: 0.5, contrast: 0.6, texel_m: 0.006}}\nsolids:\n",
        name,
        rng.uniform(0.35, 0.6),
        rng.uniform(0.2, 0.6),
        kLooks[rng.below(std::size(kLooks))],
        rng.uniform(0.35, 0.6));
}

std::string scene_tail(double bottom_m) {
    return fmt::format(
        "  - walls: {{min_x_m: -3, min_y_m: -4, max_x_m: 8, max_y_m: 4, bottom_m: {}, material: "
        "patches, other_material: plaster}}\n"
        "motion:\n  motion_model: rex\n  waypoints: [{{x_m: 0, y_m: 0}}]\n",
        bottom_m);
}

constexpr const char* kFloor =
    "  - floor: {min_x_m: -3, min_y_m: -4, max_x_m: 8, max_y_m: 4, material: ground}\n";

/// Makes a table whose edge is 0.5 to 0.9 m behind the body after the turn.
Plan table_plan(Rng& rng) {
    Plan plan;
    plan.relief_m = rng.uniform(0.68, 0.78);
    const double rim_m = 3 * kStepAhead_m + rng.uniform(0.90, 1.30);
    plan.yaml = scene_head("table", rng) + kFloor;
    plan.yaml += fmt::format(
        "  - table: {{x_m: {}, y_m: {}, length_m: 0.8, width_m: {}, top_m: {}, material: board, "
        "leg_material: plaster}}\n",
        rim_m + 0.4,
        rng.uniform(-0.15, 0.15),
        rng.uniform(1.2, 1.8),
        plan.relief_m);
    plan.yaml += scene_tail(0.0);
    add(plan.orders, {kAhead, false, false, false}, 3);
    add(plan.orders, {kTurnLeft, false, false, false}, 12);
    add(plan.orders, {kBack, true, false, false}, 6);
    plan.ends_where_unsafe = true;
    return plan;
}

/// Makes a door whose wall is 1.1 to 1.3 m ahead when the machine begins to turn.
Plan door_plan(Rng& rng) {
    Plan plan;
    plan.size_m = rng.uniform(1.00, 1.20);
    const double wall_m = 2 * kStepAhead_m + rng.uniform(1.10, 1.30);
    plan.yaml = scene_head("door", rng) + kFloor;
    plan.yaml += fmt::format(
        "  - door: {{x_m: {}, y_m: {}, width_m: {}, thickness_m: {}, sill_m: 0, wall_left_m: 3, "
        "wall_right_m: 3, material: plaster, post_material: board, sill_material: ground}}\n",
        wall_m,
        rng.uniform(-0.02, 0.02),
        plan.size_m,
        rng.uniform(0.09, 0.15));
    plan.yaml += scene_tail(0.0);
    add(plan.orders, {kAhead, false, false, false}, 2);
    add(plan.orders, {kTurnLeft, false, false, false}, 6);
    add(plan.orders, {kRight, true, false, false}, 18);
    return plan;
}

/// Makes a floor with an edge, then a tread, then ground one riser below the tread. When the
/// machine observes the edge, its toes are 0.02 to 0.07 m before the edge. The occluded strip
/// behind the edge is then one cell wide. The machine goes back, turns, and comes back with its
/// heels to the edge.
Plan tread_plan(Rng& rng) {
    Plan plan;
    plan.relief_m = rng.uniform(0.08, 0.14);
    plan.size_m = rng.uniform(0.50, 1.10);
    const double edge_m = 3 * kStepAhead_m + kToe_m + rng.uniform(0.02, 0.07);
    plan.yaml = scene_head("tread", rng);
    const auto level = [&](double from_m, double to_m, double top_m) {
        plan.yaml += fmt::format(
            "  - box: {{x_m: {}, y_m: 0, heading_deg: 0, length_m: {}, width_m: 8, bottom_m: -2, "
            "top_m: {}, material: ground}}\n",
            0.5 * (from_m + to_m),
            to_m - from_m,
            top_m);
    };
    level(-3.0, edge_m, 0.0);
    level(edge_m, edge_m + plan.size_m, -plan.relief_m);
    level(edge_m + plan.size_m, 8.0, -2.0 * plan.relief_m);
    plan.yaml += scene_tail(-2.0);
    add(plan.orders, {kAhead, false, true, false}, 3);
    add(plan.orders, {kBack, false, true, false});
    add(plan.orders, {kTurnLeft, false, true, false}, 12);
    add(plan.orders, {kBack, false, true, false});
    add(plan.orders, {kHalfBack, false, true, false});
    add(plan.orders, {kBack, true, false, true});
    return plan;
}

Plan plan_of(const Setup& setup) {
    Rng rng(mix_seed(setup.seed, 31 + static_cast<std::uint64_t>(setup.script)));
    switch (setup.script) {
        case Script::table: return table_plan(rng);
        case Script::door: return door_plan(rng);
        case Script::tread: break;
    }
    return tread_plan(rng);
}

/// Returns the REX with class stair enabled and one movement of that class.
Machine stair_machine(const Machine& rex) {
    Machine machine = rex;
    machine.limits.step[static_cast<std::size_t>(MovementClass::stair)].enabled = true;
    Movement& back = machine.movements[kBack];
    back.movement_class = MovementClass::stair;
    back.forward_tenth_mm = -static_cast<std::int32_t>(std::lround(1e4 * kStairBack_m));
    return machine;
}

/// A source that reports the motion with an error. It ends when `end` is called.
class DriftingSource final : public camera::FrameSource {
  public:
    DriftingSource(sim::SceneSource& source, double share, Stated stated)
        : source_(source), share_(share), stated_(stated) {}

    [[nodiscard]] const camera::StereoRig& rig() const override { return source_.rig(); }
    [[nodiscard]] const camera::SourceInfo& info() const override { return source_.info(); }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override {
        if (over_) return std::optional<StereoFrame>{};
        Result<std::optional<StereoFrame>> frame = source_.next();
        if (frame.ok() && frame->has_value() && (*frame)->known_motion)
            drift(*(*frame)->known_motion);
        return frame;
    }
    /// Adds the length of the next step to the walked distance [m].
    void way_grows(double step_m) { way_m_ += step_m; }
    void end() { over_ = true; }

  private:
    void drift(MotionEstimate& motion) {
        motion.T_previous_body.translation_m *= 1.0 + share_;
        // The error is a constant share of the distance. So the sum of the variances must grow with
        // the square of the distance.
        const double way_m = std::exchange(stated_way_m_, way_m_);
        if (stated_ == Stated::told) {
            const double grown_m2 = share_ * share_ * (way_m_ * way_m_ - way_m * way_m);
            motion.relative_covariance.topLeftCorner<3, 3>() +=
                grown_m2 * Eigen::Matrix3d::Identity();
        }
        motion.T_odom_body = T_odom_body_ * motion.T_previous_body;
        T_odom_body_ = motion.T_odom_body;
    }

    sim::SceneSource& source_;
    double share_;
    Stated stated_;
    double way_m_ = 0.0;
    double stated_way_m_ = 0.0;
    Pose T_odom_body_;
    bool over_ = false;
};

double yaw_of(const Pose& T_odom_body) {
    const Eigen::Vector3d ahead = T_odom_body.rotation * Eigen::Vector3d::UnitX();
    return std::atan2(ahead.y(), ahead.x());
}

/// Fills cells that are unknown, or whose sigma exceeds half of the gate's limit, from the nearest
/// good cell within three cells. If several are equally near, takes the lowest.
void fill_holes(const GateLimits& limits, grid::MapSnapshot& map) {
    constexpr int kFarthest = 3;
    const auto known = std::make_unique<grid::MapSnapshot>(map);
    const auto is_good = [&](std::size_t at) {
        return known->source[at] == grid::EvidenceSource::measured &&
               known->sigma_tenth_mm[at] <= limits.cell_sigma_tenth_mm / 2;
    };
    const auto index = [&](int ix, int iy) { return static_cast<std::size_t>(iy * map.nx + ix); };
    for (int iy = kFarthest; iy < map.ny - kFarthest; ++iy) {
        for (int ix = kFarthest; ix < map.nx - kFarthest; ++ix) {
            if (is_good(index(ix, iy))) continue;
            std::optional<std::size_t> best;
            int best_away = 0;
            for (int dy = -kFarthest; dy <= kFarthest; ++dy) {
                for (int dx = -kFarthest; dx <= kFarthest; ++dx) {
                    const std::size_t from = index(ix + dx, iy + dy);
                    const int away = dx * dx + dy * dy;
                    if (!is_good(from)) continue;
                    const bool nearer = !best || away < best_away;
                    if (!nearer && (away > best_away ||
                                    known->height_tenth_mm[from] >= known->height_tenth_mm[*best]))
                        continue;
                    best = from;
                    best_away = away;
                }
            }
            if (!best) continue;
            const std::size_t at = index(ix, iy);
            map.height_tenth_mm[at] = known->height_tenth_mm[*best];
            map.sigma_tenth_mm[at] = known->sigma_tenth_mm[*best];
            map.drift_tenth_mm[at] = known->drift_tenth_mm[*best];
            map.component[at] = known->component[*best];
            map.source[at] = grid::EvidenceSource::measured;
        }
    }
    grid::seal(map);
}

/// Executes one script.
class Walk {
  public:
    Walk(const Setup& setup,
         Plan plan,
         const Machine& rex,
         sim::SceneSource& source,
         DriftingSource& drifting,
         const pipeline::Pipeline& pipeline,
         fmt::ostream& out)
        : setup_(setup),
          plan_(std::move(plan)),
          rex_(rex),
          stairs_(stair_machine(rex)),
          source_(source),
          drifting_(drifting),
          pipeline_(pipeline),
          out_(out) {}

    /// Runs after every frame. When the machine has stood for kSettled_s, asks the gate and gives
    /// the next order.
    void step() {
        const auto& motion = source_.commanded();
        const double free_s = motion->duration_s();
        if (source_.now_s() < free_s + kSettled_s || error_) return;
        if (next_ == plan_.orders.size()) {
            drifting_.end();
            return;
        }
        const Order order = plan_.orders[next_];
        const bool safe = ask(order);
        ++next_;
        if (order.stair || (!safe && !order.forced)) {
            if (plan_.ends_where_unsafe) drifting_.end();
            return;
        }
        const auto made = motion->step(order.command, source_.now_s());
        if (!made) {
            error_ = made.error();
            drifting_.end();
            return;
        }
        drifting_.way_grows(
            (made->T_world_after.translation_m - made->T_world_before.translation_m).norm());
    }
    [[nodiscard]] const std::optional<Error>& error() const noexcept { return error_; }

  private:
    /// Asks gate and oracle, writes both answers, and returns the answer of the oracle.
    bool ask(const Order& order) {
        const Machine& machine = order.stair ? stairs_ : rex_;
        const Pose T_world_body = source_.truth().trajectory.back().T_world_body;
        const sim::SafetyAnswer truth =
            sim::judge(source_.truth().scene, machine, T_world_body, order.command);
        if (auto taken = pipeline_.snapshot(1, *map_); !taken) {
            error_ = taken.error();
            return false;
        }
        const Pose& T_odom_body = pipeline_.T_odom_body();
        const double yaw = yaw_of(T_odom_body);
        gate::Query query = gate::make_query(order.command,
                                             T_odom_body.translation_m.x(),
                                             T_odom_body.translation_m.y(),
                                             std::cos(yaw),
                                             std::sin(yaw));
        attest(query);
        print(
            order, truth, "seen", app::decide_offline(machine, query, *map_), query, T_world_body);
        if (order.stair) {
            fill_holes(rex_.limits, *map_);
            print(order,
                  truth,
                  "filled",
                  app::decide_offline(machine, query, *map_),
                  query,
                  T_world_body);
        }
        return truth.safe;
    }

    /// Adds the operator attestation of the start until the machine has left the attested area.
    void attest(gate::Query& query) {
        if (left_) return;
        const double away_m = 1e-4 * std::hypot(static_cast<double>(query.x_tenth_mm),
                                                static_cast<double>(query.y_tenth_mm));
        left_ = away_m > kAttested_m;
        if (left_) return;
        query.attested.active = true;
        query.attested.radius_tenth_mm = static_cast<std::int32_t>(1e4 * kAttested_m);
    }

    void print(const Order& order,
               const sim::SafetyAnswer& truth,
               const char* holes,
               const gate::Verdict& verdict,
               const gate::Query& query,
               const Pose& T_world_body) {
        const std::string reasons =
            fmt::format("{}", fmt::join(gate::names_of(verdict.reasons), " "));
        const gate::Evidence& e = verdict.evidence;
        const double dx = 1e-4 * static_cast<double>(e.worst_x_tenth_mm - query.x_tenth_mm);
        const double dy = 1e-4 * static_cast<double>(e.worst_y_tenth_mm - query.y_tenth_mm);
        const Pose& T_odom_body = pipeline_.T_odom_body();
        const double off_m =
            (T_odom_body.translation_m - T_world_body.translation_m).head<2>().norm();
        out_.print(
            "{},{},{},{:g},{},{},{},{},{},{},{},{},{},{},{},{},{},{:.3f},{:.3f},{:.1f},{:.1f},{:."
            "1f},"
            "{:.1f},{:.1f},{:.1f}\n",
            kScriptNames[static_cast<int>(setup_.script)],
            setup_.pitch_deg,
            setup_.seed,
            100.0 * setup_.drift,
            kStatedNames[static_cast<int>(setup_.stated)],
            setup_.images ? "images" : "analytic",
            holes,
            next_,
            order.command,
            order.asked ? 1 : 0,
            order.forced ? 1 : 0,
            truth.safe ? 1 : 0,
            truth.clear_cut ? 1 : 0,
            truth.safe ? "-" : sim::to_string(truth.dangers.front().danger),
            gate::to_string(verdict.decision),
            gate::to_string(verdict.primary),
            reasons,
            e.has_worst_cell ? query.cos_yaw * dx + query.sin_yaw * dy : std::nan(""),
            e.has_worst_cell ? query.cos_yaw * dy - query.sin_yaw * dx : std::nan(""),
            0.1 * static_cast<double>(e.value_tenth_mm),
            0.1 * static_cast<double>(e.limit_tenth_mm),
            0.1 * static_cast<double>(e.max_drift_tenth_mm),
            1e3 * off_m,
            1e3 * plan_.relief_m,
            1e3 * plan_.size_m);
        out_.flush();
    }

    const Setup& setup_;
    Plan plan_;
    const Machine& rex_;
    Machine stairs_;
    sim::SceneSource& source_;
    DriftingSource& drifting_;
    const pipeline::Pipeline& pipeline_;
    fmt::ostream& out_;
    std::unique_ptr<grid::MapSnapshot> map_ = std::make_unique<grid::MapSnapshot>();
    std::size_t next_ = 0;
    bool left_ = false;
    std::optional<Error> error_;
};

Result<sim::SceneOptions> scene_options(const Setup& setup,
                                        const sim::SceneOptions& defaults,
                                        const std::string& file) {
    auto rig = sim::rig_preset("zed_vga");
    if (!rig) return rig.error();
    rig->T_body_left =
        sim::looking_down({0.075, 0.25, 0.05}, setup.pitch_deg * std::numbers::pi / 180.0);
    sim::SceneOptions options = defaults;
    options.scene = file;
    options.rig = std::move(*rig);
    options.seed = setup.seed;
    options.commanded = true;
    options.profile = sim::CameraProfile::zed;
    options.rate_hz = kRate_hz;
    if (!setup.images) {
        options.sensor = sim::Sensor::analytic;
        options.known_motion = true;
    } else {
        options.rate_hz = 5.0;  // The odometry needs this frame rate.
    }
    return options;
}

Status run(const Setup& setup,
           const Machine& rex,
           const std::string& scratch,
           Executor& executor,
           fmt::ostream& out) {
    auto settings = surefoot::load_settings();
    if (!settings) return settings.error();
    Plan plan = plan_of(setup);
    const std::string file = fmt::format(
        "{}/{}_{}.yaml", scratch, kScriptNames[static_cast<int>(setup.script)], setup.seed);
    if (auto written = io::write_file(file, plan.yaml); !written) return written;
    const auto options = scene_options(setup, settings->sim, file);
    if (!options) return options.error();
    auto source = sim::open_scene(*options, &executor);
    if (!source) return source.error();
    settings->pipeline.ground.expected_height_m =
        (*source)->truth().trajectory.front().T_world_body.translation_m.z();
    auto pipeline =
        pipeline::Pipeline::make(settings->pipeline, (*source)->rig(), executor, steady_now_ns);
    if (!pipeline) return pipeline.error();
    const double sign = setup.seed % 2 == 0 ? 1.0 : -1.0;
    DriftingSource drifting(**source, sign * setup.drift, setup.stated);
    Walk walk(setup, std::move(plan), rex, **source, drifting, *pipeline, out);
    app::RunSession session(*pipeline, drifting, (*source)->rig(), 1, settings->maps);
    session.drive("", [&](const FrameReport&) { walk.step(); });
    if (walk.error()) return *walk.error();
    if (session.record().error) return *session.record().error;
    return {};
}

void add_runs(Script script, std::uint64_t seed, std::vector<Setup>& all) {
    if (script == Script::tread) all.push_back({script, seed, 32.0});
    const double pitch_deg = script == Script::tread ? 65.0 : 32.0;
    all.push_back({script, seed, pitch_deg});
    if (script == Script::door) return;
    for (const double drift : {0.03, 0.05, 0.10})
        all.push_back({script, seed, pitch_deg, drift, Stated::own});
    for (const double drift : {0.03, 0.10})
        all.push_back({script, seed, pitch_deg, drift, Stated::told});
}

std::vector<Setup> runs_of(const std::string& name, std::uint64_t seed) {
    std::vector<Setup> all;
    for (const Script script : {Script::table, Script::door, Script::tread}) {
        if (name == kScriptNames[static_cast<int>(script)]) add_runs(script, seed, all);
        if (name == "quick") {
            const double pitch_deg = script == Script::tread ? 65.0 : 32.0;
            all.push_back({script, seed, pitch_deg});
            if (script != Script::door)
                all.push_back({script, seed, pitch_deg, 0.10, Stated::told});
        }
        if (name == "images" && script != Script::tread)
            all.push_back({script, seed, 32.0, 0.0, Stated::own, true});
    }
    return all;
}

}  // namespace
}  // namespace surefoot

// An uncaught exception ends the experiment and prints its message. This is intended.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    using namespace surefoot;
    if (argc < 4) {
        fmt::print(stderr,
                   "usage: memory_scripts OUT.csv FIRST_SEED SEEDS "
                   "[table | door | tread | quick | images]...\n");
        return 2;
    }
    const std::string file = argv[1];
    const auto first_seed = std::strtoull(argv[2], nullptr, 10);
    const auto seeds = std::strtoull(argv[3], nullptr, 10);
    std::vector<std::string> names(argv + 4, argv + argc);
    if (names.empty()) names = {"table", "door", "tread"};
    const auto machine = app::load_machine("rex");
    if (!machine) return app::report(machine.error());
    const auto executor = surefoot::make_executor();
    const std::string scratch = file + ".scenes";
    if (auto made = io::make_folder(scratch); !made) return app::report(made.error());
    auto out = fmt::output_file(file);
    out.print(
        "script,pitch_deg,seed,drift_percent,stated,look,holes,step,command,asked,forced,safe,"
        "clear,"
        "danger,verdict,primary,reasons,forward_m,left_m,value_mm,limit_mm,stated_drift_mm,off_mm,"
        "relief_mm,size_mm\n");
    for (std::uint64_t seed = first_seed; seed < first_seed + seeds; ++seed) {
        for (const std::string& name : names) {
            for (const Setup& setup : runs_of(name, seed)) {
                const Status done = run(setup, machine->value().machine, scratch, *executor, out);
                if (!done) return app::report(done.error());
            }
        }
        fmt::print(stderr, "seed {} done\n", seed);
    }
    return 0;
}
