// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/settings/yaml_group.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "surefoot/core/checked_index.hpp"

namespace surefoot::io {

YamlGroup::YamlGroup(YamlReader& reader,
                     const YamlNode& node,
                     std::string prefix,
                     const char* document)
    : reader_(reader), node_(node), prefix_(std::move(prefix)), document_(document) {
    if (!node.is_mapping())
        reader_.fail(node,
                     prefix_.empty() ? document_ : prefix_,
                     fmt::format("expected a group of keys, found {}", node.kind_name()));
}

bool YamlGroup::has(const char* key) {
    know(key);
    return node_.find(key) != nullptr;
}

double YamlGroup::number(const char* key, double min, double max) {
    const YamlNode* node = take(key);
    return node != nullptr ? reader_.number(*node, path(key), min, max) : 0.0;
}

std::int32_t YamlGroup::length(const char* key, double min_m, double max_m) {
    constexpr double kTenthMmPerMetre = 1e4;
    const double length_m = number(key, min_m, max_m);
    return saturated_integer<std::int32_t>(std::round(length_m * kTenthMmPerMetre));
}

std::int64_t YamlGroup::duration_ns(const char* key, int min_ms, int max_ms) {
    constexpr std::int64_t kNanosecondsPerMs = 1'000'000;
    return kNanosecondsPerMs * integer(key, min_ms, max_ms);
}

int YamlGroup::integer(const char* key, int min, int max) {
    const YamlNode* node = take(key);
    return node != nullptr ? reader_.integer(*node, path(key), min, max) : 0;
}

bool YamlGroup::boolean(const char* key) {
    const YamlNode* node = take(key);
    return node != nullptr && reader_.boolean(*node, path(key));
}

std::string YamlGroup::text(const char* key, std::size_t max_size) {
    const YamlNode* node = take(key);
    std::string value = node != nullptr ? reader_.text(*node, path(key)) : std::string();
    if (node != nullptr && (value.empty() || value.size() > max_size))
        reader_.fail(*node, path(key), fmt::format("must have 1 to {} characters", max_size));
    return value;
}

void YamlGroup::fail(const char* key, const std::string& what) {
    const YamlNode* node = node_.find(key);
    reader_.fail(node != nullptr ? *node : node_, path(key), what);
}

void YamlGroup::fail_item(const char* list,
                          std::size_t index,
                          const char* key,
                          const std::string& what) {
    const YamlNode* node = node_.find(list);
    if (node == nullptr || index >= node->items.size()) return fail(list, what);
    const YamlNode& item = node->items[index];
    const YamlNode* value = item.find(key);
    reader_.fail(value != nullptr ? *value : item, item_path(list, index) + "." + key, what);
}

void YamlGroup::finish() {
    reader_.only_keys(node_, prefix_.empty() ? "" : prefix_ + ".", known_);
    for (const std::string& key : wanted_) {
        if (node_.find(key) == nullptr) fail(key.c_str(), "this key is missing");
    }
}

std::string YamlGroup::path(const char* key) const {
    return prefix_.empty() ? key : prefix_ + "." + key;
}

std::string YamlGroup::item_path(const char* key, std::size_t index) const {
    return fmt::format("{}[{}]", path(key), index);
}

void YamlGroup::know(const char* key) {
    if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
}

const YamlNode* YamlGroup::take(const char* key) {
    know(key);
    wanted_.emplace_back(key);
    return node_.find(key);
}

const YamlNode* YamlGroup::take_list(const char* key, std::size_t max_count) {
    const YamlNode* node = take(key);
    if (node == nullptr) return nullptr;
    if (node->kind == YamlNode::Kind::sequence && node->items.size() <= max_count) return node;
    reader_.fail(*node, path(key), fmt::format("expected a list of at most {} groups", max_count));
    return nullptr;
}

}  // namespace surefoot::io
