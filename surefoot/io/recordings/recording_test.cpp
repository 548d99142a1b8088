// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/recordings/recording.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "surefoot/camera/rig_scaling.hpp"
#include "surefoot/io/calibration/rig_file.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/io/io_testing.hpp"
#include "surefoot/io/recordings/recorder.hpp"

namespace surefoot::io {
namespace {

using testing::contains;
using testing::data_path;
using testing::TemporaryFolder;

constexpr int kWidth = 32;
constexpr int kHeight = 20;
constexpr std::int64_t kStart_ns = 1403715273262142976;
constexpr std::int64_t kPeriod_ns = 50'000'000;

GreyImage noise_image(int width, int height, std::uint64_t seed) {
    Rng rng(seed);
    GreyImage image(width, height);
    for (std::size_t i = 0; i < image.size(); ++i) {
        image.data()[i] = static_cast<std::uint8_t>(rng.below(256));
    }
    return image;
}

camera::StereoRig small_rig() {
    camera::StereoRig rig;
    camera::PinholeRadTan lens;
    lens.fx_px = lens.fy_px = 30.0;
    lens.cx_px = 15.5;
    lens.cy_px = 9.5;
    lens.k1 = -0.1;
    lens.k3 = 0.01;
    rig.left = {lens, kWidth, kHeight};
    rig.right = rig.left;
    rig.T_left_right = {exp_so3({0.01, 0.02, -0.01}), {0.12, 0.001, 0.0}};
    rig.T_body_left = Pose{exp_so3({0.3, 0.1, 1.0}), {0.1, 0.0, 0.9}};
    rig.imu = camera::ImuMount{Pose{exp_so3({0.1, 0.0, 0.0}), {0.0, 0.01, 0.0}}, 200.0};
    rig.rate_hz = 20.0;
    return rig;
}

StereoFrame small_frame(int index) {
    StereoFrame frame;
    frame.index = index;
    frame.time_ns = kStart_ns + index * kPeriod_ns;
    frame.left = noise_image(kWidth, kHeight, static_cast<std::uint64_t>(2 * index));
    frame.right = noise_image(kWidth, kHeight, static_cast<std::uint64_t>(2 * index + 1));
    for (int i = 9; i >= 0; --i) {
        frame.imu.push_back(
            {frame.time_ns - i * 5'000'000, {0.1, 0.2, 1.0 / (i + 3)}, {9.8, 0.0, i * 0.1}});
    }
    return frame;
}

/// Five frames in the EuRoC layout.
void record(const std::string& folder, int frames = 5) {
    auto recorder = Recorder::create(folder, small_rig());
    ASSERT_TRUE(recorder.ok()) << recorder.error().message;
    for (int i = 0; i < frames; ++i) {
        const Status status = recorder->add(small_frame(i));
        ASSERT_TRUE(status.ok()) << status.error().message;
        ASSERT_TRUE(recorder->add_truth(small_frame(i).time_ns, Pose{}).ok());
    }
    ASSERT_TRUE(recorder->finish().ok());
}

/// All outputs of a source: one line per frame or error.
struct Played {
    std::vector<StereoFrame> frames;
    std::string errors;
};

Played play(const std::string& path, const OpenOptions& options = {}) {
    Played played;
    auto source = open_source(path, options);
    if (!source.ok()) {
        played.errors = source.error().message;
        return played;
    }
    while (true) {
        auto next = (*source)->next();
        if (!next.ok()) {
            played.errors += next.error().message + "\n";
            continue;
        }
        if (!next->has_value()) return played;
        played.frames.push_back(std::move(**next));
    }
}

void replace_in_file(const std::string& path, const std::string& from, const std::string& to) {
    std::string text = *read_file(path);
    const std::size_t at = text.find(from);
    ASSERT_NE(at, text.npos) << from;
    ASSERT_TRUE(write_file(path, text.replace(at, from.size(), to)).ok());
}

std::string stamp(int index) {
    return std::to_string(kStart_ns + index * kPeriod_ns);
}

TEST(Recorder, WhatIsRecordedIsPlayedBackBitExactly) {
    const TemporaryFolder folder;
    record(folder / "r");
    auto source = open_source(folder / "r");
    ASSERT_TRUE(source.ok()) << source.error().message;
    EXPECT_EQ((*source)->info().kind, "euroc");
    EXPECT_EQ((*source)->info().frames, 5);
    EXPECT_TRUE((*source)->info().has_imu);
    const camera::StereoRig original = small_rig();
    const camera::StereoRig& rig = (*source)->rig();
    constexpr double kMatrixRounding = 1e-14;
    EXPECT_LT(difference(rig.T_left_right, original.T_left_right).norm(), kMatrixRounding);
    EXPECT_LT(difference(*rig.T_body_left, *original.T_body_left).norm(), kMatrixRounding);
    EXPECT_LT(difference(rig.imu->T_body_imu, original.imu->T_body_imu).norm(), kMatrixRounding);
    EXPECT_EQ(std::get<camera::PinholeRadTan>(rig.left.model).k3, 0.01);
    const Played played = play(folder / "r");
    EXPECT_EQ(played.errors, "");
    ASSERT_EQ(played.frames.size(), 5U);
    for (int i = 0; i < 5; ++i) {
        const StereoFrame& frame = played.frames[static_cast<std::size_t>(i)];
        const StereoFrame expected = small_frame(i);
        EXPECT_EQ(frame.time_ns, expected.time_ns);
        EXPECT_EQ(frame.index, i);
        EXPECT_EQ(frame.left, expected.left) << i;
        EXPECT_EQ(frame.right, expected.right) << i;
        ASSERT_EQ(frame.imu.size(), expected.imu.size()) << i;
        for (std::size_t k = 0; k < frame.imu.size(); ++k) {
            EXPECT_EQ(frame.imu[k].time_ns, expected.imu[k].time_ns);
            EXPECT_EQ(frame.imu[k].angular_velocity_rad_s, expected.imu[k].angular_velocity_rad_s);
            EXPECT_EQ(frame.imu[k].specific_force_m_s2, expected.imu[k].specific_force_m_s2);
        }
    }
    EXPECT_EQ(play(folder / "r/mav0").frames.size(), 5U) << "from inside";
}

TEST(Recorder, RgbdIsPlayedBackToTheStepOfItsDepths) {
    const TemporaryFolder folder;
    camera::StereoRig rig = small_rig();
    rig.right.reset();
    StereoFrame frame = small_frame(0);
    frame.right = GreyImage();
    frame.depth_m = Image<float>(kWidth, kHeight, std::numeric_limits<float>::quiet_NaN());
    frame.depth_m.at(3, 4) = 1.23456F;
    frame.depth_m.at(4, 4) = 13.107F;  // the last code
    frame.depth_m.at(5, 4) = 13.2F;
    auto recorder = Recorder::create(folder / "r", rig);
    ASSERT_TRUE(recorder.ok()) << recorder.error().message;
    ASSERT_TRUE(recorder->add(frame).ok());
    // Not finished, and the next frame got no further than its depth.
    const std::string depths = *read_file(folder / "r/depth.txt");
    ASSERT_TRUE(write_file(folder / "r/depth.txt", depths + "1403715273.5 depth/b.png\n").ok());
    const Played played = play(folder / "r");
    EXPECT_EQ(played.errors, "");
    ASSERT_EQ(played.frames.size(), 1U);
    EXPECT_EQ(played.frames[0].time_ns, frame.time_ns);
    EXPECT_EQ(played.frames[0].left, frame.left);
    const Image<float>& depth_m = played.frames[0].depth_m;
    constexpr float kHalfStep_m = 0.5F / kDepthCodesPerMetre + 1e-6F;
    EXPECT_NEAR(depth_m.at(3, 4), 1.23456F, kHalfStep_m);
    EXPECT_NEAR(depth_m.at(4, 4), 13.107F, kHalfStep_m);
    EXPECT_TRUE(std::isnan(depth_m.at(5, 4))) << "has no code";
    EXPECT_TRUE(std::isnan(depth_m.at(0, 0)));
    const auto source = open_source(folder / "r");
    EXPECT_FALSE((*source)->rig().right);
    EXPECT_EQ(std::get<camera::PinholeRadTan>((*source)->rig().left.model).k3, 0.01);
    EXPECT_LT(difference(*(*source)->rig().T_body_left, *rig.T_body_left).norm(), 1e-14);
}

TEST(Recorder, AnInterruptedRecordingIsValid) {
    const TemporaryFolder folder;
    auto recorder = Recorder::create(folder / "r", small_rig());
    ASSERT_TRUE(recorder.ok());
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(recorder->add(small_frame(i)).ok());
    // Not finished; and the next frame got no further than its right list.
    EXPECT_EQ(play(folder / "r").frames.size(), 3U);
    const std::string list = *read_file(folder / "r/mav0/cam1/data.csv");
    ASSERT_TRUE(
        write_file(folder / "r/mav0/cam1/data.csv", list + stamp(3) + "," + stamp(3) + ".png\n")
            .ok());
    const Played played = play(folder / "r");
    EXPECT_EQ(played.frames.size(), 3U);
    EXPECT_EQ(played.errors, "");
}

TEST(Recorder, RefusesInWords) {
    const TemporaryFolder folder;
    record(folder / "r", 1);
    const auto message = [](const Result<Recorder>& r) {
        return r.ok() ? "ok" : r.error().message;
    };
    EXPECT_TRUE(contains(message(Recorder::create(folder / "r", small_rig())),
                         "holds a recording already"));
    camera::StereoRig rgbd = small_rig();
    rgbd.right.reset();
    EXPECT_TRUE(contains(Recorder::create(folder / "d", rgbd)->add(small_frame(0)).error().message,
                         "the left image has 32 x 20 px and the second image 0 x 0 px"))
        << "no depth";
    EXPECT_TRUE(
        contains(message(Recorder::create(folder / "d", small_rig())), "holds a recording already"))
        << "of the other layout";
    EXPECT_TRUE(contains(message(Recorder::create("/proc/nowhere", small_rig())), "/proc/nowhere"));
    auto recorder = Recorder::create(folder / "s", small_rig());
    ASSERT_TRUE(recorder.ok());
    ASSERT_TRUE(recorder->add(small_frame(1)).ok());
    EXPECT_TRUE(contains(recorder->add(small_frame(0)).error().message, "does not increase"));
    StereoFrame wrong = small_frame(2);
    wrong.right = GreyImage(3, 3);
    EXPECT_TRUE(
        contains(recorder->add(wrong).error().message, "3 x 3 px, but the rig is for 32 x 20"));
}

TEST(Recorder, ReadsBackWhatIsWholeAndOfItsSize) {
    const TemporaryFolder folder;
    record(folder / "r", 3);
    const std::string second = folder / "r/mav0/cam1/data/" + stamp(1) + ".png";
    const std::string bytes = *read_file(second);
    ASSERT_TRUE(write_file(second, bytes.substr(0, bytes.size() - 20)).ok());
    ASSERT_TRUE(
        write_file(folder / "r/mav0/cam0/data/" + stamp(2) + ".png", *format_png(GreyImage(3, 3)))
            .ok());
    const auto recorder = Recorder::create(folder / "r", small_rig(), Recorder::Existing::renew);
    ASSERT_TRUE(recorder.ok()) << recorder.error().message;
    StereoFrame frame;
    frame.time_ns = small_frame(0).time_ns;
    ASSERT_TRUE(recorder->read_back(frame));
    EXPECT_EQ(frame.left, small_frame(0).left);
    EXPECT_EQ(frame.right, small_frame(0).right);
    for (const int index : {1, 2, 3}) {  // cut off, of another size, not there
        StereoFrame missing;
        missing.time_ns = small_frame(index).time_ns;
        EXPECT_FALSE(recorder->read_back(missing)) << index;
        EXPECT_TRUE(missing.left.empty()) << index;
    }
}

TEST(Inspect, CountsFramesGapsAndSize) {
    const TemporaryFolder folder;
    record(folder / "r", 6);
    // Frame 3 is gone from both lists, one image is gone from the disk.
    for (const char* camera : {"cam0", "cam1"}) {
        replace_in_file(folder / ("r/mav0/" + std::string(camera) + "/data.csv"),
                        stamp(3) + "," + stamp(3) + ".png\n",
                        "");
    }
    std::filesystem::remove(folder / ("r/mav0/cam1/data/" + stamp(4) + ".png"));
    const auto info = inspect(folder / "r");
    ASSERT_TRUE(info.ok()) << info.error().message;
    EXPECT_EQ(info->kind, "euroc");
    EXPECT_EQ(info->frames, 5);
    EXPECT_DOUBLE_EQ(info->rate_hz, 20.0);
    EXPECT_DOUBLE_EQ(info->duration_s, 0.25);
    EXPECT_EQ(info->gaps, 1);
    EXPECT_DOUBLE_EQ(info->longest_gap_s, 0.1);
    EXPECT_EQ(info->imu_samples, 60);
    EXPECT_DOUBLE_EQ(info->imu_rate_hz, 200.0);
    EXPECT_EQ(info->missing_images, 1);
    EXPECT_TRUE(contains(info->first_missing, stamp(4)));
    EXPECT_TRUE(info->has_truth);
    EXPECT_GT(info->bytes, 9 * kWidth * kHeight);
}

TEST(EurocSource, OneBadFrameIsNamedAndTheOthersAreKept) {
    const TemporaryFolder folder;
    const auto damaged = [&](const std::string& name, auto damage) {
        record(folder / name);
        damage(folder / (name + "/mav0"));
        return play(folder / name);
    };
    const Played missing = damaged("missing", [](const std::string& mav) {
        std::filesystem::remove(mav + "/cam1/data/" + stamp(2) + ".png");
    });
    EXPECT_EQ(missing.frames.size(), 4U);
    EXPECT_TRUE(contains(missing.errors, "frame 2: ") &&
                contains(missing.errors, "cam1/data/" + stamp(2)) &&
                contains(missing.errors, "right image of this frame is missing"))
        << missing.errors;
    const Played truncated = damaged("truncated", [](const std::string& mav) {
        const std::string path = mav + "/cam0/data/" + stamp(1) + ".png";
        const std::string bytes = *read_file(path);
        ASSERT_TRUE(write_file(path, bytes.substr(0, bytes.size() / 2)).ok());
    });
    EXPECT_EQ(truncated.frames.size(), 4U);
    EXPECT_TRUE(contains(truncated.errors, "frame 1: ") &&
                contains(truncated.errors, "truncated PNG"))
        << truncated.errors;
    const Played unequal = damaged("unequal", [](const std::string& mav) {
        ASSERT_TRUE(write_png(mav + "/cam1/data/" + stamp(3) + ".png", GreyImage(16, 20)).ok());
    });
    EXPECT_TRUE(
        contains(unequal.errors, "frame 3: ") && contains(unequal.errors, "is 32 x 20 px, but") &&
        contains(unequal.errors, "16 x 20 px; both images of a frame must have the same size"))
        << unequal.errors;
    const Played backwards = damaged("backwards", [](const std::string& mav) {
        for (const char* camera : {"/cam0", "/cam1"}) {
            replace_in_file(mav + camera + "/data.csv", stamp(3) + ",", stamp(0) + ",");
        }
    });
    EXPECT_EQ(backwards.frames.size(), 4U);
    EXPECT_TRUE(contains(backwards.errors, "frame 3: ") &&
                contains(backwards.errors, "cam0/data.csv:5") &&
                contains(backwards.errors, "goes back"))
        << backwards.errors;
    const Played deep = damaged("deep", [](const std::string& mav) {
        ASSERT_TRUE(
            write_png(mav + "/cam0/data/" + stamp(0) + ".png", DepthCodes(kWidth, kHeight)).ok());
    });
    EXPECT_TRUE(contains(deep.errors, "frame 0: ") && contains(deep.errors, "16 bits"))
        << deep.errors;
}

TEST(EurocSource, BadListsAndCalibrationsAreNamed) {
    const TemporaryFolder folder;
    const auto error = [&](const std::string& name,
                           const std::string& file,
                           const std::string& from,
                           const std::string& to) {
        record(folder / name, 3);
        replace_in_file(folder / (name + "/mav0/" + file), from, to);
        return play(folder / name).errors;
    };
    EXPECT_TRUE(
        contains(error("a", "cam0/data.csv", stamp(1) + ",", "abc,"), "cam0/data.csv:3: expected"));
    EXPECT_TRUE(
        contains(error("b", "imu0/data.csv", "0.1,0.2,", "0.1,nan,"), "imu0/data.csv:2: 'nan'"));
    EXPECT_TRUE(contains(error("c", "imu0/data.csv", stamp(0) + ",", "5,"),
                         "IMU time stamp 5 ns does not increase"));
    EXPECT_TRUE(contains(error("d", "cam0/sensor.yaml", "intrinsics: [30,", "intrinsics: [.nan,"),
                         "cam0/sensor.yaml:9: intrinsics: nan"));
    EXPECT_TRUE(contains(error("e", "cam1/sensor.yaml", "resolution", "resolutoin"),
                         "key 'resolution' is missing"));
    EXPECT_TRUE(
        contains(error("f", "cam0/sensor.yaml", "[32, 20]", "[64, 40]"), "image sizes differ"));
    // Both cameras claim a resolution that differs from the images.
    record(folder / "g", 2);
    for (const char* camera : {"cam0", "cam1"}) {
        replace_in_file(
            folder / ("g/mav0/" + std::string(camera) + "/sensor.yaml"), "[32, 20]", "[48, 30]");
    }
    EXPECT_TRUE(contains(
        play(folder / "g").errors,
        "image is 32 x 20 px, but the rig is for 48 x 30 px; give the rig of this resolution"));
    OpenOptions rate;
    rate.rate_hz = 10.0;
    record(folder / "h", 2);
    EXPECT_TRUE(contains(play(folder / "h", rate).errors, "has time stamps of its own"));
}

TEST(EurocSource, BeginsAtAnyFrame) {
    const TemporaryFolder folder;
    record(folder / "r");
    const Played all = play(folder / "r");
    ASSERT_EQ(all.frames.size(), 5U);
    OpenOptions options;
    options.first_frame = 3;
    const Played later = play(folder / "r", options);
    ASSERT_EQ(later.frames.size(), 2U);
    EXPECT_EQ(later.errors, "");
    EXPECT_EQ(later.frames[0].index, 3);
    EXPECT_EQ(later.frames[0].time_ns, all.frames[3].time_ns);
    EXPECT_EQ(later.frames[0].left, all.frames[3].left);
    // Like any first frame it brings a stretch of IMU samples from before.
    ASSERT_GT(later.frames[0].imu.size(), all.frames[3].imu.size());
    EXPECT_EQ(later.frames[0].imu.back().time_ns, all.frames[3].imu.back().time_ns);
    EXPECT_EQ(later.frames[1].imu.size(), all.frames[4].imu.size());
    options.first_frame = 5;
    EXPECT_TRUE(play(folder / "r", options).frames.empty());
    options.first_frame = 50;
    EXPECT_TRUE(play(folder / "r", options).frames.empty());
}

/// Images binned two by two: the calibration is scaled, and a note reports it.
TEST(EurocSource, ACalibrationOfTwiceTheSizeIsHalved) {
    const TemporaryFolder folder;
    record(folder / "r", 2);
    const auto before = open_source(folder / "r");
    ASSERT_TRUE(before.ok());
    EXPECT_TRUE((*before)->info().notes.empty());
    const auto doubled = camera::scaled_to((*before)->rig(), 64, 40);
    ASSERT_TRUE(doubled.ok());
    OpenOptions options;
    options.rig_file = folder / "doubled.yaml";
    ASSERT_TRUE(write_rig_yaml(*options.rig_file, *doubled).ok());
    const auto source = open_source(folder / "r", options);
    ASSERT_TRUE(source.ok()) << source.error().message;
    ASSERT_EQ((*source)->info().notes.size(), 1U);
    EXPECT_TRUE(
        contains((*source)->info().notes[0],
                 "the calibration for 64 x 40 px is scaled by 0.5 to the images of 32 x 20"));
    EXPECT_EQ((*source)->rig().left.width, 32);
    const Eigen::Vector3d p(0.2, 0.1, 1.0);
    EXPECT_LT((*project((*source)->rig().left.model, p) - *project((*before)->rig().left.model, p))
                  .norm(),
              1e-12);
    EXPECT_EQ(play(folder / "r", options).errors, "");
}

TEST(EurocSource, WithoutImuAndWithoutImuCalibration) {
    const TemporaryFolder folder;
    record(folder / "r", 3);
    std::filesystem::remove(folder / "r/mav0/imu0/sensor.yaml");
    auto source = open_source(folder / "r");
    ASSERT_TRUE(source.ok()) << source.error().message;
    EXPECT_TRUE((*source)->info().has_imu);
    EXPECT_EQ((*source)->rig().imu->T_body_imu.translation_m.norm(), 0.0);
    std::filesystem::remove_all(folder / "r/mav0/imu0");
    source = open_source(folder / "r");
    ASSERT_TRUE(source.ok());
    EXPECT_FALSE((*source)->info().has_imu);
    EXPECT_EQ(play(folder / "r").frames.size(), 3U);
}

/// Three KITTI frames of noise.
void make_kitti(const std::string& folder, const char* left, const char* right) {
    for (const char* name : {left, right}) {
        ASSERT_TRUE(make_folder(folder + "/" + name).ok());
        for (int i = 8; i < 11; ++i) {
            ASSERT_TRUE(write_png(folder + "/" + name + "/" + std::to_string(i) + ".png",
                                  noise_image(kWidth, kHeight, 7))
                            .ok());
        }
    }
    ASSERT_TRUE(write_file(folder + "/calib.txt",
                           "P0: 30 0 15 0 0 30 9 0 0 0 1 0\nP1: 30 0 15 -6 0 30 9 0 0 0 1 0\n"
                           "P2: 30 0 15 3 0 30 9 0 0 0 1 0\nP3: 30 0 15 -6 0 30 9 0 0 0 1 0\n")
                    .ok());
}

TEST(KittiSource, ReadsAllThreeFolderNames) {
    const TemporaryFolder folder;
    make_kitti(folder / "a", "image_0", "image_1");
    make_kitti(folder / "b", "image_l", "image_r");
    make_kitti(folder / "c", "image_2", "image_3");
    for (const char* name : {"a", "b", "c"}) {
        auto source = open_source(folder / name);
        ASSERT_TRUE(source.ok()) << source.error().message;
        EXPECT_NEAR(
            (*source)->rig().T_left_right.translation_m.x(), *name == 'c' ? 0.3 : 0.2, 1e-15);
        const Played played = play(folder / name);
        ASSERT_EQ(played.frames.size(), 3U) << played.errors;
        EXPECT_EQ(played.frames[2].time_ns, 200'000'000) << "10 Hz without times.txt";
    }
    OpenOptions options;
    options.rate_hz = 4.0;
    EXPECT_EQ(play(folder / "a", options).frames.at(2).time_ns, 500'000'000);
}

TEST(KittiSource, BadInputIsNamed) {
    const TemporaryFolder folder;
    make_kitti(folder / "a", "image_0", "image_1");
    ASSERT_TRUE(write_file(folder / "a/times.txt", "0.0\n0.2\n0.2\n").ok());
    const Played repeated = play(folder / "a");
    EXPECT_EQ(repeated.frames.size(), 2U);
    EXPECT_TRUE(contains(repeated.errors, "frame 2: ") &&
                contains(repeated.errors, "times.txt:3: time stamp") &&
                contains(repeated.errors, "repeats"))
        << repeated.errors;
    ASSERT_TRUE(write_file(folder / "a/times.txt", "0.0\n0.2\n").ok());
    EXPECT_TRUE(contains(play(folder / "a").errors, "times.txt: 2 time stamps for 3 images"));
    ASSERT_TRUE(write_file(folder / "a/times.txt", "0.0\nx\n").ok());
    EXPECT_TRUE(contains(play(folder / "a").errors, "times.txt:2: stamp 'x'"));
    std::filesystem::remove(folder / "a/times.txt");
    std::filesystem::remove(folder / "a/image_1/9.png");
    EXPECT_TRUE(contains(play(folder / "a").errors,
                         "image_1/9.png: the right image of this frame is missing"));
    std::filesystem::remove(folder / "a/calib.txt");
    EXPECT_TRUE(contains(play(folder / "a").errors, "calib.txt: cannot read"));
    std::filesystem::remove_all(folder / "a/image_1");
    EXPECT_TRUE(contains(play(folder / "a").errors, "image_0 exists but image_1 is missing"));
    ASSERT_TRUE(make_folder(folder / "e/image_0").ok() && make_folder(folder / "e/image_1").ok());
    EXPECT_TRUE(contains(play(folder / "e").errors, "no images in this folder"));
}

const std::string kSideBySideRig =
    "resolution: [32, 20]\nbaseline_m: 0.1\nfocal_px: 30\nprincipal_px: [15, 9]\n";

TEST(SideBySideSource, CutsInNaturalOrderAtFifteenHertz) {
    const TemporaryFolder folder;
    for (int i = 8; i < 12; ++i) {
        ASSERT_TRUE(write_png(folder / ("frame" + std::to_string(i) + ".png"),
                              noise_image(2 * kWidth, kHeight, static_cast<std::uint64_t>(i)))
                        .ok());
    }
    EXPECT_TRUE(contains(play(folder.path()).errors, "the folder has 4 images but no rig"));
    ASSERT_TRUE(write_file(folder / "rig.yaml", kSideBySideRig).ok());
    const Played played = play(folder.path());
    ASSERT_EQ(played.frames.size(), 4U) << played.errors;
    for (int i = 0; i < 4; ++i) {
        const GreyImage both = noise_image(2 * kWidth, kHeight, static_cast<std::uint64_t>(i + 8));
        const StereoFrame& frame = played.frames[static_cast<std::size_t>(i)];
        EXPECT_EQ(frame.left.at(3, 7), both.at(3, 7)) << i;
        EXPECT_EQ(frame.right.at(3, 7), both.at(3 + kWidth, 7)) << i;
        EXPECT_EQ(frame.time_ns, (i * 1'000'000'000LL + 7) / 15) << i;
    }
    ASSERT_TRUE(write_png(folder / "frame9.png", GreyImage(kWidth, kHeight)).ok());
    EXPECT_TRUE(contains(
        play(folder.path()).errors,
        "frame9.png: the image is 32 x 20 px, but a side-by-side frame of this rig is 64 x 20"));
    OpenOptions options;
    options.rate_hz = 0.0;
    EXPECT_TRUE(contains(play(folder.path(), options).errors, "--rate 0: a frame rate must be"));
    options.rate_hz.reset();
    options.rig_file = folder / "other.yaml";
    EXPECT_TRUE(contains(play(folder.path(), options).errors, "other.yaml: cannot read"));
}

TEST(SideBySideSource, HalfTheSizeOfItsCalibration) {
    const TemporaryFolder folder;
    ASSERT_TRUE(write_png(folder / "a.png", noise_image(2 * kWidth, kHeight, 1)).ok());
    const std::string rig =
        "resolution: [64, 40]\nbaseline_m: 0.1\nfocal_px: 60\nprincipal_px: [31.5, 19.5]\n";
    ASSERT_TRUE(write_file(folder / "rig.yaml", rig).ok());
    const auto source = open_source(folder.path());
    ASSERT_TRUE(source.ok()) << source.error().message;
    const auto& lens = std::get<camera::PinholeRadTan>((*source)->rig().left.model);
    EXPECT_EQ(lens.fx_px, 30.0);
    EXPECT_EQ(lens.cx_px, 15.5);
    EXPECT_EQ(play(folder.path()).errors, "");
}

TEST(SideBySideSource, PlaysAVideo) {
    const TemporaryFolder folder;
    const std::string path = folder / "walk.avi";
    {
        cv::VideoWriter writer(path,
                               cv::VideoWriter::fourcc('M', 'J', 'P', 'G'),
                               5.0,
                               cv::Size(2 * kWidth, kHeight),
                               true);
        ASSERT_TRUE(writer.isOpened());
        for (int i = 0; i < 4; ++i) {
            cv::Mat image(kHeight, 2 * kWidth, CV_8UC3, cv::Scalar(50 * i, 50 * i, 50 * i));
            image.colRange(kWidth, 2 * kWidth).setTo(cv::Scalar(200, 200, 200));
            writer.write(image);
        }
    }
    EXPECT_TRUE(contains(play(path).errors, "this video has no rig"));
    ASSERT_TRUE(write_file(folder / "rig.yaml", kSideBySideRig).ok());
    const Played played = play(path);
    ASSERT_EQ(played.frames.size(), 4U) << played.errors;
    constexpr int kJpegError = 6;
    EXPECT_NEAR(played.frames[2].left.at(10, 10), 100, kJpegError);
    EXPECT_NEAR(played.frames[2].right.at(20, 10), 200, kJpegError);
    EXPECT_EQ(played.frames[2].time_ns, 400'000'000) << "the video's own 5 Hz";
    ASSERT_TRUE(write_file(folder / "rig.yaml",
                           "resolution: [64, 40]\nbaseline_m: 0.1\nfocal_px: 60\nprincipal_px: "
                           "[31, 19]\n")
                    .ok());
    EXPECT_EQ(play(path).frames.size(), 4U) << "a calibration of twice the size";
    ASSERT_TRUE(write_file(folder / "rig.yaml", kSideBySideRig).ok());
    ASSERT_TRUE(write_file(folder / "rig.yaml",
                           "resolution: [64, 40]\nbaseline_m: 0.1\nfocal_px: 60\nprincipal_px: "
                           "[31, 19]\n")
                    .ok());
    EXPECT_EQ(play(path).frames.size(), 4U) << "a calibration of twice the size";
    ASSERT_TRUE(write_file(folder / "rig.yaml", kSideBySideRig).ok());
    const auto info = inspect(path);
    ASSERT_TRUE(info.ok());
    EXPECT_EQ(info->frames, 4);
    ASSERT_TRUE(write_file(folder / "bad.avi", "no video").ok());
    EXPECT_TRUE(contains(play(folder / "bad.avi").errors, "bad.avi: cannot be opened as a video"));
}

TEST(TumSource, AssociatesColourAndDepthByTime) {
    const TemporaryFolder folder;
    ASSERT_TRUE(make_folder(folder / "rgb").ok() && make_folder(folder / "depth").ok());
    DepthCodes codes(640, 480, 5000);
    codes.at(3, 4) = 0;
    codes.at(5, 4) = 12500;
    for (const char* name : {"a", "b", "c"}) {
        ASSERT_TRUE(
            write_png(folder / ("rgb/" + std::string(name) + ".png"), GreyImage(640, 480)).ok());
        ASSERT_TRUE(write_png(folder / ("depth/" + std::string(name) + ".png"), codes).ok());
    }
    ASSERT_TRUE(write_file(folder / "rgb.txt",
                           "# colour\n10.000 rgb/a.png\n10.033 rgb/b.png\n10.100 rgb/c.png\n")
                    .ok());
    // b is closer to the second depth image than a; c has none within 20 ms.
    ASSERT_TRUE(write_file(folder / "depth.txt",
                           "10.005 depth/a.png\n10.020 depth/b.png\n10.130 depth/c.png\n")
                    .ok());
    const Played played = play(folder.path());
    ASSERT_EQ(played.frames.size(), 2U) << played.errors;
    EXPECT_EQ(played.frames[1].time_ns, 10'033'000'000);
    EXPECT_TRUE(played.frames[0].right.empty());
    EXPECT_EQ(played.frames[0].depth_m.at(0, 0), 1.0F);
    EXPECT_EQ(played.frames[0].depth_m.at(5, 4), 2.5F);
    EXPECT_TRUE(std::isnan(played.frames[0].depth_m.at(3, 4)));
    const auto source = open_source(folder.path());
    EXPECT_EQ(std::get<camera::PinholeRadTan>((*source)->rig().left.model).cx_px, 319.5);
    EXPECT_EQ(inspect(folder.path())->unpaired, 1);
    ASSERT_TRUE(write_png(folder / "depth/a.png", GreyImage(640, 480)).ok());
    EXPECT_TRUE(contains(play(folder.path()).errors, "must be 16-bit grey"));
    ASSERT_TRUE(write_file(folder / "depth.txt", "11 depth/a.png\n").ok());
    EXPECT_TRUE(contains(play(folder.path()).errors, "are within 20 ms of each other"));
    ASSERT_TRUE(write_file(folder / "depth.txt", "11 a b\n").ok());
    EXPECT_TRUE(contains(play(folder.path()).errors, "depth.txt:1: expected 'stamp_s file'"));
}

TEST(OpenSource, SaysWhatItLookedFor) {
    const TemporaryFolder folder;
    EXPECT_TRUE(
        contains(play(folder.path()).errors, "no recording here; looked for mav0/cam0 (EuRoC)"));
    EXPECT_TRUE(contains(play(folder / "none").errors, "none: no such file or folder"));
    ASSERT_TRUE(write_file(folder / "a.txt", "x").ok());
    EXPECT_TRUE(contains(play(folder / "a.txt").errors, "a single file must be a video"));
}

TEST(OpenSource, PlaysTheRealRecordings) {
    const struct {
        const char* name;
        const char* kind;
        std::size_t frames;
        double baseline_m;
    } recordings[] = {{"sequences/kitti_city", "kitti", 51, 0.537},
                      {"sequences/zed_office", "side_by_side", 8, 0.12},
                      {"sequences/euroc_still", "euroc", 30, 0.110}};
    for (const auto& expected : recordings) {
        const std::string path = data_path(expected.name);
        if (path.empty()) continue;
        auto source = open_source(path);
        ASSERT_TRUE(source.ok()) << source.error().message;
        EXPECT_EQ((*source)->info().kind, expected.kind);
        EXPECT_NEAR((*source)->rig().T_left_right.translation_m.norm(), expected.baseline_m, 1e-3);
        const Played played = play(path);
        EXPECT_EQ(played.errors, "");
        ASSERT_EQ(played.frames.size(), expected.frames) << path;
        EXPECT_EQ(played.frames[0].left.width(), (*source)->rig().left.width);
        const auto info = inspect(path);
        ASSERT_TRUE(info.ok()) << info.error().message;
        EXPECT_EQ(info->frames, static_cast<int>(expected.frames));
        EXPECT_EQ(info->missing_images, 0);
    }
}

TEST(OpenSource, RealImuSamplesFillTheTimeBetweenFrames) {
    const std::string path = data_path("sequences/euroc_still");
    if (path.empty()) return;
    const Played played = play(path);
    double mean_m_s2 = 0.0;
    for (std::size_t i = 1; i < played.frames.size(); ++i) {
        const auto& imu = played.frames[i].imu;
        ASSERT_EQ(imu.size(), 10U) << "200 Hz between frames of 20 Hz, frame " << i;
        EXPECT_GT(imu.front().time_ns, played.frames[i - 1].time_ns);
        EXPECT_LE(imu.back().time_ns, played.frames[i].time_ns);
        for (const ImuSample& sample : imu) mean_m_s2 += sample.specific_force_m_s2.norm() / 290.0;
    }
    // The machine stands still with spinning rotors: single samples shake by 1 m/s^2.
    EXPECT_NEAR(mean_m_s2, 9.81, 0.2);
}

TEST(RecordingLists, SurviveDamage) {
    const std::string frames =
        "#timestamp [ns],filename\n1403715273262142976,a.png\n1403715273312143104,b.png\n";
    testing::for_each_mutation(frames, 3000, 1, [](const std::string& text) {
        (void)parse_euroc_frames(text, "damaged").ok();
    });
    testing::for_each_mutation(
        "1,0.1,0.2,0.3,9.8,0,0\n2,0.1,0.2,0.3,9.8,0,0\n", 3000, 2, [](const std::string& text) {
            const auto samples = parse_euroc_imu_samples(text, "damaged");
            if (!samples.ok()) return;
            for (const ImuSample& sample : *samples) {
                EXPECT_TRUE(sample.angular_velocity_rad_s.allFinite());
            }
        });
    testing::for_each_mutation(
        "1.5 rgb/a.png\n1.6 rgb/b.png\n", 3000, 3, [](const std::string& text) {
            (void)parse_tum_list(text, "damaged").ok();
        });
}

}  // namespace
}  // namespace surefoot::io
