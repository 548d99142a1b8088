// SPDX-License-Identifier: Apache-2.0
#include "service/page/page_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "service/gate_process/protocol/json_text.hpp"

namespace surefoot::page {

using gate_process::Json;

void PageSettings::offer(std::vector<PageSetting> settings, Change change) {
    const std::lock_guard lock(mutex_);
    settings_ = std::move(settings);
    change_ = std::move(change);
    ++serial_;
}

SettingAnswer PageSettings::ask(const SettingWish& wish) {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(settings_.begin(), settings_.end(), [&](const PageSetting& s) {
        return s.key == wish.key;
    });
    if (found == settings_.end())
        return {wish.key, false, "", fmt::format("there is no setting '{}'", wish.key)};
    if (!found->changeable) {
        return {wish.key,
                false,
                found->value,
                fmt::format(
                    "{} cannot change while the service runs; restart the service with --set {}={}",
                    wish.key,
                    wish.key,
                    wish.value)};
    }
    const auto changed = change_(wish);
    if (!changed) return {wish.key, false, found->value, changed.error().message};
    const std::string before = std::exchange(found->value, *changed);
    ++serial_;
    return {wish.key,
            true,
            *changed,
            fmt::format("{} is now {} (before: {})", wish.key, *changed, before)};
}

std::vector<PageSetting> PageSettings::all() const {
    const std::lock_guard lock(mutex_);
    return settings_;
}

std::uint64_t PageSettings::serial() const {
    const std::lock_guard lock(mutex_);
    return serial_;
}

std::string settings_text(const std::vector<PageSetting>& settings) {
    Json list = Json::array();
    for (const PageSetting& setting : settings) {
        list.push_back({{"key", setting.key},
                        {"value", setting.value},
                        {"unit", setting.unit},
                        {"range", setting.range},
                        {"comment", setting.comment},
                        {"changeable", setting.changeable}});
    }
    return gate_process::dump({{"kind", "settings"}, {"settings", std::move(list)}});
}

std::string setting_text(const SettingAnswer& answer) {
    return gate_process::dump({{"kind", "setting"},
                               {"key", answer.key},
                               {"accepted", answer.accepted},
                               {"value", answer.value},
                               {"text", answer.text}});
}

}  // namespace surefoot::page
