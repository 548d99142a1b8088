// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "apps/surefoot/settings.hpp"
#include "service/page/page_settings.hpp"
#include "surefoot/core/config.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// What may change while the service runs. None of it decides anything: every setting of the chain
/// makes the map that the gate judges by, and stands in the hash of each verdict, so that a change
/// needs a restart; limits of the gate and of the machine are in no list at all.
struct ServiceConfig {
    double map_hz = 10.0;
    double image_hz = 5.0;
    double layer_hz = 2.0;
    double speed = 0.0;  ///< of a simulated scene; 0 = as it comes
    int niceness = 10;

    void describe(ConfigVisitor& visitor);
};

/// Unit of a setting by the end of its name: "length_m" -> "m"; empty where it has none.
[[nodiscard]] std::string unit_of(const std::string& key);

/// The settings of a service for its pages, those of the run included, and the one place where a
/// change is checked. Any thread.
class ServiceSettings {
  public:
    /// Makes a change true, or says in words why it cannot.
    using Apply = std::function<Status(const ServiceConfig& wanted)>;

    /// `can_pace`: the source is a simulated scene. What niceness was at first is the least ever.
    ServiceSettings(const ServiceConfig& first, bool can_pace, Apply apply);

    /// Those that may change first, then all others as the run uses them.
    [[nodiscard]] std::vector<page::PageSetting> for_pages(const Settings& run) const;
    /// The new value as it is written, or why it is refused.
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
