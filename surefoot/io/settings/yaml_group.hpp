// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "surefoot/io/settings/yaml_tree.hpp"

namespace surefoot::io {

/// A group of keys of a strict file. Every key that the caller reads must exist, unless the caller
/// checks `has` first; no other key may exist. The reader keeps the first error; a call that fails
/// returns a default.
class YamlGroup {
  public:
    /// `prefix`: path of the keys to this group, for messages. `document`: name of the outermost
    /// group, which has no prefix.
    YamlGroup(YamlReader& reader, const YamlNode& node, std::string prefix, const char* document);

    /// Returns true if an optional key exists.
    [[nodiscard]] bool has(const char* key);
    double number(const char* key, double min, double max);
    /// Reads a length in metres and returns it in units of 0.1 mm.
    std::int32_t length(const char* key, double min_m, double max_m);
    /// Reads a duration in milliseconds and returns it in nanoseconds.
    std::int64_t duration_ns(const char* key, int min_ms, int max_ms);
    int integer(const char* key, int min, int max);
    bool boolean(const char* key);
    std::string text(const char* key, std::size_t max_size);
    /// Calls `read` with the group below a key.
    template <typename Read>
    void group(const char* key, Read&& read) {
        if (const YamlNode* node = take(key)) {
            YamlGroup below(reader_, *node, path(key), document_);
            read(below);
            below.finish();
        }
    }
    /// Calls `read` with each group of a list.
    template <typename Read>
    void list(const char* key, std::size_t max_count, Read&& read) {
        const YamlNode* node = take_list(key, max_count);
        if (node == nullptr) return;
        for (std::size_t i = 0; i < node->items.size(); ++i) {
            YamlGroup item(reader_, node->items[i], item_path(key, i), document_);
            read(item);
            item.finish();
        }
    }
    void fail(const char* key, const std::string& what);
    /// Reports a failure at a key of one group of a list.
    void fail_item(const char* list, std::size_t index, const char* key, const std::string& what);
    /// Reports unknown keys, then missing keys; call this function last. A misspelled key is
    /// reported first, because it explains why another key is missing.
    void finish();

  private:
    [[nodiscard]] std::string path(const char* key) const;
    [[nodiscard]] std::string item_path(const char* key, std::size_t index) const;
    void know(const char* key);
    const YamlNode* take(const char* key);
    const YamlNode* take_list(const char* key, std::size_t max_count);

    YamlReader& reader_;
    const YamlNode& node_;
    std::string prefix_;
    const char* document_;
    std::vector<std::string> known_;
    std::vector<std::string> wanted_;
};

}  // namespace surefoot::io
