// SPDX-License-Identifier: Apache-2.0
// A sill that the noise may hide is said to be hidden; one that stands out of it is not.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "surefoot/pipeline/pipeline.hpp"
#include "surefoot/sim/scene_source.hpp"
#include "surefoot/traversability/rating_confidence.hpp"

namespace surefoot::terrain {
namespace {

constexpr int kAtFirst = 1;   ///< number of frames
constexpr int kFromAfar = 2;  ///< ends 1.3 m before the sill
constexpr int kNear = 7;      ///< ends half a metre nearer
constexpr double kRate_hz = 2.0;

/// Runs rendered pairs towards a sill through the whole pipeline, with known poses.
class SillInSight {
  public:
    SillInSight(sim::CameraProfile profile, const std::string& sill, int frames) {
        sim::SceneOptions options;
        options.scene = "tests/terrain/sill.yaml#" + sill;
        options.profile = profile;
        options.known_motion = true;
        options.rate_hz = kRate_hz;
        auto source = sim::open_scene(options, &serial()).value();
        pipeline_ = std::make_unique<pipeline::Pipeline>(
            pipeline::Pipeline::make({}, source->rig(), serial()).value());
        for (int i = 0; i < frames; ++i) {
            const StereoFrame frame = source->next().value().value();
            if (i == 0) pipeline_->align({&frame, 1}, source->info().T_odom_first_body);
            pipeline_->process(frame, Work::full);
        }
    }

    /// Map and `not resolvable` flag in the middle of the sill, one cell from its edges.
    struct Said {
        int cells = 0;
        int known = 0;
        int not_resolvable = 0;
        double height_m = 0.0;  ///< mean, above the mean floor before the sill
    };
    /// `step_m`: the height of a step that matters.
    [[nodiscard]] Said ask(double step_m) const {
        const elevation::ElevationLayers& map = pipeline_->map().layers();
        const grid::GridGeometry& grid = pipeline_->map().geometry();
        traversability::TraversabilityConfig config;
        config.resolve.step_m = step_m;
        traversability::Traversability rater(config);
        traversability::TraversabilityLayers rating;
        rater.rate(map.height_m.view(), grid.resolution_m, serial(), rating);
        traversability::ConfidenceLayers confidence;
        traversability::RatingConfidence(config, grid.resolution_m)
            .compute(
                {map.height_m.view(), map.height_var_m2.view(), rater.rated_step_heights(), rating},
                confidence);
        Said said;
        double sill_m = 0.0;
        double floor_m = 0.0;
        int floor = 0;
        for (int iy = 0; iy < grid.ny; ++iy) {
            for (int ix = 0; ix < grid.nx; ++ix) {
                const Eigen::Vector2d at_m = grid.center_m({ix, iy});
                const auto z_m = static_cast<double>(map.height_m.at(ix, iy));
                if (std::abs(at_m.y()) > 0.3) continue;
                if (at_m.x() > kBegin_m - 0.25 && at_m.x() < kBegin_m - 0.05 && !std::isnan(z_m)) {
                    floor_m += z_m;
                    ++floor;
                }
                if (at_m.x() < kBegin_m + 0.025 || at_m.x() > kEnd_m - 0.025) continue;
                ++said.cells;
                if (std::isnan(z_m)) continue;
                ++said.known;
                said.not_resolvable += confidence.not_resolvable.at(ix, iy) == 1.0F ? 1 : 0;
                sill_m += z_m;
            }
        }
        said.height_m = sill_m / said.known - floor_m / floor;
        return said;
    }

  private:
    static constexpr double kBegin_m = 1.325;  ///< from the scene file
    static constexpr double kEnd_m = 1.475;
    std::unique_ptr<pipeline::Pipeline> pipeline_;
};

// Two frames resolve 3 of the 96 cells: their smallest step is 9.9 mm, and the mean height of the
// sill is 10.2 mm.
TEST(Sill, TenMillimetresUnderTheNoiseOfTheZedAreSaidToBeHidden) {
    const auto said = SillInSight(sim::CameraProfile::zed, "sill_10", kAtFirst).ask(0.010);
    EXPECT_GT(said.known, 90 * said.cells / 100);
    EXPECT_EQ(said.not_resolvable, said.known);
}

TEST(Sill, TheyAreResolvedOnceSeenFromNear) {
    const auto said = SillInSight(sim::CameraProfile::zed, "sill_10", kNear).ask(0.010);
    EXPECT_EQ(said.known, said.cells);
    EXPECT_LT(said.not_resolvable, said.known / 10);
    EXPECT_NEAR(said.height_m, 0.010, 0.003);
}

TEST(Sill, TwentyMillimetresAreResolvedFromAfarByAnIdealCamera) {
    const SillInSight ideal(sim::CameraProfile::ideal, "sill_20", kFromAfar);
    const auto said = ideal.ask(0.020);
    EXPECT_EQ(said.known, said.cells);
    EXPECT_EQ(said.not_resolvable, 0);
    EXPECT_NEAR(said.height_m, 0.020, 0.003);
    EXPECT_GT(ideal.ask(0.005).not_resolvable, 90) << "a step of 5 mm must stay unresolvable";
}

}  // namespace
}  // namespace surefoot::terrain
