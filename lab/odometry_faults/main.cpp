// SPDX-License-Identifier: Apache-2.0
// How does the odometry react to a camera, clock or IMU that fails during a walk, and to a rig that
// differs from its calibration? Does it ever state a small uncertainty for a wrong motion?
// Usage: odometry_faults OUT.csv SCENES [FIRST_SEED [SEEDS [PROFILES [FAULTS [KEY=VALUE...]]]]]
//   odometry_faults out/faults.csv walk_floor,room 71101 3 zed all
//   SCENES to PROFILES: see scene_cases.hpp. FAULTS: names of `all_faults` below with commas
//   between them, or all. KEY=VALUE: a setting of surefoot.
//
// Only images and odometry run, no map. Each fault runs with and without IMU. It begins in frame 40
// of 76; faults of the rig and permanently swapped cameras exist from the start.
//
// Writes OUT.csv, one line per frame; the columns that need an explanation:
//   faulty              the fault is in this frame
//   health, reason, camera, lit   as reported; the map uses a frame if it is `lit` and not LOST
//   path_mm             true motion since the last frame
//   err_mm, err_deg     error of the motion since the last frame
//   sig_mm, sig_deg     stated sigma of this motion in the direction of the largest sigma
//   s_*                 error and sigma of the motion over the last second; s_health: the worst
//                       health in this second
//   since_*             error and sigma of the motion since the last frame before the fault; empty
//                       before the fault
#include <fmt/format.h>
#include <fmt/os.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "lab/scenes/scene_cases.hpp"
#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "surefoot/camera/frame_integrity_check.hpp"
#include "surefoot/core/angles.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/perception/settings.hpp"
#include "surefoot/pipeline/exposure_state.hpp"
#include "surefoot/pipeline/pipeline.hpp"
#include "surefoot/sim/rendering/smooth_noise.hpp"

namespace surefoot::app {
namespace {

constexpr int kFirst = 20;  ///< first recorded frame of the path; before it the machine stands
constexpr int kFrames = 76;
constexpr int kOnset = 40;
constexpr int kAfter = 16;  ///< frames recorded after the end of a fault
constexpr double kWindow_s = 1.0;
constexpr double kWall_dn = 130.0;

using experiments::SceneCase;

struct Shown {
    StereoFrame frame;
    Pose T_world_body;
    bool faulty = false;
    bool dropped = false;
};

/// Renders images of other content through the same camera as the scene.
class Painter {
  public:
    Painter(const camera::StereoRig& rig, sim::Renderer renderer, Executor& executor)
        : rig_(rig), renderer_(std::move(renderer)), executor_(&executor) {
        clean_.left.signal_dn = Image<float>(rig.left.width, rig.left.height);
        clean_.right.signal_dn = Image<float>(rig.left.width, rig.left.height);
        clean_.left.depth_m = clean_.left.signal_dn;
    }

    /// Renders a wall without texture, or darkness.
    void flat(double signal_dn, Shown& shown) {
        clean_.left.signal_dn.fill(static_cast<float>(signal_dn));
        clean_.right.signal_dn.fill(static_cast<float>(signal_dn));
        expose(shown.frame.index);
        shown.frame.left = pair_.left;
        shown.frame.right = pair_.right;
    }

