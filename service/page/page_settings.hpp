// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "surefoot/core/result.hpp"

namespace surefoot::page {

/// A setting that the run uses, as `surefoot config` has it.
struct PageSetting {
    std::string key;    ///< with its groups: "elevation.length_m"
    std::string value;  ///< now
    std::string unit;   ///< "m"; empty where it has none
    std::string range;
    std::string comment;
    bool changeable = false;  ///< while the service runs
};

/// A page wants a setting to be so; the value is written as for --set.
struct SettingWish {
    std::string key;
    std::string value;
};

/// What became of a wish.
struct SettingAnswer {
    std::string key;
    bool accepted = false;
    std::string value;  ///< now; empty where there is no such setting
    std::string text;   ///< a sentence: what was done, or why it was refused
};

/// The settings that pages see, and may change where the service offers it: whoever asked last is
/// followed, everybody is shown. Any thread.
class PageSettings {
  public:
    /// Makes one of the changeable settings so: the value as it is now, or in words why not. Called
    /// on the thread of `ask`, one at a time.
    using Change = std::function<Result<std::string>(const SettingWish& wish)>;

    void offer(std::vector<PageSetting> settings, Change change);
    [[nodiscard]] SettingAnswer ask(const SettingWish& wish);

    [[nodiscard]] std::vector<PageSetting> all() const;
    /// Grows with each change; 0 = nothing was offered yet.
    [[nodiscard]] std::uint64_t serial() const;

  private:
    mutable std::mutex mutex_;
    std::vector<PageSetting> settings_;
    Change change_;
    std::uint64_t serial_ = 0;
};

/// The "settings" and "setting" messages of messages.json.
[[nodiscard]] std::string settings_text(const std::vector<PageSetting>& settings);
[[nodiscard]] std::string setting_text(const SettingAnswer& answer);

}  // namespace surefoot::page
