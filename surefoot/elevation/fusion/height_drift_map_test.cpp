// SPDX-License-Identifier: Apache-2.0
// Height drift in the whole map: a machine walks to and fro over a floor while its odometry drifts.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <vector>

#include "surefoot/core/executors_testing.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/elevation/elevation_map.hpp"

namespace surefoot::elevation {
namespace {

constexpr std::int64_t kFrame_ns = 66'666'667;
constexpr double kCamera_m = 1.0;       ///< over the floor
constexpr double kCellNoise_m = 0.004;  ///< shared by points within 40 mm
constexpr double kTilt_rad = 0.0005;    ///< from frame to frame

using Ground = std::function<double(double x_m, double y_m)>;

double flat(double, double) {
    return 0.0;
}

/// The remembered map, relative to the present estimate of the pose.
struct Memory {
    double rms_m = 0.0;
    int cells = 0;
};

class Walk {
  public:
    explicit Walk(std::uint64_t seed,
                  double drift_m = 0.0,
                  bool enabled = true,
                  Executor& executor = serial())
        : rng_(seed), executor_(executor), drift_sigma_m_(drift_m), map_(config(enabled)) {
        covariance_(2, 2) = drift_sigma_m_ * drift_sigma_m_;
    }

    void ahead(double length_m, int frames, const Ground& ground = flat) {
        for (int i = 0; i < frames; ++i) {
            x_m_ += length_m / frames * std::cos(yaw_rad_);
            y_m_ += length_m / frames * std::sin(yaw_rad_);
            frame(ground);
        }
    }
    void turn(double angle_rad, int frames, const Ground& ground = flat) {
        for (int i = 0; i < frames; ++i) {
            yaw_rad_ += angle_rad / frames;
            frame(ground);
        }
    }
    void to_and_fro(const Ground& ground = flat) {
        ahead(1.5, 30, ground);
        turn(std::numbers::pi, 30, ground);
        ahead(1.5, 30, ground);
        turn(std::numbers::pi, 30, ground);
    }

    /// Takes one frame at the present position of the machine.
    void frame(const Ground& ground) {
        drift_m_ += drift_sigma_m_ * rng_.normal();
        const Pose T_world_body{exp_so3({0.0, 0.0, yaw_rad_}), {x_m_, y_m_, kCamera_m}};
        Pose T_odom_body = T_world_body;
        T_odom_body.translation_m.z() += drift_m_;
        see(T_world_body, ground);
        map_.follow(T_odom_body, covariance_);
        time_ns_ += kFrame_ns;
        map_.add_points(points_, {}, T_odom_body, time_ns_, executor_);
        if (map_.height_drift().reason == HeightDriftReason::moved) ++moves_;
    }

    void go_blindly(int motions) {
        for (int i = 0; i < motions; ++i) {
            drift_m_ += drift_sigma_m_ * rng_.normal();
            map_.follow({exp_so3({0.0, 0.0, yaw_rad_}), {x_m_, y_m_, kCamera_m + drift_m_}},
                        covariance_);
        }
    }
    /// Adds 35 mm of height uncertainty; afterwards the motion is certain.
    void blur_by_blind_motion() {
        covariance_(2, 2) = 1e-4;
        go_blindly(12);
        covariance_(2, 2) = 1e-8;
    }
    void jump(double height_m) { drift_m_ += height_m; }
    void pitch(double error_rad) { pitch_rad_ = error_rad; }
    void expect(const Matrix6& covariance) { covariance_ = covariance; }

