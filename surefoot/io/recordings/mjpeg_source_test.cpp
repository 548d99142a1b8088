// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/recordings/mjpeg_source.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "surefoot/camera/rigs_testing.hpp"
#include "surefoot/io/calibration/rig_file.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io {
namespace {

using testing::contains;
using testing::TemporaryFolder;

constexpr int kWidth = 64;
constexpr int kHeight = 48;

camera::StereoRig small_rig() {
    camera::StereoRig rig = camera::test::ideal_rig(kWidth, kHeight, 60.0);
    rig.rate_hz = 20.0;
    return rig;
}

/// Both camera images in one brightness, so that a decoded frame identifies its number.
std::string jpeg(int index) {
    const cv::Mat image(kHeight, 2 * kWidth, CV_8UC1, cv::Scalar(20.0 * index));
    std::vector<uchar> bytes;
    cv::imencode(".jpg", image, bytes);
    return {bytes.begin(), bytes.end()};
}

/// Numbers of the frames played, -1 for an error.
std::vector<int> played(const std::string& bytes, std::string* errors = nullptr) {
    const TemporaryFolder folder;
    EXPECT_TRUE(write_file(folder / "v.mjpeg", bytes).ok());
    EXPECT_TRUE(write_rig_yaml(folder / "rig.yaml", small_rig()).ok());
    auto source = open_source(folder / "v.mjpeg");
    EXPECT_TRUE(source.ok());
    std::vector<int> numbers;
    std::int64_t last_ns = -1;
    while (source.ok() && numbers.size() < 1000) {
        auto frame = (*source)->next();
        if (!frame.ok()) {
            if (errors != nullptr) *errors += frame.error().message + "\n";
            numbers.push_back(-1);
            continue;
        }
        if (!frame->has_value()) return numbers;
        EXPECT_GT((*frame)->time_ns, last_ns);
        last_ns = (*frame)->time_ns;
        numbers.push_back(((*frame)->right.at(9, 9) + 10) / 20);
    }
    ADD_FAILURE() << "the source does not end";
    return numbers;
}

TEST(MjpegSource, PlaysConcatenatedImages) {
    std::string bytes;
    for (int i = 0; i < 12; ++i) bytes += jpeg(i) + (i % 3 == 0 ? std::string(7, '\0') : "");
    EXPECT_EQ(played(bytes), (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}));
}

TEST(MjpegSource, GoesOnBehindADamagedImage) {
    std::string errors;
    const std::string cut = jpeg(1).substr(0, jpeg(1).size() - 20);
    EXPECT_EQ(played(jpeg(0) + cut + jpeg(2), &errors), (std::vector<int>{0, -1, 2}));
    EXPECT_TRUE(contains(errors, "frame 1:")) << errors;
    errors.clear();
    EXPECT_EQ(played(jpeg(0) + jpeg(1) + cut, &errors), (std::vector<int>{0, 1, -1}));
    EXPECT_TRUE(contains(errors, "truncated")) << errors;
}

TEST(MjpegSource, AFileWithoutImagesIsAnError) {
    for (const std::string& bytes :
         {std::string(), std::string("no images\n"), std::string(9, 0)}) {
        std::string errors;
        EXPECT_EQ(played(bytes, &errors), std::vector<int>{-1});
        EXPECT_TRUE(contains(errors, "no JPEG images")) << errors;
    }
}

TEST(MjpegSource, AnEndMarkerInsideAThumbnailEndsNothing) {
    std::string bytes = jpeg(3);
    const std::string thumbnail = jpeg(1);
    std::string segment = "\xff\xe1";
    segment += static_cast<char>((thumbnail.size() + 2) >> 8);
    segment += static_cast<char>((thumbnail.size() + 2) & 0xff);
    bytes.insert(2, segment + thumbnail);
    const auto span = first_jpeg(bytes);
    ASSERT_TRUE(span.has_value());
    EXPECT_EQ(span->begin, 0U);
    EXPECT_EQ(span->end, bytes.size());
    for (std::size_t size = 0; size < bytes.size(); ++size)
        EXPECT_FALSE(first_jpeg(std::string_view(bytes).substr(0, size)).has_value()) << size;
}

TEST(MjpegSource, SurvivesRandomDamage) {
    testing::for_each_mutation(jpeg(0) + jpeg(1) + jpeg(2), 200, 5, [](const std::string& bytes) {
        std::string rest = bytes;
        while (const auto span = first_jpeg(rest)) {
            ASSERT_GT(span->end, span->begin);
            ASSERT_LE(span->end, rest.size());
            rest.erase(0, span->end);
        }
    });
}

}  // namespace
}  // namespace surefoot::io
