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

/// Figures by name, in the order in which they were set. SI units, shares of 1; NaN = nothing to
/// measure.
class ThesisFigures {
  public:
    void set(const std::string& name, double value) { all_.emplace_back(name, value); }
    /// NaN for a name that is not there.
    [[nodiscard]] double get(std::string_view name) const;
    [[nodiscard]] const std::vector<std::pair<std::string, double>>& all() const noexcept {
        return all_;
    }
    friend bool operator==(const ThesisFigures&, const ThesisFigures&) = default;

  private:
    std::vector<std::pair<std::string, double>> all_;
};

/// The figures of a finished part of the report, in "figures.csv" of its folder: written last, so
/// that a part which has them is whole. `conditions`: hash of everything that they depend on.
[[nodiscard]] Status write_figures(const std::string& folder,
                                   std::uint64_t conditions,
                                   const ThesisFigures& figures);
/// Nothing where the part is not finished, or was finished under other conditions. An error where
/// the file is there and is none of ours.
[[nodiscard]] Result<std::optional<ThesisFigures>> read_figures(const std::string& folder,
                                                                std::uint64_t conditions);

}  // namespace surefoot::app