    [[nodiscard]] Memory memory(const Ground& ground = flat, double older_than_s = 1.0) const {
        Memory memory;
        const grid::GridGeometry& geometry = map_.geometry();
        for (int iy = 0; iy < geometry.ny; ++iy) {
            for (int ix = 0; ix < geometry.nx; ++ix) {
                const float height_m = map_.layers().height_m.at(ix, iy);
                const double age_s =
                    1e-9 * static_cast<double>(time_ns_ - map_.layers().seen_ns.at(ix, iy));
                if (std::isnan(height_m) || age_s < older_than_s) continue;
                const Eigen::Vector2d at_m = geometry.center_m({ix, iy});
                const double error_m =
                    static_cast<double>(height_m) - drift_m_ - ground(at_m.x(), at_m.y());
                memory.rms_m += error_m * error_m;
                ++memory.cells;
            }
        }
        memory.rms_m = std::sqrt(memory.rms_m / std::max(memory.cells, 1));
        return memory;
    }
    [[nodiscard]] const ElevationMap& map() const { return map_; }
    [[nodiscard]] double drift_m() const { return drift_m_; }
    [[nodiscard]] int moves() const { return moves_; }

  private:
    static ElevationConfig config(bool enabled) {
        ElevationConfig config;
        config.height_drift.enabled = enabled;
        return config;
    }

    /// Observes a sector of the ground ahead, 0.5-2.5 m.
    void see(const Pose& T_world_body, const Ground& ground) {
        points_.clear();
        const Eigen::Vector3d tilt(
            kTilt_rad * rng_.normal(), pitch_rad_ + kTilt_rad * rng_.normal(), 0.0);
        const Eigen::Matrix3d R_wrong_right = exp_so3(tilt).toRotationMatrix();
        constexpr double kStep_m = 0.01;
        noise_m_.resize(64 * 100);
        for (double& noise_m : noise_m_) noise_m = kCellNoise_m * rng_.normal();
        for (int i = 50; i < 250; ++i) {
            const int half = 6 * i / 10;
            for (int j = -half; j < half; ++j) {
                Eigen::Vector3d p_m = T_world_body * Eigen::Vector3d(i * kStep_m, j * kStep_m, 0.0);
                const auto patch = static_cast<std::size_t>(i / 4 * 100 + (j + 200) / 4);
                p_m.z() = ground(p_m.x(), p_m.y()) + noise_m_[patch % noise_m_.size()];
                points_.push_back({(R_wrong_right * (T_world_body.inverse() * p_m)).cast<float>(),
                                   static_cast<float>(kCellNoise_m * kCellNoise_m),
                                   static_cast<float>(kCellNoise_m * kCellNoise_m)});
            }
        }
    }

