// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "surefoot/core/result.hpp"

namespace surefoot::io {

/// A binary PLY file of points that grows, for clouds larger than the memory. All properties are
/// floats: x, y, z [m], then the scalars. The header tells after every `add` how many points there
/// are, so that a file whose writer was stopped can be read.
class PlyStream {
  public:
    /// Starts a file without points; what is there is replaced. `scalars`: their names, one word
    /// each.
    [[nodiscard]] static Result<PlyStream> create(const std::string& path,
                                                  const std::vector<std::string>& scalars);
    ~PlyStream();
    PlyStream(PlyStream&& other) noexcept;
    PlyStream& operator=(PlyStream&& other) noexcept;

    /// Appends whole points, their properties one behind the other. Points that do not fit on the
    /// disk are taken back.
    [[nodiscard]] Status add(std::span<const float> values);
    /// Closes the file and reports what the system found only then.
    [[nodiscard]] Status close();
    [[nodiscard]] std::int64_t points() const noexcept { return points_; }

  private:
    PlyStream(std::string path, int descriptor, const std::vector<std::string>& scalars)
        : path_(std::move(path)), descriptor_(descriptor), scalars_(scalars) {}
    [[nodiscard]] std::string header() const;

    std::string path_;
    int descriptor_ = -1;
    std::vector<std::string> scalars_;
    std::int64_t points_ = 0;
};

}  // namespace surefoot::io
