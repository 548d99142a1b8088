// SPDX-License-Identifier: Apache-2.0
#include "service/live/service_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "service/page/page_messages.hpp"
#include "surefoot/io/settings/config_yaml.hpp"

namespace surefoot::app {
namespace {

/// Units by the suffix of a name. A longer suffix comes first, because "_m_s" also ends with "_s".
constexpr std::array<std::pair<std::string_view, std::string_view>, 24> kUnits{
    {{"_m_s2", "m/s\u00b2"},
     {"_deg_s", "deg/s"},
     {"_rad_s", "rad/s"},
     {"_sigmas", "sigma"},
     {"_sigma", "sigma"},
     {"_percent", "%"},
     {"_frames", "frames"},
     {"_cells", "cells"},
     {"_observations", "observations"},
     {"_m_s", "m/s"},
     {"_px2", "px\u00b2"},
     {"_deg", "deg"},
     {"_rad", "rad"},
     {"_m2", "m\u00b2"},
     {"_mm", "mm"},
     {"_ms", "ms"},
     {"_ns", "ns"},
     {"_px", "px"},
     {"_hz", "Hz"},
     {"_mb", "MB"},
     {"_dn", "grey values"},
     {"_m", "m"},
     {"_s", "s"},
     {"_g", "g"}}};

constexpr const char* kSpeed = "service.speed";

page::PageSetting page_setting(const io::ConfigEntry& entry, bool changeable) {
    return {entry.key, entry.value, unit_of(entry.key), entry.range, entry.comment, changeable};
}

std::string value_of(const ServiceConfig& config, const std::string& key) {
    for (const io::ConfigEntry& entry : io::list_config_of(config)) {
        if (entry.key == key) return entry.value;
    }
    return {};
}

}  // namespace

void ServiceConfig::describe(ConfigVisitor& visitor) {
    constexpr double kLeast_hz = 0.2;
    visitor.begin_group("page");
    visitor.number("map_hz",
                   map_hz,
                   kLeast_hz,
                   page::PageWish::kMaxMap_hz,
                   "largest number of maps that one page receives in a second");
    visitor.number("image_hz",
                   image_hz,
                   kLeast_hz,
                   page::PageWish::kMaxImage_hz,
                   "largest number of image pairs that one page receives in a second");
    visitor.number(
        "layer_hz",
        layer_hz,
        kLeast_hz,
        page::PageWish::kMaxMap_hz,
        "largest number of times in a second that one page receives the layers that it shows");
    visitor.end_group();
    visitor.begin_group("service");
    visitor.number(
        "speed",
        speed,
        0.0,
        page::PlaybackWish::kFastest,
        "speed of the simulated scene as a factor of real time; 0 = as fast as possible");
    visitor.integer("niceness",
                    niceness,
                    0,
                    19,
                    "niceness of the threads of perception; a larger value leaves more processor "
                    "time to the gate. It cannot go below the value of --nice");
    visitor.end_group();
}

std::string unit_of(const std::string& key) {
    for (const auto& [end, unit] : kUnits) {
        if (key.ends_with(end)) return std::string(unit);
    }
    return {};
}

ServiceSettings::ServiceSettings(const ServiceConfig& first, bool can_pace, Apply apply)
    : first_niceness_(first.niceness),
      can_pace_(can_pace),
      apply_(std::move(apply)),
      config_(first) {}

std::vector<page::PageSetting> ServiceSettings::for_pages(const Settings& run) const {
    std::vector<page::PageSetting> settings;
    for (const io::ConfigEntry& entry : io::list_config_of(now())) {
        // The speed of a recording is controlled on its timeline; a live camera has no speed.
        if (entry.key == kSpeed && !can_pace_) continue;
        settings.push_back(page_setting(entry, true));
    }
    for (const io::ConfigEntry& entry : io::list_config_of(run))
        settings.push_back(page_setting(entry, false));
    return settings;
}

/// Refuses a niceness below the niceness at the start. The gate answers in time only if perception
/// never gets more processor time than at the start.
Status ServiceSettings::check(const ServiceConfig& wanted) const {
    if (wanted.niceness < first_niceness_) {
        return usage_error(
            fmt::format("service.niceness: the value {} is refused, because serve was started with "
                        "--nice {}. The gate answers in time only if the niceness does not go "
                        "below this value; give a larger value",
                        wanted.niceness,
                        first_niceness_));
    }
    return {};
}

Result<std::string> ServiceSettings::change(const page::SettingWish& wish) {
    const std::lock_guard lock(mutex_);
    ServiceConfig wanted = config_;
    if (auto read = io::change_config(wish.key, wish.value, io::describe_config(wanted)); !read)
        return read.error();
    if (auto fits = check(wanted); !fits) return fits.error();
    if (auto applied = apply_(wanted); !applied) return applied.error();
    config_ = wanted;
    return value_of(config_, wish.key);
}

ServiceConfig ServiceSettings::now() const {
    const std::lock_guard lock(mutex_);
    return config_;
}

}  // namespace surefoot::app
