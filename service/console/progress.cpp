// SPDX-License-Identifier: Apache-2.0
#include "service/console/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace surefoot::app {
Progress::Progress(std::string label, std::optional<int> total)
    : label_(std::move(label)),
      total_(total),
      visible_(!label_.empty() && isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
    if (visible_) fmt::print(stderr, "\r\033[K");
}

void Progress::advance(int done) {
    if (!visible_) return;
    if (!total_ || *total_ <= 0) {
        fmt::print(stderr, "\r{} frame {}", label_, done);
        return;
    }
    const int percent = 100 * done / *total_;
    if (percent == last_percent_) return;
    last_percent_ = percent;
    constexpr int kBarWidth = 40;
    const auto filled = static_cast<std::size_t>(kBarWidth * done / *total_);
    fmt::print(stderr,
               "\r{} [{:<{}}] {:3d} % ({}/{})",
               label_,
               std::string(filled, '#'),
               kBarWidth,
               percent,
               done,
               *total_);
    std::fflush(stderr);
}

}  // namespace surefoot::app
