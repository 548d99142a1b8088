// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/sim/scenes/expression.hpp"
#include "surefoot/sim/scenes/scene_node.hpp"

namespace surefoot::sim {

/// Marks a required number: a value that is still NaN after reading is missing.
inline constexpr double kRequired = std::numeric_limits<double>::quiet_NaN();
/// Marks a required choice: a value that is still -1 after reading is missing.
inline constexpr int kRequiredChoice = -1;

/// Reads values of a scene file. Numbers are expressions of the parameters above them; a parameter
/// that is a word stands for that word. Keeps the first failure with its file and line and ignores
/// later ones.
class SceneReader {
  public:
    explicit SceneReader(std::string file) : file_(std::move(file)) {}

    [[nodiscard]] const std::optional<Error>& error() const noexcept { return error_; }
    void fail(int line, const std::string& what);
    void fail(const SceneNode& node, const std::string& what);

    /// Defines a parameter: an expression, a word, {uniform: [low, high]} or {choice: [...]}. Draws
    /// at most one random number.
    void define(const SceneNode& parameter, Rng& rng);
    void define(const SceneNode& origin, const std::string& name, double value);
    void forget(const std::string& name) {
        numbers_.erase(name);
        words_.erase(name);
    }
    [[nodiscard]] const NamedNumbers& numbers() const noexcept { return numbers_; }
    [[nodiscard]] const std::map<std::string, std::string, std::less<>>& words() const noexcept {
        return words_;
    }

    /// Returns NaN after a failure.
    [[nodiscard]] double number(const SceneNode& node);
    [[nodiscard]] std::string word(const SceneNode& node);
    /// A required value of the given kind; nullptr after a failure.
    [[nodiscard]] const SceneNode* required(const SceneNode& group,
                                            std::string_view key,
                                            SceneNode::Kind kind);
    /// Fills `config` through its own `describe`. Every key of the group must be a key of `config`
    /// or one of `other_keys`, which the caller reads.
    template <typename Config>
    void read(const SceneNode& group,
              Config& config,
              const std::vector<std::string_view>& other_keys = {}) {
        read_keys(
            group, [&](ConfigVisitor& visitor) { config.describe(visitor); }, other_keys);
    }
    void only_keys(const SceneNode& group, const std::vector<std::string_view>& keys);

  private:
    void read_keys(const SceneNode& group,
                   const std::function<void(ConfigVisitor&)>& describe,
                   const std::vector<std::string_view>& other_keys);
    void define_drawn(const SceneNode& parameter, Rng& rng);
    void define_value(const SceneNode& name, const SceneNode& value);

    std::string file_;
    NamedNumbers numbers_;
    std::map<std::string, std::string, std::less<>> words_;
    std::optional<Error> error_;
};

}  // namespace surefoot::sim
