// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace surefoot::app {

/// Shows the progress and the remaining time of a suite on stderr. A terminal gets one updated
/// line, other outputs one line for each finished case. Not thread-safe.
class SuiteProgress {
  public:
    SuiteProgress(std::size_t cases, std::int64_t frames);
    ~SuiteProgress();
    SuiteProgress(const SuiteProgress&) = delete;
    SuiteProgress& operator=(const SuiteProgress&) = delete;

    void started(const std::string& name);
    void finished(const std::string& name, int frames);

  private:
    void show(const std::string& what);

    bool terminal_;
    std::int64_t start_ns_;
    std::size_t cases_;
    std::size_t done_cases_ = 0;
    std::int64_t frames_;
    std::int64_t done_frames_ = 0;
};

/// Returns the remaining time, for example "about 2 h 5 min left". The number of frames gives the
/// estimate. Empty before the first frame is done and after the last.
[[nodiscard]] std::string time_left(std::int64_t done_frames,
                                    std::int64_t frames,
                                    double elapsed_s);

}  // namespace surefoot::app