    Rng rng_;
    Executor& executor_;
    double drift_sigma_m_;
    ElevationMap map_;
    Matrix6 covariance_ = Matrix6::Zero();
    double x_m_ = 0.0;
    double y_m_ = 0.0;
    double yaw_rad_ = 0.0;
    double pitch_rad_ = 0.0;
    double drift_m_ = 0.0;
    std::int64_t time_ns_ = 0;
    int moves_ = 0;
    std::vector<double> noise_m_;
    std::vector<MeasuredPoint> points_;
};

TEST(HeightDriftMap, WhereTheMapReturnsToASeenPlaceTheRememberedErrorsFall) {
    constexpr double kDrift_m = 0.002;  // from one motion to the next
    constexpr int kWalks = 12;
    double without_m2 = 0.0;
    double with_m2 = 0.0;
    int moves = 0;
    for (std::uint64_t seed = 101; seed < 101 + kWalks; ++seed) {
        Walk without(seed, kDrift_m, false);
        Walk with(seed, kDrift_m, true);
        for (Walk* walk : {&without, &with}) {
            walk->turn(2.0 * std::numbers::pi, 20);
            walk->go_blindly(60);  // away and back, outside of the map
            walk->turn(0.3 * std::numbers::pi, 6);
        }
        ASSERT_EQ(with.drift_m(), without.drift_m());
        ASSERT_GT(with.memory(flat, 0.5).cells, 5000);
        without_m2 += std::pow(without.memory(flat, 0.5).rms_m, 2) / kWalks;
        with_m2 += std::pow(with.memory(flat, 0.5).rms_m, 2) / kWalks;
        moves += with.moves();
    }
    RecordProperty("moves", std::to_string(moves));
    RecordProperty("without_mm", std::to_string(1e3 * std::sqrt(without_m2)));
    RecordProperty("with_mm", std::to_string(1e3 * std::sqrt(with_m2)));
    EXPECT_GT(moves, 0);
    EXPECT_LT(std::sqrt(with_m2), 0.75 * std::sqrt(without_m2));
}

TEST(HeightDriftMap, ADriftBetweenTwoLooksMovesOnceWhatWasSeenBeforeIt) {
    for (const double drift_m : {0.025, -0.025}) {
        Walk walk(1);
        Matrix6 covariance = Matrix6::Zero();
        covariance(2, 2) = 1e-12;
        walk.expect(covariance);
        walk.turn(2.0 * std::numbers::pi, 40);
        covariance(2, 2) = 1e-4;
        walk.expect(covariance);
        walk.go_blindly(12);  // (35 mm)^2
        walk.jump(drift_m);
        covariance(2, 2) = 1e-12;
        walk.expect(covariance);
        const float before_m = walk.map().layers().height_m.at(60, 120);  // 1.5 m behind
        const float before_m2 = walk.map().layers().height_var_m2.at(60, 120);
        walk.frame(flat);
        const HeightDriftReport report = walk.map().height_drift();
        EXPECT_EQ(report.reason, HeightDriftReason::moved);
        EXPECT_NEAR(report.offset_m, drift_m, 3.0 * report.sigma_m);
        EXPECT_GT(report.moved_cells, 10000);
        EXPECT_FLOAT_EQ(walk.map().layers().height_m.at(60, 120),
                        before_m + static_cast<float>(report.offset_m));
        EXPECT_NEAR(walk.map().layers().height_var_m2.at(60, 120) - before_m2,
                    report.sigma_m * report.sigma_m,
                    1e-9);
        EXPECT_LT(walk.memory(flat, 0.5).rms_m, 0.2 * std::abs(drift_m));
        walk.turn(2.0 * std::numbers::pi, 40);
        EXPECT_EQ(walk.moves(), 1) << "never again by the same";
    }
}

TEST(HeightDriftMap, GroundThatChangedMovesNothingElse) {
    // Changes made while the camera did not observe them: a mat of 20 mm over half of the view,
    // more or less, at either side, far or near; and a floor that ends ahead.
    std::vector<Ground> changes;
    for (const double edge_m : {-0.25, 0.0, 0.25}) {
        changes.emplace_back([=](double, double y_m) { return y_m > edge_m ? 0.02 : 0.0; });
        changes.emplace_back([=](double, double y_m) { return y_m < edge_m ? 0.02 : 0.0; });
    }
    changes.emplace_back([](double x_m, double) { return x_m > 1.8 ? 0.02 : 0.0; });
    changes.emplace_back([](double x_m, double) { return x_m < 1.8 ? 0.02 : 0.0; });
    changes.emplace_back([](double x_m, double) { return x_m > 1.5 ? -0.15 : 0.0; });
    for (std::size_t i = 0; i < changes.size(); ++i) {
        Walk walk(2, 0.0);
        walk.turn(2.0 * std::numbers::pi, 20);
        walk.blur_by_blind_motion();
        walk.frame(changes[i]);
        walk.turn(0.05, 4, changes[i]);
        EXPECT_EQ(walk.moves(), 0) << i;
    }
}

TEST(HeightDriftMap, APitchErrorMovesNothing) {
    for (const double pitch_rad : {0.004, -0.004, 0.008, -0.008, 0.012, -0.012, 0.02, -0.02}) {
        Walk walk(3, 0.0);
        walk.turn(2.0 * std::numbers::pi, 20);
        walk.blur_by_blind_motion();
        walk.pitch(pitch_rad);
        walk.frame(flat);
        walk.turn(0.5, 6);
        EXPECT_EQ(walk.moves(), 0) << pitch_rad;
    }
}

TEST(HeightDriftMap, WithoutMotionNothingMoves) {
    Walk walk(4, 0.0);
    walk.turn(2.0 * std::numbers::pi, 40);
    walk.jump(0.03);
    walk.turn(2.0 * std::numbers::pi, 40);
    EXPECT_EQ(walk.moves(), 0);
    EXPECT_EQ(walk.map().height_drift().reason, HeightDriftReason::no_old_ground);
}

TEST(HeightDriftMap, NothingIsSaidOfAnEmptyMapAndWhenItIsOff) {
    Walk walk(5, 0.001);
    walk.frame(flat);
    EXPECT_EQ(walk.map().height_drift().reason, HeightDriftReason::no_old_ground);
    Walk off(5, 0.001, false);
    off.to_and_fro();
    EXPECT_EQ(off.map().height_drift().reason, HeightDriftReason::off);
}

TEST(HeightDriftMap, AMotionThatSaysNothingClearsAndTheNextFrameStartsAnew) {
    for (const double bad : {std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN(),
                             1e11}) {
        Walk walk(6, 0.0005);
        walk.turn(std::numbers::pi, 15);
        Matrix6 covariance = Matrix6::Zero();
        covariance(2, 2) = bad;
        walk.expect(covariance);
        walk.frame(flat);
        walk.frame(flat);
        EXPECT_EQ(walk.moves(), 0) << bad;
        EXPECT_GT(walk.map().known_cells(), 1000) << bad;
    }
}

TEST(HeightDriftMap, TheOrderOfBlocksDoesNotShow) {
    Backwards backwards;
    Walk walk(8, 0.002);
    Walk other(8, 0.002, true, backwards);
    for (Walk* each : {&walk, &other}) {
        each->turn(2.0 * std::numbers::pi, 20);
        each->go_blindly(60);
        each->jump(0.03);
        each->turn(0.3 * std::numbers::pi, 6);
    }
    EXPECT_GT(walk.moves(), 0);
    const ElevationLayers& a = walk.map().layers();
    const ElevationLayers& b = other.map().layers();
    const std::size_t bytes = a.height_m.size() * sizeof(float);
    EXPECT_EQ(std::memcmp(a.height_m.data(), b.height_m.data(), bytes), 0);
    EXPECT_EQ(std::memcmp(a.height_var_m2.data(), b.height_var_m2.data(), bytes), 0);
}

TEST(HeightDriftMap, ALiftedCellIsAlignedAndTakesItsExtremesAlong) {
    ElevationConfig config;
    config.height_drift.enabled = true;
    ElevationCells cells(config, 1, 1);
    const ViewpointHistory views({});
    FusionCounts counts;
    cells.update(0, {{0.1F, 1e-4F, 0.12F, 0.09F, 5}, 1.0F}, {views, 1, 7}, counts);
    cells.count_motion();
    cells.memory_of_row(0).height_var_m2[0] += 4e-4F;
    cells.alignment().is_asked[0] = 1;
    EXPECT_FLOAT_EQ(cells.alignment().var_m2[0], 1e-4F);
    EXPECT_EQ(cells.alignment().step[0], 0U);
    cells.lift(0, 0.02, 1e-5);
    EXPECT_FLOAT_EQ(cells.layers().height_m.data()[0], 0.12F);
    EXPECT_FLOAT_EQ(cells.layers().highest_m.data()[0], 0.14F);
    EXPECT_FLOAT_EQ(cells.layers().lowest_m.data()[0], 0.11F);
    EXPECT_FLOAT_EQ(cells.layers().height_var_m2.data()[0], 5.1e-4F);
    EXPECT_FLOAT_EQ(cells.alignment().var_m2[0], 5.1e-4F);
    EXPECT_EQ(cells.alignment().step[0], 1U);
    EXPECT_EQ(cells.alignment().is_asked[0], 0);
    EXPECT_EQ(cells.layers().seen_ns.data()[0], 7) << "moved is not seen";
}

}  // namespace
}  // namespace surefoot::elevation
