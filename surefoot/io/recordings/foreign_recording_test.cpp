// SPDX-License-Identifier: Apache-2.0
// Recordings in the layouts of other projects.
#include <gtest/gtest.h>

#include "surefoot/io/calibration/rig_file.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/io/io_testing.hpp"
#include "surefoot/io/recordings/recorder.hpp"
#include "surefoot/io/recordings/recording.hpp"

namespace surefoot::io {
namespace {

using testing::contains;
using testing::TemporaryFolder;

constexpr int kWidth = 32;
constexpr int kHeight = 20;
constexpr std::int64_t kStart_ns = 1520531124150444163;
constexpr std::int64_t kPeriod_ns = 50'000'000;
const std::string kRig =
    "resolution: [32, 20]\nrate_hz: 20\nbaseline_m: 0.1\nfocal_px: 30\nprincipal_px: [15, 9]\n";

GreyImage image(std::uint64_t seed) {
    Rng rng(seed);
    GreyImage out(kWidth, kHeight);
    for (std::size_t i = 0; i < out.size(); ++i)
        out.data()[i] = static_cast<std::uint8_t>(rng.below(256));
    return out;
}

/// Returns the image in 16 bits, shifted left by this many bits.
DepthCodes deep(const GreyImage& grey, int shift) {
    DepthCodes out(grey.width(), grey.height());
    for (std::size_t i = 0; i < out.size(); ++i)
        out.data()[i] = static_cast<std::uint16_t>(grey.data()[i] << shift);
    return out;
}

std::string stamp(int index, std::int64_t late_ns = 0) {
    return std::to_string(kStart_ns + index * kPeriod_ns + late_ns);
}

struct Played {
    std::vector<StereoFrame> frames;
    std::string errors;
    camera::SourceInfo info;

