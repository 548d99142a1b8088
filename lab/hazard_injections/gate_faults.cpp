// SPDX-License-Identifier: Apache-2.0
// Faults at the inputs of the gate: snapshots, clocks, configuration, log, and queries of
// clients. Perception is simulated as level ground at 15 Hz, 45 ms after each frame.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "lab/hazard_injections/fault_bench.hpp"
#include "service/gate_process/audit/audit_record.hpp"
#include "service/gate_process/audit/audit_writer.hpp"
#include "service/gate_process/audit/memory_disk_testing.hpp"
#include "service/gate_process/protocol/rosbridge_session.hpp"
#include "service/gate_process/query_zone.hpp"
#include "surefoot/core/angles.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/machines/built_in_machines.hpp"

namespace surefoot::experiments {
namespace {

using grid::MapSnapshot;

constexpr std::int64_t kProcessing_ns = 45 * kMs;
constexpr std::int64_t kSecond_ns = 1'000 * kMs;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A position on the ground with a direction.
struct Place {
    Eigen::Vector2d center_m;
    double yaw_rad = 0.0;

    /// Returns a map point in the axes of the place: x along its direction, y to the left.
    [[nodiscard]] Eigen::Vector2d local(const Eigen::Vector2d& p_m) const {
        const Eigen::Vector2d d = p_m - center_m;
        const double c = std::cos(yaw_rad);
        const double s = std::sin(yaw_rad);
        return {c * d.x() + s * d.y(), c * d.y() - s * d.x()};
    }
    [[nodiscard]] Place at(double along_m, double across_m) const {
        const double c = std::cos(yaw_rad);
        const double s = std::sin(yaw_rad);
        return {center_m + Eigen::Vector2d(c * along_m - s * across_m, s * along_m + c * across_m),
                yaw_rad};
    }
};

/// Level ground under the machine, as perception publishes it.
struct Perceived {
    const Machine& machine;
    GateBench& bench;
    Rng& rng;
    gate::testing::Terrain terrain;
    Place body;

