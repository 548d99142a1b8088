// SPDX-License-Identifier: Apache-2.0
// How often does the gate allow a safe step on stairs, and how often a dangerous one?
// Usage: tread_steps OUT FIRST_SEED QUESTIONS
//
// Draws flights with risers of 150 to 195 mm and goings of 270 to 340 mm, half of them with a
// fault. A REX with movements of class stair stands on a tread and asks for one step up or down,
// with the toes 20 to 45 mm before the next riser; half of the steps differ from the going. The
// safety oracle says if the step is safe; a question without a clear answer is drawn again.
//
// The gate is asked on maps of the true surface with different cells, lines of nosings and errors
// (kVariants). OUT gets one line per kind of flight, direction, variant and outcome:
//   fault,direction,variant,what,count
//     what: safe, allowed (safe and OK), dangerous, missed (dangerous and OK), reason:NAME (of a
//     refused safe step), danger:NAME (the first danger of a missed step)
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "studies/runs/offline_map.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/gate/verdict_text.hpp"
#include "surefoot/grid/snapshot_builder.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/text.hpp"
#include "surefoot/sim/motion/planar.hpp"
#include "surefoot/sim/safety_oracle/safety_oracle.hpp"

namespace surefoot {
namespace {

using Eigen::Vector2d;

/// Steps of class stair: codes 1 to 7 go up by 270 to 330 mm, codes 11 to 17 back down.
constexpr int kLengths = 7;
constexpr int kFirstUp = 1;
constexpr int kFirstDown = 11;
constexpr double kShortest_m = 0.27;
constexpr double kLonger_m = 0.01;

constexpr sim::SafetyMargin kMargin{0.001, 0.001, 0.0};

enum class Fault : std::uint8_t { none, missing, object, worn, uneven, open_side, rail };
constexpr std::array<const char*, 7> kFaultNames{
    "none", "missing", "object", "worn", "uneven", "open_side", "rail"};

struct Variant {
    const char* name = "";
    double cell_m = 0.0;
    double noise_m = 0.0;        ///< standard deviation of the heights
    double line_sigma_m = -1.0;  ///< of the lines of the nosings; negative = no lines
};
constexpr std::array<Variant, 5> kVariants{{{"25 mm", 0.025},
                                            {"25 mm, lines", 0.025, 0.0, 0.001},
                                            {"10 mm", 0.010},
                                            {"10 mm, lines", 0.010, 0.0, 0.001},
                                            {"25 mm, lines, noise", 0.025, 0.003, 0.002}}};

/// Returns the REX with steps of class stair. ASSUMPTIONS: risers of up to 185 mm (the 180 mm of
/// the machine and 5 mm of tolerance of the building), and a heel that may hang over by 100 mm, so
/// that the ankle (126 mm from the heel) stands on the tread.
Machine climber(const Machine& rex) {
    Machine machine = rex;
    machine.movements = {};
    const auto set = [&](int code, double forward_m) {
        Movement& movement = machine.movements[static_cast<std::size_t>(code)];
        movement.configured = true;
        movement.movement_class = MovementClass::stair;
        // in range: at most 0.33 m
        movement.forward_tenth_mm = static_cast<std::int32_t>(std::lround(1e4 * forward_m));
    };
    for (int k = 0; k < kLengths; ++k) {
        set(kFirstUp + k, kShortest_m + kLonger_m * k);
        set(kFirstDown + k, -kShortest_m - kLonger_m * k);
    }
    machine.limits.step[static_cast<std::size_t>(MovementClass::stair)] = {true, 1'850, 1'850};
    machine.limits.tread_share_permille = 700;
    machine.limits.tread_overhang_tenth_mm = 1'000;
    return machine;
}

/// A flight along x, its floor at z = 0. Tread 0 is the floor, the last tread the landing.
struct Flight {
    Fault fault = Fault::none;
    std::vector<double> riser_x_m;  ///< position of the riser below tread k, index k - 1
    std::vector<double> tread_z_m;  ///< height of tread k, index k - 1
    double left_m = 0.0;
    double right_m = 0.0;
    int faulty = 0;  ///< the tread with the fault
    sim::Scene scene;
};

class Builder {
  public:
    Builder(Flight& flight, Rng& rng) : flight_(flight), rng_(rng) {
        material_ = flight.scene.add_material({});
    }
    void build() {
        const int treads = 5;
        const double rise_m = rng_.uniform(0.150, flight_.fault == Fault::uneven ? 0.180 : 0.195);
        const double going_m = rng_.uniform(0.27, 0.34);
        flight_.left_m = rng_.uniform(0.55, 0.90);
        flight_.right_m = -rng_.uniform(0.55, 0.90);
        if (flight_.fault == Fault::open_side) flight_.left_m = rng_.uniform(0.20, 0.42);
        flight_.scene.add_floor(
            sim::Floor({{-4.0, -3.0}, {6.0, 3.0}}, 0.0, {}), material_, material_);
        double z_m = 0.0;
        for (int k = 1; k <= treads; ++k) {
            z_m += rise_m;
            if (flight_.fault == Fault::uneven && k == flight_.faulty)
                z_m += rng_.uniform(0.010, 0.050);
            flight_.riser_x_m.push_back(0.4 + (k - 1) * going_m);
            flight_.tread_z_m.push_back(z_m);
        }
        for (int k = 1; k <= treads; ++k)
            add_tread(k, k == treads ? 5.0 : flight_.riser_x_m[at(k)]);
        if (flight_.fault == Fault::rail) {
            const double y_m = rng_.uniform(0.42, 0.56);
            box({0.0, 3.0}, {y_m, y_m + 0.04}, flight_.tread_z_m[0] + 0.7, 3.0);
        }
    }