    [[nodiscard]] std::string notes() const {
        std::string all;
        for (const std::string& note : info.notes) all += note + "\n";
        return all;
    }
};

Played play(const std::string& path, const OpenOptions& options = {}) {
    Played played;
    const auto source = open_source(path, options);
    if (!source.ok()) {
        played.errors = source.error().message;
        return played;
    }
    while (true) {
        auto next = (*source)->next();
        played.info = (*source)->info();
        if (!next.ok()) {
            played.errors += next.error().message + "\n";
            continue;
        }
        if (!next->has_value()) return played;
        played.frames.push_back(std::move(**next));
    }
}

void write_lines(const std::string& path, const std::string& text) {
    ASSERT_TRUE(make_folder(folder_of(path)).ok());
    ASSERT_TRUE(write_file(path, text).ok());
}

void write_image(const std::string& path, const auto& pixels) {
    ASSERT_TRUE(make_folder(folder_of(path)).ok());
    ASSERT_TRUE(write_png(path, pixels).ok());
}

/// An EuRoC recording whose right stamps come `late_ns` later; calibration is in rig.yaml.
OpenOptions make_euroc(const std::string& folder, int frames, std::int64_t late_ns, int shift = 0) {
    std::string left;
    std::string right;
    for (int i = 0; i < frames; ++i) {
        const std::string left_name = stamp(i) + ".png";
        const std::string right_name = stamp(i, late_ns) + ".png";
        left += stamp(i) + "," + left_name + "\n";
        right += stamp(i, late_ns) + "," + right_name + "\n";
        const GreyImage pixels = image(static_cast<std::uint64_t>(i));
        for (const auto& name : {"cam0/data/" + left_name, "cam1/data/" + right_name}) {
            if (shift > 0) {
                write_image(folder + "/mav0/" + name, deep(pixels, shift));
            } else {
                write_image(folder + "/mav0/" + name, pixels);
            }
        }
    }
    write_lines(folder + "/mav0/cam0/data.csv", left);
    write_lines(folder + "/mav0/cam1/data.csv", right);
    write_lines(folder + "/rig.yaml", kRig);
    OpenOptions options;
    options.rig_file = folder + "/rig.yaml";
    return options;
}

TEST(PairTolerance, StampsThatDifferByMicrosecondsArePairedAndItIsSaid) {
    const TemporaryFolder folder;
    OpenOptions options = make_euroc(folder / "r", 4, 37'000);
    const Played played = play(folder / "r", options);
    EXPECT_EQ(played.errors, "");
    ASSERT_EQ(played.frames.size(), 4U);
    EXPECT_EQ(played.frames[1].time_ns, kStart_ns + kPeriod_ns) << "the stamp of the left image";
    EXPECT_TRUE(contains(played.notes(), "differ by up to 0.037 ms")) << played.notes();
    EXPECT_TRUE(contains(played.notes(), "within 10 ms (--pair-tolerance)")) << played.notes();
    const auto info = inspect(folder / "r", options);
    ASSERT_TRUE(info.ok());
    EXPECT_DOUBLE_EQ(info->pair_tolerance_s, 0.01) << "a fifth of 50 ms";
    EXPECT_DOUBLE_EQ(info->largest_pair_difference_s, 37e-6);
    options.pair_tolerance_s = 1e-6;
    EXPECT_TRUE(contains(play(folder / "r", options).errors, "no time stamps within 0.001 ms"));
    EXPECT_EQ(play(folder / "same", make_euroc(folder / "same", 3, 0)).notes(), "");
}

TEST(PairTolerance, AnImageWithoutPartnerIsLeftOutAndCounted) {
    const TemporaryFolder folder;
    const OpenOptions options = make_euroc(folder / "r", 4, 12'000'000);
    EXPECT_TRUE(contains(play(folder / "r", options).errors, "no time stamps within 10 ms"));
    const OpenOptions near = make_euroc(folder / "n", 4, 1'000);
    std::string right = *read_file(folder / "n/mav0/cam1/data.csv");
    write_lines(folder / "n/mav0/cam1/data.csv", right.substr(right.find('\n') + 1));
    const Played played = play(folder / "n", near);
    EXPECT_EQ(played.frames.size(), 3U);
    EXPECT_TRUE(contains(played.notes(), "1 of 4 images have no partner")) << played.notes();
}

TEST(Pairing, TheClosestComeFirstAndEachIsUsedOnce) {
    const Partners partners = pair_by_time({0, 100, 200}, {95, 104, 205}, 20);
    EXPECT_FALSE(partners[0].has_value());
    EXPECT_EQ(partners[1], 1U);
    EXPECT_EQ(partners[2], 2U);
    EXPECT_EQ(fifth_of_frame_time_ns({0, 50, 100, 900}), 10);
    EXPECT_EQ(fifth_of_frame_time_ns({7}), 0);
}

/// TUM-VI stores 16 bits; other cameras 10 or 12 of 16.
TEST(SixteenBits, TheUpperEightOfTheBitsInUse) {
    const TemporaryFolder folder;
    for (const int shift : {8, 6, 4, 2}) {
        const std::string path = folder / std::to_string(shift);
        OpenOptions options = make_euroc(path, 3, 0, shift);
        const Played played = play(path, options);
        ASSERT_EQ(played.frames.size(), 3U) << played.errors;
        EXPECT_EQ(played.frames[2].right, image(2)) << shift;
        EXPECT_TRUE(contains(played.notes(),
                             "the upper 8 of " + std::to_string(8 + shift) + " bits are used"))
            << played.notes();
        options.image_bits = 16;
        EXPECT_EQ(play(path, options).frames.at(0).left.at(1, 1), image(0).at(1, 1) >> (8 - shift));
    }
}

TEST(SixteenBits, AValueBeyondTheGuessIsAnErrorNotASaturatedPixel) {
    const TemporaryFolder folder;
    OpenOptions options = make_euroc(folder / "r", 5, 0, 4);
    write_image(folder / ("r/mav0/cam1/data/" + stamp(1) + ".png"), deep(image(1), 8));
    const Played played = play(folder / "r", options);
    EXPECT_EQ(played.frames.size(), 4U);
    EXPECT_TRUE(contains(played.errors, "needs more than 12 bits; give the number of bits"))
        << played.errors;
    options.image_bits = 16;
    EXPECT_EQ(play(folder / "r", options).errors, "");
}

TEST(PairFolders, LeftAndRightByTheirNames) {
    const TemporaryFolder folder;
    for (const int i : {8, 9, 10}) {
        const std::string number = std::to_string(i);
        const auto seed = static_cast<std::uint64_t>(i);
        for (const char* this_camera : {"left", "right"}) {
            const std::uint64_t own = seed + (*this_camera == 'r' ? 100 : 0);
            write_image(folder / ("same/" + std::string(this_camera) + "/" + number + ".png"),
                        image(own));
            write_image(folder / ("named/" + std::string(this_camera) + "/" + this_camera + number +
                                  ".png"),
                        image(own));
            write_image(folder / ("one/" + std::string(this_camera) + number + ".png"), image(own));
            write_image(folder / ("other/" + std::string(this_camera) + "/" + this_camera[0] +
                                  number + ".png"),
                        image(own));
        }
    }
    for (const char* name : {"same", "named", "one", "other"}) {
        EXPECT_TRUE(contains(play(folder / name).errors, "no calibration. Put a rig.yaml"));
        write_lines(folder / (std::string(name) + "/rig.yaml"), kRig);
        const Played played = play(folder / name);
        ASSERT_EQ(played.frames.size(), 3U) << name << ": " << played.errors;
        EXPECT_EQ(played.info.kind, "folders");
        EXPECT_EQ(played.frames[2].left, image(10)) << name;
        EXPECT_EQ(played.frames[2].right, image(110)) << name;
        EXPECT_EQ(played.frames[2].time_ns, 2 * kPeriod_ns) << "the rig's 20 Hz";
        EXPECT_TRUE(contains(played.notes(), "no time stamps: 20 frames per second are assumed"));
        EXPECT_EQ(contains(played.notes(), "paired in the order of their names"),
                  std::string("other") == name);
    }
    std::filesystem::remove(folder / "other/right/r8.png");
    EXPECT_TRUE(contains(play(folder / "other").errors, "Neither names nor time stamps show"));
    std::filesystem::remove(folder / "same/right/9.png");
    EXPECT_TRUE(
        contains(play(folder / "same").errors, "9.png: the right image of this frame is missing"));
}

/// cam0/data and cam1/data without data.csv: the names hold the stamps.
TEST(PairFolders, StampsAndPartnersFromTheNames) {
    const TemporaryFolder folder;
    for (int i = 0; i < 3; ++i) {
        const auto seed = static_cast<std::uint64_t>(i);
        write_image(folder / ("r/cam0/data/" + stamp(i) + ".png"), image(seed));
        write_image(folder / ("r/cam1/data/" + stamp(i, 5'000) + ".png"), image(seed + 100));
    }
    write_lines(folder / "r/rig.yaml", kRig);
    const Played played = play(folder / "r");
    ASSERT_EQ(played.frames.size(), 3U) << played.errors;
    EXPECT_EQ(played.frames[2].time_ns, kStart_ns + 2 * kPeriod_ns);
    EXPECT_EQ(played.frames[2].right, image(102));
    EXPECT_TRUE(contains(played.notes(), "time stamps are read from the file names, in ns"));
    EXPECT_TRUE(contains(played.notes(), "differ by up to 0.005 ms"));
    EXPECT_EQ(stamps_of_names({"1311868164.363181.png"})->times_ns[0], 1311868164363181000);
    EXPECT_EQ(stamps_of_names({"1311868164363181.png"})->times_ns[0], 1311868164363181000);
    EXPECT_FALSE(stamps_of_names({"0000000012.png"}).has_value()) << "a number, not a time";
    EXPECT_FALSE(stamps_of_names({"1311868164363181.png", "1311868164363.png"}).has_value());
    for (const char* beyond_2261 : {"9762223982223.png", "9762223982223000.png"})
        EXPECT_FALSE(stamps_of_names({beyond_2261}).has_value()) << "no 64 bits hold it in ns";
    EXPECT_FALSE(stamps_of_names({"9223372036854775807.png"}).has_value());
    EXPECT_EQ(stamps_of_names({"9199999999999.png"})->times_ns[0], 9'199'999'999'999'000'000);
}

/// One drive of KITTI raw: the calibration of the day lies beside the drives.
TEST(PairFolders, KittiRaw) {
    const TemporaryFolder folder;
    const std::string drive = folder / "day/drive_0001_sync";
    for (const char* camera : {"image_00", "image_01", "image_02", "image_03"}) {
        for (const char* name : {"0000000000.png", "0000000001.png"})
            write_image(drive + "/" + camera + "/data/" + name, image(1));
        write_lines(drive + "/" + camera + "/timestamps.txt",
                    "2011-09-26 13:02:25.964389445\n2011-09-26 13:02:26.074343000\n");
    }
    write_lines(folder / "day/calib_cam_to_cam.txt",
                "calib_time: 09-Jan-2012 13:57:47\nS_rect_00: 32 20\n"
                "P_rect_00: 30 0 15 0 0 30 9 0 0 0 1 0\nS_rect_01: 32 20\n"
                "P_rect_01: 30 0 15 -6 0 30 9 0 0 0 1 0\nS_rect_02: 32 20\n"
                "P_rect_02: 30 0 15 3 0 30 9 0 0 0 1 0\nS_rect_03: 32 20\n"
                "P_rect_03: 30 0 15 -6 0 30 9 0 0 0 1 0\n");
    const auto source = open_source(drive);
    ASSERT_TRUE(source.ok()) << source.error().message;
    EXPECT_EQ((*source)->info().kind, "kitti_raw");
    EXPECT_NEAR((*source)->rig().T_left_right.translation_m.x(), 0.2, 1e-12) << "the grey pair";
    const Played played = play(drive);
    ASSERT_EQ(played.frames.size(), 2U) << played.errors;
    EXPECT_EQ(played.frames[0].time_ns, 1317042145964389445) << "date -u -d '2011-09-26 13:02:25'";
    EXPECT_EQ(played.frames[1].time_ns, 1317042146074343000);
    std::filesystem::remove_all(drive + "/image_00");
    EXPECT_NEAR((*open_source(drive))->rig().T_left_right.translation_m.x(), 0.3, 1e-12)
        << "the colour pair has a baseline of its own";
    EXPECT_FALSE(parse_timestamps("2011-09-26 25:02:25.9\n", "t").ok());
    EXPECT_FALSE(parse_timestamps("1317042145.96\n", "t").ok());
    EXPECT_TRUE(parse_timestamps("2012-02-29 13:02:25.9\n", "t").ok());
    for (const char* no_day : {"2011-02-29 13:02:25.9\n", "2011-09-31 13:02:25.9\n"})
        EXPECT_FALSE(parse_timestamps(no_day, "t").ok()) << no_day;
}

/// A TUM RGB-D recording of two frames; depths are codes.
void make_rgbd(const std::string& folder, std::uint16_t near, std::uint16_t far) {
    DepthCodes codes(kWidth, kHeight, far);
    for (int u = 0; u < kWidth; ++u) codes.at(u, 0) = near;
    for (const char* name : {"a", "b"}) {
        write_image(folder + "/rgb/" + name + ".png", image(1));
        write_image(folder + "/depth/" + name + ".png", codes);
    }
    write_lines(folder + "/rig.yaml",
                "layout: rgbd\nresolution: [32, 20]\nfocal_px: 30\nprincipal_px: [15, 9]\n");
}

TEST(RgbdOfOthers, AssociationsNameThePairs) {
    const TemporaryFolder folder;
    make_rgbd(folder.path(), 5000, 10000);
    for (const char* rows :
         {"10.0 rgb/b.png 10.9 depth/a.png\n11.0 rgb/a.png 11.9 depth/b.png\n",
          "10.9 depth/a.png 10.0 rgb/b.png\n11.9 depth/b.png 11.0 rgb/a.png\n"}) {
        write_lines(folder / "associations.txt", rows);
        const Played played = play(folder.path());
        ASSERT_EQ(played.frames.size(), 2U) << played.errors;
        EXPECT_EQ(played.frames[0].time_ns, 10'000'000'000) << "the colour stamp";
        EXPECT_EQ(played.frames[0].depth_m.at(3, 3), 2.0F);
        EXPECT_EQ(played.notes(), "");
    }
    write_lines(folder / "associations.txt", "10.0 rgb/b.png 10.9\n");
    EXPECT_TRUE(contains(play(folder.path()).errors,
                         "associations.txt:1: expected 'stamp_s file stamp_s file'"));
}

TEST(RgbdOfOthers, MillimetresAreGuessedWithASentence) {
    const TemporaryFolder folder;
    make_rgbd(folder.path(), 600, 2000);
    write_lines(folder / "rgb.txt", "10.0 rgb/a.png\n");
    write_lines(folder / "depth.txt", "10.0 depth/a.png\n");
    const Played guessed = play(folder.path());
    ASSERT_EQ(guessed.frames.size(), 1U) << guessed.errors;
    EXPECT_EQ(guessed.frames[0].depth_m.at(3, 3), 2.0F);
    EXPECT_TRUE(contains(guessed.notes(), "depth is read as millimetres")) << guessed.notes();
    OpenOptions options;
    options.depth_codes_per_m = 5000.0;
    EXPECT_EQ(play(folder.path(), options).frames.at(0).depth_m.at(3, 3), 0.4F);
    EXPECT_EQ(play(folder.path(), options).notes(), "");
    options.depth_codes_per_m = 0.0;
    EXPECT_TRUE(contains(play(folder.path(), options).errors, "--depth-factor 0"));
}

TEST(SkipBroken, GoesOnAndCounts) {
    const TemporaryFolder folder;
    OpenOptions options = make_euroc(folder / "r", 5, 0);
    std::filesystem::remove(folder / ("r/mav0/cam1/data/" + stamp(1) + ".png"));
    write_lines(folder / ("r/mav0/cam0/data/" + stamp(2) + ".png"), "no image");
    std::filesystem::remove(folder / ("r/mav0/cam0/data/" + stamp(4) + ".png"));
    EXPECT_FALSE(play(folder / "r", options).errors.empty());
    options.skip_broken = true;
    const Played played = play(folder / "r", options);
    EXPECT_EQ(played.errors, "");
    ASSERT_EQ(played.frames.size(), 2U);
    EXPECT_EQ(played.frames[1].index, 3);
    EXPECT_EQ(played.frames[1].frame_status.damaged, 2);
    EXPECT_EQ(played.info.broken.count, 3);
    EXPECT_TRUE(contains(played.info.broken.first, "frame 1: ")) << played.info.broken.first;
}

TEST(RecordingLists, OfOthersSurviveDamage) {
    testing::for_each_mutation("10.0 rgb/b.png 10.9 depth/a.png\n", 3000, 4, [](const auto& text) {
        (void)parse_associations(text, "damaged").ok();
    });
    testing::for_each_mutation("2011-09-26 13:02:25.964389445\n", 3000, 5, [](const auto& text) {
        (void)parse_timestamps(text, "damaged").ok();
    });
}

}  // namespace
}  // namespace surefoot::io
