// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "surefoot/core/result.hpp"

namespace surefoot::io {

/// A YAML document as a plain tree. Every value has its line number, so that errors can name
/// "file.yaml:12". Keys of a mapping are unique. Supports the needed part of YAML 1.2, OpenCV's
/// "%YAML:1.0" header and its "!!opencv-matrix" tags; scalars stay text.
struct YamlNode {
    enum class Kind { null, scalar, sequence, mapping };

    Kind kind = Kind::null;
    int line = 0;     ///< line number, from 1
    std::string key;  ///< key, if the node is an item of a mapping
    std::string scalar;
    std::vector<YamlNode> items;  ///< items of a sequence or a mapping, in file order

    /// Returns the value of a key of this mapping, or nullptr.
    [[nodiscard]] const YamlNode* find(std::string_view name) const noexcept;
    [[nodiscard]] bool is_mapping() const noexcept { return kind == Kind::mapping; }
    [[nodiscard]] bool is_scalar() const noexcept { return kind == Kind::scalar; }
    /// Returns the name of the kind for messages: "a list", "a group of keys", ...
    [[nodiscard]] const char* kind_name() const noexcept;
};

/// Parses the first document. Limits: 16 MB, 64 levels, 1e6 values (aliases count each time).
[[nodiscard]] Result<YamlNode> parse_yaml(std::string_view text, const std::string& file);

/// Typed access whose errors name file, line and key. The reader keeps the first failure; a call
/// that fails returns a default. Read all values, then check `error` once.
class YamlReader {
  public:
    YamlReader(std::string file, const YamlNode& root) : file_(std::move(file)), root_(root) {}

    [[nodiscard]] const YamlNode& root() const noexcept { return root_; }
    [[nodiscard]] const std::string& file() const noexcept { return file_; }
    [[nodiscard]] const std::optional<Error>& error() const noexcept { return error_; }

    /// Reports `what` about a key, unless there is an earlier error.
    void fail(const YamlNode& node, std::string_view key, const std::string& what);
    /// Returns the value of a required key of `mapping`.
    const YamlNode* required(const YamlNode& mapping, std::string_view key);

    /// Reads a finite number within [min, max].
    double number(const YamlNode& node, std::string_view key, double min, double max);
    int integer(const YamlNode& node, std::string_view key, int min, int max);
    bool boolean(const YamlNode& node, std::string_view key);
    std::string text(const YamlNode& node, std::string_view key);
    /// Reads a list of `count` finite numbers; nested lists are flattened row by row.
    std::vector<double> numbers(const YamlNode& node, std::string_view key, std::size_t count);
    /// Reads a list of finite numbers of any length up to `max_count`.
    std::vector<double> any_numbers(const YamlNode& node,
                                    std::string_view key,
                                    std::size_t max_count);
    /// Fails at the first key of `mapping` that is not among `names`.
    void only_keys(const YamlNode& mapping,
                   std::string_view prefix,
                   const std::vector<std::string>& names);

  private:
    std::string file_;
    const YamlNode& root_;
    std::optional<Error> error_;
};

}  // namespace surefoot::io
