// SPDX-License-Identifier: Apache-2.0
// Faults in the frames of a camera. They pass through the whole chain of `surefoot serve`:
// LiveSession, pipeline, channel, gate. A REX stands in a small room. The input is small images or
// analytic depth.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "lab/hazard_injections/fault_bench.hpp"
#include "service/live/live_session.hpp"
#include "surefoot/core/angles.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/perception/fit_settings.hpp"
#include "surefoot/perception/settings.hpp"
#include "surefoot/sim/rendering/image_faults.hpp"
#include "surefoot/sim/scene_source.hpp"
#include "surefoot/sim/sensors/rigs.hpp"

namespace surefoot::experiments {
namespace {

constexpr std::int64_t kSecond_ns = 1'000 * kMs;

/// Returns the text of a scene file: a room with a floor and an optional solid.
std::string room(const std::string& solid) {
    return "variants:\n  bench:\n    description: a room to stand in\n"
           "parameters:\n"
           "  albedo: {uniform: [0.3, 0.6]}\n"
           "  lamp_azimuth_deg: {uniform: [-180, 180]}\n"
           "lighting: {lamp_azimuth_deg: lamp_azimuth_deg}\n"
           "materials:\n"
           "  ground: {pattern: carpet, albedo: albedo, contrast: 0.6}\n"
           "  patches: {pattern: patches, albedo: 0.5, contrast: 0.6, texel_m: 0.006}\n"
           "solids:\n"
           "  - floor: {min_x_m: -3, min_y_m: -4, max_x_m: 6, max_y_m: 4, material: ground}\n"
           "  - walls: {min_x_m: -3, min_y_m: -4, max_x_m: 6, max_y_m: 4, material: patches}\n" +
           solid +
           "motion:\n  motion_model: rex\n  waypoints:\n    - {x_m: 0, y_m: 0, yaw_deg: 0}\n"
           "    - {x_m: -0.25, y_m: 0, yaw_deg: 0, move: back}\n";
}

/// Output of a camera without a fault.
struct Recording {
    camera::StereoRig rig;
    camera::SourceInfo info;
    std::vector<StereoFrame> frames;
};

enum class Sight : std::uint8_t { images, depth };

struct Shot {
    Sight sight = Sight::depth;
    std::string solid = {};  ///< additional solid in the room
    int frames = 48;
    sim::KnockConfig knock = {};
    bool imu = true;
    bool known_start = false;  ///< true: odom starts at the true pose instead of a measured one
    double scale = 0.25;       ///< depth only: image size as a share of the ZED image
};

/// Returns the rig of the ZED with fewer pixels.
camera::StereoRig small_rig(double scale) {
    camera::StereoRig rig = *sim::rig_preset("zed_vga");
    auto& lens = std::get<camera::PinholeRadTan>(rig.left.model);
    rig.left.width = static_cast<int>(rig.left.width * scale);
    rig.left.height = static_cast<int>(rig.left.height * scale);
    lens.fx_px *= scale;
    lens.fy_px *= scale;
    lens.cx_px = 0.5 * (rig.left.width - 1);
    lens.cy_px = 0.5 * (rig.left.height - 1);
    rig.right = rig.left;
    return rig;
}

Result<Recording> record(const Shot& shot, std::uint64_t seed) {
    const std::string file =
        (std::filesystem::temp_directory_path() / fmt::format("fault_bench_{}.yaml", seed))
            .string();
    if (auto written = io::write_file(file, room(shot.solid)); !written) return written.error();
    sim::SceneOptions options;
    options.scene = file;
    options.rig = small_rig(shot.sight == Sight::images ? 0.4 : shot.scale);
    options.seed = seed;
    options.commanded = true;
    options.frames = shot.frames;
    options.rate_hz = 15.0;
    options.sensor = shot.sight == Sight::images ? sim::Sensor::stereo : sim::Sensor::analytic;
    options.knock = shot.knock;
    if (!shot.imu) options.imu = sim::ImuKind::none;
    auto source = sim::open_scene(options);
    std::filesystem::remove(file);
    if (!source) return source.error();
    Recording recording{(*source)->rig(), (*source)->info(), {}};
    if (shot.known_start)
        recording.info.T_odom_first_body = (*source)->truth().trajectory.front().T_world_body;
    while (true) {
        auto frame = (*source)->next();
        if (!frame) return frame.error();
        if (!frame->has_value()) return recording;
        recording.frames.push_back(**std::move(frame));
    }
}

/// Keeps recordings in memory by name and seed.
class Archive {
  public:
    Result<const Recording*> get(const std::string& name, const Shot& shot, std::uint64_t seed) {
        auto& kept = kept_[name][seed];
        if (!kept) {
            auto made = record(shot, seed);
            if (!made) return made.error();
            kept = std::make_unique<Recording>(std::move(*made));
        }
        return static_cast<const Recording*>(kept.get());
    }

