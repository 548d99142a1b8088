// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// Named figures in the order in which they were set. SI units, shares from 0 to 1; NaN = unknown.
class ThesisFigures {
  public:
    void set(const std::string& name, double value) { all_.emplace_back(name, value); }
    /// Returns the figure with that name; NaN if there is none.
    [[nodiscard]] double get(std::string_view name) const;
    [[nodiscard]] const std::vector<std::pair<std::string, double>>& all() const noexcept {
        return all_;
    }
    friend bool operator==(const ThesisFigures&, const ThesisFigures&) = default;

  private:
    std::vector<std::pair<std::string, double>> all_;
};

/// Writes the figures of a finished part of the report to "figures.csv" in its folder. This file is
/// written last, so a part with this file is complete. `conditions`: hash of all inputs that affect
/// the figures.
[[nodiscard]] Status write_figures(const std::string& folder,
                                   std::uint64_t conditions,
                                   const ThesisFigures& figures);
/// Reads figures.csv. Returns no value if the part is not finished or was made under other
/// conditions. Returns an error if the file is not a figures file.
[[nodiscard]] Result<std::optional<ThesisFigures>> read_figures(const std::string& folder,
                                                                std::uint64_t conditions);

}  // namespace surefoot::app
