// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "service/rex_link/rex_link.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// Plays the tones of a folder with the program `aplay`. Plays no sound if `aplay` is not
/// installed. Never blocks.
class TonePlayer {
  public:
    /// An empty folder name means no sound. Returns a usage error if the folder lacks a tone.
    [[nodiscard]] static Result<TonePlayer> open(const std::string& folder);
    TonePlayer(TonePlayer&&) = default;
    TonePlayer& operator=(TonePlayer&&) = default;
    TonePlayer(const TonePlayer&) = delete;
    TonePlayer& operator=(const TonePlayer&) = delete;
    ~TonePlayer() = default;

    /// Returns the file of the tone; empty if there is no folder.
    [[nodiscard]] std::string file_of(rex_link::Tone tone) const;
    void play(rex_link::Tone tone);

  private:
    explicit TonePlayer(std::string folder) : folder_(std::move(folder)) {}

    std::string folder_;
    std::vector<pid_t> playing_;  ///< running or ended `aplay` processes
};

}  // namespace surefoot::app
