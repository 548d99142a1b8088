// SPDX-License-Identifier: Apache-2.0
#include "studies/suite/suite_progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

#include "service/console/log.hpp"
#include "service/console/option_settings.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::app {

SuiteProgress::SuiteProgress(std::size_t cases, std::int64_t frames)
    : terminal_(isatty(STDERR_FILENO) != 0),
      start_ns_(steady_now_ns()),
      cases_(cases),
      frames_(frames) {}

SuiteProgress::~SuiteProgress() {
    if (terminal_) fmt::print(stderr, "\r\033[K");
}

void SuiteProgress::started(const std::string& name) {
    if (terminal_) show(name);
}

void SuiteProgress::finished(const std::string& name, int frames) {
    ++done_cases_;
    done_frames_ += frames;
    show(name);
}

void SuiteProgress::show(const std::string& what) {
    const double elapsed_s = seconds_from_ns(steady_now_ns() - start_ns_);
    const std::string left = time_left(done_frames_, frames_, elapsed_s);
    const std::string line = fmt::format(
        "{}/{} cases, {}{}", done_cases_, cases_, what, left.empty() ? "" : ", " + left);
    if (terminal_) {
        fmt::print(stderr, "\r\033[K{}", line);
        std::fflush(stderr);
    } else {
        log_info(line);
    }
}

std::string time_left(std::int64_t done_frames, std::int64_t frames, double elapsed_s) {
    if (done_frames <= 0 || done_frames >= frames) return {};
    const double left_s =
        elapsed_s * static_cast<double>(frames - done_frames) / static_cast<double>(done_frames);
    const auto whole_s = saturated_integer<std::int64_t>(std::ceil(left_s));
    constexpr std::int64_t kMinute_s = 60;
    constexpr std::int64_t kHour_s = 3600;
    if (whole_s < kMinute_s) return fmt::format("about {} s left", whole_s);
    const std::int64_t minutes = (whole_s + kMinute_s - 1) / kMinute_s;
    if (whole_s < kHour_s) return fmt::format("about {} min left", minutes);
    return fmt::format("about {} h {} min left", minutes / 60, minutes % 60);
}

}  // namespace surefoot::app
