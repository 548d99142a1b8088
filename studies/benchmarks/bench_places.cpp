// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "service/console/option_settings.hpp"
#include "studies/benchmarks/bench_result.hpp"
#include "studies/runs/run_output.hpp"
#include "surefoot/camera/rectifier.hpp"
#include "surefoot/place_recognition/describe.hpp"
#include "surefoot/place_recognition/place_memory.hpp"
#include "surefoot/sim/scene_source.hpp"
#include "surefoot/stereo/matcher.hpp"

namespace surefoot::app {
namespace {

constexpr int kCorridors = 50;
constexpr int kKeyframes =
    10;                      ///< keyframes per corridor; all corridors together fill the database
constexpr int kQueries = 5;  ///< number of queries in each queried corridor
constexpr int kGoneThrough = 12;  ///< number of queried corridors of each kind (known, unknown)
constexpr double kApart_m = 100.0;
static_assert(kCorridors * kKeyframes == place_recognition::kMostKeyframes);

/// An observation: the rectified images, the depth, and the true pose in the scene.
struct Look {
    camera::RectifiedPair images;
    DepthImage depth;
    Pose T_scene_body;

    [[nodiscard]] Eigen::Vector3d up_body() const {
        return T_scene_body.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    }
};

/// Simulated corridors, seen by a camera with the noise profile of the ZED. The corridors differ in
/// their textures, and by centimetres in their dimensions.
class Corridors {
  public:
    Corridors(const Settings& settings, Executor& executor)
        : settings_(settings),
          executor_(executor),
          matcher_(stereo::make_matcher(settings.pipeline.stereo)) {}

    /// Returns `count` observations along the path through one corridor. The first frame is at rest
    /// and is left out.
    [[nodiscard]] Result<std::vector<Look>> look(std::uint64_t seed, double rate_hz, int count) {
        sim::SceneOptions scene = settings_.sim;
        scene.scene = "corridor";
        scene.profile = sim::CameraProfile::zed;
        scene.seed = seed;
        scene.rate_hz = rate_hz;
        scene.frames = count + 1;
        auto source = sim::open_scene(scene, &executor_);
        if (!source) return source.error();
        const auto rectifier = camera::Rectifier::make((*source)->rig());
        if (!rectifier) return rectifier.error();
        rig_ = rectifier->rig();
        std::vector<Look> looks;
        for (int i = 0; i <= count; ++i) {
            auto frame = (*source)->next();
            if (!frame) return frame.error();
            if (!*frame)
                return input_error(
                    "bench places: the path through the simulated corridor has too few frames");
            if (i == 0) continue;
            Look& look = looks.emplace_back();
            rectifier->rectify(**frame, look.images);
            matcher_->match(
                look.images.left.view(), look.images.right.view(), executor_, look.depth);
            look.T_scene_body =
                (*source)->truth().trajectory[static_cast<std::size_t>(i)].T_world_body;
        }
        return looks;
    }
    /// Returns the rig of the last call of `look`.
    [[nodiscard]] const camera::RectifiedRig& rig() const noexcept { return rig_; }

  private:
    const Settings& settings_;
    Executor& executor_;
    std::unique_ptr<stereo::Matcher> matcher_;
    camera::RectifiedRig rig_;
};

place_recognition::View view_of(const Look& look, const camera::RectifiedRig& rig) {
    return {0, rig, place_recognition::describe({}, look.images.left.view(), look.depth)};
}

/// Fills the place database to its limit. The corridors are kApart_m apart.
Result<place_recognition::PlaceMemory> remember(Corridors& corridors, std::uint64_t first_seed) {
    constexpr double kRate_hz = 1.0;
    place_recognition::PlaceMemory memory;
    for (int i = 0; i < kCorridors; ++i) {
        const auto looks =
            corridors.look(first_seed + static_cast<std::uint64_t>(i), kRate_hz, kKeyframes);
        if (!looks) return looks.error();
        for (const Look& look : *looks) {
            Pose T_map_body = look.T_scene_body;
            T_map_body.translation_m.y() += kApart_m * i;
            memory.add({view_of(look, corridors.rig()), T_map_body});
        }
    }
    return memory;
}

struct Queries {
    std::vector<double> wall_ms;
    std::vector<double> cpu_ms;
    int recognised = 0;
};

/// Times one query. The time includes the description of the image.
void ask(const place_recognition::PlaceMemory& memory,
         const Look& look,
         const camera::RectifiedRig& rig,
         Queries& queries) {
    const std::int64_t start_ns = steady_now_ns();
    const std::int64_t start_cpu_ns = cpu_now_ns();
    const place_recognition::Answer answer =
        memory.recognise(view_of(look, rig), look.up_body(), place_recognition::kMostKeyframes);
    queries.wall_ms.push_back(1e-6 * static_cast<double>(steady_now_ns() - start_ns));
    queries.cpu_ms.push_back(1e-6 * static_cast<double>(cpu_now_ns() - start_cpu_ns));
    queries.recognised += answer.refusal == place_recognition::Refusal::none ? 1 : 0;
}

}  // namespace

Result<std::vector<BenchResult>> bench_places(const CommonOptions& common, Executor& executor) {
    constexpr double kRate_hz = 0.7;  // Queries lie between keyframes and have different noise.
    const auto settings = load_settings(common);
    if (!settings) return settings.error();
    Corridors corridors(*settings, executor);
    const auto memory = remember(corridors, common.seed);
    if (!memory) return memory.error();
    std::vector<BenchResult> results;
    for (const bool known : {true, false}) {
        Queries queries;
        const std::uint64_t first_seed = common.seed + (known ? 0 : kCorridors);
        for (std::uint64_t i = 0; i < kGoneThrough; ++i) {
            const auto looks = corridors.look(first_seed + i, kRate_hz, kQueries);
            if (!looks) return looks.error();
            for (const Look& look : *looks) ask(*memory, look, corridors.rig(), queries);
        }
        if (known && queries.recognised == 0)
            return input_error("bench places: no place is recognised, so the timing means little");
        const Percentiles wall = percentiles(std::move(queries.wall_ms));
        const double least_ms = *std::min_element(queries.cpu_ms.begin(), queries.cpu_ms.end());
        results.push_back(
            {fmt::format("places/query_among_{}_{}",
                         place_recognition::kMostKeyframes,
                         known ? "known" : "unknown"),
             {wall.median, wall.p99, least_ms, percentiles(std::move(queries.cpu_ms)).median}});
    }
    return results;
}

}  // namespace surefoot::app