    /// Returns the pose of base_link after the queried movement.
    [[nodiscard]] Place target() const {
        const Movement& m = machine.movements[bench.command()];
        Place place = body.at(m.forward_tenth_mm * 1e-4, m.left_tenth_mm * 1e-4);
        place.yaw_rad += std::atan2(m.sin_turn, m.cos_turn);
        return place;
    }
    /// Returns the pose of a landing foot, which is chosen at random.
    [[nodiscard]] Place landing() {
        const GroundBox& foot = rng.below(2) == 0 ? machine.left_foot : machine.right_foot;
        return target().at(foot.center_x_tenth_mm * 1e-4, foot.center_y_tenth_mm * 1e-4);
    }
    /// Returns true if a point lies under a standing foot or within 30 mm of it.
    [[nodiscard]] bool is_stood_on(const Eigen::Vector2d& p_m) const {
        constexpr double kMargin_m = 0.03;
        for (const GroundBox* foot : {&machine.left_foot, &machine.right_foot}) {
            const Eigen::Vector2d d =
                body.at(foot->center_x_tenth_mm * 1e-4, foot->center_y_tenth_mm * 1e-4).local(p_m);
            if (std::abs(d.x()) < 0.5e-4 * foot->length_tenth_mm + kMargin_m &&
                std::abs(d.y()) < 0.5e-4 * foot->width_tenth_mm + kMargin_m)
                return true;
        }
        return false;
    }
    /// Calls `change(u, v, along_m, across_m)` for every cell. along_m and across_m are relative to
    /// `place`.
    template <typename Change>
    void each_cell(const Place& place, Change change) {
        for (int v = 0; v < terrain.geometry.ny; ++v) {
            for (int u = 0; u < terrain.geometry.nx; ++u) {
                const Eigen::Vector2d p = place.local(terrain.geometry.center_m({u, v}));
                change(u, v, p.x(), p.y());
            }
        }
    }
    /// Sets all cells within a disc to a value.
    void disc(grid::Layer& layer, const Place& place, double radius_m, double value) {
        each_cell(place, [&](int u, int v, double x, double y) {
            if (std::hypot(x, y) <= radius_m) layer.at(u, v) = static_cast<float>(value);
        });
    }
};

/// A fault of the snapshots.
struct Fault {
    std::string variant;
    std::function<void(MapSnapshot&)> change = {};  ///< applied before the snapshot is sealed
    std::function<void(MapSnapshot&)> damage = {};  ///< applied after the snapshot is sealed
    std::unique_ptr<MapSnapshot> other = {};        ///< replaces the clean snapshot
};
using Draw = std::function<Fault(Perceived&)>;

Place somewhere(Rng& rng) {
    return {{rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5)},
            rng.uniform(-std::numbers::pi, std::numbers::pi)};
}

/// Publishes snapshots until the bench ends. After the fault began, publishes the snapshots of
/// `draw`.
void perceive(Perceived& perceived, const Draw& draw) {
    GateBench& bench = perceived.bench;
    Pose& T_odom_body = perceived.terrain.input.T_odom_body;
    T_odom_body.translation_m.head<2>() = perceived.body.center_m;
    T_odom_body.rotation = Eigen::AngleAxisd(perceived.body.yaw_rad, Eigen::Vector3d::UnitZ());
    const auto clean = perceived.terrain.snapshot();
    auto shown = std::make_unique<MapSnapshot>();
    std::optional<Fault> fault;
    std::uint64_t version = 0;
    for (std::int64_t arrival_ns = bench.now_ns(); !bench.is_over();
         arrival_ns += kFramePeriod_ns) {
        bench.pass_until(arrival_ns + kProcessing_ns);
        const bool faulty = bench.is_faulty(arrival_ns);
        if (faulty && draw && !fault) {
            fault = draw(perceived);
            bench.outcome().variant = fault->variant;
        }
        *shown = fault && fault->other ? *fault->other : *clean;
        shown->version = ++version;
        shown->frame_time_ns = shown->pose_time_ns = arrival_ns;
        if (fault && fault->change) fault->change(*shown);
        grid::seal(*shown);
        if (fault && fault->damage) fault->damage(*shown);
        bench.writer().publish(*shown);
    }
}

/// Returns a run with a fault in the snapshots.
std::function<Result<Outcome>(std::uint64_t, bool)> with_snapshots(const Machine& machine,
                                                                   Draw draw) {
    return [machine, draw = std::move(draw)](std::uint64_t seed, bool faulty) -> Result<Outcome> {
        GateBench::Plan plan;
        plan.faulty = faulty;
        GateBench bench(machine, fast_warm_up(), plan, seed);
        Rng rng(mix_seed(seed, 2));
        Perceived perceived{machine, bench, rng, {}, somewhere(rng)};
        perceive(perceived, draw);
        return bench.outcome();
    };
}

/// Function that prepares the bench for a fault outside the snapshots.
using Prepare = std::function<void(GateBench&, Rng&)>;
std::function<Result<Outcome>(std::uint64_t, bool)> with_bench(const Machine& machine,
                                                               GateBench::Plan plan,
                                                               Prepare prepare) {
    return [machine, plan, prepare = std::move(prepare)](std::uint64_t seed,
                                                         bool faulty) -> Result<Outcome> {
        GateBench::Plan drawn = plan;
        drawn.faulty = faulty;
        GateBench bench(machine,
                        drawn.lasts_ns > kSecond_ns ? gate::ReadinessLimits{} : fast_warm_up(),
                        drawn,
                        seed);
        Rng rng(mix_seed(seed, 2));
        prepare(bench, rng);
        Perceived perceived{machine, bench, rng, {}, somewhere(rng)};
        perceive(perceived, {});
        return bench.outcome();
    };
}

GateBench::Plan at_once() {
    GateBench::Plan plan;
    plan.deadline_ns = 0;
    return plan;
}

// --- H8, H16, H20: numbers of a snapshot ---

/// base_link jumps farther than the machine can move between two snapshots (readiness.hpp). It
/// stays at the new position.
Fault jump(Perceived& p) {
    const auto shift = [](double x_m, double y_m, double z_m, std::string what) {
        return Fault{std::move(what), [=](MapSnapshot& map) {
                         map.body_x_tenth_mm += std::llround(1e4 * x_m);
                         map.body_y_tenth_mm += std::llround(1e4 * y_m);
                         map.body_z_tenth_mm += std::llround(1e4 * z_m);
                     }};
    };
    const double sign = p.rng.below(2) == 0 ? -1.0 : 1.0;
    switch (p.rng.below(3)) {
        case 0: {
            const double by_m = p.rng.uniform(0.12, 1.0);
            const double to_rad = p.rng.uniform(-std::numbers::pi, std::numbers::pi);
            return shift(by_m * std::cos(to_rad),
                         by_m * std::sin(to_rad),
                         0.0,
                         fmt::format("{:.0f} mm", 1e3 * by_m));
        }
        case 1: {
            const double by_m = sign * p.rng.uniform(0.12, 1.0);
            return shift(0.0, 0.0, by_m, fmt::format("{:.0f} mm in height", 1e3 * by_m));
        }
        default: {
            const double by_deg = sign * p.rng.uniform(10.0, 180.0);
            const double yaw_rad = p.body.yaw_rad + by_deg * kRadPerDeg;
            return {fmt::format("{:.0f} deg of yaw", by_deg), [yaw_rad](MapSnapshot& map) {
                        map.body_cos_yaw = std::cos(yaw_rad);
                        map.body_sin_yaw = std::sin(yaw_rad);
                    }};
        }
    }
}

Fault wrong_stamp(Perceived& p) {
    const std::int64_t by_ns = static_cast<std::int64_t>(p.rng.uniform(21.0, 500.0) * kMs);
    const std::int64_t fault_ns = p.bench.fault_ns();
    const bool of_frame = p.rng.below(2) == 0;
    const auto stamp = [of_frame](MapSnapshot& map) -> std::int64_t& {
        return of_frame ? map.frame_time_ns : map.pose_time_ns;
    };
    const char* whose = of_frame ? "frame" : "pose";
    if (p.rng.below(2) == 0)
        return {fmt::format("{} {} ms ahead of now", whose, by_ns / kMs),
                [=](MapSnapshot& map) { stamp(map) += kProcessing_ns + by_ns; }};
    return {fmt::format("{} stamps run backwards", whose), [=](MapSnapshot& map) {
                stamp(map) = fault_ns - (stamp(map) - fault_ns) - kFramePeriod_ns;
            }};
}

Fault bad_number(Perceived& p) {
    const double bad[] = {kNan, kInfinity, -kInfinity, 1e300, 2.0, 0.0};
    switch (p.rng.below(4)) {
        case 0: {
            const double value = bad[p.rng.below(6)];
            const bool sine = p.rng.below(2) == 0;
            return {fmt::format("{} of yaw is {}", sine ? "sine" : "cosine", value),
                    [=](MapSnapshot& map) {
                        (sine ? map.body_sin_yaw : map.body_cos_yaw) = value;
                        if (value == 0.0) map.body_cos_yaw = map.body_sin_yaw = 0.0;
                    }};
        }
        case 1: {
            const std::int64_t far =
                std::numeric_limits<std::int64_t>::max() >> static_cast<int>(p.rng.below(30));
            return {fmt::format("pose at {} tenths of a mm", far),
                    [=](MapSnapshot& map) { map.body_x_tenth_mm = far; }};
        }
        case 2: {  // flips one bit of any byte; the checksums do not change
            const std::size_t byte =
                offsetof(MapSnapshot, version) +
                p.rng.below(offsetof(MapSnapshot, height_tenth_mm) +
                            sizeof(std::int32_t) * 240 * 240 - offsetof(MapSnapshot, version));
            const auto bit = static_cast<unsigned char>(1U << p.rng.below(8));
            return {fmt::format("bit of byte {}", byte), {}, [=](MapSnapshot& map) {
                        reinterpret_cast<unsigned char*>(&map)[byte] ^= bit;
                    }};
        }
        default: {
            const auto height = static_cast<std::int32_t>(p.rng.next_u64() >> 33U) + 10'000;
            return {fmt::format("all heights {} tenths of a mm", height), [=](MapSnapshot& map) {
                        for (int i = 0; i < map.nx * map.ny; ++i)
                            map.height_tenth_mm[static_cast<std::size_t>(i)] =
                                i % 2 == 0 ? height : -height;
                    }};
        }
    }
}

// --- H9 to H15: what the map says of the ground, from one snapshot to the next ---

Fault rebuilt(Perceived& p, std::string variant) {
    return {std::move(variant), {}, {}, p.terrain.snapshot()};
}

Fault drifted(Perceived& p) {
    const double drift_m = p.rng.uniform(0.0255, 0.2);
    const double radius_m = p.rng.uniform(0.05, 1.0);
    p.disc(p.terrain.drift, p.landing(), radius_m, drift_m);
    return rebuilt(
        p,
        fmt::format(
            "1 sigma of {:.0f} mm within {:.0f} mm of the landing", 1e3 * drift_m, 1e3 * radius_m));
}

Fault unknown(Perceived& p) {
    const auto hide = [&](int u, int v) {
        p.terrain.height.at(u, v) = p.terrain.variance.at(u, v) = kNanF;
    };
    Place hole = p.landing();
    hole = hole.at(p.rng.uniform(-0.15, 0.15), p.rng.uniform(-0.07, 0.07));
    if (p.rng.below(3) == 0) {
        const grid::GridGeometry& g = p.terrain.geometry;
        hide(static_cast<int>((hole.center_m.x() - g.origin_m.x()) / g.resolution_m),
             static_cast<int>((hole.center_m.y() - g.origin_m.y()) / g.resolution_m));
        return rebuilt(p, "one cell under a landing foot");
    }
    const double radius_m = p.rng.below(4) == 0 ? 10.0 : p.rng.uniform(0.03, 0.5);
    p.each_cell(hole, [&](int u, int v, double x, double y) {
        if (std::hypot(x, y) <= radius_m) hide(u, v);
    });
    return rebuilt(p,
                   radius_m > 9.0 ? std::string("the whole map")
                                  : fmt::format("a disc of {:.0f} mm", 2e3 * radius_m));
}

/// The ground drops beyond a line through a landing foot; the drop may be smeared into a ramp.
Fault drop(Perceived& p) {
    const double drop_m = p.rng.uniform(0.075, 1.0);
    const double smear_m = p.rng.below(2) == 0 ? 0.0 : p.rng.uniform(0.0, 0.5);
    Place edge = p.landing();
    edge.yaw_rad = p.rng.uniform(-std::numbers::pi, std::numbers::pi);
    p.each_cell(edge, [&](int u, int v, double along_m, double) {
        const double share =
            smear_m > 0.0 ? std::clamp(along_m / smear_m, 0.0, 1.0) : (along_m > 0.0 ? 1.0 : 0.0);
        p.terrain.height.at(u, v) = static_cast<float>(-share * drop_m);
    });
    return rebuilt(p, fmt::format("{:.0f} mm over {:.0f} mm", 1e3 * drop_m, 1e3 * smear_m));
}

Fault unsure(Perceived& p) {
    const double sigma_m = p.rng.uniform(0.008, 0.06);
    p.disc(p.terrain.variance, p.landing(), p.rng.uniform(0.1, 1.0), sigma_m * sigma_m);
    return rebuilt(p, fmt::format("sigma of {:.0f} mm under a landing foot", 1e3 * sigma_m));
}

/// A table: its top is mapped as ground, or it hangs over ground that was observed under it. There
/// is always floor under the standing feet.
Fault overhang(Perceived& p) {
    const double top_m = p.rng.uniform(0.4, 1.2);
    const Place table = p.target().at(p.rng.uniform(-0.2, 0.2), p.rng.uniform(-0.2, 0.2));
    const double radius_m = p.rng.uniform(0.15, 0.6);
    const bool hangs = p.rng.below(2) == 0;
    grid::Layer& layer = hangs ? p.terrain.clearance : p.terrain.height;
    p.each_cell(table, [&](int u, int v, double x, double y) {
        if (std::hypot(x, y) <= radius_m && !p.is_stood_on(p.terrain.geometry.center_m({u, v})))
            layer.at(u, v) = static_cast<float>(top_m);
    });
    return rebuilt(p,
                   fmt::format("{:.0f} mm high, {}", 1e3 * top_m, hangs ? "hangs" : "as ground"));
}

/// All ground is higher or lower than the true ground, also under the feet.
Fault raised(Perceived& p) {
    const double by_m = p.rng.uniform(0.1, 1.0) * (p.rng.below(2) == 0 ? -1.0 : 1.0);
    p.terrain.height.fill(static_cast<float>(by_m));
    return rebuilt(p, fmt::format("{:.0f} mm", 1e3 * by_m));
}

/// A wall beside the feet, within the width of the body at the target pose.
Fault wall(Perceived& p) {
    const double beside_m = p.rng.uniform(0.30, 0.44) * (p.rng.below(2) == 0 ? -1.0 : 1.0);
    const double half_length_m = p.rng.uniform(0.2, 1.0);
    const double top_m = p.rng.uniform(0.8, 2.0);
    p.each_cell(p.target(), [&](int u, int v, double along_m, double across_m) {
        if (std::abs(across_m - beside_m) < 0.04 && std::abs(along_m) < half_length_m)
            p.terrain.height.at(u, v) = static_cast<float>(top_m);
    });
    return rebuilt(p, fmt::format("{:.0f} mm beside base_link", 1e3 * std::abs(beside_m)));
}

// --- H17 to H19, H22, H25, H28: clocks, clients, processes, disks ---

void break_clock(GateBench& bench, Rng& rng) {
    const double by_s = std::pow(10.0, rng.uniform(std::log10(0.11), std::log10(3600.0)));
    const auto by_ns = static_cast<std::int64_t>(by_s * 1e9);
    const auto how = rng.below(3);
    bench.outcome().variant = fmt::format("{} {:.1f} s",
                                          how == 0   ? "slept"
                                          : how == 1 ? "slept less by"
                                                     : "steady time back by",
                                          by_s);
    bench.set_begin([&bench, by_ns, how] {
        if (how == 0) bench.sleep(by_ns);
        if (how == 1) bench.sleep(-by_ns);
        if (how == 2) bench.step_clock(-by_ns);
    });
}

void repeat_sequences(GateBench& bench, Rng& rng) {
    const bool copies = rng.below(2) == 0;
    const std::uint64_t back = 1 + rng.below(10);
    bench.outcome().variant = copies ? "copies" : fmt::format("{} too old", back);
    bench.set_ask([&bench, copies, back](std::int64_t now_ns, bool faulty) {
        if (!faulty) return bench.ask_step(now_ns);
        const std::uint64_t last = bench.sequence();
        return bench.ask_step(copies || back >= last ? last : last - back, bench.command(), now_ns);
    });
}

/// Damages the text of a query. `variant` describes the damage.
std::string broken_text(const std::string& whole, Rng& rng, std::string& variant) {
    switch (rng.below(5)) {
        case 0: {
            const std::size_t length = rng.below(whole.size());
            variant = fmt::format("cut after {} bytes", length);
            return whole.substr(0, length);
        }
        case 1: variant = "two at once"; return whole + whole;
        case 2:
            variant = "5 MB of blanks in front";
            return std::string(std::size_t{5} << 20U, ' ') + whole;
        case 3:
            variant = "a direction that is a text";
            {
                std::string text = whole;
                const std::size_t at = text.find('[');
                return text.replace(at, text.find(']') - at + 1, R"(["9"])");
            }
        default:
            variant = "bytes that are no UTF-8";
            {
                std::string text = whole;
                text.insert(text.find("step"), "\xc3\x28");
                return text;
            }
    }
}

void break_messages(GateBench& bench, Rng& rng) {
    const auto session = std::make_shared<gate_process::RosbridgeSession>(
        21,
        bench.keeper(),
        gate_process::SessionLimits{},
        gate_process::SessionRights{gate_process::Role::rider});
    const auto draws = std::make_shared<Rng>(rng.next_u64());
    bench.set_ask([&bench, session, draws](std::int64_t now_ns, bool faulty) {
        std::string text = fmt::format(
            R"({{"op":"call_service","id":"q","service":"/surefoot/step","args":[{}]}})",
            bench.command());
        std::string variant;
        if (faulty) text = broken_text(text, *draws, variant);
        if (faulty && bench.outcome().variant.empty()) bench.outcome().variant = variant;
        const gate_process::Reaction reaction = session->on_message(text, now_ns);
        bool allowed = false;
        for (const std::string& reply : reaction.replies)
            allowed = allowed || reply.find(R"("verdict":"OK")") != std::string::npos;
        return GateBench::Heard{allowed, gate::Reason::bad_message};
    });
}

void restart(GateBench& bench, Rng& rng) {
    bench.outcome().variant = "started anew";
    std::ignore = rng;
    bench.set_begin([&bench] { bench.restart_gate(); });
}

/// The log of an assured gate fails, because its disk is full or broken.
void fill_disk(GateBench& bench, Rng& rng) {
    struct Log {
        std::shared_ptr<gate_process::testing::Platter> platter =
            std::make_shared<gate_process::testing::Platter>();
        std::optional<gate_process::AuditWriter> writer;
        bool failing = false;
    };
    const auto log = std::make_shared<Log>();
    const Machine machine = machines::load_machine("rex")->machine;
    log->writer.emplace(machine,
                        std::make_unique<gate_process::testing::MemoryDisk>(log->platter),
                        gate_process::AuditFiles{});
    bench.set_audit(
        [&bench, log, machine](const gate_process::Judgement& j, const MapSnapshot& map) {
            const gate_process::AuditedVerdict audited{j.query, j.health, j.now_ns, map, j.verdict};
            const gate_process::CellBox zone = gate_process::query_zone(machine, j.query, map, 0);
            std::string record(gate_process::record_bytes(audited, zone), '\0');
            gate_process::write_record(1, audited, zone, record.data());
            const bool written = log->writer->open().ok() &&
                                 log->writer->write(gate_process::FrameKind::verdict, record).ok();
            bench.keeper().set_log_failing(!written);
        });
    const int error = rng.below(2) == 0 ? 0 : EIO;
    bench.outcome().variant = error == 0 ? "full" : "EIO";
    bench.set_begin([log, error] {
        log->platter->set([&](gate_process::testing::Platter& platter) {
            platter.write_error = error;
            if (error == 0) platter.room = platter.used() + 100;
        });
    });
}

void unknown_command(const Machine& machine, GateBench& bench, Rng& rng) {
    std::vector<std::uint8_t> codes;
    for (int code = 0; code < 256; ++code) {
        if (code >= Machine::kMovementCodes ||
            !machine.movements[static_cast<std::size_t>(code)].configured)
            codes.push_back(static_cast<std::uint8_t>(code));
    }
    const auto draws = std::make_shared<Rng>(rng.next_u64());
    bench.outcome().variant = "codes without a movement, a new random one each time";
    bench.set_ask([&bench, draws, codes](std::int64_t now_ns, bool faulty) {
        if (!faulty) return bench.ask_step(now_ns);
        return bench.ask_step(
            bench.sequence() + 1 + draws->below(2), codes[draws->below(codes.size())], now_ns);
    });
}

// --- H26, H27: configurations ---

/// Makes one error in the text of a machine file. `variant` describes the error.
std::string broken_file(std::string_view whole, Rng& rng, std::string& variant) {
    std::vector<std::string> lines;
    for (std::size_t at = 0; at < whole.size();) {
        const std::size_t end = std::min(whole.find('\n', at), whole.size());
        lines.emplace_back(whole.substr(at, end - at));
        at = end + 1;
    }
    // The lines of the file that set one key.
    std::vector<std::size_t> keyed;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const std::size_t colon = lines[i].find(": ");
        if (!lines[i].empty() && lines[i].find_first_not_of(' ') != std::string::npos &&
            lines[i][lines[i].find_first_not_of(' ')] != '#' &&
            lines[i].find_first_of("{-") > colon && colon != std::string::npos &&
            lines[i].find("name:") == std::string::npos)
            keyed.push_back(i);
    }
    std::string& line = lines[keyed[rng.below(keyed.size())]];
    const std::size_t first = line.find_first_not_of(' ');
    const std::size_t colon = line.find(": ");
    const std::string key = line.substr(first, colon - first);
    switch (rng.below(5)) {
        case 0:
            line.erase(first + 1 + rng.below(key.size() - 1), 1);
            variant = "key " + key + " without one letter";
            break;
        case 1:
            line.clear();
            variant = "key " + key + " is missing";
            break;
        case 2:
            line += "\n" + line;
            variant = "key " + key + " is there twice";
            break;
        case 3:
            line = line.substr(0, colon + 2) + ".nan";
            variant = "key " + key + " is no number";
            break;
        default:
            line = line.substr(0, colon + 2) + "123456";
            variant = "key " + key + " is 123456";
            break;
    }
    std::string text;
    for (const std::string& each : lines) text += each + "\n";
    return text;
}

