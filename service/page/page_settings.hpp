// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "surefoot/core/result.hpp"

namespace surefoot::page {

/// One setting of the run, with the same texts as `surefoot config` prints.
struct PageSetting {
    std::string key;    ///< key with its groups, e.g. "elevation.length_m"
    std::string value;  ///< the value in use now
    std::string unit;   ///< for example "m"; empty if the setting has no unit
    std::string range;
    std::string comment;
    bool changeable = false;  ///< a page may change this setting during the run
};

/// A page's request to change one setting. The value has the format of --set.
struct SettingWish {
    std::string key;
    std::string value;
};

/// The answer to a SettingWish.
struct SettingAnswer {
    std::string key;
    bool accepted = false;
    std::string value;  ///< the value in use now; empty if the setting does not exist
    std::string text;   ///< sentence about the change, or the reason of the refusal
};

/// The settings that pages see. A page may change a setting if the service allows it. The last
/// request wins, and all pages see the result. Thread-safe.
class PageSettings {
  public:
    /// Applies a changeable setting. Returns the value now in use, or an error with the reason.
    /// Called on the thread of `ask`, one call at a time. The function must not call this object.
    using Change = std::function<Result<std::string>(const SettingWish& wish)>;

    /// Sets the list of settings, and the function that changes a setting.
    void offer(std::vector<PageSetting> settings, Change change);
    /// Changes a setting, or returns the reason why the setting cannot be changed.
    [[nodiscard]] SettingAnswer ask(const SettingWish& wish);

    [[nodiscard]] std::vector<PageSetting> all() const;
    /// Returns a number that increases with each change; 0 = offer() was not called yet.
    [[nodiscard]] std::uint64_t serial() const;

  private:
    mutable std::mutex mutex_;
    std::vector<PageSetting> settings_;
    Change change_;
    std::uint64_t serial_ = 0;
};

/// Return the "settings" and "setting" messages of messages.json.
[[nodiscard]] std::string settings_text(const std::vector<PageSetting>& settings);
[[nodiscard]] std::string setting_text(const SettingAnswer& answer);

}  // namespace surefoot::page