  private:
    std::map<std::string, std::map<std::uint64_t, std::unique_ptr<Recording>>> kept_;
};

/// Effect of a fault on perception.
struct Fault {
    std::string variant;
    /// Changes the k-th frame after the fault began. Returns false if the frame is lost.
    std::function<bool(StereoFrame& frame, int k)> damage = {};
    std::int64_t stall_ns = 0;          ///< duration of one stall of perception
    std::int64_t until_ns = kNever_ns;  ///< end of the fault, counted from its begin
};

/// Camera in simulated time. The gate is queried while the camera waits for the next frame. Like a
/// live camera, it drops all frames that arrived during processing except the newest one.
class FaultySource final : public camera::FrameSource {
  public:
    FaultySource(const Recording& recording, GateBench& bench, const Fault& fault)
        : recording_(recording), bench_(bench), fault_(fault), start_ns_(bench.now_ns()) {}

    [[nodiscard]] const camera::StereoRig& rig() const override { return recording_.rig; }
    [[nodiscard]] const camera::SourceInfo& info() const override { return recording_.info; }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override {
        while (next_ < recording_.frames.size() && !bench_.is_over()) {
            while (next_ + 1 < recording_.frames.size() && arrival_ns(next_ + 1) <= bench_.now_ns())
                ++next_;
            bench_.pass_until(arrival_ns(next_));
            StereoFrame frame = recording_.frames[next_++];
            const std::int64_t since_ns = bench_.now_ns() - bench_.fault_ns();
            if (bench_.is_faulty(bench_.now_ns()) && since_ns < fault_.until_ns && fault_.damage &&
                !fault_.damage(frame, faulty_++))
                continue;
            return std::optional<StereoFrame>(std::move(frame));
        }
        bench_.pass_until(kNever_ns - kSecond_ns);
        return std::optional<StereoFrame>();
    }

  private:
    [[nodiscard]] std::int64_t arrival_ns(std::size_t frame) const {
        return start_ns_ + static_cast<std::int64_t>(frame) * kFramePeriod_ns;
    }