/// Starts the gate with a machine file. If the gate refuses the file, the outcome is an inhibit at
/// once. Otherwise the bench queries the gate as in every other run.
Result<Outcome> start_with(const Result<io::MachineFile>& file,
                           const gate::ReadinessLimits& limits,
                           const std::string& variant,
                           std::uint64_t seed,
                           bool faulty) {
    Outcome refused;
    refused.variant = variant;
    refused.latency_ns = 0;
    refused.reason = gate::Reason::config;
    if (!file) return refused;  // The gate does not start, so no query gets an answer.
    GateBench::Plan plan;
    plan.faulty = faulty;
    plan.deadline_ns = 0;
    plan.from_the_start = faulty;
    plan.lasts_ns = 4 * kSecond_ns;
    if (!faulty) plan.lasts_ns = 600 * kMs;
    GateBench bench(file->machine, limits, plan, seed);
    if (faulty) bench.set_command(9);
    Rng rng(mix_seed(seed, 3));
    Perceived perceived{file->machine, bench, rng, {}, somewhere(rng)};
    perceive(perceived, {});
    bench.outcome().variant = variant;
    return bench.outcome();
}

Result<Outcome> wrong_file(std::uint64_t seed, bool faulty) {
    auto text = machines::find_resource(machines::built_in_machines(), "machines", "rex");
    if (!text) return text.error();
    Rng rng(mix_seed(seed, 2));
    std::string variant;
    const std::string given = faulty ? broken_file(*text, rng, variant) : *text;
    return start_with(io::parse_machine(given, "rex.yaml"), {}, variant, seed, faulty);
}