  private:
    static std::size_t at(int k) { return static_cast<std::size_t>(k); }

    void box(const Vector2d& x, const Vector2d& y, double bottom_m, double top_m) {
        const std::vector<Vector2d> corners{{x[0], y[0]}, {x[1], y[0]}, {x[1], y[1]}, {x[0], y[1]}};
        flight_.scene.add(
            sim::Prism(corners, bottom_m, {top_m, Vector2d::Zero(), Vector2d::Zero()}),
            material_,
            sim::Label::step);
    }

    void add_tread(int k, double end_m) {
        const double begin_m = flight_.riser_x_m[at(k - 1)];
        const double top_m = flight_.tread_z_m[at(k - 1)];
        const Vector2d across(flight_.right_m, flight_.left_m);
        const bool faulty = k == flight_.faulty;
        if (faulty && flight_.fault == Fault::missing) return;
        if (faulty && flight_.fault == Fault::worn) {
            const double worn_m = rng_.uniform(0.02, 0.06);
            box({begin_m, begin_m + worn_m}, across, 0.0, top_m - rng_.uniform(0.02, 0.08));
            box({begin_m + worn_m, end_m}, across, 0.0, top_m);
            return;
        }
        box({begin_m, end_m}, across, 0.0, top_m);
        if (!faulty || flight_.fault != Fault::object) return;
        const double x_m = rng_.uniform(begin_m, begin_m + 0.25);
        const double y_m = rng_.uniform(-0.35, 0.35);
        const double size_m = rng_.uniform(0.03, 0.12);
        box({x_m, x_m + size_m}, {y_m, y_m + size_m}, top_m, top_m + rng_.uniform(0.03, 0.30));
    }