    const Recording& recording_;
    GateBench& bench_;
    const Fault& fault_;
    std::int64_t start_ns_;
    std::size_t next_ = 0;
    int faulty_ = 0;
};

/// Clock of the pipeline stages. Each reading advances the time by 5 ms, so that a full frame takes
/// 45 ms, as long as a ZED frame on one thread. The clock is global, because the library takes a
/// plain function.
GateBench* running = nullptr;
std::int64_t* stall_ns = nullptr;

std::int64_t stage_clock_ns() {
    running->pass_until(running->now_ns() + 5 * kMs);
    if (running->is_faulty(running->now_ns()))
        running->pass_until(running->now_ns() + std::exchange(*stall_ns, 0));
    return running->now_ns();
}

Result<Outcome> perceive(const io::MachineFile& file,
                         const Recording& recording,
                         const GateBench::Plan& plan,
                         Fault fault,
                         std::uint64_t seed) {
    auto settings = surefoot::load_settings();
    if (!settings) return settings.error();
    settings->pipeline.elevation.length_m = 3.0;
    fit_settings(recording.rig, file, *settings);
    Serial serial;
    auto pipeline =
        pipeline::Pipeline::make(settings->pipeline, recording.rig, serial, stage_clock_ns);
    if (!pipeline) return pipeline.error();
    GateBench bench(file.machine, fast_warm_up(), plan, seed);
    bench.outcome().variant = fault.variant;
    if (plan.from_the_start) bench.set_command(1);
    running = &bench;
    stall_ns = &fault.stall_ns;
    FaultySource source(recording, bench, fault);
    app::LiveSession session(
        *pipeline, source, bench.writer(), 1, [&bench] { return bench.now_ns(); });
    // If a session ends with an error, perception ends: the gate receives no more snapshots.
    std::ignore = session.run(0.0, [] { return true; });
    bench.pass_until(kNever_ns - kSecond_ns);
    running = nullptr;
    return bench.outcome();
}

/// Draws the fault of one run.
using Draw = std::function<Fault(Rng& rng, const Recording& recording)>;

struct Setup {
    Shot shot;
    std::string name;  ///< name of the recording
    GateBench::Plan plan;
    Draw draw;
};

GateBench::Plan standing() {
    GateBench::Plan plan;
    plan.attestation_radius_m = 1.0;
    plan.any_movement = false;
    return plan;
}

// --- H1 to H4: the images ---

Fault stop(Rng& rng, const Recording&) {
    // At least four frames are lost. After fewer than three lost frames the last map is not too old
    // yet.
    const int frames = rng.below(2) == 0 ? 1'000'000 : 4 + static_cast<int>(rng.below(10));
    return {frames > 100 ? "stops for good" : fmt::format("{} frames lost", frames),
            [frames](StereoFrame&, int k) { return k >= frames; }};
}

/// The reader reads the same ring of buffers repeatedly, because the camera writes nothing new.
Fault freeze(Rng& rng, const Recording& recording) {
    const int ring = 1 + static_cast<int>(rng.below(4));
    return {fmt::format("the last {} images again and again", ring),
            [ring, &recording](StereoFrame& frame, int k) {
                const int last = frame.index - k - 1;
                const StereoFrame& old =
                    recording.frames[static_cast<std::size_t>(last - (ring - 1) + k % ring)];
                frame.left = old.left;
                frame.right = old.right;
                return true;
            }};
}

void shift(GreyImage& image, int dx, int dy) {
    const GreyImage old = image;
    for (int v = 0; v < image.height(); ++v)
        for (int u = 0; u < image.width(); ++u)
            image.at(u, v) = old.at((u + dx + image.width()) % image.width(),
                                    (v + dy + image.height()) % image.height());
}

Fault corrupt(Rng& rng, const Recording& recording) {
    const int rows = recording.frames.front().left.height();
    const int row = 10 + static_cast<int>(rng.below(static_cast<std::uint64_t>(rows - 20)));
    switch (rng.below(4)) {
        case 0:
            return {fmt::format("torn at row {} of {}", row, rows),
                    [row, &recording](StereoFrame& frame, int) {
                        const StereoFrame& old =
                            recording.frames[static_cast<std::size_t>(frame.index - 1)];
                        sim::tear(old.left, row, frame.left);
                        sim::tear(old.right, row, frame.right);
                        return true;
                    }};
        case 1:
            return {"one camera shows the frame before", [&recording](StereoFrame& frame, int) {
                        frame.right =
                            recording.frames[static_cast<std::size_t>(frame.index - 1)].right;
                        return true;
                    }};
        case 2: {
            const bool sideways = rng.below(2) == 0;
            const int by = 8 + static_cast<int>(rng.below(static_cast<std::uint64_t>(rows - 16)));
            return {fmt::format("right image moved by {} {}", by, sideways ? "columns" : "rows"),
                    [sideways, by](StereoFrame& frame, int) {
                        shift(frame.right, sideways ? by : 0, sideways ? 0 : by);
                        return true;
                    }};
        }
        default: {
            const std::uint64_t seed = rng.next_u64();
            return {"snow", [seed](StereoFrame& frame, int k) {
                        Rng snow(mix_seed(seed, static_cast<std::uint64_t>(k)));
                        for (GreyImage* image : {&frame.left, &frame.right})
                            for (std::size_t i = 0; i < image->size(); ++i)
                                image->data()[i] =
                                    static_cast<std::uint8_t>(snow.next_u64() >> 56U);
                        return true;
                    }};
        }
    }
}

/// Draws a grey cover with camera noise over the left part of an image.
void cover(GreyImage& image, double share, int grey_dn, Rng& rng) {
    const int columns = static_cast<int>(std::lround(share * image.width()));
    for (int v = 0; v < image.height(); ++v)
        for (int u = 0; u < columns; ++u)
            image.at(u, v) = static_cast<std::uint8_t>(
                std::clamp(grey_dn + std::lround(rng.normal()), 0L, 255L));
}

/// Approximates a Gaussian blur by three box filters.
void blur(GreyImage& image, int radius_px) {
    for (int round = 0; round < 3; ++round) {
        for (const bool along : {true, false}) {
            const GreyImage old = image;
            const int n = along ? image.width() : image.height();
            for (int v = 0; v < image.height(); ++v)
                for (int u = 0; u < image.width(); ++u) {
                    int sum = 0;
                    for (int d = -radius_px; d <= radius_px; ++d) {
                        const int at = std::clamp((along ? u : v) + d, 0, n - 1);
                        sum += along ? old.at(at, v) : old.at(u, at);
                    }
                    image.at(u, v) = static_cast<std::uint8_t>(sum / (2 * radius_px + 1));
                }
        }
    }
}

Fault blind(Rng& rng, const Recording&) {
    const std::uint64_t seed = rng.next_u64();
    const int cameras = 1 + static_cast<int>(rng.below(3));  // 1 = left, 2 = right, 3 = both
    const char* which = cameras == 1 ? "left" : cameras == 2 ? "right" : "both";
    if (rng.below(4) == 0) {
        const int radius_px = 8 + static_cast<int>(rng.below(12));
        return {fmt::format("{}: lens smeared, blur over {} px", which, 2 * radius_px + 1),
                [=](StereoFrame& frame, int) {
                    if ((cameras & 1) != 0) blur(frame.left, radius_px);
                    if ((cameras & 2) != 0) blur(frame.right, radius_px);
                    return true;
                }};
    }
    const double share = rng.uniform(0.9, 1.0);
    const int grey_dn = static_cast<int>(rng.below(256));
    return {fmt::format("{}: {:.0f} % covered, grey {}", which, 100.0 * share, grey_dn),
            [=](StereoFrame& frame, int k) {
                Rng noise(mix_seed(seed, static_cast<std::uint64_t>(k)));
                if ((cameras & 1) != 0) cover(frame.left, share, grey_dn, noise);
                if ((cameras & 2) != 0) cover(frame.right, share, grey_dn, noise);
                return true;
            }};
}

void brighten(GreyImage& image, double factor, double offset_dn) {
    for (std::size_t i = 0; i < image.size(); ++i)
        image.data()[i] = static_cast<std::uint8_t>(
            std::clamp(factor * image.data()[i] + offset_dn + 0.5, 0.0, 255.0));
}

Fault overexpose(Rng& rng, const Recording&) {
    const double factor = rng.uniform(4.0, 20.0);
    return {fmt::format("exposure x {:.0f}", factor), [factor](StereoFrame& frame, int) {
                brighten(frame.left, factor, 60.0);
                brighten(frame.right, factor, 60.0);
                return true;
            }};
}

/// Over-exposes the images in the first seconds, as in sunlight. After that there is no fault.
Fault warm_up(Rng& rng, const Recording&) {
    const double lasts_s = rng.uniform(1.0, 2.0);
    Fault fault{fmt::format("over-exposed for the first {:.1f} s", lasts_s),
                [lasts_s](StereoFrame& frame, int k) {
                    const double left = 1.0 - k / (15.0 * lasts_s);
                    brighten(frame.left, 3.0 + 10.0 * left, 60.0);
                    brighten(frame.right, 3.0 + 10.0 * left, 60.0);
                    return true;
                }};
    fault.until_ns = static_cast<std::int64_t>(lasts_s * 1e9);
    return fault;
}

// --- H7, H8, H20: time, poses and numbers on the way to the map ---

Fault hang(Rng& rng, const Recording&) {
    const double hangs_s = rng.uniform(0.3, 5.0);
    Fault fault{fmt::format("perception hangs for {:.1f} s", hangs_s)};
    fault.stall_ns = static_cast<std::int64_t>(hangs_s * 1e9);
    return fault;
}

Fault lose_pose(Rng& rng, const Recording&) {
    switch (rng.below(4)) {
        case 0: {
            const Health health = rng.below(2) == 0 ? Health::lost : Health::degraded;
            return {fmt::format("odometry {}", to_string(health)),
                    [health](StereoFrame& frame, int) {
                        frame.known_motion->health = health;
                        return true;
                    }};
        }
        case 1: {
            const int axis = static_cast<int>(rng.below(7));
            const double bad = rng.below(2) == 0 ? std::numeric_limits<double>::quiet_NaN()
                                                 : std::numeric_limits<double>::infinity();
            return {fmt::format("{} in the pose", bad), [=](StereoFrame& frame, int) {
                        Pose& pose = frame.known_motion->T_odom_body;
                        if (axis < 3)
                            pose.translation_m[axis] = bad;
                        else
                            pose.rotation.coeffs()[axis - 3] = bad;
                        return true;
                    }};
        }
        case 2: {
            const double by_m = rng.uniform(0.12, 1.0);
            const Eigen::Vector3d by =
                by_m * Eigen::Vector3d(rng.normal(), rng.normal(), 0.0).normalized();
            return {fmt::format("jump of {:.0f} mm", 1e3 * by_m), [by](StereoFrame& frame, int) {
                        frame.known_motion->T_odom_body.translation_m += by;
                        return true;
                    }};
        }
        default: {
            const double by_deg = rng.uniform(10.0, 180.0);
            return {fmt::format("jump of {:.0f} deg", by_deg), [by_deg](StereoFrame& frame, int) {
                        Pose& pose = frame.known_motion->T_odom_body;
                        pose.rotation = pose.rotation * Eigen::AngleAxisd(by_deg * kRadPerDeg,
                                                                          Eigen::Vector3d::UnitZ());
                        return true;
                    }};
        }
    }
}

Fault bad_depth(Rng& rng, const Recording&) {
    const float values[] = {std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity(),
                            -1.0F,
                            0.0F,
                            1e30F,
                            1e-38F};
    const float value = values[rng.below(std::size(values))];
    // The smallest positive sigma is not drawn. It is a valid number, and the map limits the
    // variance from below.
    const bool sigma = rng.below(3) == 0 && value != 1e-38F;
    return {fmt::format("every {} is {}", sigma ? "sigma" : "disparity", value),
            [=](StereoFrame& frame, int) {
                (sigma ? frame.known_depth->sigma_px : frame.known_depth->disparity_px).fill(value);
                return true;
            }};
}

Fault wrong_stamps(Rng& rng, const Recording& recording) {
    const bool stands = rng.below(2) == 0;
    const std::int64_t back_ns = static_cast<std::int64_t>(rng.uniform(0.3, 2.0) * 1e9);
    const std::int64_t stamp_ns = recording.frames[12].time_ns;
    return {stands ? "stamps stand still" : fmt::format("stamps {} ms back", back_ns / kMs),
            [=](StereoFrame& frame, int) {
                const std::int64_t time_ns = stands ? stamp_ns : frame.time_ns - back_ns;
                frame.time_ns = time_ns;
                return true;
            }};
}

/// Replaces the frames from the fault on by another recording of the same room with a person in
/// it.
Draw showing(const Recording& other, std::string variant) {
    return [&other, variant = std::move(variant)](Rng&, const Recording&) {
        return Fault{variant, [&other](StereoFrame& frame, int) {
                         frame.known_depth =
                             other.frames[static_cast<std::size_t>(frame.index)].known_depth;
                         return true;
                     }};
    };
}

class Runs {
  public:
    Runs(const io::MachineFile& file, int scenes)
        : file_(file), scenes_(static_cast<std::uint64_t>(scenes)) {}

