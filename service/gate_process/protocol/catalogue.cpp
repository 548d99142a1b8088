// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/protocol/catalogue.hpp"

#include <algorithm>

namespace surefoot::gate_process {
namespace {

bool names(std::string_view ours, std::string_view theirs) noexcept {
    return theirs == ours || theirs == ours.substr(1);
}

template <typename Entries>
auto find_entry(const Entries& entries, std::string_view name) noexcept {
    const auto found = std::find_if(
        entries.begin(), entries.end(), [&](const auto& entry) { return names(entry.name, name); });
    return found == entries.end() ? nullptr : &*found;
}

}  // namespace

const TopicEntry* find_topic(std::string_view name) noexcept {
    return find_entry(kTopics, name);
}

const ServiceEntry* find_service(std::string_view name) noexcept {
    // Until 0.1 the attestation had this name. Version 0.3 will refuse it (docs/migration.md).
    return find_entry(kServices, names("/surefoot/vouch", name) ? "/surefoot/attest" : name);
}

bool same_type(std::string_view ours, std::string_view theirs) noexcept {
    if (ours == theirs) return true;
    const std::string_view package = ours.substr(0, ours.find('/'));
    const std::string_view name = ours.substr(package.size() + 1);
    constexpr std::string_view kMiddle = "/msg/";
    return theirs.size() == package.size() + kMiddle.size() + name.size() &&
           theirs.starts_with(package) && theirs.substr(package.size()).starts_with(kMiddle) &&
           theirs.ends_with(name);
}

}  // namespace surefoot::gate_process
