// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/inertial/imu_watch.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace surefoot::odometry {
namespace {

constexpr std::int64_t kMs_ns = 1'000'000;

/// Frames every 50 ms. Their samples come from a stream that a test can disturb.
struct Stream {
    ImuWatch watch{0.03};
    std::int64_t frame_ns = 0;
    std::int64_t sample_ns = 0;  ///< stamp of the last sample
    std::int64_t period_ns = 5 * kMs_ns;

    /// A frame, with all its samples or with none.
    bool frame(bool samples, ImuProblem problem = ImuProblem::none) {
        frame_ns += 50 * kMs_ns;
        std::vector<ImuSample> given;
        for (; sample_ns + period_ns <= frame_ns; sample_ns += period_ns)
            if (samples) given.push_back({.time_ns = sample_ns + period_ns});
        watch.listen(given);
        watch.finish(frame_ns, problem);
        return watch.gap();
    }
    /// One digit per frame; 1 = gap.
    std::string frames(std::size_t count, bool samples, ImuProblem problem = ImuProblem::none) {
        std::string said;
        for (std::size_t i = 0; i < count; ++i) said += frame(samples, problem) ? '1' : '0';
        return said;
    }
};

TEST(ImuWatch, AGapIsSaidFromTheSecondFrameOnUntilSamplesComeAgain) {
    for (const std::size_t lacking : {1U, 4U, 20U}) {
        Stream stream;
        EXPECT_EQ(stream.frames(10, true), std::string(10, '0'));
        EXPECT_EQ(stream.frames(lacking, false), "0" + std::string(lacking - 1, '1'));
        EXPECT_EQ(stream.frames(3, true), "100") << "the hole ends in the first of these";
    }
}

TEST(ImuWatch, HolesThatEndWithinAFrameCount) {
    Stream stream;
    EXPECT_EQ(stream.frames(10, true), std::string(10, '0'));
    for (const int hole_ms : {20, 21, 30}) {
        for (int i = 0; i < 3; ++i) {
            stream.sample_ns += (hole_ms - 5) * kMs_ns;
            EXPECT_EQ(stream.frame(true), hole_ms > 20 && i > 0) << hole_ms << " " << i;
        }
        stream.frames(3, true);
        stream.sample_ns = stream.frame_ns;
    }
}

TEST(ImuWatch, SamplesMayComeLate) {
    Stream stream;
    stream.frame_ns = 25 * kMs_ns;
    stream.sample_ns = 0;
    for (int i = 0; i < 20; ++i) {
        stream.frame_ns += 50 * kMs_ns;
        std::vector<ImuSample> given;
        for (; stream.sample_ns + 25 * kMs_ns < stream.frame_ns; stream.sample_ns += 5 * kMs_ns)
            given.push_back({.time_ns = stream.sample_ns + 5 * kMs_ns});
        stream.watch.listen(given);
        stream.watch.finish(stream.frame_ns, ImuProblem::none);
        EXPECT_FALSE(stream.watch.gap()) << i;
    }
}

TEST(ImuWatch, AnotherRateIsNoGap) {
    Stream stream;
    EXPECT_EQ(stream.frames(10, true), std::string(10, '0'));
    stream.period_ns = 10 * kMs_ns;
    EXPECT_EQ(stream.frames(10, true), std::string(10, '0'));
    stream.period_ns = 1 * kMs_ns;
    EXPECT_EQ(stream.frames(10, true), std::string(10, '0'));
    stream.period_ns = 5 * kMs_ns;  // a fifth of the rate: a gap until it is the usual rate
    EXPECT_EQ(stream.frames(10, true), "0100000000");
}

TEST(ImuWatch, SlowStreamsAreJudgedByTheirOwnPeriod) {
    Stream stream;
    stream.period_ns = 25 * kMs_ns;
    EXPECT_EQ(stream.frames(10, true), std::string(10, '0'));
    EXPECT_EQ(stream.frames(5, false), "00011") << "four periods are two frames";
}

TEST(ImuWatch, ReadingsThatCannotBeIntegratedAreMissing) {
    for (const ImuProblem problem :
         {ImuProblem::stamps, ImuProblem::not_finite, ImuProblem::saturated, ImuProblem::gap}) {
        Stream stream;
        EXPECT_EQ(stream.frames(3, true, problem), "011") << to_string(problem);
        EXPECT_EQ(stream.frames(2, true), "00") << to_string(problem);
    }
}

TEST(ImuWatch, AnImuThatNeverSpokeHasNoGap) {
    Stream stream;
    EXPECT_EQ(stream.frames(5, false, ImuProblem::no_samples), "00000");
}

TEST(ImuWatch, ClocksThatGoBackAreNoRate) {
    Stream stream;
    stream.frames(10, true);
    stream.frame_ns -= 2000 * kMs_ns;
    stream.sample_ns -= 2000 * kMs_ns;
    EXPECT_EQ(stream.frames(3, true, ImuProblem::none), "000");
    EXPECT_EQ(stream.frames(3, false), "011");
}

}  // namespace
}  // namespace surefoot::odometry