    /// Makes one run of a setup.
    Result<Outcome> run(const Setup& setup, std::uint64_t seed, bool faulty) {
        auto recording = archive_.get(setup.name, setup.shot, scene_of(seed));
        if (!recording) return recording.error();
        Rng rng(mix_seed(seed, 2));
        GateBench::Plan plan = setup.plan;
        plan.faulty = faulty;
        Fault fault;
        if (faulty) fault = setup.draw(rng, **recording);
        if (plan.from_the_start && faulty && fault.until_ns != kNever_ns)
            plan.lasts_ns = fault.until_ns;
        if (!faulty) plan.from_the_start = false;
        return perceive(file_, **recording, plan, std::move(fault), seed);
    }

    Result<Outcome> knocked(std::uint64_t seed, bool faulty);
    Result<Outcome> person(std::uint64_t seed, bool faulty);
    Result<Outcome> no_ground(std::uint64_t seed, bool faulty);

  private:
    [[nodiscard]] std::uint64_t scene_of(std::uint64_t seed) const { return seed % scenes_ + 1; }

    io::MachineFile file_;
    std::uint64_t scenes_;
    Archive archive_;
};

/// The camera mount turns at a fixed time of the recording. The fault of the run is set to this
/// time.
Result<Outcome> Runs::knocked(std::uint64_t seed, bool faulty) {
    Rng rng(mix_seed(seed, 2));
    constexpr double kAt_s = 1.9;
    Shot shot;
    shot.frames = 140;
    shot.scale = 0.5;  // the ground plane needs enough points
    const double by_deg = rng.uniform(1.0, 5.0) * (rng.below(2) == 0 ? -1.0 : 1.0);
    const bool roll = rng.below(2) == 0;
    if (faulty) shot.knock = {kAt_s, roll ? by_deg : 0.0, roll ? 0.0 : by_deg, 0.0};
    auto recording = record(shot, seed);
    if (!recording) return recording.error();
    GateBench::Plan plan = standing();
    plan.faulty = faulty;
    plan.lasts_ns = 7 * kSecond_ns;
    plan.watched_on_ns = 300 * kMs;
    plan.fault_ns_since_start = static_cast<std::int64_t>(kAt_s * 1e9);
    Fault fault{fmt::format("{} {:.1f} deg", roll ? "roll" : "pitch", by_deg)};
    return perceive(file_, *recording, plan, std::move(fault), seed);
}

/// A person appears in the path of the body between two frames.
Result<Outcome> Runs::person(std::uint64_t seed, bool faulty) {
    Rng rng(mix_seed(seed, 2));
    Setup setup{{}, "depth", standing(), {}};
    setup.plan.forward_only = true;
    Shot with = setup.shot;
    const double x_m = rng.uniform(0.62, 0.72);
    const double y_m = rng.uniform(-0.25, 0.25);
    with.solid = fmt::format(
        "  - cylinder: {{x_m: {:.3f}, y_m: {:.3f}, radius_m: 0.15, top_m: 1.7, material: "
        "patches}}\n",
        x_m,
        y_m);
    auto other = record(with, scene_of(seed));
    if (!other) return other.error();
    setup.draw = showing(
        *other, fmt::format("{:.0f} mm ahead, {:.0f} mm to the left", 1e3 * x_m, 1e3 * y_m));
    return run(setup, seed, faulty);
}

/// At the start, the camera sees no plane that could be the floor.
Result<Outcome> Runs::no_ground(std::uint64_t seed, bool faulty) {
    Rng rng(mix_seed(seed, 2));
    Shot shot;
    shot.frames = 60;
    shot.scale = 0.35;
    const bool wall = rng.below(2) == 0;
    const double at_m = wall ? rng.uniform(0.35, 0.5) : rng.uniform(0.4, 0.8);
    shot.imu = !wall && rng.below(2) == 0;
    std::string variant = "level ground";
    if (faulty && wall) {
        variant = fmt::format("a wall {:.2f} m ahead fills the view, no IMU", at_m);
        shot.solid = fmt::format(
            "  - box: {{x_m: {:.3f}, y_m: 0, length_m: 0.1, width_m: 6, top_m: 2.4, material: "
            "patches}}\n",
            at_m);
    } else if (faulty) {
        variant = fmt::format(
            "a table {:.2f} m high fills the view, {}", at_m, shot.imu ? "with IMU" : "no IMU");
        shot.solid = fmt::format(
            "  - box: {{x_m: 2.3, y_m: 0, length_m: 4.2, width_m: 7, top_m: {:.3f}, material: "
            "patches}}\n",
            at_m);
    }
    auto recording = record(shot, seed);
    if (!recording) return recording.error();
    GateBench::Plan plan = standing();
    plan.faulty = faulty;
    plan.from_the_start = faulty;
    if (faulty) plan.lasts_ns = 4 * kSecond_ns;
    return perceive(file_, *recording, plan, Fault{variant}, seed);
}

}  // namespace

std::vector<Injection> frame_injections(const io::MachineFile& file, int scenes) {
    const auto runs = std::make_shared<Runs>(file, scenes);
    const auto with = [&runs](Sight sight, Draw draw, GateBench::Plan plan = standing()) {
        Shot shot;
        shot.sight = sight;
        shot.known_start = sight == Sight::images && !plan.from_the_start;
        const Setup setup{shot,
                          shot.known_start         ? "images, known start pose"
                          : sight == Sight::images ? "images"
                                                   : "depth",
                          plan,
                          std::move(draw)};
        return [runs, setup](std::uint64_t seed, bool faulty) {
            return runs->run(setup, seed, faulty);
        };
    };
    GateBench::Plan starting = standing();
    starting.from_the_start = true;
    starting.deadline_ns = 0;
    const auto of = [&runs](auto member) {
        return [runs, member](std::uint64_t seed, bool faulty) {
            return ((*runs).*member)(seed, faulty);
        };
    };
    const char* images = "images, whole chain";
    const char* depth = "frames with modelled depth, whole chain";
    return {
        {"H1",
         "camera stops",
         images,
         true,
         "4 or more frames are lost, or all frames",
         with(Sight::images, stop)},
        {"H1",
         "camera frozen",
         images,
         true,
         "the camera repeats the last 1 to 4 images",
         with(Sight::images, freeze)},
        {"H2",
         "corrupted frames",
         images,
         true,
         "torn image, one camera late, right image shifted by rows or columns, or snow",
         with(Sight::images, corrupt)},
        {"H3",
         "covered or smeared",
         images,
         true,
         "one camera or both: 90-100 % of the image is covered by one grey value, or the image is "
         "blurred over 17 px or more",
         with(Sight::images, blind)},
        {"H4",
         "over-exposed while walking",
         images,
         true,
         "exposure multiplied by 4 to 20",
         with(Sight::images, overexpose)},
        {"H4",
         "over-exposed at the start",
         images,
         true,
         "the first 1-2 s are over-exposed",
         with(Sight::images, warm_up, starting),
         true},
        {"H5",
         "no ground at the start",
         depth,
         true,
         "a wall or a table fills the view, with and without IMU",
         of(&Runs::no_ground),
         true},
        {"H7",
         "perception hangs",
         depth,
         true,
         "perception hangs for 0.3-5 s inside of a frame",
         with(Sight::depth, hang)},
        {"H8",
         "pose lost, jumps, no number",
         depth,
         true,
         "health LOST or DEGRADED, a pose with NaN or infinity, or a jump of 0.12-1 m or of 10-180 "
         "deg in yaw",
         with(Sight::depth, lose_pose)},
        {"H14",
         "somebody steps in",
         depth,
         false,
         "a column of 0.3 m in the way of the body",
         of(&Runs::person)},
        {"H16",
         "stamps of the camera",
         images,
         true,
         "the time stamps stand still, or jump back by 0.3-2 s",
         with(Sight::images, wrong_stamps)},
        {"H20",
         "bad numbers in depth",
         depth,
         true,
         "every disparity is NaN, infinite, 0, negative, 1e30 or 1e-38, or every sigma has one of "
         "these values except 1e-38",
         with(Sight::depth, bad_depth)},
        {"H6",
         "mount knocked",
         depth,
         true,
         "the camera turns by 1-5 deg in roll or pitch within 0.1 s",
         of(&Runs::knocked)},
    };
}

}  // namespace surefoot::experiments