    Flight& flight_;
    Rng& rng_;
    int material_ = 0;
};

struct Question {
    Flight flight;
    Pose T_world_body;
    int command = 0;
    bool up = false;
    sim::SafetyAnswer truth;
};

Question draw_once(Rng& rng, const Machine& machine) {
    Question q;
    q.flight.fault = rng.uniform() < 0.5 ? Fault::none
                                         // in range: 1 to 6
                                         : static_cast<Fault>(1 + rng.below(6));
    q.up = rng.uniform() < 0.5;
    const int from = 1 + static_cast<int>(rng.below(3)) + (q.up ? 0 : 1);  // in range: at most 4
    q.flight.faulty = from + (q.up ? 1 : -1);
    Builder(q.flight, rng).build();
    const auto k = static_cast<std::size_t>(from);
    const double next_riser_m =
        k < q.flight.riser_x_m.size() ? q.flight.riser_x_m[k] : q.flight.riser_x_m.back() + 0.31;
    const double toe_m =
        1e-4 * (machine.left_foot.center_x_tenth_mm + 0.5 * machine.left_foot.length_tenth_mm);
    const double going_m = q.flight.riser_x_m[1] - q.flight.riser_x_m[0];
    q.T_world_body.translation_m = {next_riser_m - rng.uniform(0.020, 0.045) - toe_m,
                                    rng.uniform(-0.05, 0.05),
                                    q.flight.tread_z_m[k - 1] + 1e-4 * machine.sole_depth_tenth_mm};
    q.T_world_body.rotation = Eigen::AngleAxisd(rng.uniform(-0.02, 0.02), Eigen::Vector3d::UnitZ());
    const double wanted_m = going_m + (rng.uniform() < 0.5 ? 0.0 : rng.uniform(-0.03, 0.03));
    const auto longer = std::lround((wanted_m - kShortest_m) / kLonger_m);
    // in range: 0 to 6
    const int length = static_cast<int>(std::clamp<long>(longer, 0, kLengths - 1));
    q.command = (q.up ? kFirstUp : kFirstDown) + length;
    q.truth = sim::judge(q.flight.scene, machine, q.T_world_body, q.command, kMargin);
    return q;
}

Question draw(std::uint64_t seed, const Machine& machine) {
    Rng rng(seed);
    while (true) {
        Question q = draw_once(rng, machine);
        if (q.truth.clear_cut && !q.truth.has(sim::Danger::no_stance)) return q;
    }
}

double top_at(const sim::Scene& scene, const Vector2d& p_m) {
    const auto height = scene.height_at(p_m.x(), p_m.y());
    return height ? height->z_m : std::nan("");
}

/// A map of the true surface: the median of nine points in each cell, plus noise.
Status map_of(const Question& q, const Variant& variant, Rng& rng, grid::MapSnapshot& out) {
    constexpr double kHalf_m = 1.2;
    grid::SnapshotInput input;
    // in range: at most 240
    const int cells = static_cast<int>(std::lround(2.0 * kHalf_m / variant.cell_m));
    const Vector2d middle_m = q.T_world_body.translation_m.head<2>();
    input.geometry = {variant.cell_m, cells, cells, middle_m - Vector2d(kHalf_m, kHalf_m)};
    for (double& origin : input.geometry.origin_m)
        origin = variant.cell_m * std::round(origin / variant.cell_m);
    Image<float> height(cells, cells);
    Image<float> variance(
        cells, cells, static_cast<float>(std::pow(std::max(variant.noise_m, 0.001), 2)));
    Image<float> drift(cells, cells, 0.0F);
    for (int v = 0; v < cells; ++v) {
        for (int u = 0; u < cells; ++u) {
            std::array<double, 9> z_m{};
            for (int k = 0; k < 9; ++k) {
                const Vector2d offset(k % 3 - 1, k / 3 - 1);
                z_m[static_cast<std::size_t>(k)] =
                    top_at(q.flight.scene,
                           input.geometry.center_m({u, v}) + variant.cell_m / 3.0 * offset);
            }
            std::nth_element(z_m.begin(), z_m.begin() + 4, z_m.end());
            height.at(u, v) = static_cast<float>(z_m[4] + variant.noise_m * rng.normal());
        }
    }
    input.height_m = height.view();
    input.variance_m2 = variance.view();
    input.drift_m = drift.view();
    std::vector<grid::SnapshotInput::Edge> edges;
    for (std::size_t k = 0; variant.line_sigma_m >= 0.0 && k < q.flight.riser_x_m.size(); ++k) {
        const bool there =
            !(q.flight.fault == Fault::missing && static_cast<int>(k) + 1 == q.flight.faulty);
        if (!there) continue;
        const double x_m = q.flight.riser_x_m[k] + variant.line_sigma_m * rng.normal();
        const double low_m = k == 0 ? 0.0 : q.flight.tread_z_m[k - 1];
        edges.push_back({{x_m, q.flight.left_m},  // the lower ground lies on the right
                         {x_m, q.flight.right_m},
                         q.flight.tread_z_m[k],
                         low_m,
                         0.001,
                         variant.line_sigma_m});
    }
    input.edges = edges;
    input.T_odom_body = q.T_world_body;
    input.frame_time_ns = input.pose_time_ns = 1'000'000'000;
    input.gravity_source = grid::GravitySource::plane;
    input.tilt_sigma_rad = 0.0;
    input.health = grid::SnapshotHealth::ok;
    input.camera = CameraState::ok;
    input.version = 1;
    return grid::build_snapshot(input, out);
}

using Tally = std::map<std::string, int>;

void count(const Question& q, const Variant& variant, const gate::Verdict& verdict, Tally& tally) {
    const auto add = [&](const std::string& what) {
        ++tally[fmt::format("{},{},\"{}\",{}",
                            kFaultNames[static_cast<std::size_t>(q.flight.fault)],
                            q.up ? "up" : "down",
                            variant.name,
                            what)];
    };
    const bool ok = verdict.decision == gate::Decision::ok;
    add(q.truth.safe ? "safe" : "dangerous");
    if (q.truth.safe && ok) add("allowed");
    if (q.truth.safe && !ok) {
        for (const std::string_view name : gate::names_of(verdict.reasons))
            add(fmt::format("reason:{}", name));
    }
    if (!q.truth.safe && ok) {
        add("missed");
        add(fmt::format("danger:{}", sim::to_string(q.truth.dangers.front().danger)));
    }
}

Status ask(std::uint64_t seed, const Machine& machine, grid::MapSnapshot& map, Tally& tally) {
    const Question q = draw(seed, machine);
    for (const Variant& variant : kVariants) {
        Rng rng(mix_seed(seed, 7));
        if (auto made = map_of(q, variant, rng, map); !made) return made;
        const gate::Query query = gate::query_at_body(static_cast<std::uint8_t>(q.command), map);
        count(q, variant, app::decide_offline(machine, query, map), tally);
    }
    return {};
}

int run(const std::vector<std::string>& words) {
    const auto first = words.size() == 3 ? io::parse_int64(words[1]) : std::nullopt;
    const auto questions = words.size() == 3 ? io::parse_int64(words[2]) : std::nullopt;
    if (!first || !questions) {
        return app::report(usage_error("tread_steps OUT FIRST_SEED QUESTIONS"));
    }
    const auto file = app::load_machine("rex");
    if (!file) return app::report(file.error());
    const Machine machine = climber((*file)->machine);
    const auto map = std::make_unique<grid::MapSnapshot>();
    Tally tally;
    for (std::int64_t k = 0; k < *questions; ++k)
        if (auto done =
                ask(mix_seed(static_cast<std::uint64_t>(*first), static_cast<std::uint64_t>(k)),
                    machine,
                    *map,
                    tally);
            !done)
            return app::report(done.error());
    std::string csv = "fault,direction,variant,what,count\n";
    for (const auto& [key, number] : tally) csv += fmt::format("{},{}\n", key, number);
    const auto written = io::write_file(words[0], csv);
    return written ? 0 : app::report(written.error());
}

}  // namespace
}  // namespace surefoot

int main(int argc, char** argv) {
    return surefoot::run({argv + 1, argv + argc});
}
