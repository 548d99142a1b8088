// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "surefoot/core/result.hpp"

namespace surefoot::io {

/// A growing binary PLY file, for clouds larger than the memory. All properties are floats: x, y, z
/// [m], then the scalars. After every `add` the header holds the number of points, so that a file
/// stays readable if its writer is stopped.
class PlyStream {
  public:
    /// Creates an empty file; an existing file is replaced. `scalars`: names of the scalars, one
    /// word each. Fails on errors of the operating system.
    [[nodiscard]] static Result<PlyStream> create(const std::string& path,
                                                  const std::vector<std::string>& scalars);
    ~PlyStream();
    PlyStream(PlyStream&& other) noexcept;
    PlyStream& operator=(PlyStream&& other) noexcept;

    /// Appends whole points; `values` lists all properties of each point. If writing fails (full
    /// disk), all points of this call are removed again.
    [[nodiscard]] Status add(std::span<const float> values);
    /// Closes the file and reports late errors of the operating system.
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
