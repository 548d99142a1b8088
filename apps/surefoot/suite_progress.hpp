// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace surefoot::app {

/// How far a suite is and how long it will still take, on stderr: one line that is renewed on a
/// terminal, else a line for every finished case. One thread at a time.
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

/// "about 2 h 5 min left"; empty before anything is done. Time goes by frames.
[[nodiscard]] std::string time_left(std::int64_t done_frames,
                                    std::int64_t frames,
                                    double elapsed_s);

}  // namespace surefoot::app
