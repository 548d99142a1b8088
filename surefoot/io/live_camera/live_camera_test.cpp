// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/live_camera/live_camera.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "surefoot/camera/frame_integrity_check.hpp"
#include "surefoot/camera/rigs_testing.hpp"
#include "surefoot/io/io_testing.hpp"
#include "surefoot/io/live_camera/fake_video_device.hpp"

namespace surefoot::io {
namespace {

using testing::contains;
using testing::FakeCamera;
using testing::FakeEvent;
using testing::FakeVideoDevice;

constexpr int kWidth = 32;  // width of one camera's image
constexpr int kHeight = 24;
constexpr std::int64_t kStart_us = 5'000'000;
constexpr std::int64_t kPeriod_us = 33'333;

camera::StereoRig small_rig() {
    return camera::test::ideal_rig(kWidth, kHeight, 30.0);
}

FakeCamera small_camera() {
    FakeCamera camera;
    camera.width = 2 * kWidth;
    camera.height = kHeight;
    camera.bytes_per_line = 4 * kWidth;
    camera.controls[V4L2_CID_GAIN] = {0, 100, 20, 0};
    camera.controls[V4L2_CID_EXPOSURE_AUTO] = {0, 3, V4L2_EXPOSURE_APERTURE_PRIORITY, 0};
    camera.controls[V4L2_CID_EXPOSURE_ABSOLUTE] = {1, 300, 50, 0};
    return camera;
}

/// Brightness of one pixel of frame `index`, both cameras side by side.
std::uint8_t pixel(int index, int u, int v) {
    Rng rng(static_cast<std::uint64_t>((index * kHeight + v) * 2 * kWidth + u));
    return static_cast<std::uint8_t>(rng.below(256));
}

std::string yuyv(int index, int bytes_per_line = 4 * kWidth) {
    std::string bytes(static_cast<std::size_t>(bytes_per_line * kHeight), '\x80');
    for (int v = 0; v < kHeight; ++v) {
        for (int u = 0; u < 2 * kWidth; ++u) {
            bytes[static_cast<std::size_t>(v * bytes_per_line + 2 * u)] =
                static_cast<char>(pixel(index, u, v));
        }
    }
    return bytes;
}

FakeEvent frame_event(int index) {
    FakeEvent event;
    event.bytes = yuyv(index);
    event.sequence = static_cast<std::uint32_t>(index);
    event.time_us = kStart_us + index * kPeriod_us;
    return event;
}
FakeEvent silence() {
    FakeEvent event;
    event.kind = FakeEvent::Kind::silence;
    return event;
}
/// Frames between silences: a consumer that keeps up.
void play(FakeCamera& camera, const FakeEvent& event) {
    camera.script.push_back(event);
    camera.script.push_back(silence());
}

std::unique_ptr<LiveCamera> opened(FakeCamera& camera, const CameraConfig& config = {}) {
    auto live = LiveCamera::open(
        std::make_unique<FakeVideoDevice>(camera), {"/dev/fake", {}, {}, {}}, small_rig(), config);
    EXPECT_TRUE(live.ok()) << (live.ok() ? "" : live.error().message);
    return live.ok() ? std::move(live).value() : nullptr;
}

std::string open_error(FakeCamera& camera,
                       const CameraConfig& config = {},
                       const LiveAddress& address = {"/dev/fake", {}, {}, {}}) {
    auto live =
        LiveCamera::open(std::make_unique<FakeVideoDevice>(camera), address, small_rig(), config);
    return live.ok() ? "" : live.error().message;
}

StereoFrame next_of(LiveCamera& live) {
    auto frame = live.next();
    EXPECT_TRUE(frame.ok()) << (frame.ok() ? "" : frame.error().message);
    if (!frame.ok() || !frame->has_value()) return {};
    return std::move(**frame);
}

TEST(LiveCamera, SplitsBothEyesWithStampsInOrder) {
    FakeCamera camera = small_camera();
    for (int i = 0; i < 6; ++i) play(camera, frame_event(i));
    const auto live = opened(camera);
    ASSERT_NE(live, nullptr);
    EXPECT_DOUBLE_EQ(live->rig().rate_hz, 30.0);
    for (int i = 0; i < 6; ++i) {
        const StereoFrame frame = next_of(*live);
        ASSERT_EQ(frame.left.width(), kWidth);
        for (int v = 0; v < kHeight; ++v) {
            for (int u = 0; u < kWidth; ++u) {
                ASSERT_EQ(frame.left.at(u, v), pixel(i, u, v));
                ASSERT_EQ(frame.right.at(u, v), pixel(i, kWidth + u, v));
            }
        }
        EXPECT_EQ(frame.index, i);
        EXPECT_EQ(frame.time_ns, 1000 * (kStart_us + i * kPeriod_us));
        EXPECT_EQ(
            frame.frame_status.dropped + frame.frame_status.skipped + frame.frame_status.damaged,
            0);
    }
}

TEST(LiveCamera, LinesMayBeLongerThanTheirPixels) {
    FakeCamera camera = small_camera();
    camera.bytes_per_line = 4 * kWidth + 16;
    FakeEvent event = frame_event(0);
    event.bytes = yuyv(0, 4 * kWidth + 16);
    play(camera, event);
    const auto live = opened(camera);
    ASSERT_NE(live, nullptr);
    const StereoFrame frame = next_of(*live);
    ASSERT_FALSE(frame.right.empty());
    EXPECT_EQ(frame.right.at(kWidth - 1, kHeight - 1), pixel(0, 2 * kWidth - 1, kHeight - 1));
}

TEST(LiveCamera, StampsAreMovedToTheMiddleOfTheExposure) {
    for (const bool start : {true, false}) {
        FakeCamera camera = small_camera();
        FakeEvent event = frame_event(0);
        event.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC |
                      (start ? V4L2_BUF_FLAG_TSTAMP_SRC_SOE : V4L2_BUF_FLAG_TSTAMP_SRC_EOF);
        play(camera, event);
        CameraConfig config;
        config.exposure_ms = 8.0;
        config.readout_ms = 4.0;
        const auto live = opened(camera, config);
        ASSERT_NE(live, nullptr);
        const std::int64_t half_ns = 6'000'000;
        EXPECT_EQ(next_of(*live).time_ns, 1000 * kStart_us + (start ? half_ns : -half_ns));
        EXPECT_EQ(camera.controls[V4L2_CID_EXPOSURE_ABSOLUTE].value, 80);
        EXPECT_EQ(camera.controls[V4L2_CID_EXPOSURE_AUTO].value, V4L2_EXPOSURE_MANUAL);
    }
}

TEST(LiveCamera, AManualExposureThatTheCameraHasIsKnown) {
    FakeCamera camera = small_camera();
    camera.controls[V4L2_CID_EXPOSURE_AUTO].value = V4L2_EXPOSURE_MANUAL;
    play(camera, frame_event(0));
    const auto live = opened(camera);
    ASSERT_NE(live, nullptr);
    EXPECT_EQ(next_of(*live).time_ns, 1000 * kStart_us + 2'500'000);
}

TEST(LiveCamera, ASlowConsumerGetsTheNewestFrame) {
    FakeCamera camera = small_camera();
    for (int i = 0; i < 3; ++i) camera.script.push_back(frame_event(i));
    camera.script.push_back(silence());
    play(camera, frame_event(3));
    const auto live = opened(camera);
    ASSERT_NE(live, nullptr);
    StereoFrame frame = next_of(*live);
    EXPECT_EQ(frame.left.at(0, 0), pixel(2, 0, 0));
    EXPECT_EQ(frame.frame_status.skipped, 2);
    EXPECT_EQ(frame.frame_status.dropped, 0);
    frame = next_of(*live);
    EXPECT_EQ(frame.left.at(0, 0), pixel(3, 0, 0));
    EXPECT_EQ(frame.frame_status.skipped, 0);
}

TEST(LiveCamera, FullBuffersAreOldAndAFreshFrameIsWaitedFor) {
    FakeCamera camera = small_camera();
    constexpr int kFull = static_cast<int>(V4l2Device::kBuffers);
    for (int i = 0; i < kFull; ++i) camera.script.push_back(frame_event(i));
    play(camera, frame_event(60));  // while the buffers were full the driver lost the others
    const auto live = opened(camera);
    ASSERT_NE(live, nullptr);
    const StereoFrame frame = next_of(*live);
    EXPECT_EQ(frame.left.at(0, 0), pixel(60, 0, 0));
    EXPECT_EQ(frame.frame_status.skipped, kFull);
    EXPECT_EQ(frame.frame_status.dropped, 60 - kFull);
}

TEST(LiveCamera, CountsFramesThatTheDriverLost) {
    FakeCamera camera = small_camera();
    FakeEvent last = frame_event(9);
    for (const std::uint32_t sequence : {0xfffffffeU, 0xffffffffU, 2U, 3U}) {
        FakeEvent event = frame_event(static_cast<int>(camera.script.size()));
        event.sequence = sequence;
        play(camera, event);
    }
    last.sequence = 0;  // a counter that starts again
    play(camera, last);
    const auto live = opened(camera);
    ASSERT_NE(live, nullptr);
    for (const int dropped : {0, 0, 2, 0, 0})
        EXPECT_EQ(next_of(*live).frame_status.dropped, dropped);
}

TEST(LiveCamera, RepeatedAndTornImagesAreFoundOut) {
    FakeCamera camera = small_camera();
    play(camera, frame_event(0));
    FakeEvent repeated = frame_event(1);
    repeated.bytes = yuyv(0);
    play(camera, repeated);
    FakeEvent torn = frame_event(2);
    const std::string old = yuyv(0);
    const std::size_t half = old.size() / 2;
    torn.bytes.replace(half, half, old, half, half);
    play(camera, torn);
    play(camera, frame_event(3));
    const auto live = opened(camera);
    ASSERT_NE(live, nullptr);
    camera::FrameIntegrityCheck watch;
    for (int i = 0; i < 4; ++i) {
        StereoFrame frame = next_of(*live);
        const FrameStatus frame_status = watch.check(frame);
        EXPECT_EQ(frame_status.repeated, i == 1 ? 1 : 0) << i;
        EXPECT_EQ(frame_status.torn, i == 2) << i;
    }
}

TEST(LiveCamera, ShortAndDamagedBuffersAreCountedAndLeftOut) {
    FakeCamera camera = small_camera();
    play(camera, frame_event(0));
    FakeEvent cut = frame_event(1);
    cut.bytes.resize(cut.bytes.size() - 100);
    play(camera, cut);
    FakeEvent empty = frame_event(2);
    empty.bytes.clear();
    play(camera, empty);
    FakeEvent flagged = frame_event(3);
    flagged.flags |= V4L2_BUF_FLAG_ERROR;
    play(camera, flagged);
    FakeEvent backwards = frame_event(4);
    backwards.time_us = kStart_us;
    play(camera, backwards);
    play(camera, frame_event(5));
    const auto live = opened(camera);
    ASSERT_NE(live, nullptr);
    EXPECT_EQ(next_of(*live).frame_status.damaged, 0);
    const StereoFrame frame = next_of(*live);
    EXPECT_EQ(frame.frame_status.damaged, 4);
    EXPECT_EQ(frame.index, 1);
    EXPECT_EQ(frame.left.at(5, 5), pixel(5, 5, 5));
}

TEST(LiveCamera, GivesUpWhenNothingIsUsable) {
    FakeCamera camera = small_camera();
    for (int i = 0; i < 5; ++i) {
        play(camera, frame_event(i));
        camera.script[camera.script.size() - 2].bytes.resize(10);
    }
    CameraConfig config;
    config.max_damaged = 5;
    const auto live = opened(camera, config);
    ASSERT_NE(live, nullptr);
    const auto frame = live->next();
    ASSERT_FALSE(frame.ok());
    EXPECT_TRUE(contains(frame.error().message, "5 frames in a row")) << frame.error().message;
    EXPECT_TRUE(contains(frame.error().message, "10 of 3072 bytes")) << frame.error().message;
}

TEST(LiveCamera, DecodesMjpegAndSurvivesDamage) {
    cv::Mat both(kHeight, 2 * kWidth, CV_8UC1);
    for (int v = 0; v < kHeight; ++v)
        for (int u = 0; u < 2 * kWidth; ++u) both.at<std::uint8_t>(v, u) = u < kWidth ? 60 : 180;
    std::vector<uchar> jpeg;
    ASSERT_TRUE(cv::imencode(".jpg", both, jpeg));
    const std::string whole(jpeg.begin(), jpeg.end());
    FakeCamera camera = small_camera();
    camera.fourcc = V4L2_PIX_FMT_MJPEG;
    camera.bytes_per_line = 0;
    for (int i = 0; i < 4; ++i) {
        FakeEvent event = frame_event(i);
        event.bytes = whole;
        if (i == 1) event.bytes.resize(whole.size() / 2);
        if (i == 2) event.bytes = "no JPEG at all";
        if (i == 3) event.bytes += std::string(500, '\0');  // drivers pad
        play(camera, event);
    }
    const auto live = opened(camera);
    ASSERT_NE(live, nullptr);
    const StereoFrame first = next_of(*live);
    EXPECT_NEAR(first.left.at(10, 10), 60, 2);  // tolerance of one quantisation step of the encoder
    EXPECT_NEAR(first.right.at(10, 10), 180, 2);
    EXPECT_EQ(next_of(*live).frame_status.damaged, 2);
}

TEST(LiveCamera, RandomDamageToMjpegNeverCrashes) {
    cv::Mat both(kHeight, 2 * kWidth, CV_8UC1);
    cv::randu(both, 0, 255);
    std::vector<uchar> jpeg;
    ASSERT_TRUE(cv::imencode(".jpg", both, jpeg));
    FakeCamera camera = small_camera();
    camera.fourcc = V4L2_PIX_FMT_MJPEG;
    int index = 0;
    testing::for_each_mutation(
        std::string(jpeg.begin(), jpeg.end()), 60, 7, [&](const std::string& bytes) {
            FakeEvent event = frame_event(index++);
            event.bytes = bytes;
            play(camera, event);
        });
    play(camera, frame_event(index));
    camera.script[camera.script.size() - 2].bytes.assign(jpeg.begin(), jpeg.end());
    CameraConfig config;
    config.max_damaged = 1000;
    const auto live = opened(camera, config);
    ASSERT_NE(live, nullptr);
    int frames = 0;
    int damaged = 0;
    while (camera.script.size() > 1) {
        const StereoFrame frame = next_of(*live);
        ASSERT_EQ(frame.left.width(), kWidth);
        ++frames;
        damaged += frame.frame_status.damaged;
    }
    EXPECT_EQ(frames + damaged, 61);
    EXPECT_GT(damaged, 10);
}

class Unplugging : public ::testing::TestWithParam<FakeEvent::Kind> {};

TEST_P(Unplugging, IsFollowedByReconnection) {
    FakeCamera camera = small_camera();
    camera.absent_for = 7;
    play(camera, frame_event(0));
    FakeEvent unplug;
    unplug.kind = GetParam();
    camera.script.push_back(unplug);
    FakeEvent again = frame_event(90);
    again.sequence = 5;  // drivers restart their counter, and the first images may be lost
    play(camera, again);
    play(camera, frame_event(91));
    camera.script[camera.script.size() - 2].sequence = 6;
    const auto live = opened(camera);
    ASSERT_NE(live, nullptr);
    EXPECT_EQ(next_of(*live).frame_status.reconnected, 0);
    const StereoFrame back = next_of(*live);
    EXPECT_EQ(back.frame_status.reconnected, 1);
    EXPECT_EQ(back.frame_status.dropped, 0);
    EXPECT_EQ(back.index, 1);
    EXPECT_EQ(back.left.at(3, 3), pixel(90, 3, 3));
    EXPECT_EQ(next_of(*live).frame_status.reconnected, 0);
    EXPECT_EQ(camera.opened, 2);
    EXPECT_EQ(camera.paused_ms, 8 * LiveCamera::kRetry_ms);
    EXPECT_EQ(camera.mapped, static_cast<int>(V4l2Device::kBuffers)) << "old buffers are unmapped";
}

INSTANTIATE_TEST_SUITE_P(LiveCamera,
                         Unplugging,
                         ::testing::Values(FakeEvent::Kind::unplug,
                                           FakeEvent::Kind::unplug_while_dequeuing));

TEST(LiveCamera, ReconnectionHasALimit) {
    FakeCamera camera = small_camera();
    camera.absent_for = 1000;
    play(camera, frame_event(0));
    FakeEvent unplug;
    unplug.kind = FakeEvent::Kind::unplug;
    camera.script.push_back(unplug);
    CameraConfig config;
    config.reconnect_s = 3.0;
    const auto live = opened(camera, config);
    ASSERT_NE(live, nullptr);
    (void)next_of(*live);
    const auto frame = live->next();
    ASSERT_FALSE(frame.ok());
    EXPECT_TRUE(contains(frame.error().message, "no frame for 3.0 s after 1 frames"))
        << frame.error().message;
    EXPECT_EQ(camera.paused_ms, 3000);
}

TEST(LiveCamera, ASilentDeviceIsOpenedAgain) {
    FakeCamera camera = small_camera();
    play(camera, frame_event(0));
    for (int i = 0; i < 10; ++i) camera.script.push_back(silence());
    play(camera, frame_event(1));
    const auto live = opened(camera);
    ASSERT_NE(live, nullptr);
    (void)next_of(*live);
    EXPECT_EQ(next_of(*live).frame_status.reconnected, 1);
    EXPECT_EQ(camera.opened, 2);
}

TEST(LiveCamera, ADeviceThatOpensButStaysSilentEndsTheRun) {
    FakeCamera camera = small_camera();
    CameraConfig config;
    config.reconnect_s = 5.0;
    const auto live = opened(camera, config);
    ASSERT_NE(live, nullptr);
    const auto frame = live->next();
    ASSERT_FALSE(frame.ok());
    EXPECT_TRUE(contains(frame.error().message, "silent for 1 s")) << frame.error().message;
    EXPECT_LE(camera.waited_ms + camera.paused_ms, 6000);
}

TEST(LiveCamera, TheUserMayStopWhileNothingComes) {
    FakeCamera camera = small_camera();
    int asked = 0;
    auto live = LiveCamera::open(
        std::make_unique<FakeVideoDevice>(camera), {"/dev/fake", {}, {}, {}}, small_rig(), {}, [&] {
            return ++asked > 3;
        });
    ASSERT_TRUE(live.ok());
    const auto frame = (*live)->next();
    ASSERT_TRUE(frame.ok());
    EXPECT_FALSE(frame->has_value());
}

TEST(LiveCamera, SaysWhatCannotBeSet) {
    FakeCamera camera = small_camera();
    CameraConfig config;
    config.gain = 101;
    EXPECT_TRUE(contains(open_error(camera, config), "live.gain = 101 is outside 0 .. 100"));
    config = {};
    config.exposure_ms = 40.0;
    EXPECT_TRUE(contains(open_error(camera, config), "= 400 is outside 1 .. 300"));
    config = {};
    config.white_balance_k = 4600;
    EXPECT_TRUE(contains(open_error(camera, config), "no control for live.white_balance_k"));
    config = {};
    config.gain = 3;
    config.automatic = AutoControl::on;
    EXPECT_TRUE(contains(open_error(camera, config), "sets a fixed value. Set live.auto to off"));
    EXPECT_EQ(camera.mapped, 0);
}

TEST(LiveCamera, RefusesAnotherFormatThanAskedFor) {
    FakeCamera camera = small_camera();
    camera.keeps_its_own_size = true;
    EXPECT_TRUE(
        contains(open_error(camera), "asked for 64 x 24 YUYV, but the camera gives 32 x 24"));
    camera = small_camera();
    EXPECT_TRUE(contains(open_error(camera, {}, {"/dev/fake", 64, 24, 60.0}),
                         "no YUYV or MJPEG mode of 64 x 24 px at 60 Hz; it has YUYV 64x24@30"));
    EXPECT_TRUE(
        contains(open_error(camera, {}, {"/dev/fake", 1344, 376, {}}),
                 "1344 x 376 px with both cameras, but the rig has two cameras of 32 x 24 px"));
    CameraConfig config;
    config.format = FormatChoice::mjpeg;
    EXPECT_TRUE(contains(open_error(camera, config), "in the format of live.format"));
    camera.fourcc = V4L2_PIX_FMT_H264;
    EXPECT_TRUE(contains(open_error(camera), "it has H264 64x24@30"));
    camera.open_error = EACCES;
    EXPECT_TRUE(contains(open_error(camera), "group 'video'"));
}

TEST(LiveCamera, RefusesStampsOfAnUnknownClock) {
    FakeCamera camera = small_camera();
    FakeEvent event = frame_event(0);
    event.flags = V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN;
    play(camera, event);
    const auto live = opened(camera);
    ASSERT_NE(live, nullptr);
    const auto frame = live->next();
    ASSERT_FALSE(frame.ok());
    EXPECT_TRUE(contains(frame.error().message, "CLOCK_MONOTONIC"));
}

TEST(LiveCamera, ListsModesAndControls) {
    FakeCamera camera = small_camera();
    camera.rates_hz = {15, 30, 60, 100};
    FakeVideoDevice system(camera);
    auto device = V4l2Device::open(system, "/dev/fake");
    ASSERT_TRUE(device.ok());
    EXPECT_EQ(device->card(), "Fake stereo");
    const auto modes = device->modes();
    ASSERT_EQ(modes.size(), 4U);
    EXPECT_EQ(modes[3].fourcc, "YUYV");
    EXPECT_DOUBLE_EQ(modes[3].rate_hz, 100.0);
    const auto controls = device->controls();
    ASSERT_EQ(controls.size(), 3U);
    EXPECT_EQ(controls[0].max, 100);
    EXPECT_EQ(controls[0].value, 20);
}

TEST(LiveAddress, IsReadStrictly) {
    const auto full = parse_live_address("/dev/video2@1344x376@100");
    ASSERT_TRUE(full.ok());
    EXPECT_EQ(full->device, "/dev/video2");
    EXPECT_EQ(full->width, 1344);
    EXPECT_EQ(full->height, 376);
    EXPECT_EQ(full->rate_hz, 100.0);
    ASSERT_TRUE(parse_live_address("/dev/video0").ok());
    for (const char* wrong : {"",
                              "video0",
                              "/dev/video0@",
                              "/dev/video0@640",
                              "/dev/video0@641x480",
                              "/dev/video0@-2x480",
                              "/dev/video0@99999999x2",
                              "/dev/video0@640x480@0",
                              "/dev/video0@640x480@nan",
                              "/dev/video0@640x480@30@1"}) {
        EXPECT_FALSE(parse_live_address(wrong).ok()) << wrong;
    }
}

}  // namespace
}  // namespace surefoot::io