    /// Draws a person in front of the left `share` of the view: a textured board 1.2 m away that
    /// has moved by `shift_m` to the right.
    void person(double share, double shift_m, Shown& shown) {
        constexpr double kAway_m = 1.2;
        const double edge_px = share * rig_.left.width;
        const auto paint = [&](const camera::Camera& this_camera,
                               const Pose& T_left_camera,
                               Image<float>& signal_dn) {
            signal_dn.fill(-1.0F);
            for (int v = 0; v < this_camera.height; ++v) {
                for (int u = 0; u < this_camera.width; ++u) {
                    const auto ray = camera::unproject(this_camera.model, Eigen::Vector2d(u, v));
                    if (!ray) continue;
                    const Eigen::Vector3d along = T_left_camera.rotation * *ray;
                    const double scale = (kAway_m - T_left_camera.translation_m.z()) / along.z();
                    const Eigen::Vector3d p = T_left_camera.translation_m + scale * along;
                    const auto seen = camera::project(rig_.left.model, p);
                    if (!seen || seen->x() > edge_px) continue;
                    const double x_m = p.x() - shift_m;
                    signal_dn.at(u, v) = 110.0F + 25.0F * fine_.at(noise_, 0, x_m, p.y()) +
                                         30.0F * coarse_.at(noise_, 0, x_m, p.y());
                }
            }
        };
        paint(rig_.left, Pose{}, clean_.left.signal_dn);
        paint(*rig_.right, rig_.T_left_right, clean_.right.signal_dn);
        expose(shown.frame.index);
        over(clean_.left.signal_dn, pair_.left, shown.frame.left);
        over(clean_.right.signal_dn, pair_.right, shown.frame.right);
    }

