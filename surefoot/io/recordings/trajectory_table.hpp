// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/io/columns.hpp"
#include "surefoot/io/recordings/stamps.hpp"

namespace surefoot::io {

/// Column numbers of a stamped pose: stamp, x, y, z, qx, qy, qz, qw.
using PosePlaces = std::array<std::size_t, 8>;

/// Layout of the lines of a trajectory file.
struct TrajectoryLayout {
    std::string format;  ///< name of the format (TrajectoryFile::format)
    bool stamped = true;
    std::size_t columns = 0;
    char separator = ' ';
    PosePlaces places = {0, 1, 2, 3, 4, 5, 6, 7};
    std::optional<StampUnit> unit;  ///< unit of the stamps, if the header names the unit
};

/// A line of numbers: seven numbers of a stamped pose, or twelve of a 3x4 matrix.
struct TrajectoryRow {
    int line = 0;
    std::string_view stamp;  ///< stamp as a view into the text; empty without stamps
    std::array<double, 12> numbers{};
    bool finite = true;
};

/// Lines of a trajectory file. The header line defines the layout, or the first line of numbers if
/// there is no header. Rows are views into the text.
class TrajectoryTable {
  public:
    /// Errors name `file` and the line.
    [[nodiscard]] static Result<TrajectoryTable> read(std::string_view text,
                                                      const std::string& file);
    [[nodiscard]] const TrajectoryLayout& layout() const noexcept { return layout_; }
    [[nodiscard]] const std::vector<TrajectoryRow>& rows() const noexcept { return rows_; }

  private:
    [[nodiscard]] Status take_line(std::string_view content, int number);
    [[nodiscard]] bool take_head(std::string_view content);
    [[nodiscard]] Status choose_layout(char separator);
    [[nodiscard]] Status take_row(int number);
    [[nodiscard]] Status take_number(std::string_view word, std::size_t at, TrajectoryRow& row);

    std::optional<TrajectoryLayout> head_;
    std::string_view head_line_;
    TrajectoryLayout layout_;
    std::vector<TrajectoryRow> rows_;
    std::vector<std::string_view> words_;  ///< words of the current line
};

}  // namespace surefoot::io
