// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "service/console/option_settings.hpp"
#include "service/page/page_settings.hpp"
#include "surefoot/core/config.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// Settings that may change while the service runs. These settings affect no verdict. All pipeline
/// settings need a restart, because they determine the map that the gate uses and are part of the
/// configuration hash of each verdict. Limits of the gate and of the machine cannot be changed from
/// a page.
struct ServiceConfig {
    double map_hz = 10.0;
    double image_hz = 5.0;
    double layer_hz = 2.0;
    double speed = 0.0;  ///< speed of a simulated scene relative to real time; 0 = unpaced
    int niceness = 10;

    void describe(ConfigVisitor& visitor);
};

/// Returns the unit in the suffix of a name, for example "m" for "length_m"; empty if none.
[[nodiscard]] std::string unit_of(const std::string& key);

/// The settings of a service and of its run, as pages see them. Every change of a setting is
/// checked here. Thread-safe.
class ServiceSettings {
  public:
    /// Applies a change, or returns the reason why the change is not possible.
    using Apply = std::function<Status(const ServiceConfig& wanted)>;

    /// `can_pace`: the source is a simulated scene, so its speed can change. The niceness of
    /// `first` is the lowest niceness that a later change may set.
    ServiceSettings(const ServiceConfig& first, bool can_pace, Apply apply);

    /// Returns all settings: first the settings that may change, then the settings of the run,
    /// which are read-only.
    [[nodiscard]] std::vector<page::PageSetting> for_pages(const Settings& run) const;
    /// Changes one setting. Returns the new value as text, or the reason of the refusal.
    [[nodiscard]] Result<std::string> change(const page::SettingWish& wish);
    [[nodiscard]] ServiceConfig now() const;

  private:
    [[nodiscard]] Status check(const ServiceConfig& wanted) const;

    const int first_niceness_;
    const bool can_pace_;
    const Apply apply_;
    mutable std::mutex mutex_;
    ServiceConfig config_;
};

}  // namespace surefoot::app