  private:
    /// Adds noise. The frame number differs from those of the scene, so the noise is different.
    void expose(int frame) { renderer_.expose(clean_, {}, 10'000 + frame, *executor_, pair_); }
    static void over(const Image<float>& mask, const GreyImage& from, GreyImage& image) {
        for (int v = 0; v < image.height(); ++v)
            for (int u = 0; u < image.width(); ++u)
                if (mask.at(u, v) >= 0.0F) image.at(u, v) = from.at(u, v);
    }

    camera::StereoRig rig_;
    sim::Renderer renderer_;
    Executor* executor_;
    sim::PixelNoise noise_;
    sim::SurfaceNoise fine_{1, 0.02};
    sim::SurfaceNoise coarse_{2, 0.08};
    sim::CleanPair clean_;
    sim::RenderedPair pair_;
};

/// Material for a fault: the clean recording and a painter of other images.
struct Bench {
    const std::vector<Shown>& clean;
    Painter& painter;
};

struct Fault {
    std::string name;
    std::string severity;
    int first = kOnset;
    int frames = 0;  ///< number of faulty frames; 0 = to the end
    /// Damages a frame. `k` counts from the first faulty frame.
    std::function<void(Shown&, int k, Bench&)> damage = {};
    std::function<void(camera::StereoRig&)> rig = {};
    bool watched = true;  ///< true: mark repeated and torn images, as the application does
    bool of_imu = false;
};

void scale_grey(double factor, GreyImage& image) {
    for (std::size_t i = 0; i < image.size(); ++i)
        image.data()[i] =
            static_cast<std::uint8_t>(std::min(factor * image.data()[i] + 0.5, 255.0));
}

void snow(std::uint64_t seed, GreyImage& image) {
    Rng rng(seed);
    for (std::size_t i = 0; i < image.size(); ++i)
        image.data()[i] = static_cast<std::uint8_t>(rng.next_u64() >> 56);
}

void lengthen_focus(double factor, camera::Camera& this_camera) {
    auto& lens = std::get<camera::PinholeRadTan>(this_camera.model);
    lens.fx_px *= factor;
    lens.fy_px *= factor;
}

const Shown& before(const Shown& shown, Bench& bench) {
    return bench.clean[static_cast<std::size_t>(shown.frame.index - kFirst - 1)];
}

std::vector<Fault> faults_of_light() {
    std::vector<Fault> faults;
    for (const int n : {1, 5, 10, 20})
        faults.push_back(
            {"blackout", fmt::format("{:.1f} s", 0.1 * n), kOnset, n, [](Shown& s, int, Bench& b) {
                 b.painter.flat(0.0, s);
             }});
    for (const int n : {10, 0})
        for (const bool left : {true, false})
            faults.push_back(
                {"one_camera_black",
                 fmt::format("{}, {}", left ? "left" : "right", n > 0 ? "1 s" : "for good"),
                 kOnset,
                 n,
                 [left](Shown& s, int, Bench& b) {
                     Shown black = s;
                     b.painter.flat(0.0, black);
                     (left ? s.frame.left : s.frame.right) =
                         left ? black.frame.left : black.frame.right;
                 }});
    for (const double factor : {0.25, 4.0})
        for (const int n : {5, 0})
            faults.push_back({"exposure",
                              fmt::format("x {}, {}", factor, n > 0 ? "0.5 s" : "for good"),
                              kOnset,
                              n,
                              [factor](Shown& s, int, Bench&) {
                                  scale_grey(factor, s.frame.left);
                                  scale_grey(factor, s.frame.right);
                              }});
    for (const int n : {5, 20})
        faults.push_back({"blank_wall",
                          fmt::format("{:.1f} s", 0.1 * n),
                          kOnset,
                          n,
                          [](Shown& s, int, Bench& b) { b.painter.flat(kWall_dn, s); }});
    for (const int n : {5, 20})
        faults.push_back({"noise_images",
                          fmt::format("{:.1f} s", 0.1 * n),
                          kOnset,
                          n,
                          [](Shown& s, int k, Bench&) {
                              snow(static_cast<std::uint64_t>(2 * k + 1), s.frame.left);
                              snow(static_cast<std::uint64_t>(2 * k + 2), s.frame.right);
                          }});
    return faults;
}

std::vector<Fault> faults_of_people() {
    struct Person {
        double share;
        double speed_m_s;
        const char* name;
    };
    std::vector<Fault> faults;
    for (const Person& p : {Person{0.5, 0.0, "half, keeps pace"},
                            Person{0.5, 0.3, "half, crosses at 0.3 m/s"},
                            Person{0.5, 1.0, "half, crosses at 1 m/s"},
                            Person{0.7, 0.0, "0.7, keeps pace"},
                            Person{0.7, 0.3, "0.7, crosses at 0.3 m/s"}})
        faults.push_back({"person", p.name, kOnset, 20, [p](Shown& s, int k, Bench& b) {
                              b.painter.person(p.share, 0.1 * k * p.speed_m_s, s);
                          }});
    return faults;
}

std::vector<Fault> faults_of_status() {
    std::vector<Fault> faults;
    for (const int n : {1, 5, 20})
        faults.push_back({"dropped", fmt::format("{}", n), kOnset, n, [](Shown& s, int, Bench&) {
                              s.dropped = true;
                          }});
    for (const bool watched : {true, false}) {
        const char* how = watched ? "marked" : "unmarked";
        for (const int n : {1, 5})
            faults.push_back({"repeated",
                              fmt::format("{}, {}", n, how),
                              kOnset,
                              n,
                              [](Shown& s, int, Bench& b) {
                                  const StereoFrame& last = b.clean[kOnset - kFirst - 1].frame;
                                  s.frame.left = last.left;
                                  s.frame.right = last.right;
                              },
                              {},
                              watched});
        for (const int n : {1, 5})
            faults.push_back({"torn",
                              fmt::format("{}, {}", n, how),
                              kOnset,
                              n,
                              [](Shown& s, int, Bench& b) {
                                  const StereoFrame& last = before(s, b).frame;
                                  const int row = s.frame.left.height() / 2;
                                  sim::tear(last.left, row, s.frame.left);
                                  sim::tear(last.right, row, s.frame.right);
                              },
                              {},
                              watched});
    }
    const auto shift = [](double by_s) {
        return [by_s](Shown& s, int, Bench&) { s.frame.time_ns += ns_from_seconds(by_s); };
    };
    faults.push_back({"stamp", "repeated once", kOnset, 1, shift(-0.1)});
    faults.push_back({"stamp", "back 0.3 s once", kOnset, 1, shift(-0.3)});
    faults.push_back({"stamp", "ahead 2 s once", kOnset, 1, shift(2.0)});
    for (const double by_s : {-2.0, 2.0})
        faults.push_back({"clock",
                          fmt::format("{} 2 s for good", by_s < 0.0 ? "back" : "ahead"),
                          kOnset,
                          0,
                          [by_s](Shown& s, int, Bench&) {
                              s.frame.time_ns += ns_from_seconds(by_s);
                              for (ImuSample& sample : s.frame.imu)
                                  sample.time_ns += ns_from_seconds(by_s);
                          }});
    return faults;
}

std::vector<Fault> faults_of_imu() {
    const auto each = [](std::function<void(ImuSample&)> change) {
        return [change = std::move(change)](Shown& s, int, Bench&) {
            for (ImuSample& sample : s.frame.imu) change(sample);
        };
    };
    const auto add = [&](double rate_rad_s, double force_m_s2) {
        return each([=](ImuSample& s) {
            s.angular_velocity_rad_s.z() += rate_rad_s;
            s.specific_force_m_s2.x() += force_m_s2;
        });
    };
    std::vector<Fault> faults;
    const auto put = [&](const char* severity, int n, auto damage) {
        faults.push_back({"imu", severity, kOnset, n, damage, {}, true, true});
    };
    put("no samples, 1 s", 10, [](Shown& s, int, Bench&) { s.frame.imu.clear(); });
    put("NaN, 1 s", 10, each([](ImuSample& s) {
            s.specific_force_m_s2.setConstant(std::numeric_limits<double>::quiet_NaN());
        }));
    put("saturated, 1 s", 10, each([](ImuSample& s) {
            s.angular_velocity_rad_s.setConstant(4.36);  // 250 deg/s
            s.specific_force_m_s2.setConstant(19.6);
        }));
    put("bias +0.02 rad/s, +0.2 m/s2", 0, add(0.02, 0.2));
    put("bias +0.1 rad/s, +1 m/s2", 0, add(0.1, 1.0));
    put("bias +1 rad/s, +10 m/s2", 0, add(1.0, 10.0));
    return faults;
}

std::vector<Fault> faults_of_rig() {
    const auto exchange = [](Shown& s, int, Bench&) { std::swap(s.frame.left, s.frame.right); };
    std::vector<Fault> faults;
    faults.push_back({"cameras_swapped", "1 s", kOnset, 10, exchange});
    faults.push_back({"cameras_swapped", "from the start", kFirst, 0, exchange});
    const auto put = [&](const char* name, const char* severity, auto change) {
        faults.push_back({name, severity, kFirst, 0, {}, change});
    };
    put("focal", "both + 1 %", [](camera::StereoRig& rig) {
        lengthen_focus(1.01, rig.left);
        lengthen_focus(1.01, *rig.right);
    });
    put("focal", "right + 1 %", [](camera::StereoRig& rig) {
        lengthen_focus(1.01, *rig.right);
        rig.rectified = false;
    });
    put("baseline", "x 2", [](camera::StereoRig& rig) { rig.T_left_right.translation_m *= 2.0; });
    put("baseline", "x 0.5", [](camera::StereoRig& rig) { rig.T_left_right.translation_m *= 0.5; });
    return faults;
}

std::vector<Fault> all_faults() {
    std::vector<Fault> faults{{"none", "-", kOnset, 0}};
    for (auto part : {faults_of_light(),
                      faults_of_people(),
                      faults_of_status(),
                      faults_of_imu(),
                      faults_of_rig()})
        faults.insert(faults.end(), part.begin(), part.end());
    return faults;
}

/// Returns the recording with the fault. The IMU samples of a dropped frame go to the next frame.
std::vector<Shown> damaged(const std::vector<Shown>& clean, const Fault& fault, Painter& painter) {
    Bench bench{clean, painter};
    camera::FrameIntegrityCheck watch;
    std::vector<Shown> out;
    std::vector<ImuSample> waiting;
    int dropped = 0;
    for (const Shown& original : clean) {
        Shown shown = original;
        const int k = shown.frame.index - fault.first;
        if (fault.frames > 0 && k >= fault.frames + kAfter) break;
        shown.faulty = k >= 0 && (fault.frames == 0 || k < fault.frames) && fault.name != "none";
        if (shown.faulty && fault.damage) fault.damage(shown, k, bench);
        if (shown.dropped) {
            waiting.insert(waiting.end(), shown.frame.imu.begin(), shown.frame.imu.end());
            ++dropped;
            continue;
        }
        if (dropped > 0) shown.faulty = true;  // the next frame shows the gap in the images
        shown.frame.imu.insert(shown.frame.imu.begin(), waiting.begin(), waiting.end());
        waiting.clear();
        shown.frame.frame_status.dropped = std::exchange(dropped, 0);
        if (fault.watched) shown.frame.frame_status = watch.check(shown.frame);
        out.push_back(std::move(shown));
    }
    return out;
}

/// An estimated motion, its stated covariance, and the true motion.
struct Piece {
    Pose T_true;
    Pose T_found;
    Matrix6 covariance = Matrix6::Zero();
    Health worst = Health::ok;

    void append(const Piece& next) {
        covariance = compose_covariance(covariance, next.T_found, next.covariance);
        T_true = T_true * next.T_true;
        T_found = T_found * next.T_found;
        worst = std::max(worst, next.worst);
    }
    /// Returns the columns err_mm,err_deg,sig_mm,sig_deg.
    [[nodiscard]] std::string text() const {
        const Vector6 error = difference(T_true, T_found);
        const auto sigma = [](const Eigen::Matrix3d& part) {
            const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(part,
                                                                       Eigen::EigenvaluesOnly);
            return std::sqrt(std::max(eigen.eigenvalues().maxCoeff(), 0.0));
        };
        return fmt::format("{:.3f},{:.4f},{:.3f},{:.4f}",
                           1e3 * error.head<3>().norm(),
                           kDegPerRad * error.tail<3>().norm(),
                           1e3 * sigma(covariance.topLeftCorner<3, 3>()),
                           kDegPerRad * sigma(covariance.bottomRightCorner<3, 3>()));
    }
};

struct Recording {
    camera::StereoRig rig;
    std::vector<Shown> frames;
    pipeline::PipelineConfig config;
};

Status follow(const Recording& recording,
              const Fault& fault,
              const std::vector<Shown>& shown,
              const std::string& head,
              bool with_imu,
              Executor& executor,
              fmt::ostream& out) {
    pipeline::PipelineConfig config = recording.config;
    config.odometry.imu.enabled = with_imu;
    camera::StereoRig rig = recording.rig;
    if (fault.rig) fault.rig(rig);
    auto pipeline = pipeline::Pipeline::make(config, rig, executor);
    if (!pipeline) return pipeline.error();
    std::vector<StereoFrame> first;
    for (std::size_t i = 0; i < pipeline::Pipeline::kAlignmentFrames; ++i)
        first.push_back(shown[i].frame);
    pipeline->align(first, shown.front().T_world_body);

    std::vector<Piece> pieces;
    std::optional<Piece> since;
    std::vector<double> times_s;
    for (std::size_t i = 0; i < shown.size(); ++i) {
        const FrameReport report = pipeline->process(shown[i].frame, Work::odometry);
        const MotionEstimate& m = report.motion;
        const Pose T_true =
            i > 0 ? shown[i - 1].T_world_body.inverse() * shown[i].T_world_body : Pose{};
        pieces.push_back({T_true, m.T_previous_body, m.relative_covariance, m.health});
        times_s.push_back(seconds_from_ns(
            recording.frames[static_cast<std::size_t>(shown[i].frame.index - kFirst)]
                .frame.time_ns));
        // A motion belongs to the frame at its end. So the first motion of the last second begins
        // one second ago.
        Piece second;
        for (std::size_t k = 0; k <= i; ++k)
            if (times_s[k] > times_s[i] - kWindow_s + 1e-3) second.append(pieces[k]);
        if (since || (shown[i].faulty && i > 0)) {
            if (!since) since.emplace();
            since->append(pieces.back());
        }
        out.print(
            "{},{},{},{},{:d},{},{},{:d},{},{},{:.2f},{},{},{},{},{},{}\n",
            head,
            shown[i].frame.index,
            to_string(m.health),
            to_string(m.reason),
            shown[i].faulty,
            to_string(report.camera),
            m.tracks,
            pipeline::exposure_state_of(shown[i].frame) == pipeline::ExposureState::well_exposed,
            m.inliers,
            fmt::format("{:.3f}", m.residual_px),
            1e3 * T_true.translation_m.norm(),
            pieces.back().text(),
            second.text(),
            to_string(second.worst),
            since ? since->text() : ",,,",
            m.T_odom_body.all_finite() && m.relative_covariance.allFinite() ? 1 : 0,
            fault.frames);
    }
    return {};
}

Status measure(const SceneCase& now,
               const std::vector<Fault>& faults,
               const SettingsRequest& common,
               Executor& executor,
               fmt::ostream& out) {
    auto settings = surefoot::load_settings(common);
    if (!settings) return settings.error();
    sim::SceneOptions& sim = settings->sim;
    if (Status seen = now.put_into(sim); !seen) return seen.error();
    sim.frames = kFrames;
    auto source = sim::open_scene(sim, &executor);
    if (!source) return source.error();
    Recording recording{(*source)->rig(), {}, settings->pipeline};
    const sim::SceneTruth& truth = (*source)->truth();
    while (true) {
        auto frame = (*source)->next();
        if (!frame) return frame.error();
        if (!frame->has_value()) break;
        if ((**frame).index < kFirst) continue;
        Shown shown;
        shown.frame = **std::move(frame);
        shown.T_world_body = experiments::true_pose(truth.trajectory, shown.frame.time_ns);
        recording.frames.push_back(std::move(shown));
    }
    const camera::StereoRig cameras = experiments::true_rig(recording.rig, sim);
    sim::CameraConfig camera = sim.camera;
    sim::apply_profile(sim.profile, sim.noise, camera);
    auto renderer = sim::Renderer::make(truth.scene, cameras, camera, sim.seed);
    if (!renderer) return renderer.error();
    Painter painter(cameras, std::move(renderer).value(), executor);
    for (const Fault& fault : faults) {
        const std::vector<Shown> shown = damaged(recording.frames, fault, painter);
        for (const bool with_imu : {true, false}) {
            if (fault.of_imu && !with_imu) continue;
            const std::string head = fmt::format("{},{},{},{},\"{}\",{:d}",
                                                 now.scene,
                                                 now.seed,
                                                 now.profile,
                                                 fault.name,
                                                 fault.severity,
                                                 with_imu);
            if (Status done = follow(recording, fault, shown, head, with_imu, executor, out); !done)
                return done;
        }
        out.flush();
    }
    return {};
}

int measure_all(const std::vector<std::string>& words) {
    if (words.size() < 2)
        return report(
            usage_error("odometry_faults OUT.csv SCENES [FIRST_SEED [SEEDS [PROFILES [FAULTS "
                        "[KEY=VALUE...]]]]]"));
    std::vector<Fault> faults = all_faults();
    if (words.size() > 5 && words[5] != "all") {
        const auto wanted = io::split(words[5], ",");
        std::erase_if(faults, [&](const Fault& fault) {
            return std::ranges::find(wanted, fault.name) == wanted.end();
        });
    }
    SettingsRequest common;
    if (words.size() > 6) common.overrides.assign(words.begin() + 6, words.end());
    const auto executor = surefoot::make_executor();
    auto out = fmt::output_file(words[0]);
    out.print(
        "scene,seed,profile,fault,severity,imu,frame,health,reason,faulty,camera,tracks,lit,"
        "inliers,"
        "residual_px,path_mm,err_mm,err_deg,sig_mm,sig_deg,s_mm,s_deg,s_sig_mm,s_sig_deg,s_health,"
        "since_mm,since_deg,since_sig_mm,since_sig_deg,finite,fault_frames\n");
    for (const SceneCase& now : experiments::scene_cases({words.begin() + 1, words.end()})) {
        const auto done = measure(now, faults, common, *executor, out);
        if (!done) return report(done.error());
    }
    return kExitOk;
}

}  // namespace
}  // namespace surefoot::app

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    return surefoot::app::measure_all({argv + 1, argv + argc});
}
