// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/recordings/video_frames.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "surefoot/io/bytes.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"
#include "surefoot/io/recordings/recorder.hpp"
#include "surefoot/io/recordings/recording.hpp"

namespace surefoot::io {
namespace {

using testing::contains;
using testing::TemporaryFolder;

constexpr int kWidth = 64;
constexpr int kHeight = 48;
constexpr double kRate_hz = 10.0;
constexpr std::int64_t kPeriod_ns = 100'000'000;
const std::string kRig =
    "resolution: [32, 48]\nrate_hz: 10\nbaseline_m: 0.1\nfocal_px: 30\nprincipal_px: [15, 23]\n";

/// Side-by-side frames of one grey each; false without the codec.
bool write_video(const std::string& path, const char* codec, int frames, double rate_hz = 10.0) {
    cv::VideoWriter writer(path,
                           cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]),
                           rate_hz,
                           cv::Size(kWidth, kHeight),
                           true);
    if (!writer.isOpened()) {
        std::printf("no writer of %s here: 1 check skipped\n", codec);
        return false;
    }
    for (int i = 0; i < frames; ++i) {
        cv::Mat image(kHeight, kWidth, CV_8UC3);
        for (int v = 0; v < kHeight; ++v)
            for (int u = 0; u < kWidth; ++u)
                image.at<cv::Vec3b>(v, u) = cv::Vec3b::all(
                    static_cast<std::uint8_t>((7 * u + 13 * v + 11 * i + u * v % 17) % 256));
        writer.write(image);
    }
    return true;
}

struct Played {
    std::vector<std::int64_t> times_ns;
    std::string errors;
    camera::SourceInfo info;
};

Played play(const std::string& path, const OpenOptions& options = {}) {
    Played played;
    const auto source = open_source(path, options);
    if (!source.ok()) {
        played.errors = source.error().message;
        return played;
    }
    while (true) {
        const auto next = (*source)->next();
        played.info = (*source)->info();
        if (!next.ok()) {
            played.errors += next.error().message + "\n";
            continue;
        }
        if (!next->has_value()) return played;
        played.times_ns.push_back((*next)->time_ns);
    }
}

/// An MP4 whose frames lie at a constant rate gets a gap in front of frame `late`: one entry of
/// its table of durations (stts, ISO 14496-12) becomes three, and all boxes around it grow.
void delay_frame(const std::string& path, std::uint32_t late, std::uint32_t times) {
    std::string bytes = *read_file(path);
    const auto at = [&](std::size_t i) {
        return load<std::uint32_t>(bytes.data() + i, std::endian::big);
    };
    const auto put = [&](std::size_t i, std::uint32_t value) {
        std::string four;
        store(four, value, std::endian::big);
        bytes.replace(i, 4, four);
    };
    const std::size_t stts = bytes.find("stts");
    ASSERT_NE(stts, bytes.npos);
    ASSERT_EQ(at(stts + 8), 1U) << "one entry";
    const std::uint32_t frames = at(stts + 12);
    const std::uint32_t ticks = at(stts + 16);
    std::string entries;
    for (const std::uint32_t value : {3U, late - 1, ticks, 1U, ticks * times, frames - late, ticks})
        store(entries, value, std::endian::big);
    bytes.replace(stts + 8, 12, entries);
    for (const char* box : {"moov", "trak", "mdia", "minf", "stbl", "stts"}) {
        const std::size_t name = bytes.find(box);
        put(name - 4, at(name - 4) + 16);
    }
    // Edit lists and durations of the old length would cut the last frames off.
    if (const std::size_t edit = bytes.find("edts"); edit != bytes.npos)
        bytes.replace(edit, 4, "free");
    const std::size_t media = bytes.find("mdhd");
    put(media + 20, at(media + 20) + ticks * (times - 1));
    ASSERT_TRUE(write_file(path, bytes).ok());
}

