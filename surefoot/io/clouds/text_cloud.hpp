// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/io/clouds/point_cloud.hpp"
#include "surefoot/io/columns.hpp"

namespace surefoot::io {

/// Reads a text cloud in pieces of whole lines, for files larger than the memory. The header and
/// the first point define the layout of all lines. See `parse_text_cloud` for the lines.
///
/// Scalars are doubles. A column whose first value is a whole number beyond 2^53 (nanoseconds since
/// 1970) holds 64-bit whole numbers. A later value of another kind is then an error.
class TextCloudParser {
  public:
    explicit TextCloudParser(std::string file) : file_(std::move(file)) {}

    /// Returns the points of the next lines; the cloud may be empty. Errors name file and line.
    [[nodiscard]] Result<PointCloud> parse(std::string_view lines);
    /// Returns an error if there were no points, or fewer points than the file announces.
    [[nodiscard]] Status finish() const;
    /// Describes values that were not read exactly as written, one sentence each.
    [[nodiscard]] std::vector<std::string> notes() const;

  private:
    struct Head {
        std::vector<Column> columns;
        std::string line;
        int number = 0;
        bool comment = false;
    };
    [[nodiscard]] Status take_line(std::string_view content, PointCloud& cloud);
    [[nodiscard]] Status take_head(std::string_view content, bool comment);
    [[nodiscard]] Status take_count();
    [[nodiscard]] Status choose_columns(std::string_view content);
    [[nodiscard]] Status name_columns();
    void name_scalars(const std::vector<std::string>& names);
    [[nodiscard]] Status take_point(PointCloud& cloud);
    [[nodiscard]] Status take_scalar(std::string_view word, CloudScalar& scalar);

    std::string file_;
    int line_ = 0;  ///< number of the current line
    std::optional<Head> head_;
    std::optional<std::int64_t> announced_;
    std::int64_t points_ = 0;
    std::int64_t rounded_ = 0;  ///< count of rounded whole numbers beyond 2^53

    // These members are set at the first point.
    char separator_ = ' ';
    std::size_t columns_ = 0;
    std::array<std::size_t, 3> axes_ = {0, 1, 2};
    std::vector<CloudScalar> scalars_;  ///< names and types, without values
    std::vector<std::string_view> fields_;
};

}  // namespace surefoot::io
