// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/recordings/imu_stream.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io {
namespace {

using testing::contains;
using testing::TemporaryFolder;

std::string row(std::int64_t time_ns) {
    return std::to_string(time_ns) + ",0.1,0.2,0.3,9.8,0.0," + std::to_string(time_ns % 7) + "\n";
}

std::vector<std::int64_t> times(const std::vector<ImuSample>& samples) {
    std::vector<std::int64_t> list;
    for (const ImuSample& sample : samples) list.push_back(sample.time_ns);
    return list;
}

/// Frames at given times, without images.
class TimedSource final : public camera::FrameSource {
  public:
    explicit TimedSource(std::vector<std::int64_t> times_ns) : times_ns_(std::move(times_ns)) {
        rig_.imu = camera::ImuMount{};
        info_.path = "timed";
    }
    [[nodiscard]] const camera::StereoRig& rig() const override { return rig_; }
    [[nodiscard]] const camera::SourceInfo& info() const override { return info_; }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override {
        if (next_ >= times_ns_.size()) return std::optional<StereoFrame>();
        StereoFrame frame;
        frame.time_ns = times_ns_[next_++];
        return std::optional<StereoFrame>(std::move(frame));
    }
    camera::StereoRig rig_;
    camera::SourceInfo info_;

  private:
    std::vector<std::int64_t> times_ns_;
    std::size_t next_ = 0;
};

TEST(ImuStream, EverySampleGoesWithTheFrameThatEndsItsSpan) {
    const TemporaryFolder folder;
    std::string text = "#stamp,w,a\n";
    constexpr std::int64_t kSecond_ns = 1'000'000'000;
    for (std::int64_t i = 1; i <= 3000; ++i) text += row(i * 5'000'000);  // many chunks
    ASSERT_TRUE(write_file(folder / "imu.csv", text).ok());
    auto source = with_imu(std::make_unique<TimedSource>(std::vector<std::int64_t>{
                               3 * kSecond_ns, 3 * kSecond_ns + 12'000'000, 20 * kSecond_ns}),
                           folder / "imu.csv");
    ASSERT_TRUE(source.ok()) << source.error().message;
    EXPECT_TRUE((*source)->info().has_imu);
    auto frame = (*source)->next();
    ASSERT_TRUE(frame.ok());
    EXPECT_EQ((*frame)->imu.size(), 200U) << "no more than the last second";
    EXPECT_EQ((*frame)->imu.back().time_ns, 3 * kSecond_ns);
    frame = (*source)->next();
    EXPECT_EQ(times((*frame)->imu),
              (std::vector<std::int64_t>{3 * kSecond_ns + 5'000'000, 3 * kSecond_ns + 10'000'000}));
    frame = (*source)->next();
    EXPECT_EQ((*frame)->imu.size(), 3000U - 602U);
    EXPECT_FALSE((*source)->next()->has_value());
}

TEST(ImuStream, AFifoIsReadAsFarAsItWasWritten) {
    const TemporaryFolder folder;
    const std::string path = folder / "imu";
    ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
    auto stream = ImuStream::open(path);
    ASSERT_TRUE(stream.ok());
    EXPECT_TRUE(stream->take_until(1000)->empty()) << "nobody writes yet";
    const int writer = ::open(path.c_str(), O_WRONLY);
    ASSERT_GE(writer, 0);
    const auto write_text = [&](const std::string& text) {
        ASSERT_EQ(::write(writer, text.data(), text.size()), static_cast<ssize_t>(text.size()));
    };
    write_text(row(100) + row(200) + row(300).substr(0, 9));
    EXPECT_EQ(times(*stream->take_until(1000)), (std::vector<std::int64_t>{100, 200}));
    EXPECT_TRUE(stream->take_until(1000)->empty());
    write_text(row(300).substr(9) + row(2000));
    EXPECT_EQ(times(*stream->take_until(1000)), (std::vector<std::int64_t>{300}));
    EXPECT_EQ(times(*stream->take_until(2000)), (std::vector<std::int64_t>{2000}));
    ::close(writer);
    EXPECT_TRUE(stream->take_until(9000)->empty()) << "the writer went away";
}

TEST(ImuStream, SaysWhatIsWrong) {
    const TemporaryFolder folder;
    const auto error_of = [&](const std::string& text) {
        EXPECT_TRUE(write_file(folder / "imu.csv", text).ok());
        auto stream = ImuStream::open(folder / "imu.csv");
        const auto samples = stream->take_until(1'000'000);
        return samples.ok() ? std::string() : samples.error().message;
    };
    EXPECT_EQ(error_of(row(1) + row(2)), "");
    EXPECT_TRUE(contains(error_of(row(5) + row(5)), "does not increase"));
    EXPECT_TRUE(contains(error_of("1,2,3\n"), "expected 'stamp_ns"));
    EXPECT_TRUE(contains(error_of("1,0,0,nan,0,0,0\n"), "not a finite number"));
    EXPECT_TRUE(contains(error_of(std::string(10'000, '7')), "a line is too long"));
    // Stamps that go back from one part of the file to the next, far apart.
    std::string text;
    for (std::int64_t i = 0; i < 1000; ++i) text += row(10 + i);
    EXPECT_TRUE(contains(error_of(text + row(3)), "does not increase"));
    EXPECT_FALSE(ImuStream::open(folder / "missing.csv").ok());
}

TEST(ImuStream, NeedsASourceWithoutImuAndARigThatKnowsItsPlace) {
    const TemporaryFolder folder;
    ASSERT_TRUE(write_file(folder / "imu.csv", row(1)).ok());
    auto source = std::make_unique<TimedSource>(std::vector<std::int64_t>{1});
    source->info_.has_imu = true;
    auto refused = with_imu(std::move(source), folder / "imu.csv");
    ASSERT_FALSE(refused.ok());
    EXPECT_TRUE(contains(refused.error().message, "has its own IMU"));
    source = std::make_unique<TimedSource>(std::vector<std::int64_t>{1});
    source->rig_.imu.reset();
    refused = with_imu(std::move(source), folder / "imu.csv");
    ASSERT_FALSE(refused.ok());
    EXPECT_TRUE(contains(refused.error().message, "where its IMU is"));
}

}  // namespace
}  // namespace surefoot::io