/// The hash of the configuration changes while the gate runs.
Fault other_configuration(Perceived& p) {
    const std::uint64_t hash = p.rng.next_u64();
    return {"another hash", [hash](MapSnapshot& map) { map.config_hash = hash; }};
}

/// Sets one limit, which the seed selects, to a value that would switch its rule off.
Result<Outcome> switched_off(const io::MachineFile& whole, std::uint64_t seed, bool faulty) {
    io::MachineFile file = whole;
    gate::ReadinessLimits limits;
    GateLimits& l = file.machine.limits;
    struct Knob {
        const char* name;
        std::function<void()> turn;
    };
    constexpr std::int64_t kHour_ns = 3600 * kSecond_ns;
    const std::vector<Knob> knobs{
        {"frame_age 0", [&] { l.frame_age_ns = 0; }},
        {"frame_age 1 h", [&] { l.frame_age_ns = kHour_ns; }},
        {"frame_age -1", [&] { l.frame_age_ns = -1; }},
        {"pose_age 0", [&] { l.pose_age_ns = 0; }},
        {"pose_age 1 h", [&] { l.pose_age_ns = kHour_ns; }},
        {"future_tolerance 1 h", [&] { l.future_tolerance_ns = kHour_ns; }},
        {"future_tolerance -1", [&] { l.future_tolerance_ns = -1; }},
        {"verdict_ttl 0", [&] { l.verdict_ttl_ns = 0; }},
        {"verdict_ttl 1 h", [&] { l.verdict_ttl_ns = kHour_ns; }},
        {"drift 0", [&] { l.drift_tenth_mm = 0; }},
        {"drift 1 m", [&] { l.drift_tenth_mm = 10'000; }},
        {"drop 0", [&] { l.drop_tenth_mm = 0; }},
        {"drop 1 m", [&] { l.drop_tenth_mm = 10'000; }},
        {"drop_band 0", [&] { l.drop_band_tenth_mm = 0; }},
        {"drop_evidence 0", [&] { l.drop_evidence = 0; }},
        {"swing_clearance 1 m", [&] { l.swing_clearance_tenth_mm = 10'000; }},
        {"swing_clearance 0", [&] { l.swing_clearance_tenth_mm = 0; }},
        {"foot_margin -1", [&] { l.foot_margin_tenth_mm = -1; }},
        {"patch_sigma 0", [&] { l.patch_sigma_tenth_mm = 0; }},
        {"patch_sigma 1 m", [&] { l.patch_sigma_tenth_mm = 10'000; }},
        {"patch_residual 1 m", [&] { l.patch_residual_tenth_mm = 10'000; }},
        {"cell_sigma 1 m", [&] { l.cell_sigma_tenth_mm = 10'000; }},
        {"sigma_factor 0", [&] { l.sigma_factor = 0.0; }},
        {"sigma_factor NaN", [&] { l.sigma_factor = kNan; }},
        {"independent cells 1000", [&] { l.patch_independent_cells = 1000; }},
        {"tilt 90 deg", [&] { l.min_normal_z = 0.0; }},
        {"tilt NaN", [&] { l.min_normal_z = kNan; }},
        {"step 1 m", [&] { l.step[0].up_tenth_mm = 10'000; }},
        {"attestation radius 100 m", [&] { l.attestation_radius_tenth_mm = 1'000'000; }},
        {"body without parts", [&] { file.machine.body.count = 0; }},
        {"sway -1", [&] { file.machine.body.sway_tenth_mm = -1; }},
        {"foot without length", [&] { file.machine.left_foot.length_tenth_mm = 0; }},
        {"code 0 moves", [&] { file.machine.movements[0] = file.machine.movements[9]; }},
        {"warmup 0", [&] { limits.warmup_ns = 0; }},
        {"warmup of 0 frames", [&] { limits.warmup_frames = 0; }},
        {"warmup time-out 1 h", [&] { limits.warmup_timeout_ns = kHour_ns; }},
        {"recover 0", [&] { limits.recover_ns = 0; }},
        {"recover in 0 frames", [&] { limits.recover_frames = 0; }},
        {"degraded for 1 h", [&] { limits.degraded_timeout_ns = kHour_ns; }},
        {"fastest 100 m/s", [&] { limits.fastest_m_s = 100.0; }},
        {"fastest NaN", [&] { limits.fastest_m_s = kNan; }},
        {"fastest turn infinite", [&] { limits.fastest_rad_s = kInfinity; }},
        {"jump 10 m", [&] { limits.jump_m = 10.0; }},
        {"jump 0", [&] { limits.jump_m = 0.0; }},
        {"jump of 3 rad", [&] { limits.jump_rad = 3.0; }},
        {"clock gap 1 h", [&] { limits.clock_gap_ns = kHour_ns; }},
        {"clock gap 0", [&] { limits.clock_gap_ns = 0; }},
    };
    const Knob& knob = knobs[seed % knobs.size()];
    if (faulty) knob.turn();
    return start_with(file, limits, faulty ? knob.name : "", seed, faulty);
}

}  // namespace

std::vector<Injection> gate_injections(const io::MachineFile& file) {
    const Machine& machine = file.machine;
    const auto snapshots = [&](Draw draw) { return with_snapshots(machine, std::move(draw)); };
    const auto bench = [&](GateBench::Plan plan, Prepare prepare) {
        return with_bench(machine, plan, std::move(prepare));
    };
    GateBench::Plan restarting = at_once();
    restarting.lasts_ns = 1'900 * kMs;
    return {
        {"H8",
         "pose jumps",
         "snapshot",
         true,
         "a lasting jump of 0.12-1 m sideways or in height, or of 10-180 deg in yaw",
         snapshots(jump)},
        {"H9",
         "drift of remembered ground",
         "cells of the map",
         false,
         "stated drift around a landing foot, 25.5-200 mm (1 sigma)",
         snapshots(drifted)},
        {"H10",
         "unmapped cells",
         "cells of the map",
         false,
         "one cell under a landing foot, a disc of 0.06-1 m, or the whole map",
         snapshots(unknown)},
        {"H11",
         "drop-off, smeared",
         "cells of the map",
         false,
         "the ground falls by 0.075-1 m beyond a line through a landing foot, over a length of "
         "0-0.5 m",
         snapshots(drop)},
        {"H12",
         "relief below the noise",
         "cells of the map",
         false,
         "sigma of 8-60 mm under a landing foot",
         snapshots(unsure)},
        {"H13",
         "table top seen as floor",
         "cells of the map",
         false,
         "a table top 0.4-1.2 m high where the body will be, mapped as ground or as hanging",
         snapshots(overhang)},
        {"H15",
         "body beside the feet",
         "cells of the map",
         false,
         "a wall 0.30-0.44 m beside base_link",
         snapshots(wall)},
        {"H5",
         "ground at another height than the soles",
         "cells of the map",
         true,
         "the whole map is 0.1-1 m too high or too low, with base_link unchanged",
         snapshots(raised)},
        {"H16",
         "time stamps",
         "snapshot",
         true,
         "the stamp of a frame or pose is 21-500 ms in the future, or stamps run backwards",
         snapshots(wrong_stamp)},
        {"H17",
         "clock",
         "clocks of the gate process",
         true,
         "the computer sleeps for 0.11 s to 1 h, or the steady clock goes back by as much",
         bench(at_once(), break_clock)},
        {"H18",
         "repeated and old questions",
         "client",
         true,
         "a copy of a question, or a question whose sequence number is up to ten too old",
         bench(at_once(), repeat_sequences)},
        {"H19",
         "broken messages",
         "text of a client",
         true,
         "a new text each time: cut at any position, two messages at once, 5 MB, a wrong type, or "
         "invalid UTF-8",
         bench(at_once(), break_messages)},
        {"H20",
         "bad numbers in a map",
         "snapshot",
         true,
         "NaN, infinity, 1e300 or 0 as yaw, far poses, absurd heights, a flipped bit",
         snapshots(bad_number)},
        {"H22",
         "gate process restarts",
         "process, modelled",
         true,
         "a restart; the gate warms up for 2 s, and an OK within 1.9 s is wrong",
         bench(restarting, restart)},
        {"H25",
         "disk full",
         "disk of the log, assured gate",
         true,
         "the disk is full, or a write fails with EIO",
         bench({}, fill_disk)},
        {"H26",
         "wrong configuration at the start",
         "machine file",
         true,
         "a key is misspelt, missing or given twice, or its value is NaN or 123456",
         wrong_file,
         true},
        {"H26",
         "another configuration while running",
         "snapshot",
         true,
         "another hash",
         snapshots(other_configuration)},
        {"H27",
         "settings that switch rules off",
         "limits of the gate",
         true,
         "a limit of the gate is 0, negative, huge or NaN",
         [file](std::uint64_t seed, bool faulty) { return switched_off(file, seed, faulty); },
         true},
        {"H28",
         "unknown directions",
         "client",
         true,
         "every direction code that has no movement",
         bench(at_once(), [machine](GateBench& b, Rng& rng) { unknown_command(machine, b, rng); })},
    };
}

}  // namespace surefoot::experiments