/// The case video-truncated: an AVI whose second half is missing.
TEST(VideoFrames, AVideoThatBreaksOffIsNotAtItsEnd) {
    const TemporaryFolder folder;
    const std::string path = folder / "half.avi";
    if (!write_video(path, "MJPG", 20)) return;
    ASSERT_TRUE(write_file(folder / "rig.yaml", kRig).ok());
    EXPECT_EQ(play(path).times_ns.size(), 20U);
    EXPECT_EQ(play(path).errors, "");
    const std::string whole = *read_file(path);
    ASSERT_TRUE(write_file(path, whole.substr(0, whole.size() / 2)).ok());
    const Played half = play(path);
    ASSERT_GT(half.times_ns.size(), 5U);
    ASSERT_LT(half.times_ns.size(), 12U);
    EXPECT_TRUE(contains(half.errors, "breaks off here") &&
                contains(half.errors, "of the 20 frames that its container announces"))
        << half.errors;
    EXPECT_EQ(half.info.frames, 20);
    const auto info = inspect(path);
    ASSERT_TRUE(info.ok());
    EXPECT_EQ(info->frames, static_cast<int>(half.times_ns.size()));
    EXPECT_EQ(info->announced_frames, 20);
    EXPECT_TRUE(contains(info->incomplete, "breaks off here"));
    OpenOptions options;
    options.skip_broken = true;
    EXPECT_EQ(play(path, options).errors, "");
    EXPECT_EQ(play(path, options).info.broken.count, 1);
}

/// The decoder fills up the missing part of the last frame of a cut file: this frame must not be
/// used.
TEST(VideoFrames, TheLastFrameOfACutVideoIsNotGiven) {
    const TemporaryFolder folder;
    const std::string path = folder / "cut.avi";
    if (!write_video(path, "MJPG", 6)) return;
    ASSERT_TRUE(write_file(folder / "rig.yaml", kRig).ok());
    const std::string whole = *read_file(path);
    const std::size_t second_last = whole.rfind("00dc", whole.rfind("idx1") - 8);
    ASSERT_TRUE(write_file(path, whole.substr(0, second_last - 200)).ok());
    const Played cut = play(path);
    EXPECT_LE(cut.times_ns.size(), 4U);
    EXPECT_TRUE(contains(cut.errors, "breaks off here")) << cut.errors;
}

/// The case video-vfr: the container's times count.
TEST(VideoFrames, AVariableRateKeepsTheTimesOfTheContainer) {
    const TemporaryFolder folder;
    const std::string path = folder / "gap.mp4";
    if (!write_video(path, "mp4v", 15)) return;
    ASSERT_TRUE(write_file(folder / "rig.yaml", kRig).ok());
    delay_frame(path, 5, 6);
    const Played played = play(path);
    EXPECT_EQ(played.errors, "");
    ASSERT_EQ(played.times_ns.size(), 15U);
    for (std::int64_t i = 0; i < 15; ++i) {
        EXPECT_NEAR(static_cast<double>(played.times_ns[static_cast<std::size_t>(i)]),
                    static_cast<double>((i < 5 ? i : i + 5) * kPeriod_ns),
                    1e3)
            << i;
    }
    const auto info = inspect(path);
    ASSERT_TRUE(info.ok());
    EXPECT_EQ(info->gaps, 1);
    EXPECT_NEAR(info->longest_gap_s, 0.6, 1e-6);
    EXPECT_NEAR(info->rate_hz, kRate_hz, 1e-3) << "the median, not the mean";
    EXPECT_NEAR(info->duration_s, 1.9, 1e-6);
}

/// The rate comes from --rate, otherwise from the container, otherwise from the rig.
TEST(VideoFrames, TheContainerBeatsTheRigAndTheOptionBeatsBoth) {
    const TemporaryFolder folder;
    const std::string path = folder / "fast.avi";
    if (!write_video(path, "MJPG", 4, 30.0)) return;
    ASSERT_TRUE(write_file(folder / "rig.yaml", kRig).ok());
    const Played own = play(path);
    ASSERT_EQ(own.times_ns.size(), 4U) << own.errors;
    EXPECT_NEAR(static_cast<double>(own.times_ns[3]), 1e8, 1e3);
    ASSERT_EQ(own.info.notes.size(), 1U);
    EXPECT_TRUE(contains(own.info.notes[0], "the rig says 10 Hz, but the video has 30 frames"))
        << own.info.notes[0];
    OpenOptions options;
    options.rate_hz = 5.0;
    EXPECT_EQ(play(path, options).times_ns.at(3), 600'000'000);
    EXPECT_TRUE(play(path, options).info.notes.empty());
}

TEST(VideoFrames, OnlyRegularFilesAreOpened) {
    const TemporaryFolder folder;
    std::filesystem::create_symlink("/dev/zero", folder / "zero.avi");
    EXPECT_TRUE(contains(VideoFrames::open(folder / "zero.avi").error().message, "a device"));
    EXPECT_TRUE(contains(VideoFrames::open(folder.path()).error().message, "a directory"));
}

}  // namespace
}  // namespace surefoot::io
